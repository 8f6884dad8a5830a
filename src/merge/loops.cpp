#include "loops.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "loop_curve.h"
#include "merge/facts.h"
#include "mesh/winding.h"

namespace meshgraft {

namespace {

/// The boundary loops of one of the two meshes, with a lookup of the loops at a vertex.
class MeshLoops {
 public:
  MeshLoops(const Mesh& mesh, facts::merge::Side side)
      : mesh_(mesh), side_(side), loops_(boundary_loops(mesh)) {
    for (std::size_t l = 0; l < loops_.size(); ++l)
      for (const Index v : loops_[l]) at_[v].push_back(l);
  }

  /// Returns the list in the direction of the mesh's loop. Throws where it is not one whole simple loop.
  std::vector<Index> require_loop(const std::vector<Index>& listed, const Location& location) const {
    if (loops_.empty()) throw Error(facts::merge::NoBoundaryLoop{.side = side_}, location);
    if (listed.empty()) throw Error(facts::merge::NoLoopNamed{.side = side_}, location);
    for (const Index v : listed) require_on_one_loop(v, location);
    const std::vector<Index>& loop = loops_[at_.at(listed.front()).front()];
    for (const Index v : listed)
      if (&loops_[at_.at(v).front()] != &loop)
        throw Error(
            facts::merge::VerticesOfTwoLoops{.side = side_, .vertex = listed.front(), .other_vertex = v},
            location);
    if (listed.size() != loop.size())
      throw Error(
          facts::merge::LoopNotListedWhole{.listed = listed.size(), .side = side_, .count = loop.size()},
          location);
    require_length(loop, location);
    std::vector<Index> turned = loop;
    std::rotate(turned.begin(), std::find(turned.begin(), turned.end(), listed.front()), turned.end());
    const bool backwards = !std::equal(turned.begin(), turned.end(), listed.begin()) &&
                           std::equal(turned.begin() + 1, turned.end(), listed.rbegin());
    if (!backwards && turned != listed)
      throw Error(facts::merge::LoopNotListedInOrder{.side = side_}, location);
    return turned;
  }

  std::vector<std::size_t> usable() const {
    std::vector<std::size_t> numbers;
    for (std::size_t l = 0; l < loops_.size(); ++l) {
      try {
        require_loop(loops_[l], {});
        numbers.push_back(l);
      } catch (const Error&) {
      }
    }
    return numbers;
  }

 private:
  void require_on_one_loop(Index v, const Location& location) const {
    if (v < 0 || v >= mesh_.vertex_count())
      throw Error(facts::merge::NoSuchVertex{.side = side_, .vertex = v, .count = mesh_.vertex_count()},
                  location);
    const auto found = at_.find(v);
    if (found == at_.end())
      throw Error(facts::merge::VertexNotOnBoundary{.side = side_, .vertex = v}, location);
    if (found->second.size() > 1)
      throw Error(facts::merge::BoundaryTouchesItself{.side = side_, .vertex = v}, location);
  }

  void require_length(const std::vector<Index>& loop, const Location& location) const {
    Points points(static_cast<Eigen::Index>(loop.size()), 3);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      points.row(static_cast<Eigen::Index>(i)) = mesh_.positions.row(loop[i]);
      if (!mesh_.positions.row(loop[i]).allFinite())
        throw Error(facts::merge::VertexNotFinite{.side = side_, .vertex = loop[i]}, location);
    }
    const double size = points.cwiseAbs().maxCoeff();
    const double extent = (points.colwise().maxCoeff() - points.colwise().minCoeff()).maxCoeff();
    constexpr double least = 1e-60, most = 1e60;  // keeps squares and cubes of lengths in range
    if (extent > 0 && !(extent > least && size < most))
      throw Error(
          facts::merge::LoopLengthOutOfRange{
              .side = side_, .vertex = loop.front(), .length = 2 * extent, .coordinate = size},
          location);
    if (!(LoopCurve(points).length() > 1e-12 * size))
      throw Error(facts::merge::LoopWithoutLength{.side = side_, .vertex = loop.front()}, location);
  }

  const Mesh& mesh_;
  facts::merge::Side side_;
  std::vector<std::vector<Index>> loops_;
  std::map<Index, std::vector<std::size_t>> at_;
};

}  // namespace

Location pair_location(std::size_t pair, std::size_t count) {
  return count == 1 ? Location() : Location::pair(pair);
}

std::vector<std::size_t> usable_loops(const Mesh& mesh) {
  return MeshLoops(mesh, facts::merge::Side::target).usable();
}

std::vector<LoopPair> checked_loops(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs) {
  if (pairs.empty()) throw Error(facts::merge::NoPairs{});
  const MeshLoops target_loops(target, facts::merge::Side::target),
      source_loops(source, facts::merge::Side::source);
  std::vector<LoopPair> checked;
  std::map<Index, std::size_t> source_owner, target_owner;
  const auto claim = [](const std::vector<Index>& loop, std::map<Index, std::size_t>& owner, std::size_t p,
                        facts::merge::Side side) {
    const auto [at, added] = owner.emplace(*std::min_element(loop.begin(), loop.end()), p);
    if (!added)
      throw Error(
          facts::merge::LoopNamedTwice{.pair = at->second, .other_pair = p, .side = side, .vertex = at->first});
  };
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const Location location = pair_location(p, pairs.size());
    checked.push_back({source_loops.require_loop(pairs[p].loops.source, location),
                       target_loops.require_loop(pairs[p].loops.target, location)});
    claim(checked.back().source, source_owner, p, facts::merge::Side::source);
    claim(checked.back().target, target_owner, p, facts::merge::Side::target);
  }
  return checked;
}

std::vector<Index> checked_loop(const Mesh& mesh, facts::merge::Side side, const std::vector<Index>& listed) {
  return MeshLoops(mesh, side).require_loop(listed, {});
}

void require_held_components(std::span<const Index> component, std::span<const LoopPair> pairs) {
  const Index count = component.empty() ? 0 : std::ranges::max(component) + 1;
  std::vector<Index> size(count, 0), first(count, -1);
  for (Index v = 0; v < static_cast<Index>(component.size()); ++v) {
    if (component[v] < 0) continue;
    if (size[component[v]]++ == 0) first[component[v]] = v;
  }
  Flags held(count, 0);
  for (const LoopPair& pair : pairs) held[component[pair.source.front()]] = 1;
  for (Index c = 0; c < count; ++c)
    if (!held[c])
      throw Error(facts::merge::ComponentWithoutPair{.component = c, .vertices = size[c], .vertex = first[c]});
}

LoopGeometry loop_geometry(const Mesh& mesh, const Points& vertex_normals, const std::vector<Index>& loop) {
  const Attribute* kept = mesh.find_attribute(Domain::vertex, cut_normal_name);
  const auto count = static_cast<Eigen::Index>(loop.size());
  LoopGeometry geometry{Points(count, 3), Points(count, 3)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Index v = loop[i];
    geometry.points.row(i) = mesh.positions.row(v);
    geometry.normals.row(i) = vertex_normals.row(v);
    if (kept == nullptr || kept->components != 3) continue;
    const Eigen::Map<const Eigen::RowVector3d> normal(kept->values.data() + std::ptrdiff_t{3} * v);
    if (normal.allFinite() && normal.norm() > 0) geometry.normals.row(i) = normal.normalized();
  }
  return geometry;
}

bool windings_disagree(const Mesh& target, const Mesh& source) {
  constexpr double clearly = 0.02;  // chosen, × the volume of a ball of the same area: more than a sheet has
  const double there = enclosed_volume(target), here = enclosed_volume(source);
  return std::min(there, here) < -clearly && std::max(there, here) > clearly;
}

namespace {

double mean_turn(const Points& loop) {
  const Eigen::Index count = loop.rows();
  double sum = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d before = (loop.row(i) - loop.row((i + count - 1) % count)).transpose(),
                          after = (loop.row((i + 1) % count) - loop.row(i)).transpose();
    sum += std::atan2(before.cross(after).norm(), before.dot(after));
  }
  return sum / static_cast<double>(count);
}

}  // namespace

Points smoothed_loop(const Points& loop) {
  // Alternates steps forwards and backwards (Taubin 1995), so that the loop does not shrink.
  constexpr int passes = 10;
  const Eigen::Index count = loop.rows();
  Points points = loop, next = loop;
  for (int pass = 0; pass < passes; ++pass) {
    for (const double step : {0.5, -0.53}) {
      for (Eigen::Index i = 0; i < count; ++i)
        next.row(i) =
            points.row(i) +
            step * ((points.row((i + count - 1) % count) + points.row((i + 1) % count)) / 2 - points.row(i));
      std::swap(points, next);
    }
  }
  return points;
}

double raggedness_deg(const Points& loop) {
  return std::max(0.0, (mean_turn(loop) - mean_turn(smoothed_loop(loop))) * 180 / std::numbers::pi);
}

double mean_edge_length(const Points& loop) {
  return LoopCurve(loop).length() / static_cast<double>(loop.rows());
}

}  // namespace meshgraft
