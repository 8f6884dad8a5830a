#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace meshgraft::cli {

/// Throws Error(usage) with `remedy` if `output` is the same file as one of `inputs` (through links too).
void require_not_an_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs,
                          const std::string& remedy = "Choose another name.");

/// Throws Error(usage) unless the name ends in .png.
void require_png(const std::filesystem::path& output);

/// Throws Error(io) if the folder of `output` does not exist: better now than after a long computation.
void require_folder(const std::filesystem::path& output);

/// Checks what a command is to write before it works: `outputs`, of which empty ones are left out, are distinct
/// and can be written, and none replaces an input. With `force` the first of them, the mesh, may; the edit file
/// never is replaced. Throws Error(usage) and Error(io).
void require_outputs(const std::vector<std::filesystem::path>& outputs,
                     const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& edit,
                     bool force);

}  // namespace meshgraft::cli
