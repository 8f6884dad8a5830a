#include <meshgraft/operators/affine_operator.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include <meshgraft/mesh/normals.h>

#include "core/parallel.h"
#include "core/sparse_checks.h"
#include "density_scale.h"
#include "intrinsic_delaunay.h"
#include "laplacian.h"
#include "linalg/sparse.h"
#include "local_maps.h"
#include "smoothness_pairs.h"

namespace meshgraft {

namespace {

/// Returns the unit vector halfway between two normals. Opposite normals (the two sides of a thin edge, or of
/// a sheet) have no mean but agree on a line, so the second is reversed.
Eigen::RowVector3d normal_between(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
  constexpr double opposite = -0.6;
  return (a.dot(b) < opposite ? Eigen::RowVector3d(a - b) : Eigen::RowVector3d(a + b)).normalized();
}

/// Flags the vertices whose map is unknown: fitted to positions, or shared by a feature.
Flags flag_unknown_maps(const ConstraintMask& mask) {
  Flags unknown(mask.transform);
  for (std::uint8_t& flag : unknown) flag = !flag;
  return unknown;
}

/// Flags the vertices whose row of E_L has an unknown. A row spans `laplacian_order` rings.
Flags flag_rows(const ConstraintMask& mask, const IndexLists& rings, int laplacian_order) {
  std::vector<Index> unknown;
  for (Index v = 0; v < mask.size(); ++v)
    if (mask.is_unknown(v)) unknown.push_back(v);
  Flags rows(mask.size(), 0);
  for (const Index v : grow_rings(unknown, laplacian_order, rings)) rows[v] = 1;
  return rows;
}

/// Returns the number of vectors d per pair where rows are FT05's.
std::size_t vectors_per_pair(const std::vector<std::array<Index, 2>>& pairs,
                             const std::vector<double>& values) {
  return pairs.empty() ? 0 : values.size() / (3 * pairs.size());
}

}  // namespace

bool AffineOperator::is_scaled_by_density(double length_ratio) {
  return density_scale(length_ratio) == length_ratio;
}

AffineOperator::AffineOperator(const Points& points, const Triangles& triangles, const OperatorOptions& options,
                               const Context& context)
    : AffineOperator(OperatorMesh{points, triangles}, ConstraintMask(static_cast<Index>(points.rows()), false),
                     options, context) {}

AffineOperator::AffineOperator(const OperatorMesh& mesh, const ConstraintMask& mask,
                               const OperatorOptions& options, const Context& context) {
  validate(options);
  const auto& [points, triangles, numbers] = mesh;
  const auto n = static_cast<Index>(points.rows());

  const IndexLists faces_at = vertex_triangles(n, triangles, context);
  rings_ = vertex_rings(triangles, faces_at, context);
  const Points normals = vertex_normals(points, triangles, faces_at, context);
  edge_lengths_ = mean_edge_lengths(points, rings_);
  mean_edge_length_ = mean_of_positive(edge_lengths_);

  nodes_ = make_stencil_nodes({points, normals, rings_, numbers}, mask, options, context);
  context.step("assemble", 0.1);
  take_over(H_, local_map_operator(nodes_, rings_, mask, context));
  context.step("assemble", 0.4);
  build_laplacian_rows(points, triangles, options, flag_rows(mask, rings_, options.laplacian_order), context);
  if (has_integral_rows(options)) {
    intrinsic_edges_ =
        std::make_shared<const IntrinsicEdges>(intrinsic_delaunay_edges(points, triangles, context));
    build_integral_rows(map_places({points, normals, rings_, numbers}, context), mask);
  } else {
    pairs_ =
        smoothness_pairs(triangles, faces_at, rings_, flag_unknown_maps(mask), options.opposite_pairs, context);
    build_smoothness_rows(normals, options, context);
  }
  context.throw_if_stopped();
  list_pairs_by_vertex();
}

/// Builds the rows ℓ̄ √(12 w) (M_i − M_j) e_k of the intrinsic edges. The factor 12 is measured: it balances E_R
/// with λ E_L and the stiffness (docs/method.md). The weight of cotangents is that of a difference between the
/// edge's ends, but maps differ as their places do.
void AffineOperator::build_integral_rows(const Points& places, const ConstraintMask& mask) {
  constexpr double least = 1.0 / 16, most = 4;  // of a weight's factor
  const double scale = mean_edge_length_ * std::sqrt(12.0);
  const Points& points = nodes_.positions;
  for (const auto& [ends, weight] : intrinsic_edges_->edges) {
    const auto [i, j] = ends;
    if (mask.transform[i] && mask.transform[j]) continue;
    const double length = (points.row(i) - points.row(j)).squaredNorm();
    const double between = (places.row(i) - places.row(j)).squaredNorm();
    const double factor = between > 0 ? std::clamp(length / between, least, most) : most;
    pairs_.push_back(ends);
    pair_values_.push_back(scale * std::sqrt(weight * factor));
  }
}

/// Builds the rows of FT05 equation 9: (D x)_i − M_i δ_i, with D applied `laplacian_order` times on both
/// sides.
void AffineOperator::build_laplacian_rows(const Points& points, const Triangles& triangles,
                                          const OperatorOptions& options, const Flags& rows,
                                          const Context& context) {
  const auto n = static_cast<Index>(points.rows());
  const Eigen::Index node_count = nodes_.positions.rows();
  const Points shifted = nodes_.positions.topRows(n);  // p' for vertices that were moved, else p
  const SparseRows D = umbrella_operator(shifted, triangles, rings_, options.weights, context);
  SparseRows power = D;
  for (int order = 1; order < options.laplacian_order; ++order) take_over(power, multiply(D, power, context));
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
  SparseChecks check(context);
  for (Eigen::Index row = 0; row < row_count; ++row) {
    check();
    const Index i = row_vertices[row];
    const double density =
        options.density == Density::aware ? density_scale(mean_edge_length_ / edge_lengths_[i]) : 1.0;
    const double scale = laplacian_scale * density;
    for (SparseRows::InnerIterator it(power, i); it; ++it)
      L_.insertBackUncompressed(row, it.col()) = scale * it.value();
    for (int k = 0; k < 3; ++k) delta_.insertBackUncompressed(row, 3 * i + k) = scale * delta(i, k);
  }
  if (row_count == 0) return;  // Eigen's makeCompressed fails on a matrix without rows
  L_.makeCompressed();
  delta_.makeCompressed();
}

/// Builds the rows of FT05 equation 11: (M_i − M_j) d for d = p_i − p_j. With apexes, it adds d = |p_i − p_j|
/// times the normal between the two. An unordered pair stands for both ordered ones, hence √2.
void AffineOperator::build_smoothness_rows(const Points& normals, const OperatorOptions& options,
                                           const Context& context) {
  const bool with_normals = options.degenerate != DegenerateTreatment::ft05_noise;
  const std::size_t vectors = with_normals ? 2 : 1;
  pair_values_.resize(3 * vectors * pairs_.size());
  context.throw_if_stopped();
  const auto write = [&](std::size_t number, const Eigen::RowVector3d& d) {
    Eigen::Map<Eigen::RowVector3d>(pair_values_.data() + 3 * number) = d;
  };
  // If the faces around a vertex cancel (a two-sided sheet), its apex still has a direction.
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
          write(p * vectors, scale * d);
          if (with_normals)
            write(p * vectors + 1, scale * d.norm() * normal_between(direction(i), direction(j)));
        }
      },
      context, 4096);
}

/// Lists the pairs of each vertex by the other vertex, ascending: first those that end with it. Pairs are
/// sorted, and begin with their smaller vertex.
void AffineOperator::list_pairs_by_vertex() {
  pairs_at_.offsets.assign(static_cast<std::size_t>(rings_.size()) + 1, 0);
  for (const auto& [i, j] : pairs_) {
    ++pairs_at_.offsets[i + 1];
    ++pairs_at_.offsets[j + 1];
  }
  std::partial_sum(pairs_at_.offsets.begin(), pairs_at_.offsets.end(), pairs_at_.offsets.begin());
  pairs_at_.values.resize(2 * pairs_.size());
  std::vector<Index> next(pairs_at_.offsets.begin(), pairs_at_.offsets.end() - 1);
  for (const int end : {1, 0})
    for (std::size_t p = 0; p < pairs_.size(); ++p)
      pairs_at_.values[next[pairs_[p][end]]++] = static_cast<Index>(p);
}

SparseRows AffineOperator::P(const Context& context) const {
  assert(pairs_.empty() || !pair_values_.empty());
  const int entries = intrinsic_edges_ ? 2 : 6;
  const std::size_t rows_per_pair = intrinsic_edges_ ? 3 : vectors_per_pair(pairs_, pair_values_);
  SparseRows P = rows_of_lengths(std::vector<int>(pairs_.size() * rows_per_pair, entries), 3 * rings_.size());
  const auto write = [&](std::size_t row, int entry, Index column, double value) {
    P.innerIndexPtr()[row * entries + entry] = column;
    P.valuePtr()[row * entries + entry] = value;
  };
  const auto write_pairs = [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t row = p * rows_per_pair; row < (p + 1) * rows_per_pair; ++row) {
        const auto [i, j] = pairs_[p];
        if (intrinsic_edges_) {
          const auto k = static_cast<Index>(row - p * rows_per_pair);
          write(row, 0, 3 * i + k, pair_values_[p]);
          write(row, 1, 3 * j + k, -pair_values_[p]);
          continue;
        }
        for (int k = 0; k < 3; ++k) {
          write(row, k, 3 * i + k, pair_values_[3 * row + k]);
          write(row, 3 + k, 3 * j + k, -pair_values_[3 * row + k]);
        }
      }
  };
  parallel_blocks(pairs_.size(), write_pairs, context, 4096);
  return P;
}

/// Computes Σ d dᵀ (m_v − m_w) over the pairs {v, w} of each vertex v.
template <int columns>
void AffineOperator::couple_vertices(const LinearSolver::Rows& m, LinearSolver::Rows& product,
                                     const Context& context) const {
  using Map = Eigen::Matrix<double, 3, columns, Eigen::RowMajor>;
  const std::size_t vectors = vectors_per_pair(pairs_, pair_values_);
  const auto couple_some = [&](std::size_t begin, std::size_t end) {
    Map sum(3, m.cols()), difference(3, m.cols());
    for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) {
      sum.setZero();
      for (const Index pair : pairs_at_[v]) {
        const auto [i, j] = pairs_[pair];
        difference = m.middleRows<3>(3 * v) - m.middleRows<3>(3 * (i == v ? j : i));
        if (intrinsic_edges_) {
          sum += pair_values_[pair] * pair_values_[pair] * difference;
          continue;
        }
        for (std::size_t k = 0; k < vectors; ++k) {
          const Eigen::Map<const Eigen::Vector3d> d(&pair_values_[3 * (pair * vectors + k)]);
          sum += d * (d.transpose() * difference);
        }
      }
      product.middleRows<3>(3 * v) = sum;
    }
  };
  parallel_blocks(rings_.size(), couple_some, context, 2048);
}

void AffineOperator::couple(const LinearSolver::Rows& m, LinearSolver::Rows& product,
                            const Context& context) const {
  assert(pairs_.empty() || !pair_values_.empty());
  assert(m.rows() == 3 * rings_.size() && &m != &product);
  product.resize(m.rows(), m.cols());
  if (m.cols() == 3)
    couple_vertices<3>(m, product, context);
  else
    couple_vertices<Eigen::Dynamic>(m, product, context);
}

SparseRows AffineOperator::coupling(const Context& context) const {
  // Integral rows couple the k-th columns of two maps with each other alone, FT05's all three with all three.
  assert(pairs_.empty() || !pair_values_.empty());
  const int width = intrinsic_edges_ ? 1 : 3;
  const Index n = rings_.size();
  std::vector<int> lengths(3 * n);
  for (Index v = 0; v < n; ++v) {
    const auto partners = static_cast<int>(pairs_at_[v].size());
    std::fill_n(lengths.begin() + 3 * v, 3, partners > 0 ? width * (partners + 1) : 0);
  }
  SparseRows K = rows_of_lengths(lengths, 3 * n);
  const std::size_t vectors = vectors_per_pair(pairs_, pair_values_);
  // Returns Σ d dᵀ over the rows of a pair, where integral rows have the coordinate axes times √w for d.
  const auto block_of = [&](Index pair) {
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    if (intrinsic_edges_) {
      block.diagonal().setConstant(pair_values_[pair] * pair_values_[pair]);
      return block;
    }
    for (std::size_t k = 0; k < vectors; ++k) {
      const Eigen::Map<const Eigen::Vector3d> d(&pair_values_[3 * (pair * vectors + k)]);
      block += d * d.transpose();
    }
    return block;
  };
  parallel_blocks(
      n,
      [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) {
          const int first = K.outerIndexPtr()[3 * v], length = lengths[3 * static_cast<std::size_t>(v)];
          if (length == 0) continue;
          const auto write = [&](Index partner, const Eigen::Matrix3d& block, int at) {
            for (int row = 0; row < 3; ++row)
              for (int k = 0; k < width; ++k) {
                const int entry = first + row * length + at + k, column = width == 1 ? row : k;
                K.innerIndexPtr()[entry] = 3 * partner + column;
                K.valuePtr()[entry] = block(row, column);
              }
          };
          Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
          // The block of v itself comes between those of smaller and larger vertices.
          const auto is_smaller = [&](Index pair) { return pairs_[pair][1] == v; };
          const auto smaller = std::count_if(pairs_at_[v].begin(), pairs_at_[v].end(), is_smaller);
          int column = 0;
          for (const Index pair : pairs_at_[v]) {
            const auto [i, j] = pairs_[pair];
            const Eigen::Matrix3d block = block_of(pair);
            own += block;
            write(i == v ? j : i, -block, is_smaller(pair) ? column : column + width);
            column += width;
          }
          write(v, own, static_cast<int>(smaller) * width);
        }
      },
      context);
  return K;
}

EnergyRows AffineOperator::release_rows() {
  EnergyRows rows;
  rows.L.swap(L_);  // Eigen's matrices are copied where they would be moved
  rows.delta.swap(delta_);
  take_over(rows.P, P({.threads = 1}));
  std::vector<double>().swap(pair_values_);
  pairs_at_ = {};
  return rows;
}

SparseRows AffineOperator::A(const Context& context) const {
  return stack(SparseRows(L_ - multiply(delta_, H_, context)), multiply(P(context), H_, context));
}

}  // namespace meshgraft
