#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Reads a mesh. The format follows the content where it has a signature, else the extension (docs/files.md).
/// Everything in the file is kept: data that meshgraft understands as attributes, the rest in `Mesh::source`.
/// Indices may be out of range and coordinates non-finite; `check_mesh` reports both. Throws Error(io) if the
/// file cannot be read, Error(input) with file and line (or byte) if it is malformed.
Mesh read_mesh(const std::filesystem::path& path, const Context& context = {});

/// An edit stored beside the rest shape in one file, as an additional morph target (blend shape) of weight 0.
struct MorphTarget {
  std::string name;
  /// Positions before the edit, n×3, model units; those of the file, if the mesh still belongs to that file.
  Points rest{0, 3};
};

struct WriteOptions {
  bool overwrite = true;  ///< replace an existing file
  /// For glTF: the file has the rest positions, and the mesh's positions as a morph target. Normals of the
  /// rest shape are those of the original file. A mesh without a glTF file has its normals turned back with
  /// the surface.
  std::optional<MorphTarget> morph_target{};
};

struct WriteResult {
  std::vector<std::filesystem::path> files;  ///< files written: the mesh, then those that it refers to
  std::vector<Note> notes;                   ///< data that the format cannot store
};

/// Writes a mesh in the format of `path`'s extension. The file appears whole or not at all.
///
/// A mesh that was read from the same format and has its topology unchanged is written as it was read. This
/// covers scalar types, byte order, property order, comments, groups, .mtl reference and unknown elements;
/// only changed positions, normals and tangents are new. Any other mesh is written from its positions, faces
/// and attributes. An OBJ whose materials come from several files, or from another folder, gets a material
/// library beside it; a new .gltf gets its buffer (docs/files.md).
///
/// Throws Error(io) if the file cannot be written, with the id io.file_exists if it must not be replaced.
/// Throws Error(input) if the extension is unknown (io.unknown_extension) or the format cannot store the
/// values, Error(usage) for a morph target that does not fit the format or the mesh.
WriteResult write_mesh(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options = {},
                       const Context& context = {});

/// Returns notes on the files behind a mesh: io.other_format for each whose content is of another format than
/// its extension says.
std::vector<Note> notes_on_files(const Mesh& mesh);

/// Returns the unit of length of the file behind a mesh ("millimeter", "inch"). It is empty where the file
/// has none, as in most formats.
std::string unit_of(const Mesh& mesh);

/// Throws Error(input), io.unknown_extension or io.no_extension, unless the extension of `path` belongs to a
/// format that `write_mesh` knows.
void require_mesh_format(const std::filesystem::path& path);

/// Throws Error(usage) with the id io.no_morph_targets unless the extension of `path` belongs to a format
/// with morph targets.
void require_morph_targets(const std::filesystem::path& path);

/// Returns a mesh file and the existing files that it refers to: an OBJ's material libraries and their
/// textures, a glTF file's buffers and images.
std::vector<std::filesystem::path> files_behind(const std::filesystem::path& path);

}  // namespace meshgraft
