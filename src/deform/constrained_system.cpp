#include "constrained_system.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "../core/stopwatch.h"
#include "region_states.h"
#include "rotations.h"

namespace meshgraft {

void require_vertex(Index vertex, Index count, const std::string& place) {
  if (vertex < 0 || vertex >= count)
    throw Error(ErrorCode::input, fmt::format("vertex {} does not exist; the mesh has {}", vertex, count),
                place);
}

namespace {

/// Whether a vertex of a feature has a neighbour that is not in it.
bool beside_others(Index vertex, const Triangles& triangles, std::span<const Index> faces,
                   const std::vector<Index>& feature) {
  return std::any_of(faces.begin(), faces.end(), [&](Index t) {
    return std::any_of(triangles.row(t).begin(), triangles.row(t).end(),
                       [&](Index w) { return feature[w] != feature[vertex]; });
  });
}

}  // namespace

ConstrainedSystem::ConstrainedSystem(const Points& points, const Triangles& triangles,
                                     const VertexStates& states, std::span<const Anchor> all_anchors,
                                     std::span<const Feature> features, const DeformerOptions& options,
                                     DeformerSummary& summary, const Context& context)
    : rest_(points),
      residual_corrections_(options.residual_corrections),
      features_(features.begin(), features.end()),
      feature_column_(features.size(), -1) {
  validate(options.operators);
  if (residual_corrections_ < 0 || residual_corrections_ > 10)
    throw Error(ErrorCode::input, fmt::format("{} is not between 0 and 10", residual_corrections_),
                "residual_corrections");
  Stopwatch watch;
  cut_patch(triangles, states, options.operators.laplacian_order, context);
  take_anchors(all_anchors, states);
  if (patch_.size() > 0) {
    build_operators(options.operators, context);
    region_size_ = std::sqrt(free_area());
    build_system(options.operators.density, options.method == DeformMethod::ft05 ? 0 : options.stiffness,
                 context);
    summary.degenerate_vertices = count_degenerate();
  }
  summary.free_vertices = static_cast<Index>(free_.size());
  summary.assemble_seconds = watch.lap();
  if (E_.cols() == 0) return;
  factorise(options.backend, summary, context);
  prepare_similarities(context);
}

/// The patch reaches so far that every row with an unknown, and every normal and weight in it, is complete.
/// Rows within a feature are zero whatever its map: of its vertices only those beside others count.
void ConstrainedSystem::cut_patch(const Triangles& triangles, const VertexStates& states, int laplacian_order,
                                  const Context& context) {
  const auto n = static_cast<Index>(rest_.rows());
  const IndexLists faces_at = vertex_triangles(n, triangles, context);
  std::vector<std::uint8_t> active(static_cast<std::size_t>(n), 0);
  for (Index v = 0; v < n; ++v) {
    active[v] = !faces_at[v].empty() && (!states.position[v] || !states.transform[v]);
    if (active[v] && states.feature[v] >= 0)
      active[v] = beside_others(v, triangles, faces_at[v], states.feature);
    if (!faces_at[v].empty() && !states.position[v]) free_.push_back(v);
  }
  patch_ = make_patch(rest_, triangles, faces_at, active, laplacian_order + 2, context);
  for (Index v : patch_.vertices) {
    known_.position.push_back(states.position[v] || faces_at[v].empty());
    known_.transform.push_back(states.transform[v] || faces_at[v].empty());
    known_.feature.push_back(states.feature[v]);
  }
  known_.anchored.assign(patch_.vertices.size(), 0);
}

void ConstrainedSystem::take_anchors(std::span<const Anchor> all_anchors, const VertexStates& states) {
  for (std::size_t a = 0; a < all_anchors.size(); ++a) {
    const Anchor& anchor = all_anchors[a];
    require_usable(anchor, a, static_cast<Index>(rest_.rows()));
    const Index local = patch_.local(anchor.vertex);
    if (local < 0 || states.position[anchor.vertex]) continue;  // what is held needs no anchor
    known_.anchored[local] = 1;
    anchors_.push_back(anchor);
  }
}

void ConstrainedSystem::build_operators(const OperatorOptions& options, const Context& context) {
  const Index n = patch_.size();
  const IndexLists rings = vertex_rings(n, patch_.triangles, context);
  settle_idle_components(rings, known_);
  require_solvable(patch_, rings, known_);

  AffineOperator::Extent extent;
  extent.fitted.resize(static_cast<std::size_t>(n));
  extent.unknown.resize(static_cast<std::size_t>(n));
  extent.movable.resize(static_cast<std::size_t>(n));
  std::vector<Index> active;
  for (Index v = 0; v < n; ++v) {
    extent.unknown[v] = !known_.transform[v];
    extent.fitted[v] = !known_.transform[v] && known_.feature[v] < 0;
    extent.movable[v] = !known_.position[v] && !known_.transform[v] && known_.feature[v] < 0;
    if (!known_.position[v] || !known_.transform[v]) active.push_back(v);
  }
  extent.numbers = patch_.vertices;
  extent.rows.assign(static_cast<std::size_t>(n), 0);
  for (Index v : grow_rings(active, options.laplacian_order, rings)) extent.rows[v] = 1;
  operators_ = std::make_unique<AffineOperator>(patch_.points, patch_.triangles, options, extent, context);
}

Index ConstrainedSystem::count_degenerate() const {
  Index count = 0;
  for (Index v = 0; v < patch_.size(); ++v)
    if (!known_.position[v] && operators_->nodes().flat[v]) ++count;
  return count;
}

/// Area of the patch's faces with a free corner, features apart, in the patch's units.
double ConstrainedSystem::free_area() const {
  double area = 0;
  for (const auto& t : patch_.triangles.rowwise()) {
    if (std::none_of(t.begin(), t.end(), [&](Index v) { return !known_.position[v] && known_.feature[v] < 0; }))
      continue;
    const Eigen::RowVector3d u = patch_.points.row(t[1]) - patch_.points.row(t[0]),
                             v = patch_.points.row(t[2]) - patch_.points.row(t[0]);
    area += u.cross(v).norm() / 2;
  }
  return area > 0 ? area : 1;
}

/// Rows w (x_i − x_j) of the edges with a free end, toward w ½(F_i + F_j)(p_i − p_j). With `aware` their sum
/// approximates μ²/D² ∫ ‖∂x − F‖², D the region's size, beside E_R's ∫ ‖∂M − ∂F‖²: neither size nor
/// tessellation counts.
SparseRows ConstrainedSystem::stiffness_rows(Density density, double stiffness) {
  const AffineOperator& op = *operators_;
  const double scale = density == Density::aware ? op.mean_edge_length() / region_size_ : 1.0;
  if (stiffness > 0) {
    for (Index i = 0; i < patch_.size(); ++i)
      for (const Index j : op.rings()[i])
        if (i < j && (!known_.position[i] || !known_.position[j]) &&
            (known_.feature[i] < 0 || known_.feature[i] != known_.feature[j]))
          bars_.push_back({{i, j}, stiffness * scale});
  }
  SparseRows rows(static_cast<Eigen::Index>(bars_.size()), op.nodes().positions.rows());
  if (bars_.empty()) return rows;  // Eigen's makeCompressed does not take a matrix without rows
  rows.reserve(std::vector<int>(bars_.size(), 2));
  for (std::size_t b = 0; b < bars_.size(); ++b) {
    const auto row = static_cast<Eigen::Index>(b);
    rows.insertBackUncompressed(row, bars_[b].ends[0]) = bars_[b].weight;
    rows.insertBackUncompressed(row, bars_[b].ends[1]) = -bars_[b].weight;
  }
  rows.makeCompressed();
  return rows;
}

/// Soft rows weight · (x_i − target). Where i was moved off its plane, x_i is the place it comes back to
/// (FT05 equation 8). With `aware`, the rows of anchors spread over a surface approximate an integral like
/// those of E_L and E_R, measured by the free area so that neither size nor tessellation counts.
SparseRows ConstrainedSystem::anchor_rows(Density density) {
  const AffineOperator& op = *operators_;
  const double area = region_size_ * region_size_;
  SparseRows rows(static_cast<Eigen::Index>(anchors_.size()), E_.cols());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t a = 0; a < anchors_.size(); ++a) {
    const Index v = patch_.local(anchors_[a].vertex);
    const double scale = density == Density::aware ? op.edge_lengths()[v] * op.mean_edge_length() / area : 1.0;
    anchor_weights_.push_back(anchors_[a].weight * scale);
    const auto add = [&](const SparseRows& matrix, Eigen::Index row, double factor) {
      for (SparseRows::InnerIterator it(matrix, row); it; ++it)
        entries.emplace_back(static_cast<int>(a), static_cast<int>(it.col()),
                             anchor_weights_.back() * factor * it.value());
    };
    add(E_, v, 1);
    const Eigen::RowVector3d back = patch_.points.row(v) - op.nodes().positions.row(v);
    for (int k = 0; k < 3; ++k)
      if (back[k] != 0) add(G_, 3 * v + k, back[k]);
  }
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

/// Columns: each free vertex and its apex in turn, then four for each feature (three of the map, one of the
/// translation).
void ConstrainedSystem::build_system(Density density, double stiffness, const Context& context) {
  const AffineOperator& op = *operators_;
  const Index n = patch_.size();
  const Eigen::Index node_count = op.nodes().positions.rows();
  std::vector<int> column(static_cast<std::size_t>(node_count), -1);
  int columns = 0;
  std::map<Index, std::vector<Index>> features;
  for (Index v = 0; v < n; ++v) {
    if (known_.feature[v] >= 0)
      features[known_.feature[v]].push_back(v);
    else if (!known_.position[v])
      column[v] = columns++;
    if (op.nodes().apex[v] >= 0) column[op.nodes().apex[v]] = columns++;
  }
  const int first_shared = columns;
  columns += 4 * static_cast<int>(features.size());

  std::vector<Eigen::Triplet<double>> E_entries, F_entries;
  for (Eigen::Index node = 0; node < node_count; ++node)
    if (column[node] >= 0) E_entries.emplace_back(static_cast<int>(node), column[node], 1.0);
  shared_begin_ = first_shared;
  int shared = first_shared;
  for (const auto& [feature, vertices] : features) {
    feature_column_[feature] = shared;
    if (features_[feature].similarity) similarities_.push_back(feature);
    for (Index v : vertices) {
      for (int k = 0; k < 3; ++k) {
        E_entries.emplace_back(v, shared + k, op.nodes().positions(v, k));
        F_entries.emplace_back(3 * v + k, shared + k, 1.0);
      }
      E_entries.emplace_back(v, shared + 3, 1.0);
    }
    shared += 4;
  }
  E_.resize(node_count, columns);
  E_.setFromTriplets(E_entries.begin(), E_entries.end());
  SparseRows F(3 * n, columns);
  F.setFromTriplets(F_entries.begin(), F_entries.end());
  if (columns == 0) return;

  G_ = multiply(op.H(), E_, context);
  if (F.nonZeros() > 0) G_ = SparseRows(G_ + F);
  A_L_ = difference_of_products(op.L(), E_, op.delta(), G_, context);

  bar_rows_ = stiffness_rows(density, stiffness);
  A_L_ = stack(stack(A_L_, multiply(bar_rows_, E_, context)), anchor_rows(density));
  A_L_transposed_ = transpose(A_L_, context);
  G_transposed_ = transpose(G_, context);
  P_transposed_ = transpose(op.P(), context);
  context.step("assemble", 0.7);
}

/// AᵀA = A_LᵀA_L + Gᵀ(PᵀP)G; PᵀP couples the maps of pairs alone and is small.
NormalMatrix ConstrainedSystem::normal_matrix(const Context& context) const {
  if (E_.cols() == 0) return NormalMatrix(0, 0);
  return normal_equations(A_L_transposed_, A_L_, G_transposed_, coupling(context), G_, context);
}

/// Unknowns sit at their vertices; those of features are shared by vertices far apart.
CouplingGraph ConstrainedSystem::coupling_graph() const {
  CouplingGraph graph{std::vector<Index>(static_cast<std::size_t>(E_.cols()), -1), &operators_->rings(), cuts_,
                      Points::Zero(E_.cols(), 3)};
  const std::vector<Index>& apex = operators_->nodes().apex;
  for (Index v = 0; v < patch_.size(); ++v)
    for (const Index node : {v, apex[v]}) {
      if (node < 0) continue;
      for (SparseRows::InnerIterator entry(E_, node); entry; ++entry)
        if (entry.col() < shared_begin_) {
          graph.group[entry.col()] = v;
          graph.positions.row(entry.col()) = operators_->nodes().positions.row(node);
        }
    }
  return graph;
}

void ConstrainedSystem::factorise(SolverBackend backend, DeformerSummary& summary, const Context& context) {
  Stopwatch watch;
  const NormalMatrix normal = normal_matrix(context);
  normal_one_norm_ = one_norm(normal);
  summary.assemble_seconds += watch.lap();

  solver_ = make_solver(backend);
  solver_->analyse(normal, coupling_graph(), context);
  summary.analyse_seconds = watch.lap();
  solver_->factorise(normal, context);
  summary.factorise_seconds = watch.lap();
  summary.solver = solver_->statistics();
}

void ConstrainedSystem::prepare_similarities(const Context& context) {
  const auto count = static_cast<Eigen::Index>(4 * similarities_.size());
  if (count == 0) return;
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(E_.cols(), count);
  for (Eigen::Index s = 0; s < count; ++s) units(shared_row(s), s) = 1;
  similarity_response_ = solver_->solve(units, context);
  Eigen::MatrixXd among(count, count);
  for (Eigen::Index s = 0; s < count; ++s) among.row(s) = similarity_response_.row(shared_row(s));
  similarity_stiffness_ = among.inverse();
}

/// Row of y of the s-th shared unknown of the similarities.
Eigen::Index ConstrainedSystem::shared_row(Eigen::Index s) const {
  return feature_column_[similarities_[static_cast<std::size_t>(s / 4)]] + s % 4;
}

/// Takes each similarity's affine map to the similarity that costs least, and the other unknowns along. With K
/// the cost of a change of (T, t), and t at its best, that is the least tr (sRᵀ − Tᵀ)ᵀ K̄ (sRᵀ − Tᵀ): a
/// Procrustes problem. Exact for one feature; several together settle in the co-rotational steps.
void ConstrainedSystem::impose_similarities(Columns& y) const {
  if (similarities_.empty()) return;
  const Eigen::Index count = similarity_stiffness_.rows();
  Columns change(count, 3);
  for (std::size_t f = 0; f < similarities_.size(); ++f) {
    const auto first = static_cast<Eigen::Index>(4 * f);
    const Feature& feature = features_[similarities_[f]];
    const Eigen::Matrix4d K = similarity_stiffness_.block<4, 4>(first, first);
    const Eigen::Vector3d drift = K.block<3, 1>(0, 3) / K(3, 3);  // what a change of T costs in t
    const Eigen::Matrix3d K_bar = K.topLeftCorner<3, 3>() - drift * K.block<1, 3>(3, 0);
    const Eigen::Matrix3d T_transposed =
        y.middleRows<3>(feature_column_[similarities_[f]]) + Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d moments = K_bar * T_transposed;
    const Eigen::Matrix3d R = nearest_rotation(moments.transpose());
    const double scale = feature.scale.value_or((R * moments).trace() / K_bar.trace());
    const Eigen::Matrix3d difference = scale * R.transpose() - T_transposed;
    change.middleRows<3>(first) = difference;
    change.row(first + 3) = -drift.transpose() * difference;
  }
  y += similarity_response_ * (similarity_stiffness_ * change);
}

std::vector<Eigen::Matrix3d> ConstrainedSystem::feature_maps(const Columns& y) const {
  std::vector<Eigen::Matrix3d> maps(features_.size(), Eigen::Matrix3d::Identity());
  for (std::size_t f = 0; f < features_.size(); ++f)
    if (feature_column_[f] >= 0) maps[f] += y.middleRows<3>(feature_column_[f]).transpose();
  return maps;
}

ConstrainedSystem::Known ConstrainedSystem::known_values(std::span<const VertexConstraint> constraints) const {
  Known values{Columns::Zero(operators_->nodes().positions.rows(), 3), Columns::Zero(3 * patch_.size(), 3)};
  for (const VertexConstraint& constraint : constraints) {
    const Index v = patch_.local(constraint.vertex);
    if (v < 0) continue;
    if (constraint.position)
      values.x.row(v) = (constraint.position->transpose() - rest_.row(constraint.vertex)) / patch_.scale;
    if (constraint.transform)
      values.m.middleRows<3>(3 * v) = (*constraint.transform - Eigen::Matrix3d::Identity()).transpose();
  }
  return values;
}

ConstrainedSystem::Known ConstrainedSystem::no_values(Eigen::Index columns) const {
  return {Columns::Zero(operators_->nodes().positions.rows(), columns),
          Columns::Zero(3 * patch_.size(), columns)};
}

Eigen::Index ConstrainedSystem::row_count() const { return solver_ ? A_L_.rows() + operators_->P().rows() : 0; }

namespace {

/// What E_R draws the maps' free part to.
Columns wanted_maps(const Columns& known, const MapField& field) {
  return field.smoothness.rows() == 0 ? Columns(-known) : Columns(field.smoothness - known);
}

}  // namespace

/// The part of b that is linear in values and field; anchors draw to rest.
ConstrainedSystem::Rows ConstrainedSystem::right_hand_side(const Known& values, const MapField& field,
                                                           const Context& context) const {
  const Columns m = multiply(operators_->H(), values.x, context) + values.m;
  return {laplacian_rows(values, m, field, context), multiply(operators_->P(), wanted_maps(m, field), context)};
}

/// The rows of E_L, of stiffness and of anchors; `m` are the maps of what is known.
Columns ConstrainedSystem::laplacian_rows(const Known& values, const Columns& m, const MapField& field,
                                          const Context& context) const {
  const AffineOperator& op = *operators_;
  const Columns laplacian = multiply(op.delta(), m, context) - multiply(op.L(), values.x, context);
  const auto bar_count = static_cast<Eigen::Index>(bars_.size());
  Columns rows(A_L_.rows(), m.cols());
  rows.topRows(laplacian.rows()) = laplacian;
  if (bar_count > 0) {
    auto bars = rows.middleRows(laplacian.rows(), bar_count);
    bars = -multiply(bar_rows_, values.x, context);
    if (field.stretch.rows() > 0) add_stretch(field.stretch, bars);
  }
  for (std::size_t a = 0; a < anchors_.size(); ++a) {
    const Index v = patch_.local(anchors_[a].vertex);
    const Eigen::RowVector3d back = patch_.points.row(v) - op.nodes().positions.row(v);
    rows.row(laplacian.rows() + bar_count + static_cast<Eigen::Index>(a)) =
        -anchor_weights_[a] * (back * m.middleRows<3>(3 * v));
  }
  return rows;
}

void ConstrainedSystem::add_stretch(const Columns& stretch, Eigen::Ref<Columns> bars) const {
  const Points& points = operators_->nodes().positions;
  for (std::size_t b = 0; b < bars_.size(); ++b) {
    const auto [i, j] = bars_[b].ends;
    const Eigen::RowVector3d d = bars_[b].weight * (points.row(i) - points.row(j));
    bars.row(static_cast<Eigen::Index>(b)) +=
        d * ((stretch.middleRows<3>(3 * i) + stretch.middleRows<3>(3 * j)) / 2);
  }
}

/// Where anchors draw to, the last rows beside E_L's.
void ConstrainedSystem::add_targets(Rows& rows) const {
  const auto first = rows.laplacian.rows() - static_cast<Eigen::Index>(anchors_.size());
  for (std::size_t a = 0; a < anchors_.size(); ++a) {
    if (!anchors_[a].target) continue;
    const Eigen::RowVector3d move = anchors_[a].target->transpose() - rest_.row(anchors_[a].vertex);
    rows.laplacian.row(first + static_cast<Eigen::Index>(a)) += anchor_weights_[a] * (move / patch_.scale);
  }
}

Columns ConstrainedSystem::apply_transposed(const Rows& rows, const Context& context) const {
  return multiply(A_L_transposed_, rows.laplacian, context) +
         multiply(G_transposed_, multiply(P_transposed_, rows.smoothness, context), context);
}

ConstrainedSystem::Rows ConstrainedSystem::residual_rows(const Rows& rhs, const Columns& y,
                                                         const Context& context) const {
  return {rhs.laplacian - multiply(A_L_, y, context),
          rhs.smoothness - multiply(operators_->P(), multiply(G_, y, context), context)};
}

/// y = (AᵀA)⁻¹ Aᵀ b, then corrections with the residual of the rectangular system. An iterative solver has to
/// be as accurate only as all of them together are to be.
Columns ConstrainedSystem::solve(const Rows& rhs, const SolveSteps& steps, const Context& context) const {
  // Of the box, errors are some ten times as large as these (docs/performance.md).
  const double tolerance = steps.corrections > 0 ? 1e-8 : 1e-6;
  SolveOptions options{.tolerance = std::pow(tolerance, 1.0 / (1 + steps.corrections))};
  const auto back_substitute = [&](const Rows& rows) {
    return Columns(solver_->solve(Eigen::MatrixXd(apply_transposed(rows, context)), options, context));
  };
  Eigen::MatrixXd guess;
  if (steps.guess != nullptr && steps.guess->rows() == E_.cols()) {
    guess = *steps.guess;
    options.guess = &guess;
  }
  Columns y = back_substitute(rhs);
  options.guess = nullptr;
  for (int correction = 0; correction < steps.corrections; ++correction)
    y += back_substitute(residual_rows(rhs, y, context));
  impose_similarities(y);
  return y;
}

Columns ConstrainedSystem::solve(const Known& values, const MapField& field, const SolveSteps& steps,
                                 const Context& context) const {
  Rows rhs = right_hand_side(values, field, context);
  add_targets(rhs);
  return solve(rhs, steps, context);
}

Columns ConstrainedSystem::respond(const Known& values, const MapField& field, int corrections,
                                   const Context& context) const {
  return solve(right_hand_side(values, field, context), {.corrections = corrections}, context);
}

Columns ConstrainedSystem::respond(const Known& values, const MapField& field, const SparseRows& coupling,
                                   const Context& context) const {
  const Columns m = multiply(operators_->H(), values.x, context) + values.m;
  Columns rhs = multiply(A_L_transposed_, laplacian_rows(values, m, field, context), context);
  rhs += multiply(G_transposed_, multiply(coupling, wanted_maps(m, field), context), context);
  return solver_->solve(Eigen::MatrixXd(rhs), context);
}

SparseRows ConstrainedSystem::coupling(const Context& context) const { return operators_->coupling(context); }

SparseRows ConstrainedSystem::field_rows(int axis, const SparseRows& coupling, const Context& context) const {
  const Index n = patch_.size();
  SparseRows along(3 * n, n);
  std::vector<Eigen::Triplet<double>> of_maps, of_bars;
  for (Index v = 0; v < n; ++v) of_maps.emplace_back(3 * v + axis, v, 1.0);
  along.setFromTriplets(of_maps.begin(), of_maps.end());
  const SparseRows smoothness = multiply(G_transposed_, multiply(coupling, along, context), context);
  if (bars_.empty()) return smoothness;
  const Points& points = operators_->nodes().positions;
  for (std::size_t b = 0; b < bars_.size(); ++b) {
    const auto [i, j] = bars_[b].ends;
    const double half = bars_[b].weight * (points(i, axis) - points(j, axis)) / 2;
    of_bars.emplace_back(static_cast<int>(b), i, half);
    of_bars.emplace_back(static_cast<int>(b), j, half);
  }
  SparseRows stretch(static_cast<Eigen::Index>(bars_.size()), n);
  stretch.setFromTriplets(of_bars.begin(), of_bars.end());
  const SparseRows bars_transposed = transpose(multiply(bar_rows_, E_, context), context);
  return smoothness + multiply(bars_transposed, stretch, context);
}

Columns ConstrainedSystem::back_substitute(const Columns& rhs, const Context& context) const {
  return solver_->solve(Eigen::MatrixXd(rhs), context);
}

SparseRows ConstrainedSystem::displacement_rows() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < free_.size(); ++k)
    for (SparseRows::InnerIterator it(E_, patch_.local(free_[k])); it; ++it)
      entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()), it.value());
  const StencilNodes& nodes = operators_->nodes();
  for (const Index v : nodes.moved) {  // as in `displacements`
    const Eigen::RowVector3d back = patch_.points.row(v) - nodes.positions.row(v);
    const auto k = std::lower_bound(free_.begin(), free_.end(), patch_.vertices[v]) - free_.begin();
    for (int axis = 0; axis < 3; ++axis)
      for (SparseRows::InnerIterator it(G_, 3 * v + axis); it; ++it)
        entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()), back[axis] * it.value());
  }
  SparseRows rows(static_cast<Eigen::Index>(free_.size()), E_.cols());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

Columns ConstrainedSystem::maps(const Columns& y, const Known& values, const Context& context) const {
  return multiply(G_, y, context) + multiply(operators_->H(), values.x, context) + values.m;
}

Columns ConstrainedSystem::displacements(const Columns& y, const Known& values, const Context& context) const {
  Columns x = multiply(E_, y, context) + values.x;
  const StencilNodes& nodes = operators_->nodes();
  if (!nodes.moved.empty()) {
    // FT05 equation 8: x = M (p − p') + x' for vertices that were moved off their plane.
    const Columns m = maps(y, values, context);
    for (Index v : nodes.moved) {
      const Eigen::RowVector3d back = patch_.points.row(v) - nodes.positions.row(v);
      x.row(v) += back * m.middleRows<3>(3 * v);
    }
  }
  x.conservativeResize(patch_.size(), Eigen::NoChange);
  return x;
}

void ConstrainedSystem::place(const Columns& y, const Known& values,
                              std::span<const VertexConstraint> constraints, Points& out,
                              const Context& context) const {
  out = rest_;
  if (y.rows() > 0) {
    const Columns x = displacements(y, values, context);
    place_features(y, out);
    for (Index v = 0; v < patch_.size(); ++v) {
      if (known_.position[v]) continue;
      const Index global = patch_.vertices[v];
      out.row(global) = rest_.row(global) + patch_.scale * x.row(v);
      if (!out.row(global).allFinite())
        throw Error(ErrorCode::unsolvable, fmt::format("the solution is not finite at vertex {}", global), "",
                    "Move the handles by less, or repair the surface there");
    }
  }
  for (const VertexConstraint& constraint : constraints)
    if (constraint.position) out.row(constraint.vertex) = constraint.position->transpose();
}

Columns ConstrainedSystem::feature_rows(std::size_t feature, const Columns& y) const {
  if (feature_column_[feature] < 0) return Columns::Zero(4, y.cols());
  return y.middleRows<4>(feature_column_[feature]);
}

/// All vertices of the features that something reaches.
void ConstrainedSystem::place_features(const Columns& y, Points& out) const {
  for (std::size_t f = 0; f < features_.size(); ++f) {
    if (feature_column_[f] < 0) continue;
    const auto map = y.middleRows<4>(feature_column_[f]);  // less I
    for (const Index v : features_[f].vertices) {
      const Eigen::RowVector3d p = (rest_.row(v) - patch_.centre) / patch_.scale;
      out.row(v) = rest_.row(v) + patch_.scale * (p * map.topRows<3>() + map.row(3));
    }
  }
}

/// max ‖M_c(x) − W_c‖ over the constrained transforms next to something free.
double ConstrainedSystem::max_transform_deviation(std::span<const VertexConstraint> constraints,
                                                  const Points& positions) const {
  Points local(patch_.size(), 3);
  for (Index v = 0; v < patch_.size(); ++v)
    local.row(v) = (positions.row(patch_.vertices[v]) - patch_.centre) / patch_.scale;
  std::vector<Eigen::Matrix3d> given(static_cast<std::size_t>(patch_.size()), Eigen::Matrix3d::Identity());
  for (const VertexConstraint& constraint : constraints)
    if (const Index v = patch_.local(constraint.vertex); v >= 0 && constraint.transform)
      given[v] = *constraint.transform;
  double largest = 0;
  const IndexLists& rings = operators_->rings();
  for (Index v = 0; v < patch_.size(); ++v) {
    const bool beside_free =
        std::any_of(rings[v].begin(), rings[v].end(), [&](Index w) { return !known_.position[w]; });
    if (!known_.transform[v] || (!beside_free && known_.position[v])) continue;
    const double deviation = local_map_deviation(v, patch_.points, local, given[v], rings[v]).norm();
    largest = std::max(largest, deviation);
  }
  return largest;
}

void ConstrainedSystem::evaluate(std::span<const VertexConstraint> constraints, const Problem& problem,
                                 Points& out, EvaluationReport* report, Columns* solved_maps,
                                 const Context& context) const {
  if (solved_maps != nullptr) solved_maps->resize(0, 3);
  if (!solver_) {
    place(Columns(0, 3), {}, constraints, out, context);
    return;
  }
  const Known values = known_values(constraints);
  Rows rhs = right_hand_side(values, problem.field, context);
  add_targets(rhs);
  const Columns y = solve(rhs, {.corrections = residual_corrections_, .guess = &problem.guess}, context);
  place(y, values, constraints, out, context);
  if (solved_maps != nullptr) *solved_maps = maps(y, values, context);
  if (report == nullptr) return;
  // Columns of similarities have a gradient: what keeps them similar.
  const auto of_single_vertices = [&](const Rows& rows) {
    return apply_transposed(rows, context).topRows(shared_begin_).norm();
  };
  const double scale = of_single_vertices(rhs);
  report->residual = scale > 0 ? of_single_vertices(residual_rows(rhs, y, context)) / scale : 0.0;
  report->max_transform_deviation = max_transform_deviation(constraints, out);
  report->solver_iterations = solver_->statistics().iterations;
  report->inverted_maps = count_inverted(maps(y, values, context));
}

/// Free vertices whose local map turns inside out.
Index ConstrainedSystem::count_inverted(const Columns& maps) const {
  Index count = 0;
  for (Index v = 0; v < patch_.size(); ++v) {
    if (known_.transform[v]) continue;
    const Eigen::Matrix3d map = maps.middleRows<3>(3 * v) + Eigen::Matrix3d::Identity();
    count += map.determinant() <= 0;
  }
  return count;
}

double ConstrainedSystem::condition_estimate(const Context& context) const {
  return solver_ ? estimate_condition(normal_one_norm_, *solver_, context) : 1.0;
}

}  // namespace meshgraft
