#pragma once

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

/// Returns random rows, in runs of `together` rows with the same columns.
inline SparseRows random_runs(int rows, int columns, int together, std::minstd_rand& generator) {
  const auto random = [&] { return static_cast<double>(generator() % 2001) / 1000.0 - 1.0; };
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < rows && columns > 0; row += together)
    for (int k = 0; k < 6; ++k) {
      const int column = static_cast<int>(generator() % static_cast<unsigned>(columns));
      for (int r = row; r < std::min(rows, row + together); ++r) entries.emplace_back(r, column, random());
    }
  SparseRows matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Returns rows that are empty but for some, of which a few are full.
inline SparseRows uneven_rows(int rows, int columns, std::minstd_rand& generator) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < rows; row += 3)
    for (int column = 0; column < columns; ++column)
      if (row % 7 == 0 || generator() % 20 == 0) entries.emplace_back(row, column, 0.5 * row - column);
  SparseRows matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Returns rows with at most one entry: every third is empty, the others take the columns in a shuffled order.
/// With `repeat` two rows take the same column.
inline SparseRows selection(int rows, int columns, bool repeat, std::minstd_rand& generator) {
  std::vector<int> order(columns);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), generator);
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < rows && !order.empty(); ++row) {
    if (row % 3 == 2) continue;
    entries.emplace_back(row, order.back(), row % 2 == 0 ? 1.0 : -2.5);
    if (!repeat || row > 0) order.pop_back();
  }
  SparseRows matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Two matrices whose product exists.
struct SparsePair {
  std::string name;
  SparseRows a, b;
};

/// Returns pairs of many kinds: without rows or columns, one row, zero, runs of like rows, uneven, tall, wide.
inline std::vector<SparsePair> sparse_families() {
  std::minstd_rand generator(9);
  std::vector<SparsePair> pairs{
      {"no rows", SparseRows(0, 4), random_runs(4, 5, 1, generator)},
      {"no inner columns", SparseRows(3, 0), SparseRows(0, 5)},
      {"no columns", random_runs(3, 4, 1, generator), SparseRows(4, 0)},
      {"zero", SparseRows(6, 7), random_runs(7, 5, 2, generator)},
      {"one row", random_runs(1, 9, 1, generator), random_runs(9, 8, 1, generator)},
      {"uneven", uneven_rows(90, 60, generator), uneven_rows(60, 110, generator)},
      {"tall", random_runs(900, 40, 1, generator), random_runs(40, 50, 2, generator)},
      {"wide", random_runs(40, 900, 1, generator), random_runs(900, 700, 3, generator)}};
  for (const bool repeat : {false, true})
    pairs.push_back({repeat ? "a column selected twice" : "columns selected",
                     random_runs(600, 300, 3, generator), selection(300, 220, repeat, generator)});
  for (const int together : {1, 2, 3, 4, 5})
    pairs.push_back({"runs of " + std::to_string(together), random_runs(600, 300, together, generator),
                     random_runs(300, 150, together, generator)});
  return pairs;
}

}  // namespace meshgraft
