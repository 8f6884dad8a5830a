#include <meshgraft/select/selection.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "candidates.h"
#include "core/facts.h"
#include "mesh/box_diagonal.h"
#include "mesh/shortest_distances.h"
#include "mesh/vertex_tree.h"
#include "select/facts.h"

namespace meshgraft {

namespace {

void require_finite(const Eigen::Vector3d& vector, const Location& location) {
  if (!vector.allFinite())
    throw Error(facts::core::NotFinite{.what = facts::core::Quantity::coordinate}, location);
}

void require_not_negative(double number, const Location& location) {
  if (!std::isfinite(number) || number < 0)
    throw Error(facts::core::NegativeOrNotFinite{.value = number}, location);
}

Eigen::Vector3d unit(const Eigen::Vector3d& normal, const Location& location) {
  require_finite(normal, location);
  const double length = normal.stableNorm();
  if (length == 0) throw Error(facts::core::NormalWithoutLength{}, location);
  return normal / length;
}

// Sets of vertices as flags, to combine selections.

Flags flags_of(std::span<const Index> vertices, Index vertex_count) {
  Flags flags(vertex_count, false);
  for (const Index v : vertices) flags[v] = true;
  return flags;
}

template <typename Predicate>
std::vector<Index> vertices_where(Index vertex_count, const Predicate& predicate) {
  std::vector<Index> vertices;
  for (Index v = 0; v < vertex_count; ++v) {
    if (predicate(v)) vertices.push_back(v);
  }
  return vertices;
}

// Finds shortest edge paths that avoid blocked vertices.
class PathFinder {
 public:
  explicit PathFinder(const SelectionMesh& context)
      : context_(context),
        blocked_(context.mesh.vertex_count(), false),
        distance_(context.mesh.vertex_count(), unreached),
        previous_(context.mesh.vertex_count(), -1) {}

  void block(std::span<const Index> vertices) {
    for (const Index v : vertices) blocked_[v] = true;
  }

  // Returns the vertices after `from` up to and including `to`; empty if there is no path.
  std::vector<Index> find(Index from, Index to) {
    const Points& positions = context_.mesh.positions;
    std::vector<Index> touched = {from};
    bool found = false;
    shortest_distances(std::span(&from, 1), distance_, [&](Index v, double reached, const auto& offer) {
      found = v == to;
      if (found) return false;
      for (const Index w : context_.rings[v]) {
        if (blocked_[w] && w != to) continue;
        if (!offer(w, reached + (positions.row(w) - positions.row(v)).norm())) continue;
        touched.push_back(w);
        previous_[w] = v;
      }
      return true;
    });
    std::vector<Index> path;
    if (found) {
      for (Index v = to; v != from; v = previous_[v]) path.push_back(v);
      std::reverse(path.begin(), path.end());
    }
    for (const Index v : touched) distance_[v] = unreached;
    return path;
  }

 private:
  const SelectionMesh& context_;
  Flags blocked_;
  std::vector<double> distance_;
  std::vector<Index> previous_;
};

class Resolver {
 public:
  explicit Resolver(const SelectionMesh& context) : context_(context), count_(context.mesh.vertex_count()) {}

  std::vector<Index> resolve(const Selection& selection, const Location& location) const {
    std::vector<Index> found =
        std::visit([&](const auto& kind) { return vertices(kind, location); }, selection.kind);
    return context_.weld.empty() ? found : representatives(found);
  }

 private:
  // Returns the first copy of each vertex in the weld, once, in order of first occurrence.
  std::vector<Index> representatives(std::span<const Index> vertices) const {
    Flags seen(count_, false);
    std::vector<Index> distinct;
    for (const Index v : vertices) {
      const Index first_copy = context_.weld.of(v);
      if (!seen[first_copy]) distinct.push_back(first_copy);
      seen[first_copy] = true;
    }
    return distinct;
  }

  Eigen::Vector3d position(Index v) const { return context_.mesh.positions.row(v).transpose(); }

  std::vector<Index> child(const std::shared_ptr<const Selection>& of, const Location& location) const {
    if (!of) throw Error(facts::select::NoSelection{}, location);
    return resolve(*of, location);
  }

  std::vector<Index> vertices(const Selection::All&, const Location&) const {
    std::vector<Index> all(count_);
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  std::vector<Index> vertices(const Selection::Indices& indices, const Location& location) const {
    Flags seen(count_, false);
    std::vector<Index> distinct;
    for (std::size_t k = 0; k < indices.vertices.size(); ++k) {
      const Index v = indices.vertices[k];
      if (v < 0 || v >= count_)
        throw Error(facts::core::NoSuchVertex{.vertex = v, .count = count_}, (location / "indices")[k]);
      if (!seen[v]) distinct.push_back(v);
      seen[v] = true;
    }
    return distinct;
  }

  std::vector<Index> vertices(const Selection::Box& box, const Location& location) const {
    require_finite(box.min, location / "box" / "min");
    require_finite(box.max, location / "box" / "max");
    if ((box.min.array() > box.max.array()).any()) throw Error(facts::select::BoxReversed{}, location / "box");
    return vertices_where(count_, [&](Index v) {
      const Eigen::Array3d x = position(v).array();
      return (x >= box.min.array()).all() && (x <= box.max.array()).all();
    });
  }

  std::vector<Index> vertices(const Selection::Sphere& sphere, const Location& location) const {
    require_finite(sphere.centre, location / "sphere" / "centre");
    require_not_negative(sphere.radius, location / "sphere" / "radius");
    return vertices_where(count_,
                          [&](Index v) { return (position(v) - sphere.centre).norm() <= sphere.radius; });
  }

  std::vector<Index> vertices(const Selection::HalfSpace& half, const Location& location) const {
    require_finite(half.plane.point, location / "half_space" / "point");
    const Eigen::Vector3d normal = unit(half.plane.normal, location / "half_space" / "normal");
    return vertices_where(count_, [&](Index v) { return (position(v) - half.plane.point).dot(normal) >= 0; });
  }

  std::vector<Index> vertices(const Selection::Component& component, const Location& location) const {
    const auto& numbers = context_.components;
    const Index count = numbers.empty() ? 0 : *std::max_element(numbers.begin(), numbers.end()) + 1;
    if (count == 0) throw Error(facts::select::NoVertexWithFace{}, location / "component");
    if (component.number < 0 || component.number >= count)
      throw Error(facts::select::NoSuchComponent{.number = component.number, .count = count},
                  location / "component");
    return vertices_where(count_, [&](Index v) { return numbers[v] == component.number; });
  }

  std::vector<Index> vertices(const Selection::Loop& loop, const Location& location) const {
    const auto count = static_cast<Index>(context_.loops.size());
    if (count == 0) throw Error(facts::select::NoLoops{.number = loop.number}, location / "loop");
    if (loop.number < 0 || loop.number >= count)
      throw Error(facts::select::NoSuchLoop{.number = loop.number, .count = count}, location / "loop");
    return context_.loops[loop.number];
  }

  std::vector<Index> vertices(const Selection::NearestVertex& nearest, const Location& location) const {
    require_finite(nearest.point, location / "nearest");
    // A linear search suffices, because a tree does not pay for one query.
    Index best = -1;
    double best_distance = std::numeric_limits<double>::infinity();
    for (Index v = 0; v < count_; ++v) {
      const double distance = (position(v) - nearest.point).norm();
      if (context_.components[v] < 0 || !(distance < best_distance)) continue;
      best = v;
      best_distance = distance;
    }
    if (best < 0) throw Error(facts::select::NoVertexWithFace{}, location / "nearest");
    return {best};
  }

  std::vector<Index> vertices(const Selection::Path& path, const Location& location) const {
    const std::vector<Index> stations = path_stations(path, location / "path");
    PathFinder finder(context_);
    finder.block(stations);
    std::vector<Index> vertices = {stations[0]};
    const std::size_t legs = path.closed ? stations.size() : stations.size() - 1;
    for (std::size_t k = 0; k < legs; ++k) {
      const Index from = stations[k];
      const Index to = stations[(k + 1) % stations.size()];
      const std::vector<Index> leg = finder.find(from, to);
      if (leg.empty()) throw Error(facts::select::NoWayAlongEdges{.from = from, .to = to}, location / "path");
      finder.block(leg);
      vertices.insert(vertices.end(), leg.begin(), leg.end());
    }
    if (path.closed) vertices.pop_back();  // it repeats the first vertex
    return vertices;
  }

  // Returns the vertices nearest to a path's points, without successive repeats.
  std::vector<Index> path_stations(const Selection::Path& path, const Location& location) const {
    const VertexTree tree(context_.mesh.positions, candidates_of(context_));
    std::vector<Index> stations;
    Flags seen(count_, false);
    for (std::size_t k = 0; k < path.points.size(); ++k) {
      require_finite(path.points[k], (location / "points")[k]);
      const auto nearest = tree.nearest(path.points[k]);
      if (!nearest) throw Error(facts::select::NoVertexWithFace{}, location);
      const Index v = nearest->vertex;
      const bool comes_home = path.closed && k + 1 == path.points.size() && k > 0 && v == stations.front();
      if ((!stations.empty() && v == stations.back()) || comes_home) continue;
      if (seen[v]) throw Error(facts::select::PathCrossesItself{.vertex = v}, (location / "points")[k]);
      seen[v] = true;
      stations.push_back(v);
    }
    const std::size_t needed = path.closed ? 3 : 2;
    if (stations.size() < needed)
      throw Error(facts::select::PathTooShort{.kind = path.closed ? facts::select::Kind::closed_path
                                                                  : facts::select::Kind::path,
                                              .needed = needed,
                                              .count = stations.size()},
                  location / "points");
    return stations;
  }

  std::vector<Index> vertices(const Selection::Grow& grow, const Location& location) const {
    const std::vector<Index> of = child(grow.of, location / "grow" / "of");
    if (grow.rings >= 0) return grow_rings(of, grow.rings, context_.rings);
    const Flags near_outside = within_rings_of_outside(of, -std::int64_t{grow.rings});
    return ascending(of, [&](Index v) { return !near_outside[v]; });
  }

  std::vector<Index> vertices(const Selection::GrowLength& grow, const Location& location) const {
    require_not_negative(grow.length, location / "grow_length" / "length");
    const std::vector<Index> of = child(grow.of, location / "grow_length" / "of");
    const auto distance = edge_distance(of, context_.mesh.positions, context_.rings, {.limit = grow.length});
    return vertices_where(count_, [&](Index v) { return std::isfinite(distance[v]); });
  }

  std::vector<Index> vertices(const Selection::Rim& rim, const Location& location) const {
    if (rim.rings < 1) throw Error(facts::select::NoRings{}, location / "rim" / "rings");
    const std::vector<Index> of = child(rim.of, location / "rim" / "of");
    const Flags near_outside = within_rings_of_outside(of, rim.rings);
    return ascending(of, [&](Index v) { return near_outside[v]; });
  }

  Flags within_rings_of_outside(const std::vector<Index>& inside, std::int64_t rings) const {
    // The way from outside to a vertex inside is shortest where it stays inside.
    const Flags in = flags_of(inside, count_);
    Flags near(count_, 0);
    std::vector<Index> front, next;
    const auto reach = [&](Index v, std::vector<Index>& reached) {
      if (near[v]) return;
      near[v] = 1;
      reached.push_back(v);
    };
    for (const Index v : inside)
      if (std::ranges::any_of(context_.rings[v], [&](Index w) { return !in[w]; })) reach(v, front);
    for (std::int64_t ring = 1; ring < rings && !front.empty(); ++ring) {
      next.clear();
      for (const Index v : front)
        for (const Index w : context_.rings[v])
          if (in[w]) reach(w, next);
      front.swap(next);
    }
    return near;
  }

  template <typename Predicate>
  std::vector<Index> ascending(const std::vector<Index>& of, const Predicate& predicate) const {
    const Flags in = flags_of(of, count_);
    return vertices_where(count_, [&](Index v) { return in[v] && predicate(v); });
  }

  std::vector<Flags> operands(const std::vector<Selection>& of, const Location& location,
                              const char* name) const {
    if (of.empty()) throw Error(facts::select::NoSelection{}, location / name);
    std::vector<Flags> sets;
    for (std::size_t k = 0; k < of.size(); ++k) {
      sets.push_back(flags_of(resolve(of[k], (location / name)[k]), count_));
    }
    return sets;
  }

  std::vector<Index> vertices(const Selection::Union& combined, const Location& location) const {
    const auto sets = operands(combined.of, location, "union");
    return vertices_where(count_, [&](Index v) {
      return std::any_of(sets.begin(), sets.end(), [&](const Flags& set) { return set[v]; });
    });
  }

  std::vector<Index> vertices(const Selection::Intersect& combined, const Location& location) const {
    const auto sets = operands(combined.of, location, "intersect");
    return vertices_where(count_, [&](Index v) {
      return std::all_of(sets.begin(), sets.end(), [&](const Flags& set) { return set[v]; });
    });
  }

  std::vector<Index> vertices(const Selection::Minus& combined, const Location& location) const {
    const auto sets = operands(combined.of, location, "minus");
    return vertices_where(count_, [&](Index v) {
      return sets[0][v] && std::none_of(sets.begin() + 1, sets.end(), [&](const Flags& set) { return set[v]; });
    });
  }

  std::vector<Index> vertices(const Selection::Mirror& mirror, const Location& location) const {
    require_finite(mirror.plane.point, location / "mirror" / "point");
    const Eigen::Vector3d normal = unit(mirror.plane.normal, location / "mirror" / "normal");
    require_not_negative(mirror.tolerance_rel, location / "mirror" / "tolerance_rel");
    const std::vector<Index> of = child(mirror.of, location / "mirror" / "of");
    const double tolerance = mirror.tolerance_rel * box_diagonal(context_.mesh.positions);
    const VertexTree tree(context_.mesh.positions, candidates_of(context_));
    std::vector<Index> images;
    for (const Index v : of) {
      const Eigen::Vector3d x = position(v);
      if (!x.allFinite()) continue;
      const auto found = tree.nearest(x - 2 * (x - mirror.plane.point).dot(normal) * normal);
      if (found && found->distance <= tolerance) images.push_back(found->vertex);
    }
    return ascending(images, [](Index) { return true; });
  }

  const SelectionMesh& context_;
  Index count_;
};

}  // namespace

SelectionMesh::SelectionMesh(const Mesh& the_mesh, Weld the_weld)
    : SelectionMesh(the_mesh, connectivity(the_mesh)) {
  weld = std::move(the_weld);
}

SelectionMesh::SelectionMesh(const Mesh& the_mesh, Connectivity connectivity)
    : mesh(the_mesh),
      rings(std::move(connectivity.rings)),
      components(std::move(connectivity.components)),
      loops(std::move(connectivity.loops)) {}

std::vector<Index> resolve(const Selection& selection, const SelectionMesh& context, const Location& location) {
  return Resolver(context).resolve(selection, location);
}

}  // namespace meshgraft
