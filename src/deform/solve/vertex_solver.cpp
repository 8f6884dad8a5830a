#include "vertex_solver.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "core/parallel.h"
#include "linalg/sparse.h"

namespace meshgraft {

namespace {

constexpr std::size_t vertices_at_once = 4096;

/// Returns the lower triangle of the square part of `rows` that belongs to the vertices `unknown`. The part is
/// symmetric, so that the lower triangle by columns is the upper one by rows.
NormalMatrix square_part(const SparseRows& rows, const std::vector<Index>& unknown, const Context& context) {
  std::vector<Index> rank(rows.cols(), -1);
  for (std::size_t k = 0; k < unknown.size(); ++k) rank[unknown[k]] = static_cast<Index>(k);
  const auto for_rows = [&](const auto& body) {
    const auto block = [&](std::size_t begin, std::size_t end) {
      for (auto k = static_cast<Eigen::Index>(begin); k < static_cast<Eigen::Index>(end); ++k) body(k);
    };
    parallel_blocks(unknown.size(), block, context, vertices_at_once);
  };
  NormalMatrix lower(rows.rows(), rows.rows());
  std::int64_t* const begin = lower.outerIndexPtr();
  for_rows([&](Eigen::Index k) {
    for (SparseRows::InnerIterator it(rows, k); it; ++it) begin[k + 1] += rank[it.col()] >= k ? 1 : 0;
  });
  std::partial_sum(begin, begin + lower.cols() + 1, begin);
  lower.resizeNonZeros(begin[lower.cols()]);
  for_rows([&](Eigen::Index k) {
    std::int64_t entry = begin[k];
    for (SparseRows::InnerIterator it(rows, k); it; ++it) {
      if (rank[it.col()] < k) continue;
      lower.innerIndexPtr()[entry] = rank[it.col()];
      lower.valuePtr()[entry++] = it.value();
    }
  });
  return lower;
}

}  // namespace

SparseRows select_rows(const SparseRows& matrix, const std::vector<Index>& rows, const Context& context) {
  const int* const outer = matrix.outerIndexPtr();
  std::vector<int> lengths;
  lengths.reserve(rows.size());
  const int* const counts = matrix.innerNonZeroPtr();  // null if the matrix is compressed
  for (const Index row : rows) lengths.push_back(counts != nullptr ? counts[row] : outer[row + 1] - outer[row]);
  SparseRows selected = rows_of_lengths(lengths, matrix.cols());
  const auto copy = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const int from = outer[rows[k]], to = selected.outerIndexPtr()[k];
      std::copy_n(matrix.innerIndexPtr() + from, lengths[k], selected.innerIndexPtr() + to);
      std::copy_n(matrix.valuePtr() + from, lengths[k], selected.valuePtr() + to);
    }
  };
  parallel_blocks(rows.size(), copy, context, vertices_at_once);
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
