
#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "merge/pose_source.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using Eigen::Vector3d;

Mesh bumpy_grid() {
  const test::TestMesh grid = test::irregular_grid(6, 5);
  Mesh mesh = make_mesh(grid.positions, grid.triangles);
  const Points normals = vertex_normals(mesh);
  mesh.attributes.push_back({.name = "normal",
                             .interpolation = Interpolation::direction,
                             .components = 3,
                             .values = {normals.data(), normals.data() + normals.size()}});
  // Corner c has the values (its vertex, c), so that a value at a wrong corner is detected.
  Attribute uv{.name = "uv", .domain = Domain::corner, .components = 2};
  for (Index c = 0; c < mesh.faces.corner_count(); ++c) {
    uv.values.push_back(mesh.faces.corners()[static_cast<std::size_t>(c)]);
    uv.values.push_back(c);
  }
  mesh.attributes.push_back(uv);
  return mesh;
}

Eigen::Affine3d some_similarity() {
  Eigen::Affine3d map = Eigen::Translation3d(3, -2, 7) *
                        Eigen::AngleAxisd(1.9, Vector3d(1, 2, -3).normalized()) * Eigen::Scaling(0.37);
  return map;
}

double normal_error(const Mesh& mesh) {
  const Points normals = vertex_normals(mesh);
  const Attribute& kept = *mesh.find_attribute(Domain::vertex, "normal");
  double error = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Eigen::Map<const Vector3d> given(&kept.values[3 * static_cast<std::size_t>(v)]);
    error = std::max(error, (given.transpose() - normals.row(v)).norm());
  }
  return error;
}

TEST(PoseSource, NormalsFollowSimilaritiesAndReflections) {
  const Mesh mesh = bumpy_grid();
  const Eigen::Affine3d mirror = reflection({{1, 2, 3}, {0.3, -2, 1}}, "mirror");
  for (const Eigen::Affine3d& map : {some_similarity(), mirror, Eigen::Affine3d(some_similarity() * mirror)}) {
    const Mesh moved = transformed(mesh, map, "transform");
    EXPECT_LT(normal_error(moved), 1e-12);
    EXPECT_EQ(moved.source, nullptr);
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      EXPECT_LT((moved.positions.row(v).transpose() - map * Vector3d(mesh.positions.row(v))).norm(), 1e-12);
  }
}

TEST(PoseSource, AReflectionKeepsTheOutsideOutsideAndCornersWithTheirVertices) {
  const test::TestMesh ball = test::bumpy_sphere(2);
  const auto volume = [](const Mesh& mesh) {
    double six = 0;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      const auto face = mesh.faces[f];
      six += mesh.positions.row(face[0]).dot(mesh.positions.row(face[1]).cross(mesh.positions.row(face[2])));
    }
    return six / 6;
  };
  const Eigen::Affine3d mirror = reflection({{0, 0.5, 0}, {0, 3, 0}}, "mirror");
  const Mesh closed = make_mesh(ball.positions, ball.triangles);
  EXPECT_NEAR(volume(transformed(closed, mirror, "mirror")), volume(closed), 1e-12);

  const Mesh mesh = bumpy_grid();
  const Mesh mirrored = transformed(mesh, mirror, "mirror");
  const Attribute& uv = *mirrored.find_attribute(Domain::corner, "uv");
  for (Index c = 0; c < mirrored.faces.corner_count(); ++c)
    EXPECT_EQ(uv.values[2 * static_cast<std::size_t>(c)],
              mirrored.faces.corners()[static_cast<std::size_t>(c)]);
  const Mesh back = transformed(mirrored, mirror, "mirror");
  EXPECT_EQ(back.faces, mesh.faces);
  EXPECT_EQ(back.find_attribute(Domain::corner, "uv")->values,
            mesh.find_attribute(Domain::corner, "uv")->values);
}

TEST(PoseSource, AlignFindsASimilarityFromThreePairs) {
  const Mesh source = bumpy_grid();
  const Mesh target = transformed(source, some_similarity(), "transform");
  const std::vector<Match> pairs{{0, 0}, {17, 17}, {30, 30}};
  const Eigen::Affine3d found = align_source(source, target, pairs);
  EXPECT_LT((found.matrix() - some_similarity().matrix()).norm(), 1e-10);
}

TEST(PoseSource, RefusesWhatLeavesThePoseOpen) {
  const Mesh mesh = bumpy_grid();
  const auto message = [&](const std::vector<Match>& pairs) {
    try {
      align_source(mesh, mesh, pairs);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({{0, 0}, {1, 1}}), "pairs: three pairs of vertices pose a source, 2 given");
  EXPECT_EQ(message({{0, 0}, {1, 1}, {2, 9999}}),
            "pairs[2]: target vertex 9999 does not exist; the mesh has 42");
  EXPECT_NE(message({{0, 0}, {0, 0}, {1, 1}}).find("lie on a line"), std::string::npos);
  EXPECT_THROW(reflection({{0, 0, 0}, {0, 0, 0}}, "mirror"), Error);
  Eigen::Affine3d flat = Eigen::Affine3d::Identity();
  flat.linear()(2, 2) = 0;
  EXPECT_THROW(transformed(mesh, flat, "transform"), Error);
}

}  // namespace
}  // namespace meshgraft
