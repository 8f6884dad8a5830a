#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace meshgraft::cli {

/// Returns the program's commands in their order.
inline std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

/// Returns a command's options that begin with a dash. The other options are its arguments.
inline std::vector<const CLI::Option*> dashed_options(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

inline std::vector<const CLI::Option*> arguments_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

/// Returns all spellings of an option, for example "-o" and "--output".
inline std::vector<std::string> spellings(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// Returns whether a value follows the option.
inline bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

}  // namespace meshgraft::cli
