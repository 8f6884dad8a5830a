#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/script/report.h>

#include "choices.h"
#include "cli/facts.h"
#include "commands.h"
#include "findings.h"
#include "io/file.h"
#include "outputs.h"
#include "picture.h"
#include "script/fact_json.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

using Json = nlohmann::ordered_json;

struct RepairArguments {
  int threads = 0;
  std::uint64_t memory = 0;
  std::filesystem::path mesh, output, report, picture;
  // The steps that the command line switches off, and the values that it sets.
  bool no_clean = false, no_weld = false, keep_shells = false, keep_debris = false, no_split = false,
       no_winding = false, keep_isolated = false;
  std::optional<double> weld_distance, debris_size;
  std::optional<int> hole_edges;
  std::optional<HoleFill> hole_fill;
  bool dry_run = false, json = false, force = false;
#ifdef MESHGRAFT_HAS_RENDER
  View view{.width = picture_width, .height = picture_height};
#endif
};

RepairOptions repair_options_of(const RepairArguments& arguments) {
  RepairOptions options;
  options.clean_faces = !arguments.no_clean;
  options.weld = !arguments.no_weld;
  options.weld_distance = arguments.weld_distance;
  options.remove_duplicate_shells = !arguments.keep_shells;
  options.remove_debris = !arguments.keep_debris;
  if (arguments.debris_size) options.debris_rel = *arguments.debris_size;
  options.split_non_manifold = !arguments.no_split;
  options.unify_winding = !arguments.no_winding;
  if (arguments.hole_edges) options.hole_edges = arguments.hole_edges;
  if (arguments.hole_fill) options.hole_fill = *arguments.hole_fill;
  options.remove_isolated = !arguments.keep_isolated;
  return options;
}

// The files that were written, and notes on the data that the mesh's format cannot hold.
struct WrittenRepair {
  std::vector<std::string> files;
  std::vector<Note> notes;
};

Json report_json(const RepairArguments& arguments, const Mesh& given, const RepairResult& result,
                 const Diagnostics& left, const WrittenRepair& written, bool with_maps) {
  Json changes = Json::array();
  for (const RepairChange& change : result.changes) {
    changes.push_back(change_json(change));
    changes.back()["indices"] = change.indices;
  }
  std::vector<Note> notes = result.notes;
  notes.insert(notes.end(), written.notes.begin(), written.notes.end());
  Json json = {{"format", "meshgraft-repair"},
               {"version", 1},
               {"program", std::string("meshgraft ") + MESHGRAFT_VERSION},
               {"mesh", arguments.mesh.string()},
               {"outputs", written.files},
               {"changed", result.changed()},
               {"before", {{"vertices", given.vertex_count()}, {"faces", given.face_count()}}},
               {"after", {{"vertices", result.mesh.vertex_count()}, {"faces", result.mesh.face_count()}}},
               {"changes", changes},
               {"notes", to_json(notes, text_of)},
               {"findings", Json::parse(write_diagnostics(left, text_of))}};
  if (with_maps)
    json["maps"] = {{"vertices", result.vertex.new_index},
                    {"faces", result.face.new_index},
                    {"vertex_origins", result.vertex_origin},
                    {"face_origins", result.face_origin}};
  return json;
}

void print_summary(const RepairArguments& arguments, const Mesh& given, const RepairResult& result,
                   const Diagnostics& left, const WrittenRepair& written) {
  fmt::print("{}: {} vertices, {} faces\n", arguments.mesh.string(), given.vertex_count(), given.face_count());
  for (const RepairChange& change : result.changes) fmt::print("  {}\n", sentence(change.note));
  if (!result.changed()) fmt::print("  nothing to repair\n");
  for (const Note& note : result.notes) fmt::print("  note: {}\n", sentence(note));
  for (const Note& note : written.notes) fmt::print("  note: {}\n", sentence(note));
  fmt::print("  {} vertices, {} faces {}\n", result.mesh.vertex_count(), result.mesh.face_count(),
             arguments.dry_run ? "would be left" : "are left");
  if (left.has_defects()) print_findings(left, "left");
  for (const std::string& file : written.files) fmt::print("  wrote {}\n", file);
}

#ifdef MESHGRAFT_HAS_RENDER
// Returns the mesh without faces and vertices that cannot be drawn.
Mesh drawable(const Mesh& mesh) {
  return repair(mesh, {.clean_faces = false,
                       .remove_duplicate_shells = false,
                       .weld = false,
                       .split_non_manifold = false,
                       .remove_debris = false,
                       .unify_winding = false,
                       .hole_edges = 0})
      .mesh;
}
#endif

void write_repair_outputs(const RepairArguments& arguments, [[maybe_unused]] const Mesh& given,
                          const RepairResult& result, WrittenRepair& written, const Context& context) {
#ifdef MESHGRAFT_HAS_RENDER
  std::optional<render::Image> picture;
  if (!arguments.picture.empty()) {
    const Mesh before = drawable(given);
    picture = make_comparison(before, result.mesh, arguments.view, context);
  }
#endif
  context.step("write");
  if (!arguments.dry_run) {
    const WriteResult mesh = write_mesh(result.mesh, arguments.output, {}, context);
    for (const std::filesystem::path& file : mesh.files) written.files.push_back(file.string());
    written.notes.insert(written.notes.end(), mesh.notes.begin(), mesh.notes.end());
  }
#ifdef MESHGRAFT_HAS_RENDER
  if (picture) {
    render::write_png(*picture, arguments.picture);
    written.files.push_back(arguments.picture.string());
  }
#endif
}

void check_repair_outputs(const RepairArguments& arguments) {
  if (arguments.output.empty() && !arguments.dry_run) throw Error(facts::cli::NoOutputOfRepair{}, "repair");
  require_outputs({.mesh = arguments.dry_run ? std::filesystem::path() : arguments.output,
                   .picture = arguments.picture,
                   .report = arguments.report},
                  {arguments.mesh}, {}, arguments.force);
#ifdef MESHGRAFT_HAS_RENDER
  check_view(arguments.view);
#endif
}

void run_repair(const RepairArguments& arguments, Context context) {
  context.threads = arguments.threads;
  context.memory = arguments.memory;
  check_repair_outputs(arguments);
  context.step("read");
  const Mesh given = read_mesh(arguments.mesh, context);
  if (given.face_count() == 0) throw Error(facts::cli::NoFacesToRepair{}, arguments.mesh);
  const RepairResult result = repair(given, repair_options_of(arguments), context);
  if (result.mesh.face_count() == 0 && !arguments.dry_run)
    throw Error(facts::cli::NoFacesLeft{}, arguments.mesh);
  const Diagnostics left = check_mesh(result.mesh, context);
  WrittenRepair written;
  written.notes = notes_on_files(given);
  write_repair_outputs(arguments, given, result, written, context);
  const auto dump = [&](bool with_maps) {
    return report_json(arguments, given, result, left, written, with_maps)
               .dump(2, ' ', false, Json::error_handler_t::replace) +
           "\n";
  };
  if (!arguments.report.empty()) {
    written.files.push_back(arguments.report.string());
    write_file_atomically(arguments.report, dump(true), context);
  }
  if (arguments.json)
    fmt::print("{}", dump(false));
  else
    print_summary(arguments, given, result, left, written);
}

void add_steps(CLI::App& command, RepairArguments& arguments) {
  command.add_flag("--no-clean", arguments.no_clean, "Keep degenerate, repeated and flat faces");
  command.add_flag("--keep-shells", arguments.keep_shells, "Keep components that lie on another one");
  CLI::Option* no_weld = command.add_flag("--no-weld", arguments.no_weld, "Weld no boundary edges");
  command
      .add_option("--weld-distance", arguments.weld_distance,
                  "Weld boundary vertices this far apart, model units, up to half of the edges there (default "
                  "1e-6 of the box, up to a tenth of the edges)")
      ->type_name("LENGTH")
      ->check(number_from(0, 1e300))
      ->excludes(no_weld);
  command.add_flag("--no-split", arguments.no_split, "Leave edges of more than two faces and the like");
  CLI::Option* keep = command.add_flag("--keep-debris", arguments.keep_debris, "Keep small loose components");
  command
      .add_option(
          "--debris-size", arguments.debris_size,
          fmt::format("Remove components with fewer faces and less area than this times the largest one's "
                      "(default {})",
                      RepairOptions{}.debris_rel))
      ->type_name("X")
      ->check(number_from(0, 1))
      ->excludes(keep);
  command.add_flag("--no-winding", arguments.no_winding, "Turn no faces over");
  command
      .add_option(
          "--fill-holes", arguments.hole_edges,
          "Close holes of at most this many edges, 0 for none (default: up to 24, where the hole's area is "
          "at most 0.5 % of that of the components around it)")
      ->type_name("N")
      ->check(whole_number_from(0, 100000));
  add_choice<HoleFill>(
      command, "--hole-fill", arguments.hole_fill,
      {{"plain", HoleFill::plain}, {"refined", HoleFill::refined}, {"faired", HoleFill::faired}},
      "What closes a hole: plain triangles between the vertices around it (default), refined to edges as long "
      "as "
      "around it, or faired as well, so that the surface goes on smoothly");
  command.add_flag("--keep-isolated", arguments.keep_isolated, "Keep vertices that no face has");
}

}  // namespace

void add_repair(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<RepairArguments>();
  CLI::App* command = program.add_subcommand(
      "repair",
      "Mend a mesh: weld, clean, take apart what is no manifold, turn faces alike, close small holes");
  command->add_option("mesh", arguments->mesh, "The mesh file")->required()->type_name("MESH");
  command->add_option("-o,--output", arguments->output, "The mesh file to write; its extension is the format")
      ->type_name("FILE");
  add_steps(*command, *arguments);
  command->add_option("--report", arguments->report, "Write changes and index maps as JSON")->type_name("FILE");
#ifdef MESHGRAFT_HAS_RENDER
  add_picture(*command, arguments->picture, arguments->view, "Write a PNG of the mesh before and after");
#endif
  command->add_flag("--dry-run", arguments->dry_run, "Tell what would be changed; write no mesh");
  command->add_flag("--force,--in-place", arguments->force, "Allow the output to replace the input mesh");
  command->add_flag("--json", arguments->json, "Print the report, without maps, instead of a summary");
  command->footer(
      "Examples:\n  meshgraft repair scan.ply --dry-run\n"
      "  meshgraft repair scan.ply -o clean.ply --fill-holes 60 --report repair.json");
  add_threads(*command, arguments->threads);
  add_memory(*command, arguments->memory);
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_repair(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
