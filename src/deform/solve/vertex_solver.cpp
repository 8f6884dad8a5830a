#include "vertex_solver.h"

#include <cstdint>

#include "core/sparse_checks.h"

namespace meshgraft {

namespace {

/// Returns the lower triangle of the square part of `rows` that belongs to the vertices `unknown`.
NormalMatrix square_part(const SparseRows& rows, const std::vector<Index>& unknown, const Context& context) {
  std::vector<Index> column_of(rows.cols(), -1);
  for (std::size_t k = 0; k < unknown.size(); ++k) column_of[unknown[k]] = static_cast<Index>(k);
  const auto for_each_entry = [&](const auto& body) {
    SparseChecks check(context);
    for (Eigen::Index k = 0; k < rows.rows(); ++k, check())
      for (SparseRows::InnerIterator it(rows, k); it; ++it)
        if (const Index column = column_of[it.col()]; column >= 0 && column <= k) body(k, column, it.value());
  };
  NormalMatrix lower(rows.rows(), rows.rows());
  std::int64_t* const begin = lower.outerIndexPtr();
  for_each_entry([&](Eigen::Index, Index column, double) { ++begin[column + 1]; });
  for (Eigen::Index column = 0; column < lower.cols(); ++column) begin[column + 1] += begin[column];
  lower.resizeNonZeros(begin[lower.cols()]);
  std::vector<std::int64_t> next(begin, begin + lower.cols());
  for_each_entry([&](Eigen::Index row, Index column, double value) {
    const std::int64_t entry = next[column]++;
    lower.innerIndexPtr()[entry] = row;
    lower.valuePtr()[entry] = value;
  });
  return lower;
}

}  // namespace

SparseRows select_rows(const SparseRows& matrix, const std::vector<Index>& rows, const Context& context) {
  SparseRows selected(static_cast<Eigen::Index>(rows.size()), matrix.cols());
  std::vector<int> lengths;
  for (const Index row : rows) lengths.push_back(matrix.outerIndexPtr()[row + 1] - matrix.outerIndexPtr()[row]);
  selected.reserve(lengths);
  SparseChecks check(context);
  for (std::size_t k = 0; k < rows.size(); ++k, check())
    for (SparseRows::InnerIterator it(matrix, rows[k]); it; ++it)
      selected.insertBackUncompressed(static_cast<Eigen::Index>(k), it.col()) = it.value();
  selected.makeCompressed();
  return selected;
}

std::unique_ptr<LinearSolver> factorise_vertices(const SparseRows& rows, const OrderingGraph& graph,
                                                 SolverBackend backend, const Context& context) {
  NormalMatrix matrix = square_part(rows, graph.group, context);
  auto solver = make_solver(backend);
  solver->analyse(matrix, graph, context);
  solver->factorise_and_free(matrix, context);
  return solver;
}

void factorise_vertices(const SparseRows& rows, const std::vector<Index>& unknown, LinearSolver& analysed,
                        const Context& context) {
  NormalMatrix matrix = square_part(rows, unknown, context);
  analysed.factorise_and_free(matrix, context);
}

}  // namespace meshgraft
