#include "twist.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "editor/facts.h"

namespace meshgraft::editor {

namespace {

/// A loop that begins at a given vertex, with the arc parameter of each vertex: its share of the length, 0 to
/// below 1.
struct LoopArcs {
  std::vector<Index> vertices;
  std::vector<double> arcs;
};

LoopArcs loop_from(const Mesh& mesh, Index first) {
  for (std::vector<Index>& loop : boundary_loops(mesh)) {
    const auto found = std::find(loop.begin(), loop.end(), first);
    if (found == loop.end()) continue;
    std::rotate(loop.begin(), found, loop.end());
    LoopArcs along{std::move(loop), {}};
    double length = 0;
    for (std::size_t i = 0; i < along.vertices.size(); ++i) {
      along.arcs.push_back(length);
      const Index next = along.vertices[(i + 1) % along.vertices.size()];
      length += (mesh.positions.row(next) - mesh.positions.row(along.vertices[i])).norm();
    }
    for (double& arc : along.arcs) arc /= length > 0 ? length : 1;
    return along;
  }
  throw Error(facts::editor::StartOffLoops{}, "twist");
}

double to_unit(double arc) { return arc - std::floor(arc); }

// Distance of two arc parameters along the shorter way round.
double distance(double a, double b) { return std::abs(a - b - std::round(a - b)); }

std::size_t nearest(const std::vector<double>& arcs, double arc) {
  const auto above = static_cast<std::size_t>(std::upper_bound(arcs.begin(), arcs.end(), arc) - arcs.begin());
  const std::size_t before = above - 1, after = above % arcs.size();  // arcs[0] is 0
  return distance(arcs[before], arc) <= distance(arcs[after], arc) ? before : after;
}

}  // namespace

Match twisted_start(const Mesh& source, const Mesh& target, const Match& start, double by_deg, bool mirrored) {
  const LoopArcs from = loop_from(source, start.source), to = loop_from(target, start.target);
  Match best = start;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < from.vertices.size(); ++i) {
    // Loops run in opposite directions, unless the source is mirrored.
    const double wanted = to_unit(by_deg / 360 + (mirrored ? from.arcs[i] : -from.arcs[i]));
    const std::size_t met = nearest(to.arcs, wanted);
    const double off = distance(to.arcs[met], wanted) + 1e-9 * distance(from.arcs[i], 0);
    if (off >= least) continue;
    least = off;
    best = {from.vertices[i], to.vertices[met]};
  }
  return best;
}

}  // namespace meshgraft::editor
