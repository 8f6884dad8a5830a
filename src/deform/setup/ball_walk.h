#pragma once

#include <vector>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Walks over a surface's edges from a vertex within a ball around that vertex. Vertices that are near in
/// space but not along the surface are not visited. The visited region ends only at the ball's boundary, so a
/// weight that falls off smoothly with the distance has no jump elsewhere.
class BallWalk {
 public:
  /// `points` and `rings` must outlive the walk. Only one walk may run at a time.
  BallWalk(const Points& points, const IndexLists& rings)
      : points_(&points), rings_(&rings), met_in_(points.rows(), 0) {}

  /// Calls `visit(vertex, squared distance)` for the start and for every vertex that the walk reaches.
  template <class Visit>
  void from(Index start, double radius, const Visit& visit) {
    ++walk_;
    queue_.assign(1, start);
    met_in_[start] = walk_;
    visit(start, 0.0);
    for (std::size_t next = 0; next < queue_.size(); ++next)
      for (const Index w : (*rings_)[queue_[next]]) {
        if (met_in_[w] == walk_) continue;
        met_in_[w] = walk_;
        const double squared = (points_->row(w) - points_->row(start)).squaredNorm();
        if (!(squared < radius * radius)) continue;
        queue_.push_back(w);
        visit(w, squared);
      }
  }

 private:
  const Points* points_;
  const IndexLists* rings_;
  std::vector<int> met_in_;
  int walk_ = 0;
  std::vector<Index> queue_;
};

}  // namespace meshgraft
