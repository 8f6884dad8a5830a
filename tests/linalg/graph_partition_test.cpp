#include "linalg/direct/graph_partition.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "linalg/direct/symbolic_factorisation.h"
#include "matrix_families.h"

namespace meshgraft {
namespace {

TEST(NestedDissectionOrder, HasEveryUnknownOnceAndIsTheSameEveryTime) {
  for (const NamedMatrix& family : matrix_families()) {
    const std::vector<int> order = nested_dissection_order(family.lower);
    EXPECT_EQ(nested_dissection_order(family.lower), order) << family.name;
    std::vector<int> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, numbers_below(family.lower.rows())) << family.name;
  }
}

TEST(NestedDissectionOrder, FillsAGridLessThanTheOrderOfItsRows) {
  for (const Index reach : {1, 2}) {
    const NormalMatrix lower = lattice_matrix(50, 50, reach);
    EXPECT_LT(symbolic_factorisation(lower, nested_dissection_order(lower), {}).flops(),
              0.5 * symbolic_factorisation(lower, numbers_below(lower.rows()), {}).flops());
  }
}

TEST(BisectGraph, HasPartsOfAboutTheSameSizeThatFewEdgesJoin) {
  for (const char* sample : {"bumpy_plane", "torus", "knot"}) {
    const Mesh mesh = make_sample(sample, 40);
    const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
    const std::vector<Index> group = numbers_below(mesh.vertex_count());
    constexpr int levels = 3;
    const BisectionTree bisection = bisect_graph({group, &rings}, levels);
    EXPECT_EQ(bisect_graph({group, &rings}, levels).part, bisection.part) << sample;
    ASSERT_EQ(bisection.levels, levels);
    std::vector<int> size(1U << levels, 0);
    int across = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      ASSERT_GE(bisection.part[v], 0);
      ASSERT_LT(bisection.part[v], 1 << levels);
      ++size[bisection.part[v]];
      for (const Index w : rings[v]) across += bisection.part[v] != bisection.part[w] ? 1 : 0;
    }
    const auto [smallest, largest] = std::minmax_element(size.begin(), size.end());
    EXPECT_LT(*largest, 1.3 * *smallest) << sample;
    EXPECT_LT(across, 0.3 * static_cast<double>(rings.values.size())) << sample;
  }
}

// Large graphs are cut by several calls of METIS.
TEST(BisectGraph, CutsALargeGraphLikeASmallOne) {
  const Mesh mesh = make_sample("bumpy_plane", 360);
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  constexpr int levels = 4;
  const BisectionTree bisection = bisect_graph({numbers_below(mesh.vertex_count()), &rings}, levels);
  ASSERT_EQ(bisection.levels, levels);
  std::vector<int> size(1U << levels, 0);
  int across = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    ++size.at(bisection.part[v]);
    for (const Index w : rings[v]) across += bisection.part[v] != bisection.part[w] ? 1 : 0;
  }
  const auto [smallest, largest] = std::minmax_element(size.begin(), size.end());
  EXPECT_LT(*largest, 1.1 * *smallest);
  // Sixteen squares of 90 × 90 vertices have 6 × 360 edges of the grid across their sides.
  EXPECT_LT(across, 2 * 4 * 6 * 360);
}

TEST(NestedDissectionOrder, OrdersALargeMatrixLikeASmallOne) {
  constexpr Index side = 420;  // 24 neighbours each: more than METIS gets at once
  const NormalMatrix lower = lattice_matrix(side, side, 2);
  const std::vector<int> order = nested_dissection_order(lower);
  std::vector<int> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, numbers_below(lower.rows()));
  // The flops of a nested dissection grow with the third power of the side.
  const NormalMatrix small = lattice_matrix(side / 2, side / 2, 2);
  EXPECT_LT(symbolic_factorisation(lower, order, {}).flops(),
            12 * symbolic_factorisation(small, nested_dissection_order(small), {}).flops());
}

TEST(BisectGraph, LeavesAGraphWholeThatIsToHaveOnePart) {
  const Mesh mesh = make_sample("torus", 12);
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  const BisectionTree bisection = bisect_graph({numbers_below(mesh.vertex_count()), &rings}, 0);
  EXPECT_EQ(bisection.part, std::vector<int>(static_cast<std::size_t>(mesh.vertex_count()), 0));
}

TEST(GraphPartition, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const Context context{.threads = 1, .progress = {}, .stop_token = stop.get_token()};
  const Mesh mesh = make_sample("torus", 12);
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  EXPECT_THROW(bisect_graph({numbers_below(mesh.vertex_count()), &rings}, 2, context), Error);
  EXPECT_THROW(nested_dissection_order(lattice_matrix(9, 9), context), Error);
}

}  // namespace
}  // namespace meshgraft
