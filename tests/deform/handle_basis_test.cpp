// Linear frames from the handle basis equal the solver's results.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
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

Deformer make_linear(const Scene& scene, const Region& region, const OperatorOptions& options = {}) {
  return {scene.mesh.positions, scene.mesh.triangles, region, linear_method(options)};
}

Points normals_of(const TestMesh& mesh, const Points& positions) {
  return vertex_normals(positions, mesh.triangles, vertex_triangles(mesh.size(), mesh.triangles));
}

/// Returns how far two solutions of the same problem may differ. The tolerance grows with the box, the largest
/// displacement and the rounding of the coordinates.
double tolerance(const TestMesh& mesh, const Points& edited) {
  const double moved = largest_distance(edited, mesh.positions);
  return std::max(1e-10 * std::max(mesh.box_diagonal(), moved), eight_ulp(edited));
}

/// Returns the positions that a vertex shader computes from the buffers, in scene units.
Points shade(const HandleBasis& basis, const Points& rest, std::span<const HandlePose> poses) {
  const HandleBuffers buffers = basis.buffers();
  const auto frames = basis.pose_matrices(poses);
  const Eigen::Index width = buffers.normals.rows() > 0 ? 16 : 4;
  Points positions = (rest.rowwise() - buffers.centre) / buffers.scale;
  for (std::size_t k = 0; k < buffers.vertices.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    Eigen::RowVector3f place = buffers.positions.row(row);
    for (std::size_t h = 0; h < poses.size(); ++h)
      place += buffers.blocks.row(row).segment<4>(width * static_cast<Eigen::Index>(h)) * frames[h];
    positions.row(buffers.vertices[k]) = place.cast<double>();
  }
  return positions;
}

std::vector<HandlePose> two_poses(const Scene& scene) {
  return {pose_of(about_middle(scene.mesh, linear_maps()[0].second)), pose_of(head_move(scene))};
}

TEST(HandleBasis, IsTheDirectSolution) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    for (const OperatorOptions& options : operator_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Deformer deformer = make_linear(scene, two_handles(scene), options);
      const auto poses = two_poses(scene);
      const Points direct = deformer.evaluate(poses), frame = HandleBasis(deformer).frame(poses);
      EXPECT_LE(largest_distance(frame, direct), tolerance(mesh, direct));
    }
  }
}

TEST(HandleBasis, IsTheDirectSolutionForHalfTheConstraints) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    for (const bool position : {true, false}) {
      SCOPED_TRACE(mesh.name + (position ? ", by position" : ", by transform"));
      Region region = two_handles(scene);
      region.handles[1].constrain_position = position;
      region.handles[1].constrain_transform = !position;
      const Deformer deformer = make_linear(scene, region);
      const auto poses = two_poses(scene);
      const Points direct = deformer.evaluate(poses);
      const HandleBasis basis(deformer, normals_of(mesh, mesh.positions));
      Points frame(mesh.size(), 3);
      Directions normals(mesh.size(), 3);
      basis.frame(poses, frame, &normals);
      EXPECT_LE(largest_distance(frame, direct), tolerance(mesh, direct));
    }
  }
}

TEST(HandleBasis, FollowsAnchorsAndFeatures) {
  for (const TestMesh& mesh : {bumpy_sphere(3), irregular_grid(22, 16), bar(3, 14), tube(14, 30)})
    for (const bool targets : {false, true}) {
      SCOPED_TRACE(mesh.name + (targets ? ", targets" : ""));
      const Scene scene = make_scene(mesh);
      Region region = held_foot(scene);
      std::vector<char> held(static_cast<std::size_t>(mesh.size()), 0);
      for (const std::vector<Index>* part : {&scene.foot, &scene.head})
        for (const Index v : *part) held[v] = 1;
      Feature feature;  // large enough that no row reaches some of its vertices
      for (Index v = 0; v < mesh.size(); ++v)
        if (!held[v] &&
            (mesh.positions.row(v) - mesh.positions.row(mesh.size() / 2)).norm() < 0.25 * mesh.box_diagonal())
          feature.vertices.push_back(v);
      ASSERT_FALSE(feature.vertices.empty());
      region.features.push_back(feature);
      for (Index v = 0; v < mesh.size(); v += 7) {
        Anchor anchor{v, 300, {}};
        if (targets)
          anchor.target =
              mesh.positions.row(v).transpose() + 0.1 * mesh.box_diagonal() * Eigen::Vector3d::UnitY();
        region.anchors.push_back(anchor);
      }
      const Deformer deformer = make_linear(scene, region);
      const HandleBasis basis(deformer, normals_of(mesh, mesh.positions));
      for (const HandlePose& pose : {HandlePose{}, pose_of(head_move(scene))}) {
        const Points direct = deformer.evaluate(std::vector{pose});
        // Anchors with targets move the mesh by themselves.
        const bool rests = !targets && pose.transform.isApprox(Eigen::Affine3d::Identity());
        EXPECT_EQ(largest_distance(direct, mesh.positions) < 1e-3, rests);
        Points frame(mesh.size(), 3);
        Directions normals(mesh.size(), 3);
        basis.frame(std::vector{pose}, frame, &normals);
        EXPECT_LE(largest_distance(frame, direct), tolerance(mesh, direct));
        const Points shaded = shade(basis, mesh.positions, std::vector{pose});
        const HandleBuffers buffers = basis.buffers();
        const Points expected = (direct.rowwise() - buffers.centre) / buffers.scale;
        EXPECT_LE(largest_distance(shaded, expected), 3e-6);
      }
    }
}

TEST(HandleBasis, NothingMovesWhenNothingIsMoved) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const Points rest_normals = normals_of(mesh, mesh.positions);
    const HandleBasis basis(make_linear(scene, held_foot(scene)), rest_normals);
    Points frame(mesh.size(), 3);
    Directions normals(mesh.size(), 3);
    basis.frame(std::vector{HandlePose{}}, frame, &normals);
    EXPECT_TRUE(same_bytes(frame, mesh.positions));
    EXPECT_EQ(normals, rest_normals.cast<float>());
  }
}

TEST(HandleBasis, HandlesAndTheOutsideAreExact) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const Eigen::Affine3d move = head_move(scene);
    const Points frame = HandleBasis(make_linear(scene, held_foot(scene))).frame(std::vector{pose_of(move)});
    for (const Index v : scene.foot) EXPECT_EQ(frame.row(v), mesh.positions.row(v));
    for (const Index v : scene.head)
      EXPECT_EQ(Eigen::Vector3d(frame.row(v)), move * Eigen::Vector3d(mesh.positions.row(v)));
  }
}

/// Returns the angles between unit vectors in ascending order, in degrees.
std::vector<double> angles_deg(const Points& a, const Points& b) {
  std::vector<double> angles;
  for (Eigen::Index v = 0; v < a.rows(); ++v)
    angles.push_back(2 * std::asin(std::min(1.0, (a.row(v) - b.row(v)).norm() / 2)) * 180 / std::numbers::pi);
  std::sort(angles.begin(), angles.end());
  return angles;
}

TEST(HandleBasis, NormalsAreThoseOfTheSurface) {
  for (const TestMesh& mesh : {bumpy_sphere(5), grid(120, 100), tube(60, 150), torus(80, 120)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const HandleBasis basis(make_linear(scene, two_handles(scene)), normals_of(mesh, mesh.positions));
    const auto poses = two_poses(scene);
    Points frame(mesh.size(), 3);
    Directions normals(mesh.size(), 3);
    basis.frame(poses, frame, &normals);
    EXPECT_LT((normals.rowwise().norm().array() - 1).abs().maxCoeff(), 1e-6);
    const std::vector<double> angles = angles_deg(normals.cast<double>(), normals_of(mesh, frame));
    EXPECT_LE(angles[angles.size() * 99 / 100], 2);
  }
}

TEST(HandleBasis, NormalsFollowAffineMapsExactly) {
  for (const TestMesh& mesh : {bumpy_sphere(3), irregular_grid(22, 16), tube(14, 30)})
    for (const bool transform : {true, false})
      for (const auto& [name, linear] : linear_maps()) {
        SCOPED_TRACE(mesh.name + ", " + name);
        const Scene scene = make_scene(mesh);
        Region region = two_handles(scene);
        region.handles[1].constrain_transform = transform;
        const HandleBasis basis(make_linear(scene, region), normals_of(mesh, mesh.positions));
        const HandlePose pose = pose_of(about_middle(mesh, linear));
        Points frame(mesh.size(), 3);
        Directions normals(mesh.size(), 3);
        basis.frame(std::vector{pose, pose}, frame, &normals);
        Points expected = normals_of(mesh, mesh.positions);
        const Eigen::Matrix3d cofactor = linear.determinant() * linear.inverse().transpose();
        for (Index v = 0; v < mesh.size(); ++v)
          expected.row(v) = (cofactor * expected.row(v).transpose()).normalized().transpose();
        EXPECT_LT(largest_distance(normals.cast<double>(), expected), 1e-4);
      }
}

TEST(HandleBasis, BuffersAreAccurateFarFromTheOrigin) {
  for (const TestMesh& mesh : mesh_families())
    for (const bool with_normals : {true, false}) {
      SCOPED_TRACE(mesh.name);
      const Scene scene = make_scene(mesh);
      const Deformer deformer = make_linear(scene, two_handles(scene));
      const HandleBasis basis(deformer, with_normals ? normals_of(mesh, mesh.positions) : Points());
      const HandleBuffers buffers = basis.buffers();
      EXPECT_EQ(buffers.blocks.cols(), with_normals ? 32 : 8);
      // These poses move about as far as the mesh is large, so that all vertices stay within a few boxes.
      const auto poses = two_poses(scene);
      const Points direct = deformer.evaluate(poses);
      const Points expected = (direct.rowwise() - buffers.centre) / buffers.scale;
      const double box = mesh.box_diagonal() / buffers.scale;
      EXPECT_LE(largest_distance(shade(basis, mesh.positions, poses), expected),
                1e-6 * box + eight_ulp(direct) / buffers.scale);
    }
}

TEST(HandleBasis, BuffersHoldTheMaps) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const TestMesh& mesh = scene.mesh;
  Region region = two_handles(scene);
  region.anchors.push_back({mesh.size() / 2, 1000, Eigen::Vector3d(0, 0, 2)});
  const HandleBasis basis(make_linear(scene, region), normals_of(mesh, mesh.positions));
  const auto poses = two_poses(scene);
  Points frame(mesh.size(), 3);
  Directions normals(mesh.size(), 3);
  basis.frame(poses, frame, &normals);
  const HandleBuffers buffers = basis.buffers();
  const auto frames = basis.pose_matrices(poses);
  ASSERT_EQ(buffers.maps.rows(), static_cast<Eigen::Index>(buffers.vertices.size()));
  for (std::size_t k = 0; k < buffers.vertices.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    using Block = Eigen::Matrix<float, 4, 4, Eigen::RowMajor>;
    using Map = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
    Eigen::Matrix3f m = Eigen::Matrix3f::Identity() + Eigen::Map<const Map>(&buffers.maps(row, 0));
    for (std::size_t h = 0; h < 2; ++h) {
      const Block block = Eigen::Map<const Block>(&buffers.blocks(row, static_cast<Eigen::Index>(16 * h)));
      m += (block * frames[h]).bottomRows<3>();
    }
    const Eigen::RowVector3f n = buffers.normals.row(row);
    const Eigen::RowVector3f turned =
        n[0] * m.row(1).cross(m.row(2)) + n[1] * m.row(2).cross(m.row(0)) + n[2] * m.row(0).cross(m.row(1));
    EXPECT_LT((turned.normalized() - normals.row(buffers.vertices[k])).norm(), 1e-4);
  }
}

TEST(HandleBasis, SameBytesForAnyNumberOfThreads) {
  for (const TestMesh& mesh : {bumpy_sphere(4), irregular_grid(60, 50)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const auto frame = [&](int threads) {
      Context context;
      context.threads = threads;
      const Deformer deformer(mesh.positions, mesh.triangles, two_handles(scene), linear_method(), context);
      const HandleBasis basis(deformer, normals_of(mesh, mesh.positions), context);
      Points both(2 * mesh.size(), 3), positions(mesh.size(), 3);
      Directions normals(mesh.size(), 3);
      basis.frame(two_poses(scene), positions, &normals, context);
      both << positions, normals.cast<double>();
      return both;
    };
    EXPECT_TRUE(same_bytes(frame(1), frame(2)));
  }
}

TEST(HandleBasis, LargeAndUnevenHandleCounts) {
  // Eleven handles of one vertex each are more than the basis solves for at once.
  const TestMesh mesh = irregular_grid(40, 30);
  const Scene scene = make_scene(mesh);
  Region region = held_foot(scene);
  region.handles.clear();
  std::vector<HandlePose> poses;
  for (int h = 0; h < 11; ++h) {
    const Index v = scene.head[static_cast<std::size_t>(h)];
    region.handles.push_back(make_handle("h" + std::to_string(h), {v}));
    poses.push_back(pose_of(Eigen::Affine3d(Eigen::Translation3d(0.01 * h, 0, 0.02 * (h % 3)))));
  }
  const Deformer deformer = make_linear(scene, region);
  const Points direct = deformer.evaluate(poses);
  EXPECT_LE(largest_distance(HandleBasis(deformer).frame(poses), direct), tolerance(mesh, direct));
}

std::string id_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_FALSE(error.problem().empty());
    return std::string(error.id());
  }
  return "nothing was thrown";
}

TEST(HandleBasis, RefusesWhatIsNotLinear) {
  const Scene scene = make_scene(bumpy_sphere(2));
  const TestMesh& mesh = scene.mesh;
  const Deformer corotational(mesh.positions, mesh.triangles, held_foot(scene));
  EXPECT_EQ(id_of([&] { HandleBasis basis(corotational); }), "deform.frames_not_linear");

  std::vector<VertexConstraint> constraints(1);
  constraints[0].vertex = 0;
  constraints[0].position = Eigen::Vector3d::Zero();
  constraints[0].transform = Eigen::Matrix3d::Identity();
  const Deformer per_vertex({mesh.positions, mesh.triangles, {.whole = true}, constraints}, linear_method());
  EXPECT_EQ(id_of([&] { HandleBasis basis(per_vertex); }), "deform.no_handles");

  Region region = held_foot(scene);
  std::vector<char> held(static_cast<std::size_t>(mesh.size()), 0);
  for (const Index v : scene.foot) held[v] = 1;
  for (const Index v : scene.head) held[v] = 1;
  const auto free = std::find(held.begin(), held.end(), 0) - held.begin();
  region.features.push_back({{static_cast<Index>(free)}, true, {}});
  EXPECT_EQ(id_of([&] { HandleBasis basis(make_linear(scene, region)); }), "deform.feature_not_linear");

  const Deformer deformer = make_linear(scene, held_foot(scene));
  EXPECT_EQ(id_of([&] { HandleBasis basis(deformer, Points::Zero(3, 3)); }), "core.size_mismatch");
  const HandleBasis basis(deformer);
  const std::vector rest{HandlePose{}};
  Points positions(mesh.size(), 3), few(3, 3);
  Directions normals(mesh.size(), 3);
  EXPECT_EQ(id_of([&] { basis.frame({}, positions); }), "core.size_mismatch");
  EXPECT_EQ(id_of([&] { basis.frame(rest, few); }), "core.size_mismatch");
  EXPECT_EQ(id_of([&] { basis.frame(rest, positions, &normals); }), "deform.basis_without_normals");
  HandlePose redrawn, broken;
  redrawn.curve = Points::Zero(static_cast<Eigen::Index>(scene.head.size()), 3);
  broken.transform.translation()[1] = std::nan("");
  EXPECT_EQ(id_of([&] { basis.frame(std::vector{redrawn}, positions); }), "deform.curve_not_affine");
  EXPECT_EQ(id_of([&] { basis.frame(std::vector{broken}, positions); }), "deform.too_large_or_not_finite");
}

TEST(HandleBasis, CanBeCancelled) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const Deformer deformer = make_linear(scene, held_foot(scene));
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  EXPECT_EQ(id_of([&] { HandleBasis basis(deformer, Points(), context); }), "core.cancelled");
}

}  // namespace
}  // namespace meshgraft::test
