#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/edit/edit_file.h>
#include <meshgraft/edit/run_edit.h>
#include <meshgraft/io/mesh_io.h>

#include "choices.h"
#include "commands.h"
#include "outputs.h"
#include "summary.h"
#ifdef MESHGRAFT_HAS_RENDER
#include "picture.h"
#endif

namespace meshgraft::cli {

namespace {

struct DeformArguments {
  std::filesystem::path edit, output, report, picture;
#ifdef MESHGRAFT_HAS_RENDER
  View view{.width = picture_width, .height = picture_height};
#endif
  SettingsOverrides overrides;
  std::optional<std::string> morph_target;
  int threads = 0;
  bool json = false;
  bool force = false;
};

// A cut or a merge has no rest to go back to.
void require_morph_target(const DeformArguments& arguments, const EditFile& edit) {
  require_morph_targets(arguments.output);
  for (const EditStep& step : edit.steps)
    if (!std::holds_alternative<DeformStep>(step.action))
      throw Error(ErrorCode::usage, "the edit changes the faces, which a morph target cannot",
                  "--as-morph-target",
                  "Leave the option out, or write the cut or merged mesh first and deform that.");
}

void check_outputs(const DeformArguments& arguments, const EditFile& edit) {
  require_outputs({.mesh = arguments.output, .picture = arguments.picture, .report = arguments.report},
                  referenced_files(edit), arguments.edit, arguments.force);
  if (arguments.morph_target) require_morph_target(arguments, edit);
#ifdef MESHGRAFT_HAS_RENDER
  quick_options_of(arguments.view);
#endif
}

#ifdef MESHGRAFT_HAS_RENDER
render::Image draw(const DeformArguments& arguments, const EditResult& result, const Context& context) {
  Mesh before = result.mesh;
  before.positions = result.rest;
  const std::vector<const Mesh*> meshes{&before, &result.mesh};
  return make_picture(meshes, std::vector<std::string>{"before", "after"}, quick_options_of(arguments.view),
                      context);
}
#endif

WriteOptions write_options(const DeformArguments& arguments, const EditResult& result) {
  WriteOptions options;
  if (arguments.morph_target) options.morph_target = MorphTarget{*arguments.morph_target, result.rest};
  return options;
}

// Everything is computed before anything is written.
void write_outputs(const DeformArguments& arguments, EditResult& result, const Context& context) {
  EditReport& report = result.report;
#ifdef MESHGRAFT_HAS_RENDER
  std::optional<render::Image> picture;
  if (!arguments.picture.empty()) picture = draw(arguments, result, context);
#endif
  write_result(result, arguments.output, write_options(arguments, result), context);
#ifdef MESHGRAFT_HAS_RENDER
  if (picture) {
    render::write_png(*picture, arguments.picture);
    report.outputs.push_back(arguments.picture.string());
  }
#endif
  if (!arguments.report.empty()) {
    report.outputs.push_back(arguments.report.string());
    write_file_atomically(arguments.report, write_report(report));
  }
}

void run_deform(const DeformArguments& arguments, Context context) {
  context.threads = arguments.threads;
  const EditFile edit = read_edit_file(arguments.edit);
  check_outputs(arguments, edit);
  EditResult result = run_edit(edit, {.overrides = arguments.overrides}, context);
  write_outputs(arguments, result, context);
  if (arguments.json)
    fmt::print("{}", write_report(result.report));
  else
    print_summary(result.report, result.rest);
}

void add_overrides(CLI::App& command, SettingsOverrides& overrides) {
  add_choice<Method>(command, "--method", overrides.method,
                     {{"ft05", DeformMethod::ft05},
                      {"rotation-aware", DeformMethod::rotation_aware},
                      {"corotational", DeformMethod::corotational}},
                     "The method; overrides the edit file, as the next ones do");
  command.add_option("--stiffness", overrides.stiffness, "How strongly lengths are kept, from 0 on")
      ->type_name("X")
      ->check(number_from(0, 1e6));
  command.add_option("--iterations", overrides.iterations, "Most co-rotational steps")
      ->type_name("N")
      ->check(whole_number_from(0, 1000));
  add_choice<DegenerateTreatment>(command, "--degenerate", overrides.degenerate,
                                  {{"ft05-noise", DegenerateTreatment::ft05_noise},
                                   {"apex", DegenerateTreatment::apex},
                                   {"auto", DegenerateTreatment::automatic}},
                                  "What is done where the surface is flat");
  add_choice<WeightScheme>(command, "--weights", overrides.weights,
                           {{"uniform", WeightScheme::uniform}, {"cotangent", WeightScheme::cotangent}},
                           "Weights of the ring's vertices");
  add_choice<Density>(command, "--density", overrides.density,
                      {{"ft05", Density::ft05}, {"aware", Density::aware}},
                      "Whether rows count by number or by the size of their triangles");
  add_choice<SolverBackend>(
      command, "--backend", overrides.backend,
      {{"auto", SolverBackend::automatic},
       {"cholmod", SolverBackend::cholmod},
       {"eigen", SolverBackend::eigen},
       {"iterative", SolverBackend::iterative}},
      "The sparse solver: a Cholesky factorisation, or iterations for very large regions");
  command
      .add_option(
          "--proxy", overrides.proxy,
          "Solve a decimated proxy of about so many vertices, which the others follow: for regions that "
          "take too long or too much memory; 0: the region itself")
      ->type_name("N")
      ->check(whole_number_from(0, 1'000'000'000));
}

}  // namespace

void add_deform(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<DeformArguments>();
  CLI::App* command = program.add_subcommand("deform", "Run an edit file: deform meshes by their handles");
  command->add_option("edit", arguments->edit, "The edit file")->required()->type_name("EDIT.json");
  command->add_option("-o,--output", arguments->output, "The mesh file to write; its extension is the format")
      ->required()
      ->type_name("FILE");
  command
      ->add_option(
          "--as-morph-target", arguments->morph_target,
          "Keep the shape as it was, and add the edited one as a morph target of this name (.glb, .gltf)")
      ->type_name("NAME")
      ->expected(0, 1)
      ->default_str("edit");
  add_overrides(*command, arguments->overrides);
  add_threads(*command, arguments->threads);
  command->add_option("--report", arguments->report, "Write what was done, with measures of quality, as JSON")
      ->type_name("FILE");
#ifdef MESHGRAFT_HAS_RENDER
  add_picture(*command, arguments->picture, arguments->view, "Write a PNG of the mesh before and after");
#endif
  command->add_flag("--force,--in-place", arguments->force, "Allow the output to replace an input mesh");
  command->add_flag("--json", arguments->json, "Print the report instead of a summary");
  command->footer("Example:\n  meshgraft deform examples/octopus_wave.json -o waving.ply --report report.json");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_deform(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
