#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "matrix_families.h"

namespace meshgraft {
namespace {

/// Returns a bi-Laplacian over rings, plus the identity.
NormalMatrix bilaplacian(const IndexLists& rings) {
  const Index n = rings.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index v = 0; v < n; ++v) {
    entries.emplace_back(v, v, static_cast<double>(rings[v].size()));
    for (const Index w : rings[v]) entries.emplace_back(v, w, -1.0);
  }
  SparseRows laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return gram_matrix(laplacian, 1);
}

TEST(MultifrontalSolver, FillsLessThanMinimumDegreeAndDependsOnNoOtherThread) {
  for (const char* sample : {"bumpy_plane", "torus", "knot", "cylinder"}) {
    const Mesh mesh = make_sample(sample, 140);
    const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
    const NormalMatrix matrix = bilaplacian(rings);
    const std::vector<Index> group = numbers_below(matrix.rows());
    const auto analysed = [&](const OrderingGraph& graph) {
      auto solver = make_solver(SolverBackend::multifrontal);
      solver->analyse(matrix, graph);
      return solver->statistics();
    };
    SolverStatistics first, second;
    std::thread other([&] { first = analysed({group, &rings}); });
    second = analysed({group, &rings});
    other.join();
    const SolverStatistics minimum_degree = analysed({});
    ASSERT_EQ(first.ordering, Ordering::mesh_dissection) << mesh.vertex_count();
    EXPECT_EQ(minimum_degree.ordering, Ordering::minimum_degree);
    EXPECT_EQ(first.factor_nonzeros, second.factor_nonzeros);
    EXPECT_LT(first.factor_flops, minimum_degree.factor_flops) << sample;
  }
}

TEST(MultifrontalSolver, CutsAGraphOnceForSeveralSystems) {
  constexpr int k = 100;
  const IndexLists rings = grid_neighbours(k, k);
  const NormalMatrix matrix = grid_matrix(k);
  const std::vector<Index> group = numbers_below(matrix.rows());
  const auto bisection = std::make_shared<BisectionTree>();
  auto alone = make_solver(), first = make_solver(), second = make_solver();
  alone->analyse(matrix, {group, &rings});
  first->analyse(matrix, {group, &rings, bisection});
  const BisectionTree filled = *bisection;
  EXPECT_EQ(filled.part.size(), group.size());
  second->analyse(matrix, {group, &rings, bisection});
  EXPECT_EQ(bisection->part, filled.part);
  for (const auto* solver : {&first, &second})
    EXPECT_EQ((*solver)->statistics().factor_nonzeros, alone->statistics().factor_nonzeros);
}

TEST(MultifrontalSolver, OrdersByMinimumDegreeOrLargeMatricesByNestedDissection) {
  struct Case {
    Index width, height;
    Ordering ordering;
  };
  for (const auto& [width, height, ordering] : {Case{0, 0, Ordering::minimum_degree},
                                                {1, 1, Ordering::minimum_degree},
                                                {9, 30, Ordering::minimum_degree},
                                                {25, 400, Ordering::minimum_degree},
                                                {10, 5000, Ordering::nested_dissection}}) {
    const NormalMatrix matrix = lattice_matrix(width, height);
    auto solver = make_solver(SolverBackend::multifrontal);
    solver->analyse(matrix);
    solver->factorise(matrix);
    EXPECT_EQ(solver->statistics().backend, SolverBackend::multifrontal);
    EXPECT_EQ(solver->statistics().ordering, ordering) << width * height;
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 3),
                          rhs = matrix.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LE((solver->solve(rhs) - x).norm(), 1e-9 * x.norm()) << width * height;
  }
}

TEST(MultifrontalSolver, CountsWhatItStores) {
  for (const NamedMatrix& family : matrix_families()) {
    auto solver = make_solver(SolverBackend::multifrontal);
    solver->analyse(family.lower);
    solver->factorise(family.lower);
    const SolverStatistics statistics = solver->statistics();
    const auto unknowns = static_cast<double>(statistics.unknowns),
               nonzeros = static_cast<double>(statistics.factor_nonzeros);
    EXPECT_EQ(statistics.unknowns, family.lower.rows());
    EXPECT_EQ(statistics.matrix_nonzeros, family.lower.nonZeros());
    EXPECT_GE(statistics.factor_nonzeros, statistics.matrix_nonzeros) << family.name;
    EXPECT_LE(nonzeros, unknowns * (unknowns + 1) / 2) << family.name;
    // Σ (non-zeros of a column)² is least if all columns are alike, and most if they are as long as possible.
    EXPECT_GE(unknowns * statistics.factor_flops * (1 + 1e-12), nonzeros * nonzeros) << family.name;
    EXPECT_LE(statistics.factor_flops, unknowns * nonzeros) << family.name;
    EXPECT_GE(static_cast<double>(statistics.peak_memory_bytes), 8 * nonzeros) << family.name;
  }
}

}  // namespace
}  // namespace meshgraft
