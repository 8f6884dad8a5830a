#include "pose_by_boundary.h"

#include "boundary_condition.h"
#include "match_loops.h"

namespace meshgraft {

Points pose_by_boundary(const Points& source, const std::vector<Index>& component,
                        std::vector<PairGeometry>& pairs, std::span<const Correspondence> correspondences,
                        std::optional<double> size) {
  Points posed = source;
  for (const std::vector<std::size_t>& members : pairs_by_component(pairs, component)) {
    std::vector<LoopGeometry> sources, targets;
    std::vector<Correspondence> matched;
    for (const std::size_t p : members) {
      sources.push_back(pairs[p].source);
      targets.push_back(pairs[p].target);
      matched.push_back(correspondences[p]);
    }
    const Similarity pose = pose_of_boundary(sources, targets, matched, size);
    const auto bring = [&](const Eigen::RowVector3d& point) {
      return Eigen::RowVector3d(pose.scale * point * pose.rotation.transpose() + pose.translation.transpose());
    };
    const Index number = component[pairs[members.front()].loops.source.front()];
    for (Index v = 0; v < static_cast<Index>(component.size()); ++v)
      if (component[v] == number) posed.row(v) = bring(source.row(v));
    for (const std::size_t p : members) {
      LoopGeometry& loop = pairs[p].source;
      for (auto point : loop.points.rowwise()) point = bring(point);
      loop.normals = (loop.normals * pose.rotation.transpose()).eval();
    }
  }
  return posed;
}

}  // namespace meshgraft
