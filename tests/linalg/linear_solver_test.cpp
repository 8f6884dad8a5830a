#include <meshgraft/linalg/linear_solver.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <numeric>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <meshgraft/core/error.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "matrix_families.h"

namespace meshgraft {
namespace {

/// Returns a 2D bi-Laplacian on a k×k grid plus a small multiple of the identity, which is positive definite.
NormalMatrix grid_matrix(int k, double shift = 1e-3) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto at = [k](int x, int y) { return y * k + x; };
  for (int y = 0; y < k; ++y) {
    for (int x = 0; x < k; ++x) {
      entries.emplace_back(at(x, y), at(x, y), 4.0);
      if (x > 0) entries.emplace_back(at(x, y), at(x - 1, y), -1.0);
      if (x + 1 < k) entries.emplace_back(at(x, y), at(x + 1, y), -1.0);
      if (y > 0) entries.emplace_back(at(x, y), at(x, y - 1), -1.0);
      if (y + 1 < k) entries.emplace_back(at(x, y), at(x, y + 1), -1.0);
    }
  }
  SparseRows laplacian(k * k, k * k);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  SparseRows diagonal(k * k, k * k);
  diagonal.setIdentity();
  diagonal *= shift;
  SparseRows identity(k * k, k * k);
  identity.setIdentity();
  return normal_equations(transpose(laplacian), laplacian, diagonal, identity, diagonal);
}

Eigen::MatrixXd dense(const NormalMatrix& lower) {
  const Eigen::MatrixXd half = Eigen::MatrixXd(lower);
  return Eigen::MatrixXd(half.selfadjointView<Eigen::Lower>());
}

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
  EXPECT_EQ(std::memcmp(first.data(), second.data(), sizeof(double) * first.size()), 0);
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
  const Eigen::MatrixXd full = dense(matrix);
  const double norm = full.cwiseAbs().colwise().sum().maxCoeff();
  const double exact = norm * full.inverse().cwiseAbs().colwise().sum().maxCoeff();
  EXPECT_NEAR(one_norm(matrix), norm, 1e-9 * norm);
  const double estimate = estimate_condition(norm, *solver);
  EXPECT_LE(estimate, exact * (1 + 1e-6));
  EXPECT_GE(estimate, exact / 10);
}

/// Returns the neighbours in a k×k grid.
IndexLists grid_rings(int k) {
  IndexLists rings;
  for (int y = 0; y < k; ++y) {
    for (int x = 0; x < k; ++x) {
      for (const auto& [dx, dy] : {std::pair{0, -1}, {-1, 0}, {1, 0}, {0, 1}})
        if (x + dx >= 0 && x + dx < k && y + dy >= 0 && y + dy < k)
          rings.values.push_back((y + dy) * k + x + dx);
      rings.offsets.push_back(static_cast<Index>(rings.values.size()));
    }
  }
  return rings;
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
  const IndexLists rings = grid_rings(k);
  const NormalMatrix matrix = with_shared_unknown(grid_matrix(k));
  std::vector<Index> group(static_cast<std::size_t>(matrix.rows()), -1);
  std::iota(group.begin(), group.end() - 1, Index{0});
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

/// Returns a bi-Laplacian over rings, plus the identity.
NormalMatrix bilaplacian(const IndexLists& rings) {
  const Index n = rings.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index v = 0; v < n; ++v) {
    entries.emplace_back(v, v, static_cast<double>(rings[v].size()));
    for (const Index w : rings[v]) entries.emplace_back(v, w, -1.0);
  }
  SparseRows laplacian(n, n), identity(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  identity.setIdentity();
  return normal_equations(transpose(laplacian), laplacian, identity, identity, identity);
}

TEST(NestedDissection, FillsLessThanMinimumDegreeAndDependsOnNoOtherThread) {
  if (available_backends().front() != SolverBackend::multifrontal)
    GTEST_SKIP() << "this build has no multifrontal solver";
  for (const char* sample : {"bumpy_plane", "torus", "knot", "cylinder"}) {
    const Mesh mesh = make_sample(sample, 140);
    const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
    const NormalMatrix matrix = bilaplacian(rings);
    std::vector<Index> group(static_cast<std::size_t>(matrix.rows()));
    std::iota(group.begin(), group.end(), Index{0});
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
    ASSERT_EQ(first.ordering, "dissection") << mesh.vertex_count();
    EXPECT_EQ(minimum_degree.ordering, "amd");
    EXPECT_EQ(first.factor_nonzeros, second.factor_nonzeros);
    EXPECT_LT(first.factor_flops, minimum_degree.factor_flops) << sample;
  }
}

TEST(NestedDissection, TakesAGraphInPiecesAndGroupsOfSeveral) {
  // Each grid position has two unknowns, but a middle column has none, so the graph falls into two pieces.
  constexpr int k = 90;
  const IndexLists rings = grid_rings(k);
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

TEST(NestedDissection, CutsAGraphOnceForSeveralSystems) {
  if (available_backends().front() != SolverBackend::multifrontal)
    GTEST_SKIP() << "this build has no multifrontal solver";
  constexpr int k = 100;
  const IndexLists rings = grid_rings(k);
  const NormalMatrix matrix = grid_matrix(k);
  std::vector<Index> group(static_cast<std::size_t>(matrix.rows()));
  std::iota(group.begin(), group.end(), Index{0});
  const auto cuts = std::make_shared<BisectionTree>();
  auto alone = make_solver(), first = make_solver(), second = make_solver();
  alone->analyse(matrix, {group, &rings});
  first->analyse(matrix, {group, &rings, cuts});
  const BisectionTree filled = *cuts;
  EXPECT_EQ(filled.part.size(), group.size());
  second->analyse(matrix, {group, &rings, cuts});
  EXPECT_EQ(cuts->part, filled.part);
  for (const auto* solver : {&first, &second})
    EXPECT_EQ((*solver)->statistics().factor_nonzeros, alone->statistics().factor_nonzeros);
}

TEST(NestedDissection, CanBeCancelledAtAnyTime) {
  constexpr int k = 110;
  const IndexLists rings = grid_rings(k);
  const NormalMatrix matrix = grid_matrix(k);
  std::vector<Index> group(static_cast<std::size_t>(matrix.rows()));
  std::iota(group.begin(), group.end(), Index{0});
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
    std::vector<std::vector<Index>> near(static_cast<std::size_t>(groups));
    for (Index edge = 0; edge < groups; ++edge) {
      const auto a = static_cast<Index>(generator() % static_cast<unsigned>(groups)),
                 b = static_cast<Index>(generator() % static_cast<unsigned>(groups));
      if (a == b) continue;
      near[a].push_back(b);
      near[b].push_back(a);
    }
    IndexLists neighbours;
    for (std::vector<Index>& list : near) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      neighbours.values.insert(neighbours.values.end(), list.begin(), list.end());
      neighbours.offsets.push_back(static_cast<Index>(neighbours.values.size()));
    }
    auto solver = make_solver();
    solver->analyse(matrix, {group, &neighbours});
    solver->factorise(matrix);
    EXPECT_LT((solver->solve(rhs) - x).norm(), 1e-6 * x.norm()) << groups << " groups";
  }
}

TEST_P(EveryBackend, GivesTheSameBytesForAnyNumberOfThreadsAndColumns) {
  constexpr int k = 110;
  const IndexLists rings = grid_rings(k);
  const NormalMatrix matrix = grid_matrix(k);
  std::vector<Index> group(static_cast<std::size_t>(matrix.rows()));
  std::iota(group.begin(), group.end(), Index{0});
  const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(k * k, 40);
  const auto context = [](int threads) {
    return Context{.threads = threads, .progress = {}, .stop_token = {}};
  };
  const auto factor = [&](int threads) {
    auto solver = make_solver(GetParam());
    solver->analyse(matrix, {group, &rings}, context(threads));
    solver->factorise(matrix, context(threads));
    return solver;
  };
  const auto by_one = factor(1), by_two = factor(2);
  for (const int columns : {1, 2, 3, 5, 32, 40}) {
    if (columns > 5 && GetParam() == SolverBackend::iterative) continue;  // solves four at a time
    const Eigen::MatrixXd one = by_one->solve(rhs.leftCols(columns), context(1)),
                          two = by_two->solve(rhs.leftCols(columns), context(2));
    EXPECT_EQ(std::memcmp(one.data(), two.data(), sizeof(double) * one.size()), 0) << columns;
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
    EXPECT_NE(error.remedy().find("'auto'"), std::string::npos) << error.remedy();
    EXPECT_NE(error.remedy().find("MESHGRAFT_WITH_MULTIFRONTAL"), std::string::npos) << error.remedy();
  }
}

TEST(Multifrontal, OrdersByMinimumDegreeOrLargeMatricesByNestedDissection) {
  if (available_backends().front() != SolverBackend::multifrontal) GTEST_SKIP();
  struct Case {
    Index width, height;
    const char* ordering;
  };
  for (const auto& [width, height, ordering] :
       {Case{0, 0, "amd"}, {1, 1, "amd"}, {9, 30, "amd"}, {25, 400, "amd"}, {10, 5000, "metis"}}) {
    const NormalMatrix matrix = lattice_matrix(width, height);
    auto solver = make_solver(SolverBackend::multifrontal);
    solver->analyse(matrix);
    solver->factorise(matrix);
    EXPECT_EQ(solver->statistics().backend, "multifrontal");
    EXPECT_EQ(solver->statistics().ordering, ordering) << width * height;
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 3),
                          rhs = matrix.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LE((solver->solve(rhs) - x).norm(), 1e-9 * x.norm()) << width * height;
  }
}

TEST(SparseProducts, AgreeWithEigenAndDoNotDependOnThreads) {
  std::srand(7);
  std::vector<Eigen::Triplet<double>> a_entries, b_entries;
  for (int k = 0; k < 20000; ++k) {
    a_entries.emplace_back(std::rand() % 1500, std::rand() % 900, std::rand() / double(RAND_MAX) - 0.5);
    b_entries.emplace_back(std::rand() % 900, std::rand() % 1100, std::rand() / double(RAND_MAX) - 0.5);
  }
  SparseRows a(1500, 900), b(900, 1100);
  a.setFromTriplets(a_entries.begin(), a_entries.end());
  b.setFromTriplets(b_entries.begin(), b_entries.end());
  const SparseRows one = multiply(a, b, Context{.threads = 1});
  const SparseRows two = multiply(a, b, Context{.threads = 2});
  const SparseRows eigen = a * b;
  EXPECT_LT((one - eigen).norm(), 1e-12 * eigen.norm());
  ASSERT_EQ(one.nonZeros(), two.nonZeros());
  EXPECT_EQ(std::memcmp(one.valuePtr(), two.valuePtr(), sizeof(double) * one.nonZeros()), 0);
  EXPECT_EQ(std::memcmp(one.innerIndexPtr(), two.innerIndexPtr(), sizeof(int) * one.nonZeros()), 0);

  const SparseRows back = transpose(a, Context{.threads = 2}), eigens = a.transpose();
  EXPECT_EQ((back - eigens).norm(), 0);
  EXPECT_EQ(back.nonZeros(), eigens.nonZeros());
  EXPECT_EQ((stack(a, a).bottomRows(1500) - a).norm(), 0);
  EXPECT_LT((difference_of_products(a, b, a, b)).norm(), 1e-12 * eigen.norm());

  for (int columns : {1, 3, 8}) {
    const Columns x = Columns::Random(900, columns);
    EXPECT_LT((multiply(a, x) - a * x).norm(), 1e-12 * x.norm());
  }
}

/// Returns random rows, in runs of `together` rows with the same columns.
SparseRows random_runs(int rows, int columns, int together, std::minstd_rand& generator) {
  const auto random = [&] { return static_cast<double>(generator() % 2001) / 1000.0 - 1.0; };
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < rows; row += together)
    for (int k = 0; k < 6; ++k) {
      const int column = static_cast<int>(generator() % static_cast<unsigned>(columns));
      for (int r = row; r < std::min(rows, row + together); ++r) entries.emplace_back(r, column, random());
    }
  SparseRows matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(SparseProducts, TakeRowsWithTheSameColumnsTogether) {
  std::minstd_rand generator(11);
  for (const int together : {1, 2, 3, 4, 5}) {
    const SparseRows a = random_runs(200, 300, together, generator),
                     b = random_runs(300, 150, together, generator);
    EXPECT_LT((multiply(a, b) - SparseRows(a * b)).norm(), 1e-12) << together;
    const SparseRows columnwise = transpose(a);  // has runs of columns
    EXPECT_LT((multiply(columnwise, a) - SparseRows(columnwise * a)).norm(), 1e-12) << together;

    const SparseRows K = multiply(transpose(random_runs(50, 300, together, generator)),
                                  random_runs(50, 300, together, generator));
    const SparseRows symmetric = K + transpose(K), A = random_runs(80, 150, together, generator);
    const Eigen::MatrixXd expected = Eigen::MatrixXd(SparseRows(transpose(A) * A)) +
                                     Eigen::MatrixXd(SparseRows(transpose(b) * symmetric * b));
    const NormalMatrix lower = normal_equations(transpose(A), A, transpose(b), symmetric, b);
    EXPECT_LT((Eigen::MatrixXd(lower) - Eigen::MatrixXd(expected.triangularView<Eigen::Lower>())).norm(),
              1e-10);
  }
}

TEST(SparseProducts, LowerTriangleIsThatOfTheFullSum) {
  const NormalMatrix lower = grid_matrix(8);
  const Eigen::MatrixXd half = Eigen::MatrixXd(lower);
  EXPECT_EQ(half.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().norm(), 0);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(lower)).eigenvalues()[0], 0);
}

}  // namespace
}  // namespace meshgraft
