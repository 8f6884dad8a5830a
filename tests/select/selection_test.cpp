#include <meshgraft/select/selection.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <numeric>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "mesh/shapes.h"

namespace meshgraft {
namespace {

using Indices = std::vector<Index>;

std::shared_ptr<const Selection> share(Selection::Kind kind) { return std::make_shared<const Selection>(kind); }

class OnGrid : public testing::Test {
 protected:
  // The grid has 7×7 vertices in the plane z = 0, with index 7·y + x.
  const Mesh mesh = shapes::grid(6, 6);
  const SelectionMesh context{mesh};

  Indices select(Selection::Kind kind) const { return resolve(Selection(std::move(kind)), context, "roi"); }

  Indices where(const std::function<bool(int, int)>& inside) const {
    Indices vertices;
    for (Index v = 0; v < 49; ++v) {
      if (inside(v % 7, v / 7)) vertices.push_back(v);
    }
    return vertices;
  }

  void expect_error(Selection::Kind kind, const std::string& place, const std::string& id,
                    const std::string& part_of_problem = "") const {
    try {
      select(std::move(kind));
      ADD_FAILURE() << "no error, expected " << id;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_EQ(error.id(), id);
      EXPECT_EQ(error.location().text(), place);
      EXPECT_NE(error.problem().find(part_of_problem), std::string::npos) << error.problem();
    }
  }
};

TEST_F(OnGrid, AllSelectsEveryVertex) {
  EXPECT_EQ(select(Selection::All{}), where([](int, int) { return true; }));
}

TEST_F(OnGrid, IndicesKeepTheirOrderWithoutRepeats) {
  EXPECT_EQ(select(Selection::Indices{{9, 3, 9, 48, 3}}), (Indices{9, 3, 48}));
  expect_error(Selection::Indices{{0, 49}}, "roi.indices[1]", "core.no_such_vertex",
               "vertex 49 does not exist; the mesh has 49");
  expect_error(Selection::Indices{{-1}}, "roi.indices[0]", "core.no_such_vertex", "vertex -1");
}

TEST_F(OnGrid, BoxSphereAndHalfSpaceIncludeTheirBoundary) {
  EXPECT_EQ(select(Selection::Box{{1, 2, -1}, {3, 2, 1}}), (Indices{15, 16, 17}));
  EXPECT_EQ(select(Selection::Box{{1, 2, 0}, {3, 2, 0}}), (Indices{15, 16, 17}));
  EXPECT_EQ(select(Selection::Box{{0.1, 0.1, 0}, {0.9, 0.9, 0}}), Indices{});
  EXPECT_EQ(select(Selection::Sphere{{3, 3, 0}, 1}), (Indices{17, 23, 24, 25, 31}));
  EXPECT_EQ(select(Selection::HalfSpace{{{0, 5, 0}, {0, 9, 0}}}), where([](int, int y) { return y >= 5; }));
  expect_error(Selection::Box{{1, 0, 0}, {0, 1, 1}}, "roi.box", "select.box_reversed");
  expect_error(Selection::Box{{NAN, 0, 0}, {0, 1, 1}}, "roi.box.min", "core.not_finite");
  expect_error(Selection::Sphere{{0, 0, 0}, -1}, "roi.sphere.radius", "core.negative_or_not_finite");
  expect_error(Selection::HalfSpace{{{0, 0, 0}, {0, 0, 0}}}, "roi.half_space.normal",
               "core.normal_without_length");
}

TEST_F(OnGrid, NearestVertex) {
  EXPECT_EQ(select(Selection::NearestVertex{{2.2, 4.4, 3}}), Indices{30});
  EXPECT_EQ(select(Selection::NearestVertex{{0.5, 0.5, 0}}), Indices{0});  // four equals: the smallest
  expect_error(Selection::NearestVertex{{INFINITY, 0, 0}}, "roi.nearest", "core.not_finite");
}

TEST_F(OnGrid, GrowAndShrink) {
  const auto block = share(Selection::Box{{2, 2, 0}, {4, 4, 0}});
  EXPECT_EQ(select(Selection::Grow{block, 0}), select(block->kind));
  EXPECT_EQ(select(Selection::Grow{block, 1}), where([](int x, int y) {
              return std::max(std::abs(x - 3), std::abs(y - 3)) <= 2 && std::abs(x - 3) + std::abs(y - 3) <= 3;
            }));
  EXPECT_EQ(select(Selection::Grow{block, -1}), Indices{24});
  EXPECT_EQ(select(Selection::Grow{block, -2}), Indices{});
  EXPECT_EQ(select(Selection::Grow{block, std::numeric_limits<int>::min()}), Indices{});
  EXPECT_EQ(select(Selection::Grow{block, std::numeric_limits<int>::max()}).size(), 49);
  // Shrinking does not start from the boundary of the mesh.
  const auto upper = share(Selection::HalfSpace{{{0, 4, 0}, {0, 1, 0}}});
  EXPECT_EQ(select(Selection::Grow{upper, -1}), where([](int, int y) { return y >= 5; }));
  EXPECT_EQ(select(Selection::Grow{share(Selection::All{}), -3}).size(), 49);
}

TEST_F(OnGrid, GrowByLength) {
  const auto centre = share(Selection::Indices{{24}});
  const auto diamond = [&](double k) {
    return where([&](int x, int y) { return std::abs(x - 3) + std::abs(y - 3) <= k; });
  };
  for (const double length : {0.0, 0.9, 1.0, 2.5, 100.0}) {
    EXPECT_EQ(select(Selection::GrowLength{centre, length}), diamond(length));
  }
  expect_error(Selection::GrowLength{centre, -1}, "roi.grow_length.length", "core.negative_or_not_finite");
  expect_error(Selection::GrowLength{share(Selection::Indices{{99}}), 1}, "roi.grow_length.of.indices[0]",
               "core.no_such_vertex", "99");
}

TEST_F(OnGrid, Combinations) {
  const Selection left(Selection::HalfSpace{{{3, 0, 0}, {-1, 0, 0}}});
  const Selection low(Selection::HalfSpace{{{0, 3, 0}, {0, -1, 0}}});
  EXPECT_EQ(select(Selection::Union{{left, low}}), where([](int x, int y) { return x <= 3 || y <= 3; }));
  EXPECT_EQ(select(Selection::Intersect{{left, low}}), where([](int x, int y) { return x <= 3 && y <= 3; }));
  EXPECT_EQ(select(Selection::Minus{{left, low}}), where([](int x, int y) { return x <= 3 && y > 3; }));
  EXPECT_EQ(select(Selection::Minus{{left}}), select(left.kind));
  expect_error(Selection::Union{}, "roi.union", "select.no_selection");
  expect_error(Selection::Minus{{left, Selection(Selection::Sphere{{0, 0, 0}, NAN})}},
               "roi.minus[1].sphere.radius", "core.negative_or_not_finite");
  expect_error(Selection::Grow{nullptr, 1}, "roi.grow.of", "select.no_selection");
}

TEST_F(OnGrid, Rim) {
  const auto block = share(Selection::Box{{1, 1, 0}, {5, 5, 0}});
  EXPECT_EQ(select(Selection::Rim{block, 1}),
            where([](int x, int y) { return std::max(std::abs(x - 3), std::abs(y - 3)) == 2; }));
  EXPECT_EQ(select(Selection::Rim{block, 3}), select(block->kind));
  EXPECT_EQ(select(Selection::Rim{share(Selection::All{}), 2}), Indices{});
  expect_error(Selection::Rim{block, 0}, "roi.rim.rings", "select.no_rings");
}

TEST_F(OnGrid, MirrorIsSymmetric) {
  const Eigen::Vector3d centre(3, 3, 0), x_axis(-2, 0, 0);
  const auto part = share(Selection::Indices{{0, 8, 37, 24}});
  const auto image = share(Selection::Mirror{part, {centre, x_axis}});
  EXPECT_EQ(select(image->kind), (Indices{6, 12, 24, 39}));
  EXPECT_EQ(select(Selection::Mirror{image, {centre, x_axis}}), (Indices{0, 8, 24, 37}));
  // The mirror image of vertex 4 lies 0.1 beyond the edge of the mesh, within the wide tolerance only.
  const auto right = share(Selection::Indices{{4}});
  EXPECT_EQ(select(Selection::Mirror{right, {{5.05, 0, 0}, {1, 0, 0}}}), Indices{});
  EXPECT_EQ(select(Selection::Mirror{right, {{5.05, 0, 0}, {1, 0, 0}}, 0.1}), Indices{6});
  expect_error(Selection::Mirror{part, {centre, {0, 0, 0}}}, "roi.mirror.normal", "core.normal_without_length");
  expect_error(Selection::Mirror{part, {centre, x_axis}, -1}, "roi.mirror.tolerance_rel",
               "core.negative_or_not_finite");
}

void expect_path(const Indices& path, const SelectionMesh& context, bool closed) {
  EXPECT_EQ(std::set<Index>(path.begin(), path.end()).size(), path.size()) << "a vertex comes twice";
  for (std::size_t k = 0; k + (closed ? 0 : 1) < path.size(); ++k) {
    const auto ring = context.rings[path[k]];
    EXPECT_TRUE(std::binary_search(ring.begin(), ring.end(), path[(k + 1) % path.size()]));
  }
}

TEST_F(OnGrid, PathFollowsEdgesThroughItsPoints) {
  EXPECT_EQ(select(Selection::Path{{{0.1, 2.1, 0}, {4, 1.9, 0}}}), (Indices{14, 15, 16, 17, 18}));
  EXPECT_EQ(select(Selection::Path{{{4, 2, 0}, {0, 2, 0}}}), (Indices{18, 17, 16, 15, 14}));
  const Indices path = select(Selection::Path{{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {6, 6, 0}}});
  EXPECT_EQ(path.size(), 13);
  EXPECT_EQ(path.front(), 0);
  EXPECT_EQ(path.back(), 48);
  expect_path(path, context, false);
}

TEST_F(OnGrid, PathCountsSuccessivePointsAtOneVertexOnce) {
  EXPECT_EQ(select(Selection::Path{{{0, 0, 0}, {0.1, 0, 0}, {0.9, 0, 0}, {1.2, 0.2, 0}, {2, 0, 0}}}),
            (Indices{0, 1, 2}));
}

TEST_F(OnGrid, PathClosesWithoutRepeats) {
  const std::vector<Eigen::Vector3d> corners = {{1, 1, 0}, {5, 1, 0}, {5, 5, 0}, {1, 5, 0}};
  for (const bool repeat_first : {false, true}) {
    std::vector<Eigen::Vector3d> points = corners;
    if (repeat_first) points.push_back(corners[0]);
    const Indices path = select(Selection::Path{points, true});
    EXPECT_EQ(path.size(), 16);
    EXPECT_EQ(path.front(), 8);
    expect_path(path, context, true);
    const std::set<Index> expected = [&] {
      const auto ring = where([](int x, int y) { return std::max(std::abs(x - 3), std::abs(y - 3)) == 2; });
      return std::set<Index>(ring.begin(), ring.end());
    }();
    EXPECT_EQ(std::set<Index>(path.begin(), path.end()), expected);
  }
}

TEST_F(OnGrid, PathKeepsOffItsOtherLegs) {
  // The shortest path from the second to the third point would cross the first leg.
  const Indices path = select(Selection::Path{{{3, 0, 0}, {3, 4, 0}, {1, 2, 0}, {5, 2, 0}}});
  expect_path(path, context, false);
  for (const Index station : {3, 31, 15, 19})
    EXPECT_TRUE(std::find(path.begin(), path.end(), station) != path.end());
}

TEST_F(OnGrid, PathNamesWhatIsWrong) {
  expect_error(Selection::Path{{{0, 0, 0}}}, "roi.path.points", "select.path_too_short", "a path needs 2");
  expect_error(Selection::Path{{{0, 0, 0}, {0.1, 0, 0}}}, "roi.path.points", "select.path_too_short",
               "here are 1");
  expect_error(Selection::Path{{{0, 0, 0}, {2, 0, 0}}, true}, "roi.path.points", "select.path_too_short",
               "a closed path needs 3");
  expect_error(Selection::Path{{{0, 0, 0}, {2, 0, 0}, {0, 0, 0}}}, "roi.path.points[2]",
               "select.path_crosses_itself", "comes back to vertex 0");
  expect_error(Selection::Path{{{0, 0, 0}, {NAN, 0, 0}}}, "roi.path.points[1]", "core.not_finite");
  // The first leg spans the whole width at x = 3, so no path can cross it.
  expect_error(Selection::Path{{{3, 0, 0}, {3, 6, 0}, {0, 3, 0}, {6, 3, 0}}}, "roi.path",
               "select.no_way_along_edges", "there is no way");
}

TEST(SelectionOnParts, ComponentsAndLoops) {
  Mesh mesh = shapes::together({shapes::tube(5, 2), shapes::tube(8, 1)});
  shapes::add_vertex(mesh, {0, 0, 0.1});
  const SelectionMesh context(mesh);
  const auto select = [&](Selection::Kind kind) {
    return resolve(Selection(std::move(kind)), context, "fixed");
  };
  Indices second(16);
  std::iota(second.begin(), second.end(), 15);
  EXPECT_EQ(select(Selection::Component{1}), second);
  ASSERT_EQ(context.loops.size(), 4);
  for (Index k = 0; k < 4; ++k) EXPECT_EQ(select(Selection::Loop{k}), context.loops[k]);
  EXPECT_EQ(select(Selection::Loop{3}), (Indices{10, 14, 13, 12, 11}));  // in loop order, not ascending
  // The isolated vertex is nearest, but belongs to no face.
  EXPECT_NE(select(Selection::NearestVertex{{0, 0, 0.1}}), Indices{31});

  const auto message = [&](Selection::Kind kind) -> std::string {
    try {
      select(std::move(kind));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(
      message(Selection::Component{2}),
      "fixed.component: connected component 2 does not exist: the mesh has 2 connected components, numbered "
      "from 0");
  EXPECT_EQ(message(Selection::Loop{-1}),
            "fixed.loop: boundary loop -1 does not exist: the mesh has 4 boundary loops, numbered from 0");
}

TEST(SelectionOnParts, PathNeedsOneComponent) {
  Mesh far = shapes::tube(5, 2);
  far.positions.rowwise() += Eigen::RowVector3d(10, 0, 0);
  const Mesh mesh = shapes::together({shapes::tube(5, 2), far});
  const SelectionMesh context(mesh);
  EXPECT_THROW(resolve(Selection(Selection::Path{{{1, 0, 0}, {11, 0, 0}}}), context, "curve"), Error);
}

TEST(SelectionOnParts, AMeshWithoutFacesHasOnlyVertices) {
  Mesh points;
  points.positions = Points::Zero(3, 3);
  const SelectionMesh context(points);
  EXPECT_EQ(resolve(Selection(Selection::All{}), context, "roi").size(), 3);
  const auto expect_error = [&](Selection::Kind kind, const std::string& id) {
    try {
      resolve(Selection(std::move(kind)), context, "roi");
      ADD_FAILURE() << "no error, expected " << id;
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), id);
    }
  };
  expect_error(Selection::NearestVertex{{0, 0, 0}}, "select.no_vertex_with_face");
  expect_error(Selection::Component{0}, "select.no_vertex_with_face");
  expect_error(Selection::Path{{{0, 0, 0}, {1, 0, 0}}}, "select.no_vertex_with_face");
  expect_error(Selection::Loop{0}, "select.no_loops");
}

TEST(SelectionMirror, FindsTheOtherSideOfATorus) {
  const Mesh torus = shapes::torus(16, 9);
  const SelectionMesh context(torus);
  const auto upper = std::make_shared<const Selection>(Selection::Sphere{{3, 0, 0}, 1.5});
  const Eigen::Vector3d origin(0, 0, 0), normal(1, 0, 0);
  const Indices rest = resolve(*upper, context, "handle");
  ASSERT_GT(rest.size(), 5);
  const auto image = std::make_shared<const Selection>(Selection::Mirror{upper, {origin, normal}});
  EXPECT_EQ(resolve(*image, context, "handle"),
            resolve(Selection(Selection::Sphere{{-3, 0, 0}, 1.5}), context, "x"));
  EXPECT_EQ(resolve(Selection(Selection::Mirror{image, {origin, normal}}), context, "handle"), rest);
}

}  // namespace
}  // namespace meshgraft
