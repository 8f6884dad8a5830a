#include "shape_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "core/percentile.h"
#include "loop_curve.h"

namespace meshgraft {

namespace {

/// The vertices of a connected component of the source.
struct ComponentVertices {
  std::vector<Index> far, all;
};

Points rows_of(const Points& points, const std::vector<Index>& rows) {
  Points chosen(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) chosen.row(static_cast<Eigen::Index>(i)) = points.row(rows[i]);
  return chosen;
}

/// Returns the second and third corner of a triangle in coordinates of its plane, relative to the first
/// corner.
Eigen::Matrix2d flat(const Eigen::RowVector3d& u, const Eigen::RowVector3d& v) {
  Eigen::Matrix2d corners;
  const double length = u.norm();
  const double along = v.dot(u) / length;
  corners << length, along, 0, u.cross(v).norm() / length;
  return corners;
}

/// Returns the smaller in-plane singular value of the map of a triangle; -1 where it is undefined.
double smallest_stretch(const Points& rest, const Points& grafted, const Eigen::RowVector3i& t) {
  const Eigen::Matrix2d before = flat(rest.row(t[1]) - rest.row(t[0]), rest.row(t[2]) - rest.row(t[0]));
  const Eigen::Matrix2d after =
      flat(grafted.row(t[1]) - grafted.row(t[0]), grafted.row(t[2]) - grafted.row(t[0]));
  if (!(before.determinant() > 1e-12 * before.squaredNorm()) || !after.allFinite()) return -1;
  return Eigen::JacobiSVD<Eigen::Matrix2d>(after * before.inverse()).singularValues()[1];
}

}  // namespace

ShapeReport measure_shape(const Points& rest, const Points& grafted, const Triangles& triangles,
                          std::span<const Index> far, const std::vector<Index>& component) {
  std::map<Index, ComponentVertices> parts;
  Flags is_far(rest.rows(), 0);
  for (const Index v : far) {
    parts[component[v]].far.push_back(v);
    is_far[v] = 1;
  }
  for (Index v = 0; v < static_cast<Index>(component.size()); ++v)
    if (component[v] >= 0) parts[component[v]].all.push_back(v);

  ShapeReport report;
  std::map<Index, double> scales;
  std::size_t largest = 0;
  for (const auto& [number, part] : parts) {
    const std::vector<Index>& measured = part.far.size() >= 4 ? part.far : part.all;
    const Points from = rows_of(rest, measured), to = rows_of(grafted, measured);
    Similarity best;
    if (!fit_similarity(from, to, Eigen::VectorXd::Ones(from.rows()), best)) continue;
    scales[number] = best.scale;
    report.scales.push_back(best.scale);
    const Points there =
        (best.scale * from * best.rotation.transpose()).rowwise() + best.translation.transpose();
    const double size = (to.colwise().maxCoeff() - to.colwise().minCoeff()).norm();
    const double distance = std::sqrt((to - there).rowwise().squaredNorm().mean());
    if (size > 0) report.distance_rel = std::max(report.distance_rel, distance / size);
    if (part.all.size() <= largest) continue;
    largest = part.all.size();
    report.similarity = best;
  }
  std::map<Index, std::vector<double>> stretches;
  for (const auto& t : triangles.rowwise()) {
    const auto scale = scales.find(component[t[0]]);
    if (scale == scales.end() || (is_far[t[0]] && is_far[t[1]] && is_far[t[2]])) continue;
    const double stretch = smallest_stretch(rest, grafted, t);
    if (stretch >= 0) stretches[component[t[0]]].push_back(stretch / scale->second);
  }
  for (auto& [number, values] : stretches)
    report.smallest_singular_p5 = std::min(report.smallest_singular_p5, percentile(values, 5));
  return report;
}

}  // namespace meshgraft
