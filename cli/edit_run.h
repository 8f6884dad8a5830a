#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <meshgraft/core/context.h>
#include <meshgraft/script/run_edit.h>

#ifdef MESHGRAFT_HAS_RENDER
#include "picture.h"
#endif

namespace meshgraft::cli {

/// What `run` and `deform` are asked for: an edit file, what to write of it, and what to do otherwise than it
/// says.
struct EditRunArguments {
  std::filesystem::path edit, output, report, picture;  ///< empty: not asked for
  std::vector<std::string> saves;                       ///< NAME=FILE
#ifdef MESHGRAFT_HAS_RENDER
  View view{.width = picture_width, .height = picture_height};
#endif
  RunOptions run;
  std::vector<std::string> notes;  ///< about words that are read as others
  std::optional<std::string> morph_target;
  int threads = 0;
  bool json = false;
  bool force = false;
};

/// The options of a command that runs an edit file, all but `-o`. `arguments` must outlive the command.
void add_edit_run_options(CLI::App& command, EditRunArguments& arguments);

/// Runs the edit and writes what is asked for, once all is computed. Throws what `read_edit_file`,
/// `require_outputs`, `run_edit` and `write_mesh` throw, and Error(usage) for a mesh to save that the edit does
/// not have.
void run_edit_file(const EditRunArguments& arguments, Context context);

}  // namespace meshgraft::cli
