#include "merge/seam_fairing.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "merge/closed_curves.h"
#include "merge/seam_scenes.h"
#include "mesh/shapes.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

struct Faired {
  Mesh mesh;
  std::vector<Index> band;
};

Faired faired(const test::SeamScene& scene, const SeamOptions& options = {}, const Context& context = {}) {
  Faired result{scene.mesh, {}};
  result.band = fair_seam(result.mesh, scene.layout, options, context);
  return result;
}

double distance_from_smooth(const test::SeamScene& scene, const Points& positions) {
  return (positions - scene.smooth).norm();
}

TEST(SeamFairing, BringsANoisyBandNearerToTheSurface) {
  for (const double noise : {0.1, 0.2, 0.4})
    for (const test::SeamScene& scene : test::seam_scenes(noise)) {
      if (scene.name == "flat ring") continue;  // its noise is within the plane
      const double before = distance_from_smooth(scene, scene.mesh.positions),
                   after = distance_from_smooth(scene, faired(scene).mesh.positions);
      EXPECT_LT(after, (noise < 0.15 ? 0.75 : 0.95) * before) << scene.name << ", noise " << noise;
    }
}

TEST(SeamFairing, KeepsVerticesOutsideTheBandToTheBit) {
  for (const test::SeamScene& scene : test::seam_scenes(0.3))
    for (const int target_rings : {0, 1, 3})
      for (const int source_rings : {0, 2}) {
        SCOPED_TRACE(scene.name);
        const Faired result = faired(scene, {.target_rings = target_rings, .source_rings = source_rings});
        EXPECT_TRUE(std::is_sorted(result.band.begin(), result.band.end()));
        const SeamPatch patch = make_seam_patch(scene.mesh, scene.layout, 6);
        for (Index v = 0; v < scene.mesh.vertex_count(); ++v) {
          if (!std::binary_search(result.band.begin(), result.band.end(), v)) {
            EXPECT_EQ(result.mesh.positions.row(v), scene.mesh.positions.row(v));
            continue;
          }
          const auto local =
              std::lower_bound(patch.vertex.begin(), patch.vertex.end(), v) - patch.vertex.begin();
          const bool of_target = scene.layout.side_of_vertex(v) == SeamSide::target;
          EXPECT_LE(patch.ring[local], of_target ? target_rings : source_rings);
        }
      }
}

TEST(SeamFairing, WithoutStepsMovesNothing) {
  for (const test::SeamScene& scene : test::seam_scenes(0.3))
    EXPECT_TRUE(test::same_bytes(faired(scene, {.fairings = 0}).mesh.positions, scene.mesh.positions))
        << scene.name;
}

TEST(SeamFairing, LeavesASurfaceOfEvenCurvatureNearlyAlone) {
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    const Faired result = faired(scene);
    const double edge = 0.3, moved = test::largest_distance(result.mesh.positions, scene.mesh.positions);
    EXPECT_FALSE(result.band.empty());
    EXPECT_LT(moved, 0.1 * edge) << scene.name;
    if (scene.name == "flat ring") {
      EXPECT_LT(moved, 1e-9);
    }
  }
}

TEST(SeamFairing, FollowsSimilarities) {
  for (const test::SeamScene& scene :
       test::seam_scenes(0.1)) {  // without folds, whose reduction goes along the axes
    const Points result = faired(scene).mesh.positions;
    for (const Eigen::Affine3d& map : test::similarities()) {
      test::SeamScene moved = scene;
      moved.mesh.positions = test::mapped(scene.mesh.positions, map);
      const double scale = std::cbrt(map.linear().determinant());
      EXPECT_LT(test::largest_distance(faired(moved).mesh.positions, test::mapped(result, map)), 1e-6 * scale)
          << scene.name;
    }
  }
}

TEST(SeamFairing, KeepsSharpEdgesOfTheTarget) {
  const auto pipe = [](double h) { return std::pair(1.0, 1.6 * h); };
  test::SeamScene scene = test::round_seam("pipe", 4, 8, 0, pipe);
  for (Index v = 0; v < scene.mesh.vertex_count(); ++v)
    scene.mesh.positions.row(v).leftCols<2>() = scene.mesh.positions.row(v % 4).leftCols<2>();
  const Faired result = faired(scene);
  for (const Index v : result.band) EXPECT_EQ(scene.layout.side_of_vertex(v), SeamSide::source);
}

TEST(SeamFairing, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const test::SeamScene& scene : test::seam_scenes(0.4)) {
    const Faired one = faired(scene, {}, shapes::with_threads(1));
    for (const int threads : {2, 3})
      EXPECT_TRUE(
          test::same_bytes(one.mesh.positions, faired(scene, {}, shapes::with_threads(threads)).mesh.positions))
          << scene.name;
  }
}

TEST(SeamFairing, NamesAVertexThatIsNotFinite) {
  test::SeamScene scene = test::seam_scenes(0)[0];
  scene.mesh.positions(scene.layout.target_vertices, 1) = std::nan("");
  try {
    faired(scene);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "merge.seam_vertex_not_finite");
    EXPECT_NE(error.location().text().find(std::to_string(scene.layout.target_vertices)), std::string::npos)
        << error.location().text();
  }
}

}  // namespace
}  // namespace meshgraft
