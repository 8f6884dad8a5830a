#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// A file and its bytes.
struct NewFile {
  std::filesystem::path path;
  std::string content;
};

/// What a writer makes of a mesh.
struct Written {
  std::string content;
  std::vector<NewFile> companions{};  ///< that the content refers to
  std::vector<std::string> notes{};   ///< what it could not hold, a sentence each
};

/// A mesh file format: what tells its files apart, and how bytes become a mesh and a mesh bytes. A new
/// format is a header and a source file that define one of these, and a line in `formats()`.
struct Format {
  std::string_view name;                         ///< as people write it, "PLY"
  std::span<const std::string_view> extensions;  ///< lower case with the dot, the usual one first

  /// True if the content can be nothing else; null for formats without a signature.
  bool (*has_signature)(std::string_view content);

  /// `name` is the file's name for messages. Throws Error(input) with the place in the file.
  Mesh (*read)(std::string content, const std::string& name, const Context& context);

  /// What the file `path` is to hold. Throws Error(input) for positions that the format cannot hold.
  Written (*write)(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                   const Context& context);

  /// The files that the file `path` refers to, as far as they exist; null for formats that are one file.
  std::vector<std::filesystem::path> (*companions)(const std::filesystem::path& path) = nullptr;

  bool has_morph_targets = false;  ///< whether `WriteOptions::morph_target` means anything
};

/// All formats that can be read and written.
std::span<const Format> formats();

}  // namespace meshgraft::io
