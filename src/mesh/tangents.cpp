#include "tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include "area_vector.h"
#include "face_defects.h"

namespace meshgraft {

namespace {

struct FaceMap {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();  ///< applied to directions in the surface
  double area = 0;                                       ///< at rest
};

/// Returns the linear map from a face's rest edges to the moved ones (the best fit for a polygon). The map
/// takes the normal to the new one, scaled by the mean stretch within the face. The normal matters because a
/// smooth tangent is not quite parallel to its faces.
FaceMap face_map(std::span<const Index> face, const Points& rest, const Points& moved) {
  const Eigen::Vector3d area_before = area_vector(face, rest);
  const Eigen::Vector3d area_after = area_vector(face, moved);
  const double area = area_before.stableNorm();
  const double ratio = area_after.stableNorm() / area;
  if (!(area > 0) || !std::isfinite(ratio)) return {Eigen::Matrix3d::Identity(), 0};
  const Eigen::Vector3d normal = area_before / area;
  const Eigen::Vector3d normal_after =
      ratio > 0 ? Eigen::Vector3d(area_after / (area * std::sqrt(ratio))) : normal;
  Eigen::Matrix3d before = area * normal * normal.transpose();
  Eigen::Matrix3d after = area * normal_after * normal.transpose();
  for (std::size_t c = 0; c < face.size(); ++c) {
    const Index i = face[c];
    const Index j = face[(c + 1) % face.size()];
    const Eigen::Vector3d edge = (rest.row(j) - rest.row(i)).transpose();
    const Eigen::Vector3d in_plane = edge - normal * normal.dot(edge);
    before += in_plane * in_plane.transpose();
    after += (moved.row(j) - moved.row(i)).transpose() * in_plane.transpose();
  }
  const Eigen::Matrix3d linear = after * before.inverse();
  if (!linear.allFinite()) return {Eigen::Matrix3d::Identity(), 0};
  return {linear, area};
}

Eigen::Vector3d perpendicular(const Eigen::Vector3d& vector, const double* normal) {
  Eigen::Vector3d result = vector;
  if (normal != nullptr) {
    const Eigen::Vector3d n = Eigen::Map<const Eigen::Vector3d>(normal).stableNormalized();
    if (n.allFinite()) result -= n * n.dot(result);
  }
  return result;
}

const double* normal_at(const Mesh& mesh, Index corner) {
  const Index vertex = mesh.faces.corners()[corner];
  for (const auto& [domain, row] : {std::pair{Domain::corner, corner}, std::pair{Domain::vertex, vertex}}) {
    const Attribute* normals = mesh.find_attribute(domain, "normal");
    if (normals == nullptr || normals->components != 3) continue;
    const double* at = normals->values.data() + 3 * static_cast<std::size_t>(row);
    return std::isnan(at[0]) ? nullptr : at;
  }
  return nullptr;
}

class TangentUpdate {
 public:
  TangentUpdate(const Mesh& mesh, const Points& rest, const Flags& moved)
      : mesh_(mesh), rest_(rest), moved_(moved) {}

  void update(Attribute& tangents) {
    const Attribute old = tangents;
    const bool of_corners = tangents.domain == Domain::corner;
    std::map<Key, Sum> sums;
    const Flags near = near_moved_vertices();
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      const std::span<const Index> face = mesh_.faces[f];
      if (!near[f]) continue;
      const FaceMap map = face_map(face, rest_, mesh_.positions);
      for (std::size_t k = 0; k < face.size(); ++k) {
        const Index corner = mesh_.faces.first_corner(f) + static_cast<Index>(k);
        const double* at = old.values.data() + 4 * static_cast<std::size_t>(of_corners ? corner : face[k]);
        const Eigen::Vector3d tangent = Eigen::Map<const Eigen::Vector3d>(at);
        if (!tangent.allFinite()) continue;
        Sum& sum = sums[Key{face[k], {at[0], at[1], at[2], at[3]}}];
        sum.direction += map.area * (map.linear * tangent);
        sum.is_moved = sum.is_moved || moved_[f];
      }
    }
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      const std::span<const Index> face = mesh_.faces[f];
      if (!near[f]) continue;
      for (std::size_t k = 0; k < face.size(); ++k) {
        const Index corner = mesh_.faces.first_corner(f) + static_cast<Index>(k);
        const std::size_t row = 4 * static_cast<std::size_t>(of_corners ? corner : face[k]);
        const double* at = old.values.data() + row;
        const auto sum = sums.find(Key{face[k], {at[0], at[1], at[2], at[3]}});
        if (sum == sums.end() || !sum->second.is_moved) continue;
        const Eigen::Vector3d carried = perpendicular(sum->second.direction, normal_at(mesh_, corner));
        const double length = carried.stableNorm();
        if (!(length > 0) || !std::isfinite(length)) continue;
        for (int axis = 0; axis < 3; ++axis) tangents.values[row + axis] = carried[axis] / length;
      }
    }
  }

 private:
  using Key = std::pair<Index, std::array<double, 4>>;  // a vertex, and the tangent that its corners share
  struct Sum {
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    bool is_moved = false;
  };

  /// Flags the faces that share a vertex with a moved face, because they all affect the tangents that change.
  Flags near_moved_vertices() const {
    Flags touched(mesh_.vertex_count(), false);
    for (Index f = 0; f < mesh_.face_count(); ++f)
      if (moved_[f])
        for (const Index v : mesh_.faces[f]) touched[v] = true;
    Flags near(mesh_.face_count(), false);
    for (Index f = 0; f < mesh_.face_count(); ++f)
      near[f] = in_range(mesh_, f) && std::ranges::any_of(mesh_.faces[f], [&](Index v) { return touched[v]; });
    return near;
  }

  const Mesh& mesh_;
  const Points& rest_;
  const Flags& moved_;
};

}  // namespace

void update_tangents(Mesh& mesh, const Points& rest, const Flags& moved) {
  for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
    Attribute& attribute = mesh.attributes[a];
    if (attribute.name != "tangent" || attribute.components != 4 || attribute.domain == Domain::face) continue;
    TangentUpdate(mesh, rest, moved).update(attribute);
  }
}

}  // namespace meshgraft
