#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/mesh.h>

#include "core/memory_budget.h"

namespace meshgraft::io {

/// A file and its bytes.
struct NewFile {
  std::filesystem::path path;
  std::string content;
};

/// The files that a writer composes for a mesh, and its notes.
struct Written {
  std::string content;
  std::vector<NewFile> companions{};  ///< files that the content refers to
  std::vector<Note> notes{};          ///< losses
};

/// A mesh file format: how its files are recognised, read and written. A new format needs a header and a
/// source file that define one of these, and a line in `formats()`.
struct Format {
  std::string_view name;                         ///< display name, e.g. "PLY"
  std::span<const std::string_view> extensions;  ///< lower case with the dot, the usual one first

  /// Returns true if the content can be of no other format. Null for formats without a signature.
  bool (*has_signature)(std::string_view content);

  /// Reads a mesh. `name` is the file's name for messages. The content has been charged to the budget. Throws
  /// Error(input) with the location in the file, and Error(memory) beyond the budget.
  Mesh (*read)(std::string content, const std::string& name, MemoryBudget& budget, const Context& context);

  /// Composes the file `path`. Throws Error(input) for positions that the format cannot hold.
  Written (*write)(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                   const Context& context);

  /// Returns the existing files that the file `path` refers to. Null for formats that consist of one file.
  std::vector<std::filesystem::path> (*companions)(const std::filesystem::path& path) = nullptr;

  bool has_morph_targets = false;  ///< whether `WriteOptions::morph_target` is supported
};

/// Returns all formats that can be read and written.
std::span<const Format> formats();

}  // namespace meshgraft::io
