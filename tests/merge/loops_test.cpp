#include "merge/loops.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "merge/closed_curves.h"
#include "mesh/shapes.h"

namespace meshgraft {
namespace {

std::string id_of(const Mesh& mesh, const std::vector<Index>& listed) {
  try {
    checked_loop(mesh, facts::merge::Side::source, listed);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    return std::string(error.id());
  }
  return "nothing was refused";
}

TEST(CheckedLoop, RunsAlongHalfEdgesFromTheFirstListedVertex) {
  for (const Mesh& mesh : {shapes::tube(9, 3), shapes::grid(5, 4), shapes::tube(6, 2, true)})
    for (const std::vector<Index>& loop : boundary_loops(mesh))
      for (std::size_t start = 0; start < loop.size(); ++start) {
        std::vector<Index> listed = loop;
        std::rotate(listed.begin(), listed.begin() + static_cast<std::ptrdiff_t>(start), listed.end());
        EXPECT_EQ(checked_loop(mesh, facts::merge::Side::source, listed), listed);
        std::vector<Index> backwards = listed;
        std::reverse(backwards.begin() + 1, backwards.end());
        EXPECT_EQ(checked_loop(mesh, facts::merge::Side::source, backwards), listed);
      }
}

TEST(CheckedLoop, RefusesWhatIsNotOneWholeLoopInOrder) {
  const Mesh tube = shapes::tube(6, 3);
  const auto loops = boundary_loops(tube);
  std::vector<Index> part(loops[0].begin(), loops[0].end() - 1), mixed = loops[0], shuffled = loops[0];
  mixed[2] = loops[1][0];
  std::swap(shuffled[1], shuffled[3]);
  EXPECT_EQ(id_of(tube, part), "merge.loop_not_listed_whole");
  EXPECT_EQ(id_of(tube, mixed), "merge.vertices_of_two_loops");
  EXPECT_EQ(id_of(tube, shuffled), "merge.loop_not_listed_in_order");
  EXPECT_EQ(id_of(tube, {8}), "merge.vertex_not_on_boundary");
  EXPECT_EQ(id_of(tube, {-1}), "merge.no_such_vertex");
  EXPECT_EQ(id_of(tube, {}), "merge.no_loop_named");
  EXPECT_EQ(id_of(shapes::cube(), {0}), "merge.no_boundary_loop");
  EXPECT_EQ(id_of(shapes::bow_tie(), {2}), "merge.boundary_touches_itself");
  Mesh point = tube;
  for (const Index v : loops[0]) point.positions.row(v) << 1, 2, 3;
  EXPECT_EQ(id_of(point, loops[0]), "merge.loop_without_length");
  point.positions(loops[0][1], 0) = std::nan("");
  EXPECT_EQ(id_of(point, loops[0]), "merge.vertex_not_finite");
}

TEST(CheckedLoops, AreOfDifferentPairs) {
  const Mesh tube = shapes::tube(6, 3);
  const auto loops = boundary_loops(tube);
  const std::vector<MergePair> both{{{loops[0], loops[1]}, {}}, {{loops[1], loops[0]}, {}}};
  const auto checked = checked_loops(tube, tube, both);
  ASSERT_EQ(checked.size(), 2U);
  EXPECT_EQ(checked[1].source, loops[1]);
  const std::vector<MergePair> twice{{{loops[0], loops[1]}, {}}, {{loops[0], loops[0]}, {}}};
  EXPECT_THROW(checked_loops(tube, tube, twice), Error);
  EXPECT_THROW(checked_loops(tube, tube, {}), Error);
  EXPECT_TRUE(pair_location(0, 1).empty());
  EXPECT_NE(pair_location(2, 3), pair_location(1, 3));
}

TEST(HeldComponents, AreAllThatHaveFaces) {
  Mesh two = shapes::together({shapes::tube(6, 2), shapes::tube(5, 2)});
  shapes::add_vertex(two, {9, 9, 9});  // isolated: it needs no pair
  const auto loops = boundary_loops(two);
  std::vector<LoopPair> pairs;
  for (const auto& loop : loops) pairs.push_back({loop, {}});
  EXPECT_NO_THROW(require_held_components(connected_components(two), pairs));
  std::erase_if(pairs, [](const LoopPair& pair) { return pair.source.size() == 5; });
  EXPECT_THROW(require_held_components(connected_components(two), pairs), Error);
}

TEST(LoopGeometry, PrefersTheNormalsOfTheUncutSurface) {
  Mesh tube = shapes::tube(6, 3);
  const Points estimated = Points::Constant(tube.vertex_count(), 3, 0.5);
  const auto loop = boundary_loops(tube)[0];
  const LoopGeometry plain = loop_geometry(tube, estimated, loop);
  EXPECT_EQ(plain.normals, estimated.topRows(6));
  for (Eigen::Index k = 0; k < 6; ++k) EXPECT_EQ(plain.points.row(k), tube.positions.row(loop[k]));
  Attribute kept{.name = std::string(cut_normal_name), .components = 3};
  kept.values.assign(static_cast<std::size_t>(3 * tube.vertex_count()), std::nan(""));
  for (int c = 0; c < 3; ++c) kept.values[3 * loop[2] + c] = c == 1 ? 4.0 : 0.0;
  tube.attributes.push_back(kept);
  const LoopGeometry known = loop_geometry(tube, estimated, loop);
  EXPECT_EQ(known.normals.row(2), Eigen::RowVector3d::UnitY());  // of unit length
  EXPECT_EQ(known.normals.row(3), estimated.row(3));             // missing here
}

TEST(Windings, DisagreeWhereOneMeshClearlyFacesInward) {
  const Mesh cube = shapes::cube();
  Mesh inward = cube;
  inward.faces = {};
  for (Index f = 0; f < cube.face_count(); ++f)
    inward.faces.push_back(std::vector<Index>(cube.faces[f].rbegin(), cube.faces[f].rend()));
  EXPECT_FALSE(windings_disagree(cube, cube));
  EXPECT_FALSE(windings_disagree(inward, inward));
  EXPECT_TRUE(windings_disagree(cube, inward));
  EXPECT_TRUE(windings_disagree(inward, cube));
  EXPECT_FALSE(windings_disagree(shapes::grid(3, 3), inward));  // a sheet has no inside
}

TEST(SmoothedLoop, KeepsSmoothLoopsAndCalmsRaggedOnes) {
  for (const test::ClosedCurve& curve : test::closed_curves()) {
    if (curve.size() < 40) continue;
    SCOPED_TRACE(curve.name);
    Points ragged = curve.points;
    for (Index k = 0; k < curve.size(); ++k) ragged.row(k) *= k % 2 == 0 ? 1.05 : 0.95;
    const Points calm = smoothed_loop(ragged);
    EXPECT_GT(raggedness_deg(ragged), 10);
    EXPECT_LT(raggedness_deg(calm), 0.3 * raggedness_deg(ragged));
    EXPECT_LT(raggedness_deg(curve.points), 5);
    EXPECT_LT((calm.colwise().mean() - ragged.colwise().mean()).norm(),
              1e-12);  // it neither drifts nor shrinks
    EXPECT_NEAR((calm.rowwise() - calm.colwise().mean()).rowwise().norm().mean(),
                (curve.points.rowwise() - curve.points.colwise().mean()).rowwise().norm().mean(), 0.03);
    for (const Eigen::Affine3d& map : test::similarities()) {
      EXPECT_LT((smoothed_loop(test::mapped(ragged, map)) - test::mapped(calm, map)).norm(), 1e-9);
      EXPECT_NEAR(raggedness_deg(test::mapped(ragged, map)), raggedness_deg(ragged), 1e-6);
    }
  }
}

TEST(MeanEdgeLength, IsTheLengthPerEdge) {
  Points square(4, 3);
  square << 0, 0, 0, 3, 0, 0, 3, 1, 0, 0, 1, 0;
  EXPECT_EQ(mean_edge_length(square), 2);
  for (const test::ClosedCurve& curve : test::closed_curves())
    for (const Eigen::Affine3d& map : test::similarities()) {
      const double scale = std::cbrt(map.linear().determinant());
      EXPECT_NEAR(mean_edge_length(test::mapped(curve.points, map)), scale * mean_edge_length(curve.points),
                  1e-9 * scale)
          << curve.name;
    }
}

}  // namespace
}  // namespace meshgraft
