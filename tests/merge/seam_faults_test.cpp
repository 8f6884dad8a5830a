#include "merge/seam_faults.h"

#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "merge/seam_scenes.h"

namespace meshgraft {
namespace {

/// A scene with its strip's faces and, as the band, all vertices of the strip.
struct Joined {
  explicit Joined(const test::SeamScene& scene) : mesh(scene.mesh), rest(scene.mesh.positions) {
    target_vertices = scene.layout.target_vertices;
    for (Index f = scene.strip_begin(); f < mesh.face_count(); ++f) new_faces.push_back(f);
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (scene.is_on_strip(v)) band.push_back(v);
  }
  SeamFaults faults() const { return find_seam_faults({mesh, new_faces, band, rest, target_vertices}, {}); }

  Mesh mesh;
  std::vector<Index> new_faces, band;
  Points rest;
  Index target_vertices = 0;
};

Index total(const SeamFaults& faults) { return faults.folded_edges + faults.crossings + faults.far_crossings; }

TEST(SeamFaults, AreNoneOnASmoothSurface) {
  for (const test::SeamScene& scene : test::seam_scenes(0))
    EXPECT_EQ(total(Joined(scene).faults()), 0) << scene.name;
}

TEST(SeamFaults, CountFoldsOfTheStrip) {
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    SCOPED_TRACE(scene.name);
    Joined joined(scene);
    // A vertex of the strip is drawn over its neighbours.
    const Index v = joined.band[0], beside = joined.band[2];
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
    const Index first = joined.target_vertices;
    const Eigen::RowVector3d across = joined.rest.row(first) - joined.rest.row(joined.target_vertices - 1);
    for (Index v = first; v < deep.mesh.vertex_count(); ++v) deep.mesh.positions.row(v) -= 4 * across;
    EXPECT_GT(deep.faults().crossings + deep.faults().far_crossings, 0);
  }
}

TEST(SeamFaults, AreThoseThatTheInputsDidNotHave) {
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    SCOPED_TRACE(scene.name);
    Joined joined(scene);
    // A vertex of the target, two rows before the strip, is pulled across the band of the target.
    const Index around = joined.band.back() - joined.target_vertices + 1;
    const Index v = joined.target_vertices - 2 * around, far = joined.target_vertices - 1;
    for (Index band_vertex = joined.target_vertices - 2 * around; band_vertex < joined.target_vertices - around;
         ++band_vertex)
      joined.band.insert(joined.band.begin(), band_vertex);
    joined.mesh.positions.row(v) = joined.mesh.positions.row(far);
    joined.mesh.positions.row(v)(2) += 1e-3;
    const Index brought_now = total(joined.faults());
    EXPECT_GT(brought_now, 0);
    joined.rest = joined.mesh.positions;
    EXPECT_LT(total(joined.faults()), brought_now);
    // A vertex that its input did not have makes them new again.
    joined.rest.row(v).setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(total(joined.faults()), brought_now);
  }
}

TEST(SeamFaults, DoNotDependOnWhereTheInputsWere) {
  const test::SeamScene scene = test::seam_scenes(0)[0];
  Joined joined(scene);
  for (Index v = joined.target_vertices; v < joined.mesh.vertex_count(); ++v)
    joined.mesh.positions.row(v) = joined.rest.row(joined.mesh.vertex_count() - 1 - v);  // through the target
  const SeamFaults through = joined.faults();
  EXPECT_GT(total(through), 0);
  // Target and source lie within one another at rest, too.
  joined.rest.bottomRows(joined.mesh.vertex_count() - joined.target_vertices) =
      joined.mesh.positions.bottomRows(joined.mesh.vertex_count() - joined.target_vertices);
  EXPECT_EQ(joined.faults().far_crossings, through.far_crossings);
}

}  // namespace
}  // namespace meshgraft
