#include "limb_twist.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "rotations.h"
#include "vertex_solver.h"

namespace meshgraft {

namespace {

using Tensor = Eigen::Matrix<double, 1, 6>;

/// Slopes whose square is below this, × the steepest one's, have no certain direction.
constexpr double flattest = 1e-6;
/// Means along level lines reach over √(this) × √(free area), so that they go all around.
constexpr double reach_of_means = 1e4;

/// The strain fades where a twist would shear the surface by more: lines along the limb would grow by √5.
constexpr double most_shear = 2;

/// Returns 0 on a sheet and 1 on a limb, and a smooth ramp in between. `elongation` is 1 where t points the
/// same way all along a level line, as on a pipe, and 0 where it points in all directions of a plane.
double share_of_limb(double elongation) {
  const double x = std::clamp((elongation - 0.2) / 0.4, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

Tensor to_tensor(const Eigen::Matrix3d& m) { return {m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(2, 0), m(0, 1)}; }

Eigen::Matrix3d to_matrix(const Tensor& c) {
  Eigen::Matrix3d m;
  m << c[0], c[5], c[4], c[5], c[1], c[3], c[4], c[3], c[2];
  return m;
}

/// Returns the gradients of the hat functions of a triangle's corners in rows, or zero for a triangle that is
/// too thin to have any.
Eigen::Matrix3d hat_gradients(const Points& points, const Triangles& triangles, Eigen::Index t, double& area) {
  constexpr double thinnest = 1e-6;  // height, × the longest side
  Eigen::Vector3d side[3];
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    side[k] = (points.row(triangles(t, (k + 2) % 3)) - points.row(triangles(t, (k + 1) % 3))).transpose();
    longest = std::max(longest, side[k].squaredNorm());
  }
  const Eigen::Vector3d normal = side[0].cross(side[1]);
  const double twice = normal.norm();
  Eigen::Matrix3d gradients = Eigen::Matrix3d::Zero();
  area = 0;
  if (!(twice > thinnest * longest)) return gradients;
  area = twice / 2;
  for (int k = 0; k < 3; ++k) gradients.row(k) = normal.cross(side[k]).transpose() / (twice * twice);
  return gradients;
}

/// Returns one column of ones and zeros for each connected group of flagged vertices. Beyond a fixed number of
/// columns, groups share them with either sign, so that neighbours still differ.
Columns group_indicators(const IndexLists& rings, std::span<const std::uint8_t> given) {
  constexpr Index most_columns = 16;
  std::vector<Index> group(rings.size(), -1), queue;
  Index count = 0;
  for (Index start = 0; start < rings.size(); ++start) {
    if (!given[start] || group[start] >= 0 || rings[start].empty()) continue;
    group[start] = count;
    queue.assign(1, start);
    while (!queue.empty()) {
      const Index v = queue.back();
      queue.pop_back();
      for (const Index w : rings[v])
        if (given[w] && group[w] < 0) {
          group[w] = count;
          queue.push_back(w);
        }
    }
    ++count;
  }
  Columns indicators = Columns::Zero(rings.size(), std::min(count, most_columns));
  for (Index v = 0; v < rings.size(); ++v) {
    if (group[v] < 0) continue;
    for (Index column = 0; column < indicators.cols(); ++column) {
      if (count <= most_columns) {
        indicators(v, column) = group[v] == column ? 1 : 0;
      } else {
        std::uint64_t bits = (static_cast<std::uint64_t>(group[v]) << 8U) + static_cast<std::uint64_t>(column);
        bits = (bits ^ (bits >> 31U)) * 0x9E3779B97F4A7C15U;  // Fibonacci hashing
        indicators(v, column) = (bits >> 63U) == 0 ? 1 : -1;
      }
    }
  }
  return indicators;
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

/// Returns a matrix of zeros with an entry for each vertex and for each edge, in both directions.
SparseRows ring_matrix(const IndexLists& rings) {
  std::vector<int> lengths;
  for (Index v = 0; v < rings.size(); ++v) lengths.push_back(1 + static_cast<int>(rings[v].size()));
  SparseRows matrix = rows_of_lengths(lengths, rings.size());
  for (Index v = 0; v < rings.size(); ++v) {
    int* const columns = matrix.innerIndexPtr() + matrix.outerIndexPtr()[v];
    std::copy(rings[v].begin(), rings[v].end(), columns);
    columns[rings[v].size()] = v;
    std::sort(columns, columns + lengths[v]);
  }
  std::fill_n(matrix.valuePtr(), matrix.nonZeros(), 0.0);
  return matrix;
}

double& entry(SparseRows& matrix, Index row, Index column) {
  const int* const begin = matrix.innerIndexPtr() + matrix.outerIndexPtr()[row];
  const int* const end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[row + 1];
  return matrix.valuePtr()[std::lower_bound(begin, end, column) - matrix.innerIndexPtr()];
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
  int corner(Index t, Index v) const { return triangles(t, 0) == v ? 0 : triangles(t, 1) == v ? 1 : 2; }
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
    Eigen::Matrix<double, 3, Eigen::Dynamic> corners(3, weights.cols());
    for (int k = 0; k < 3; ++k) corners.row(k) = weights.row(triangles(static_cast<Eigen::Index>(t), k));
    const Eigen::Matrix<double, 3, Eigen::Dynamic> gradients = hats[t].transpose() * corners;
    slopes[t] = gradients * gradients.transpose();
  });
  const auto component_of = [&](std::size_t t) {
    return fields.component()[triangles(static_cast<Eigen::Index>(t), 0)];
  };
  std::vector<double> steepest(fields.constrained_components().size(), 0.0);
  for (std::size_t t = 0; t < slopes.size(); ++t)
    if (const Index c = component_of(t); c >= 0) steepest[c] = std::max(steepest[c], slopes[t].trace());
  for_each(triangles.rows(), context, [&](std::size_t t) {
    const Index c = component_of(t);
    if (c < 0 || !(steepest[c] > 0)) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(slopes[t]);
    const double first = eigen.eigenvalues()[2], second = std::max(0.0, eigen.eigenvalues()[1]);
    const double certainty = std::max(0.0, first - second) / (first + second + flattest * steepest[c]);
    along[t] = std::sqrt(certainty) * eigen.eigenvectors().col(2);
    const Eigen::Vector3d normal = hats[t].row(0).cross(hats[t].row(1)).transpose();
    across[t] = normal.stableNormalized().cross(along[t]);
  });
}

LimbTwist::LimbTwist(const FieldSurface& surface, const SurfaceFields& fields,
                     std::span<const std::uint8_t> given, SolverBackend backend, const Context& context) {
  const Columns indicators = group_indicators(surface.rings, given);
  if (indicators.cols() < 2) return;  // all rotations are the same
  const Faces faces(surface, fields, fields.spread(indicators, context), context);
  context.throw_if_stopped();
  find_axes(surface, fields, given, faces, backend, context);
  if (moments_.isZero(0)) {
    *this = {};
    return;
  }
  context.throw_if_stopped();
  find_derivatives(surface, given, faces, context);
}

/// Finds the centre line and the axis at each vertex as means along level lines of the weights. The mean of a
/// field is the solution of M f̄ + Λ K f̄ = M f, where K measures slopes across t only.
void LimbTwist::find_axes(const FieldSurface& surface, const SurfaceFields& fields,
                          std::span<const std::uint8_t> given, const Faces& faces, SolverBackend backend,
                          const Context& context) {
  const std::vector<double>& areas = fields.areas();
  const std::vector<Index>& component = fields.component();
  std::vector<double> free_areas(fields.constrained_components().size(), 0.0);
  for (Index v = 0; v < surface.rings.size(); ++v) {
    if (surface.rings[v].empty()) continue;
    vertices_.push_back(v);
    free_areas[component[v]] += given[v] ? 0 : areas[v];
  }
  SparseRows matrix = ring_matrix(surface.rings);
  Columns tensors = Columns::Zero(surface.points.rows(), 6);
  directions_ = Points::Zero(surface.points.rows(), 3);
  for_each(static_cast<Eigen::Index>(vertices_.size()), context, [&](std::size_t k) {
    const Index v = vertices_[k];
    entry(matrix, v, v) += areas[v];
    for (const Index t : faces.at[v]) {
      // Slopes across t, as much as t is certain.
      const Eigen::Vector3d slopes = faces.hats[t] * faces.across[t], &along = faces.along[t];
      const Eigen::Vector3d stiffness =
          reach_of_means * free_areas[component[v]] * faces.areas[t] * slopes[faces.corner(t, v)] * slopes;
      for (int j = 0; j < 3; ++j) entry(matrix, v, faces.triangles(t, j)) += stiffness[j];
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

  axes_ = moments_ = Points::Zero(surface.points.rows(), 3);
  for_each(means.rows(), context, [&](std::size_t k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Index v = vertices_[k];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(to_matrix(means.row(row).tail<6>()));
    const double first = eigen.eigenvalues()[2], second = std::max(0.0, eigen.eigenvalues()[1]);
    const double share = first > 1e-3 ? share_of_limb((first - second) / (first + second)) : 0;
    if (given[v] || share == 0) return;
    const Eigen::RowVector3d axis = eigen.eigenvectors().col(2).transpose();
    const Eigen::RowVector3d offset = surface.points.row(v) - means.row(row).head<3>();
    axes_.row(v) = axis;
    moments_.row(v) = share * axis.cross(offset);
  });
}

/// Finds the triangles' derivatives along t, summed by area at the vertices without a given map.
void LimbTwist::find_derivatives(const FieldSurface& surface, std::span<const std::uint8_t> given,
                                 const Faces& faces, const Context& context) {
  take_over(derivatives_, ring_matrix(surface.rings));
  Columns tensors = Columns::Zero(surface.points.rows(), 6);
  for_each(surface.points.rows(), context, [&](std::size_t row) {
    const auto v = static_cast<Index>(row);
    if (given[v]) return;
    const Eigen::Vector3d direction = directions_.row(v).transpose();
    for (const Index t : faces.at[v]) {
      tensors.row(v) += faces.areas[t] * to_tensor(direction * direction.transpose());
      const Eigen::Vector3d slopes = faces.areas[t] * faces.hats[t] * direction;
      for (int j = 0; j < 3; ++j) entry(derivatives_, v, faces.triangles(t, j)) += slopes[j];
    }
  });
  const Eigen::MatrixXd means = means_->solve(tensors(vertices_, Eigen::all), context);
  along_axis_ = Eigen::VectorXd::Zero(surface.points.rows());
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const Eigen::Vector3d axis = axes_.row(vertices_[k]).transpose();
    along_axis_[vertices_[k]] = axis.dot(to_matrix(means.row(static_cast<Eigen::Index>(k))) * axis);
  }
}

Columns LimbTwist::slopes(const Columns& fields, const Context& context) const {
  const auto count = static_cast<Eigen::Index>(vertices_.size());
  const Columns derivatives = multiply(derivatives_, fields, context);
  Eigen::MatrixXd gradients(count, 3 * fields.cols());  // averaged, because the sign of t is arbitrary
  for_each(count, context, [&](std::size_t k) {
    const Index v = vertices_[k];
    for (Eigen::Index f = 0; f < fields.cols(); ++f)
      gradients.block<1, 3>(static_cast<Eigen::Index>(k), 3 * f) = derivatives(v, f) * directions_.row(v);
  });
  const Eigen::MatrixXd means = means_->solve(gradients, context);
  Columns slopes = Columns::Zero(fields.rows(), fields.cols());
  for_each(count, context, [&](std::size_t k) {
    const Index v = vertices_[k];
    if (!(along_axis_[v] > 0)) return;
    for (Eigen::Index f = 0; f < fields.cols(); ++f)
      slopes(v, f) = means.block<1, 3>(static_cast<Eigen::Index>(k), 3 * f).dot(axes_.row(v)) / along_axis_[v];
  });
  return slopes;
}

Eigen::Matrix3d twist_shear(const LimbPoint& at, const Eigen::Vector3d& turn, const Eigen::Vector3d& slope,
                            const Eigen::Matrix3d& reference, const Eigen::Matrix3d& stretch) {
  const Eigen::Vector3d axis = (stretch * at.axis).stableNormalized();
  const Eigen::Vector3d turning = reference.transpose() * (right_jacobian(turn) * slope);
  const double all = turning.squaredNorm(), length = (stretch * at.axis).norm();
  if (!(all > 0) || !(length > 0)) return Eigen::Matrix3d::Zero();
  // m × a is s r without its part along the axis.
  const Eigen::Matrix3d shear = -cross_matrix(axis) * stretch * cross_matrix(at.axis);
  const double rate = axis.dot(turning), share = rate * rate / all;
  const double sheared = rate * (shear * at.moment).norm() / length / most_shear, square = sheared * sheared;
  return share * share * rate / std::sqrt(1 + square * square) * shear;
}

}  // namespace meshgraft
