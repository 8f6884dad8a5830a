#include "merge/seam_faults.h"

#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "merge/seam_scenes.h"

namespace meshgraft {
namespace {

/// A scene, and the vertices of its strip.
struct Joined {
  explicit Joined(const test::SeamScene& scene)
      : mesh(scene.mesh), layout(scene.layout), rest(scene.mesh.positions) {
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (scene.is_on_strip(v)) strip.push_back(v);
  }
  SeamFaults faults() const { return find_seam_faults({mesh, layout, rest}, {}); }

  Mesh mesh;
  SeamLayout layout;
  std::vector<Index> strip;
  Points rest;
};

TEST(SeamFaults, AreNoneOnASmoothSurface) {
  for (const test::SeamScene& scene : test::seam_scenes(0))
    EXPECT_EQ(Joined(scene).faults().total(), 0) << scene.name;
}

TEST(SeamFaults, CountFoldsOfTheStrip) {
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    SCOPED_TRACE(scene.name);
    Joined joined(scene);
    // A vertex of the strip is drawn over its neighbours.
    const Index v = joined.strip[0], beside = joined.strip[2];
    joined.mesh.positions.row(v) = 1.5 * joined.rest.row(beside) - 0.5 * joined.rest.row(v);
    EXPECT_GT(joined.faults().folded_edges, 0);
  }
}

TEST(SeamFaults, CountIntersectionsOfTheStripAndWithOtherFaces) {
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    SCOPED_TRACE(scene.name);
    Joined joined(scene);
    // The source is pushed through the strip and the target.
    Joined deep = joined;
    const Index first = joined.layout.target_vertices;
    const Eigen::RowVector3d across =
        joined.rest.row(first) - joined.rest.row(joined.layout.target_vertices - 1);
    for (Index v = first; v < deep.mesh.vertex_count(); ++v) deep.mesh.positions.row(v) -= 4 * across;
    EXPECT_GT(deep.faults().crossings + deep.faults().far_crossings, 0);
  }
}

TEST(SeamFaults, AreThoseThatTheInputsDidNotHave) {
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    SCOPED_TRACE(scene.name);
    Joined joined(scene);
    // A vertex of the target, two rows before the strip, is pulled across the strip's row.
    const Index around = joined.strip.back() - joined.layout.target_vertices + 1;
    const Index v = joined.layout.target_vertices - 2 * around, far = joined.layout.target_vertices - 1;
    joined.mesh.positions.row(v) = joined.mesh.positions.row(far);
    joined.mesh.positions.row(v)(2) += 1e-3;
    const Index brought_now = joined.faults().total();
    EXPECT_GT(brought_now, 0);
    joined.rest = joined.mesh.positions;
    EXPECT_LT(joined.faults().total(), brought_now);
    // A vertex that its input did not have makes them new again.
    joined.rest.row(v).setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(joined.faults().total(), brought_now);
  }
}

TEST(SeamFaults, AreCountedWhereTheSeamWasNotFaired) {
  // Three rings off the strip, a face is turned over.
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    SCOPED_TRACE(scene.name);
    Joined joined(scene);
    const Index around = joined.strip.back() - joined.layout.target_vertices + 1;
    const Index v = joined.layout.target_vertices - 2 * around;
    joined.mesh.positions.row(v) = 2 * joined.rest.row(v + around) - joined.rest.row(v);
    EXPECT_GT(joined.faults().total(), 0);
  }
}

TEST(SeamFaults, DoNotDependOnWhereTheInputsWere) {
  const test::SeamScene scene = test::seam_scenes(0)[0];
  Joined joined(scene);
  for (Index v = joined.layout.target_vertices; v < joined.mesh.vertex_count(); ++v)
    joined.mesh.positions.row(v) = joined.rest.row(joined.mesh.vertex_count() - 1 - v);  // through the target
  const SeamFaults through = joined.faults();
  EXPECT_GT(through.total(), 0);
  // Target and source lie within one another at rest, too.
  joined.rest.bottomRows(joined.mesh.vertex_count() - joined.layout.target_vertices) =
      joined.mesh.positions.bottomRows(joined.mesh.vertex_count() - joined.layout.target_vertices);
  EXPECT_EQ(joined.faults().far_crossings, through.far_crossings);
}

}  // namespace
}  // namespace meshgraft
