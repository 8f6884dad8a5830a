#include "merge/pose_by_boundary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "merge/loop_pairs.h"
#include "mesh/shapes.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

/// A source of several components, each with one pair or two, and a vertex that belongs to none.
struct PosedParts {
  Points positions;
  std::vector<Index> component;
  std::vector<PairGeometry> pairs;
  std::vector<Correspondence> correspondences;

  bool has_pair(Index v) const {
    for (const PairGeometry& pair : pairs)
      if (component[pair.loops.source.front()] == component[v]) return true;
    return false;
  }
};

/// Pairs each loop with its copy, mapped by the map of its component. `bend` is how far the copy differs from a
/// similar loop. The last component has no pair.
PosedParts posed_parts(const std::vector<Eigen::Affine3d>& maps, double bend) {
  const test::TestMesh first = test::tube(12, 5), second = test::irregular_grid(9, 6), third = test::tube(9, 3);
  Mesh mesh = shapes::together({make_mesh(first.positions, first.triangles),
                                make_mesh(second.positions, second.triangles),
                                make_mesh(third.positions, third.triangles)});
  shapes::add_vertex(mesh, {1, 2, 3});
  PosedParts parts{mesh.positions, connected_components(mesh), {}, {}};
  const Points normals = vertex_normals(mesh);
  for (const std::vector<Index>& loop : boundary_loops(mesh)) {
    const Index number = parts.component[loop.front()];
    if (number == 2) continue;
    LoopGeometry source{mesh.positions(loop, Eigen::all), normals(loop, Eigen::all)};
    LoopGeometry target = test::reversed_loop(source);
    for (Index k = 0; k < static_cast<Index>(target.points.rows()); ++k)
      target.points.row(k) += bend * Eigen::RowVector3d(std::sin(k), std::cos(2 * k), std::sin(3 * k + 1));
    Correspondence correspondence;
    for (std::size_t i = 0; i < loop.size(); ++i)
      correspondence.loop_parameter.push_back(static_cast<double>(loop.size() - 1 - i));
    parts.pairs.push_back({{loop, {}}, std::move(source), test::mapped_loop(target, maps[number]), ""});
    parts.correspondences.push_back(correspondence);
  }
  return parts;
}

/// Moves the source of one component by a similarity.
void move_component(PosedParts& parts, Index number, const Eigen::Affine3d& map) {
  for (Index v = 0; v < static_cast<Index>(parts.component.size()); ++v)
    if (parts.component[v] == number)
      parts.positions.row(v) = (map * Eigen::Vector3d(parts.positions.row(v).transpose())).transpose();
  for (PairGeometry& pair : parts.pairs)
    if (parts.component[pair.loops.source.front()] == number) pair.source = test::mapped_loop(pair.source, map);
}

Points posed_points(PosedParts& parts, std::optional<double> size = {}) {
  return pose_by_boundary(parts.positions, parts.component, parts.pairs, parts.correspondences, size);
}

TEST(PoseByBoundary, FindsTheSimilarityOfEachComponent) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const std::vector<Eigen::Affine3d> chosen{maps[k], maps[(k + 1) % maps.size()]};
    PosedParts parts = posed_parts(chosen, 0);
    const Points before = parts.positions, posed = posed_points(parts);
    for (Index v = 0; v < static_cast<Index>(before.rows()); ++v) {
      if (!parts.has_pair(v)) {
        EXPECT_EQ(posed.row(v), before.row(v));  // without a pair nothing moves
        continue;
      }
      const Eigen::Affine3d& map = chosen[parts.component[v]];
      const Eigen::Vector3d expected = map * Eigen::Vector3d(before.row(v).transpose());
      EXPECT_LT((posed.row(v).transpose() - expected).norm(), 1e-9 * map.linear().norm());
    }
  }
}

TEST(PoseByBoundary, DoesNotDependOnTheSourcesPose) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  for (const double bend : {0.0, 0.03, 0.2}) {
    PosedParts given = posed_parts(maps, bend);
    const Points expected = posed_points(given);
    for (std::size_t k = 0; k < maps.size(); ++k) {
      PosedParts moved = posed_parts(maps, bend);
      move_component(moved, 0, maps[k]);
      move_component(moved, 1, maps[(k + 1) % maps.size()].inverse());
      const Points posed = posed_points(moved);
      EXPECT_LT(test::largest_distance(posed, expected), 1e-9 * expected.norm()) << bend;
    }
  }
}

TEST(PoseByBoundary, FollowsTheTarget) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  const std::vector<Eigen::Affine3d> none(2, Eigen::Affine3d::Identity());
  PosedParts unmoved = posed_parts(none, 0.1);
  const Points expected = posed_points(unmoved);
  for (const Eigen::Affine3d& map : maps) {
    PosedParts moved = posed_parts({map, map}, 0.1);
    const Points posed = posed_points(moved);
    for (Index v = 0; v < static_cast<Index>(posed.rows()); ++v)
      if (moved.has_pair(v)) {
        EXPECT_LT((posed.row(v) - test::mapped(expected.row(v), map)).norm(), 1e-9 * map.linear().norm());
      }
  }
}

TEST(PoseByBoundary, TakesTheGivenSize) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  for (const double size : {0.2, 1.0, 3.0}) {
    PosedParts free = posed_parts(maps, 0.05), sized = posed_parts(maps, 0.05);
    const Points rest = free.positions, found = posed_points(free), posed = posed_points(sized, size);
    for (Index v = 1; v < static_cast<Index>(rest.rows()); ++v) {
      if (!sized.has_pair(v) || sized.component[v] != sized.component[v - 1]) continue;
      const Eigen::RowVector3d before = rest.row(v) - rest.row(v - 1), after = posed.row(v) - posed.row(v - 1),
                               freely = found.row(v) - found.row(v - 1);
      EXPECT_NEAR(after.norm(), size * before.norm(), 1e-10 * size);
      EXPECT_LT((after.normalized() - freely.normalized()).norm(), 1e-9);  // the rotation is the same
    }
  }
}

TEST(PoseByBoundary, MovesTheSourceLoopsAlong) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  for (const std::optional<double> size : {std::optional<double>(), std::optional(0.5)}) {
    const PosedParts before = posed_parts(maps, 0.05);
    PosedParts parts = before;
    const Points posed = posed_points(parts, size);
    for (std::size_t p = 0; p < parts.pairs.size(); ++p) {
      const PairGeometry &now = parts.pairs[p], &then = before.pairs[p];
      EXPECT_EQ(now.source.points, Points(posed(now.loops.source, Eigen::all)));
      EXPECT_EQ(now.target.points, then.target.points);
      EXPECT_EQ(now.target.normals, then.target.normals);
      // Normals turn like edges do: angles between them stay, and lengths stay 1.
      for (Eigen::Index k = 0; k + 1 < now.source.points.rows(); ++k) {
        const auto cosine = [k](const LoopGeometry& loop) {
          return loop.normals.row(k).dot((loop.points.row(k + 1) - loop.points.row(k)).normalized());
        };
        EXPECT_NEAR(now.source.normals.row(k).norm(), 1, 1e-12);
        EXPECT_NEAR(cosine(now.source), cosine(then.source), 1e-9);
      }
    }
  }
}

TEST(PoseByBoundary, DoesNotDependOnTheOrderOfPairs) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  PosedParts parts = posed_parts(maps, 0.1), reversed = posed_parts(maps, 0.1);
  std::ranges::reverse(reversed.pairs);
  std::ranges::reverse(reversed.correspondences);
  const Points expected = posed_points(parts);
  EXPECT_LT(test::largest_distance(posed_points(reversed), expected), 1e-11 * expected.norm());
}

}  // namespace
}  // namespace meshgraft
