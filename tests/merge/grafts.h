#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/cut_halves.h"

/// Grafts of parts that were cut off, of a head on a bust, and of pegs on holes.
namespace meshgraft::test {

struct Graft {
  std::string name;
  Mesh target, source;
  std::vector<MergePair> pairs;
  bool closed = true;  // whether the joined mesh is closed
};

inline double diagonal(const Points& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

inline std::vector<MergePair> without_matches(const std::vector<LoopPair>& loops) {
  std::vector<MergePair> pairs;
  for (const LoopPair& pair : loops) pairs.push_back({pair, {}});
  return pairs;
}

/// Cuts a sample by a plane into a target below and a source above, to be grafted back.
inline Graft cut_sample(const std::string& sample, int resolution, const Eigen::Vector3d& point,
                        const Eigen::Vector3d& normal) {
  const Mesh whole = make_sample(sample, resolution);
  Graft graft{sample,
              cut_by_plane(whole, {point, normal}, {.keep = CutKeep::below}).mesh,
              cut_by_plane(whole, {point, normal}, {.keep = CutKeep::above}).mesh,
              {}};
  graft.pairs = without_matches(coinciding_loops(graft.target, graft.source));
  graft.closed = boundary_loops(whole).empty();
  return graft;
}

inline Graft head_on_bust(int resolution = 40) {
  Graft graft{"head on bust", make_sample("bust", resolution), make_sample("head", resolution), {}};
  graft.pairs = {{{boundary_loops(graft.source).at(0), boundary_loops(graft.target).at(0)}, {}}};
  return graft;
}

/// Returns a tube of radius 1 with `rows` rows of `around` vertices, closed above. Its loop lies at z = 0.
inline Mesh peg(Index rows, Index around) {
  Mesh mesh;
  mesh.positions.resize(rows * around + 1, 3);
  const auto angle = [&](Index k) { return 2 * std::numbers::pi * k / around; };
  for (Index r = 0; r < rows; ++r)
    for (Index k = 0; k < around; ++k)
      mesh.positions.row(r * around + k) << std::cos(angle(k)), std::sin(angle(k)), 2.0 * r / (rows - 1);
  const Index top = rows * around;
  mesh.positions.row(top) << 0, 0, 2;
  for (Index k = 0; k < around; ++k) {
    const Index next = (k + 1) % around;
    for (Index r = 0; r + 1 < rows; ++r)
      mesh.faces.push_back(
          std::vector<Index>{r * around + k, r * around + next, (r + 1) * around + next, (r + 1) * around + k});
    mesh.faces.push_back(std::vector<Index>{(rows - 1) * around + k, (rows - 1) * around + next, top});
  }
  return mesh;
}

/// Returns a plate with a hole around z, or a tube that is cut off at an angle. The hole has 32 vertices.
inline Mesh holed(double radius, double tilt_deg, bool plate) {
  constexpr Index around = 32, rows = 10;
  const double slope = std::tan(tilt_deg * std::numbers::pi / 180);
  Mesh mesh;
  mesh.positions.resize(rows * around, 3);
  for (Index r = 0; r < rows; ++r)
    for (Index k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around, way = plate ? radius * (1 + 0.3 * r) : radius;
      const double x = way * std::cos(angle), y = way * std::sin(angle);
      mesh.positions.row(r * around + k) << x, y,
          plate ? x * slope : x * slope * (rows - 1 - r) / (rows - 1) - 0.25 * radius * r;
    }
  for (Index r = 0; r + 1 < rows; ++r)
    for (Index k = 0; k < around; ++k) {
      const Index next = (k + 1) % around;
      mesh.faces.push_back(
          std::vector<Index>{r * around + k, (r + 1) * around + k, (r + 1) * around + next, r * around + next});
    }
  return mesh;
}

/// Returns the loop whose first vertex is 0.
inline std::vector<Index> first_loop(const Mesh& mesh) {
  for (std::vector<Index>& loop : boundary_loops(mesh))
    if (loop.front() == 0) return loop;
  return {};
}

}  // namespace meshgraft::test
