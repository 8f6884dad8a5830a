#include "merge/reduce_folds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "merge/seam_scenes.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

constexpr double fold_bound_deg = 30;

/// A patch with the flags of the vertices that may move: those on the strip and one ring around it.
struct FoldScene {
  std::string name;
  SeamPatch patch;
  Flags may_move;

  explicit FoldScene(const test::SeamScene& scene)
      : name(scene.name), patch(make_seam_patch(scene.mesh, scene.layout, 4)) {
    for (std::size_t v = 0; v < patch.vertex.size(); ++v)
      may_move.push_back(patch.ring[v] <= 2 && !patch.on_border[v]);
  }
  Points reduced(double largest_deg = fold_bound_deg) const {
    Points points = patch.points;
    reduce_folds(points, patch, largest_deg, may_move, {});
    return points;
  }
};

std::vector<FoldScene> fold_scenes(double noise) {
  std::vector<FoldScene> scenes;
  for (const test::SeamScene& scene : test::seam_scenes(noise)) scenes.emplace_back(scene);
  return scenes;
}

bool is_strip_edge(const SeamPatch& patch, const SeamEdge& edge) {
  return patch.side[edge.triangles[0]] == SeamSide::strip || patch.side[edge.triangles[1]] == SeamSide::strip;
}

double largest_fold_deg(SeamPatch patch, const Points& points) {
  patch.points = points;
  double largest = 0;
  for (const SeamEdge& edge : inner_edges(patch))
    if (is_strip_edge(patch, edge)) largest = std::max(largest, edge.dihedral_deg);
  return largest;
}

double harmonic_index(const Points& points, const Triangles& triangles, Eigen::Index t) {
  const Eigen::RowVector3d a = points.row(triangles(t, 0)), b = points.row(triangles(t, 1)),
                           c = points.row(triangles(t, 2));
  return ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm()) /
         (2 * (b - a).cross(c - a).norm());
}

/// Computes the cost that the header states, with a constant bound for the strip's edges.
double fold_cost_of(const SeamPatch& patch, const Points& points, double largest_deg) {
  SeamPatch moved = patch;
  moved.points = points;
  const std::vector<SeamEdge> before = inner_edges(patch), now = inner_edges(moved);
  std::vector<double> brought(patch.vertex.size(), largest_deg);
  for (const SeamEdge& edge : before)
    if (!is_strip_edge(patch, edge))
      for (const Index v : edge.ends) brought[v] = std::max(brought[v], edge.dihedral_deg);
  double cost = 0;
  for (std::size_t e = 0; e < now.size(); ++e) {
    const double accepted = is_strip_edge(patch, now[e])
                                ? std::min(brought[now[e].ends[0]], brought[now[e].ends[1]])
                                : std::max(largest_deg, before[e].dihedral_deg);
    cost += std::pow(std::max(0.0, now[e].dihedral_deg - accepted) * std::numbers::pi / 180, 2);
  }
  for (Eigen::Index t = 0; t < patch.triangles.rows(); ++t) {
    const double accepted = std::max(3.5, harmonic_index(patch.points, patch.triangles, t));
    cost += std::pow(std::max(0.0, harmonic_index(points, patch.triangles, t) - accepted), 2);
  }
  return cost;
}

TEST(ReduceFolds, LowersItsCostAndTheSharpestFold) {
  int reduced = 0;
  for (const double noise : {0.0, 0.3, 0.6, 1.0})
    for (const FoldScene& scene : fold_scenes(noise)) {
      SCOPED_TRACE(scene.name);
      const Points points = scene.reduced();
      const double before = fold_cost_of(scene.patch, scene.patch.points, fold_bound_deg),
                   after = fold_cost_of(scene.patch, points, fold_bound_deg);
      EXPECT_LE(after, before * (1 + 1e-9));
      const double was = largest_fold_deg(scene.patch, scene.patch.points),
                   is = largest_fold_deg(scene.patch, points);
      if (was < 80) {
        EXPECT_LE(is, was + 1e-9);
      }  // a sum of squares may trade one very sharp fold for others
      reduced += is < 0.8 * was;
    }
  EXPECT_GT(reduced, 4);
}

TEST(ReduceFolds, MovesOnlyWhatMayMove) {
  for (const FoldScene& scene : fold_scenes(0.8)) {
    const Points points = scene.reduced();
    for (Index v = 0; v < static_cast<Index>(points.rows()); ++v)
      if (!scene.may_move[v]) {
        EXPECT_EQ(points.row(v), scene.patch.points.row(v)) << scene.name;
      }
    FoldScene fixed = scene;
    std::fill(fixed.may_move.begin(), fixed.may_move.end(), std::uint8_t{0});
    EXPECT_TRUE(test::same_bytes(fixed.reduced(), scene.patch.points)) << scene.name;
  }
}

TEST(ReduceFolds, LeavesAStripWithoutFoldsAlone) {
  for (const FoldScene& scene : fold_scenes(0.4)) {
    const double bound = largest_fold_deg(scene.patch, scene.patch.points) + 1e-6;
    EXPECT_TRUE(test::same_bytes(scene.reduced(bound), scene.patch.points)) << scene.name;
  }
}

TEST(ReduceFolds, ACreaseMayContinueAcrossTheStrip) {
  // A square pipe: its four edges run along it, and across the strip. With whole coordinates all of them are
  // bent by exactly 90°, so that rounding makes no edge of the strip sharper than those beside it.
  test::SeamScene scene = test::round_seam("pipe", 4, 8, 0, [](double h) { return std::pair(1.0, h); });
  for (Index v = 0; v < scene.mesh.vertex_count(); ++v)
    scene.mesh.positions.row(v) << (v % 4 == 0 || v % 4 == 3 ? 1 : -1), (v % 4 < 2 ? 1 : -1), v / 4;
  const FoldScene square(scene);
  EXPECT_NEAR(largest_fold_deg(square.patch, square.patch.points), 90, 1e-9);
  EXPECT_TRUE(test::same_bytes(square.reduced(), square.patch.points));
}

TEST(ReduceFolds, TheUnitDoesNotMatter) {
  for (FoldScene scene : fold_scenes(0.8)) {
    const Points points = scene.reduced();
    scene.patch.points *= 1024;
    EXPECT_TRUE(test::same_bytes(scene.reduced(), 1024 * points)) << scene.name;
  }
}

}  // namespace
}  // namespace meshgraft
