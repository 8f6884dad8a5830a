#include "support/scene_edits.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <Eigen/QR>

namespace meshgraft::test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Handle make_handle(std::string name, std::vector<Index> vertices) {
  Handle handle;
  handle.name = std::move(name);
  handle.vertices = std::move(vertices);
  return handle;
}

Region two_handles(const Scene& scene) {
  Region region;
  region.whole = true;
  region.handles = {make_handle("foot", scene.foot), make_handle("head", scene.head)};
  return region;
}

Region held_foot(const Scene& scene) {
  Region region;
  region.whole = true;
  region.fixed = scene.foot;
  region.handles = {make_handle("head", scene.head)};
  return region;
}

HandlePose pose_of(const Eigen::Affine3d& map) {
  HandlePose pose;
  pose.transform = map;
  return pose;
}

Eigen::Affine3d about_middle(const TestMesh& mesh, const Matrix3d& linear) {
  const Eigen::RowVector3d first = mesh.positions.row(mesh.triangles(0, 0));
  Eigen::RowVector3d low = first, high = first;
  for (Index v : mesh.triangles.reshaped()) {
    low = low.cwiseMin(mesh.positions.row(v));
    high = high.cwiseMax(mesh.positions.row(v));
  }
  const Vector3d middle = (low + (high - low) / 2).transpose();
  Eigen::Affine3d map;
  map.linear() = linear;
  map.translation() = middle - linear * middle + mesh.box_diagonal() * Vector3d(0.3, -0.2, 0.1);
  return map;
}

std::vector<std::pair<std::string, Matrix3d>> linear_maps() {
  Matrix3d shear, mirror = Matrix3d::Identity();
  shear << 1.3, 0.25, -0.1, -0.15, 0.8, 0.3, 0.1, 0.05, 1.1;
  mirror(1, 1) = -1;
  return {{"shear", shear},
          {"unequal scales", Vector3d(0.4, 1.7, 1.1).asDiagonal()},
          {"reflection", mirror},
          {"turn", Eigen::AngleAxisd(2.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix()}};
}

Eigen::Affine3d head_move(const Scene& scene) {
  const Vector3d pivot = scene.mesh.positions.row(scene.head.front());
  return Eigen::Translation3d(pivot + scene.mesh.box_diagonal() * Vector3d(0.1, 0.05, 0.15)) *
         Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()) * Eigen::Scaling(1.2) *
         Eigen::Translation3d(-pivot);
}

Points image(const Points& points, const Eigen::Affine3d& map) {
  Points result(points.rows(), 3);
  // Uses extended precision, so that the expected positions add no rounding of their own.
  const Eigen::Matrix<long double, 3, 3> linear = map.linear().cast<long double>();
  const Eigen::Matrix<long double, 3, 1> shift = map.translation().cast<long double>();
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    result.row(i) = (linear * points.row(i).transpose().cast<long double>() + shift).cast<double>().transpose();
  return result;
}

double largest_distance(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

double eight_ulp(const Points& points) {
  const double largest = points.cwiseAbs().maxCoeff();
  return 8 * (std::nextafter(largest, std::numeric_limits<double>::infinity()) - largest);
}

AffineFit fit_affine(const Points& rest, const Points& moved, const std::vector<Index>& vertices) {
  const auto count = static_cast<Eigen::Index>(vertices.size());
  Eigen::MatrixXd from(count, 4), to(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    from.row(k) << rest.row(vertices[static_cast<std::size_t>(k)]), 1.0;
    to.row(k) = moved.row(vertices[static_cast<std::size_t>(k)]);
  }
  const Eigen::MatrixXd map = from.colPivHouseholderQr().solve(to);
  AffineFit fit;
  fit.map = Eigen::Affine3d::Identity();
  fit.map.affine() = map.transpose();
  fit.misfit = (from * map - to).norm() / to.norm();
  return fit;
}

bool same_bytes(const Points& a, const Points& b) {
  return a.rows() == b.rows() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

}  // namespace meshgraft::test
