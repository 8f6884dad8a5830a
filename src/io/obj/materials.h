#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "document.h"
#include "io/format.h"
#include "io/textures.h"

namespace meshgraft::io {

/// The materials of an OBJ file that is composed anew.
struct ObjMaterials {
  std::vector<std::string> libraries;  ///< names for its mtllib lines
  std::optional<NewFile> library;      ///< a new library beside it
  std::vector<Note> notes;
};

/// Returns the old libraries if the mesh comes from one OBJ file of the same folder and its materials keep
/// their names.
///
/// Otherwise composes a new library. It defines the materials of all files by their names in the mesh, with
/// texture paths relative to the new file. It replaces only a file that an earlier call made and that is not
/// one of the files' libraries.
ObjMaterials materials_for(const Mesh& mesh, const std::filesystem::path& path);

/// Returns the library names of all OBJ files behind the mesh, if the mesh has materials.
std::vector<std::string> material_libraries_of(const Mesh& mesh);

/// Returns the libraries of `document` that a copy of the file at `path` would not find.
std::vector<std::string> libraries_to_copy(const ObjDocument& document, const std::filesystem::path& path);

/// Returns the existing images of all materials' colours (`map_Kd`).
std::vector<MaterialTexture> textures_of(const ObjDocument& document);

/// Returns the existing material libraries and textures that an OBJ file refers to.
std::vector<std::filesystem::path> files_of_materials(const std::filesystem::path& path);

}  // namespace meshgraft::io
