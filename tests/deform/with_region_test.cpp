// A deformer for another region of the same mesh gives the results of a new one, with less work.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quick_frames.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

constexpr DeformMethod methods[] = {DeformMethod::ft05, DeformMethod::rotation_aware,
                                    DeformMethod::corotational};

/// Returns the vertices of faces that are neither in the foot nor in the head, along the axis between the two.
std::vector<Index> between_ends(const Scene& scene) {
  std::vector<Index> free;
  for (const Index v : scene.mesh.triangles.reshaped())
    if (!std::binary_search(scene.foot.begin(), scene.foot.end(), v) &&
        !std::binary_search(scene.head.begin(), scene.head.end(), v))
      free.push_back(v);
  std::sort(free.begin(), free.end());
  free.erase(std::unique(free.begin(), free.end()), free.end());
  int axis = 0;
  (scene.mesh.positions(scene.foot, Eigen::all).colwise().mean() -
   scene.mesh.positions(scene.head, Eigen::all).colwise().mean())
      .cwiseAbs()
      .maxCoeff(&axis);
  std::stable_sort(free.begin(), free.end(), [&](Index a, Index b) {
    return scene.mesh.positions(a, axis) < scene.mesh.positions(b, axis);
  });
  return free;
}

/// Returns a share of the vertices between the ends, from the middle in both directions.
std::vector<Index> middle_part(const Scene& scene, double share) {
  const std::vector<Index> free = between_ends(scene);
  const auto count =
      std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(free.size())));
  const auto first = free.begin() + static_cast<std::ptrdiff_t>((free.size() - count) / 2);
  std::vector<Index> part(first, first + static_cast<std::ptrdiff_t>(count));
  std::sort(part.begin(), part.end());
  return part;
}

/// Returns the vertices between the ends that are at most `rings` edges from the middle vertex.
std::vector<Index> disc(const Scene& scene, int rings) {
  const IndexLists around = vertex_rings(scene.mesh.size(), scene.mesh.triangles);
  std::vector<Index> grown = grow_rings(middle_part(scene, 0), rings, around);
  const std::vector<Index> free = between_ends(scene);
  std::erase_if(grown, [&](Index v) { return std::find(free.begin(), free.end(), v) == free.end(); });
  return grown;
}

Region with_handle(Region region, const std::vector<Index>& vertices) {
  region.handles.push_back(make_handle("added", vertices));
  return region;
}

Region with_fixed(Region region, const std::vector<Index>& vertices) {
  region.fixed.insert(region.fixed.end(), vertices.begin(), vertices.end());
  return region;
}

/// Returns the head's move for the first handle and another map for the second.
std::vector<HandlePose> poses_of(const Scene& scene, const Region& region) {
  const Eigen::Affine3d other =
      about_middle(scene.mesh, Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, -1).normalized()).matrix());
  std::vector<HandlePose> poses{pose_of(head_move(scene)), pose_of(other)};
  poses.resize(region.handles.size());
  return poses;
}

Deformer make(const Scene& scene, const Region& region, const DeformerOptions& options,
              const Context& context = {}) {
  return {scene.mesh.positions, scene.mesh.triangles, region, options, context};
}

/// Returns a tolerance for the rounding of distant coordinates and of steps on triangles of 1:1000.
double tolerance(const TestMesh& mesh) {
  const bool needles =
      mesh.name.find("needle") != std::string::npos || mesh.name.find("fan pole") != std::string::npos;
  return std::max((needles ? 1e-8 : 1e-10) * mesh.box_diagonal(), eight_ulp(mesh.positions));
}

/// Checks that the other region's deformer equals a new one, or is refused for the same reason. Returns whether
/// it shares the set-up.
bool expect_as_fresh(const Scene& scene, const Deformer& deformer, const Region& region,
                     const DeformerOptions& options) {
  std::optional<Deformer> fresh;
  std::string refused;
  try {
    fresh.emplace(make(scene, region, options));
  } catch (const Error& error) {
    refused = error.what();
  }
  try {
    const Deformer other = deformer.with_region(region);
    EXPECT_EQ(refused, "");
    const std::vector poses = poses_of(scene, region);
    EvaluationReport of_fresh, of_other;
    const Points expected = fresh->evaluate(poses, {}, &of_fresh);
    EXPECT_LT(largest_distance(other.evaluate(poses, {}, &of_other), expected), tolerance(scene.mesh));
    EXPECT_EQ(of_other.iterations, of_fresh.iterations);
    EXPECT_EQ(of_other.inverted_maps, of_fresh.inverted_maps);
    EXPECT_EQ(of_other.fell_back_to_linear, of_fresh.fell_back_to_linear);
    EXPECT_NEAR(of_other.max_transform_deviation, of_fresh.max_transform_deviation, 1e-6);
    EXPECT_FALSE(fresh->summary().reused);
    EXPECT_EQ(other.summary().free_vertices, fresh->summary().free_vertices);
    EXPECT_EQ(other.summary().degenerate_vertices, fresh->summary().degenerate_vertices);
    EXPECT_EQ(other.summary().fixed_vertices, fresh->summary().fixed_vertices);
    EXPECT_EQ(other.summary().solver.unknowns, fresh->summary().solver.unknowns);
    EXPECT_TRUE(std::ranges::equal(other.free_vertices(), fresh->free_vertices()));
    return other.summary().reused;
  } catch (const Error& error) {
    EXPECT_EQ(refused, error.what());
    return false;
  }
}

class WithRegionByMethod : public testing::TestWithParam<DeformMethod> {};
INSTANTIATE_TEST_SUITE_P(All, WithRegionByMethod, testing::ValuesIn(methods), [](const auto& method) {
  std::string name(to_string(method.param));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(WithRegionByMethod, IsAsFreshOnEveryFamily) {
  const DeformMethod method = GetParam();
  const DeformerOptions options{.method = method, .iterations = 5};
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    const Region region = held_foot(scene);
    if (between_ends(scene).empty()) continue;
    Region anchored = region;
    for (const Index v : middle_part(scene, 0.02)) anchored.anchors.push_back({v, 5.0, {}});
    const Deformer deformer = make(scene, region, options);
    for (const auto& [name, other] :
         {std::pair{"a handle", with_handle(region, disc(scene, 1))},
          std::pair{"a band", with_handle(region, middle_part(scene, 0.3))},
          std::pair{"fixed", with_fixed(region, middle_part(scene, 0.05))}, std::pair{"anchors", anchored}}) {
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)) + ", " + name);
      const bool shared = expect_as_fresh(scene, deformer, other, options);
      EXPECT_TRUE(shared || name == std::string("a band") || mesh.size() < 100);
    }
  }
}

TEST(WithRegion, IsAsFreshInEveryVariant) {
  for (const TestMesh& mesh : {bumpy_sphere(3), irregular_grid(22, 16), flat_sheet(18, 12)}) {
    const Scene scene = make_scene(mesh);
    const Region region = held_foot(scene), more = with_handle(region, disc(scene, 1));
    for (const OperatorOptions& operators : operator_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(operators));
      const DeformerOptions options = linear_method(operators);
      const Deformer deformer = make(scene, region, options);
      // Noise moves flat vertices off their plane, but not those of a handle. A new handle on such vertices
      // prevents sharing.
      const std::vector<Index> held = disc(scene, 1);
      const std::vector<Index>& moved = deformer.affine_operator().nodes().moved;
      const bool moves = std::any_of(moved.begin(), moved.end(), [&](Index v) {
        return std::binary_search(held.begin(), held.end(), deformer.patch_vertices()[v]);
      });
      EXPECT_EQ(expect_as_fresh(scene, deformer, more, options), !moves);
    }
  }
}

TEST_P(WithRegionByMethod, PartsOfThePatchThatNothingReachesDoNotCount) {
  const DeformMethod method = GetParam();
  const DeformerOptions options{.method = method, .iterations = 5};
  // Nothing reaches the inside of a disc handle, of a band handle or of a handle at the foot, nor the foot
  // behind the latter.
  for (const TestMesh& mesh : {irregular_grid(50, 16), tube(16, 50)}) {
    const Scene scene = make_scene(mesh, 0.1, 0.1);
    const Region region = held_foot(scene);
    std::vector<Index> beside_foot = between_ends(scene);
    const bool foot_is_low = scene.mesh.positions.row(scene.foot.front()).minCoeff() <=
                             scene.mesh.positions.row(scene.head.front()).minCoeff();
    if (!foot_is_low) std::reverse(beside_foot.begin(), beside_foot.end());
    beside_foot.resize(beside_foot.size() / 4);
    std::sort(beside_foot.begin(), beside_foot.end());
    const Deformer deformer = make(scene, region, options);
    for (const auto& [name, other] : {std::pair{"disc", with_handle(region, disc(scene, 6))},
                                      std::pair{"band", with_handle(region, middle_part(scene, 0.3))},
                                      std::pair{"end", with_handle(region, beside_foot)}}) {
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)) + ", " + name);
      EXPECT_TRUE(expect_as_fresh(scene, deformer, other, options));
    }
  }
}

TEST(WithRegion, CutsAreSharedWhereAMeshIsDissected) {
  const Scene scene = make_scene(irregular_grid(80, 60));
  const Region region = held_foot(scene);
  for (const DeformMethod method : {DeformMethod::ft05, DeformMethod::corotational}) {
    SCOPED_TRACE(std::string(to_string(method)));
    const DeformerOptions options{.method = method, .iterations = 5};
    const Deformer deformer = make(scene, region, options);
    EXPECT_TRUE(expect_as_fresh(scene, deformer, with_handle(region, disc(scene, 4)), options));
  }
}

// The factor of the first region is kept, but for the fronts that an added handle reaches.
TEST(WithRegion, AddedHandlesChangeTheFactorOfTheLinearMethod) {
  if (available_backends().front() != SolverBackend::multifrontal) GTEST_SKIP() << "not part of this build";
  const DeformerOptions linear{.method = DeformMethod::ft05}, published = DeformerOptions::as_published();
  for (const auto& [mesh, options] : std::vector<std::pair<TestMesh, DeformerOptions>>{
           {irregular_grid(80, 60), linear}, {tube(40, 90), linear}, {tube(40, 90), published}}) {
    const Scene scene = make_scene(mesh);
    const Region region = held_foot(scene), more = with_handle(region, disc(scene, 1)),
                 most = with_fixed(more, {between_ends(scene).front()});
    SCOPED_TRACE(mesh.name);
    const Deformer first = make(scene, region, options);
    EXPECT_TRUE(expect_as_fresh(scene, first, more, options));
    const Deformer second = first.with_region(more);
    EXPECT_TRUE(expect_as_fresh(scene, second, most, options));
    const Deformer third = second.with_region(most);
    const SolverStatistics of_first = first.summary().solver;
    for (const Deformer* deformer : {&second, &third}) {
      const SolverStatistics changed = deformer->summary().solver;
      EXPECT_EQ(changed.factor_nonzeros, of_first.factor_nonzeros);
      EXPECT_LT(changed.peak_memory_bytes, of_first.peak_memory_bytes);
      EXPECT_LT(changed.matrix_nonzeros, of_first.matrix_nonzeros);
    }
    const double condition = make(scene, most, options).condition_estimate();
    EXPECT_NEAR(third.condition_estimate() / condition, 1, 0.5);
  }
}

TEST(WithRegion, AHandleThatGoesAgainLeavesTheSameBytes) {
  for (const TestMesh& mesh : {bumpy_sphere(3), irregular_grid(22, 16), tube(14, 30)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const Region region = held_foot(scene), more = with_handle(region, disc(scene, 2));
    auto first = std::make_unique<Deformer>(make(scene, region, {}));
    const Points expected = first->evaluate(poses_of(scene, region));
    auto second = std::make_unique<Deformer>(first->with_region(more));
    first.reset();
    const Deformer third = second->with_region(region);
    second.reset();
    EXPECT_TRUE(third.summary().reused);
    EXPECT_TRUE(same_bytes(third.evaluate(poses_of(scene, region)), expected));
  }
}

TEST_P(WithRegionByMethod, HandlesMayGiveOnePartAlone) {
  const DeformMethod method = GetParam();
  const DeformerOptions options{.method = method, .iterations = 5};
  for (const TestMesh& mesh : {bumpy_sphere(3), irregular_grid(22, 16)}) {
    const Scene scene = make_scene(mesh);
    const Region region = held_foot(scene);
    for (const bool position : {true, false}) {
      Region other = with_handle(region, disc(scene, 2));
      other.handles.back().constrain_position = position;
      other.handles.back().constrain_transform = !position;
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)) + (position ? ", place" : ", turn"));
      const Deformer deformer = make(scene, region, options);
      EXPECT_TRUE(expect_as_fresh(scene, deformer, other, options));
      EXPECT_TRUE(expect_as_fresh(scene, deformer.with_region(other), region, options));
    }
  }
}

TEST_P(WithRegionByMethod, FeaturesStay) {
  const DeformMethod method = GetParam();
  const DeformerOptions options{.method = method, .iterations = 5};
  const TestMesh mesh = bumpy_sphere(3);
  const Scene scene = make_scene(mesh);
  Feature feature;
  for (Index v = 0; v < mesh.size(); ++v)
    if (mesh.positions(v, 0) > 0.8 && std::abs(mesh.positions(v, 2)) < 0.4) feature.vertices.push_back(v);
  std::vector<Index> opposite;
  for (Index v = 0; v < mesh.size(); ++v)
    if (mesh.positions(v, 0) < -0.85 && std::abs(mesh.positions(v, 2)) < 0.4) opposite.push_back(v);
  for (const bool similarity : {false, true}) {
    feature.similarity = similarity;
    Region region = held_foot(scene);
    region.features = {feature};
    SCOPED_TRACE(std::string(to_string(method)) + (similarity ? ", similarity" : ", affine"));
    const Deformer deformer = make(scene, region, options);
    EXPECT_TRUE(expect_as_fresh(scene, deformer, with_handle(region, opposite), options));
    Region without = region;
    without.features.clear();
    EXPECT_FALSE(expect_as_fresh(scene, deformer, without, options));
  }
}

TEST(WithRegion, SharesNothingWithRegionsThatDifferTooMuch) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const Region region = held_foot(scene);
  Region fewer_fixed = region;
  fewer_fixed.fixed.resize(fewer_fixed.fixed.size() / 2);
  const Deformer deformer = make(scene, region, {});
  EXPECT_FALSE(expect_as_fresh(scene, deformer, fewer_fixed, {}));
  // Most of the shared patch would be unused.
  EXPECT_FALSE(expect_as_fresh(scene, deformer, with_fixed(region, middle_part(scene, 0.99)), {}));
  Region nothing_free = region;
  nothing_free.fixed = between_ends(scene);
  nothing_free.fixed.insert(nothing_free.fixed.end(), scene.foot.begin(), scene.foot.end());
  EXPECT_FALSE(expect_as_fresh(scene, deformer, nothing_free, {}));
  EXPECT_FALSE(expect_as_fresh(scene, make(scene, nothing_free, {}), region, {}));
}

TEST(WithRegion, FacesThatWereTurnedOverAreNotShared) {
  Scene scene = make_scene(irregular_grid(22, 16));
  for (Index t = 0; t < scene.mesh.triangles.rows(); t += 3)
    std::swap(scene.mesh.triangles(t, 0), scene.mesh.triangles(t, 1));
  const Region region = held_foot(scene);
  EXPECT_FALSE(expect_as_fresh(scene, make(scene, region, {}), with_handle(region, disc(scene, 1)), {}));
}

TEST(WithRegion, IsRefusedAsTheConstructorWould) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const Region region = held_foot(scene);
  const Deformer deformer = make(scene, region, {});
  EXPECT_FALSE(expect_as_fresh(scene, deformer, with_handle(region, {}), {}));
  EXPECT_FALSE(expect_as_fresh(scene, deformer, with_handle(region, scene.head), {}));
  EXPECT_FALSE(expect_as_fresh(scene, deformer, with_handle(region, {scene.mesh.size()}), {}));
  Region loose = region;
  loose.fixed.clear();
  loose.handles.clear();
  EXPECT_FALSE(expect_as_fresh(scene, deformer, loose, {}));
}

TEST(WithRegion, FollowsConstraintsPerVertexAndCurves) {
  const Scene scene = make_scene(irregular_grid(22, 16));
  const Region region = held_foot(scene);
  std::vector<VertexConstraint> constraints;
  for (const auto* part : {&scene.foot, &scene.head})
    for (const Index v : *part)
      constraints.push_back({v, scene.mesh.positions.row(v).transpose(), Eigen::Matrix3d::Identity(), {}});
  const Deformer per_vertex({scene.mesh.positions, scene.mesh.triangles, {.whole = true}, constraints});
  EXPECT_TRUE(expect_as_fresh(scene, per_vertex, region, {}));
  Region curve = with_handle(region, disc(scene, 0));
  curve.handles.back().shape = HandleShape::curve;
  EXPECT_TRUE(expect_as_fresh(scene, per_vertex, curve, {}));
}

TEST(WithRegion, FramesAreAsFresh) {
  const Scene scene = make_scene(irregular_grid(30, 24));
  const TestMesh& mesh = scene.mesh;
  const Region region = held_foot(scene), more = with_handle(region, disc(scene, 6));
  const std::vector poses = poses_of(scene, more);
  const auto expect_same = [&](const auto& frames, const auto& expected) {
    Points moved(mesh.size(), 3), wanted(mesh.size(), 3);
    frames.frame(poses, moved);
    expected.frame(poses, wanted);
    EXPECT_LT(largest_distance(moved, wanted), 1e-9 * mesh.box_diagonal());
  };
  const Deformer linear = make(scene, region, linear_method()).with_region(more);
  ASSERT_TRUE(linear.summary().reused);
  const Points normals =
      vertex_normals(mesh.positions, mesh.triangles, vertex_triangles(mesh.size(), mesh.triangles));
  expect_same(HandleBasis(linear, normals), HandleBasis(make(scene, more, linear_method()), normals));
  const Deformer rotating = make(scene, region, {}).with_region(more);
  expect_same(ReducedFrames(rotating), ReducedFrames(make(scene, more, {})));
}

TEST(WithRegion, GivesTheSameBytesForAnyNumberOfThreads) {
  const Scene scene = make_scene(irregular_grid(60, 50));
  const Region region = held_foot(scene), more = with_handle(region, disc(scene, 7));
  const auto edit = [&](int threads) {
    const Context context{.threads = threads};
    const Deformer deformer = make(scene, region, {}, context).with_region(more, context);
    EXPECT_TRUE(deformer.summary().reused);
    return deformer.evaluate(poses_of(scene, more), context);
  };
  EXPECT_TRUE(same_bytes(edit(1), edit(2)));
}

TEST(WithRegion, SeveralThreadsMayShareOneDeformer) {
  const Scene scene = make_scene(irregular_grid(80, 60));
  const Region region = held_foot(scene);
  const Deformer deformer = make(scene, region, linear_method());
  std::vector<Points> results(2);
  {
    std::vector<std::jthread> threads;
    for (std::size_t k = 0; k < results.size(); ++k)
      threads.emplace_back([&, k] {
        const Region more = with_handle(region, disc(scene, 3));
        results[k] = deformer.with_region(more).evaluate(poses_of(scene, more));
      });
  }
  EXPECT_TRUE(same_bytes(results[0], results[1]));
}

TEST(WithRegion, AnIterativeSolverFindsTheSame) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const Region region = held_foot(scene), more = with_handle(region, disc(scene, 3));
  DeformerOptions options = linear_method();
  options.backend = SolverBackend::iterative;
  const Deformer other = make(scene, region, options).with_region(more);
  EXPECT_TRUE(other.summary().reused);
  const std::vector poses = poses_of(scene, more);
  EXPECT_LT(largest_distance(other.evaluate(poses), make(scene, more, options).evaluate(poses)),
            1e-6 * scene.mesh.box_diagonal());
}

}  // namespace
}  // namespace meshgraft::test
