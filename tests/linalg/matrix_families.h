#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/topology.h>

#include "linalg/sparse.h"
#include "linalg/sparse_products.h"

namespace meshgraft {

inline Context with_threads(int threads) { return {.threads = threads, .progress = {}, .stop_token = {}}; }

/// Returns 0 … count−1.
inline std::vector<int> numbers_below(Eigen::Index count) {
  std::vector<int> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

/// Returns whether two arrays of numbers have the same size and the same bytes.
template <class Matrix>
bool same_bytes(const Matrix& a, const Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(), sizeof(*a.data()) * a.size()) == 0);
}
template <class Scalar, int options, class StorageIndex>
bool same_bytes(const Eigen::SparseMatrix<Scalar, options, StorageIndex>& a,
                const Eigen::SparseMatrix<Scalar, options, StorageIndex>& b) {
  const auto same = [](const auto* first, const auto* second, Eigen::Index count) {
    return count == 0 || std::memcmp(first, second, sizeof(*first) * count) == 0;
  };
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         same(a.outerIndexPtr(), b.outerIndexPtr(), a.outerSize() + 1) &&
         same(a.innerIndexPtr(), b.innerIndexPtr(), a.nonZeros()) &&
         same(a.valuePtr(), b.valuePtr(), a.nonZeros());
}

/// Returns the whole of a symmetric matrix.
inline Eigen::MatrixXd full_matrix(const NormalMatrix& lower) {
  const Eigen::MatrixXd half = Eigen::MatrixXd(lower);
  return Eigen::MatrixXd(half.selfadjointView<Eigen::Lower>());
}

/// Returns the lower triangle of AᵀA.
inline NormalMatrix gram_matrix(const SparseRows& A) {
  const SparseRows none(1, A.cols());
  return normal_equations({.A = A,
                           .A_transposed = transpose(A),
                           .G = none,
                           .G_transposed = transpose(none),
                           .K = SparseRows(1, 1)});
}

/// Returns the lower triangle of AᵀA + shift² I.
inline NormalMatrix gram_matrix(const SparseRows& A, double shift) {
  SparseRows identity(A.cols(), A.cols());
  identity.setIdentity();
  const SparseRows diagonal = shift * identity;
  return normal_equations(
      {.A = A, .A_transposed = transpose(A), .G = diagonal, .G_transposed = diagonal, .K = identity});
}

/// Returns lists of neighbours, ascending and distinct. Edges from a group to itself are ignored.
inline IndexLists neighbours_of(Index groups, const std::vector<std::pair<Index, Index>>& edges) {
  std::vector<std::vector<Index>> near(groups);
  for (const auto& [a, b] : edges) {
    if (a == b) continue;
    near[a].push_back(b);
    near[b].push_back(a);
  }
  IndexLists lists;
  for (std::vector<Index>& list : near) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    lists.values.insert(lists.values.end(), list.begin(), list.end());
    lists.offsets.push_back(static_cast<Index>(lists.values.size()));
  }
  return lists;
}

/// Returns the neighbours in a width×height grid.
inline IndexLists grid_neighbours(Index width, Index height) {
  std::vector<std::pair<Index, Index>> edges;
  for (Index at = 0; at < width * height; ++at) {
    if (at % width > 0) edges.emplace_back(at, at - 1);
    if (at >= width) edges.emplace_back(at, at - width);
  }
  return neighbours_of(width * height, edges);
}

/// Returns the square of a k×k grid's Laplacian, plus a small multiple of the identity.
inline NormalMatrix grid_matrix(int k, double shift = 1e-3) {
  std::vector<Eigen::Triplet<double>> entries;
  const IndexLists neighbours = grid_neighbours(k, k);
  for (Index at = 0; at < k * k; ++at) {
    entries.emplace_back(at, at, 4.0);
    for (const Index other : neighbours[at]) entries.emplace_back(at, other, -1.0);
  }
  SparseRows laplacian(k * k, k * k);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return gram_matrix(laplacian, shift);
}

/// Returns a positive definite matrix with an entry for each edge. Repeated edges count once.
inline NormalMatrix matrix_of_edges(Index unknowns, const std::vector<std::pair<Index, Index>>& edges) {
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  std::vector<std::pair<Index, Index>> below;
  for (const auto& [a, b] : edges)
    if (a != b) below.emplace_back(std::max(a, b), std::min(a, b));
  std::sort(below.begin(), below.end());
  below.erase(std::unique(below.begin(), below.end()), below.end());
  for (const auto& [row, column] : below) {
    entries.emplace_back(row, column, -1.0);
    entries.emplace_back(row, row, 1.0);
    entries.emplace_back(column, column, 1.0);
  }
  for (Index u = 0; u < unknowns; ++u) entries.emplace_back(u, u, 1.0 + 0.01 * u);
  NormalMatrix lower(unknowns, unknowns);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

/// Returns the matrix of a width×height grid whose unknowns are coupled with those at most `reach` steps away.
inline NormalMatrix lattice_matrix(Index width, Index height, Index reach = 1) {
  std::vector<std::pair<Index, Index>> edges;
  for (Index y = 0; y < height; ++y)
    for (Index x = 0; x < width; ++x)
      for (Index dy = 0; dy <= reach; ++dy)
        for (Index dx = dy - reach; dx <= reach - dy; ++dx)
          if (x + dx >= 0 && x + dx < width && y + dy < height)
            edges.emplace_back(y * width + x, (y + dy) * width + x + dx);
  return matrix_of_edges(width * height, edges);
}

struct NamedMatrix {
  std::string name;
  NormalMatrix lower;
};

/// Returns matrices of many kinds: empty, one unknown, diagonal, band, dense rows, uncoupled, grids, random.
inline std::vector<NamedMatrix> matrix_families() {
  using Edges = std::vector<std::pair<Index, Index>>;
  std::vector<NamedMatrix> matrices{{"nothing", matrix_of_edges(0, {})},
                                    {"one unknown", matrix_of_edges(1, {})},
                                    {"diagonal", matrix_of_edges(20, {})},
                                    {"grid", lattice_matrix(9, 11)},
                                    {"far grid", lattice_matrix(12, 12, 2)}};
  Edges band, dense, first_row, last_row, pieces;
  for (Index u = 0; u < 60; ++u) {
    band.emplace_back(u, std::min(59, u + 1));
    first_row.emplace_back(0, u);
    last_row.emplace_back(59, u);
    if (u % 20 > 0) pieces.emplace_back(u, u - u % 20);
  }
  for (Index a = 0; a < 30; ++a)
    for (Index b = 0; b < a; ++b) dense.emplace_back(a, b);
  matrices.push_back({"band", matrix_of_edges(60, band)});
  matrices.push_back({"dense", matrix_of_edges(30, dense)});
  matrices.push_back({"dense first row", matrix_of_edges(60, first_row)});
  matrices.push_back({"dense last row", matrix_of_edges(60, last_row)});
  matrices.push_back({"pieces", matrix_of_edges(65, pieces)});
  std::minstd_rand generator(4);
  for (const unsigned edges : {15U, 60U, 120U, 400U}) {
    Edges random;
    for (unsigned edge = 0; edge < edges; ++edge) random.emplace_back(generator() % 80, generator() % 80);
    matrices.push_back({"random", matrix_of_edges(80, random)});
  }
  return matrices;
}

}  // namespace meshgraft
