#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/cut_halves.h"
#include "merge/seam.h"
#include "mesh/shapes.h"
#include "support/mesh_families.h"

/// Meshes in two pieces whose loops meet, for tests of seams.
namespace meshgraft::test {

struct Graft {
  std::string name;
  Mesh target, source;
  std::vector<LoopPair> pairs;
  Index euler_characteristic = 0;
  bool closed = false;
};

/// Returns a mesh in two pieces, to be joined again.
inline Graft cut_in_two(const std::string& name, const Mesh& mesh, const Eigen::RowVector3d& normal,
                        double offset) {
  Graft graft{name, side_of_plane(mesh, normal, offset, false), side_of_plane(mesh, normal, offset, true), {}};
  graft.pairs = coinciding_loops(graft.target, graft.source);
  const TopologySummary whole = summarise_topology(mesh);
  graft.euler_characteristic = whole.euler_characteristic;
  graft.closed = whole.closed;
  return graft;
}

/// Returns point k of `around` points that divide a regular polygon inscribed in the unit circle evenly.
inline Eigen::RowVector3d on_polygon(int k, int around, int corners, double z) {
  const double place = static_cast<double>(k) * corners / around;
  const auto corner = [&](double i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    return Eigen::RowVector3d(std::cos(angle), std::sin(angle), z);
  };
  const double t = place - std::floor(place);
  return (1 - t) * corner(std::floor(place)) + t * corner(std::floor(place) + 1);
}

/// Returns a tube on the upper end of another one, with different numbers of vertices around.
inline Graft tubes(int target_around, int source_around, bool triangles) {
  Graft graft{std::to_string(source_around) + " on " + std::to_string(target_around), {}, {}, {}, 0, false};
  graft.target = shapes::tube(target_around, 6, triangles);
  graft.target.positions.col(2) *= 2 * std::numbers::pi / target_around;
  graft.source = shapes::tube(source_around, 6, triangles);
  graft.source.positions.col(2) *= 2 * std::numbers::pi / source_around;
  const double top = graft.target.positions.col(2).maxCoeff();
  graft.source.positions.col(2).array() += top;
  LoopPair pair;
  for (int k = 0; k < source_around; ++k) {
    pair.source.push_back(k);
    graft.source.positions.row(k) = on_polygon(k, source_around, target_around, top);
  }
  for (int k = target_around - 1; k >= 0; --k) pair.target.push_back(6 * target_around + k);
  graft.pairs = {pair};
  return graft;
}

inline std::vector<Graft> grafts() {
  const TestMesh sphere = icosphere(3), bar = test::bar(6, 24);
  const Mesh closed_bar = make_mesh(bar.positions, bar.triangles);
  Eigen::Index longest = 0;
  (bar.positions.colwise().maxCoeff() - bar.positions.colwise().minCoeff()).maxCoeff(&longest);
  const Eigen::RowVector3d along = Eigen::RowVector3d::Unit(longest);
  return {cut_in_two("tube of quads", shapes::tube(24, 12), {0, 0, 1}, 6),
          cut_in_two("tube of triangles", shapes::tube(24, 12, true), {0, 0, 1}, 6),
          cut_in_two("torus, two pairs", shapes::torus(40, 16, true), {0.3, 1, 0}, 0.02),
          cut_in_two("torus of quads, two pairs", shapes::torus(40, 16), {0, 1, 0}, 0.02),
          cut_in_two("sphere", make_mesh(sphere.positions, sphere.triangles), {0.1, 0.2, 1}, 0.2),
          cut_in_two("bar", closed_bar, along, closed_bar.positions.col(longest).mean() + 0.01),
          cut_in_two("sample cylinder", make_sample("cylinder", 40), {0, 0, 1}, 2),
          cut_in_two("sample torus", make_sample("torus", 40), {1, 0.2, 0}, 0.05),
          tubes(17, 68, true),
          tubes(17, 128, false),
          tubes(64, 16, true),
          tubes(24, 24, false)};
}

inline bool same_positions(const Points& a, const Points& b) { return a.rows() == b.rows() && a == b; }

}  // namespace meshgraft::test
