#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/report.h>

#include "commands.h"
#include "exit_status.h"
#include "findings.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  std::filesystem::path mesh;
  bool json = false;
};

// The operations that a mesh allows as it is.
struct Uses {
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
  const auto loops = boundary_loops(mesh);
  uses.all_loops = loops.size();
  for (std::size_t k = 0; k < loops.size(); ++k)
    if (is_sound(mesh, diagnostics, loops[k])) uses.loops.push_back(k);
  return uses;
}

std::string uses_text(const Uses& uses) {
  const std::string deform = uses.deform ? "deform: yes"
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

void run_check(const CheckArguments& arguments, const Context& context) {
  context.step("read");
  const Mesh mesh = read_mesh(arguments.mesh, context);
  const Diagnostics report = check_mesh(mesh, context);
  const Uses uses = uses_of(mesh, report);
  const bool clean = !report.has_defects() && mesh.face_count() > 0;
  if (arguments.json) {
    const Json json = {{"format", "meshgraft-check"},
                       {"version", 1},
                       {"mesh", arguments.mesh.string()},
                       {"clean", clean},
                       {"counts", {{"vertices", mesh.vertex_count()}, {"faces", mesh.face_count()}}},
                       {"findings", Json::parse(write_diagnostics(report, text_of))},
                       {"deform", uses.deform          ? "everywhere"
                                  : uses.deform_beyond ? "partly"
                                                       : "no"},
                       {"loops", uses.all_loops},
                       {"mergeable_loops", uses.loops}};
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  } else {
    fmt::print("{}: {} vertices, {} faces\n", arguments.mesh.string(), mesh.vertex_count(), mesh.face_count());
    if (mesh.face_count() == 0)
      fmt::print("  {:<12}no faces: there is no surface to edit\n", "findings");
    else
      print_findings(report, "findings");
    if (report.has_defects() && mesh.face_count() > 0)
      fmt::print("  {:<12}meshgraft repair {} -o {}\n", "to mend", arguments.mesh.string(),
                 repaired_name(arguments.mesh));
    fmt::print("  {:<12}{}\n", "as it is", uses_text(uses));
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
  command->footer("Example:\n  meshgraft check scan.ply && meshgraft deform edit.json -o out.ply");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_check(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
