// The backend `iterative` is as accurate as asked for, and its iterations do not grow with the problem.
#include <cmath>
#include <cstring>
#include <functional>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/samples/samples.h>

#include "matrix_families.h"

namespace meshgraft {
namespace {

/// A thin plate over a mesh: the bi-Laplacian of its free vertices, and what the solver is told about them.
struct Plate {
  IndexLists rings;
  std::vector<Index> free;
  NormalMatrix matrix;
  OrderingGraph graph() const { return {free, &rings, {}, positions}; }
  Points positions;  ///< of the free vertices
};

Plate make_plate(const Mesh& mesh, const std::function<bool(Index)>& held) {
  Plate plate;
  plate.rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  std::vector<Index> column(static_cast<std::size_t>(mesh.vertex_count()), -1);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!held(v)) {
      column[v] = static_cast<Index>(plate.free.size());
      plate.free.push_back(v);
    }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const auto ring = plate.rings[v];
    if (column[v] >= 0) entries.emplace_back(v, column[v], 1.0);
    for (const Index w : ring)
      if (column[w] >= 0) entries.emplace_back(v, column[w], -1.0 / static_cast<double>(ring.size()));
  }
  const auto columns = static_cast<Eigen::Index>(plate.free.size());
  SparseRows rows(mesh.vertex_count(), columns);
  rows.setFromTriplets(entries.begin(), entries.end());
  plate.matrix = gram_matrix(rows);
  plate.positions = mesh.positions(plate.free, Eigen::all);
  return plate;
}

/// Returns the plate over a sample, held at its low end.
Plate plate_of(const char* sample, int resolution) {
  const Mesh mesh = make_sample(sample, resolution);
  const double low = mesh.positions.col(2).minCoeff(), high = mesh.positions.col(2).maxCoeff();
  return make_plate(mesh, [&](Index v) { return mesh.positions(v, 2) <= low + 0.1 * (high - low); });
}

std::unique_ptr<LinearSolver> ready(const Plate& plate, SolverBackend backend = SolverBackend::iterative,
                                    const Context& context = {}) {
  auto solver = make_solver(backend);
  solver->analyse(plate.matrix, plate.graph(), context);
  solver->factorise(plate.matrix, context);
  return solver;
}

Eigen::MatrixXd loads(const Plate& plate, int columns) {
  std::srand(3);
  return plate.matrix.selfadjointView<Eigen::Lower>() * Eigen::MatrixXd::Random(plate.matrix.rows(), columns);
}

/// Returns √(eᵀ N e) of the error e over that of the exact solution, the largest of all columns.
double energy_error(const Plate& plate, const Eigen::MatrixXd& x, const Eigen::MatrixXd& exact) {
  const auto energy = [&](const Eigen::MatrixXd& e) {
    return Eigen::RowVectorXd(e.cwiseProduct(plate.matrix.selfadjointView<Eigen::Lower>() * e).colwise().sum());
  };
  return std::sqrt(energy(x - exact).cwiseQuotient(energy(exact)).maxCoeff());
}

TEST(IterativeSolver, IsAsAccurateAsAskedForInTheEnergyNorm) {
  for (const char* sample : {"torus", "knot", "cylinder", "bar"}) {
    const Plate plate = plate_of(sample, 60);
    const Eigen::MatrixXd rhs = loads(plate, 3);
    const auto solver = ready(plate);
    const Eigen::MatrixXd exact = ready(plate, available_backends().front())->solve(rhs);
    for (const double tolerance : {1e-2, 1e-5, 1e-8})
      EXPECT_LT(energy_error(plate, solver->solve(rhs, {.tolerance = tolerance}), exact), 3 * tolerance)
          << sample;
  }
}

TEST(IterativeSolver, TakesAsManyIterationsHoweverFineTheMesh) {
  int coarse_iterations = 0;
  for (const int resolution : {40, 80, 160}) {
    const Plate plate = plate_of("torus", resolution);
    const auto solver = ready(plate);
    solver->solve(loads(plate, 3));
    const SolverStatistics statistics = solver->statistics();
    if (coarse_iterations == 0) coarse_iterations = statistics.iterations;
    EXPECT_LE(statistics.iterations, coarse_iterations + 8) << statistics.unknowns;
    EXPECT_GT(statistics.iterations, 0);
    EXPECT_LT(statistics.coarse_unknowns, statistics.unknowns / 3);
    EXPECT_LT(statistics.operator_complexity, 2);
  }
}

TEST(IterativeSolver, StartsFromAGuess) {
  const Plate plate = plate_of("knot", 60);
  const Eigen::MatrixXd rhs = loads(plate, 3);
  const auto solver = ready(plate);
  const Eigen::MatrixXd solution = solver->solve(rhs);
  const int from_zero = solver->statistics().iterations;
  const Eigen::MatrixXd again = solver->solve(rhs, {.tolerance = 1e-8, .guess = &solution});
  EXPECT_EQ(solver->statistics().iterations, 0);
  EXPECT_EQ(again, solution);
  const Eigen::MatrixXd near = solution + 1e-4 * Eigen::MatrixXd(solution.cwiseAbs());
  EXPECT_LT(energy_error(plate, solver->solve(rhs, {.guess = &near}), solution), 1e-7);
  EXPECT_LT(solver->statistics().iterations, from_zero);
}

TEST(IterativeSolver, LeavesColumnsOfZerosAndSolvesAnyNumberOfColumns) {
  const Plate plate = plate_of("cylinder", 40);
  Eigen::MatrixXd rhs = loads(plate, 6);
  rhs.col(1).setZero();
  const auto solver = ready(plate);
  const Eigen::MatrixXd together = solver->solve(rhs);
  EXPECT_EQ(together.col(1).norm(), 0);
  for (const int column : {0, 2, 3, 4, 5}) {
    const Eigen::MatrixXd alone = solver->solve(rhs.col(column));
    EXPECT_LT((together.col(column) - alone).norm(), 1e-6 * alone.norm()) << column;
  }
}

class IterativeSolverOf : public testing::TestWithParam<const char*> {};

TEST_P(IterativeSolverOf, GivesTheSameBytesForAnyNumberOfThreads) {
  const Plate plate = plate_of(GetParam(), 110);
  const Eigen::MatrixXd rhs = loads(plate, 3);
  const auto solution = [&](int threads) {
    const Context context{.threads = threads};
    return ready(plate, SolverBackend::iterative, context)->solve(rhs, context);
  };
  const Eigen::MatrixXd one = solution(1);
  for (const int threads : {2, 3, 0}) {
    const Eigen::MatrixXd other = solution(threads);
    EXPECT_EQ(std::memcmp(one.data(), other.data(), sizeof(double) * one.size()), 0) << threads;
  }
}

INSTANTIATE_TEST_SUITE_P(Samples, IterativeSolverOf, testing::Values("torus", "bar"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(IterativeSolver, ReportsProgressAndStopsWhenAsked) {
  const Plate plate = plate_of("torus", 60);
  const auto solver = ready(plate);
  std::stop_source stop;
  int steps = 0;
  double last = -1;
  Context context;
  context.stop_token = stop.get_token();
  context.progress = [&](const Progress& progress) {
    EXPECT_EQ(progress.stage, "solve");
    EXPECT_LE(progress.fraction, 1);
    last = std::max(last, progress.fraction);
    if (++steps == 4) stop.request_stop();
  };
  try {
    solver->solve(loads(plate, 2), context);
    FAIL() << "went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(steps, 4);
  EXPECT_GT(last, 0);
}

TEST(IterativeSolver, SaysWhereItDoesNotConverge) {
  // The matrix is singular: nothing holds the plate, and the load pushes it away. Only rounding keeps the
  // smallest eigenvalue from zero.
  const Mesh mesh = make_sample("torus", 40);
  const Plate plate = make_plate(mesh, [](Index) { return false; });
  auto solver = make_solver(SolverBackend::iterative);
  solver->analyse(plate.matrix, plate.graph());
  try {
    solver->factorise(plate.matrix);
    solver->solve(Eigen::MatrixXd::Ones(plate.matrix.rows(), 1), {.tolerance = 1e-14});
    FAIL() << "found a solution";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unsolvable);
    // Rounding decides whether the coarse grid's factorisation already fails.
    EXPECT_TRUE(error.id() == "linalg.not_converged" || error.id() == "linalg.not_positive_definite")
        << error.what();
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(IterativeSolver, SolvesHubsAndWhatHasNoPositions) {
  // In a wheel all nodes are beside the hub, so the bi-Laplacian couples every node with every other.
  constexpr Index rim = 700;
  Plate plate;
  std::vector<std::pair<Index, Index>> edges;
  for (Index v = 0; v < rim; ++v) edges.insert(edges.end(), {{v, (v + 1) % rim}, {v, rim}});
  plate.rings = neighbours_of(rim + 1, edges);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index v = 0; v <= rim; ++v) {
    entries.emplace_back(v, v, 1.0 + 1e-3);
    const auto ring = plate.rings[v];
    for (const Index w : ring) entries.emplace_back(v, w, -1.0 / static_cast<double>(ring.size()));
  }
  SparseRows rows(rim + 1, rim + 1);
  rows.setFromTriplets(entries.begin(), entries.end());
  plate.matrix = gram_matrix(rows);
  plate.free = numbers_below(rim + 1);
  const Eigen::MatrixXd rhs = loads(plate, 3);
  auto solver = make_solver(SolverBackend::iterative);
  solver->analyse(plate.matrix, {plate.free, &plate.rings});
  solver->factorise(plate.matrix);
  const Eigen::MatrixXd exact = ready(plate, SolverBackend::eigen)->solve(rhs);
  EXPECT_LT(energy_error(plate, solver->solve(rhs), exact), 1e-7);
}

}  // namespace
}  // namespace meshgraft
