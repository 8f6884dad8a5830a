// Times set-up and evaluation, stage by stage, beside CGAL's on the same mesh and constraints, and merging:
//
//   meshgraft_bench [--eigen_max_vertices=20000] [--iterative_max_vertices=100000] [--mesh=FILE] [Google
//   Benchmark's own flags]
//
// With --mesh, the set-up and evaluation of that mesh alone are timed.
//
// One iteration is one edit from scratch. Its stages are counters in seconds, so that the medians over
// repetitions are each stage's own; the benchmark's time is their sum.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <benchmark/benchmark.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>

#include "../cli/blas_kernels.h"
#include "bench_merge.h"
#include "bench_run.h"
#include "cgal_deformation.h"
#include "frame_benchmark.h"
#include "machine_benchmark.h"
#include "region_benchmark.h"

namespace meshgraft::bench {
namespace {

constexpr std::array<Index, 7> sizes{2'000, 5'000, 10'000, 20'000, 50'000, 100'000, 250'000};
constexpr std::array<Index, 1> very_large_sizes{1'000'000};
constexpr unsigned cgal_iterations = 10;

using Merges = BySize<BenchMerge, make_head_on_bust>;

void run_deformer(benchmark::State& state, const BenchEdit& edit, const DeformerOptions& options) {
  const Region region = region_of(edit);
  std::vector<HandlePose> poses(1);
  poses[0].transform = edit.pose;
  Points positions(edit.positions.rows(), 3);
  DeformerSummary summary;
  EvaluationReport evaluation;
  Quality quality;
  const PeakMemory memory;
  for ([[maybe_unused]] auto iteration : state) {
    const Deformer deformer(edit.positions, edit.triangles, region, options);
    summary = deformer.summary();
    report(state,
           {{"assemble", summary.assemble_seconds},
            {"analyse", summary.analyse_seconds},
            {"factorise", summary.factorise_seconds},
            {"evaluate", median_seconds(5, [&] { deformer.evaluate(poses, positions, {}, &evaluation); })}});
    quality = measure_quality({edit.positions, positions, edit.triangles, deformer.free_vertices()},
                              {.self_intersections = false});
  }
  average(state);
  state.counters["vertices"] = static_cast<double>(edit.positions.rows());
  state.counters["free"] = summary.free_vertices;
  state.counters["peak_bytes"] = static_cast<double>(memory.bytes());
  state.counters["steps"] = evaluation.iterations;
  state.counters["factor_flops"] = summary.solver.factor_flops;
  state.counters["unknowns"] = static_cast<double>(summary.solver.unknowns);
  state.counters["factor_nonzeros"] = static_cast<double>(summary.solver.factor_nonzeros);
  state.counters["edge_rms"] = quality.edge_rms;
  state.counters["dihedral_p99_deg"] = quality.dihedral_p99_deg;
}

// Times METIS on the matrix's own graph; `run_deformer` times the ordering of the mesh's graph.
void run_ordering(benchmark::State& state, const BenchEdit& edit, const OperatorOptions& operators) {
  const Deformer deformer(edit.positions, edit.triangles, region_of(edit),
                          {.method = DeformMethod::ft05, .operators = operators});
  const NormalMatrix normal = deformer.normal_matrix();
  SolverStatistics statistics;
  for ([[maybe_unused]] auto iteration : state) {
    const auto solver = make_solver(SolverBackend::multifrontal);
    report(state, {{"metis_analyse", seconds([&] { solver->analyse(normal); })}});
    statistics = solver->statistics();
  }
  average(state);
  const DeformerSummary& ours = deformer.summary();
  state.counters["vertices"] = static_cast<double>(edit.positions.rows());
  state.counters["metis_flops"] = statistics.factor_flops;
  state.counters["metis_factor_nonzeros"] = static_cast<double>(statistics.factor_nonzeros);
  state.counters["analyse"] = ours.analyse_seconds;
  state.counters["factor_flops"] = ours.solver.factor_flops;
  state.counters["factor_nonzeros"] = static_cast<double>(ours.solver.factor_nonzeros);
}

std::vector<Index> free_vertices(const BenchEdit& edit) {
  std::vector<char> held(static_cast<std::size_t>(edit.positions.rows()), 0);
  for (const auto* part : {&edit.fixed, &edit.handle}) {
    for (const Index v : *part) held[v] = 1;
  }
  std::vector<Index> free;
  for (Index v = 0; v < static_cast<Index>(held.size()); ++v) {
    if (!held[v]) free.push_back(v);
  }
  return free;
}

void run_surface_mesh_deformation(benchmark::State& state, const BenchEdit& edit, CgalMethod method) {
  CgalResult result;
  const PeakMemory memory;
  for ([[maybe_unused]] auto iteration : state) {
    result = run_cgal(edit, method, {.iterations = cgal_iterations});
    report(state, {{"construct", result.times.construct_seconds},
                   {"preprocess", result.times.preprocess_seconds},
                   {"deform", result.times.deform_seconds}});
  }
  average(state);
  state.counters["peak_bytes"] = static_cast<double>(memory.bytes());
  const std::vector<Index> free = free_vertices(edit);
  const Quality quality =
      measure_quality({edit.positions, result.positions, edit.triangles, free}, {.self_intersections = false});
  state.counters["vertices"] = static_cast<double>(edit.positions.rows());
  state.counters["free"] = static_cast<double>(free.size());
  state.counters["edge_rms"] = quality.edge_rms;
  state.counters["dihedral_p99_deg"] = quality.dihedral_p99_deg;
}

void run_merge(benchmark::State& state, const BenchMerge& merge, const MergeOptions& options) {
  for ([[maybe_unused]] auto iteration : state) {
    const MergeResult result = merge_meshes(merge.target, merge.source, merge.pairs, options);
    const MergeReport& times = result.report;
    report(state, {{"match", times.match_seconds},
                   {"assemble", times.assemble_seconds},
                   {"factorise", times.factorise_seconds},
                   {"solve", times.solve_seconds},
                   {"seam", times.seam_seconds}});
  }
  average(state);
  state.counters["target_vertices"] = merge.target.vertex_count();
  state.counters["source_vertices"] = merge.source.vertex_count();
}

/// The largest size at which each backend is timed.
struct MaxVertices {
  Index eigen = 20'000, iterative = 1'000'000;
};

void register_deformer(Edits& edits, const MaxVertices& most) {
  for (const auto treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
    const auto add_size = [&](SolverBackend backend, const std::string& name, Index size) {
      DeformerOptions options;
      options.method = DeformMethod::ft05;
      options.operators.degenerate = treatment;
      options.backend = backend;
      add("meshgraft/" + std::string(to_string(treatment)) + "/" + name + "/" + std::to_string(size),
          [&edits, size, options](benchmark::State& state) { run_deformer(state, edits[size], options); });
    };
    if (is_available(SolverBackend::multifrontal)) {
      for (const Index size : sizes) add_size(SolverBackend::multifrontal, "multifrontal", size);
      if (treatment == DegenerateTreatment::ft05_noise)  // the apex treatment's factor takes 15 GB
        for (const Index size : very_large_sizes) add_size(SolverBackend::multifrontal, "multifrontal", size);
    }
    for (const Index size : sizes) {
      if (size <= most.eigen) add_size(SolverBackend::eigen, "eigen", size);
    }
    for (const Index size : {100'000, 250'000})
      if (size <= most.iterative) add_size(SolverBackend::iterative, "iterative", size);
    for (const Index size : very_large_sizes) {
      if (size <= most.iterative) add_size(SolverBackend::iterative, "iterative", size);
    }
  }
}

void register_orderings(Edits& edits) {
  if (!is_available(SolverBackend::multifrontal)) return;
  for (const auto treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise})
    for (const Index size : {60'000, 100'000, 250'000})  // METIS is used from 50,000 unknowns on
      add("ordering/" + std::string(to_string(treatment)) + "/metis/" + std::to_string(size),
          [&edits, size, treatment](benchmark::State& state) {
            run_ordering(state, edits[size], {.degenerate = treatment});
          });
}

// Registers the default method. Its set-up has two more scalar systems, its evaluation one solve per step.
void register_corotational(Edits& edits) {
  for (const Index size : sizes) {
    add("meshgraft/corotational/default/" + std::to_string(size),
        [&edits, size](benchmark::State& state) { run_deformer(state, edits[size], {}); });
  }
}

void register_cgal(Edits& edits) {
  for (const auto& [method, name] : {std::pair{CgalMethod::original_arap, "ORIGINAL_ARAP"},
                                     std::pair{CgalMethod::spokes_and_rims, "SPOKES_AND_RIMS"},
                                     std::pair{CgalMethod::sre_arap, "SRE_ARAP"}}) {
    std::vector<Index> chosen(std::begin(sizes), std::end(sizes));
    if (method == CgalMethod::sre_arap)
      chosen.insert(chosen.end(), std::begin(very_large_sizes), std::end(very_large_sizes));
    for (const Index size : chosen)
      add("cgal/" + std::string(name) + "/default/" + std::to_string(size),
          [&edits, size, method = method](benchmark::State& state) {
            run_surface_mesh_deformation(state, edits[size], method);
          });
  }
}

/// Registers the methods and CGAL's SRE_ARAP on a mesh that is not the sheet. The names end with the mesh's.
void register_mesh(const std::string& mesh_name, Index size, const std::function<const BenchEdit&()>& edit) {
  const std::string end = std::to_string(size) + "/" + mesh_name;
  for (const auto treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
    DeformerOptions options;
    options.method = DeformMethod::ft05;
    options.operators.degenerate = treatment;
    add("meshgraft/" + std::string(to_string(treatment)) + "/default/" + end,
        [edit, options](benchmark::State& state) { run_deformer(state, edit(), options); });
  }
  add("meshgraft/corotational/default/" + end,
      [edit](benchmark::State& state) { run_deformer(state, edit(), {}); });
  add("cgal/SRE_ARAP/default/" + end,
      [edit](benchmark::State& state) { run_surface_mesh_deformation(state, edit(), CgalMethod::sre_arap); });
}

/// Registers closed and curved samples, with irregular triangles.
void register_samples() {
  struct Case {
    std::string sample;
    Index size;
    int resolution;
  };
  for (const Case& one : {Case{"octopus", 50'000, 213}, Case{"dinosaur", 50'000, 200},
                          Case{"head", 50'000, 201}, Case{"octopus", 250'000, 475}}) {
    const auto made = std::make_shared<std::optional<BenchEdit>>();
    register_mesh(one.sample, one.size, [one, made]() -> const BenchEdit& {
      if (!*made) *made = make_bend_edit(make_sample(one.sample, one.resolution));
      return **made;
    });
  }
}

void register_merge(Merges& merges) {
  struct Case {
    MergeShape shape;
    MergePose pose;
    Index size;
  };
  for (const auto& [shape, pose, size] :
       {Case{MergeShape::similar, MergePose::find, 20'000}, Case{MergeShape::ft05, MergePose::find, 20'000},
        Case{MergeShape::similar, MergePose::keep, 20'000},
        Case{MergeShape::similar, MergePose::keep, 200'000}}) {
    MergeOptions options;
    options.shape = shape;
    options.pose = pose;
    add("merge/" + std::string(to_string(shape)) + "/" + std::string(to_string(pose)) + "/" +
            std::to_string(size),
        [size = size, options](benchmark::State& state) {
          run_merge(state, make_head_on_bust(size), options);
        });
  }
}

// Takes a flag of our own out of the arguments; the rest is Google Benchmark's. Returns its last value, or "".
std::string take_text(std::string_view flag, int& argc, char** argv) {
  std::string value;
  char** const end = std::remove_if(argv + 1, argv + argc, [&](const char* argument) {
    if (!std::string_view(argument).starts_with(flag)) return false;
    value = argument + flag.size();
    return true;
  });
  argc = static_cast<int>(end - argv);
  return value;
}

Index take_number(std::string_view flag, Index value, int& argc, char** argv) {
  const std::string text = take_text(flag, argc, argv);
  return text.empty() ? value : static_cast<Index>(std::strtol(text.c_str(), nullptr, 10));
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

/// Runs the benchmarks of one mesh alone.
int run_mesh(const std::string& file, int argc, char** argv) {
  BenchEdit edit;
  try {
    edit = make_bend_edit(read_mesh(file));
  } catch (const Error& error) {
    std::fprintf(stderr, "meshgraft_bench: %s\n", error.what());
    return 2;
  }
  register_mesh(std::filesystem::path(file).stem().string(), static_cast<Index>(edit.positions.rows()),
                [&]() -> const BenchEdit& { return edit; });
  return run(argc, argv);
}

}  // namespace
}  // namespace meshgraft::bench

int main(int argc, char** argv) {
  meshgraft::cli::restart_with_better_blas_kernels(argv);
  meshgraft::bench::Edits edits;
  meshgraft::bench::Merges merges;
  meshgraft::bench::MaxVertices most;
  most.eigen = meshgraft::bench::take_number("--eigen_max_vertices=", most.eigen, argc, argv);
  most.iterative = meshgraft::bench::take_number("--iterative_max_vertices=", most.iterative, argc, argv);
  const std::string file = meshgraft::bench::take_text("--mesh=", argc, argv);
  meshgraft::bench::register_machine();
  if (!file.empty()) return meshgraft::bench::run_mesh(file, argc, argv);
  meshgraft::bench::register_samples();
  meshgraft::bench::register_deformer(edits, most);
  meshgraft::bench::register_corotational(edits);
  meshgraft::bench::register_frames(edits);
  meshgraft::bench::register_regions(edits);
  meshgraft::bench::register_orderings(edits);
  meshgraft::bench::register_cgal(edits);
  meshgraft::bench::register_merge(merges);
  return meshgraft::bench::run(argc, argv);
}
