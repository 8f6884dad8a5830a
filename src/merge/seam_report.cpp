#include "seam_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "core/percentile.h"
#include "mesh/box_diagonal.h"

namespace meshgraft {

namespace {

constexpr int neighbourhood_rings = 6;

double smallest_angle_deg(const SeamPatch& patch, Eigen::Index t) {
  double smallest = 180;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector3d at = patch.points.row(patch.triangles(t, c));
    const Eigen::Vector3d a = patch.points.row(patch.triangles(t, (c + 1) % 3)).transpose() - at;
    const Eigen::Vector3d b = patch.points.row(patch.triangles(t, (c + 2) % 3)).transpose() - at;
    smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi);
  }
  return smallest;
}

void measure_shape(const SeamPatch& patch, SeamReport& report) {
  std::vector<double> angles;
  for (Eigen::Index t = 0; t < patch.triangles.rows(); ++t) {
    if (patch.side[t] == SeamSide::strip) angles.push_back(smallest_angle_deg(patch, t));
  }
  report.angle_p1_deg = percentile(angles, 1);

  std::vector<double> strip, target, source;
  for (const SeamEdge& edge : inner_edges(patch)) {
    const SeamSide a = patch.side[edge.triangles[0]], b = patch.side[edge.triangles[1]];
    if (a == SeamSide::strip || b == SeamSide::strip) {
      strip.push_back(edge.dihedral_deg);
    } else {
      (a == SeamSide::target ? target : source).push_back(edge.dihedral_deg);
    }
  }
  report.dihedral_p99_deg = percentile(strip, 99);
  report.target_dihedral_p99_deg = percentile(target, 99);
  report.source_dihedral_p99_deg = percentile(source, 99);
}

}  // namespace

SeamReport measure_seam(const Mesh& mesh, const SeamLayout& layout, const Points& unfaired) {
  SeamReport report;
  const TopologySummary topology = summarise_topology(mesh);
  report.manifold = topology.manifold;
  report.oriented = topology.oriented;
  report.closed = topology.closed;
  report.euler_characteristic = topology.euler_characteristic;
  report.new_faces = mesh.face_count() - layout.target_faces - layout.source_faces;
  measure_shape(make_seam_patch(mesh, layout, neighbourhood_rings), report);
  const auto n = static_cast<Eigen::Index>(layout.target_vertices);
  if (n > 0) {
    const double largest = (mesh.positions.topRows(n) - unfaired.topRows(n)).rowwise().norm().maxCoeff();
    report.band_displacement_rel = largest / box_diagonal_of_faces(mesh);
  }
  return report;
}

}  // namespace meshgraft
