#include "rotation_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Eigenvalues>

#include <meshgraft/mesh/normals.h>

#include "anderson_mixing.h"
#include "core/parallel.h"
#include "rotations.h"

namespace meshgraft {

namespace {

/// The rotation vector (3) and the logarithm of the stretch (6) of a transform.
using Logarithm = Eigen::Matrix<double, 1, 9>;

template <class Body>
void for_each_vertex(Index count, const Context& context, const Body& body) {
  parallel_blocks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) body(v);
      },
      context);
}

/// Flags the vertices where constraints or a feature's single map give the field.
Flags given_maps(const ConstraintMask& mask) {
  Flags given = mask.transform;
  for (Index v = 0; v < mask.size(); ++v) given[v] = !mask.is_fitted(v);
  return given;
}

}  // namespace

FieldSurface field_surface(const ConstrainedSystem& system) {
  return {system.patch().points, system.triangles(), system.rings(), system.intrinsic_edges(),
          system.bisection()};
}

/// Returns the bending matrix of the other field if it is the same. That of a whole patch without flipped edges
/// serves all parts of it.
std::shared_ptr<const BendingMatrix> RotationField::bending_matrix(const ConstrainedSystem& system,
                                                                   const RotationField* other,
                                                                   const Context& context) {
  if (other != nullptr && other->serves_parts_) return other->fields_.bending();
  return std::make_shared<const BendingMatrix>(field_surface(system), context);
}

RotationField::RotationField(const ConstrainedSystem& system, const DeformerOptions& options,
                             const RotationField* other, const Context& context)
    : system_(system),
      has_features_(!system.features().empty()),
      keeps_strain_(options.method == DeformMethod::shell),
      iterations_(is_corotational(options.method) ? options.iterations : 0),
      serves_parts_((other != nullptr && other->serves_parts_) ||
                    (!system.is_part() && !system.intrinsic_edges().differ)),
      fields_(
          field_surface(system), given_maps(system.mask()), bending_matrix(system, other, context),
          {.smoothing_length_rel = iterations_ > 0 ? std::optional(options.smoothing_length_rel) : std::nullopt,
           .backend = options.backend},
          context),
      groups_(system.rings(), given_maps(system.mask()), fields_, context),
      limbs_(field_surface(system), fields_, groups_, options.backend, context) {
  keep_few_groups(context);
  if (other != nullptr) {
    normals_ = other->normals_;
    return;
  }
  const Patch& patch = system.patch();
  const IndexLists faces_at = vertex_triangles(patch.size(), patch.triangles, context);
  normals_ = std::make_shared<const Points>(vertex_normals(patch.points, patch.triangles, faces_at, context));
}

/// Drops the weights of many groups, which take more memory than their gain of time is worth.
void RotationField::keep_few_groups(const Context& context) {
  constexpr Index most_groups = 6;
  if (groups_.count() > most_groups)
    groups_ = {};
  else if (!limbs_.empty())
    slopes_of_groups_ = limbs_.slopes(groups_.weights(), context);
}

RotationField::Result RotationField::find(std::span<const VertexConstraint> constraints, const Context& context,
                                          double settled, const Columns& start) const {
  Result result;
  if (system_.row_count() == 0) return result;  // all positions are given
  Blend blended;
  bool found = blend(constraints, {}, blended, context);
  if (found) {
    const Columns none = Columns::Zero(system_.patch().size(), 3);
    compose(blended, none, result.problem.field, context);
    if (has_features_) {  // their maps are unknown before a first solve
      Columns& y = result.problem.guess;
      y = system_.solve(system_.known_values(constraints), result.problem.field, {}, context);
      found = blend(constraints, system_.feature_maps(y), blended, context);
      if (found) compose(blended, none, result.problem.field, context);
    }
  }
  if (found && iterations_ > 0) found = local_steps(constraints, settled, start, blended, result, context);
  if (!found) {
    result = {};
    result.linear = true;
    result.problem.field = linear_field(constraints, context);
  } else {
    result.strain = std::move(blended.strain);
  }
  result.position_stretch = position_stretch(constraints);
  return result;
}

/// Blends the logarithms of the known transforms over the surface. Returns false if a transform has no
/// logarithm.
bool RotationField::blend(std::span<const VertexConstraint> constraints, const FeatureMaps& features,
                          Blend& blended, const Context& context) const {
  const Patch& patch = system_.patch();
  const Index n = patch.size();
  const ConstraintMask& mask = system_.mask();
  const IndexLists& rings = system_.rings();

  // Rotations are measured from rest if something stays at rest, or if they are given with full turns.
  // Otherwise a component moves as a whole. Then they are measured from the mean rotation, so that the pose
  // at rest does not matter.
  struct Given {
    Index vertex = -1;
    const VertexConstraint* constraint = nullptr;
    PolarParts parts;
  };
  std::vector<Given> given;
  Flags constrained(n, 0);
  bool from_rest = false;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const VertexConstraint& constraint : constraints) {
    const Index v = patch.local(constraint.vertex);
    if (v < 0 || rings[v].empty() || !constraint.transform) continue;
    given.push_back({v, &constraint, {}});
    if (!polar_decompose(*constraint.transform, given.back().parts)) return false;
    constrained[v] = 1;
    from_rest |= constraint.rotation.has_value();
    sum += fields_.areas()[v] * given.back().parts.rotation;
  }
  for (Index v = 0; v < n; ++v) from_rest |= mask.transform[v] && !constrained[v] && !rings[v].empty();
  const Eigen::Matrix3d reference = from_rest ? Eigen::Matrix3d::Identity() : nearest_rotation(sum);

  Columns logs = Columns::Zero(n, 9);
  for (std::size_t g = 0; g < given.size(); ++g) {
    const auto& [v, constraint, parts] = given[g];
    Eigen::Vector3d turn = rotation_log(parts.rotation * reference.transpose());
    if (constraint->rotation) {
      turn = nearest_turn(turn, constraint->rotation->angle() * constraint->rotation->axis());
    } else if (g > 0 && std::binary_search(rings[v].begin(), rings[v].end(), given[g - 1].vertex)) {
      turn = nearest_turn(turn, logs.block<1, 3>(given[g - 1].vertex, 0).transpose());  // along a curve
    }
    logs.row(v) << turn.transpose(), stretch_log(parts.stretch).transpose();
  }
  if (has_features_ && !impose_on_features(features, reference, logs, blended)) return false;
  // A component with given positions only starts from the affine map that fits them.
  const std::vector<Eigen::Matrix3d> fits = fitted_maps(constraints);
  std::vector<Logarithm> fit_logs;
  for (const Eigen::Matrix3d& fit : fits) {
    PolarParts parts;
    if (!polar_decompose(fit, parts)) return false;
    fit_logs.emplace_back();
    fit_logs.back() << rotation_log(parts.rotation * reference.transpose()).transpose(),
        stretch_log(parts.stretch).transpose();
  }
  for (Index v = 0; v < n; ++v)
    if (const Index c = fields_.component()[v]; c >= 0 && !fields_.constrained_components()[c])
      logs.row(v) = fit_logs[c];
  const std::optional<Columns> of_groups = groups_.common_values(logs);
  logs = of_groups ? groups_.spread(*of_groups, std::move(logs), context)
                   : fields_.spread(std::move(logs), context);
  Columns slopes;
  if (!limbs_.empty())
    slopes = of_groups ? Columns(slopes_of_groups_ * of_groups->leftCols<3>())
                       : limbs_.slopes(logs.leftCols<3>(), context);

  blended.rotation.resize(n);
  blended.stretch.resize(n);
  RestStrain& strain = blended.strain;
  if (keeps_strain_) strain.stretch.resize(n);
  if (keeps_strain_ && !limbs_.empty()) strain.turning.resize(n);
  for_each_vertex(n, context, [&](Index v) {
    const Logarithm log = logs.row(v);
    const Eigen::Vector3d turn = log.head<3>().transpose();
    blended.rotation[v] = rotation_exp(turn) * reference;
    blended.stretch[v] = stretch_exp(log.tail<6>().transpose());
    if (keeps_strain_) strain.stretch[v] = blended.stretch[v];
    if (limbs_.empty()) return;
    const LimbPoint at = limbs_.at(v);
    const Eigen::Vector3d slope = slopes.row(v).transpose();
    const TwistRate twist = twist_rate(at, turn, slope, reference, blended.stretch[v]);
    const Eigen::Matrix3d plain = blended.stretch[v];
    blended.stretch[v] += twist_shear(at, twist, plain) * at.moment * at.direction.transpose();
    if (!keeps_strain_) return;
    strain.turning[v] = wanted_turning(at, twist, turn, slope, reference, plain);
    strain.stretch[v] = plain + rod_strain(at, strain.turning[v], plain);
  });
  return true;
}

/// Writes the features' logarithms into `logs`, beside those of the constraints. Returns false if one does
/// not exist.
bool RotationField::impose_on_features(const FeatureMaps& maps, const Eigen::Matrix3d& reference, Columns& logs,
                                       Blend& blended) const {
  const std::vector<Index>& feature = system_.mask().feature;
  const std::size_t count = system_.features().size();
  std::vector<Logarithm> feature_logs(count, Logarithm::Zero());
  if (maps.empty()) {
    feature_logs = mean_logs_around_features(logs);
    blended.feature_turn.clear();
    for (const Logarithm& log : feature_logs) blended.feature_turn.emplace_back(log.head<3>().transpose());
  }
  for (std::size_t f = 0; f < maps.size(); ++f) {
    PolarParts parts;
    if (!polar_decompose(maps[f], parts)) return false;
    const Eigen::Vector3d turn = rotation_log(parts.rotation * reference.transpose());
    blended.feature_turn[f] = nearest_turn(turn, blended.feature_turn[f]);
    feature_logs[f] << blended.feature_turn[f].transpose(), stretch_log(parts.stretch).transpose();
  }
  for (Index v = 0; v < system_.patch().size(); ++v)
    if (feature[v] >= 0) logs.row(v) = feature_logs[feature[v]];
  return true;
}

/// Returns for each feature the mean of the given logarithms in the components of the patch that it touches.
std::vector<Logarithm> RotationField::mean_logs_around_features(const Columns& logs) const {
  const std::vector<Index>& feature = system_.mask().feature;
  const std::vector<Index>& component = fields_.component();
  std::vector<Logarithm> sums(fields_.constrained_components().size(), Logarithm::Zero());
  std::vector<double> areas(sums.size(), 0.0);
  std::set<std::pair<Index, Index>> touched;  // feature, component
  for (Index v = 0; v < system_.patch().size(); ++v) {
    if (component[v] < 0) continue;
    if (feature[v] >= 0) touched.emplace(feature[v], component[v]);
    if (!system_.mask().transform[v]) continue;
    sums[component[v]] += fields_.areas()[v] * logs.row(v);
    areas[component[v]] += fields_.areas()[v];
  }
  std::vector<Logarithm> means(system_.features().size(), Logarithm::Zero());
  std::vector<double> totals(means.size(), 0.0);
  for (const auto& [f, c] : touched) {
    means[f] += sums[c];
    totals[f] += areas[c];
  }
  for (std::size_t f = 0; f < means.size(); ++f)
    if (totals[f] > 0) means[f] /= totals[f];
  return means;
}

/// Returns the linear part of an affine map per component. Where no transform is given, the map fits the
/// given positions best. Elsewhere it is I.
std::vector<Eigen::Matrix3d> RotationField::fitted_maps(std::span<const VertexConstraint> constraints) const {
  const Patch& patch = system_.patch();
  const Flags& constrained = fields_.constrained_components();
  std::vector<std::vector<Eigen::Matrix<double, 1, 6>>> moves(
      constrained.size());  // rest position, displacement
  for (const VertexConstraint& constraint : constraints) {
    const Index v = patch.local(constraint.vertex);
    const Index component = v < 0 ? -1 : fields_.component()[v];
    if (component < 0 || constrained[component] || !constraint.position) continue;
    moves[component].emplace_back();
    moves[component].back() << patch.points.row(v),
        (constraint.position->transpose() - system_.rest().row(constraint.vertex)) / patch.scale;
  }
  std::vector<Eigen::Matrix3d> maps(constrained.size(), Eigen::Matrix3d::Identity());
  for (std::size_t c = 0; c < constrained.size(); ++c) {
    const auto count = static_cast<Eigen::Index>(moves[c].size());
    if (count < 4) continue;
    Eigen::MatrixXd points(count, 3), displacements(count, 3);
    for (Eigen::Index k = 0; k < count; ++k) {
      points.row(k) = moves[c][k].head<3>();
      displacements.row(k) = moves[c][k].tail<3>();
    }
    points.rowwise() -= points.colwise().mean().eval();
    displacements.rowwise() -= displacements.colwise().mean().eval();
    maps[c] += points.completeOrthogonalDecomposition().solve(displacements).transpose();
  }
  return maps;
}

/// Returns the largest ratio of two stretches of a fitted map.
double RotationField::position_stretch(std::span<const VertexConstraint> constraints) const {
  double largest = 1;
  for (const Eigen::Matrix3d& map : fitted_maps(constraints)) {
    const Eigen::Matrix3d squared = map.transpose() * map;
    const auto squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squared).eigenvalues();
    if (squares[0] > 0) largest = std::max(largest, std::sqrt(squares[2] / squares[0]));
  }
  return largest;
}

/// Returns the right-hand side of a linear blend. Edges with stiffness keep the linearly blended transforms.
MapField RotationField::linear_field(std::span<const VertexConstraint> constraints,
                                     const Context& context) const {
  const Index n = system_.patch().size();
  const Eigen::Matrix<double, 1, 9> identity = Eigen::Matrix3d::Identity().reshaped().transpose();
  Columns entries = Columns::Zero(n, 9);
  const std::vector<Eigen::Matrix3d> fits = fitted_maps(constraints);
  for (Index v = 0; v < n; ++v) {
    const Index c = fields_.component()[v];
    entries.row(v) = c < 0 ? identity : fits[c].reshaped().transpose();
  }
  for (const VertexConstraint& constraint : constraints)
    if (const Index v = system_.patch().local(constraint.vertex); v >= 0 && constraint.transform)
      entries.row(v) = constraint.transform->reshaped().transpose();
  entries = fields_.spread(std::move(entries), context);
  MapField field{Columns(3 * n, 3), false};
  for (Index v = 0; v < n; ++v) {
    const Eigen::Matrix3d map = entries.row(v).transpose().reshaped(3, 3);
    field.maps.middleRows<3>(3 * v) = (map - Eigen::Matrix3d::Identity()).transpose();
  }
  return field;
}

/// Writes the maps of a blend that deviates by the given rotation vectors.
void RotationField::compose(const Blend& blended, const Columns& deviation, MapField& field,
                            const Context& context) const {
  field.maps.resize(deviation.rows() * 3, 3);
  for_each_vertex(static_cast<Index>(blended.rotation.size()), context, [&](Index v) {
    const Eigen::Matrix3d map =
        rotation_exp(deviation.row(v).transpose()) * blended.rotation[v] * blended.stretch[v];
    field.maps.middleRows<3>(3 * v) = (map - Eigen::Matrix3d::Identity()).transpose();
  });
}

/// Performs fixed-point steps. Each step solves, takes the rotations of the surface's own maps as deviations
/// from the blend, and smooths the deviations. The first deviations are those of `start`. Anderson mixing
/// accelerates the steps, and keeps them from oscillating. Features' rotations go into the blend instead.
/// Returns false if a feature is inverted.
bool RotationField::local_steps(std::span<const VertexConstraint> constraints, double settled,
                                const Columns& start, Blend& blended, Result& result,
                                const Context& context) const {
  const ConstrainedSystem::KnownParts known = system_.known_parts(system_.known_values(constraints), context);
  Columns deviation = Columns::Zero(system_.patch().size(), 3);
  AndersonMixing mixing([&](const Columns& a, const Columns& b) { return mean_product(a, b, context); });
  ConstrainedSystem::SolveMemory memory;
  Columns maps, raw;
  double change = first_change;
  if (start.rows() > 0) {
    surface_deviation(start, blended, deviation, raw, context);
    deviation = fields_.smooth(raw, deviation, context, smooth_share * change_after_start);
    compose(blended, deviation, result.problem.field, context);
    change = change_after_start;
  }
  while (result.iterations < iterations_) {
    Columns& y = result.problem.guess;
    system_.solve(known, result.problem.field, solve_share * change, y, memory, context);
    double turn = 0;
    if (has_features_) {
      const std::vector<Eigen::Vector3d> before = blended.feature_turn;
      if (!blend(constraints, system_.feature_maps(y), blended, context)) return false;
      for (std::size_t f = 0; f < before.size(); ++f)
        turn = std::max(turn, (blended.feature_turn[f] - before[f]).norm());
    }
    system_.maps(y, known, maps, context);
    surface_deviation(maps, blended, deviation, raw, context);
    const Columns step = fields_.smooth(raw, deviation, context, smooth_share * change) - deviation;
    deviation = mixing.next(deviation, step);
    compose(blended, deviation, result.problem.field, context);
    result.change = std::max(std::sqrt(mean_product(step, step, context)), turn);
    change = std::min(first_change, result.change);
    ++result.iterations;
    context.step("rotations", static_cast<double>(result.iterations) / iterations_);
    if (result.change < settled) break;
  }
  return true;
}

/// Writes the rotation vectors that take the blended rotations to those of the maps, each near the current one.
void RotationField::surface_deviation(const Columns& maps, const Blend& blended, const Columns& current,
                                      Columns& deviation, const Context& context) const {
  const std::vector<Index>& apex = system_.operators()->nodes().apex;
  deviation.resize(current.rows(), 3);
  for_each_vertex(static_cast<Index>(current.rows()), context, [&](Index v) {
    const Eigen::Matrix3d map = maps.middleRows<3>(3 * v).transpose() + Eigen::Matrix3d::Identity();
    const Eigen::Vector3d normal = apex[v] < 0 ? Eigen::Vector3d(normals().row(v)) : Eigen::Vector3d::Zero();
    deviation.row(v) =
        surface_turn(map, {blended.rotation[v], blended.stretch[v]}, normal, current.row(v)).transpose();
  });
}

/// Returns the mean of a · b over the area around the fitted vertices. It is summed up in parts of fixed size,
/// so that rounding does not depend on the threads.
double RotationField::mean_product(const Columns& a, const Columns& b, const Context& context) const {
  constexpr Index part_size = 4096;
  struct Sums {
    double product = 0, area = 0;
  };
  const Index count = system_.patch().size();
  std::vector<Sums> sums((static_cast<std::size_t>(count) + part_size - 1) / part_size);
  parallel_blocks(
      sums.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part) {
          const Index first = static_cast<Index>(part) * part_size;
          for (Index v = first; v < std::min(count, first + part_size); ++v) {
            if (!system_.mask().is_fitted(v)) continue;
            sums[part].product += fields_.areas()[v] * a.row(v).dot(b.row(v));
            sums[part].area += fields_.areas()[v];
          }
        }
      },
      context, 1);
  Sums total;
  for (const Sums& of_part : sums) {
    total.product += of_part.product;
    total.area += of_part.area;
  }
  return total.area > 0 ? total.product / total.area : 0;
}

}  // namespace meshgraft
