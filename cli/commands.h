#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include <meshgraft/core/context.h>

namespace meshgraft::cli {

/// What the chosen command does, once the whole command line has been read.
using Action = std::function<void(const Context&)>;

/// Thrown by a command that did its work, and whose exit status is the answer.
struct Answer {
  int status = 0;
};

// Each adds one command to the program and, when it is chosen, sets `action`.
void add_info(CLI::App& program, Action& action);
void add_check(CLI::App& program, Action& action);
void add_repair(CLI::App& program, Action& action);
void add_run(CLI::App& program, Action& action);
void add_deform(CLI::App& program, Action& action);
void add_compare(CLI::App& program, Action& action);
void add_cut(CLI::App& program, Action& action);
void add_merge(CLI::App& program, Action& action);
void add_sample(CLI::App& program, Action& action);
void add_edit(CLI::App& program, Action& action);    ///< only where the editor was built
void add_render(CLI::App& program, Action& action);  ///< only where the renderer was built
void add_completion(CLI::App& program, Action& action);
void add_man(CLI::App& program, Action& action);

}  // namespace meshgraft::cli
