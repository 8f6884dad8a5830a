#include "box_diagonal.h"

#include <Eigen/Geometry>

#include "face_defects.h"

namespace meshgraft {

namespace {

double diagonal(const Eigen::AlignedBox3d& box) { return box.isEmpty() ? 0 : box.diagonal().stableNorm(); }

}  // namespace

double box_diagonal(const Points& points) {
  Eigen::AlignedBox3d box;
  for (const auto& point : points.rowwise())
    if (point.allFinite()) box.extend(point.transpose());
  return diagonal(box);
}

double box_diagonal_of_faces(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Index v : mesh.faces.corners())
    if (is_vertex_of(mesh, v) && mesh.positions.row(v).allFinite())
      box.extend(mesh.positions.row(v).transpose());
  return diagonal(box);
}

}  // namespace meshgraft
