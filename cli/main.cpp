#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>

#include "blas_kernels.h"
#include "command_tree.h"
#include "commands.h"
#include "interrupt.h"
#include "progress_bar.h"

namespace {

using namespace meshgraft;

void add_commands(CLI::App& program, cli::Action& action) {
  program.set_version_flag("--version", "meshgraft " MESHGRAFT_VERSION, "Print the version");
  program.set_help_flag("-h,--help", "Print this help");
  program.require_subcommand(1);
  program.get_formatter()->column_width(34);
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

int fail(const std::string& message, ErrorCode code) {
  fmt::print(stderr, "meshgraft: error: {}\n", message);
  return exit_status(code);
}

std::string known_commands(const CLI::App& program) {
  std::string names;
  for (const CLI::App* command : cli::commands_of(program))
    names += (names.empty() ? "" : ", ") + command->get_name();
  return names;
}

// Returns the exit status for the end of parsing. Help and version are no errors; all other exceptions of the
// parser are.
int end_of_parsing(const CLI::App& program, const CLI::ParseError& error) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return program.exit(error);
  std::string command = "meshgraft";
  if (const auto words = program.remaining(); program.get_subcommands().empty() && !words.empty())
    return fail(
        fmt::format("'{}' is not a command. The commands are {}.", words.front(), known_commands(program)),
        ErrorCode::usage);
  for (const CLI::App* chosen : program.get_subcommands()) command += " " + chosen->get_name();
  return fail(fmt::format("{}. Try '{} --help'.", error.what(), command), ErrorCode::usage);
}

void run(const cli::Action& action) {
  cli::Interrupt interrupt;
  cli::ProgressBar progress;
  Context context;
  context.stop_token = interrupt.token();
  context.progress = [&](std::string_view stage, double fraction) { progress.update(stage, fraction); };
  action(context);
}

// Checks that all output was written. A full disk counts as a failure, too.
void require_printed() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout))
    throw Error(ErrorCode::io, "cannot write to standard output");
}

}  // namespace

int main(int argc, char** argv) {
  cli::restart_with_better_blas_kernels(argv);
  CLI::App program("Mesh editing with affine-invariant Laplacian coordinates.", "meshgraft");
  cli::Action action;
  try {
    add_commands(program, action);
    program.parse(argc, argv);
    int status = 0;
    try {
      run(action);
    } catch (const cli::Answer& answer) {
      status = answer.status;
    }
    require_printed();
    return status;
  } catch (const CLI::ParseError& error) {
    const int status = end_of_parsing(program, error);
    return status == 0 && (std::fflush(stdout) != 0 || std::ferror(stdout))
               ? fail("cannot write to standard output", ErrorCode::io)
               : status;
  } catch (const Error& error) {
    return fail(error.what(), error.code());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(fmt::format("{}: {}. Check the path, and where links in it lead.", error.path1().string(),
                            error.code().message()),
                ErrorCode::io);
  } catch (const std::system_error& error) {
    return fail(error.what(), ErrorCode::io);
  } catch (const std::bad_alloc&) {
    return fail("not enough memory. Close other programs, or take a smaller mesh.", ErrorCode::memory);
  } catch (const std::exception& error) {
    if (std::string_view(error.what()).starts_with("pthread_create"))  // thrown by oneTBB
      return fail("no threads could be started. Give the program more memory.", ErrorCode::memory);
    return fail(fmt::format("{} (a defect of meshgraft; please report it)", error.what()), ErrorCode::internal);
  }
}
