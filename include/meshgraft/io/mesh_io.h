#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Reads a mesh; the format follows the content where it has a signature, else the extension (docs/files.md).
/// Everything the file carries is kept: what has a meaning here as attributes, the rest in `Mesh::source`.
/// Indices may be out of range and coordinates non-finite: `check_mesh` names them.
/// Throws Error(io) if the file cannot be read, Error(input) with file and line (or byte) if it is malformed.
Mesh read_mesh(const std::filesystem::path& path, const Context& context = {});

/// An edit kept beside the shape that it was made from, as one more morph target (blend shape) of weight 0.
struct MorphTarget {
  std::string name;
  Points rest{0, 3};  ///< n×3, the positions before the edit; those of the file, if the mesh is still its
};

struct WriteOptions {
  bool overwrite = true;  ///< replace an existing file
  /// For glTF: the file holds the rest positions, and the mesh's as a morph target. Normals of the rest are the
  /// file's; a mesh without a glTF file has them turned back with the surface.
  std::optional<MorphTarget> morph_target{};
};

struct WriteResult {
  std::vector<std::filesystem::path> files;  ///< that were written: the mesh, then those that it refers to
  std::vector<std::string> notes;            ///< what the format has no place for, a sentence each
};

/// Writes a mesh in the format of `path`'s extension. A mesh that was read from the same format and has its
/// topology unchanged is written as it was read (scalar types, byte order, property order, comments, groups,
/// .mtl reference, unknown elements), only positions and normals that changed are new; any other is written
/// from its positions, faces and attributes. An OBJ whose materials come from several files, or from another
/// folder, gets a material library beside it, a new .gltf its buffer (docs/files.md). The file appears whole or
/// not at all. Throws Error(io) if it cannot be written, Error(input) if the extension is unknown or the format
/// cannot hold the values, Error(usage) for a morph target that does not fit the format or the mesh.
WriteResult write_mesh(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options = {},
                       const Context& context = {});

/// What a length of 1 means in the file behind a mesh ("millimeter", "inch"); empty where it does not tell, as
/// most formats do not.
std::string unit_of(const Mesh& mesh);

/// Throws Error(input) unless the extension of `path` is that of a format that `write_mesh` knows.
void require_mesh_format(const std::filesystem::path& path);

/// Throws Error(usage) unless the extension of `path` is that of a format with morph targets.
void require_morph_targets(const std::filesystem::path& path);

/// A mesh file and the files that it refers to, which exist: an OBJ's material libraries and their textures, a
/// glTF file's buffers and images.
std::vector<std::filesystem::path> files_behind(const std::filesystem::path& path);

/// Writes `content` to `path` so that a reader sees either the old file or the whole new one (a temporary
/// file beside it, flushed, then renamed). Throws Error(io), leaving no temporary file behind.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Where a path leads through symbolic links, whether there is a file or not.
std::filesystem::path follow_links(std::filesystem::path path);

/// A whole file as bytes. Throws Error(io) with a reason and a remedy (no such file, a folder, no permission).
std::string read_file(const std::filesystem::path& path);

}  // namespace meshgraft
