#include "pose_source.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>

#include "core/facts.h"
#include "merge/facts.h"
#include "mesh/winding.h"

namespace meshgraft {

namespace {

void transform_normals(Attribute& normals, const Eigen::Matrix3d& linear) {
  const Eigen::Matrix3d cofactors = linear.determinant() * linear.inverse().transpose();
  for (std::size_t k = 0; k + 2 < normals.values.size(); k += 3) {
    Eigen::Map<Eigen::Vector3d> normal(&normals.values[k]);
    const double length = normal.norm();
    if (!(length > 0)) continue;  // no normal is stored
    normal = (cofactors * normal).normalized() * length;
  }
}

Points gathered(const Mesh& mesh, std::span<const Match> pairs, Index Match::* side) {
  Points points(static_cast<Eigen::Index>(pairs.size()), 3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Index v = pairs[i].*side;
    if (v < 0 || v >= mesh.vertex_count())
      throw Error(facts::merge::NoSuchVertex{.side = side == &Match::source ? facts::merge::Side::source
                                                                            : facts::merge::Side::target,
                                             .vertex = v,
                                             .count = mesh.vertex_count()},
                  Location("pairs")[i]);
    points.row(static_cast<Eigen::Index>(i)) = mesh.positions.row(v);
  }
  return points;
}

// Returns whether points (nearly) lie on a line, so that the rotation about the line is undetermined.
bool on_a_line(const Points& points) {
  const Points centred = points.rowwise() - points.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(centred.transpose() * centred,
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& extent = spread.eigenvalues();  // ascending
  return !(extent(1) > 1e-12 * extent(2));
}

}  // namespace

Mesh transformed(const Mesh& mesh, const Eigen::Affine3d& map, const Location& location) {
  const Eigen::Matrix3d linear = map.linear();
  const double determinant = linear.determinant();
  if (!(std::abs(determinant) > 1e-12 * std::pow(linear.norm(), 3)))
    throw Error(facts::merge::TransformFlattens{}, location);
  Mesh moved = mesh;
  moved.positions = ((mesh.positions * linear.transpose()).rowwise() + map.translation().transpose()).eval();
  for (Attribute& attribute : moved.attributes)
    if ((attribute.name == "normal" || attribute.name == cut_normal_name) && attribute.components == 3)
      transform_normals(attribute, linear);
  return determinant < 0 ? turned_over(moved) : moved;
}

Eigen::Affine3d reflection(const Plane& plane, const Location& location) {
  const double length = plane.normal.norm();
  if (!(length > 0)) throw Error(facts::core::NormalWithoutLength{}, location);
  const Eigen::Vector3d n = plane.normal / length;
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() -= 2 * n * n.transpose();
  map.translation() = 2 * n.dot(plane.point) * n;
  return map;
}

Eigen::Affine3d align_source(const Mesh& source, const Mesh& target, std::span<const Match> pairs) {
  if (pairs.size() < fewest_aligned_pairs)
    throw Error(facts::merge::TooFewPairs{.count = pairs.size()}, "pairs");
  const Points from = gathered(source, pairs, &Match::source);
  const Points to = gathered(target, pairs, &Match::target);
  for (const Points* side : {&from, &to})
    if (on_a_line(*side))
      throw Error(facts::merge::VerticesOnALine{.side = side == &from ? facts::merge::Side::source
                                                                      : facts::merge::Side::target},
                  "pairs");
  return Eigen::Affine3d(Eigen::umeyama(from.transpose(), to.transpose(), true));
}

}  // namespace meshgraft
