#include "merge/footprint.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "merge/drop_scenes.h"

namespace meshgraft {
namespace {

std::shared_ptr<const Chart> chart_at(std::shared_ptr<const Mesh> mesh, const Drop& drop, double radius) {
  PreparedTarget target(std::move(mesh), {});
  SurfacePoint point = find_surface_point(target, drop);
  return std::make_shared<const Chart>(make_chart(std::move(target), std::move(point), radius, {}));
}

/// An outline on a target.
struct FootprintCase {
  std::shared_ptr<const Chart> chart;
  Placement placement;
  Footprint footprint;

  FootprintCase(const test::TestMesh& mesh, Index vertex, const FlatLoop& loop, double size,
                double spin_deg = 0) {
    const Drop drop{vertex};
    chart = chart_at(test::shared_mesh(mesh), drop, 1.5 * size * loop.outline.reach());
    placement = place_outline(chart->target, chart->point, loop, size, spin_deg);
    footprint = lay_outline(*chart, loop.outline, size, placement);
  }
  std::string obstacle(double size) const {
    const auto note = find_obstacle(chart->target, footprint, size);
    return note ? std::string(note->id()) : "none";
  }
};

Index middle_of(const test::TestMesh& mesh) {
  Index best = 0;
  const Eigen::RowVector3d middle = mesh.positions.colwise().mean();
  (mesh.positions.rowwise() - middle).rowwise().norm().minCoeff(&best);
  return best;
}

TEST(Footprint, OnAPlaneIsTheOutline) {
  const test::TestMesh sheet = test::flat_sheet(40, 40);
  const Index v = middle_of(sheet);
  for (const FlatLoop& loop : test::flat_loops())
    for (const double spin : {0.0, 35.0}) {
      const FootprintCase test(sheet, v, loop, 1.5, spin);
      const Eigen::RowVector3d second = test.placement.normal.cross(test.placement.first_axis);
      for (Index w = 0; w < sheet.size(); ++w) {
        const Eigen::RowVector3d p = sheet.positions.row(w) - sheet.positions.row(v);
        const Eigen::RowVector2d uv(p.dot(test.placement.first_axis), p.dot(second));
        const double distance = test.footprint.scale * loop.outline.signed_distance(uv / test.footprint.scale);
        if (std::abs(distance) < 1e-9) continue;
        EXPECT_EQ(test.footprint.is_inside(w), distance < 0);
        if (test.footprint.is_inside(w)) {
          EXPECT_NEAR(test.footprint.values[w], distance, 1e-9);
        }
      }
      EXPECT_EQ(test.obstacle(1.5), "none");
    }
}

TEST(Footprint, IsAsWideAsItsOutlineAlsoOnCurvedSurfaces) {
  for (const test::TestMesh& mesh : {test::icosphere(4), test::flat_sheet(40, 40), test::bumpy_sphere(4)})
    for (const FlatLoop& loop : test::flat_loops())
      for (const double size : {1.0, 2.0}) {
        const FootprintCase test(mesh, mesh.name == "flat sheet" ? middle_of(mesh) : 100, loop, size);
        EXPECT_NEAR(width_of(test.chart->target, test.footprint), size * loop.outline.width(),
                    0.05 * size * loop.outline.width())
            << mesh.name;
        EXPECT_LE(test.footprint.scale, most_widened * size * (1 + 1e-12));
      }
}

TEST(Footprint, InsideIsConnectedAndHasNegativeValues) {
  for (const test::TestMesh& mesh : {test::icosphere(3), test::torus(20, 40), test::irregular_grid(30, 20)})
    for (const FlatLoop& loop : test::flat_loops()) {
      const FootprintCase test(mesh, mesh.size() / 2, loop, 1.5);
      const auto& inside = test.footprint.inside;
      ASSERT_FALSE(inside.empty()) << mesh.name;
      for (const Index v : inside) {
        EXPECT_TRUE(test.footprint.is_inside(v));
        const auto ring = test.chart->target.rings[v];
        if (inside.size() > 1) {
          EXPECT_TRUE(
              std::any_of(ring.begin(), ring.end(), [&](Index w) { return test.footprint.is_inside(w); }));
        }
      }
      EXPECT_EQ(
          static_cast<std::size_t>(std::count_if(test.footprint.values.begin(), test.footprint.values.end(),
                                                 [](double value) { return value < 0; })),
          inside.size());
    }
}

TEST(Footprint, NamesWhatIsInTheWay) {
  const FlatLoop loop = test::flat_loops()[0];
  const test::TestMesh sheet = test::flat_sheet(20, 20), sphere = test::icosphere(3);
  EXPECT_EQ(FootprintCase(sheet, middle_of(sheet), loop, 1).obstacle(1), "none");
  EXPECT_EQ(FootprintCase(sheet, 21 * 10 + 1, loop, 1.5).obstacle(1.5), "merge.hole_reaches_boundary");
  // Around a vertex there is always that vertex, but not where the outline lies within a triangle.
  const FlatLoop off = test::flat_loop_of((0.01 * test::closed_curves()[2].points).rowwise() +
                                          Eigen::RowVector3d(0.05, 0.03, 0));
  EXPECT_EQ(FootprintCase(sheet, middle_of(sheet), off, 1).obstacle(1), "merge.loop_smaller_than_faces");
  EXPECT_EQ(FootprintCase(sphere, 0, loop, 60).obstacle(60), "merge.loop_larger_than_surface");
}

TEST(RefineAround, HalvesUntilEdgesNearTheOutlineAreShort) {
  for (const test::TestMesh& mesh : {test::icosphere(2), test::flat_sheet(12, 12)}) {
    SCOPED_TRACE(mesh.name);
    const FlatLoop loop = test::flat_loops()[0];
    const Index v = mesh.name == "icosphere" ? 0 : middle_of(mesh);
    constexpr double longest = 0.05;
    FootprintCase test(mesh, v, loop, 2);
    std::shared_ptr<const Mesh> fine;
    int halvings = 0;
    for (; halvings < 12; ++halvings) {
      const auto refined = refine_around(test.chart->target.mesh, test.footprint, longest, {});
      if (!refined) break;
      fine = std::make_shared<const Mesh>(refined->mesh);
      EXPECT_EQ(fine->positions.topRows(mesh.size()), mesh.positions);  // the old vertices stay
      test.chart = chart_at(fine, {v}, 3 * loop.outline.reach());
      test.footprint = lay_outline(*test.chart, loop.outline, 2, test.placement);
    }
    EXPECT_GT(halvings, 0);
    EXPECT_LT(halvings, 12);
    for (Index a = 0; a < fine->vertex_count(); ++a)
      for (const Index b : test.chart->target.rings[a]) {
        if (!test.footprint.uv.row(a).allFinite() || !test.footprint.uv.row(b).allFinite()) continue;
        if (test.footprint.is_inside(a) != test.footprint.is_inside(b)) {
          EXPECT_LE((fine->positions.row(a) - fine->positions.row(b)).norm(), longest);
        }
      }
    EXPECT_FALSE(refine_around(*fine, test.footprint, 10, {}).has_value());
  }
}

}  // namespace
}  // namespace meshgraft
