#include <meshgraft/linalg/linear_solver.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <meshgraft/core/error.h>

#include "matrix_families.h"

namespace meshgraft {
namespace {

class EveryBackend : public testing::TestWithParam<SolverBackend> {};

TEST_P(EveryBackend, SolvesSeveralColumnsAtOnce) {
  for (int k : {1, 2, 7, 30, 64}) {  // the last is large enough for nested dissection
    const NormalMatrix matrix = grid_matrix(k);
    auto solver = make_solver(GetParam());
    solver->analyse(matrix);
    solver->factorise(matrix);
    const Eigen::MatrixXd x = Eigen::MatrixXd::Random(k * k, 3);
    const Eigen::MatrixXd rhs = matrix.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LT((solver->solve(rhs) - x).norm(), 1e-6 * x.norm()) << k;
    EXPECT_EQ(solver->statistics().unknowns, k * k);
    if (GetParam() == SolverBackend::iterative) continue;  // it factorises a smaller matrix
    EXPECT_GE(solver->statistics().factor_nonzeros, matrix.nonZeros());
  }
}

TEST_P(EveryBackend, TakesNewValuesWithoutAnotherAnalysis) {
  NormalMatrix matrix = grid_matrix(12);
  auto solver = make_solver(GetParam());
  solver->analyse(matrix);
  solver->factorise(matrix);
  matrix *= 4.0;
  solver->factorise(matrix);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(144);
  const Eigen::VectorXd rhs = matrix.selfadjointView<Eigen::Lower>() * ones;
  EXPECT_LT((solver->solve(rhs) - ones).norm(), 1e-6);
}

TEST_P(EveryBackend, FactorisesAlikeWhenTheMatrixIsFreed) {
  const NormalMatrix matrix = grid_matrix(40);
  const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(matrix.rows(), 3);
  auto solver = make_solver(GetParam());
  solver->analyse(matrix);
  solver->factorise(matrix);
  const Eigen::MatrixXd x = solver->solve(rhs);
  NormalMatrix copy = matrix;
  solver->factorise_and_free(copy);
  EXPECT_EQ(copy.data().allocatedSize(), 0);
  EXPECT_EQ(solver->solve(rhs), x);
  LinearSolver::Rows in_place = rhs;
  solver->solve_in_place(in_place);
  EXPECT_EQ(Eigen::MatrixXd(in_place), x);
}

TEST_P(EveryBackend, RefusesWhatIsNotPositiveDefinite) {
  const NormalMatrix matrix = grid_matrix(6, 0.0) * -1.0;
  auto solver = make_solver(GetParam());
  solver->analyse(matrix);
  try {
    solver->factorise(matrix);
    FAIL() << "accepted a negative definite matrix";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unsolvable);
    EXPECT_EQ(error.id(), "linalg.not_positive_definite");
    EXPECT_EQ(error.fact().get<std::int64_t>("count"), matrix.rows());
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST_P(EveryBackend, SolvesFromSeveralThreadsToTheSameBytes) {
  const NormalMatrix matrix = grid_matrix(40);
  auto solver = make_solver(GetParam());
  solver->analyse(matrix);
  solver->factorise(matrix);
  const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(1600, 3);
  Eigen::MatrixXd first, second;
  std::thread other([&] { first = solver->solve(rhs); });
  second = solver->solve(rhs);
  other.join();
  EXPECT_TRUE(same_bytes(first, second));
}

TEST_P(EveryBackend, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  auto solver = make_solver(GetParam());
  EXPECT_THROW(solver->analyse(grid_matrix(5), {}, context), Error);
}

TEST_P(EveryBackend, EstimatesTheConditionNumberFromBelow) {
  const NormalMatrix matrix = grid_matrix(9);
  auto solver = make_solver(GetParam());
  solver->analyse(matrix);
  solver->factorise(matrix);
  const Eigen::MatrixXd full = full_matrix(matrix);
  const double norm = full.cwiseAbs().colwise().sum().maxCoeff();
  const double exact = norm * full.inverse().cwiseAbs().colwise().sum().maxCoeff();
  EXPECT_NEAR(one_norm(matrix), norm, 1e-9 * norm);
  const double estimate = estimate_condition(norm, *solver);
  EXPECT_LE(estimate, exact * (1 + 1e-6));
  EXPECT_GE(estimate, exact / 10);
}

/// Returns a grid's matrix with one more unknown that is coupled with all others.
NormalMatrix with_shared_unknown(const NormalMatrix& grid) {
  const Eigen::Index n = grid.rows();
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  for (Eigen::Index column = 0; column < n; ++column) {
    for (NormalMatrix::InnerIterator entry(grid, column); entry; ++entry)
      entries.emplace_back(entry.row(), column, entry.value());
    entries.emplace_back(n, column, 1e-3);
  }
  entries.emplace_back(n, n, static_cast<double>(n));
  NormalMatrix lower(n + 1, n + 1);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

TEST_P(EveryBackend, SolvesTheSameWithACouplingGraph) {
  constexpr int k = 110;  // large enough for nested dissection
  const IndexLists rings = grid_neighbours(k, k);
  const NormalMatrix matrix = with_shared_unknown(grid_matrix(k));
  std::vector<Index> group = numbers_below(matrix.rows());
  group.back() = -1;
  auto with = make_solver(GetParam()), without = make_solver(GetParam());
  with->analyse(matrix, {group, &rings});
  without->analyse(matrix);
  with->factorise(matrix);
  without->factorise(matrix);
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(matrix.rows(), 2);
  const Eigen::MatrixXd rhs = matrix.selfadjointView<Eigen::Lower>() * x;
  const SolveOptions options{.tolerance = 1e-11};
  EXPECT_LT((with->solve(rhs, options) - x).norm(), 1e-6 * x.norm());
  EXPECT_LT((with->solve(rhs, options) - without->solve(rhs, options)).norm(), 1e-6 * x.norm());
}

TEST(NestedDissection, TakesAGraphInPiecesAndGroupsOfSeveral) {
  // Each grid position has two unknowns, but a middle column has none, so the graph falls into two pieces.
  constexpr int k = 90;
  const IndexLists rings = grid_neighbours(k, k);
  std::vector<Index> group;
  for (Index place = 0; place < k * k; ++place)
    if (place % k != k / 2) group.insert(group.end(), 2, place);
  std::vector<std::int64_t> first(k * k, -1);
  for (std::size_t u = 0; u < group.size(); u += 2) first[group[u]] = static_cast<std::int64_t>(u);
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  for (std::size_t u = 0; u < group.size(); ++u) {
    const auto row = static_cast<std::int64_t>(u);
    entries.emplace_back(row, row, 20.0);
    if (u % 2 == 1) entries.emplace_back(row, row - 1, -1.0);
    for (const Index place : rings[group[u]])
      for (std::int64_t other = first[place]; first[place] >= 0 && other < first[place] + 2; ++other)
        if (other < row) entries.emplace_back(row, other, -1.0);
  }
  const auto n = static_cast<Eigen::Index>(group.size());
  NormalMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  for (const SolverBackend backend : available_backends()) {
    auto solver = make_solver(backend);
    solver->analyse(matrix, {group, &rings});
    solver->factorise(matrix);
    const Eigen::VectorXd x = Eigen::VectorXd::Random(n);
    const Eigen::VectorXd rhs = matrix.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LT((solver->solve(rhs) - x).norm(), 1e-9 * x.norm());
  }
}

TEST(NestedDissection, CanBeCancelledAtAnyTime) {
  constexpr int k = 110;
  const IndexLists rings = grid_neighbours(k, k);
  const NormalMatrix matrix = grid_matrix(k);
  const std::vector<Index> group = numbers_below(matrix.rows());
  for (const int milliseconds : {0, 1, 3, 10, 30, 100}) {
    std::stop_source stop;
    const Context context{.threads = 2, .progress = {}, .stop_token = stop.get_token()};
    std::jthread other([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
      stop.request_stop();
    });
    auto solver = make_solver();
    try {
      solver->analyse(matrix, {group, &rings}, context);
      solver->factorise(matrix, context);
      solver->solve(Eigen::MatrixXd::Random(k * k, 3), context);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
  }
}

TEST(NestedDissection, SolvesWhateverTheGraphSays) {
  // These graphs are unrelated to the matrix. Sets are then coupled irregularly, and the solver must find all
  // couplings in the matrix.
  constexpr int k = 100;
  const NormalMatrix matrix = grid_matrix(k);
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(k * k, 3);
  const Eigen::MatrixXd rhs = matrix.selfadjointView<Eigen::Lower>() * x;
  std::minstd_rand generator(3);
  for (const Index groups : {1, 7, 60, 500, k * k}) {
    std::vector<Index> group;
    for (int u = 0; u < k * k; ++u)
      group.push_back(u % 97 == 0 ? -1 : static_cast<Index>(generator() % static_cast<unsigned>(groups)));
    std::vector<std::pair<Index, Index>> edges;
    for (Index edge = 0; edge < groups; ++edge)
      edges.emplace_back(generator() % static_cast<unsigned>(groups),
                         generator() % static_cast<unsigned>(groups));
    const IndexLists neighbours = neighbours_of(groups, edges);
    auto solver = make_solver();
    solver->analyse(matrix, {group, &neighbours});
    solver->factorise(matrix);
    EXPECT_LT((solver->solve(rhs) - x).norm(), 1e-6 * x.norm()) << groups << " groups";
  }
}

TEST_P(EveryBackend, GivesTheSameBytesForAnyNumberOfThreadsAndColumns) {
  constexpr int k = 110;
  const IndexLists rings = grid_neighbours(k, k);
  const NormalMatrix matrix = grid_matrix(k);
  const std::vector<Index> group = numbers_below(matrix.rows());
  const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(k * k, 40);
  const auto factor = [&](int threads) {
    auto solver = make_solver(GetParam());
    solver->analyse(matrix, {group, &rings}, with_threads(threads));
    solver->factorise(matrix, with_threads(threads));
    return solver;
  };
  const auto by_one = factor(1), by_two = factor(2);
  for (const int columns : {1, 2, 3, 5, 32, 40}) {
    if (columns > 5 && GetParam() == SolverBackend::iterative) continue;  // solves four at a time
    const Eigen::MatrixXd one = by_one->solve(rhs.leftCols(columns), with_threads(1)),
                          two = by_two->solve(rhs.leftCols(columns), with_threads(2));
    EXPECT_TRUE(same_bytes(one, two)) << columns;
    const Eigen::MatrixXd residual = matrix.selfadjointView<Eigen::Lower>() * one - rhs.leftCols(columns);
    EXPECT_LT(residual.norm(), 1e-8 * rhs.norm()) << columns;  // iterations stop at a tolerance
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, EveryBackend, testing::ValuesIn(available_backends()),
                         [](const auto& backend) {
                           switch (backend.param) {
                             case SolverBackend::multifrontal: return "multifrontal";
                             case SolverBackend::eigen: return "eigen";
                             default: return "iterative";
                           }
                         });

TEST(Backends, OneThatIsNotBuiltInIsRefusedByName) {
  EXPECT_NO_THROW(make_solver(SolverBackend::automatic));
  const auto backends = available_backends();
  if (std::find(backends.begin(), backends.end(), SolverBackend::multifrontal) != backends.end()) {
    EXPECT_NO_THROW(make_solver(SolverBackend::multifrontal));
    return;
  }
  try {
    make_solver(SolverBackend::multifrontal);
    FAIL() << "made a solver that is not there";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.id(), "linalg.no_multifrontal_solver");
    EXPECT_NE(error.remedy().find("another backend"), std::string::npos) << error.remedy();
    EXPECT_NE(error.remedy().find("MESHGRAFT_WITH_MULTIFRONTAL"), std::string::npos) << error.remedy();
  }
}

}  // namespace
}  // namespace meshgraft
