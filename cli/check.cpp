#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/report.h>

#include "choices.h"
#include "commands.h"
#include "exit_status.h"
#include "findings.h"
#include "script/fact_json.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  std::uint64_t memory = 0;
  std::filesystem::path mesh;
  bool json = false;
  bool intersections = false;
};

// A search for self-intersections takes seconds above this size.
constexpr Index most_triangles_searched = 1'000'000;

// The operations that a mesh allows as it is.
struct Uses {
  std::size_t components = 0;      // connected components
  bool deform = false;             // deformable everywhere
  bool deform_beyond = false;      // deformable where no refused finding is within reach
  std::vector<std::size_t> loops;  // numbers of the boundary loops that a merge can use
  std::size_t all_loops = 0;
};

bool is_sound(const Mesh& mesh, const Diagnostics& diagnostics, const std::vector<Index>& loop) {
  if (std::any_of(loop.begin(), loop.end(), [&](Index v) { return !mesh.positions.row(v).allFinite(); }))
    return false;
  for (const FindingKind kind :
       {FindingKind::non_manifold_edge, FindingKind::non_manifold_vertex, FindingKind::inconsistent_winding}) {
    const Finding* finding = diagnostics.find(kind);
    if (finding && std::any_of(loop.begin(), loop.end(), [&](Index v) {
          return std::binary_search(finding->indices.begin(), finding->indices.end(), v);
        }))
      return false;
  }
  return true;
}

Uses uses_of(const Mesh& mesh, const Diagnostics& diagnostics) {
  Uses uses;
  const bool refused =
      std::any_of(diagnostics.findings.begin(), diagnostics.findings.end(),
                  [](const Finding& finding) { return finding.severity == Severity::refused; });
  const bool has_faces = mesh.face_count() > 0;
  uses.deform = has_faces && !refused;
  uses.deform_beyond = has_faces && refused;
  uses.components = static_cast<std::size_t>(summarise_topology(mesh).components);
  const auto loops = boundary_loops(mesh);
  uses.all_loops = loops.size();
  for (std::size_t k = 0; k < loops.size(); ++k)
    if (is_sound(mesh, diagnostics, loops[k])) uses.loops.push_back(k);
  return uses;
}

std::string uses_text(const Uses& uses) {
  const std::string deform = uses.deform && uses.components > 1
                                 ? fmt::format(
                                       "deform: yes, where something holds each of the {} components that it "
                                       "moves",
                                       uses.components)
                             : uses.deform ? "deform: yes"
                             : uses.deform_beyond
                                 ? "deform, cut and merge: where nothing that is refused is within reach"
                                 : "deform: no, there are no faces";
  const std::string merge =
      !uses.deform && !uses.deform_beyond ? "merge: no"
      : uses.all_loops == 0               ? "merge: cut it open first, or drop a source on it with --at"
      : uses.loops.empty()                ? "merge: no loop is sound"
      : uses.loops.size() == uses.all_loops
          ? fmt::format("merge: along {}", uses.all_loops == 1 ? "its loop" : "all its loops")
          : fmt::format("merge: along {} of {} loops", uses.loops.size(), uses.all_loops);
  return deform + "; " + merge;
}

// Returns a suggested file name for the repaired mesh.
std::string repaired_name(const std::filesystem::path& mesh) {
  return mesh.stem().string() + "_repaired" + mesh.extension().string();
}

// Openings may be meant. Closing them is a choice and mends nothing.
bool is_choice(const RepairChange& change) { return change.kind == RepairChangeKind::filled_hole; }

// Returns the changes that a repair would make.
std::vector<RepairChange> repairs_of(const Mesh& mesh, const Context& context) {
  return mesh.face_count() == 0 ? std::vector<RepairChange>() : repair(mesh, {}, context).changes;
}

// Returns the number of pairs of triangles that intersect; nothing for a mesh with too many triangles.
std::optional<std::int64_t> self_intersections_of(const Mesh& mesh, bool whatever_the_size,
                                                  const Context& context) {
  const Triangulation pieces = triangulate(mesh, {.skip_out_of_range = true});
  if (pieces.triangles.rows() > most_triangles_searched && !whatever_the_size) return std::nullopt;
  std::vector<Index> all(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(all.begin(), all.end(), Index{0});
  return count_self_intersections(mesh.positions, pieces.triangles, all, context);
}

Json changes_json(const std::vector<RepairChange>& changes) {
  Json list = Json::array();
  constexpr std::size_t most = 10;
  for (const RepairChange& change : changes)
    list.push_back({{"name", name_of(change.kind)},
                    {"count", change.count},
                    {"domain", domain_name(change.domain)},
                    {"first", std::vector<Index>(change.indices.begin(),
                                                 change.indices.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                              most, change.indices.size())))},
                    {"description", text_of(change.note).statement},
                    {"choice", is_choice(change)}});
  return list;
}

// Prints what a repair would change, besides what the findings say.
void print_changes(const std::vector<RepairChange>& changes) {
  std::string label = "a repair";
  for (const RepairChange& change : changes) {
    fmt::print("  {:<12}{}: {}{}\n", label, name_of(change.kind), text_of(change.note).statement,
               is_choice(change) ? " (a choice: openings may be meant)" : "");
    label = "";
  }
}

void run_check(const CheckArguments& arguments, Context context) {
  context.memory = arguments.memory;
  context.step("read");
  const Mesh mesh = read_mesh(arguments.mesh, context);
  const Diagnostics report = check_mesh(mesh, context);
  const Uses uses = uses_of(mesh, report);
  const std::vector<RepairChange> changes = repairs_of(mesh, context);
  const bool repairable = !std::ranges::all_of(changes, is_choice);
  const std::optional<std::int64_t> intersections =
      self_intersections_of(mesh, arguments.intersections, context);
  const bool clean = !report.has_defects() && !repairable && mesh.face_count() > 0;
  if (arguments.json) {
    const Json json = {{"format", "meshgraft-check"},
                       {"version", 1},
                       {"mesh", arguments.mesh.string()},
                       {"clean", clean},
                       {"counts", {{"vertices", mesh.vertex_count()}, {"faces", mesh.face_count()}}},
                       {"findings", Json::parse(write_diagnostics(report, text_of))},
                       {"repair", changes_json(changes)},
                       {"self_intersections", intersections ? Json(*intersections) : Json(nullptr)},
                       {"components", uses.components},
                       {"deform", uses.deform          ? "everywhere"
                                  : uses.deform_beyond ? "partly"
                                                       : "no"},
                       {"notes", to_json(notes_on_files(mesh), text_of)},
                       {"loops", uses.all_loops},
                       {"mergeable_loops", uses.loops}};
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  } else {
    fmt::print("{}: {} vertices, {} faces\n", arguments.mesh.string(), mesh.vertex_count(), mesh.face_count());
    if (mesh.face_count() == 0)
      fmt::print("  {:<12}no faces: there is no surface to edit\n", "findings");
    else
      print_findings(report, "findings");
    print_changes(changes);
    if (intersections && *intersections > 0)
      fmt::print("  {:<12}{} pairs of triangles of the surface intersect\n", "intersects", *intersections);
    if (!intersections)
      fmt::print("  {:<12}not searched among so many triangles: --intersections does it\n", "intersects");
    if ((report.has_defects() || repairable) && mesh.face_count() > 0)
      fmt::print("  {:<12}meshgraft repair {} -o {}\n", "to mend", arguments.mesh.string(),
                 repaired_name(arguments.mesh));
    fmt::print("  {:<12}{}\n", "as it is", uses_text(uses));
    for (const Note& note : notes_on_files(mesh)) fmt::print("  {:<12}{}\n", "note", sentence(note));
  }
  if (!clean) throw Answer{exit_status(ErrorCode::input)};
}

}  // namespace

void add_check(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = program.add_subcommand(
      "check", "Name what is wrong with a mesh and what to do about it; exit status 0 if nothing is, else 3");
  command->add_option("mesh", arguments->mesh, "The mesh file")->required()->type_name("MESH");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->add_flag("--intersections", arguments->intersections,
                    "Look for self-intersections also among more than a million triangles");
  command->footer("Example:\n  meshgraft check scan.ply && meshgraft deform edit.json -o out.ply");
  add_memory(*command, arguments->memory);
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_check(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
