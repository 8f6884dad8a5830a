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

}  // namespace
}  // namespace meshgraft
