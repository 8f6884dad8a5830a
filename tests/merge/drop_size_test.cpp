#include "merge/drop_size.h"

#include <cmath>

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
    const SizeSearch search(target, loop, drop, 4, context);
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

TEST(DropSize, LargestFitsAndAFewPerCentMoreDoesNot) {
  for (const SizeScene& scene : size_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Mesh target = scene.target();
    const FlatLoop loop = test::flat_loops()[0];
    const Drop drop{scene.vertex};
    const Context context;
    const SizeRange range(target, loop);
    const SizeSearch search(target, loop, drop, range.largest, context);
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
  const SizeSearch search(target, loop, on_boundary, 1, context);
  EXPECT_EQ(search.largest_below(1, 0.2), 0);
}

}  // namespace
}  // namespace meshgraft
