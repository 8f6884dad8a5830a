#include "exponential_map.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>

#include <Eigen/Geometry>

namespace meshgraft {

namespace {

using Vector = Eigen::RowVector3d;

// Turns a vector into another tangent plane by the smallest rotation.
Vector transported(const Vector& vector, const Vector& from_normal, const Vector& to_normal) {
  return Eigen::Quaterniond::FromTwoVectors(from_normal.transpose(), to_normal.transpose()) *
         vector.transpose();
}

struct Frame {
  Vector point, normal, first_axis;
  Eigen::RowVector2d uv = Eigen::RowVector2d::Zero();

  // Returns the coordinates of a neighbouring point: its direction is projected, its distance is kept.
  Eigen::RowVector2d uv_of(const Vector& other) const {
    const Vector way = other - point;
    const Vector second_axis = normal.transpose().cross(first_axis.transpose()).transpose();
    const Eigen::RowVector2d flat(way.dot(first_axis), way.dot(second_axis));
    const double length = flat.norm();
    return length > 0 ? Eigen::RowVector2d(uv + flat * (way.norm() / length)) : uv;
  }
};

// Computes coordinates outward from the origin. This is not the walk of `shortest_distances`: the distance of a
// vertex is the length of its coordinates, which are known when it is settled, and no sum along a path.
class Spreading {
 public:
  Spreading(const Points& positions, const Points& normals, const IndexLists& rings, double radius)
      : positions_(positions),
        normals_(normals),
        rings_(rings),
        radius_(radius),
        settled_(positions.rows(), false),
        distance_(positions.rows(), std::numeric_limits<double>::infinity()),
        first_axis_(positions.rows(), 3),
        uv_(PlanePoints::Constant(positions.rows(), 2, std::numeric_limits<double>::quiet_NaN())) {}

  PlanePoints run(const ChartOrigin& origin, const Context& context) {
    const Frame base{origin.point, origin.normal, origin.first_axis};
    for (const Index v : origin.seeds) {
      settle(v, {base});
      push_neighbours(v);
    }
    for (std::size_t count = 0; !queue_.empty(); ++count) {
      if (count % 4096 == 0) context.throw_if_stopped();
      const Index v = std::get<1>(queue_.top());
      queue_.pop();
      if (settled_[v]) continue;
      std::vector<Frame> nearer;
      for (const Index u : rings_[v])
        if (settled_[u]) nearer.push_back(frame_at(u));
      settle(v, nearer);
      if (uv_.row(v).norm() <= radius_) push_neighbours(v);
    }
    return uv_;
  }

 private:
  Frame frame_at(Index v) const { return {positions_.row(v), normals_.row(v), first_axis_.row(v), uv_.row(v)}; }

  void settle(Index v, const std::vector<Frame>& from) {
    const Vector point = positions_.row(v);
    Eigen::RowVector2d uv = Eigen::RowVector2d::Zero();
    Vector axis = Vector::Zero();
    double total = 0;
    for (const Frame& frame : from) {
      const double distance = (point - frame.point).norm();
      const double weight = 1 / std::max(distance, 1e-300);
      uv += weight * frame.uv_of(point);
      axis += weight * transported(frame.first_axis, frame.normal, normals_.row(v));
      total += weight;
    }
    settled_[v] = true;
    uv_.row(v) = uv / total;
    axis -= axis.dot(normals_.row(v)) * normals_.row(v);
    first_axis_.row(v) = axis.stableNormalized();
  }

  void push_neighbours(Index v) {
    const Frame frame = frame_at(v);
    for (const Index u : rings_[v]) {
      if (settled_[u]) continue;
      const double distance = frame.uv_of(positions_.row(u)).norm();
      if (distance >= distance_[u]) continue;
      distance_[u] = distance;
      queue_.emplace(distance, u);
    }
  }

  const Points& positions_;
  const Points& normals_;
  const IndexLists& rings_;
  double radius_;
  Flags settled_;
  std::vector<double> distance_;
  Points first_axis_;
  PlanePoints uv_;
  using Entry = std::tuple<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

PlanePoints exponential_map(const Points& positions, const Points& normals, const IndexLists& rings,
                            const ChartOrigin& origin, double radius, const Context& context) {
  return Spreading(positions, normals, rings, radius).run(origin, context);
}

}  // namespace meshgraft
