// Repairs the damaged meshes of some folders, beside CGAL in the same run:
//
//   meshgraft_repair_bench FOLDER... [Google Benchmark's own flags]
//
// Prints two Markdown tables for docs/repair.md: what `repair` finds and changes, and what is left and lost
// beside CGAL's repair. The times follow, and how much longer CGAL takes, by medians. Leaves out meshes of
// fewer than 100 faces, and those without defects in which `repair` changes nothing.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>

#include "cgal_repair.h"
#include "ratio_reporter.h"
#include "support/mesh_files.h"
#include "support/surface_losses.h"

namespace meshgraft::bench {
namespace {

constexpr Index least_faces = 100;

std::string findings_of(const Mesh& mesh) {
  std::string text;
  for (const Finding& finding : check_mesh(mesh).findings)
    if (finding.kind != FindingKind::polygon)
      text += fmt::format("{}{} `{}`", text.empty() ? "" : ", ", finding.count, name_of(finding.kind));
  return text.empty() ? "none" : text;
}

std::int64_t intersections_of(const Mesh& mesh) {
  std::vector<Index> all(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(all.begin(), all.end(), 0);
  return count_self_intersections(mesh.positions, triangulate(mesh).triangles, all);
}

std::string moves_of(const Mesh& given, const RepairResult& result) {
  Index moved = 0;
  double largest = 0;
  for (Index v = 0; v < given.vertex_count(); ++v) {
    const Index now = result.vertex.new_index[v];
    if (now < 0) continue;
    const double distance = (given.positions.row(v) - result.mesh.positions.row(now)).norm();
    moved += distance > 0;
    largest = std::max(largest, distance);
  }
  if (moved == 0) return "none";
  const double diagonal = (given.positions.colwise().maxCoeff() - given.positions.colwise().minCoeff()).norm();
  return fmt::format("{}, {:.1e} of the box", moved, largest / diagonal);
}

struct Case {
  std::string name;
  std::shared_ptr<const Mesh> given;
  RepairResult result;
};

std::vector<Case> damaged_meshes(const std::vector<std::string>& folders) {
  std::vector<Case> cases;
  int files = 0;
  for (const std::string& folder : folders)
    for (const std::filesystem::path& path : test::mesh_files(folder)) {
      try {
        auto mesh = std::make_shared<const Mesh>(read_mesh(path));
        if (mesh->face_count() < least_faces) continue;
        ++files;
        RepairResult result = repair(*mesh);
        if (result.changed() || check_mesh(*mesh).has_defects())
          cases.push_back({path.filename().string(), std::move(mesh), std::move(result)});
      } catch (const Error& error) {
        fmt::print(stderr, "{}: {}\n", path.string(), error.what());
      }
    }
  fmt::print("{} of {} meshes of {} faces or more have defects, or holes that are closed.\n\n", cases.size(),
             files, least_faces);
  return cases;
}

void print_changes(const std::vector<Case>& cases) {
  fmt::print(
      "| mesh | vertices | faces | `check` finds | `repair` changes | vertices moved "
      "|\n|---|---|---|---|---|---|\n");
  for (const Case& one : cases) {
    std::string changes;
    for (const RepairChange& change : one.result.changes)
      changes += fmt::format("{}{} `{}`", changes.empty() ? "" : ", ", change.count, name_of(change.kind));
    fmt::print("| {} | {} | {} | {} | {} | {} |\n", one.name, one.given->vertex_count(),
               one.given->face_count(), findings_of(*one.given), changes, moves_of(*one.given, one.result));
  }
}

std::string losses_text(const Mesh& given, const Mesh& repaired) {
  const test::SurfaceLosses losses = test::surface_losses(given, repaired);
  if (losses.faces == 0 && losses.vertices == 0) return "none";
  return fmt::format("{}, {}, {:.2f} %", losses.vertices, losses.faces, 100 * losses.area_rel);
}

void print_comparison(const std::vector<Case>& cases) {
  fmt::print("\n| mesh | components | openings | intersecting pairs | vertices, faces, area lost | left |\n");
  fmt::print("|---|---|---|---|---|---|\n");
  for (const Case& one : cases) {
    CgalRepair cgal(*one.given);
    cgal.run();
    const Mesh theirs = cgal.mesh();
    const Mesh& ours = one.result.mesh;
    const TopologySummary before = summarise_topology(*one.given), here = summarise_topology(ours),
                          there = summarise_topology(theirs);
    fmt::print("| {} | {}: {}, {} | {}: {}, {} | {}: {}, {} | {}; {} | {}; {} |\n", one.name, before.components,
               here.components, there.components, before.boundary_loops, here.boundary_loops,
               there.boundary_loops, intersections_of(*one.given), intersections_of(ours),
               intersections_of(theirs), losses_text(*one.given, ours), losses_text(*one.given, theirs),
               findings_of(ours), findings_of(theirs));
    std::fflush(stdout);
  }
}

void add_times(const std::vector<Case>& cases) {
  const auto add = [](const std::string& name, const auto& work) {
    benchmark::RegisterBenchmark(name.c_str(),
                                 [work](benchmark::State& state) {
                                   for (auto _ : state) work();
                                 })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  };
  for (const Case& one : cases) {
    const auto cgal = std::make_shared<CgalRepair>(*one.given);
    add(one.name + " / meshgraft", [given = one.given] { benchmark::DoNotOptimize(repair(*given)); });
    add(one.name + " / meshgraft, one thread",
        [given = one.given] { benchmark::DoNotOptimize(repair(*given, {}, {.threads = 1})); });
    add(one.name + " / CGAL", [cgal] { cgal->run(); });
  }
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const std::vector<std::string> folders(argv + 1, argv + argc);
  const std::vector<Case> cases = damaged_meshes(folders);
  print_changes(cases);
  print_comparison(cases);
  add_times(cases);
  RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace meshgraft::bench

int main(int argc, char** argv) { return meshgraft::bench::run(argc, argv); }
