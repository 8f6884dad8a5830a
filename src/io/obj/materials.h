#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/io/textures.h>
#include <meshgraft/mesh/mesh.h>

#include "document.h"
#include "io/format.h"

namespace meshgraft::io {

/// The materials of an OBJ file that is composed anew.
struct ObjMaterials {
  std::vector<std::string> libraries;  ///< that its mtllib lines name
  std::optional<NewFile> library;      ///< that goes beside it
  std::vector<std::string> notes;
};

/// Where the mesh comes from one file of the same folder, its libraries. Else a library of its own, that
/// defines the materials of all files by the names that they have in the mesh, and textures as seen from there.
/// It replaces only a file that an earlier call made and none of the files' libraries.
ObjMaterials materials_for(const Mesh& mesh, const std::filesystem::path& path);

/// The names of the libraries of all OBJ files behind the mesh, where it has materials.
std::vector<std::string> material_libraries_of(const Mesh& mesh);

/// The libraries of `document` that a copy of it at `path` would not find.
std::vector<std::string> libraries_to_copy(const ObjDocument& document, const std::filesystem::path& path);

/// The pictures of all materials' colours (`map_Kd`) that exist.
std::vector<MaterialTexture> textures_of(const ObjDocument& document);

/// The material libraries and textures that an OBJ file refers to, as far as they exist.
std::vector<std::filesystem::path> files_of_materials(const std::filesystem::path& path);

}  // namespace meshgraft::io
