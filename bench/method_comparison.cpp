// Runs the four tests of Botsch and Sorkine by our methods, by published ones, and by CGAL. Prints the tables
// of docs/methods.md as Markdown.
//
//   meshgraft_methods [--data FOLDER] [--table methods|published|ablations|stiffness] [--cells quality|kinks]
//                     [--only TEXT] [--meshes FOLDER]
//
// --only leaves out methods whose names do not contain the text.

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/io/mesh_io.h>

#include "../cli/blas_kernels.h"
#include "baselines/baselines.h"
#include "cgal_deformation.h"
#include "standard_tests.h"

namespace meshgraft::bench {
namespace {

constexpr unsigned cgal_iterations = 100;

using Solve = std::function<Points(const BenchEdit&)>;

struct Method {
  std::string name;
  Solve solve;
};

std::vector<VertexConstraint> constraints_of(const BenchEdit& edit) {
  std::vector<VertexConstraint> constraints;
  for (const Index v : edit.fixed)
    constraints.push_back({v, edit.positions.row(v).transpose(), Eigen::Matrix3d::Identity()});
  for (const Index v : edit.handle)
    constraints.push_back({v, edit.pose * edit.positions.row(v).transpose(), edit.pose.linear()});
  return constraints;
}

Method ours(const std::string& name, const DeformerOptions& options) {
  return {name, [options](const BenchEdit& edit) {
            const auto constraints = constraints_of(edit);
            return Deformer({edit.positions, edit.triangles, {.whole = true}, constraints}, options)
                .evaluate(constraints);
          }};
}

Method ours(DeformMethod method) { return ours(std::string(to_string(method)), {.method = method}); }

Method published(Baseline baseline, const std::string& changed = "", const BaselineOptions& options = {}) {
  return {std::string(to_string(baseline)) + changed, [baseline, options](const BenchEdit& edit) {
            return deform_by(baseline, {edit.positions, edit.triangles, {.whole = true}, constraints_of(edit)},
                             options);
          }};
}

Method cgal(CgalMethod method, const std::string& name, unsigned iterations = cgal_iterations) {
  return {"CGAL " + name, [method, iterations](const BenchEdit& edit) {
            return run_cgal(edit, method, {.iterations = iterations}).positions;
          }};
}

std::vector<Method> all_methods() {
  return {ours(DeformMethod::corotational),
          ours(DeformMethod::shell),
          ours(DeformMethod::rotation_aware),
          ours(DeformMethod::ft05),
          published(Baseline::botsch_kobbelt_2004),
          published(Baseline::lipman_2004),
          published(Baseline::sorkine_2004),
          published(Baseline::yu_2004),
          published(Baseline::arap_2007),
          published(Baseline::sr_arap_2015),
          published(Baseline::smooth_arap_2025),
          cgal(CgalMethod::spokes_and_rims, "SPOKES_AND_RIMS"),
          cgal(CgalMethod::sre_arap, "SRE_ARAP")};
}

// Returns the published methods with their defaults and CGAL's, then those with "arap" with other settings.
std::vector<Method> published_methods() {
  std::vector<Method> methods;
  for (const Baseline baseline : all_baselines) methods.push_back(published(baseline));
  methods.push_back(cgal(CgalMethod::spokes_and_rims, "SPOKES_AND_RIMS"));
  methods.push_back(cgal(CgalMethod::sre_arap, "SRE_ARAP"));
  const auto add = [&](Baseline baseline, const std::string& changed, const BaselineOptions& options) {
    methods.push_back(published(baseline, ", " + changed, options));
  };
  for (const double lambda : {0.5, 0.8, 0.9, 0.98, 0.99, 0.999})
    add(Baseline::smooth_arap_2025, fmt::format("λ = {}", lambda), {.smoothness = lambda});
  for (const double alpha : {0.001, 0.003, 0.03})
    add(Baseline::sr_arap_2015, fmt::format("α = {}", alpha), {.sr_alpha = alpha});
  add(Baseline::sr_arap_2015, "α = 0.001, cotangent",
      {.sr_alpha = 0.001, .sr_weights = WeightScheme::cotangent});
  add(Baseline::smooth_arap_2025, "all terms fitted", {.smooth_arap_fit = RotationFit::energy});
  constexpr int many = 400;
  const std::string long_run = fmt::format("{} iterations", many);
  for (const Baseline baseline : {Baseline::arap_2007, Baseline::smooth_arap_2025, Baseline::sr_arap_2015})
    add(baseline, long_run, {.arap_iterations = many, .arap_tolerance = 0});
  methods.push_back(cgal(CgalMethod::sre_arap, "SRE_ARAP, " + long_run, many));
  return methods;
}

// Returns the default method, and variants of it with one choice changed in each.
std::vector<Method> ablations() {
  std::vector<Method> methods{ours("default", {})};
  const auto add = [&](const std::string& name, const std::function<void(DeformerOptions&)>& change) {
    DeformerOptions options;
    change(options);
    methods.push_back(ours(name, options));
  };
  add("apex height 0.25", [](auto& o) { o.operators.apex_height_rel = 0.25; });
  add("apex height 1", [](auto& o) { o.operators.apex_height_rel = 1; });
  add("ft05-noise", [](auto& o) { o.operators.degenerate = DegenerateTreatment::ft05_noise; });
  add("cotangent weights", [](auto& o) { o.operators.weights = WeightScheme::cotangent; });
  add("density ft05, stiffness 0.3", [](auto& o) {
    o.operators.density = Density::ft05;
    o.stiffness = 0.3;
  });
  add("weight of E_L 1", [](auto& o) { o.operators.laplacian_weight = 1; });
  for (const int iterations : {1, 5, 10, 30, 100})
    add(fmt::format("at most {} steps", iterations), [iterations](auto& o) { o.iterations = iterations; });
  for (const double length : {0.0, 0.03, 0.06, 0.12, 0.2})
    add(fmt::format("smoothing length {}", length), [length](auto& o) { o.smoothing_length_rel = length; });
  return methods;
}

std::vector<Method> stiffnesses() {
  std::vector<Method> methods;
  for (const double stiffness : {0.0, 5.0, 10.0, 20.0, 40.0, 60.0, 100.0, 200.0, 500.0, 1000.0})
    methods.push_back(ours(fmt::format("{}", stiffness), {.stiffness = stiffness}));
  return methods;
}

std::vector<Index> free_vertices(const BenchEdit& edit) {
  std::vector<char> held(static_cast<std::size_t>(edit.positions.rows()), 0);
  for (const auto* list : {&edit.fixed, &edit.handle})
    for (const Index v : *list) held[v] = 1;
  std::vector<Index> free;
  for (Index v = 0; v < static_cast<Index>(edit.positions.rows()); ++v)
    if (!held[v]) free.push_back(v);
  return free;
}

// The measures of a cell, and how the line above the table names them.
struct Cells {
  const char* heading;
  std::function<std::string(const Quality&)> text;
};

const std::map<std::string, Cells> kinds_of_cells{
    {"quality",
     {"Edge RMS / dihedral change p99 (degrees) / smallest singular value / new self-intersections (product of "
      "the first two).",
      [](const Quality& quality) {
        return fmt::format("{:.3f} / {:.1f} / {:.2f} / {} ({:.3f})", quality.edge_rms, quality.dihedral_p99_deg,
                           quality.sigma_min, quality.new_self_intersections.value_or(-1),
                           quality.edge_rms * quality.dihedral_p99_deg);
      }}},
    {"kinks",
     {"Edge RMS × dihedral change p99 (degrees) / largest dihedral change / rim jump / flipped faces / new "
      "self-intersections.",
      [](const Quality& quality) {
        return fmt::format("{:.3f} / {:.1f} / {:.1f} / {} / {}", quality.edge_rms * quality.dihedral_p99_deg,
                           quality.dihedral_max_deg, quality.rim_jump_max_deg, quality.flipped_faces,
                           quality.new_self_intersections.value_or(-1));
      }}}};

// Returns nothing where the method has no solution.
std::optional<Points> solution(const Method& method, const BenchEdit& edit) {
  try {
    return method.solve(edit);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unsolvable) throw;
    return std::nullopt;
  }
}

void print_table(const std::vector<StandardTest>& tests, const std::vector<Method>& methods, const Cells& cells,
                 const std::filesystem::path& meshes) {
  fmt::print("{}\n\n", cells.heading);
  fmt::print("| method |");
  for (const StandardTest& test : tests) fmt::print(" {} |", test.name);
  fmt::print("\n|---|");
  for (std::size_t t = 0; t < tests.size(); ++t) fmt::print("---|");
  fmt::print("\n");
  for (const Method& method : methods) {
    fmt::print("| {} |", method.name);
    for (const StandardTest& test : tests) {
      const std::optional<Points> edited = solution(method, test.edit);
      if (!edited) {
        fmt::print(" fails |");
        continue;
      }
      const Quality quality =
          measure_quality({test.edit.positions, *edited, test.edit.triangles, free_vertices(test.edit)});
      fmt::print(" {} |", cells.text(quality));
      std::fflush(stdout);
      if (!meshes.empty())
        write_mesh(make_mesh(*edited, test.edit.triangles), meshes / (test.name + " " + method.name + ".ply"));
    }
    fmt::print("\n");
  }
}

int run(int argc, char** argv) {
  std::map<std::string, std::string> arguments{{"--table", "methods"}, {"--cells", "quality"}};
  for (int k = 1; k + 1 < argc; k += 2) arguments[argv[k]] = argv[k + 1];
  const std::map<std::string, std::function<std::vector<Method>()>> tables{{"methods", all_methods},
                                                                           {"published", published_methods},
                                                                           {"ablations", ablations},
                                                                           {"stiffness", stiffnesses}};
  const auto table = tables.find(arguments["--table"]);
  const auto cells = kinds_of_cells.find(arguments["--cells"]);
  if (argc % 2 == 0 || table == tables.end() || cells == kinds_of_cells.end()) {
    fmt::print(
        stderr,
        "usage: meshgraft_methods [--data FOLDER] [--table methods|published|ablations|stiffness] [--cells "
        "quality|kinks] [--only TEXT] [--meshes FOLDER]\n");
    return 2;
  }
  const auto tests = arguments.contains("--data") ? read_tests(arguments["--data"]) : sample_tests();
  std::vector<Method> methods = table->second();
  std::erase_if(methods, [&](const Method& method) {
    return method.name.find(arguments["--only"]) == std::string::npos;
  });
  print_table(tests, methods, cells->second, arguments["--meshes"]);
  return 0;
}

}  // namespace
}  // namespace meshgraft::bench

int main(int argc, char** argv) {
  meshgraft::cli::restart_with_better_blas_kernels(argv);
  try {
    return meshgraft::bench::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "meshgraft_methods: {}\n", error.what());
    return 1;
  }
}
