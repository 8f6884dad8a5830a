#include "laplacian.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/parallel.h"

namespace meshgraft {

namespace {

/// Returns the index of entry (row, column) in the values of a matrix with sorted rows.
int entry_of(const SparseRows& matrix, Index row, Index column) {
  const int* begin = matrix.innerIndexPtr() + matrix.outerIndexPtr()[row];
  const int* end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[row + 1];
  return static_cast<int>(std::lower_bound(begin, end, column) - matrix.innerIndexPtr());
}

/// Returns one row per vertex with a ring: the ring and the vertex itself, sorted, with values 0.
SparseRows umbrella_pattern(const IndexLists& rings) {
  const Index n = rings.size();
  SparseRows pattern(n, n);
  std::vector<int> lengths(n);
  for (Index i = 0; i < n; ++i) lengths[i] = rings[i].empty() ? 0 : static_cast<int>(rings[i].size()) + 1;
  pattern.reserve(lengths);
  for (Index i = 0; i < n; ++i) {
    bool self_placed = rings[i].empty();
    for (Index j : rings[i]) {
      if (!self_placed && j > i) {
        pattern.insertBackUncompressed(i, i) = 0;
        self_placed = true;
      }
      pattern.insertBackUncompressed(i, j) = 0;
    }
    if (!self_placed) pattern.insertBackUncompressed(i, i) = 0;
  }
  pattern.makeCompressed();
  return pattern;
}

/// Adds ½(cot α + cot β) on every edge of the pattern.
void add_half_cotangents(const Points& points, const Triangles& triangles, SparseRows& matrix) {
  double* values = matrix.valuePtr();
  for (Index t = 0; t < triangles.rows(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const Index i = triangles(t, corner), j = triangles(t, (corner + 1) % 3),
                  k = triangles(t, (corner + 2) % 3);
      if (i == j || j == k || k == i) continue;
      const Eigen::RowVector3d a = points.row(i) - points.row(k), b = points.row(j) - points.row(k);
      const double area2 = a.cross(b).norm();
      if (area2 <= 0) continue;
      const double half_cotangent = 0.5 * a.dot(b) / area2;
      values[entry_of(matrix, i, j)] += half_cotangent;
      values[entry_of(matrix, j, i)] += half_cotangent;
    }
  }
}

}  // namespace

SparseRows umbrella_operator(const Points& points, const Triangles& triangles, const IndexLists& rings,
                             WeightScheme weights, const Context& context) {
  context.throw_if_stopped();
  SparseRows D = umbrella_pattern(rings);
  double* values = D.valuePtr();
  if (weights == WeightScheme::cotangent) add_half_cotangents(points, triangles, D);
  for (Index i = 0; i < rings.size(); ++i) {
    if (rings[i].empty()) continue;
    const int self = entry_of(D, i, i);
    const int begin = D.outerIndexPtr()[i], end = D.outerIndexPtr()[i + 1];
    double sum = 0;
    for (int entry = begin; entry < end; ++entry) sum += values[entry] = std::max(values[entry], 0.0);
    const bool vanishing = !(sum > 0) || !std::isfinite(sum);
    for (int entry = begin; entry < end; ++entry)
      values[entry] = -(vanishing ? 1.0 / static_cast<double>(end - begin - 1) : values[entry] / sum);
    values[self] = 1;
  }
  return D;
}

SparseRows dirichlet_matrix(const Points& points, const Triangles& triangles, const IndexLists& rings,
                            const Context& context) {
  context.throw_if_stopped();
  constexpr double smallest_weight = 1e-3, largest_weight = 4;
  SparseRows K = umbrella_pattern(rings);
  add_half_cotangents(points, triangles, K);
  double* values = K.valuePtr();
  for (Index i = 0; i < rings.size(); ++i) {
    if (rings[i].empty()) continue;
    const int self = entry_of(K, i, i);
    double sum = 0;
    for (int entry = K.outerIndexPtr()[i]; entry < K.outerIndexPtr()[i + 1]; ++entry) {
      if (entry == self) continue;
      values[entry] = -std::clamp(values[entry], smallest_weight, largest_weight);
      sum -= values[entry];
    }
    values[self] = sum;
  }
  return K;
}

std::vector<double> vertex_areas(const Points& points, const Triangles& triangles) {
  std::vector<double> areas(points.rows(), 0.0);
  for (const auto& t : triangles.rowwise()) {
    const Eigen::RowVector3d a = points.row(t[1]) - points.row(t[0]), b = points.row(t[2]) - points.row(t[0]);
    const double third = a.cross(b).norm() / 6;
    for (int corner = 0; corner < 3; ++corner) areas[t[corner]] += third;
  }
  return areas;
}

std::vector<double> mean_edge_lengths(const Points& points, const IndexLists& rings) {
  std::vector<double> lengths(rings.size(), 0.0);
  for (Index i = 0; i < rings.size(); ++i) {
    for (Index j : rings[i]) lengths[i] += (points.row(j) - points.row(i)).norm();
    if (!rings[i].empty()) lengths[i] /= static_cast<double>(rings[i].size());
  }
  return lengths;
}

double mean_of_positive(std::span<const double> lengths) {
  double sum = 0;
  Index count = 0;
  for (const double length : lengths)
    if (length > 0) sum += length, ++count;
  return count > 0 ? sum / count : 1.0;
}

}  // namespace meshgraft
