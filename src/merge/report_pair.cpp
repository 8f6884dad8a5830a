#include "report_pair.h"

#include <algorithm>
#include <cmath>

#include "loop_curve.h"
#include "loops.h"

namespace meshgraft {

namespace {

/// Returns the RMS distance of points from their mean.
double radius_of(const Points& points) {
  const Eigen::RowVector3d centre = points.colwise().mean();
  return std::sqrt((points.rowwise() - centre).rowwise().squaredNorm().mean());
}

/// Reports the points of the target's loop that the source's loop vertices meet, and the loops' ratio.
void report_meetings(const PairGeometry& pair, const Correspondence& correspondence, Index given,
                     PairReport& report) {
  const std::vector<Index>& loop = pair.loops.source;
  report.target_points.resize(static_cast<Eigen::Index>(loop.size()), 3);
  Points there(static_cast<Eigen::Index>(loop.size()), 3);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    there.row(static_cast<Eigen::Index>(i)) = at(pair.target.points, correspondence.loop_parameter[i]);
    if (loop[i] >= given) continue;
    report.target_points.row(static_cast<Eigen::Index>(report.met.size())) =
        there.row(static_cast<Eigen::Index>(i));
    report.met.push_back(loop[i]);
  }
  report.size_ratio = radius_of(there) / radius_of(pair.source.points);
  report.target_points.conservativeResize(static_cast<Eigen::Index>(report.met.size()), 3);
}

}  // namespace

PairReport report_pair(const PairGeometry& pair, const Correspondence& correspondence, Index given) {
  const auto& [source, target] = pair.loops;
  PairReport report;
  report.source_vertices = static_cast<Index>(source.size());
  report.target_vertices = static_cast<Index>(target.size());
  const auto nearest = static_cast<std::size_t>(std::lround(correspondence.loop_parameter.front()));
  report.start = {source.front(), target[nearest % target.size()]};
  report.confidence = correspondence.confidence;
  report.starts = correspondence.starts;
  report.raggedness_deg = std::max(raggedness_deg(pair.source.points), raggedness_deg(pair.target.points));
  // Counts are compared, because matched loops coincide whatever the units of their meshes.
  report.edge_ratio = static_cast<double>(source.size()) / static_cast<double>(target.size());
  report_meetings(pair, correspondence, given, report);
  return report;
}

double misfit_rel(const Points& posed, std::span<const VertexConstraint> constraints) {
  Points there(posed.rows(), 3);
  for (Eigen::Index i = 0; i < there.rows(); ++i) there.row(i) = constraints[i].position->transpose();
  return std::sqrt((posed - there).rowwise().squaredNorm().mean()) / radius_of(there);
}

}  // namespace meshgraft
