#include <meshgraft/mesh/cut.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using Eigen::Vector3d;

struct Case {
  std::string name;
  Mesh mesh;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const test::TestMesh& family : test::mesh_families())
    all.push_back({family.name, make_mesh(family.positions, family.triangles)});
  all.push_back({"cube", shapes::cube()});
  all.push_back({"grid of quads", shapes::grid(7, 5)});
  all.push_back({"tube of quads", shapes::tube(9, 4)});
  all.push_back({"torus of quads", shapes::torus(11, 6)});
  return all;
}

double area(const Mesh& mesh) {
  double sum = 0;
  const Triangles triangles = triangulate(mesh).triangles;
  for (Index t = 0; t < triangles.rows(); ++t) {
    const Vector3d a = mesh.positions.row(triangles(t, 0)), b = mesh.positions.row(triangles(t, 1)),
                   c = mesh.positions.row(triangles(t, 2));
    sum += (b - a).cross(c - a).norm() / 2;
  }
  return sum;
}

double smallest_angle_deg(const Mesh& mesh) {
  double smallest = 180;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    for (std::size_t c = 0; c < face.size(); ++c) {
      const Vector3d p = mesh.positions.row(face[c]), q = mesh.positions.row(face[(c + 1) % face.size()]),
                     r = mesh.positions.row(face[(c + face.size() - 1) % face.size()]);
      const double angle = std::atan2((q - p).cross(r - p).norm(), (q - p).dot(r - p));
      smallest = std::min(smallest, angle * 180 / std::numbers::pi);
    }
  }
  return smallest;
}

Vector3d centre(const Mesh& mesh) {
  return (mesh.positions.colwise().minCoeff() + mesh.positions.colwise().maxCoeff()).transpose() / 2;
}

double size_of(const Mesh& mesh) {
  return (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).norm();
}

std::vector<Vector3d> directions(int count) {
  std::mt19937 random(11);
  std::vector<Vector3d> all{Vector3d::UnitX(), -Vector3d::UnitY(), Vector3d::UnitZ()};
  while (static_cast<int>(all.size()) < count) {
    Vector3d d;
    for (int k = 0; k < 3; ++k) d[k] = static_cast<double>(random()) / 2147483648.0 - 1;
    if (d.norm() > 0.1) all.push_back(d);
  }
  return all;
}

void expect_simple_loops(const CutResult& cut) {
  const auto all = boundary_loops(cut.mesh);
  std::set<Index> seen;
  for (const auto& loop : all)
    for (const Index v : loop) EXPECT_TRUE(seen.insert(v).second) << "vertex " << v << " is on two loops";
  for (const auto& loop : cut.loops) {
    EXPECT_GE(loop.size(), 3u);
    EXPECT_NE(std::find(all.begin(), all.end(), loop), all.end());
  }
}

void expect_sound(const CutResult& cut, const Mesh& uncut) {
  const TopologySummary before = summarise_topology(uncut), after = summarise_topology(cut.mesh);
  EXPECT_EQ(after.manifold, before.manifold);
  EXPECT_EQ(after.oriented, before.oriented);
  EXPECT_FALSE(cut.loops.empty());
  expect_simple_loops(cut);
  ASSERT_EQ(static_cast<Index>(cut.origin.size()), cut.mesh.vertex_count());
  ASSERT_EQ(static_cast<Index>(cut.face_parent.size()), cut.mesh.face_count());
  ASSERT_EQ(static_cast<Index>(cut.vertex.new_index.size()), uncut.vertex_count());
  for (Index v = 0; v < cut.mesh.vertex_count(); ++v) {
    const Between& o = cut.origin[v];
    const Eigen::RowVector3d p = (1 - o.t) * uncut.positions.row(o.from) + o.t * uncut.positions.row(o.to);
    EXPECT_TRUE((p.array() == cut.mesh.positions.row(v).array()).all());
  }
  Index last = -1;
  for (Index v = 0; v < uncut.vertex_count(); ++v) {
    const Index w = cut.vertex.new_index[v];
    if (w < 0) continue;
    EXPECT_EQ(cut.origin[w].from, v);
    const bool on_cut = std::any_of(cut.loops.begin(), cut.loops.end(), [&](const auto& loop) {
      return std::find(loop.begin(), loop.end(), w) != loop.end();
    });
    if (on_cut) continue;
    EXPECT_GT(w, last) << "the others keep their order";
    last = w;
  }
}

TEST(Cut, HalvesOfEveryFamilyAreSound) {
  for (const Case& test : cases()) {
    const TopologySummary before = summarise_topology(test.mesh);
    int number = 0;
    for (const Vector3d& direction : directions(12)) {
      for (const double snap : {0.0, 0.1, 0.3}) {
        SCOPED_TRACE(test.name + ", direction " + std::to_string(number++) + ", snap " + std::to_string(snap));
        const Vector3d point = centre(test.mesh) + 0.013 * size_of(test.mesh) * Vector3d(1, -0.7, 0.4);
        const CutOptions options{.snap = snap};
        CutResult both;
        try {
          both = cut_by_plane(test.mesh, point, direction, options);
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::input);
          continue;  // a flat sheet in the plane's direction
        }
        const CutResult above =
            cut_by_plane(test.mesh, point, direction, {.keep = CutKeep::above, .snap = snap});
        const CutResult below =
            cut_by_plane(test.mesh, point, direction, {.keep = CutKeep::below, .snap = snap});
        for (const CutResult& result : {both, above, below}) expect_sound(result, test.mesh);

        // The halves are what `both` has side by side.
        EXPECT_EQ(both.mesh.face_count(), above.mesh.face_count() + below.mesh.face_count());
        EXPECT_EQ(both.loops.size(), above.loops.size() + below.loops.size());
        const double scale = area(both.mesh);
        EXPECT_NEAR(area(above.mesh) + area(below.mesh), scale, 1e-12 * scale);
        const bool is_far = test.mesh.positions.cwiseAbs().maxCoeff() > 1e8;
        if (snap == 0) {
          EXPECT_NEAR(scale, area(test.mesh), is_far ? 1e-6 : 1e-11 * scale);
        }

        // Cutting along circles and arcs: χ grows by the vertices minus the edges that are there twice.
        const TopologySummary after = summarise_topology(both.mesh);
        if (before.closed) {
          EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
          EXPECT_EQ(after.boundary_loops, static_cast<Index>(both.loops.size()));
          EXPECT_EQ(above.loops.size(), below.loops.size());
        }

        // No piece on the wrong side; the cut lies in the plane.
        const Vector3d n = direction.normalized();
        const double slack = 1e-9 * size_of(test.mesh) + 1e-14 * test.mesh.positions.cwiseAbs().maxCoeff();
        for (const auto& p : above.mesh.positions.rowwise()) EXPECT_GT((p.transpose() - point).dot(n), -slack);
        for (const auto& p : below.mesh.positions.rowwise()) EXPECT_LT((p.transpose() - point).dot(n), slack);
      }
    }
  }
}

// The vertex nearest to a point.
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

Mesh mesh_of(const test::TestMesh& mesh) { return make_mesh(mesh.positions, mesh.triangles); }

TEST(CutAlongLoop, IsStraightBetweenTheListedVertices) {
  const Mesh sphere = mesh_of(test::icosphere(4));
  std::vector<Index> stations;
  for (int k = 0; k < 3; ++k) {
    const double a = 2 * std::numbers::pi * k / 3 + 0.2;
    stations.push_back(nearest(sphere, Vector3d(std::cos(a), std::sin(a), 0.3 * std::cos(2 * a)).normalized()));
  }
  for (const double snap : {0.0, 0.2}) {
    const CutResult cut = cut_along_loop(sphere, stations, {.snap = snap});
    expect_sound(cut, sphere);
    ASSERT_EQ(cut.loops.size(), 2u);
    double arcs = 0;  // great circles
    for (int k = 0; k < 3; ++k)
      arcs += std::acos(sphere.positions.row(stations[k]).dot(sphere.positions.row(stations[(k + 1) % 3])));
    EXPECT_NEAR(length_of(cut.mesh, cut.loops[0]), arcs, (snap > 0 ? 0.01 : 0.002) * arcs);
    EXPECT_NEAR(area(cut.mesh), area(sphere), (snap > 0 ? 1e-3 : 1e-12) * area(sphere));
    for (const Index v : stations) EXPECT_GE(cut.vertex.new_index[v], 0);

    // Listed against the clock seen from above, so what lies at the left hand is the upper part.
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
  for (const Case& test : cases()) {
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

}  // namespace
}  // namespace meshgraft
