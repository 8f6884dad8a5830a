#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/run_edit.h>

#include "cli/facts.h"

namespace meshgraft::cli {

/// The files that a command is to write. Empty paths are not requested.
struct Outputs {
  std::filesystem::path mesh{}, picture{}, report{}, edit{};
  std::vector<std::filesystem::path> more_meshes{};

  /// Returns the requested files, meshes first.
  std::vector<std::filesystem::path> all() const;
  /// Returns `mesh`, if it is requested, and `more_meshes`.
  std::vector<std::filesystem::path> meshes() const;
};

/// Throws `error` if `output` is the same file as one of `inputs` (through links too).
void require_not_an_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs,
                          const Fact& error = facts::cli::OutputIsInput{});

/// Returns whether the extension of a file is that of a mesh format.
bool names_a_mesh(const std::filesystem::path& file);

/// Throws Error(usage) unless the name ends in .png.
void require_png(const std::filesystem::path& output);

/// Throws Error(io) if a file of this name cannot be written: it is a folder, its folder does not exist, or
/// permission is missing. Checking first avoids a failure after a long computation.
void require_writable(const std::filesystem::path& output);

/// Checks a command's outputs before the command starts its work. The outputs must be distinct however they
/// are spelled, have a known format, and be writable. None may replace an input or a file that an input
/// refers to (material libraries, textures). With `force` a mesh may replace an input mesh. The edit file is
/// never replaced. Throws Error(usage), Error(input) and Error(io).
void require_outputs(const Outputs& outputs, const std::vector<std::filesystem::path>& inputs,
                     const std::filesystem::path& edit, bool force);

/// Writes a mesh of an edit. Adds the files, the seconds and notes on the data that the format cannot hold to
/// the report.
void write_and_report(const Mesh& mesh, const std::filesystem::path& output, EditReport& report,
                      const WriteOptions& options, const Context& context);

}  // namespace meshgraft::cli
