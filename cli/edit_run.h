#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/run_edit.h>

#include "picture.h"

namespace meshgraft::cli {

/// Reads the edit file that a command was given. Throws Error(input) where it was given a mesh instead.
EditFile read_given_edit(const std::filesystem::path& file);

/// The arguments of `run` and `deform`: an edit file, the outputs, and settings that override the edit file.
struct EditRunArguments {
  std::filesystem::path edit, output, report, picture;  ///< empty: not requested
  std::vector<std::string> saves;                       ///< NAME=FILE
  std::vector<std::string> features;                    ///< selections
#ifdef MESHGRAFT_HAS_RENDER
  View view{.width = picture_width, .height = picture_height};
#endif
  RunOptions run;
  std::vector<Note> notes;  ///< about values that are read as other ones
  std::optional<std::string> morph_target;
  int threads = 0;
  std::uint64_t memory = 0;  ///< of files, bytes
  bool json = false;
  bool force = false;
};

/// Adds the options of a command that runs an edit file, except `-o`. `arguments` must outlive the command.
void add_edit_run_options(CLI::App& command, EditRunArguments& arguments);

/// Runs the edit, computes everything, and then writes the requested outputs. Throws the errors of
/// `read_edit_file`, `require_outputs`, `run_edit` and `write_mesh`. Throws Error(usage) for a mesh to save
/// that the edit does not have.
void run_edit_file(const EditRunArguments& arguments, Context context);

}  // namespace meshgraft::cli
