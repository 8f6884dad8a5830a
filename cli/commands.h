#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include <meshgraft/core/context.h>

namespace meshgraft::cli {

/// The work of the chosen command. It runs once the whole command line has been read.
using Action = std::function<void(const Context&)>;

/// Thrown by a command that did its work and whose result is an exit status.
struct Answer {
  int status = 0;
};

// Each function adds one command to the program. The command sets `action` when it is chosen.
void add_info(CLI::App& program, Action& action);
void add_check(CLI::App& program, Action& action);
void add_repair(CLI::App& program, Action& action);
void add_run(CLI::App& program, Action& action);
void add_deform(CLI::App& program, Action& action);
void add_compare(CLI::App& program, Action& action);
void add_cut(CLI::App& program, Action& action);
void add_loops(CLI::App& program, Action& action);
void add_merge(CLI::App& program, Action& action);
void add_sample(CLI::App& program, Action& action);
void add_edit(CLI::App& program, Action& action);    ///< only where the editor was built
void add_render(CLI::App& program, Action& action);  ///< only where the renderer was built
void add_completion(CLI::App& program, Action& action);
void add_man(CLI::App& program, Action& action);

}  // namespace meshgraft::cli
