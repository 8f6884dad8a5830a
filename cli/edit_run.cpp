#include "edit_run.h"

#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/edit_file.h>

#include "choices.h"
#include "cli/facts.h"
#include "edit_picture.h"
#include "io/file.h"
#include "outputs.h"
#include "script/facts.h"
#include "selection_text.h"
#include "summary.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

bool keeps_faces(const EditFile& edit) {
  return std::all_of(edit.steps.begin(), edit.steps.end(), [](const EditStep& step) {
    return std::holds_alternative<DeformStep>(step.action) || std::holds_alternative<SculptStep>(step.action);
  });
}

// Checks that the edit can be written as a morph target. A cut or a merge has no rest shape with the same
// faces.
void require_morph_target(const EditRunArguments& arguments, const EditFile& edit) {
  if (arguments.output.empty()) throw Error(facts::cli::MorphTargetWithoutOutput{});
  require_morph_targets(arguments.output);
  if (!keeps_faces(edit)) throw Error(facts::cli::MorphTargetOfOtherFaces{}, "--as-morph-target");
}

// Adds the features of the command line to all deform steps.
void add_features(const std::vector<std::string>& features, EditFile& edit) {
  for (const std::string& text : features) {
    EditSelection selection = selection_from(text, {0}, "--feature");
    if (auto* file = std::get_if<EditSelection::IndexFile>(&selection.kind))
      file->file = std::filesystem::absolute(file->file).generic_string();  // not relative to the edit file
    for (EditStep& step : edit.steps)
      if (auto* deform = std::get_if<DeformStep>(&step.action)) deform->features.push_back({selection});
  }
}

// Returns the error with the option as its location if it is of a feature that add_features() added.
Error in_words_of_features(const Error& error, const std::vector<std::string>& features, const EditFile& edit) {
  const std::span<const LocationPart> parts = error.location().parts();
  if (parts.size() < 5 || parts[1].name != "steps" || parts[3].name != "features") return error;
  const auto* step = std::get_if<DeformStep>(&edit.steps.at(parts[2].index).action);
  if (step == nullptr) return error;
  const std::size_t own = step->features.size() - features.size();
  if (parts[4].index < own) return error;
  return error.at(at_option(error.location(), 5, "--feature " + features[parts[4].index - own]));
}

// A mesh of the edit to be saved after the last step, and its file.
struct Save {
  std::string name;
  std::filesystem::path file;
};

std::vector<Save> saves_of(const EditRunArguments& arguments, const EditFile& edit) {
  const std::vector<std::string> known = mesh_names(edit);
  std::vector<Save> saves;
  for (const std::string& text : arguments.saves) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
      throw Error(facts::cli::NotASave{.text = text}, "--save");
    saves.push_back({text.substr(0, sign), text.substr(sign + 1)});
    if (std::find(known.begin(), known.end(), saves.back().name) == known.end())
      throw Error(facts::script::NoMeshToKeep{.name = saves.back().name, .known = known}, "--save");
  }
  return saves;
}

void check_outputs(const EditRunArguments& arguments, const std::vector<Save>& saves, const EditFile& edit) {
  Outputs outputs{.mesh = arguments.output, .picture = arguments.picture, .report = arguments.report};
  for (const Save& save : saves) outputs.more_meshes.push_back(save.file);
  require_outputs(outputs, referenced_files(edit), arguments.edit, arguments.force);
  if (arguments.morph_target) require_morph_target(arguments, edit);
#ifdef MESHGRAFT_HAS_RENDER
  check_view(arguments.view);
#endif
}

#ifdef MESHGRAFT_HAS_RENDER
// Draws the mesh before and after the edit. If the edit changes the faces, draws the inputs and the result.
render::Image draw(const EditRunArguments& arguments, const EditFile& edit, const EditResult& result,
                   const Context& context) {
  if (!keeps_faces(edit)) return picture_of_parts(edit, result.mesh, arguments.view, context);
  Mesh before = result.mesh;
  before.positions = result.rest;
  return make_comparison(before, result.mesh, arguments.view, context);
}
#endif

void write_meshes(const EditRunArguments& arguments, const std::vector<Save>& saves, EditResult& result,
                  const Context& context) {
  WriteOptions options;
  if (arguments.morph_target) options.morph_target = MorphTarget{*arguments.morph_target, result.rest};
  if (!arguments.output.empty())
    write_and_report(result.mesh, arguments.output, result.report, options, context);
  for (const Save& save : saves)
    write_and_report(result.kept.at(save.name), save.file, result.report, {}, context);
}

// Computes everything before anything is written.
void write_outputs(const EditRunArguments& arguments, const std::vector<Save>& saves,
                   [[maybe_unused]] const EditFile& edit, EditResult& result, const Context& context) {
  EditReport& report = result.report;
#ifdef MESHGRAFT_HAS_RENDER
  std::optional<render::Image> picture;
  if (!arguments.picture.empty()) picture = draw(arguments, edit, result, context);
#endif
  write_meshes(arguments, saves, result, context);
#ifdef MESHGRAFT_HAS_RENDER
  if (picture) {
    render::write_png(*picture, arguments.picture);
    report.outputs.push_back(arguments.picture.string());
  }
#endif
  if (!arguments.report.empty()) {
    report.outputs.push_back(arguments.report.string());
    write_file_atomically(arguments.report, write_report(report, text_of), context);
  }
}

/// Adds `--backend`, which still accepts 'cholmod', an earlier name of `multifrontal`.
void add_backend(CLI::App& command, EditRunArguments& arguments) {
  add_choice<SolverBackend>(command, "--backend", arguments.run.overrides.backend,
                            {{"auto", SolverBackend::automatic},
                             {"multifrontal", SolverBackend::multifrontal},
                             {"eigen", SolverBackend::eigen},
                             {"iterative", SolverBackend::iterative}},
                            "The sparse solver: a Cholesky factorisation, or iterations for very large regions")
      ->transform([&arguments](const std::string& word) -> std::string {
        if (word != "cholmod") return word;
        arguments.notes = {
            facts::script::FormerBackend{.location = "--backend", .former = word, .name = "multifrontal"}};
        return "multifrontal";
      });
}

void add_overrides(CLI::App& command, EditRunArguments& arguments) {
  SettingsOverrides& overrides = arguments.run.overrides;
  add_as_published(command, overrides.preset);
  add_choice<Method>(command, "--method", overrides.method,
                     {{"ft05", DeformMethod::ft05},
                      {"rotation-aware", DeformMethod::rotation_aware},
                      {"corotational", DeformMethod::corotational},
                      {"shell", DeformMethod::shell}},
                     "The method; overrides the edit file, as the next ones do");
  command.add_option("--stiffness", overrides.stiffness, "How strongly lengths are kept, from 0 on")
      ->type_name("X")
      ->check(number_from(0, 1e6));
  command.add_option("--iterations", overrides.iterations, "Most co-rotational iterations")
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
  add_backend(command, arguments);
  command
      .add_option(
          "--proxy", overrides.proxy,
          "Solve a decimated proxy of about so many vertices, which the others follow: for regions that "
          "take too long or too much memory; 0: the region itself")
      ->type_name("N")
      ->check(whole_number_from(0, 1'000'000'000));
}

}  // namespace

EditFile read_given_edit(const std::filesystem::path& file) {
  if (std::filesystem::is_regular_file(file) && names_a_mesh(file))
    throw Error(facts::cli::MeshForEdit{.mesh = file.string()}, file);
  return read_edit_file(file);
}

void add_edit_run_options(CLI::App& command, EditRunArguments& arguments) {
  command.add_option("edit", arguments.edit, "The edit file")->required()->type_name("EDIT.json");
  command
      .add_option(
          "--as-morph-target", arguments.morph_target,
          "Keep the shape as it was, and add the edited one as a morph target (.glb, .gltf) of this name "
          "(default: edit)")
      ->type_name("NAME")
      ->expected(0, 1)
      ->default_str("edit");
  add_overrides(command, arguments);
  command
      .add_option(
          "--feature", arguments.features,
          fmt::format("What keeps its shape up to one similarity, in all deform steps: {}, or JSON as in "
                      "an edit file; repeatable",
                      fmt::join(selection_forms, ", ")))
      ->type_name("SELECTION");
  add_threads(command, arguments.threads);
  add_memory(command, arguments.memory);
  command.add_option("--report", arguments.report, "Write what was done, with measures of quality, as JSON")
      ->type_name("FILE");
  command.add_flag("--condition", arguments.run.estimate_condition,
                   "Estimate the condition number of the equations for the report, by up to ten more solves");
#ifdef MESHGRAFT_HAS_RENDER
  add_picture(command, arguments.picture, arguments.view, "Write a PNG of the mesh before and after");
#endif
  command.add_flag("--force,--in-place", arguments.force, "Allow the output to replace an input mesh");
  command.add_flag("--json", arguments.json, "Print the report instead of a summary");
}

void run_edit_file(const EditRunArguments& arguments, Context context) {
  context.threads = arguments.threads;
  context.memory = arguments.memory;
  EditFile edit = read_given_edit(arguments.edit);
  add_features(arguments.features, edit);
  const std::vector<Save> saves = saves_of(arguments, edit);
  check_outputs(arguments, saves, edit);
  RunOptions options = arguments.run;
  for (const Save& save : saves) options.keep.push_back(save.name);
  EditResult result = [&] {
    try {
      return run_edit(edit, options, context);
    } catch (const Error& error) {
      throw in_words_of_features(error, arguments.features, edit);
    }
  }();
  std::vector<Note>& notes = result.report.notes;
  notes.insert(notes.begin(), arguments.notes.begin(), arguments.notes.end());
  write_outputs(arguments, saves, edit, result, context);
  if (arguments.json)
    fmt::print("{}", write_report(result.report, text_of));
  else
    print_summary(edit, result.report, result.rest);
}

}  // namespace meshgraft::cli
