#include <meshgraft/mesh/cut.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "cut_cases.h"
#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;

// Returns the vertex nearest to a point.
Index nearest(const Mesh& mesh, const Vector3d& point) {
  Eigen::Index row = 0;
  (mesh.positions.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&row);
  return static_cast<Index>(row);
}

double length_of(const Mesh& mesh, const std::vector<Index>& loop) {
  double length = 0;
  for (std::size_t k = 0; k < loop.size(); ++k)
    length += (mesh.positions.row(loop[k]) - mesh.positions.row(loop[(k + 1) % loop.size()])).norm();
  return length;
}

TEST(CutAlongLoop, IsStraightBetweenTheListedVertices) {
  const Mesh sphere = mesh_of(icosphere(4));
  std::vector<Index> stations;
  for (int k = 0; k < 3; ++k) {
    const double a = 2 * std::numbers::pi * k / 3 + 0.2;
    stations.push_back(nearest(sphere, Vector3d(std::cos(a), std::sin(a), 0.3 * std::cos(2 * a)).normalized()));
  }
  for (const double snap : {0.0, 0.2}) {
    const CutResult cut = cut_along_loop(sphere, stations, {.snap = snap});
    expect_sound(cut, sphere);
    ASSERT_EQ(cut.loops.size(), 2u);
    double arcs = 0;  // length along great circles
    for (int k = 0; k < 3; ++k)
      arcs += std::acos(sphere.positions.row(stations[k]).dot(sphere.positions.row(stations[(k + 1) % 3])));
    EXPECT_NEAR(length_of(cut.mesh, cut.loops[0]), arcs, (snap > 0 ? 0.01 : 0.002) * arcs);
    EXPECT_NEAR(area(cut.mesh), area(sphere), (snap > 0 ? 1e-3 : 1e-12) * area(sphere));
    for (const Index v : stations) EXPECT_GE(cut.vertex.new_index[v], 0);

    // The stations run counter-clockwise as seen from above, so the upper part is on their left.
    const CutResult above = cut_along_loop(sphere, stations, {.keep = CutKeep::above, .snap = snap});
    const CutResult below = cut_along_loop(sphere, stations, {.keep = CutKeep::below, .snap = snap});
    expect_sound(above, sphere);
    EXPECT_GT(above.mesh.positions.col(2).maxCoeff(), 0.99);
    EXPECT_LT(below.mesh.positions.col(2).minCoeff(), -0.99);
    EXPECT_EQ(above.mesh.face_count() + below.mesh.face_count(), cut.mesh.face_count());
    EXPECT_EQ(summarise_topology(above.mesh).euler_characteristic, 1);
  }
}

TEST(CutAlongLoop, FollowsAPlaneOnAFlatSheet) {
  const Mesh sheet = shapes::grid(12, 12);  // quads
  const std::vector<Index> stations{13 * 2 + 1, 13 * 3 + 10, 13 * 11 + 7};
  const CutResult cut = cut_along_loop(sheet, stations, {.keep = CutKeep::above, .snap = 0});
  expect_sound(cut, sheet);
  double perimeter = 0;
  for (int k = 0; k < 3; ++k)
    perimeter += (sheet.positions.row(stations[k]) - sheet.positions.row(stations[(k + 1) % 3])).norm();
  ASSERT_EQ(cut.loops.size(), 1u);
  EXPECT_NEAR(length_of(cut.mesh, cut.loops[0]), perimeter, 1e-9);
  const Vector3d a = sheet.positions.row(stations[0]), b = sheet.positions.row(stations[1]),
                 c = sheet.positions.row(stations[2]);
  EXPECT_NEAR(area(cut.mesh), (b - a).cross(c - a).norm() / 2, 1e-9);
  EXPECT_TRUE(std::any_of(cut.face_parent.begin(), cut.face_parent.end(), [&](Index parent) {
    return std::count(cut.face_parent.begin(), cut.face_parent.end(), parent) == 1;
  })) << "quads that the loop does not meet stay whole";
}

TEST(CutAlongLoop, AHandleOpensAlongTwoLoops) {
  const Mesh torus = mesh_of(test::torus(24, 60));
  const std::vector<Index> around{24 * 7 + 1, 24 * 7 + 9, 24 * 7 + 17};
  const CutResult cut = cut_along_loop(torus, around);
  expect_sound(cut, torus);
  EXPECT_EQ(cut.loops.size(), 2u);
  const TopologySummary after = summarise_topology(cut.mesh);
  EXPECT_EQ(after.components, 1);
  EXPECT_EQ(after.genus, 0);
  EXPECT_THROW(cut_along_loop(torus, around, {.keep = CutKeep::above}), Error);
}

TEST(CutAlongLoop, RandomLoopsAreSoundOrRefused) {
  std::mt19937 random(5);
  int done = 0, refused = 0;
  for (const CutCase& test : cut_cases()) {
    for (int k = 0; k < 20; ++k) {
      std::vector<Index> stations;
      const int count = 3 + static_cast<int>(random() % 3);
      for (int j = 0; j < count; ++j)
        stations.push_back(static_cast<Index>(random() % test.mesh.vertex_count()));
      SCOPED_TRACE(test.name + ", loop " + std::to_string(k));
      try {
        const CutResult cut = cut_along_loop(test.mesh, stations, {.snap = k % 2 == 0 ? 0.0 : 0.15});
        expect_sound(cut, test.mesh);
        EXPECT_EQ(cut.loops.size(), 2u);
        EXPECT_EQ(cut.loops[0].size(), cut.loops[1].size());
        ++done;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
        ++refused;
      }
    }
  }
  EXPECT_GT(done, 150) << refused << " were refused";
}

TEST(CutAlongLoop, RefusesWhatIsNoLoop) {
  const Mesh sphere = mesh_of(icosphere(2));
  const auto id = [](const Mesh& mesh, const std::vector<Index>& vertices) -> std::string {
    try {
      cut_along_loop(mesh, vertices);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      return std::string(error.id());
    }
    return "";
  };
  EXPECT_EQ(id(sphere, {0, 1}), "mesh.loop_too_short");
  EXPECT_EQ(id(sphere, {0, 1, 0}), "mesh.loop_repeats_vertex");
  EXPECT_EQ(id(sphere, {0, 1, 5000}), "core.no_such_vertex");
  const Mesh two = shapes::together({sphere, sphere});
  EXPECT_EQ(id(two, {0, 1, sphere.vertex_count()}), "mesh.no_path");
  const Mesh sheet = shapes::grid(10, 10, true);
  const auto at = [](int x, int y) { return static_cast<Index>(11 * y + x); };
  EXPECT_EQ(id(sheet, {at(0, 5), at(5, 2), at(5, 8)}), "mesh.loop_touches_boundary");
  EXPECT_EQ(id(sheet, {at(2, 2), at(8, 8), at(8, 2), at(2, 8)}), "mesh.loop_crosses_itself");
  EXPECT_EQ(id(sheet, {at(2, 2), at(8, 2), at(5, 2)}), "mesh.loop_crosses_itself");
}

}  // namespace
}  // namespace meshgraft::test
