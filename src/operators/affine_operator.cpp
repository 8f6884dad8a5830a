#include <meshgraft/operators/affine_operator.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <meshgraft/core/parallel.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/operators/laplacian.h>

namespace meshgraft {

namespace {

/// Unit vector between two normals. Opposite ones (the two sides of a thin edge, or of a sheet) have nothing
/// between them, but agree on a line: the second is then taken the other way round.
Eigen::RowVector3d normal_between(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
  constexpr double opposite = -0.6;
  return (a.dot(b) < opposite ? Eigen::RowVector3d(a - b) : Eigen::RowVector3d(a + b)).normalized();
}

std::vector<std::uint8_t> flags_or_all(const std::vector<std::uint8_t>& flags, Index count) {
  return flags.empty() ? std::vector<std::uint8_t>(static_cast<std::size_t>(count), 1) : flags;
}

double mean_of_positive(const std::vector<double>& values) {
  double sum = 0;
  Index count = 0;
  for (double value : values) {
    if (value > 0) sum += value, ++count;
  }
  return count > 0 ? sum / count : 1.0;
}

/// ℓ̄/ℓ, bounded: extreme ratios would drown all other rows in rounding.
double density_scale(double length_ratio) {
  constexpr double largest = 1e3;
  return std::clamp(length_ratio, 1 / largest, largest);
}

}  // namespace

std::vector<std::array<Index, 2>> smoothness_pairs(const Triangles& triangles,
                                                   const IndexLists& vertex_triangles, const IndexLists& rings,
                                                   std::span<const std::uint8_t> active, bool opposite_pairs,
                                                   const Context& context) {
  context.throw_if_stopped();
  std::vector<std::array<Index, 2>> pairs;
  const auto add = [&](Index i, Index j) {
    if (i != j && (active[i] || active[j])) pairs.push_back({std::min(i, j), std::max(i, j)});
  };
  std::vector<Index> opposite;
  for (Index i = 0; i < rings.size(); ++i) {
    for (Index j : rings[i]) {
      if (j < i) continue;
      add(i, j);
      if (!opposite_pairs) continue;
      // Every two faces on the edge (i, j) contribute the pair of their third corners.
      opposite.clear();
      for (Index t : vertex_triangles[i]) {
        bool on_edge = false;
        Index third = -1;
        for (int corner = 0; corner < 3; ++corner) {
          const Index v = triangles(t, corner);
          if (v == j)
            on_edge = true;
          else if (v != i)
            third = v;
        }
        if (on_edge && third >= 0) opposite.push_back(third);
      }
      for (std::size_t a = 0; a < opposite.size(); ++a)
        for (std::size_t b = a + 1; b < opposite.size(); ++b) add(opposite[a], opposite[b]);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

AffineOperator::AffineOperator(const Points& points, const Triangles& triangles, const OperatorOptions& options,
                               const Extent& extent, const Context& context) {
  validate(options);
  const auto n = static_cast<Index>(points.rows());
  const auto fitted = flags_or_all(extent.fitted, n);
  const auto unknown = flags_or_all(extent.unknown, n);
  const auto movable = flags_or_all(extent.movable, n);
  const auto rows = flags_or_all(extent.rows, n);

  const IndexLists faces_at = vertex_triangles(n, triangles, context);
  rings_ = vertex_rings(triangles, faces_at, context);
  const Points normals = vertex_normals(points, triangles, faces_at, context);
  edge_lengths_ = mean_edge_lengths(points, rings_);
  mean_edge_length_ = mean_of_positive(edge_lengths_);

  nodes_ = make_stencil_nodes(points, normals, rings_, {fitted, movable, extent.numbers}, options, context);
  context.step("assemble", 0.1);
  H_ = local_map_operator(nodes_, rings_, fitted, context);
  context.step("assemble", 0.4);
  build_laplacian_rows(points, triangles, options, rows, context);
  pairs_ = smoothness_pairs(triangles, faces_at, rings_, unknown, options.opposite_pairs, context);
  build_smoothness_rows(normals, options, context);
}

/// FT05 equation 9: (D x)_i − M_i δ_i, with D applied `laplacian_order` times on both sides.
void AffineOperator::build_laplacian_rows(const Points& points, const Triangles& triangles,
                                          const OperatorOptions& options, const std::vector<std::uint8_t>& rows,
                                          const Context& context) {
  const auto n = static_cast<Index>(points.rows());
  const Eigen::Index node_count = nodes_.positions.rows();
  const Points shifted = nodes_.positions.topRows(n);  // p' where a vertex was moved, else p
  const SparseRows D = umbrella_operator(shifted, triangles, rings_, options.weights, context);
  SparseRows power = D;
  for (int order = 1; order < options.laplacian_order; ++order) power = multiply(D, power, context);
  const Columns delta = multiply(power, Columns(shifted), context);

  std::vector<Index> row_vertices;
  for (Index i = 0; i < n; ++i)
    if (rows[i] && !rings_[i].empty()) row_vertices.push_back(i);
  const auto row_count = static_cast<Eigen::Index>(row_vertices.size());
  L_.resize(row_count, node_count);
  delta_.resize(row_count, 3 * n);
  std::vector<int> lengths;
  for (Index i : row_vertices) lengths.push_back(power.outerIndexPtr()[i + 1] - power.outerIndexPtr()[i]);
  L_.reserve(lengths);
  delta_.reserve(std::vector<int>(lengths.size(), 3));
  const double laplacian_scale = std::sqrt(options.laplacian_weight);
  for (Eigen::Index row = 0; row < row_count; ++row) {
    const Index i = row_vertices[row];
    const double density =
        options.density == Density::aware ? density_scale(mean_edge_length_ / edge_lengths_[i]) : 1.0;
    const double scale = laplacian_scale * density;
    for (SparseRows::InnerIterator it(power, i); it; ++it)
      L_.insertBackUncompressed(row, it.col()) = scale * it.value();
    for (int k = 0; k < 3; ++k) delta_.insertBackUncompressed(row, 3 * i + k) = scale * delta(i, k);
  }
  L_.makeCompressed();
  delta_.makeCompressed();
}

/// FT05 equation 11: (M_i − M_j) d for d = p_i − p_j and, with apexes, for d = |p_i − p_j| times the normal
/// between the two; an unordered pair stands for both ordered ones, hence √2.
void AffineOperator::build_smoothness_rows(const Points& normals, const OperatorOptions& options,
                                           const Context& context) {
  const bool with_normals = options.degenerate != DegenerateTreatment::ft05_noise;
  const std::size_t rows_per_pair = with_normals ? 2 : 1;
  P_ = rows_of_lengths(std::vector<int>(pairs_.size() * rows_per_pair, 6), 3 * rings_.size());
  const auto write_row = [&](std::size_t row, const std::array<Index, 2>& pair, const Eigen::RowVector3d& d) {
    int* columns = P_.innerIndexPtr() + 6 * row;
    double* values = P_.valuePtr() + 6 * row;
    for (int k = 0; k < 3; ++k) {
      columns[k] = 3 * pair[0] + k;
      columns[3 + k] = 3 * pair[1] + k;
      values[k] = d[k];
      values[3 + k] = -d[k];
    }
  };
  // Where the faces around a vertex cancel (a two-sided sheet), its apex still has a direction.
  const auto direction = [&](Index v) -> Eigen::RowVector3d {
    const Index apex = nodes_.apex[v];
    if (apex < 0) return normals.row(v);
    return (nodes_.positions.row(apex) - nodes_.positions.row(v)).normalized();
  };
  parallel_blocks(
      pairs_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
          const auto [i, j] = pairs_[p];
          const double local_length = 0.5 * (edge_lengths_[i] + edge_lengths_[j]);
          const double scale =
              std::numbers::sqrt2 *
              (options.density == Density::aware ? density_scale(mean_edge_length_ / local_length) : 1.0);
          const Eigen::RowVector3d d = nodes_.positions.row(i) - nodes_.positions.row(j);
          write_row(p * rows_per_pair, pairs_[p], scale * d);
          if (with_normals)
            write_row(p * rows_per_pair + 1, pairs_[p],
                      scale * d.norm() * normal_between(direction(i), direction(j)));
        }
      },
      context, 4096);
}

SparseRows AffineOperator::A(const Context& context) const {
  return stack(SparseRows(L_ - multiply(delta_, H_, context)), multiply(P_, H_, context));
}

}  // namespace meshgraft
