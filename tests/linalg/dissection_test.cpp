#include "linalg/direct/dissection.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "linalg/direct/multifrontal.h"
#include "matrix_families.h"

namespace meshgraft {
namespace {

struct System {
  std::string name;
  NormalMatrix lower;
  std::vector<Index> group;
  IndexLists neighbours;
  OrderingGraph graph() const { return {group, &neighbours}; }
};

/// Returns systems of meshes whose vertices are coupled with two rings, some with one unknown coupled with all.
/// Others have ordering graphs that are unrelated to the matrix.
std::vector<System> systems() {
  std::vector<System> systems;
  for (const char* sample : {"bumpy_plane", "torus", "knot"}) {
    const Mesh mesh = make_sample(sample, 48);
    System system{sample, {}, {}, vertex_rings(mesh.vertex_count(), mesh.faces)};
    std::vector<std::pair<Index, Index>> edges;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      for (const Index w : system.neighbours[v])
        for (const Index x : system.neighbours[w]) edges.emplace_back(v, x);
    system.group.resize(static_cast<std::size_t>(mesh.vertex_count()));
    std::iota(system.group.begin(), system.group.end(), 0);
    system.lower = matrix_of_edges(mesh.vertex_count(), edges);
    systems.push_back(system);
    for (Index v = 0; v < mesh.vertex_count(); ++v) edges.emplace_back(v, mesh.vertex_count());
    system.name += " with a shared unknown";
    system.group.push_back(-1);
    system.lower = matrix_of_edges(mesh.vertex_count() + 1, edges);
    systems.push_back(std::move(system));
  }
  std::minstd_rand generator(6);
  for (const unsigned groups : {1U, 40U, 900U}) {
    System system{"random groups", lattice_matrix(40, 40, 2), {}, {}};
    for (int u = 0; u < 1600; ++u)
      system.group.push_back(u % 97 == 0 ? -1 : static_cast<Index>(generator() % groups));
    std::vector<std::pair<Index, Index>> edges;
    for (unsigned edge = 0; edge < 2 * groups; ++edge)
      edges.emplace_back(generator() % groups, generator() % groups);
    system.neighbours = neighbours_of(static_cast<Index>(groups), edges);
    systems.push_back(std::move(system));
  }
  return systems;
}

bool lies_below(int set, int other, const Dissection& dissection) {
  while (set >= 0 && set != other) set = dissection.parent[set];
  return set == other;
}

TEST(Dissection, HasEveryUnknownInOneSet) {
  for (const System& system : systems()) {
    const Dissection dissection = dissect(system.lower, system.graph());
    std::vector<int> times(system.group.size(), 0);
    for (int set = 0; set < dissection.sets(); ++set) {
      EXPECT_TRUE(std::is_sorted(dissection.unknowns[set].begin(), dissection.unknowns[set].end()));
      for (const int unknown : dissection.unknowns[set]) {
        ++times[unknown];
        EXPECT_EQ(dissection.set_of[unknown], set) << system.name;
      }
      if (set + 1 < dissection.sets()) {
        EXPECT_GT(dissection.parent[set], set) << system.name;
      } else {
        EXPECT_EQ(dissection.parent[set], -1) << system.name;
      }
    }
    EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int count) { return count == 1; })) << system.name;
  }
}

TEST(Dissection, CouplesUnknownsOfTwoSetsOnlyIfOneLiesBelowTheOther) {
  for (const System& system : systems()) {
    const Dissection dissection = dissect(system.lower, system.graph());
    int wrong = 0;
    for (Eigen::Index column = 0; column < system.lower.cols(); ++column)
      for (NormalMatrix::InnerIterator it(system.lower, column); it; ++it) {
        const int a = dissection.set_of[column], b = dissection.set_of[it.row()];
        wrong += lies_below(a, b, dissection) || lies_below(b, a, dissection) ? 0 : 1;
      }
    EXPECT_EQ(wrong, 0) << system.name;
  }
}

TEST(Dissection, CutsMeshesIntoManyLeavesBySmallSeparators) {
  for (const System& system : systems()) {
    if (system.name == "random groups") continue;
    const Dissection dissection = dissect(system.lower, system.graph());
    std::size_t leaves = 0, in_leaves = 0, largest = 0;
    for (int set = 0; set < dissection.sets(); ++set) {
      if (!dissection.is_leaf(set)) continue;
      ++leaves;
      in_leaves += dissection.unknowns[set].size();
      largest = std::max(largest, dissection.unknowns[set].size());
    }
    EXPECT_GE(leaves, 4U) << system.name;
    EXPECT_LE(largest, 600U) << system.name;
    EXPECT_GT(2 * in_leaves, system.group.size()) << system.name;
  }
}

// Cuts a grid in the middle. If couplings reach over `reach` steps, the separator has exactly `reach` columns.
TEST(Dissection, HasSeparatorsAsThickAsCouplingsAreLong) {
  constexpr Index width = 40, height = 25;
  for (const Index reach : {1, 2, 3}) {
    std::vector<int> side;
    for (Index position = 0; position < width * height; ++position)
      side.push_back(position % width < width / 2 ? 0 : 1);
    const IndexLists neighbours = grid_neighbours(width, height);
    OrderingGraph graph{numbers_below(width * height), &neighbours,
                        std::make_shared<BisectionTree>(BisectionTree{1, side})};
    const Dissection dissection = dissect(lattice_matrix(width, height, reach), graph);
    ASSERT_EQ(dissection.sets(), 4) << "two sides, the separator, unknowns without a group";
    EXPECT_EQ(dissection.unknowns[2].size(), static_cast<std::size_t>(reach * height));
    EXPECT_EQ(dissection.unknowns[0].size() + dissection.unknowns[1].size(),
              static_cast<std::size_t>((width - reach) * height));
  }
}

TEST(Dissection, IsTheSameEveryTime) {
  for (const System& system : systems()) {
    const Dissection first = dissect(system.lower, system.graph()),
                     second = dissect(system.lower, system.graph());
    EXPECT_EQ(first.set_of, second.set_of) << system.name;
  }
}

TEST(Dissection, IsOfAFactorThatFillsLittleAndSolves) {
  std::minstd_rand generator(7);
  for (const System& system : systems()) {
    const SupernodalPattern pattern =
        symbolic_factorisation(system.lower, dissect(system.lower, system.graph()), {});
    std::vector<int> random(system.group.size());
    std::iota(random.begin(), random.end(), 0);
    std::shuffle(random.begin(), random.end(), generator);
    if (system.name != "random groups") {
      EXPECT_LT(pattern.flops(), 0.5 * symbolic_factorisation(system.lower, random, {}).flops()) << system.name;
    }

    MultifrontalFactor factor(pattern);
    factor.factorise(factor.permuted(system.lower, {}), {});
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(system.lower.rows(), -1, 2),
                          rhs = system.lower.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LT((factor.solve(rhs, {}) - x).norm(), 1e-9 * x.norm()) << system.name;
  }
}

TEST(OneLeaf, HasAllUnknowns) {
  for (const int unknowns : {0, 1, 7}) {
    const Dissection dissection = one_leaf(unknowns);
    EXPECT_EQ(dissection.sets(), 1);
    EXPECT_TRUE(dissection.is_leaf(0));
    EXPECT_EQ(dissection.unknowns[0].size(), static_cast<std::size_t>(unknowns));
    EXPECT_EQ(dissection.set_of, std::vector<int>(static_cast<std::size_t>(unknowns), 0));
  }
}

}  // namespace
}  // namespace meshgraft
