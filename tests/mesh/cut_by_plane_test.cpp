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
#include "mesh/sound_mesh.h"
#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;

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

TEST(Cut, HalvesOfEveryFamilyAreSound) {
  for (const CutCase& test : cut_cases()) {
    const TopologySummary before = summarise_topology(test.mesh);
    int number = 0;
    for (const Vector3d& direction : directions(8)) {
      for (const double snap : {0.0, 0.1, 0.3}) {
        SCOPED_TRACE(test.name + ", direction " + std::to_string(number++) + ", snap " + std::to_string(snap));
        const Vector3d point = centre(test.mesh) + 0.013 * size_of(test.mesh) * Vector3d(1, -0.7, 0.4);
        const CutOptions options{.snap = snap};
        CutResult both;
        try {
          both = cut_by_plane(test.mesh, {point, direction}, options);
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::input);
          continue;  // the plane is parallel to a flat sheet
        }
        const CutResult above =
            cut_by_plane(test.mesh, {point, direction}, {.keep = CutKeep::above, .snap = snap});
        const CutResult below =
            cut_by_plane(test.mesh, {point, direction}, {.keep = CutKeep::below, .snap = snap});
        for (const CutResult& result : {both, above, below}) expect_sound(result, test.mesh);

        // `both` has the two halves side by side.
        EXPECT_EQ(both.mesh.face_count(), above.mesh.face_count() + below.mesh.face_count());
        EXPECT_EQ(both.loops.size(), above.loops.size() + below.loops.size());
        const double scale = area(both.mesh);
        EXPECT_NEAR(area(above.mesh) + area(below.mesh), scale, 1e-12 * scale);
        const bool is_far = test.mesh.positions.cwiseAbs().maxCoeff() > 1e8;
        if (snap == 0) {
          EXPECT_NEAR(scale, area(test.mesh), is_far ? 1e-6 : 1e-11 * scale);
        }

        // A cut adds to χ its doubled vertices minus its doubled edges, which is 0 for closed loops.
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

TEST(Cut, SnappingLeavesNoSlivers) {
  for (const TestMesh& family : {bumpy_sphere(4), torus(30, 60), irregular_grid(40, 30)}) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = mesh_of(family);
    double plain = 180, snapped = 180;
    for (const Vector3d& direction : directions(20)) {
      if (direction.normalized().z() > 0.9) continue;  // the plane is parallel to the sheet
      const Vector3d point = centre(mesh) + 0.013 * size_of(mesh) * Vector3d(1, -0.7, 0.4);
      plain = std::min(plain, smallest_angle_deg(cut_by_plane(mesh, {point, direction}, {.snap = 0}).mesh));
      snapped =
          std::min(snapped, smallest_angle_deg(cut_by_plane(mesh, {point, direction}, {.snap = 0.2}).mesh));
    }
    EXPECT_GT(snapped, 10 * plain);
    EXPECT_GT(snapped, 1.5);
  }
}

TEST(Cut, GoesThroughVerticesThatLieOnIt) {
  const Mesh sheet = shapes::grid(6, 4);
  const CutResult cut = cut_by_plane(sheet, {{3, 0, 0}, {1, 0, 0}});
  expect_sound(cut, sheet);
  EXPECT_EQ(cut.mesh.vertex_count(), sheet.vertex_count() + 5);
  EXPECT_EQ(cut.mesh.face_count(), sheet.face_count()) << "quads stay whole";
  EXPECT_EQ(cut.loops.size(), 2u);
  EXPECT_EQ(summarise_topology(cut.mesh).components, 2);
  // Kept vertices come first, in their order; the cut's vertices above follow, then those below.
  for (Index v = sheet.vertex_count() - 5; v < cut.mesh.vertex_count(); ++v)
    EXPECT_EQ(cut.mesh.positions(v, 0), 3);
  EXPECT_EQ(cut.vertex.new_index[3], sheet.vertex_count() - 5);

  // The plane passes through two opposite corners of an octahedron's equator.
  const Mesh octahedron = shapes::polygons(
      {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}});
  const CutResult equator = cut_by_plane(octahedron, {{0, 0, 0}, {0, 0, 1}});
  expect_sound(equator, octahedron);
  EXPECT_EQ(equator.mesh.face_count(), 8);
  EXPECT_EQ(equator.mesh.vertex_count(), 10);
}

TEST(Cut, APlaneThatOnlyTouchesCutsNothing) {
  const Mesh cube = shapes::cube();
  const auto id = [&](const Vector3d& point, const Vector3d& normal) -> std::string {
    try {
      cut_by_plane(cube, {point, normal});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      return std::string(error.id());
    }
    return "";
  };
  EXPECT_EQ(id({0, 0, 2}, {0, 0, 1}), "mesh.plane_misses_mesh");
  EXPECT_EQ(id({0, 0, 1}, {0, 0, 1}), "mesh.plane_misses_mesh") << "in a face";
  EXPECT_EQ(id({1, 1, 1}, {1, 1, 1}), "mesh.plane_misses_mesh") << "in a corner";
  EXPECT_EQ(id({0, 0, 0}, {0, 0, 0}), "mesh.plane_normal_unusable");
  // The plane lies between two cubes.
  Mesh other = cube;
  other.positions.col(2).array() += 3;
  const Mesh two = shapes::together({cube, other});
  EXPECT_THROW(cut_by_plane(two, {{0, 0, 2}, {0, 0, 1}}), Error);
  // The plane touches one cube and cuts the other.
  const CutResult cut = cut_by_plane(two, {{0.5, 0, 3}, {0.01, 0, 1}}, {.snap = 0});
  EXPECT_EQ(cut.loops.size(), 2u);
}

TEST(Cut, FacesInThePlaneGoToOneSide) {
  // A step whose tread lies in the cutting plane z = 0, between a riser below and one above.
  const Mesh step = shapes::polygons(
      {{0, 0, -1}, {0, 1, -1}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, 1}, {1, 1, 1}},
      {{0, 2, 3, 1}, {2, 4, 5, 3}, {4, 6, 7, 5}});
  const CutResult above = cut_by_plane(step, {{0, 0, 0}, {0, 0, 1}}, {.keep = CutKeep::above});
  const CutResult below = cut_by_plane(step, {{0, 0, 0}, {0, 0, 1}}, {.keep = CutKeep::below});
  EXPECT_EQ(above.mesh.face_count(), 1);
  EXPECT_EQ(below.mesh.face_count(), 2) << "the tread belongs below";
  expect_sound(above, step);
  expect_sound(below, step);
}

TEST(Cut, SaddlesComeApartIntoSimpleLoops) {
  // The values have alternating signs in the four quadrants around a vertex.
  Mesh saddle = shapes::grid(8, 8, true);
  std::vector<double> values;
  for (const auto& p : saddle.positions.rowwise()) values.push_back((p(0) - 4) * (p(1) - 4));
  const CutResult cut = cut_at_zero(saddle, values);
  expect_sound(cut, saddle);
  EXPECT_EQ(summarise_topology(cut.mesh).components, 4);
  EXPECT_EQ(cut.loops.size(), 4u);
}

TEST(Cut, ValuesAreChecked) {
  const Mesh cube = shapes::cube();
  EXPECT_THROW(cut_at_zero(cube, std::vector<double>(7, 1.0)), Error);
  std::vector<double> values{1, 1, 1, 1, -1, -1, -1, std::nan("")};
  EXPECT_THROW(cut_at_zero(cube, values), Error);
  values.back() = -1;
  EXPECT_THROW(cut_at_zero(cube, values, {.snap = 0.7}), Error);
  EXPECT_EQ(cut_at_zero(cube, values).loops.size(), 2u);
  Mesh broken = cube;
  broken.faces.push_back(std::vector<Index>{0, 1, 99});
  EXPECT_THROW(cut_at_zero(broken, values), Error);
}

// Refused faces and vertices do not stop a step that does not reach them.
TEST(Cut, CutsTheSoundFacesOfADefectiveMesh) {
  Mesh mesh = shapes::torus(24, 16, true);  // in the plane z = 0
  mesh.attributes = {{.name = "group", .domain = Domain::face, .values = std::vector<double>(768, 1)}};
  Index highest = 0;
  mesh.positions.col(2).maxCoeff(&highest);
  const Eigen::RowVector3d place = mesh.positions.row(highest);
  mesh.positions(highest, 0) = NAN;
  mesh.faces.push_back(std::vector<Index>{0, 1, 9999});
  mesh.attributes[0].values.push_back(2);
  const Diagnostics findings = check_mesh(mesh);
  const SoundMesh sound(mesh, findings, "torus");
  ASSERT_TRUE(sound.any());
  EXPECT_EQ(sound.mesh().face_count(), 768 - 6);
  EXPECT_EQ(sound.mesh().attributes[0].values, std::vector<double>(762, 1));
  ASSERT_TRUE(sound.note().has_value());
  EXPECT_TRUE(sound.note()->text().starts_with("torus: 7 faces that are refused were left out"))
      << sound.note()->text();
  try {
    cut_by_plane(sound.mesh(), {Vector3d(0, 0, 99), Vector3d(0, 0, 1)});
    FAIL() << "no error";
  } catch (const Error& error) {
    const Error explained = sound.explained(error);
    EXPECT_EQ(explained.fact(), error.fact());
    ASSERT_EQ(explained.notes().size(), 1u);
    EXPECT_EQ(explained.notes()[0], *sound.note());
  }
  EXPECT_THROW(sound.require_beyond(std::vector<Index>{0}), Error);

  CutResult result = cut_by_plane(sound.mesh(), {Vector3d(0, 0, -0.6 * place.z()), Vector3d(0, 0, 1)});
  sound.require_beyond(vertices_at_cut(result));
  sound.put_back(result.vertex, result.mesh);
  const Index now = result.vertex.new_index[highest];
  ASSERT_GE(now, 0);
  EXPECT_TRUE(std::isnan(result.mesh.positions(now, 0)));
  EXPECT_EQ(result.mesh.positions(now, 2), place.z());
  EXPECT_EQ((result.mesh.positions.array().isNaN()).count(), 1);

  const CutResult through = cut_by_plane(sound.mesh(), {Vector3d(0, 0, 0.98 * place.z()), Vector3d(0, 0, 1)});
  EXPECT_THROW(sound.require_beyond(vertices_at_cut(through)), Error);

  const SoundMesh clean(result.mesh, Diagnostics(), "clean");
  EXPECT_FALSE(clean.any());
  EXPECT_EQ(&clean.mesh(), &result.mesh) << "nothing is copied";
}

}  // namespace
}  // namespace meshgraft::test
