#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The picture that a material's base colour comes from.
struct MaterialTexture {
  std::string material;        ///< as the labels of the mesh's attribute "material" have it
  std::filesystem::path file;  ///< where it is; empty: in `bytes`
  std::string bytes;           ///< a PNG, JPEG, … that lies in the mesh's own file
};

/// The pictures of the mesh's materials, at most one each: `map_Kd` of an OBJ's libraries, `baseColorTexture`
/// of glTF. Also of a mesh that was cut or grafted from such files. What is missing or malformed is left out;
/// files are looked for and not read.
std::vector<MaterialTexture> textures_of(const Mesh& mesh);

}  // namespace meshgraft
