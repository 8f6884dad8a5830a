#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/linalg/linear_solver.h>

#include "matrix_families.h"

namespace meshgraft {
namespace {

TEST(EigenSolver, SolvesEveryFamily) {
  for (const NamedMatrix& family : matrix_families()) {
    if (family.lower.rows() == 0) continue;
    auto solver = make_solver(SolverBackend::eigen);
    solver->analyse(family.lower);
    solver->factorise(family.lower);
    const Eigen::MatrixXd x = Eigen::MatrixXd::Random(family.lower.rows(), 3);
    const Eigen::MatrixXd rhs = family.lower.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LE((solver->solve(rhs) - x).norm(), 1e-10 * x.norm()) << family.name;
  }
}

// Minimum degree finds an order without fill wherever there is one, as for forests.
TEST(EigenSolver, FillsNothingInForests) {
  const std::set<std::string> forests{"one unknown",     "diagonal",       "band",
                                      "dense first row", "dense last row", "pieces"};
  std::size_t found = 0;
  for (const NamedMatrix& family : matrix_families()) {
    if (!forests.contains(family.name)) continue;
    auto solver = make_solver(SolverBackend::eigen);
    solver->analyse(family.lower);
    solver->factorise(family.lower);
    EXPECT_EQ(solver->statistics().factor_nonzeros, family.lower.nonZeros()) << family.name;
    ++found;
  }
  EXPECT_EQ(found, forests.size());
}

TEST(EigenSolver, CountsWhatItStores) {
  for (const NamedMatrix& family : matrix_families()) {
    if (family.lower.rows() == 0) continue;
    auto solver = make_solver(SolverBackend::eigen);
    solver->analyse(family.lower);
    solver->factorise(family.lower);
    const SolverStatistics statistics = solver->statistics();
    const auto unknowns = static_cast<double>(statistics.unknowns),
               nonzeros = static_cast<double>(statistics.factor_nonzeros);
    EXPECT_EQ(statistics.backend, SolverBackend::eigen);
    EXPECT_EQ(statistics.ordering, Ordering::minimum_degree);
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

TEST(EigenSolver, RefusesEveryFamilyWithANegativeDiagonalEntry) {
  for (const NamedMatrix& family : matrix_families())
    for (Eigen::Index bad = 0; bad < family.lower.rows(); bad += 13) {
      NormalMatrix indefinite = family.lower;
      indefinite.coeffRef(bad, bad) *= -1;
      auto solver = make_solver(SolverBackend::eigen);
      solver->analyse(indefinite);
      try {
        solver->factorise(indefinite);
        ADD_FAILURE() << "factorised an indefinite matrix: " << family.name;
      } catch (const Error& error) {
        EXPECT_EQ(error.id(), "linalg.not_positive_definite");
      }
    }
}

}  // namespace
}  // namespace meshgraft
