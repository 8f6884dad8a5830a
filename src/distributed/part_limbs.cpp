#include "part_limbs.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "components.h"
#include "deform/solve/limb_faces.h"

namespace meshgraft::distributed {

/// The triangles of the part, and t in each, as in `LimbTwist`.
struct PartLimbs::Faces {
  std::vector<Eigen::Matrix3d> hats;
  std::vector<double> areas;
  std::vector<Eigen::Vector3d> along, across;

  Faces(const Communicator& comm, const Part& part, const PartFields& fields, const Columns& weights);
};

PartLimbs::Faces::Faces(const Communicator& comm, const Part& part, const PartFields& fields,
                        const Columns& weights)
    : hats(static_cast<std::size_t>(part.mesh.triangles.rows())),
      areas(hats.size()),
      along(hats.size(), Eigen::Vector3d::Zero()),
      across(along) {
  std::vector<Eigen::Matrix3d> slopes(hats.size());
  const auto component_of = [&](std::size_t t) {
    return fields.component()[part.mesh.triangles(static_cast<Eigen::Index>(t), 0)];
  };
  LabelValues own;
  for (std::size_t t = 0; t < hats.size(); ++t) {
    hats[t] = hat_gradients(part.points, part.mesh.triangles, static_cast<Eigen::Index>(t), areas[t]);
    slopes[t] = slopes_of_weights(hats[t], weights, part.mesh.triangles.row(static_cast<Eigen::Index>(t)));
    Eigen::VectorXd& steepest = own.try_emplace(component_of(t), Eigen::VectorXd::Zero(1)).first->second;
    if (part.mesh.owns_triangle(static_cast<Index>(t))) steepest[0] = std::max(steepest[0], slopes[t].trace());
  }
  const LabelValues steepest = largest_by_label(comm, own);
  for (std::size_t t = 0; t < hats.size(); ++t)
    find_direction(slopes[t], steepest.at(component_of(t))[0], hats[t], along[t], across[t]);
}

PartLimbs::PartLimbs(const Communicator& comm, const Part& part, const PartFields& fields, const Flags& given,
                     double tolerance)
    : comm_(comm), part_(part), tolerance_(tolerance) {
  const Columns indicators = group_indicators(given);
  if (indicators.cols() < 2) return;  // all rotations are the same
  const Faces faces(comm, part, fields, fields.spread(indicators));
  find_axes(fields, given, indicators, faces);
  if (!comm.any(!moments_.isZero(0))) {
    means_.reset();
    return;
  }
  find_derivatives(given, faces);
}

/// Numbers the connected groups of given vertices in the order of their smallest vertices.
Columns PartLimbs::group_indicators(const Flags& given) const {
  const Index count = part_.mesh.vertices.size(), own = part_.mesh.vertices.own();
  Flags flagged(count);
  for (Index v = 0; v < count; ++v) flagged[v] = given[v] && !part_.mesh.rings[v].empty();
  const std::vector<Number> labels = find_components(
      comm_, part_.mesh, flagged, std::vector<Number>(part_.original.begin(), part_.original.end()));
  std::vector<Number> first;
  for (Index v = 0; v < own; ++v)
    if (labels[v] == part_.original[v]) first.push_back(labels[v]);
  std::vector<Number> all;
  for (const auto& list : comm_.exchange(ByRank<Number>(comm_.size(), first)))
    all.insert(all.end(), list.begin(), list.end());
  std::sort(all.begin(), all.end());
  std::vector<Index> group(count, -1);
  for (Index v = 0; v < count; ++v)
    if (labels[v] >= 0)
      group[v] = static_cast<Index>(std::lower_bound(all.begin(), all.end(), labels[v]) - all.begin());
  return indicators_of_groups(group, static_cast<Index>(all.size()));
}

void PartLimbs::find_axes(const PartFields& fields, const Flags& given, const Columns& indicators,
                          const Faces& faces) {
  const Index count = part_.mesh.vertices.size(), own = part_.mesh.vertices.own();
  const auto& [points, triangles] = std::tie(part_.points, part_.mesh.triangles);
  SparseRows matrix = ring_matrix(part_.mesh.rings);
  Columns tensors = Columns::Zero(own, 6);
  directions_ = Points::Zero(count, 3);
  Flags unknown(count);
  for (Index v = 0; v < count; ++v) unknown[v] = !part_.mesh.rings[v].empty();
  for (Index v = 0; v < own; ++v) {
    if (!unknown[v]) continue;
    const double area = fields.areas()[v];
    matrix_entry(matrix, v, v) += area;
    for (const Index t : part_.mesh.faces_at[v]) {
      const Eigen::Vector3d stiffness =
          stiffness_across(faces.hats[t] * faces.across[t], corner_of(triangles, t, v),
                           fields.free_area(fields.component()[v]), faces.areas[t]);
      for (int j = 0; j < 3; ++j) matrix_entry(matrix, v, triangles(t, j)) += stiffness[j];
      tensors.row(v) += faces.areas[t] / (3 * area) * to_tensor(faces.along[t] * faces.along[t].transpose());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(to_matrix(tensors.row(v)));
    if (eigen.eigenvalues()[2] > 0.1) directions_.row(v) = eigen.eigenvectors().col(2).transpose();
  }
  part_.mesh.vertices.update(directions_);
  // The system is far too uneven for conjugate gradients without a factor.
  means_.emplace(
      comm_, part_, SparseRows(matrix.topRows(own)), unknown,
      ParallelSolverOptions{.preconditioner = Preconditioner::mumps, .prefix = "limb_", .direct = true});
  Columns loads(own, 9);
  for (Index v = 0; v < own; ++v)
    loads.row(v) << fields.areas()[v] * points.row(v), fields.areas()[v] * tensors.row(v);
  const Columns means = means_->solve(loads, tolerance_);
  LabelValues of_own;  // of each component: 1 for each group that it has
  for (Index v = 0; v < own; ++v)
    if (unknown[v]) {
      Eigen::VectorXd& groups =
          of_own.try_emplace(fields.component()[v], Eigen::VectorXd::Zero(indicators.cols())).first->second;
      groups = groups.cwiseMax(indicators.row(v).transpose().cwiseAbs());
    }
  const LabelValues groups = largest_by_label(comm_, of_own);
  axes_ = moments_ = rates_along_ = Points::Zero(count, 3);
  for (Index v = 0; v < own; ++v) {
    if (!unknown[v] || given[v]) continue;
    const auto limb =
        limb_at(points.row(v), directions_.row(v), means.row(v),
                (groups.at(fields.component()[v]).array() > 0).count() <= most_groups_around_discs);
    axes_.row(v) = limb.axis.transpose();
    moments_.row(v) = limb.moment.transpose();
    rates_along_.row(v) = limb.direction.transpose();
  }
  part_.mesh.vertices.update(axes_);
  part_.mesh.vertices.update(moments_);
  part_.mesh.vertices.update(rates_along_);
}

void PartLimbs::find_derivatives(const Flags& given, const Faces& faces) {
  const Index own = part_.mesh.vertices.own();
  SparseRows derivatives = ring_matrix(part_.mesh.rings);
  Columns tensors = Columns::Zero(own, 6);
  for (Index v = 0; v < own; ++v) {
    if (given[v]) continue;
    const Eigen::Vector3d direction = directions_.row(v).transpose();
    for (const Index t : part_.mesh.faces_at[v]) {
      tensors.row(v) += faces.areas[t] * to_tensor(direction * direction.transpose());
      const Eigen::Vector3d slopes = faces.areas[t] * faces.hats[t] * direction;
      for (int j = 0; j < 3; ++j) matrix_entry(derivatives, v, part_.mesh.triangles(t, j)) += slopes[j];
    }
  }
  take_over(derivatives_, SparseRows(derivatives.topRows(own)));
  const Columns means = means_->solve(tensors, tolerance_);
  along_axis_ = Eigen::VectorXd::Zero(own);
  for (Index v = 0; v < own; ++v) {
    along_axis_[v] = along_direction(at(v), Tensor(means.row(v)));
  }
}

Columns PartLimbs::slopes(const Columns& fields) const {
  const Index own = part_.mesh.vertices.own();
  const Columns derivatives = multiply(derivatives_, fields, {.threads = 1});
  Columns averaged(own, 4 * fields.cols());
  for (Index v = 0; v < own; ++v)
    for (Eigen::Index f = 0; f < fields.cols(); ++f)
      averaged.block<1, 4>(v, 4 * f) = averaged_derivative(at(v), directions_.row(v), derivatives(v, f));
  const Columns means = means_->solve(averaged, tolerance_);
  Columns slopes = Columns::Zero(fields.rows(), fields.cols());
  for (Index v = 0; v < own; ++v) {
    if (!(along_axis_[v] > 0)) continue;
    for (Eigen::Index f = 0; f < fields.cols(); ++f)
      slopes(v, f) = along_direction(at(v), Eigen::RowVector4d(means.block<1, 4>(v, 4 * f))) / along_axis_[v];
  }
  part_.mesh.vertices.update(slopes);
  return slopes;
}

}  // namespace meshgraft::distributed
