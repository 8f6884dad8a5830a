// meshgraft-mpi: runs one deform edit, or a conversion, on all ranks of mpirun.
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>

#include "cli/choices.h"
#include "cli/exit_status.h"
#include "cli/facts.h"
#include "cli/outputs.h"
#include "cli/wording.h"
#include "distributed/convert_mesh.h"
#include "distributed/run_step.h"
#include "distributed/session.h"
#include "distributed/stored_mesh.h"

namespace {

using namespace meshgraft;

struct Arguments {
  bool converts = false;
  distributed::ConvertRequest convert;
  distributed::RunRequest request;
  std::string petsc;  ///< options of PETSc, in its own words
  std::optional<Preconditioner> preconditioner;
  std::optional<DeformMethod> method;
};

void add_convert(CLI::App& program, Arguments& arguments) {
  CLI::App& convert = *program.add_subcommand(
      "convert", "Convert between a binary PLY file and a mesh in chunks, in constant memory");
  convert.footer("Example:\n  mpirun -n 4 meshgraft-mpi convert mesh.ply -o mesh.chunks");
  distributed::ConvertRequest& request = arguments.convert;
  convert.add_option("input", request.input, "The mesh: a binary PLY file, or a folder NAME.chunks")
      ->required()
      ->type_name("MESH");
  convert.add_option("-o,--output", request.output, "The mesh to write: NAME.ply or NAME.chunks")
      ->required()
      ->type_name("MESH");
  convert
      .add_option("--records-per-file", request.records_per_file,
                  "The most records in a file of chunks (16777216)")
      ->type_name("NUMBER")
      ->check(cli::whole_number_from(1, std::numeric_limits<int>::max()));
  convert.add_flag("--force", request.force, "A PLY file may replace the input");
  convert.callback([&arguments] { arguments.converts = true; });
}

void add_arguments(CLI::App& program, Arguments& arguments) {
  program.set_version_flag("--version", "meshgraft-mpi " MESHGRAFT_VERSION, "Print the version");
  program.set_help_flag("-h,--help", "Print this help");
  program.require_subcommand(1);
  program.footer("Example:\n  mpirun -n 4 meshgraft-mpi deform edit.json -o out.ply --report report.json");
  CLI::App& deform = *program.add_subcommand("deform", "Deform a mesh by its handles, on all ranks together");
  distributed::RunRequest& request = arguments.request;
  deform
      .add_option("edit", request.edit,
                  "The edit file: one deform step on a binary PLY file or a mesh in chunks")
      ->required()
      ->type_name("EDIT.json");
  deform.add_option("-o,--output", request.output, "The mesh to write, in the format of the input")
      ->required()
      ->type_name("MESH");
  deform.add_option("--report", request.report, "Write a report as JSON")->type_name("FILE");
  deform.add_flag("--force", request.force, "The output may replace the input");
  cli::add_choice<DeformMethod>(deform, "--method", arguments.method,
                                {{"ft05", DeformMethod::ft05},
                                 {"rotation-aware", DeformMethod::rotation_aware},
                                 {"corotational", DeformMethod::corotational}},
                                "The method, in place of the edit's");
  cli::add_as_published(deform, request.overrides.preset);
  cli::add_choice<Preconditioner>(deform, "--preconditioner", arguments.preconditioner,
                                  {{"blended", Preconditioner::blended},
                                   {"gamg", Preconditioner::gamg},
                                   {"hypre", Preconditioner::hypre},
                                   {"mumps", Preconditioner::mumps}},
                                  "The preconditioner of the solve (blended)");
  deform
      .add_option("--tolerance", request.tolerance,
                  "The relative error of the solve, in the energy norm (1e-8)")
      ->type_name("NUMBER")
      ->check(cli::number_from(1e-14, 0.1));
  deform.add_option("--petsc", arguments.petsc, "Options of PETSc, such as \"-ksp_monitor -log_view\"")
      ->type_name("OPTIONS");
}

/// Parses the command line. Returns the exit status if nothing is left to do. Only the first rank prints help.
std::optional<int> parse(CLI::App& program, int argc, char** argv, bool prints) {
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& end) {
    if (end.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success))
      throw Error(facts::cli::CommandLine{.reason = end.what(), .command = "meshgraft-mpi"});
    if (prints) program.exit(end);
    return 0;
  }
  return {};
}

int run_program(const distributed::Session& session, int argc, char** argv) {
  CLI::App program("Mesh editing on many ranks: one deform edit over MPI.", "meshgraft-mpi");
  Arguments arguments;
  add_arguments(program, arguments);
  add_convert(program, arguments);
  if (const auto status = parse(program, argc, argv, session.is_first())) return *status;
  if (arguments.converts) {
    distributed::convert_mesh(session.comm(), arguments.convert);
    return 0;
  }
  session.start_solvers(arguments.petsc);
  if (arguments.preconditioner) arguments.request.preconditioner = *arguments.preconditioner;
  distributed::RunRequest& request = arguments.request;
  if (arguments.method) request.overrides.method = *arguments.method;
  request.check_outputs = [&request](const std::filesystem::path& input) {
    cli::Outputs outputs{.report = request.report};
    if (!distributed::names_chunks(request.output)) outputs.mesh = request.output;
    cli::require_outputs(outputs, {input}, request.edit, request.force);
  };
  distributed::run_distributed(session.comm(), request, cli::text_of);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const distributed::Session session(argc, argv);
  try {
    return run_program(session, argc, argv);
  } catch (...) {
    const Error error = current_error();
    const int status = cli::exit_status(error.code());
    constexpr double patience = 5;  // seconds: ranks that fail together arrive at once
    const bool together = session.all_arrive(patience);
    if (!together || session.is_first()) fmt::print(stderr, "meshgraft-mpi: error: {}\n", cli::sentence(error));
    if (!together) session.abort(status);
    return status;
  }
}
