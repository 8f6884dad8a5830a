#include "umbrella_smoothing.h"

namespace meshgraft {

void smooth_by_umbrella(Points& points, const IndexLists& rings, std::span<const Index> moving, int steps,
                        const Context& context) {
  for (int step = 0; step < steps; ++step) {
    context.throw_if_stopped();
    const Points before = points;
    for (const Index v : moving) {
      if (rings[v].empty()) continue;
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (const Index w : rings[v]) sum += before.row(w);
      points.row(v) = sum / static_cast<double>(rings[v].size());
    }
  }
}

}  // namespace meshgraft
