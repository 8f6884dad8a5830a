#include "limb_twist.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "limb_faces.h"
#include "rotations.h"
#include "vertex_solver.h"

namespace meshgraft {

namespace {

/// Returns the share of the strain that is used where it shears the surface by a slope. It fades where lines
/// along a limb would grow by more than √5, and lines from the centre of a disc by more than √10, which is a
/// turn by 180° within five times the disc's radius. Discs that turn less than half as far need no strain: the
/// sheet around them draws in a little instead, which stretches it less.
double strain_share(bool is_on_disc, double slope) {
  constexpr double most_on_limbs = 2, most_on_discs = 3, sufficient_on_discs = 1;
  constexpr int steepness = 8;  // chosen: nothing folds from 90 to 180°, and turns by 60° are as without strain
  const double fading = 1 / std::sqrt(1 + std::pow(slope / (is_on_disc ? most_on_discs : most_on_limbs), 4));
  if (!is_on_disc) return fading;
  const double excess = std::pow(slope / sufficient_on_discs, steepness);
  return fading * excess / (1 + excess);
}

/// Returns for each component whether it has so few groups that it may have discs.
Flags components_with_discs(const SurfaceFields& fields, const std::vector<Index>& group) {
  std::vector<std::set<Index>> groups(fields.constrained_components().size());
  for (std::size_t v = 0; v < group.size(); ++v)
    if (group[v] >= 0) groups[fields.component()[v]].insert(group[v]);
  Flags few;
  for (const auto& set : groups) few.push_back(std::ssize(set) <= most_groups_around_discs);
  return few;
}

template <class Body>
void for_each(Eigen::Index count, const Context& context, const Body& body) {
  parallel_blocks(
      static_cast<std::size_t>(count),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) body(k);
      },
      context);
}

}  // namespace

/// The triangles, and t in each.
struct LimbTwist::Faces {
  const Triangles& triangles;
  IndexLists at;                      ///< per vertex: triangles
  std::vector<Eigen::Matrix3d> hats;  ///< gradients of the hat functions, in rows
  std::vector<double> areas;
  std::vector<Eigen::Vector3d> along;   ///< t √(certainty)
  std::vector<Eigen::Vector3d> across;  ///< the same, turned by 90° within the triangle

  Faces(const FieldSurface& surface, const SurfaceFields& fields, const Columns& weights,
        const Context& context);
};

/// Finds t: the direction in which the weights change most.
LimbTwist::Faces::Faces(const FieldSurface& surface, const SurfaceFields& fields, const Columns& weights,
                        const Context& context)
    : triangles(surface.triangles),
      at(vertex_triangles(surface.rings.size(), surface.triangles, context)),
      hats(static_cast<std::size_t>(triangles.rows())),
      areas(hats.size()),
      along(hats.size(), Eigen::Vector3d::Zero()),
      across(along) {
  std::vector<Eigen::Matrix3d> slopes(hats.size());
  for_each(triangles.rows(), context, [&](std::size_t t) {
    hats[t] = hat_gradients(surface.points, triangles, static_cast<Eigen::Index>(t), areas[t]);
    slopes[t] = slopes_of_weights(hats[t], weights, triangles.row(static_cast<Eigen::Index>(t)));
  });
  const auto component_of = [&](std::size_t t) {
    return fields.component()[triangles(static_cast<Eigen::Index>(t), 0)];
  };
  std::vector<double> steepest(fields.constrained_components().size(), 0.0);
  for (std::size_t t = 0; t < slopes.size(); ++t)
    if (const Index c = component_of(t); c >= 0) steepest[c] = std::max(steepest[c], slopes[t].trace());
  for_each(triangles.rows(), context, [&](std::size_t t) {
    const Index c = component_of(t);
    if (c >= 0) find_direction(slopes[t], steepest[c], hats[t], along[t], across[t]);
  });
}

LimbTwist::LimbTwist(const FieldSurface& surface, const SurfaceFields& fields, const GroupWeights& groups,
                     SolverBackend backend, const Context& context) {
  if (groups.count() < 2) return;  // all rotations are the same
  const Faces faces(surface, fields, groups.weights(), context);
  context.throw_if_stopped();
  find_axes(surface, fields, groups.group(), faces, backend, context);
  if (moments_.isZero(0)) {
    *this = {};
    return;
  }
  context.throw_if_stopped();
  find_derivatives(surface, groups.group(), faces, context);
}

/// Finds the centre line and the axis at each vertex as means along level lines of the weights. The mean of a
/// field is the solution of M f̄ + Λ K f̄ = M f, where K measures slopes across t only.
void LimbTwist::find_axes(const FieldSurface& surface, const SurfaceFields& fields,
                          const std::vector<Index>& group, const Faces& faces, SolverBackend backend,
                          const Context& context) {
  const std::vector<double>& areas = fields.areas();
  const std::vector<Index>& component = fields.component();
  std::vector<double> free_areas(fields.constrained_components().size(), 0.0);
  for (Index v = 0; v < surface.rings.size(); ++v) {
    if (surface.rings[v].empty()) continue;
    vertices_.push_back(v);
    free_areas[component[v]] += group[v] >= 0 ? 0 : areas[v];
  }
  SparseRows matrix = ring_matrix(surface.rings);
  Columns tensors = Columns::Zero(surface.points.rows(), 6);
  directions_ = Points::Zero(surface.points.rows(), 3);
  for_each(static_cast<Eigen::Index>(vertices_.size()), context, [&](std::size_t k) {
    const Index v = vertices_[k];
    matrix_entry(matrix, v, v) += areas[v];
    for (const Index t : faces.at[v]) {
      const Eigen::Vector3d& along = faces.along[t];
      const Eigen::Vector3d stiffness =
          stiffness_across(faces.hats[t] * faces.across[t], corner_of(faces.triangles, t, v),
                           free_areas[component[v]], faces.areas[t]);
      for (int j = 0; j < 3; ++j) matrix_entry(matrix, v, faces.triangles(t, j)) += stiffness[j];
      tensors.row(v) += faces.areas[t] / (3 * areas[v]) * to_tensor(along * along.transpose());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(to_matrix(tensors.row(v)));
    if (eigen.eigenvalues()[2] > 0.1) directions_.row(v) = eigen.eigenvectors().col(2).transpose();
  });
  // The system is far too uneven for conjugate gradients.
  if (backend == SolverBackend::iterative) backend = SolverBackend::automatic;
  try {
    means_ = factorise_vertices(
        select_rows(matrix, vertices_, context),
        {vertices_, &surface.rings, surface.bisection, surface.points(vertices_, Eigen::all)}, backend,
        context);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unsolvable) throw;
    moments_ = Points::Zero(surface.points.rows(), 3);  // needles beyond what numbers hold: no strain
    return;
  }
  Eigen::MatrixXd loads(static_cast<Eigen::Index>(vertices_.size()), 9);
  for_each(loads.rows(), context, [&](std::size_t k) {
    const Index v = vertices_[k];
    loads.row(static_cast<Eigen::Index>(k)) << areas[v] * surface.points.row(v), areas[v] * tensors.row(v);
  });
  const Eigen::MatrixXd means = means_->solve(loads, context);

  const Flags may_have_discs = components_with_discs(fields, group);
  const Points normals = vertex_normals(surface.points, surface.triangles, faces.at, context);
  axes_ = moments_ = rates_along_ = Points::Zero(surface.points.rows(), 3);
  for_each(means.rows(), context, [&](std::size_t k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Index v = vertices_[k];
    if (group[v] >= 0) return;
    LimbPoint limb =
        limb_at(surface.points.row(v), directions_.row(v), means.row(row), may_have_discs[component[v]] != 0);
    if (is_on_disc(limb) && limb.axis.dot(normals.row(v)) < 0) {  // the same sign all around
      limb.axis = -limb.axis;
      limb.moment = -limb.moment;
    }
    axes_.row(v) = limb.axis.transpose();
    moments_.row(v) = limb.moment.transpose();
    rates_along_.row(v) = limb.direction.transpose();
  });
}

/// Finds the triangles' derivatives along t, summed by area at the vertices without a given map.
void LimbTwist::find_derivatives(const FieldSurface& surface, const std::vector<Index>& group,
                                 const Faces& faces, const Context& context) {
  take_over(derivatives_, ring_matrix(surface.rings));
  Columns tensors = Columns::Zero(surface.points.rows(), 6);
  for_each(surface.points.rows(), context, [&](std::size_t row) {
    const auto v = static_cast<Index>(row);
    if (group[v] >= 0) return;
    const Eigen::Vector3d direction = directions_.row(v).transpose();
    for (const Index t : faces.at[v]) {
      tensors.row(v) += faces.areas[t] * to_tensor(direction * direction.transpose());
      const Eigen::Vector3d slopes = faces.areas[t] * faces.hats[t] * direction;
      for (int j = 0; j < 3; ++j) matrix_entry(derivatives_, v, faces.triangles(t, j)) += slopes[j];
    }
  });
  const Eigen::MatrixXd means = means_->solve(tensors(vertices_, Eigen::all), context);
  along_axis_ = Eigen::VectorXd::Zero(surface.points.rows());
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const Index v = vertices_[k];
    along_axis_[v] = along_direction(at(v), Tensor(means.row(static_cast<Eigen::Index>(k))));
  }
}

Columns LimbTwist::slopes(const Columns& fields, const Context& context) const {
  const auto count = static_cast<Eigen::Index>(vertices_.size());
  const Columns derivatives = multiply(derivatives_, fields, context);
  Columns averaged(count, 4 * fields.cols());
  for_each(count, context, [&](std::size_t k) {
    const Index v = vertices_[k];
    for (Eigen::Index f = 0; f < fields.cols(); ++f)
      averaged.block<1, 4>(static_cast<Eigen::Index>(k), 4 * f) =
          averaged_derivative(at(v), directions_.row(v), derivatives(v, f));
  });
  means_->solve_in_place(averaged, {}, context);
  Columns slopes = Columns::Zero(fields.rows(), fields.cols());
  for_each(count, context, [&](std::size_t k) {
    const Index v = vertices_[k];
    if (!(along_axis_[v] > 0)) return;
    for (Eigen::Index f = 0; f < fields.cols(); ++f)
      slopes(v, f) = along_direction(
                         at(v), Eigen::RowVector4d(averaged.block<1, 4>(static_cast<Eigen::Index>(k), 4 * f))) /
                     along_axis_[v];
  });
  return slopes;
}

TwistRate twist_rate(const LimbPoint& at, const Eigen::Vector3d& turn, const Eigen::Vector3d& slope,
                     const Eigen::Matrix3d& reference, const Eigen::Matrix3d& stretch) {
  const Eigen::Vector3d axis = (stretch * at.axis).stableNormalized();
  const Eigen::Vector3d turning = reference.transpose() * (right_jacobian(turn) * slope);
  const double all = turning.squaredNorm(), length = (stretch * at.direction).norm();
  if (!(all > 0) || !(length > 0)) return {};
  const double rate = axis.dot(turning), share = rate * rate / all;
  const double sheared = rate * (twist_shear(at, {axis, 1}, stretch) * at.moment).norm() / length;
  return {axis, share * share * rate * strain_share(is_on_disc(at), sheared)};
}

double twist_rate(const LimbPoint& at, double turning) {
  return turning * strain_share(is_on_disc(at), std::abs(turning) * at.moment.norm());
}

Eigen::Matrix3d twist_shear(const LimbPoint& at, const TwistRate& twist, const Eigen::Matrix3d& stretch) {
  // m × a is s r without its part along the axis.
  const Eigen::Matrix3d shear = -cross_matrix(twist.axis) * stretch * cross_matrix(at.axis);
  return twist.rate * shear;
}

Eigen::Matrix3d twist_shear(const LimbPoint& at, const Eigen::Vector3d& turn, const Eigen::Vector3d& slope,
                            const Eigen::Matrix3d& reference, const Eigen::Matrix3d& stretch) {
  return twist_shear(at, twist_rate(at, turn, slope, reference, stretch), stretch);
}

Eigen::Vector3d wanted_turning(const LimbPoint& at, const TwistRate& twist, const Eigen::Vector3d& turn,
                               const Eigen::Vector3d& slope, const Eigen::Matrix3d& reference,
                               const Eigen::Matrix3d& stretch) {
  constexpr double share_of_bend = 0.2;  // chosen on the tests of docs/methods.md
  const Eigen::Vector3d twisting = twist.rate * twist.axis;
  const double length = (stretch * at.direction).norm();
  if (is_on_disc(at) || !(length > 0)) return twisting;
  const Eigen::Vector3d turning = reference.transpose() * (right_jacobian(turn) * slope),
                        bending = turning - turning.dot(twist.axis) * twist.axis;
  const double sheared = rod_strain(at, bending, stretch).norm() / length;
  return twisting + share_of_bend * strain_share(false, sheared) * bending;
}

Eigen::Matrix3d rod_strain(const LimbPoint& at, const Eigen::Vector3d& turning,
                           const Eigen::Matrix3d& stretch) {
  const Eigen::Vector3d offset = stretch * at.moment.cross(at.axis);  // U r, without the part along the axis
  return turning.cross(offset) * at.direction.transpose();
}

}  // namespace meshgraft
