#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>

#include "blas_kernels.h"
#include "cli/facts.h"
#include "command_tree.h"
#include "commands.h"
#include "exit_status.h"
#include "help_formatter.h"
#include "interrupt.h"
#include "progress_bar.h"
#include "wording.h"

namespace {

using namespace meshgraft;

void add_commands(CLI::App& program, cli::Action& action) {
  program.set_version_flag("--version", "meshgraft " MESHGRAFT_VERSION, "Print the version");
  program.set_help_flag("-h,--help", "Print this help");
  program.require_subcommand(1);
  const auto formatter = std::make_shared<cli::HelpFormatter>();
  formatter->column_width(34);
  program.formatter(formatter);  // commands that are added take it over
  program.footer(
      "Example:\n  meshgraft sample octopus -o octopus.ply\n\n"
      "'meshgraft COMMAND --help' tells more about a command.");
  cli::add_info(program, action);
  cli::add_check(program, action);
  cli::add_repair(program, action);
  cli::add_run(program, action);
  cli::add_deform(program, action);
  cli::add_compare(program, action);
  cli::add_cut(program, action);
  cli::add_loops(program, action);
  cli::add_merge(program, action);
  cli::add_sample(program, action);
#ifdef MESHGRAFT_HAS_EDITOR
  cli::add_edit(program, action);
#endif
#ifdef MESHGRAFT_HAS_RENDER
  cli::add_render(program, action);
#endif
  cli::add_completion(program, action);
  cli::add_man(program, action);
}

// Checks that all output was written. A full disk counts as a failure, too.
void require_printed() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout)) throw Error(facts::cli::CannotPrint{});
}

// Refuses empty values, as of -o "$UNSET". Throws Error(usage) that names the option.
void require_values(const CLI::App& program) {
  for (const CLI::App* command : program.get_subcommands())
    for (const CLI::Option* option : command->get_options())
      if (std::ranges::find(option->results(), std::string()) != option->results().end())
        throw Error(facts::cli::EmptyValue{}, Location::place(option->get_name()));
}

// Prints help or the version, which the parser throws, too. Throws Error(usage) for its other exceptions.
void end_parsing(const CLI::App& program, const CLI::ParseError& end) {
  if (end.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    program.exit(end);
    return;
  }
  std::string command = "meshgraft";
  if (const auto words = program.remaining(); program.get_subcommands().empty() && !words.empty()) {
    std::vector<std::string> known;
    for (const CLI::App* one : cli::commands_of(program)) known.push_back(one->get_name());
    throw Error(facts::cli::NoSuchCommand{.command = words.front(), .commands = known});
  }
  for (const CLI::App* chosen : program.get_subcommands()) command += " " + chosen->get_name();
  throw Error(facts::cli::CommandLine{.reason = end.what(), .command = command});
}

void run(const cli::Action& action) {
  cli::Interrupt interrupt;
  cli::ProgressBar progress;
  Context context;
  context.stop_token = interrupt.token();
  context.progress = [&](const Progress& report) { progress.update(report); };
  action(context);
}

// Returns the exit status of the command line.
int run_program(CLI::App& program, int argc, char** argv) {
  cli::Action action;
  int status = 0;
  try {
    add_commands(program, action);
    program.parse(argc, argv);
    require_values(program);
    run(action);
  } catch (const CLI::ParseError& end) {
    end_parsing(program, end);
  } catch (const cli::Answer& answer) {
    status = answer.status;
  }
  require_printed();
  return status;
}

// Returns the exception that is being handled as an error of the command line.
Error error_of_program() {
  try {
    throw;
  } catch (const std::filesystem::filesystem_error&) {
    return current_error();
  } catch (const std::system_error& error) {  // standard output, or a thread
    return Error(facts::cli::SystemCall{.reason = error.what()});
  } catch (const std::exception&) {
    return current_error();
  }
}

}  // namespace

int main(int argc, char** argv) {
  cli::restart_with_better_blas_kernels(argv);
  CLI::App program("Mesh editing with affine-invariant Laplacian coordinates.", "meshgraft");
  try {
    return run_program(program, argc, argv);
  } catch (const std::exception&) {
    const Error error = error_of_program();
    fmt::print(stderr, "meshgraft: error: {}\n", cli::sentence(error));
    return cli::exit_status(error.code());
  }
}
