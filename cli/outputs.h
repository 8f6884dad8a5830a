#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/run_edit.h>

namespace meshgraft::cli {

/// What a command is to write; empty paths are not asked for.
struct Outputs {
  std::filesystem::path mesh{}, picture{}, report{}, edit{};
  std::vector<std::filesystem::path> more_meshes{};

  /// Those that are asked for, the mesh and more of them first.
  std::vector<std::filesystem::path> all() const;
  /// `mesh`, where it is asked for, and the others.
  std::vector<std::filesystem::path> meshes() const;
};

/// Throws Error(usage) with `remedy` if `output` is the same file as one of `inputs` (through links too).
void require_not_an_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs,
                          const std::string& remedy = "Choose another name.");

/// Throws Error(usage) unless the name ends in .png.
void require_png(const std::filesystem::path& output);

/// Throws Error(io) if a file of this name cannot be written, for it is a folder, has no folder, or for lack of
/// permission: better now than after a long computation.
void require_writable(const std::filesystem::path& output);

/// Checks what a command is to write before it works: the outputs are distinct however they are spelled, of a
/// kind that is known, and can be written, and none replaces an input or what an input refers to (material
/// libraries, textures). With `force` a mesh may replace an input mesh; the edit file never is replaced.
/// Throws Error(usage), Error(input) and Error(io).
void require_outputs(const Outputs& outputs, const std::vector<std::filesystem::path>& inputs,
                     const std::filesystem::path& edit, bool force);

/// Writes a mesh of an edit, and tells the report of the files, the seconds and what the format has no place
/// for.
void write_and_report(const Mesh& mesh, const std::filesystem::path& output, EditReport& report,
                      const WriteOptions& options, const Context& context);

}  // namespace meshgraft::cli
