#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "choices.h"
#include "cli/facts.h"
#include "commands.h"
#include "core/facts.h"
#include "edit_run.h"
#include "io/file.h"
#include "outputs.h"
#include "picture.h"
#include "script/compare.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

struct CompareArguments {
  std::filesystem::path edit, folder;
  std::string methods;  // separated by commas; empty = all
  int threads = 0;
  std::uint64_t memory = 0;
  bool json = false;
#ifdef MESHGRAFT_HAS_RENDER
  View view{.width = 800, .height = 600};
#endif
};

std::vector<Contender> methods_of(const std::string& list) {
  if (list.empty()) return all_contenders();
  std::vector<Contender> methods;
  for (const std::string& name : CLI::detail::split(list, ',')) methods.push_back(contender_named(name));
  return methods;
}

// Returns the extension of the mesh file that the edit's result is based on. Returns ".ply" if that mesh is a
// sample.
std::string mesh_extension(const EditFile& edit) {
  std::string name = edit.output.empty() ? outcome_of(edit.steps.back()) : edit.output;
  for (auto step = edit.steps.rbegin(); step != edit.steps.rend(); ++step)
    if (outcome_of(*step) == name) name = mesh_of(*step);
  const auto input = std::find_if(edit.inputs.begin(), edit.inputs.end(),
                                  [&](const EditInput& candidate) { return candidate.name == name; });
  if (input == edit.inputs.end() || input->file.empty()) return ".ply";
  return std::filesystem::path(input->file).extension().string();
}

// The files that a comparison writes into its folder.
struct ComparisonFiles {
  std::filesystem::path folder;
  std::string extension;

  std::filesystem::path text() const { return folder / "compare.md"; }
  std::filesystem::path json() const { return folder / "compare.json"; }
  std::filesystem::path sheet() const { return folder / "compare.png"; }
  std::filesystem::path mesh(const Contender& method) const { return folder / (name(method) + extension); }
  std::filesystem::path picture(const Contender& method) const { return folder / (name(method) + ".png"); }

  std::vector<std::filesystem::path> all(const std::vector<Contender>& methods) const {
    std::vector<std::filesystem::path> files{text(), json(), sheet()};
    for (const Contender& method : methods) {
      files.push_back(mesh(method));
      files.push_back(picture(method));
    }
    return files;
  }

 private:
  static std::string name(const Contender& method) { return std::string(to_string(method)); }
};

bool is_comparison(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return false;
  const auto json = nlohmann::json::parse(read_file(file), nullptr, false);
  return json.is_object() && json.contains("format") && json["format"] == "meshgraft-comparison";
}

// Refuses to replace an input. Files in the folder may be replaced only if an earlier comparison wrote them.
void require_ours(const ComparisonFiles& files, const std::vector<Contender>& methods,
                  const CompareArguments& arguments, const EditFile& edit) {
  if (!std::filesystem::exists(files.folder)) return require_writable(files.folder);
  if (!std::filesystem::is_directory(files.folder)) throw Error(facts::cli::NotAFolder{}, files.folder);
  std::vector<std::filesystem::path> inputs = referenced_files(edit);
  inputs.push_back(arguments.edit);
  const bool ours = is_comparison(files.json());
  for (const std::filesystem::path& file : files.all(methods)) {
    require_not_an_input(file, inputs, facts::cli::FolderHoldsInput{});
    require_writable(file);
    if (!ours && std::filesystem::exists(std::filesystem::symlink_status(file)))
      throw Error(facts::cli::FolderNotOurs{}, file);
  }
}

#ifdef MESHGRAFT_HAS_RENDER
struct Pictures {
  std::vector<render::Image> of_methods;  // one per method that has a result
  render::Image sheet;                    // all methods, the rest shape first
};

Pictures draw(const Comparison& comparison, const View& view, const Context& context) {
  std::vector<const Mesh*> meshes{nullptr};
  std::vector<std::string> captions{"rest"};
  Mesh rest;
  for (const MethodOutcome& outcome : comparison.outcomes) {
    if (!outcome.result) continue;
    if (rest.vertex_count() == 0) {
      rest = outcome.result->mesh;
      rest.positions = outcome.result->rest;
    }
    meshes.push_back(&outcome.result->mesh);
    captions.emplace_back(to_string(outcome.method));
  }
  meshes.front() = &rest;
  render::RenderOptions options = options_of(view, rest);
  if (meshes.size() > 1) look_at_change(options.camera, meshes, view, context);
  std::vector<render::Image> images = make_pictures(meshes, options, context);
  Pictures pictures;
  pictures.sheet = contact_sheet(images, captions, 4);
  images.erase(images.begin());
  pictures.of_methods = std::move(images);
  return pictures;
}
#endif

// Composes the Markdown text: the table, and links to the meshes and pictures in the folder.
std::string comparison_text(const Comparison& comparison, const ComparisonFiles& files) {
  std::string text = fmt::format("# {} by several methods\n\n", comparison.edit);
  const EditReport* any = nullptr;
  for (const MethodOutcome& outcome : comparison.outcomes)
    if (outcome.result && any == nullptr) any = &outcome.result->report;
  for (const EditReport::Input& input : any->inputs)
    text += fmt::format("{}: {} vertices, {} faces.\n", input.source, input.vertices, input.faces);
  text += fmt::format("{} free vertices follow {} held by handles; {} stay fixed.\n\n", any->counts.free,
                      any->counts.handle, any->counts.fixed);
#ifdef MESHGRAFT_HAS_RENDER
  text += fmt::format("![At rest, and by each method]({})\n\n", files.sheet().filename().string());
#endif
  text += comparison_table(comparison, text_of);
  for (const MethodOutcome& outcome : comparison.outcomes) {
    if (!outcome.result) continue;
    const std::string mesh = files.mesh(outcome.method).filename().string();
    text += fmt::format("\n## {}\n\n[{}]({})\n", to_string(outcome.method), mesh, mesh);
#ifdef MESHGRAFT_HAS_RENDER
    text += fmt::format("\n![{}]({})\n", to_string(outcome.method),
                        files.picture(outcome.method).filename().string());
#endif
  }
  return text;
}

// Computes everything before anything is written. Once begun, writing cannot be cancelled.
void write_folder(Comparison& comparison, const ComparisonFiles& files,
                  [[maybe_unused]] const CompareArguments& arguments, const Context& context) {
#ifdef MESHGRAFT_HAS_RENDER
  const Pictures pictures = draw(comparison, arguments.view, context);
#endif
  context.step("write");
  Context unstoppable = context;
  unstoppable.stop_token = {};
  std::error_code failure;
  std::filesystem::create_directory(files.folder, failure);
  if (failure) throw Error(facts::core::FileSystem{.reason = failure.message()}, files.folder);
  comparison.outputs = {files.json().string(), files.text().string()};
#ifdef MESHGRAFT_HAS_RENDER
  comparison.outputs.push_back(files.sheet().string());
#endif
  for (MethodOutcome& outcome : comparison.outcomes) {
    if (!outcome.result) continue;
    outcome.result->report.outputs = {files.mesh(outcome.method).string()};
#ifdef MESHGRAFT_HAS_RENDER
    outcome.result->report.outputs.push_back(files.picture(outcome.method).string());
#endif
  }
  // First the file that marks the folder as ours.
  write_file_atomically(files.json(), write_comparison(comparison, text_of), unstoppable);
  write_file_atomically(files.text(), comparison_text(comparison, files), unstoppable);
#ifdef MESHGRAFT_HAS_RENDER
  render::write_png(pictures.sheet, files.sheet());
  auto picture = pictures.of_methods.begin();
#endif
  for (const MethodOutcome& outcome : comparison.outcomes) {
    if (!outcome.result) continue;
    write_mesh(outcome.result->mesh, files.mesh(outcome.method), {}, unstoppable);
#ifdef MESHGRAFT_HAS_RENDER
    render::write_png(*picture++, files.picture(outcome.method));
#endif
  }
}

void run_compare(const CompareArguments& arguments, Context context) {
  context.threads = arguments.threads;
  context.memory = arguments.memory;
  const std::vector<Contender> methods = methods_of(arguments.methods);
  const EditFile edit = read_given_edit(arguments.edit);
  const bool ends_in_slash = !arguments.folder.has_filename();
  const ComparisonFiles files{ends_in_slash ? arguments.folder.parent_path() : arguments.folder,
                              mesh_extension(edit)};
  if (!arguments.folder.empty()) require_ours(files, methods, arguments, edit);
  Comparison comparison = compare_methods(edit, methods, context);
  if (!arguments.folder.empty()) write_folder(comparison, files, arguments, context);
  if (arguments.json) {
    fmt::print("{}", write_comparison(comparison, text_of));
    return;
  }
  fmt::print("{}", comparison_table(comparison, text_of));
  if (!arguments.folder.empty()) fmt::print("\nwrote {}\n", files.text().string());
}

}  // namespace

void add_compare(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command = program.add_subcommand("compare", "Run an edit file by several methods, side by side");
  command->add_option("edit", arguments->edit, "The edit file")->required()->type_name("EDIT.json");
  std::vector<std::string> names;
  for (const Contender& method : all_contenders()) names.emplace_back(to_string(method));
  command->add_option("--methods", arguments->methods, "Some of them, separated by commas (default: all)")
      ->type_name(CLI::detail::join(names, "|"));
  [[maybe_unused]] CLI::Option* folder =
      command->add_option("-o,--output", arguments->folder, "A folder for tables, meshes and pictures")
          ->type_name("FOLDER");
#ifdef MESHGRAFT_HAS_RENDER
  for (CLI::Option* option : add_view(*command, arguments->view, "one that shows what changed"))
    option->needs(folder);
#endif
  add_threads(*command, arguments->threads);
  add_memory(*command, arguments->memory);
  command->add_flag("--json", arguments->json, "Print JSON instead of the table");
  command->footer(
      "Example:\n  meshgraft compare examples/octopus_wave.json --methods corotational,ft05,arap-2007 -o "
      "octopus");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_compare(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
