#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

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
