// Times the search of a surface for intersections with itself, beside CGAL in the same run:
//
//   meshgraft_intersection_bench [Google Benchmark's own flags]
//
// The surface is the knot of 100,000 and of a million triangles. Its vertices are moved at random by up to
// 0.2 edge lengths (it does not intersect itself) and by up to 0.8 (it does, everywhere). Prints at the end
// how much longer CGAL takes, by medians. With --benchmark_repetitions=5
// --benchmark_enable_random_interleaving=true, changes of the machine's speed affect both alike.

#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <meshgraft/deform/quality.h>
#include <meshgraft/samples/samples.h>

#include "ratio_reporter.h"

namespace meshgraft::bench {
namespace {

struct Surface {
  Points points;
  Triangles triangles;
};

Surface noisy_knot(int resolution, double noise_rel) {
  Mesh knot = make_sample("knot", resolution);
  Surface surface{knot.positions, triangulate(knot).triangles};
  double length = 0;
  for (const auto& t : surface.triangles.rowwise())
    length += (surface.points.row(t[0]) - surface.points.row(t[1])).norm();
  length /= static_cast<double>(surface.triangles.rows());
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> noise(-noise_rel * length, noise_rel * length);
  for (double& x : surface.points.reshaped()) x += noise(random);
  return surface;
}

std::size_t count_ours(const Surface& surface, int threads) {
  std::vector<Index> all(static_cast<std::size_t>(surface.points.rows()));
  std::iota(all.begin(), all.end(), Index{0});
  return self_intersections(surface.points, surface.triangles, all, {.threads = threads}).size();
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

CgalMesh converted(const Surface& surface) {
  CgalMesh mesh;
  for (const auto& p : surface.points.rowwise()) mesh.add_vertex({p[0], p[1], p[2]});
  const auto vertex = [](Index v) { return CgalMesh::Vertex_index(static_cast<CgalMesh::size_type>(v)); };
  for (const auto& t : surface.triangles.rowwise()) mesh.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  return mesh;
}

template <class Tag>
std::size_t count_cgal(const CgalMesh& mesh) {
  std::vector<std::pair<CgalMesh::Face_index, CgalMesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections<Tag>(mesh, std::back_inserter(pairs));
  return pairs.size();
}

void add_case(const std::string& name, const std::function<std::size_t()>& count) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [count](benchmark::State& state) {
                                 std::size_t pairs = 0;
                                 for (auto _ : state) pairs = count();
                                 state.counters["pairs"] = static_cast<double>(pairs);
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const int resolution : {224, 708})
    for (const double noise_rel : {0.2, 0.8}) {
      const auto surface = std::make_shared<Surface>(noisy_knot(resolution, noise_rel));
      const auto mesh = std::make_shared<CgalMesh>(converted(*surface));
      const std::string group = std::to_string(surface->triangles.rows()) + " triangles, noise " +
                                std::to_string(noise_rel).substr(0, 3);
      add_case(group + " / meshgraft", [surface] { return count_ours(*surface, 0); });
      add_case(group + " / meshgraft, one thread", [surface] { return count_ours(*surface, 1); });
      add_case(group + " / CGAL", [mesh] { return count_cgal<CGAL::Parallel_if_available_tag>(*mesh); });
      add_case(group + " / CGAL, one thread", [mesh] { return count_cgal<CGAL::Sequential_tag>(*mesh); });
    }
  RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace meshgraft::bench

int main(int argc, char** argv) { return meshgraft::bench::run(argc, argv); }
