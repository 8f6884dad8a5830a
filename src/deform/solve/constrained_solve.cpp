// The right-hand sides, solutions and measures of a `ConstrainedSystem` that is set up.
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "constrained_system.h"
#include "core/parallel.h"
#include "deform/facts.h"
#include "linalg/sparse.h"
#include "linalg/sparse_products.h"
#include "operators/local_maps.h"
#include "rotations.h"

namespace meshgraft {

namespace {

// Position errors relative to the box are about ten times these tolerances (docs/performance.md).
constexpr double tolerance_with_corrections = 1e-8, tolerance_without_corrections = 1e-6;

/// Relative to y: a correction that is no larger leaves an error of at most this times that of a direct solve.
constexpr double small_change = 1e-3;

}  // namespace

ConstrainedSystem::Known ConstrainedSystem::known_values(std::span<const VertexConstraint> constraints) const {
  Known values{Columns::Zero(operators_->rows().nodes().positions.rows(), 3),
               Columns::Zero(3 * patch().size(), 3)};
  for (const VertexConstraint& constraint : constraints) {
    const Index v = patch().local(constraint.vertex);
    if (v < 0) continue;
    if (constraint.position)
      values.x.row(v) = (constraint.position->transpose() - rest().row(constraint.vertex)) / patch().scale;
    if (constraint.transform)
      values.m.middleRows<3>(3 * v) = (*constraint.transform - Eigen::Matrix3d::Identity()).transpose();
  }
  return values;
}

ConstrainedSystem::Known ConstrainedSystem::no_values(Eigen::Index columns) const {
  return {Columns::Zero(operators_->rows().nodes().positions.rows(), columns),
          Columns::Zero(3 * patch().size(), columns)};
}

Eigen::Index ConstrainedSystem::row_count() const { return solver_ ? A_L_.rows() + G_.rows() : 0; }

/// Returns the target of the maps' unknown part in the E_R rows: the field less the known part.
Columns ConstrainedSystem::wanted_maps(const Columns& known, const MapField& field,
                                       const Context& context) const {
  if (field.maps.rows() == 0 || !field.smooth) return -known;
  return fitted_field()(field.maps, context) - known;
}

/// Returns the part of the maps minus I that known values give.
Columns ConstrainedSystem::known_maps(const Known& values, const Context& context) const {
  return multiply(H(), values.x, context) + values.m;
}

/// Returns the part of b that is linear in values and field. Anchors pull toward rest in it.
ConstrainedSystem::Rows ConstrainedSystem::right_hand_side(const Known& values, const MapField& field,
                                                           const Context& context) const {
  const Columns m = known_maps(values, context);
  return {laplacian_rows(values, m, field, context), wanted_maps(m, field, context)};
}

/// Returns the rows of E_L, stiffness and anchors. `m` holds the maps that the known values give.
Columns ConstrainedSystem::laplacian_rows(const Known& values, const Columns& m, const MapField& field,
                                          const Context& context) const {
  const AffineOperator& op = operators_->rows();
  const Columns laplacian = multiply(op.delta(), m, context) - multiply(op.L(), values.x, context);
  const auto edge_row_count = static_cast<Eigen::Index>(edge_rows_.size());
  Columns rows(A_L_.rows(), m.cols());
  rows.topRows(laplacian.rows()) = laplacian;
  if (edge_row_count > 0) {
    auto edge_rows = rows.middleRows(laplacian.rows(), edge_row_count);
    edge_rows = -multiply(stiffness_rows_, values.x, context);
    if (field.maps.rows() > 0) add_stretch(field.maps, edge_rows, context);
  }
  for (std::size_t a = 0; a < anchors_.size(); ++a) {
    const Index v = patch().local(anchors_[a].vertex);
    const Eigen::RowVector3d back = patch().points.row(v) - op.nodes().positions.row(v);
    rows.row(laplacian.rows() + edge_row_count + static_cast<Eigen::Index>(a)) =
        -anchor_weights_[a] * (back * m.middleRows<3>(3 * v));
  }
  return rows;
}

void ConstrainedSystem::add_stretch(const Columns& maps, Eigen::Ref<Columns> edge_rows,
                                    const Context& context) const {
  const Points& points = operators_->rows().nodes().positions;
  parallel_blocks(
      edge_rows_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          const auto [i, j] = edge_rows_[b].ends;
          const Eigen::RowVector3d d = edge_rows_[b].weight * (points.row(i) - points.row(j));
          edge_rows.row(static_cast<Eigen::Index>(b)) +=
              d * ((maps.middleRows<3>(3 * i) + maps.middleRows<3>(3 * j)) / 2);
        }
      },
      context, 4096);
}

/// Adds the anchors' targets to the anchor rows, which are the last ones below E_L's.
void ConstrainedSystem::add_targets(Rows& rows) const {
  const auto first = rows.laplacian.rows() - static_cast<Eigen::Index>(anchors_.size());
  for (std::size_t a = 0; a < anchors_.size(); ++a) {
    if (!anchors_[a].target) continue;
    const Eigen::RowVector3d move = anchors_[a].target->transpose() - rest().row(anchors_[a].vertex);
    rows.laplacian.row(first + static_cast<Eigen::Index>(a)) += anchor_weights_[a] * (move / patch().scale);
  }
}

Columns ConstrainedSystem::apply_transposed(const Rows& rows, const Context& context) const {
  Columns side = multiply(A_L_transposed_, rows.laplacian, context), coupled;
  operators_->rows().couple(rows.maps, coupled, context);
  add_product(G_transposed_, coupled, side, context);
  return side;
}

ConstrainedSystem::Rows ConstrainedSystem::residual_rows(const Rows& rhs, const Columns& y,
                                                         const Context& context) const {
  return {rhs.laplacian - multiply(A_L_, y, context), rhs.maps - multiply(G_, y, context)};
}

/// Computes y = (AᵀA)⁻¹ Aᵀ b, then corrects y with the residual of the rectangular system. The solve and its
/// corrections together have to reach the tolerance, so an iterative solver gets a looser one for each. A guess
/// serves a direct solver in place of the solve if the first correction changes it little.
Columns ConstrainedSystem::solve(const Rows& rhs, const SolveSteps& steps, const Context& context) const {
  const double tolerance = steps.corrections > 0 ? tolerance_with_corrections : tolerance_without_corrections;
  SolveOptions options{.tolerance = std::pow(tolerance, 1.0 / (1 + steps.corrections))};
  const auto back_substitute = [&](Columns side) {
    solver_->solve_in_place(side, options, context);
    return side;
  };
  const auto correction = [&](const Columns& of) {
    return back_substitute(apply_transposed(residual_rows(rhs, of, context), context));
  };
  const bool is_guessed = steps.guess != nullptr && steps.guess->rows() == E_.cols();
  int corrections = steps.corrections;
  Columns y;
  if (is_guessed && !is_iterative()) {
    const Columns change = correction(*steps.guess);
    y = *steps.guess + change;
    if (change.norm() <= small_change * y.norm()) --corrections;
  } else {
    Eigen::MatrixXd guess;
    if (is_guessed) {
      guess = *steps.guess;
      options.guess = &guess;
    }
    y = back_substitute(apply_transposed(rhs, context));
    options.guess = nullptr;
  }
  for (; corrections > 0; --corrections) y += correction(y);
  impose_similarities(y);
  return y;
}

Columns ConstrainedSystem::solve(const Known& values, const MapField& field, const SolveSteps& steps,
                                 const Context& context) const {
  Rows rhs = right_hand_side(values, field, context);
  add_targets(rhs);
  return solve(rhs, steps, context);
}

ConstrainedSystem::KnownParts ConstrainedSystem::known_parts(const Known& values,
                                                             const Context& context) const {
  KnownParts known{known_maps(values, context), {}};
  Rows rows{laplacian_rows(values, known.maps, {}, context), -known.maps};
  add_targets(rows);
  known.side = apply_transposed(rows, context);
  return known;
}

void ConstrainedSystem::solve(const KnownParts& known, const MapField& field, double tolerance, Columns& y,
                              SolveMemory& memory, const Context& context) const {
  auto& [at_maps, coupled, laplacian] = memory;
  SolveOptions options{.tolerance = std::max(tolerance, tolerance_without_corrections)};
  Eigen::MatrixXd guess;
  if (y.rows() > 0 && is_iterative()) {
    guess = y;
    options.guess = &guess;
  }
  fitted_field()(field.maps, at_maps, context);
  operators_->rows().couple(at_maps, coupled, context);
  laplacian.setZero(A_L_.rows(), 3);
  const auto edge_row_count = static_cast<Eigen::Index>(edge_rows_.size());
  add_stretch(field.maps, laplacian.middleRows(operators_->rows().L().rows(), edge_row_count), context);
  y = known.side;
  add_product(A_L_transposed_, laplacian, y, context);
  add_product(G_transposed_, coupled, y, context);
  solver_->solve_in_place(y, options, context);
  impose_similarities(y);
}

Columns ConstrainedSystem::respond(const Known& values, const MapField& field, int corrections,
                                   const Context& context) const {
  return solve(right_hand_side(values, field, context), {.corrections = corrections}, context);
}

SparseRows ConstrainedSystem::coupling(const Context& context) const {
  return operators_->rows().coupling(context);
}

AlikeRows ConstrainedSystem::field_rows(const Context& context) const {
  SparseRows edge_rows_transposed(G_transposed_.rows(), 0);
  if (!edge_rows_.empty())
    take_over(edge_rows_transposed, transpose(multiply(stiffness_rows_, E_, context), context));
  const AlikeRows fitted = fitted_field().along_axes(context), stretch = minus_stretch();
  return alike_products({G_transposed_, coupling(context), fitted, edge_rows_transposed, stretch}, context);
}

/// Returns minus the targets of the stiffness rows in terms of a number φ per vertex, where F − I = φ e_axis
/// eᵀ, for each axis.
AlikeRows ConstrainedSystem::minus_stretch() const {
  const Points& points = operators_->rows().nodes().positions;
  AlikeRows axes;
  for (int axis = 0; axis < 3; ++axis) {
    SparseRows& rows = axes[axis];
    take_over(rows, rows_of_lengths(std::vector<int>(edge_rows_.size(), 2), patch().size()));
    for (std::size_t b = 0; b < edge_rows_.size(); ++b) {
      const auto [i, j] = edge_rows_[b].ends;
      const double half = edge_rows_[b].weight * (points(j, axis) - points(i, axis)) / 2;
      rows.innerIndexPtr()[2 * b] = std::min(i, j);
      rows.innerIndexPtr()[2 * b + 1] = std::max(i, j);
      rows.valuePtr()[2 * b] = rows.valuePtr()[2 * b + 1] = half;
    }
  }
  return axes;
}

void ConstrainedSystem::back_substitute(Columns& sides, const Context& context) const {
  context.throw_if_stopped();
  solver_->solve_in_place(sides, {}, context);
  context.throw_if_stopped();
}

bool ConstrainedSystem::is_iterative() const {
  return solver_->statistics().backend == SolverBackend::iterative;
}

SparseRows ConstrainedSystem::displacement_rows() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < free_.size(); ++k)
    for (SparseRows::InnerIterator it(E_, patch().local(free_[k])); it; ++it)
      entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()), it.value());
  const StencilNodes& nodes = operators_->rows().nodes();
  for (const Index v : nodes.moved) {  // the same correction as in `displacements`
    const Eigen::RowVector3d back = patch().points.row(v) - nodes.positions.row(v);
    const auto k = std::lower_bound(free_.begin(), free_.end(), patch().vertices[v]) - free_.begin();
    for (int axis = 0; axis < 3; ++axis)
      for (SparseRows::InnerIterator it(G_, 3 * v + axis); it; ++it)
        entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()), back[axis] * it.value());
  }
  SparseRows rows(static_cast<Eigen::Index>(free_.size()), E_.cols());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

Columns ConstrainedSystem::maps(const Columns& y, const Known& values, const Context& context) const {
  return multiply(G_, y, context) + known_maps(values, context);
}

void ConstrainedSystem::maps(const Columns& y, const KnownParts& known, Columns& maps,
                             const Context& context) const {
  maps = known.maps;
  add_product(G_, y, maps, context);
}

Columns ConstrainedSystem::displacements(const Columns& y, const Known& values, const Context& context) const {
  Columns x = multiply(E_, y, context) + values.x;
  const StencilNodes& nodes = operators_->rows().nodes();
  if (!nodes.moved.empty()) {
    // FT05 equation 8: x = M (p − p') + x' for vertices that were moved off their plane.
    const Columns m = maps(y, values, context);
    for (Index v : nodes.moved) {
      const Eigen::RowVector3d back = patch().points.row(v) - nodes.positions.row(v);
      x.row(v) += back * m.middleRows<3>(3 * v);
    }
  }
  x.conservativeResize(patch().size(), Eigen::NoChange);
  return x;
}

void ConstrainedSystem::place(const Columns& y, const Known& values,
                              std::span<const VertexConstraint> constraints, PointsRef out,
                              const Context& context) const {
  out = rest();
  if (y.rows() > 0) {
    const Columns x = displacements(y, values, context);
    place_features(y, out);
    for (Index v = 0; v < patch().size(); ++v) {
      if (mask_.position[v]) continue;
      const Index global = patch().vertices[v];
      out.row(global) = rest().row(global) + patch().scale * x.row(v);
      if (!out.row(global).allFinite()) throw Error(facts::deform::SolutionNotFinite{.vertex = global});
    }
  }
  for (const VertexConstraint& constraint : constraints)
    if (constraint.position) out.row(constraint.vertex) = constraint.position->transpose();
}

Columns ConstrainedSystem::feature_rows(std::size_t feature, const Columns& y) const {
  if (feature_column_[feature] < 0) return Columns::Zero(4, y.cols());
  return y.middleRows<4>(feature_column_[feature]);
}

/// Places all vertices of each feature that has columns in the system.
void ConstrainedSystem::place_features(const Columns& y, PointsRef out) const {
  for (std::size_t f = 0; f < features_.size(); ++f) {
    if (feature_column_[f] < 0) continue;
    const auto map = y.middleRows<4>(feature_column_[f]);  // (T − I)ᵀ over tᵀ
    for (const Index v : features_[f].vertices) {
      const Eigen::RowVector3d p = (rest().row(v) - patch().centre) / patch().scale;
      out.row(v) = rest().row(v) + patch().scale * (p * map.topRows<3>() + map.row(3));
    }
  }
}

double ConstrainedSystem::max_transform_deviation(std::span<const VertexConstraint> constraints,
                                                  const Points& positions) const {
  Points local(patch().size(), 3);
  for (Index v = 0; v < patch().size(); ++v)
    local.row(v) = (positions.row(patch().vertices[v]) - patch().centre) / patch().scale;
  std::vector<Eigen::Matrix3d> given(patch().size(), Eigen::Matrix3d::Identity());
  for (const VertexConstraint& constraint : constraints)
    if (const Index v = patch().local(constraint.vertex); v >= 0 && constraint.transform)
      given[v] = *constraint.transform;
  double largest = 0;
  const IndexLists& rings = this->rings();
  for (Index v = 0; v < patch().size(); ++v) {
    const bool beside_free =
        std::any_of(rings[v].begin(), rings[v].end(), [&](Index w) { return !mask_.position[w]; });
    if (!mask_.transform[v] || (!beside_free && mask_.position[v])) continue;
    const double deviation = local_map_deviation({v, rings[v], given[v]}, patch().points, local).norm();
    largest = std::max(largest, deviation);
  }
  return largest;
}

void ConstrainedSystem::evaluate(std::span<const VertexConstraint> constraints, const Problem& problem,
                                 PointsRef out, EvaluationReport* report, Columns* solved_maps,
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
  // The columns of similarities keep a gradient, which balances the similarity constraint. So the residual is
  // taken over the columns of single vertices only.
  const auto of_single_vertices = [&](const Rows& rows) {
    return apply_transposed(rows, context).topRows(shared_begin_).norm();
  };
  const double scale = of_single_vertices(rhs);
  report->residual = scale > 0 ? of_single_vertices(residual_rows(rhs, y, context)) / scale : 0.0;
  report->max_transform_deviation = max_transform_deviation(constraints, out);
  report->solver_iterations = solver_->statistics().iterations;
  report->inverted_maps = count_inverted(maps(y, values, context));
}

Index ConstrainedSystem::count_inverted(const Columns& maps) const {
  Index count = 0;
  for (Index v = 0; v < patch().size(); ++v) {
    if (mask_.transform[v]) continue;
    const Eigen::Matrix3d map = maps.middleRows<3>(3 * v) + Eigen::Matrix3d::Identity();
    count += map.determinant() <= 0;
  }
  return count;
}

/// Replaces each similarity's affine map by the similarity of least cost and updates the other unknowns. Let
/// K be the cost of a change of (T, t), and let t be optimal for T. The similarity then minimises
/// tr (sRᵀ − Tᵀ)ᵀ K̄ (sRᵀ − Tᵀ), a Procrustes problem. The result is exact for one feature. Several features
/// converge in the co-rotational iterations.
void ConstrainedSystem::impose_similarities(Columns& y) const {
  if (similarities_.empty() || y.isZero(0)) return;  // an edit that moves nothing gives exactly zero
  const Eigen::Index count = similarity_stiffness_.rows();
  Columns change(count, 3);
  for (std::size_t f = 0; f < similarities_.size(); ++f) {
    const auto first = static_cast<Eigen::Index>(4 * f);
    const Feature& feature = features_[similarities_[f]];
    const Eigen::Matrix4d K = similarity_stiffness_.block<4, 4>(first, first);
    const Eigen::Vector3d drift = K.block<3, 1>(0, 3) / K(3, 3);  // −driftᵀ · ΔTᵀ is the best change of tᵀ
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

}  // namespace meshgraft
