#include "merge/drop_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "merge/drop_scenes.h"

namespace meshgraft {
namespace {

/// A target with a vertex at which loops are tried.
struct SizeScene {
  test::TestMesh mesh;
  Index vertex = 0;

  Mesh target() const { return make_mesh(mesh.positions, mesh.triangles); }
};

std::vector<SizeScene> size_scenes() {
  const test::TestMesh sheet = test::flat_sheet(20, 20);
  return {{sheet, 21 * 10 + 10},
          {sheet, 21 * 10 + 4},
          {test::icosphere(3), 5},
          {test::tube(20, 30), 20 * 15},
          {test::bar(6, 24), 300}};
}

TEST(DropSize, RangeFollowsTargetAndLoop) {
  for (const SizeScene& scene : size_scenes())
    for (const FlatLoop& loop : test::flat_loops()) {
      const SizeRange range(scene.target(), loop);
      EXPECT_NEAR(range.largest * loop.outline.width(), scene.mesh.box_diagonal(), 1e-9);
      EXPECT_NEAR(range.least / range.largest, 1e-6, 1e-15);
    }
}

TEST(DropSize, ATrialFitsOrNamesWhatIsInTheWay) {
  for (const SizeScene& scene : size_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Mesh target = scene.target();
    const FlatLoop loop = test::flat_loops()[0];
    const Drop drop{scene.vertex};
    const Context context;
    SizeSearch search(target, loop, drop, 4, context);
    for (const double size : {0.25, 1.0, 2.0, 4.0})
      for (const bool may_widen : {false, true}) {
        const SizeTrial trial = search.at(size, may_widen);
        EXPECT_NE(trial.fit == nullptr, !trial.misfit.has_value());
        if (!trial.fit) continue;
        EXPECT_EQ(trial.fit->size, size);
        EXPECT_FALSE(find_obstacle(trial.fit->chart->target, trial.fit->footprint, size).has_value());
        EXPECT_GE(width_of(trial.fit->chart->target, trial.fit->footprint), 0.85 * size * loop.outline.width());
        // What fits without widening also fits with it.
        if (!may_widen) {
          EXPECT_NE(search.at(size, true).fit, nullptr);
        }
      }
  }
}

/// Returns a sphere of 60 meridians and 30 parallels, squashed to a lens with the poles at its rim. Charts
/// around them grow where edges are halved.
test::TestMesh lens() {
  constexpr Index meridians = 60, parallels = 30;
  test::TestMesh mesh;
  mesh.name = "lens";
  mesh.positions.resize(meridians * (parallels - 1) + 2, 3);
  const Index top = static_cast<Index>(mesh.positions.rows()) - 2, bottom = top + 1;
  std::vector<std::array<Index, 3>> triangles;
  const auto vertex = [&](Index row, Index column) { return row * meridians + column % meridians; };
  for (Index row = 0; row + 1 < parallels; ++row)
    for (Index column = 0; column < meridians; ++column) {
      const double polar = std::numbers::pi * (row + 1) / parallels,
                   azimuth = 2 * std::numbers::pi * column / meridians;
      mesh.positions.row(vertex(row, column)) << std::sin(polar) * std::cos(azimuth),
          0.05 * std::sin(polar) * std::sin(azimuth), std::cos(polar);
      const Index a = vertex(row, column), b = vertex(row, column + 1);
      if (row == 0) triangles.push_back({top, a, b});
      if (row + 2 == parallels) {
        triangles.push_back({bottom, b, a});
      } else {
        triangles.push_back({a, vertex(row + 1, column), vertex(row + 1, column + 1)});
        triangles.push_back({a, vertex(row + 1, column + 1), b});
      }
    }
  mesh.positions.row(top) << 0, 0, 1;
  mesh.positions.row(bottom) << 0, 0, -1;
  mesh.triangles =
      Eigen::Map<const Triangles>(triangles.front().data(), static_cast<Eigen::Index>(triangles.size()), 3);
  return mesh;
}

/// Lays the outline on the whole target, and halves edges around it. Returns the last chart and footprint.
std::pair<Chart, Footprint> lay_on_whole(const Mesh& target, const FlatLoop& loop, const Drop& drop,
                                         double size, double largest, double longest) {
  const auto chart_of = [&](const Mesh& mesh, double of) {
    PreparedTarget prepared(std::make_shared<const Mesh>(mesh), {});
    SurfacePoint point = find_surface_point(prepared, drop);
    return make_chart(std::move(prepared), std::move(point), most_widened * of * loop.outline.reach(), {});
  };
  std::optional<Chart> chart = chart_of(target, largest);
  const Placement placement = place_outline(chart->target, chart->point, loop, size, drop.spin_deg);
  Footprint footprint = lay_outline(*chart, loop.outline, size, placement);
  for (int halving = 0; halving < 12; ++halving) {
    const auto refined = refine_around(chart->target.mesh, footprint, longest, {});
    if (!refined) break;
    chart.emplace(chart_of(refined->mesh, size));
    footprint = lay_outline(*chart, loop.outline, size, placement);
  }
  return {std::move(*chart), std::move(footprint)};
}

TEST(DropSize, OnAPartIsTheSameAsOnTheWhole) {
  std::vector<SizeScene> scenes = size_scenes();
  for (const Index v : {31, 86, 116, 123}) scenes.push_back({lens(), v});
  int fits = 0;
  for (const SizeScene& scene : scenes)
    for (const double size : {0.05, 0.1, 0.4}) {
      SCOPED_TRACE(scene.mesh.name + " " + std::to_string(scene.vertex) + " " + std::to_string(size));
      const Mesh target = scene.target();
      const FlatLoop loop = test::flat_loops()[0];
      const Drop drop{scene.vertex};
      const Context context;
      const SizeTrial trial = SizeSearch(target, loop, drop, size, context).at(size, true);
      if (!trial.fit) continue;
      ++fits;
      const double longest =
          size * loop.outline.length() / std::max(24.0, static_cast<double>(loop.outline.size()) / 2);
      const auto [chart, footprint] = lay_on_whole(target, loop, drop, size, size, longest);
      const auto points_inside = [](const Mesh& mesh, const Footprint& of) {
        Points points(static_cast<Eigen::Index>(of.inside.size()), 3);
        for (Eigen::Index k = 0; k < points.rows(); ++k) points.row(k) = mesh.positions.row(of.inside[k]);
        return points;
      };
      EXPECT_EQ(points_inside(trial.fit->chart->target.mesh, trial.fit->footprint),
                points_inside(chart.target.mesh, footprint));
      EXPECT_EQ(
          trial.fit->chart->target.mesh.vertex_count() - static_cast<Index>(trial.fit->part->vertices.size()),
          chart.target.mesh.vertex_count() - target.vertex_count());
    }
  EXPECT_GT(fits, 15);
}

TEST(DropSize, LargestFitsAndAFewPerCentMoreDoesNot) {
  for (const SizeScene& scene : size_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Mesh target = scene.target();
    const FlatLoop loop = test::flat_loops()[0];
    const Drop drop{scene.vertex};
    const Context context;
    const SizeRange range(target, loop);
    SizeSearch search(target, loop, drop, range.largest, context);
    const double largest = search.largest_below(range.largest, range.least);
    ASSERT_GT(largest, 0);
    EXPECT_LT(largest, range.largest);
    EXPECT_NE(search.at(largest, true).fit, nullptr);
    EXPECT_EQ(search.at(1.06 * largest, true).fit, nullptr);
    EXPECT_NEAR(largest * std::pow(10, 2 - std::floor(std::log10(largest))),  // three digits
                std::round(largest * std::pow(10, 2 - std::floor(std::log10(largest)))), 1e-9);
  }
}

TEST(DropSize, WhereNothingFitsIsZero) {
  const test::TestMesh sheet = test::flat_sheet(20, 20);
  const Mesh target = make_mesh(sheet.positions, sheet.triangles);
  const FlatLoop loop = test::flat_loops()[0];
  const Drop on_boundary{Index{10}};
  const Context context;
  SizeSearch search(target, loop, on_boundary, 1, context);
  EXPECT_EQ(search.largest_below(1, 0.2), 0);
}

}  // namespace
}  // namespace meshgraft
