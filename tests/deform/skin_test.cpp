#include "deform/proxy/skin.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "mesh/shapes.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

/// A surface of which every fifth vertex is a proxy. Its upper end is a boundary: the lowest vertices there are
/// of given position.
struct SkinScene {
  test::TestMesh mesh;
  IndexLists rings;
  std::vector<Index> proxies, rows, inner;
  std::vector<SkinProblem::BoundaryVertex> boundary;
  double spacing = 0;

  explicit SkinScene(test::TestMesh family)
      : mesh(std::move(family)), rings(vertex_rings(mesh.size(), mesh.triangles)) {
    Eigen::Index axis = 0;
    (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).maxCoeff(&axis);
    const double low = mesh.positions.col(axis).minCoeff(), high = mesh.positions.col(axis).maxCoeff();
    spacing = 0.15 * mesh.box_diagonal();
    for (Index v = 0; v < mesh.size(); ++v) {
      if (rings[v].empty()) continue;
      const double height = (mesh.positions(v, axis) - low) / (high - low);
      if (v % 5 == 0) proxies.push_back(v);
      if (height > 0.85 && height < 0.95) {
        boundary.push_back({v, static_cast<Index>(boundary.size())});
      } else if (height < 0.85) {
        (height < 0.15 ? inner : rows).push_back(v);
      }
    }
    for (auto& [vertex, bone] : boundary) bone += static_cast<Index>(proxies.size());
  }
  Index bone_count() const { return static_cast<Index>(proxies.size() + boundary.size()); }
  SkinProblem problem() const {
    return {.points = mesh.positions,
            .rings = rings,
            .proxies = proxies,
            .radius = std::vector<double>(proxies.size(), spacing),
            .boundary = boundary,
            .boundary_radius = spacing,
            .rows = rows,
            .inner = inner};
  }
  Index vertex_of_row(Index row) const {
    const auto k = static_cast<std::size_t>(row);
    return k < rows.size() ? rows[k] : inner[k - rows.size()];
  }
  Index vertex_of_bone(Index bone) const {
    const auto k = static_cast<std::size_t>(bone);
    return k < proxies.size() ? proxies[k] : boundary[k - proxies.size()].vertex;
  }
};

std::vector<SkinScene> skin_scenes() {
  std::vector<SkinScene> scenes;
  for (const test::TestMesh& mesh :
       {test::bumpy_sphere(3), test::irregular_grid(22, 16), test::tube(14, 30), test::torus(14, 30),
        test::bar(3, 14), test::with_isolated_vertices(test::irregular_grid(12, 8)),
        test::minute(test::bumpy_sphere(2))})
    scenes.emplace_back(mesh);
  return scenes;
}

TEST(Skin, WeightsAreAPartitionOfUnity) {
  for (const SkinScene& scene : skin_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const SkinResult result = make_skin(scene.problem());
    ASSERT_TRUE(result.outside.empty());
    ASSERT_EQ(static_cast<std::size_t>(result.skin.rows()), scene.rows.size() + scene.inner.size());
    for (Index row = 0; row < result.skin.rows(); ++row) {
      double sum = 0;
      std::set<Index> bones;
      for (auto e = result.skin.offsets[row]; e < result.skin.offsets[row + 1]; ++e) {
        EXPECT_GE(result.skin.weights[e], 0);
        EXPECT_TRUE(result.skin.bones[e] >= 0 && result.skin.bones[e] < scene.bone_count());
        EXPECT_TRUE(bones.insert(result.skin.bones[e]).second) << "bone twice";
        EXPECT_LE(result.skin.weights[e],
                  result.skin.weights[result.skin.offsets[row]]);  // the first is the heaviest
        sum += result.skin.weights[e];
      }
      EXPECT_NEAR(sum, 1, 1e-6);
    }
  }
}

TEST(Skin, ReproducesAnAffineMapOfAllBonesExactly) {
  for (const SkinScene& scene : skin_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const SkinResult result = make_skin(scene.problem());
    for (const auto& [name, linear] : test::linear_maps()) {
      Bone change;
      change << linear - Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.1, -2, 3);
      const std::vector<Bone> bones(static_cast<std::size_t>(scene.bone_count()), change);
      for (Index row = 0; row < result.skin.rows(); ++row) EXPECT_EQ(blend(result.skin, row, bones), change);
    }
  }
}

TEST(Skin, BlendIsTheWeightedMeanOfTheBones) {
  for (const SkinScene& scene : skin_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Skin skin = make_skin(scene.problem()).skin;
    std::vector<Bone> bones;
    for (Index b = 0; b < scene.bone_count(); ++b) bones.push_back(Bone::Constant(std::sin(b)));
    for (Index row = 0; row < skin.rows(); ++row) {
      double mean = 0, low = 2, high = -2;
      for (auto e = skin.offsets[row]; e < skin.offsets[row + 1]; ++e) {
        const double value = std::sin(skin.bones[e]);
        mean += skin.weights[e] * value;
        low = std::min(low, value);
        high = std::max(high, value);
      }
      const Bone found = blend(skin, row, bones);
      EXPECT_NEAR(found(1, 2), mean, 1e-6);
      EXPECT_TRUE(found(0, 3) >= low - 1e-6 && found(0, 3) <= high + 1e-6);
    }
  }
}

TEST(Skin, BonesReachTheirVertices) {
  for (SkinScene scene : skin_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    scene.spacing = 0.6 * scene.mesh.box_diagonal();  // so far that no influence radius has to be extended
    const Skin skin = make_skin(scene.problem()).skin;
    for (Index row = 0; row < skin.rows(); ++row)
      for (auto e = skin.offsets[row]; e < skin.offsets[row + 1]; ++e) {
        const double distance = (scene.mesh.positions.row(scene.vertex_of_row(row)) -
                                 scene.mesh.positions.row(scene.vertex_of_bone(skin.bones[e])))
                                    .norm();
        EXPECT_LT(distance, scene.spacing);
      }
  }
}

TEST(Skin, ReachesGrowUntilEveryVertexHasABone) {
  for (SkinScene scene : skin_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    scene.spacing = 1e-3 * scene.mesh.box_diagonal();  // shorter than any edge
    const SkinResult result = make_skin(scene.problem());
    EXPECT_TRUE(result.outside.empty());
    for (Index row = 0; row < result.skin.rows(); ++row)
      EXPECT_GT(result.skin.offsets[row + 1], result.skin.offsets[row]);
  }
}

TEST(Skin, NearABoundaryTheBoundaryTakesOver) {
  for (const SkinScene& scene : skin_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Skin skin = make_skin(scene.problem()).skin;
    const auto rim_share = [&](Index row) {
      double share = 0;
      for (auto e = skin.offsets[row]; e < skin.offsets[row + 1]; ++e)
        if (skin.bones[e] >= static_cast<Index>(scene.proxies.size())) share += skin.weights[e];
      return share;
    };
    for (Index row = 0; row < skin.rows(); ++row) {
      const Index v = scene.vertex_of_row(row);
      double nearest = 1e9;
      for (const auto& [vertex, bone] : scene.boundary)
        nearest = std::min(nearest, (scene.mesh.positions.row(v) - scene.mesh.positions.row(vertex)).norm());
      const bool is_inner = row >= static_cast<Index>(scene.rows.size());
      if (is_inner || nearest >= scene.spacing) {
        EXPECT_EQ(rim_share(row), 0);
      }
      // Beside the boundary the rest of the weight is the square of the relative distance, at most about
      // doubled.
      const double relative = nearest / scene.spacing;
      if (!is_inner) {
        EXPECT_LE(rim_share(row), std::pow(std::max(0.0, 1 - relative * relative), 2) + 1e-6);
      }
    }
  }
}

TEST(Skin, AProxyThatMovesOnlyItselfHasItsOwnRow) {
  const SkinScene scene(test::irregular_grid(12, 9));
  std::vector<Index> all;
  for (Index v = 0; v < scene.mesh.size(); ++v) all.push_back(v);
  const SkinResult result = make_skin({.points = scene.mesh.positions,
                                       .rings = scene.rings,
                                       .proxies = all,
                                       .radius = std::vector<double>(all.size(), 0.0),
                                       .boundary = {},
                                       .boundary_radius = 0,
                                       .rows = all,
                                       .inner = {}});
  EXPECT_EQ(result.skin.bones, all);
  EXPECT_EQ(result.skin.weights, std::vector<float>(all.size(), 1.0F));
}

TEST(Skin, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const SkinScene& scene : skin_scenes()) {
    const Skin one = make_skin(scene.problem(), shapes::with_threads(1)).skin;
    for (const int threads : {2, 3}) {
      const Skin other = make_skin(scene.problem(), shapes::with_threads(threads)).skin;
      EXPECT_EQ(one.offsets, other.offsets) << scene.mesh.name;
      EXPECT_EQ(one.bones, other.bones) << scene.mesh.name;
      EXPECT_EQ(one.weights, other.weights) << scene.mesh.name;
    }
  }
}

TEST(Skin, NamesVerticesThatNoProxyCanReach) {
  const SkinScene scene(test::with_isolated_vertices(test::irregular_grid(12, 8)));
  const std::vector<Index> one{scene.proxies.front()};
  std::vector<Index> rows = scene.rows, alone;
  for (Index v = 0; v < scene.mesh.size(); ++v)
    if (scene.rings[v].empty()) alone.push_back(v);
  rows.insert(rows.end(), alone.begin(), alone.end());
  SkinProblem problem = scene.problem();
  problem.proxies = one;
  problem.radius = {
      scene.spacing};  // one influence radius is extended over the whole sheet, but not to other components
  problem.rows = rows;
  const SkinResult result = make_skin(std::move(problem));
  EXPECT_EQ(result.outside, alone);
  EXPECT_EQ(result.skin.rows(), 0);
}

}  // namespace
}  // namespace meshgraft
