#include "part_system.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "core/platform/memory.h"
#include "core/stopwatch.h"
#include "deform/solve/fitted_field.h"
#include "deform/solve/stiffness_edges.h"
#include "deform/solve/vertex_solver.h"
#include "linalg/sparse_products.h"
#include "operators/density_scale.h"
#include "operators/laplacian.h"

#include "components.h"
#include "label_sums.h"

namespace meshgraft::distributed {

namespace {

const Context one_thread{.threads = 1};

/// Returns the sum of the positive mean edge lengths of the own vertices and their number.
std::pair<double, Number> sum_edge_lengths(const Part& part) {
  const std::vector<double> lengths = mean_edge_lengths(part.points, part.mesh.rings);
  double sum = 0;
  Number count = 0;
  for (Index v = 0; v < part.mesh.vertices.own(); ++v)
    if (lengths[v] > 0) sum += lengths[v], ++count;
  return {sum, count};
}

/// Returns some rows of a matrix, each times its scale.
SparseRows scaled_rows(const SparseRows& matrix, const std::vector<Index>& rows,
                       const std::vector<double>& scales) {
  if (rows.empty()) return SparseRows(0, matrix.cols());
  SparseRows scaled = select_rows(matrix, rows, one_thread);
  for (Eigen::Index row = 0; row < scaled.rows(); ++row)
    for (SparseRows::InnerIterator it(scaled, row); it; ++it) it.valueRef() *= scales[row];
  return scaled;
}

/// Computes Pᵀ P x without storing P x, which is several times as large as x.
Columns normal_product(const SparseRows& P, const Columns& x) {
  Columns sum = Columns::Zero(x.rows(), x.cols());
  for (Eigen::Index row = 0; row < P.rows(); ++row) {
    Eigen::RowVector3d product = Eigen::RowVector3d::Zero();
    for (SparseRows::InnerIterator it(P, row); it; ++it) product += it.value() * x.row(it.col());
    for (SparseRows::InnerIterator it(P, row); it; ++it) sum.row(it.col()) += it.value() * product;
  }
  return sum;
}

/// Returns the area of a triangle, in patch units.
double area_of(const Part& part, Index triangle) {
  const auto corners = part.mesh.triangles.row(triangle);
  const Eigen::RowVector3d u = part.points.row(corners[1]) - part.points.row(corners[0]),
                           v = part.points.row(corners[2]) - part.points.row(corners[0]);
  return u.cross(v).norm() / 2;
}

/// Returns the area of the own faces with a free corner, in patch units.
double free_area(const Part& part) {
  double area = 0;
  for (Index t = 0; t < part.mesh.triangles.rows(); ++t) {
    const auto corners = part.mesh.triangles.row(t);
    if (!part.mesh.owns_triangle(t)) continue;
    if (std::none_of(corners.begin(), corners.end(), [&](Index v) { return !part.mask.position[v]; })) continue;
    area += area_of(part, t);
  }
  return area;
}

}  // namespace

PartSystem::PartSystem(const Communicator& comm, const Part& part, const std::vector<Anchor>& anchors,
                       const DistributedOptions& options)
    : comm_(comm),
      part_(part),
      anchors_(anchors),
      preconditioner_(options.preconditioner),
      tolerance_(options.tolerance) {
  build_operator(options.deformer);
  column_ = number_columns();
  if (columns_.total() == 0) return;
  find_stiffness_scales(options.deformer);
  comm.together([&] { build_system(options.deformer); });
  factorise();
  if (comm.any(!anchors_.empty()) && options.deformer.operators.density == Density::aware) {
    weigh_anchors();
    factorise();
  }
}

void PartSystem::build_operator(const DeformerOptions& options) {
  const auto [sum, count] = sum_edge_lengths(part_);
  const double total = comm_.sum(sum);
  const Number positive = comm_.sum(count);
  mean_edge_length_ = positive > 0 ? total / static_cast<double>(positive) : 1.0;
  const double area = comm_.sum(free_area(part_));
  region_size_ = area > 0 ? std::sqrt(area) : 1.0;
  comm_.together([&] {
    rows_.emplace(OperatorMesh{part_.points, part_.mesh.triangles, part_.original}, part_.mask,
                  options.operators, one_thread);
  });
  Number degenerate = 0;
  for (Index v = 0; v < part_.mesh.vertices.own(); ++v)
    degenerate += part_.mask.is_movable(v) && rows_->nodes().flat[v];
  degenerate_vertices_ = comm_.sum(degenerate);
}

/// Numbers the columns over all ranks: each free vertex, followed by its apex. Returns the local column of each
/// node, or -1.
std::vector<int> PartSystem::number_columns() {
  const StencilNodes& nodes = rows_->nodes();
  const Halo& vertices = part_.mesh.vertices;
  const auto has_column = [&](Index v) { return !part_.mask.position[v]; };
  const auto apex_has_column = [&](Index v) { return nodes.apex[v] >= 0 && part_.mask.is_fitted(v); };
  std::vector<Number> first(vertices.size(), -1);  // number of a vertex's first column
  Number own = 0;
  for (Index v = 0; v < vertices.own(); ++v) {
    first[v] = own;
    own += has_column(v) + apex_has_column(v);
  }
  const std::vector<Number> starts = comm_.starts(own);
  for (Index v = 0; v < vertices.own(); ++v) first[v] += starts[comm_.rank()];
  vertices.update(first);
  std::vector<int> column(nodes.positions.rows(), -1);
  std::vector<Number> copies;
  int next = 0;
  for (Index v = 0; v < vertices.size(); ++v) {
    const auto add = [&](Index node, Number number) {
      column[node] = next++;
      if (v >= vertices.own()) copies.push_back(number);
    };
    if (has_column(v)) add(v, first[v]);
    if (apex_has_column(v)) add(nodes.apex[v], first[v] + has_column(v));
  }
  columns_ = Halo(comm_, starts, std::move(copies));
  return column;
}

/// Returns the matrix that places local columns at their nodes.
SparseRows PartSystem::unknowns_of_nodes() const {
  std::vector<int> entries(column_.size());
  std::transform(column_.begin(), column_.end(), entries.begin(), [](int column) { return column >= 0; });
  SparseRows E = rows_of_lengths(entries, columns_.size());
  std::copy_if(column_.begin(), column_.end(), E.innerIndexPtr(), [](int column) { return column >= 0; });
  std::fill_n(E.valuePtr(), E.nonZeros(), 1.0);
  return E;
}

/// Builds the rows that belong to this rank, as `ConstrainedSystem` does.
void PartSystem::build_system(const DeformerOptions& options) {
  const Index own = part_.mesh.vertices.own();
  // The operator scales its rows by ℓ̄ of the part; they are scaled by that of the whole patch.
  const auto rescaled = [&](double length) {
    if (options.operators.density != Density::aware) return 1.0;
    return density_scale(mean_edge_length_ / length) / density_scale(rows_->mean_edge_length() / length);
  };
  const double of_integrals = mean_edge_length_ / rows_->mean_edge_length();
  const std::vector<double>& lengths = rows_->edge_lengths();
  std::vector<Index> own_rows;
  std::vector<double> scales;
  EnergyRows all = rows_->release_rows();
  for (Index row = 0; row < all.delta.rows(); ++row) {  // a row of Δ has entries at its vertex alone
    const Index v = all.delta.innerIndexPtr()[all.delta.outerIndexPtr()[row]] / 3;
    if (v >= own) continue;
    own_rows.push_back(row);
    scales.push_back(rescaled(lengths[v]));
  }
  take_over(L_, scaled_rows(all.L, own_rows, scales));
  take_over(delta_, scaled_rows(all.delta, own_rows, scales));

  own_rows.clear();
  scales.clear();
  const auto& pairs = rows_->pairs();
  const auto rows_per_pair = pairs.empty() ? 0 : static_cast<Index>(all.P.rows() / std::ssize(pairs));
  const Halo& vertices = part_.mesh.vertices;
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    const auto [i, j] = pairs[pair];
    if ((vertices.number(i) < vertices.number(j) ? i : j) >= own) continue;
    for (Index k = 0; k < rows_per_pair; ++k) {
      own_rows.push_back(static_cast<Index>(pair) * rows_per_pair + k);
      scales.push_back(rows_->intrinsic_edges() ? of_integrals : rescaled(0.5 * (lengths[i] + lengths[j])));
    }
  }
  take_over(P_, scaled_rows(all.P, own_rows, scales));

  const SparseRows E = unknowns_of_nodes(), G = multiply(rows_->H(), E, one_thread);
  take_over(A_L_, difference_of_products({L_, E}, {delta_, G}, one_thread));
  list_edge_rows(options);
  take_over(stiffness_, stiffness_rows());
  take_over(A_L_, stack(A_L_, multiply(stiffness_, E, one_thread), one_thread));
  if (!anchors_.empty()) take_over(A_L_, stack(A_L_, anchor_rows(G, options.operators.density), one_thread));
}

/// Finds the factor of the stiffness at each vertex, as `ConstrainedSystem` does.
void PartSystem::find_stiffness_scales(const DeformerOptions& options) {
  if (options.method == DeformMethod::ft05 || options.stiffness <= 0) return;
  const LocalMesh& mesh = part_.mesh;
  const bool is_aware = options.operators.density == Density::aware;
  stiffness_scales_.assign(mesh.vertices.size(), 0);
  for (Index v = 0; v < mesh.vertices.size(); ++v)
    if (!part_.mask.position[v]) stiffness_scales_[v] = is_aware ? mean_edge_length_ / region_size_ : 1.0;
  if (!is_aware || !options.soften_coarse) return;

  Flags is_free(mesh.vertices.size());
  for (Index v = 0; v < mesh.vertices.size(); ++v) is_free[v] = !part_.mask.position[v];
  const std::vector<Number> component =
      find_components(comm_, mesh, is_free, std::vector<Number>(part_.original.begin(), part_.original.end()));
  LabelValues sizes;  // area, vertices
  for (Index v = 0; v < mesh.vertices.size(); ++v)
    if (is_free[v]) {
      Eigen::VectorXd& size = sizes.try_emplace(component[v], Eigen::VectorXd::Zero(2)).first->second;
      size[1] += v < mesh.vertices.own();
    }
  for (Index t = 0; t < mesh.triangles.rows(); ++t) {
    const auto corners = mesh.triangles.row(t);
    const auto free = std::find_if(corners.begin(), corners.end(), [&](Index v) { return is_free[v] != 0; });
    if (mesh.owns_triangle(t) && free != corners.end()) sizes.at(component[*free])[0] += area_of(part_, t);
  }
  sizes = sum_by_label(comm_, sizes);

  for (Index v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_free[v]) continue;
    const Eigen::VectorXd& size = sizes.at(component[v]);
    stiffness_scales_[v] = stiffness_scale(
        mean_edge_length_, {.area = size[0], .vertices = options.vertices_represented * size[1]},
        options.stiffness);
  }
}

/// Lists the rows w (x_i − x_j) of the edges with a free end, as `ConstrainedSystem` does.
void PartSystem::list_edge_rows(const DeformerOptions& options) {
  if (options.method == DeformMethod::ft05 || options.stiffness <= 0) return;
  const Halo& vertices = part_.mesh.vertices;
  visit_stiffness_edges(*rows_, options.stiffness, [&](Index i, Index j, double weight) {
    const Index first = vertices.number(i) < vertices.number(j) ? i : j;
    if (first < vertices.own() && (!part_.mask.position[i] || !part_.mask.position[j]))
      edge_rows_.push_back({{i, j}, weight * edge_scale(stiffness_scales_[i], stiffness_scales_[j])});
  });
}

/// Returns the rows of `edge_rows_`.
SparseRows PartSystem::stiffness_rows() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t b = 0; b < edge_rows_.size(); ++b) {
    entries.emplace_back(static_cast<int>(b), edge_rows_[b].ends[0], edge_rows_[b].weight);
    entries.emplace_back(static_cast<int>(b), edge_rows_[b].ends[1], -edge_rows_[b].weight);
  }
  SparseRows rows(static_cast<Eigen::Index>(edge_rows_.size()), rows_->nodes().positions.rows());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

/// Returns soft rows weight · (x_i − target), as `ConstrainedSystem` has them before it weighs the anchors.
SparseRows PartSystem::anchor_rows(const SparseRows& G, Density density) {
  const double area = region_size_ * region_size_;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t a = 0; a < anchors_.size(); ++a) {
    const Index v = anchors_[a].vertex;
    anchor_weights_.push_back(density == Density::aware ? rows_->edge_lengths()[v] * mean_edge_length_ / area
                                                        : anchors_[a].weight);
    const auto add = [&](Eigen::Index column, double value) {
      entries.emplace_back(static_cast<int>(a), static_cast<int>(column), anchor_weights_.back() * value);
    };
    add(column_[v], 1);
    const Eigen::RowVector3d back = part_.points.row(v) - rows_->nodes().positions.row(v);
    for (int k = 0; k < 3; ++k)
      if (back[k] != 0)
        for (SparseRows::InnerIterator it(G, 3 * v + k); it; ++it) add(it.col(), back[k] * it.value());
  }
  SparseRows rows(static_cast<Eigen::Index>(anchors_.size()), columns_.size());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

UnknownNodes PartSystem::unknown_nodes() const {
  UnknownNodes nodes{&part_.mesh, std::vector<Index>(columns_.own()), Points(columns_.own(), 3),
                     Flags(part_.mesh.vertices.size(), 0)};
  const auto add = [&](Index v, Index node) {
    if (node < 0 || column_[node] < 0) return;
    nodes.has_unknowns[v] = 1;
    if (column_[node] >= columns_.own()) return;
    nodes.vertex[column_[node]] = v;
    nodes.positions.row(column_[node]) = rows_->nodes().positions.row(node);
  };
  for (Index v = 0; v < part_.mesh.vertices.size(); ++v) {
    add(v, v);
    add(v, rows_->nodes().apex[v]);
  }
  return nodes;
}

/// Sums up AᵀA = A_LᵀA_L + Gᵀ (PᵀP) G from the rows of all ranks, and sets up the solver.
void PartSystem::factorise() {
  const Stopwatch watch;
  platform::release_freed_memory();
  NormalMatrix lower;
  comm_.together([&] {
    const SparseRows coupling = multiply(transpose(P_, one_thread), P_, one_thread);
    const SparseRows G = multiply(rows_->H(), unknowns_of_nodes(), one_thread);
    const SparseRows A_transposed = transpose(A_L_, one_thread), G_transposed = transpose(G, one_thread);
    lower = normal_equations(
        {.A = A_L_, .A_transposed = A_transposed, .G = G, .G_transposed = G_transposed, .K = coupling},
        one_thread);
  });
  platform::release_freed_memory();
  MatrixRows matrix = sum_contributions(comm_, columns_, lower);
  NormalMatrix().swap(lower);  // an assignment would keep its memory
  solver_.reset();
  solver_.emplace(comm_, std::move(matrix), unknown_nodes(),
                  ParallelSolverOptions{.preconditioner = preconditioner_, .prefix = ""});
  factorise_seconds_ += watch.seconds();
}

/// Scales each anchor's row by the compliance of the surface at the anchors, as `ConstrainedSystem` does.
void PartSystem::weigh_anchors() {
  const auto count = static_cast<Eigen::Index>(anchors_.size());
  const Eigen::Map<const Eigen::VectorXd> small(anchor_weights_.data(), count);
  SparseRows unit_rows(count, columns_.size());
  if (count > 0) unit_rows = SparseRows(small.cwiseInverse().asDiagonal() * SparseRows(A_L_.bottomRows(count)));
  Columns force = unit_rows.transpose() * Eigen::VectorXd::Ones(count);
  columns_.add_to_owners(force);
  const Columns response = with_halo(solver_->solve(force.topRows(columns_.own()), 1e-8, nullptr));
  Eigen::VectorXd compliance = unit_rows * response.col(0);
  const double most = comm_.largest(count > 0 ? compliance.maxCoeff() : 0.0);
  compliance = compliance.cwiseMax(1e-3 * most);
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(A_L_.rows());
  for (Eigen::Index a = 0; a < count; ++a) {
    const double weight = anchor_share * anchors_[a].weight / std::sqrt(compliance[a]);
    factors[A_L_.rows() - count + a] = weight / anchor_weights_[a];
    anchor_weights_[a] = weight;
  }
  take_over(A_L_, SparseRows(factors.asDiagonal() * A_L_));
}

/// Returns own rows, followed by those of the halo's columns.
Columns PartSystem::with_halo(const Columns& own) const {
  Columns all(columns_.size(), own.cols());
  all.topRows(columns_.own()) = own;
  columns_.update(all);
  return all;
}

PartSystem::Rows PartSystem::right_hand_side(const PartValues& values, const PartField& field) const {
  Columns x = Columns::Zero(rows_->nodes().positions.rows(), 3);
  x.topRows(values.displacement.rows()) = values.displacement;
  const Columns m = multiply(rows_->H(), x, one_thread) + values.maps;
  const Columns laplacian = multiply(delta_, m, one_thread) - multiply(L_, x, one_thread);
  const auto edge_count = static_cast<Eigen::Index>(edge_rows_.size());
  Rows rows;
  rows.laplacian.resize(A_L_.rows(), 3);
  rows.laplacian.topRows(laplacian.rows()) = laplacian;
  if (edge_count > 0)
    rows.laplacian.middleRows(laplacian.rows(), edge_count) = -multiply(stiffness_, x, one_thread);
  for (std::size_t b = 0; field.maps.rows() > 0 && b < edge_rows_.size(); ++b) {
    const auto [i, j] = edge_rows_[b].ends;
    const Eigen::RowVector3d d =
        edge_rows_[b].weight * (rows_->nodes().positions.row(i) - rows_->nodes().positions.row(j));
    rows.laplacian.row(laplacian.rows() + static_cast<Eigen::Index>(b)) +=
        d * ((field.maps.middleRows<3>(3 * i) + field.maps.middleRows<3>(3 * j)) / 2);
  }
  for (std::size_t a = 0; a < anchors_.size(); ++a) {
    const Index v = anchors_[a].vertex;
    const Eigen::RowVector3d back = part_.points.row(v) - rows_->nodes().positions.row(v);
    auto row = rows.laplacian.row(laplacian.rows() + edge_count + static_cast<Eigen::Index>(a));
    row = -anchor_weights_[a] * (back * m.middleRows<3>(3 * v));
    if (!anchors_[a].target) continue;
    const Eigen::RowVector3d target = (anchors_[a].target->transpose() - part_.centre) / part_.scale;
    row += anchor_weights_[a] * (target - part_.points.row(v));
  }
  rows.maps = -m;
  if (field.maps.rows() > 0 && field.smooth)
    rows.maps += FittedField(*rows_, rows_->H(), part_.mask)(field.maps, one_thread);
  return rows;
}

/// Returns the local maps m = G y of local columns y.
Columns PartSystem::maps_of(const Columns& y) const {
  Columns x = Columns::Zero(static_cast<Eigen::Index>(column_.size()), y.cols());
  for (std::size_t node = 0; node < column_.size(); ++node)
    if (column_[node] >= 0) x.row(node) = y.row(column_[node]);
  return multiply(rows_->H(), x, one_thread);
}

/// Returns Aᵀ times rows, own columns × 3.
Columns PartSystem::apply_transposed(const Rows& rows) const {
  Columns sums = A_L_.transpose() * rows.laplacian;
  const Columns at_nodes = rows_->H().transpose() * normal_product(P_, rows.maps);
  for (std::size_t node = 0; node < column_.size(); ++node)
    if (column_[node] >= 0) sums.row(column_[node]) += at_nodes.row(node);
  columns_.add_to_owners(sums);
  return sums.topRows(columns_.own());
}

PartSystem::Rows PartSystem::residual_rows(const Rows& rhs, const Columns& y) const {
  const Columns all = with_halo(y);
  Rows left{multiply(A_L_, all, one_thread), maps_of(all)};
  left.laplacian = rhs.laplacian - left.laplacian;
  left.maps = rhs.maps - left.maps;
  return left;
}

Columns PartSystem::solve(const PartValues& values, const PartField& field, int corrections,
                          const Columns* guess) const {
  const Rows rhs = right_hand_side(values, field);
  const double each = std::pow(tolerance_, 1.0 / (1 + corrections));
  Columns y = solver_->solve(apply_transposed(rhs), each, guess);
  for (int correction = 0; correction < corrections; ++correction)
    y += solver_->solve(apply_transposed(residual_rows(rhs, y)), each, nullptr);
  return y;
}

double PartSystem::residual(const Columns& y, const PartValues& values, const PartField& field) const {
  const Rows rhs = right_hand_side(values, field);
  const double scale = comm_.sum(apply_transposed(rhs).squaredNorm());
  const double left = comm_.sum(apply_transposed(residual_rows(rhs, y)).squaredNorm());
  return scale > 0 ? std::sqrt(left / scale) : 0.0;
}

Columns PartSystem::maps(const Columns& y, const PartValues& values) const {
  Columns x = Columns::Zero(rows_->nodes().positions.rows(), 3);
  x.topRows(values.displacement.rows()) = values.displacement;
  const Columns m = maps_of(with_halo(y)) + multiply(rows_->H(), x, one_thread) + values.maps;
  return m.topRows(3 * Eigen::Index{part_.mesh.vertices.own()});
}

Columns PartSystem::displacements(const Columns& y, const PartValues& values) const {
  const Index own = part_.mesh.vertices.own();
  Columns x = values.displacement.topRows(own);
  for (Index v = 0; v < own; ++v)
    if (column_[v] >= 0) x.row(v) = y.row(column_[v]);
  const std::vector<Index>& moved = rows_->nodes().moved;
  if (!comm_.any(!moved.empty())) return x;
  const Columns m = maps(y, values);  // FT05 equation 8: x = M (p − p') + x' for vertices moved off their plane
  for (const Index v : moved)
    if (v < own) x.row(v) += (part_.points.row(v) - rows_->nodes().positions.row(v)) * m.middleRows<3>(3 * v);
  return x;
}

}  // namespace meshgraft::distributed
