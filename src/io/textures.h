#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The image of a material's base colour.
struct MaterialTexture {
  /// Label of the mesh's attribute "material". It is empty for a mesh without materials. Then all faces have
  /// this image; where there are several, their attribute "texnumber" is the index of their image, from 0.
  std::string material;
  std::filesystem::path file;  ///< image file; empty if the image is in `bytes` or missing
  /// A PNG, JPEG, … embedded in the mesh's own file, shared by all materials that show it; null if there is
  /// none.
  std::shared_ptr<const std::string> bytes;
};

/// Returns the images of the mesh's materials, at most one each. The sources are `map_Kd` of an OBJ's
/// libraries, `baseColorTexture` of glTF, and the comments `TextureFile` of a PLY. OBJ and glTF images are
/// also found for a mesh that was cut or grafted from such files. Missing or malformed images are left out. A
/// missing image of a PLY keeps its entry, because `texnumber` counts it. The function looks for files, but
/// does not read them.
std::vector<MaterialTexture> textures_of(const Mesh& mesh);

}  // namespace meshgraft
