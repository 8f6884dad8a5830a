#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The picture that a material's base colour comes from.
struct MaterialTexture {
  /// As the labels of the mesh's attribute "material" have it. Empty: of a mesh without materials, whose faces
  /// have this picture or, where there are several, the one that their attribute "texnumber" counts from 0.
  std::string material;
  std::filesystem::path file;  ///< where it is; empty: in `bytes`, or not there
  std::string bytes;           ///< a PNG, JPEG, … that lies in the mesh's own file
};

/// The pictures of the mesh's materials, at most one each: `map_Kd` of an OBJ's libraries, `baseColorTexture`
/// of glTF, the comments `TextureFile` of a PLY. Also, but for those of a PLY, of a mesh that was cut or
/// grafted from such files. What is missing or malformed is left out, but a PLY's picture that is not there
/// keeps its place, for `texnumber` counts it; files are looked for and not read.
std::vector<MaterialTexture> textures_of(const Mesh& mesh);

}  // namespace meshgraft
