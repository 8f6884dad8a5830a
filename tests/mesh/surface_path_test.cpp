#include "mesh/cut/surface_path.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

struct PathSurface {
  Mesh mesh;
  EdgeTable table;
  SurfacePaths paths;

  explicit PathSurface(Mesh given)
      : mesh(std::move(given)),
        table(mesh.vertex_count(), mesh.faces),
        paths(mesh.positions, mesh.faces, table) {}
  PathSurface(const PathSurface&) = delete;

  Eigen::RowVector3d at(const EdgePoint& point) const {
    return (1 - point.t) * mesh.positions.row(point.from) + point.t * mesh.positions.row(point.to);
  }
  std::vector<EdgePoint> whole(Index from, Index to) const {
    std::vector<EdgePoint> points = paths.between(from, to);
    points.insert(points.begin(), {from, from, 0});
    points.push_back({to, to, 0});
    return points;
  }
  double length(const std::vector<EdgePoint>& points) const {
    double sum = 0;
    for (std::size_t k = 1; k < points.size(); ++k) sum += (at(points[k]) - at(points[k - 1])).norm();
    return sum;
  }
  bool in_one_face(const EdgePoint& a, const EdgePoint& b) const {
    for (Index f = 0; f < mesh.face_count(); ++f)
      if (std::ranges::all_of(std::array{a.from, a.to, b.from, b.to},
                              [&](Index v) { return std::ranges::count(mesh.faces[f], v) > 0; }))
        return true;
    return false;
  }
};

TEST(SurfacePaths, RunThroughFacesAndAreShorterThanEdges) {
  std::mt19937 random(1);
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const PathSurface surface(make_mesh(family.positions, family.triangles));
    const IndexLists rings = vertex_rings(family.size(), family.triangles);
    const auto corner = [&] {
      return surface.mesh.faces.corners()[random() % surface.mesh.faces.corner_count()];
    };
    for (int k = 0; k < 10; ++k) {
      const Index from = corner(), to = corner();
      if (from == to) continue;
      const auto points = surface.whole(from, to);
      for (std::size_t i = 1; i < points.size(); ++i) {
        EXPECT_TRUE(surface.in_one_face(points[i - 1], points[i])) << from << " to " << to;
        EXPECT_TRUE(points[i].from == points[i].to || (points[i].t > 0 && points[i].t < 1));
      }
      const double length = surface.length(points), rounding = 1e-9 * family.box_diagonal();
      EXPECT_LE(length, edge_distance(std::vector<Index>{from}, family.positions, rings)[to] + rounding);
      EXPECT_GE(length, (family.positions.row(from) - family.positions.row(to)).norm() - rounding);
      EXPECT_EQ(points.size() == 2, std::ranges::count(rings[from], to) > 0) << "along an edge";
    }
  }
}

TEST(SurfacePaths, AreStraightInThePlane) {
  constexpr int across = 9, up = 7;
  test::TestMesh sheet = test::flat_sheet(across, up);
  const double cell = 2.0 / across;
  for (Index v = 0; v < sheet.size(); ++v) {  // the border becomes a rectangle, which is convex
    const int column = v % (across + 1), row = v / (across + 1);
    if (column == 0 || column == across) sheet.positions(v, 0) = column * cell;
    if (row == 0 || row == up) sheet.positions(v, 1) = row * cell;
  }
  const PathSurface surface(make_mesh(sheet.positions, sheet.triangles));
  for (Index from = 0; from < sheet.size(); from += 7)
    for (Index to = 3; to < sheet.size(); to += 11)
      if (from != to) {
        EXPECT_NEAR(surface.length(surface.whole(from, to)),
                    (sheet.positions.row(from) - sheet.positions.row(to)).norm(), 1e-9);
      }
}

TEST(SurfacePaths, EndAtTheirComponent) {
  const test::TestMesh ball = test::icosphere(1);
  const Mesh one = make_mesh(ball.positions, ball.triangles);
  const PathSurface surface(test::both(one, one));
  EXPECT_NO_THROW(surface.paths.between(0, 20));
  try {
    surface.paths.between(0, ball.size() + 20);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "mesh.no_path");
  }
}

}  // namespace
}  // namespace meshgraft
