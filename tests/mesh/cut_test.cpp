#include <meshgraft/mesh/cut.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/sound_mesh.h>
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

Mesh mesh_of(const test::TestMesh& mesh) { return make_mesh(mesh.positions, mesh.triangles); }

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
    const EdgePoint& o = cut.origin[v];
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
    for (const Vector3d& direction : directions(8)) {
      for (const double snap : {0.0, 0.1, 0.3}) {
        SCOPED_TRACE(test.name + ", direction " + std::to_string(number++) + ", snap " + std::to_string(snap));
        const Vector3d point = centre(test.mesh) + 0.013 * size_of(test.mesh) * Vector3d(1, -0.7, 0.4);
        const CutOptions options{.snap = snap};
        CutResult both;
        try {
          both = cut_by_plane(test.mesh, point, direction, options);
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::input);
          continue;  // the plane is parallel to a flat sheet
        }
        const CutResult above =
            cut_by_plane(test.mesh, point, direction, {.keep = CutKeep::above, .snap = snap});
        const CutResult below =
            cut_by_plane(test.mesh, point, direction, {.keep = CutKeep::below, .snap = snap});
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

const Attribute& attribute(const Mesh& mesh, Domain domain, const char* name) {
  const Attribute* found = mesh.find_attribute(domain, name);
  if (found == nullptr) throw std::runtime_error(std::string("no attribute ") + name);
  return *found;
}

// Adds a linear function of position as vertex and as corner values; corner values have an offset per chart.
Mesh with_linear_attributes(Mesh mesh, const Vector3d& gradient) {
  Attribute vertex{.name = "height"}, uv{.name = "uv", .domain = Domain::corner},
      group{.name = "group", .domain = Domain::face, .interpolation = Interpolation::nearest};
  for (const auto& p : mesh.positions.rowwise()) vertex.values.push_back(p.dot(gradient));
  for (Index f = 0; f < mesh.face_count(); ++f) {
    group.values.push_back(f % 2);
    for (const Index v : mesh.faces[f]) uv.values.push_back(mesh.positions.row(v).dot(gradient) + 10 * (f % 2));
  }
  mesh.attributes = {vertex, uv, group};
  return mesh;
}

TEST(Cut, ALinearFunctionStaysLinearAndSeamsStaySeams) {
  const Vector3d gradient(0.3, -1.1, 0.7);
  for (const Case& test : {Case{"torus", mesh_of(test::torus(14, 30))}, Case{"cube", shapes::cube()},
                           Case{"sheet", shapes::grid(7, 5)}}) {
    SCOPED_TRACE(test.name);
    const Mesh mesh = with_linear_attributes(test.mesh, gradient);
    for (const double snap : {0.0, 0.3}) {
      const CutResult cut =
          cut_by_plane(mesh, centre(mesh) + Vector3d(0.07, 0.03, 0), {1, 0.2, 0.1}, {.snap = snap});
      const auto& height = attribute(cut.mesh, Domain::vertex, "height").values;
      const auto& uv = attribute(cut.mesh, Domain::corner, "uv").values;
      const auto& group = attribute(cut.mesh, Domain::face, "group").values;
      for (Index v = 0; v < cut.mesh.vertex_count(); ++v)
        EXPECT_NEAR(height[v], cut.mesh.positions.row(v).dot(gradient), 1e-12);
      std::size_t corner = 0;
      for (Index f = 0; f < cut.mesh.face_count(); ++f) {
        EXPECT_EQ(group[f], cut.face_parent[f] % 2);
        for (const Index v : cut.mesh.faces[f]) {
          // A vertex that was moved away from a chart keeps that chart's value.
          EXPECT_NEAR(uv[corner++], height[v] + 10 * group[f], snap > 0 ? 0.3 * size_of(mesh) : 1e-12);
        }
      }
    }
  }
}

TEST(Cut, OneChartStaysLinearWhereVerticesAreMoved) {
  const Vector3d gradient(0.3, -1.1, 0.7);
  Mesh mesh = with_linear_attributes(mesh_of(test::irregular_grid(22, 16)), gradient);
  Attribute& uv = mesh.attributes[1];
  std::size_t corner = 0;
  for (Index f = 0; f < mesh.face_count(); ++f)
    for (const Index v : mesh.faces[f]) uv.values[corner++] = mesh.positions.row(v).dot(gradient);
  const CutResult cut = cut_by_plane(mesh, centre(mesh), {1, 0.4, 0}, {.snap = 0.3});
  int moved = 0;
  for (Index v = 0; v < cut.mesh.vertex_count(); ++v)
    moved += cut.origin[v].t > 0 && cut.vertex.new_index[cut.origin[v].from] == v;
  EXPECT_GT(moved, 5);
  corner = 0;
  for (Index f = 0; f < cut.mesh.face_count(); ++f)
    for (const Index v : cut.mesh.faces[f])
      EXPECT_NEAR(attribute(cut.mesh, Domain::corner, "uv").values[corner++],
                  cut.mesh.positions.row(v).dot(gradient), 1e-12);
}

TEST(Cut, KeepsTheWholeSurfacesNormalsOnItsLoops) {
  const Mesh sphere = mesh_of(test::icosphere(3));
  const CutResult cut = cut_by_plane(sphere, {0.02, 0, 0.3}, {0.1, 0.2, 1});
  const Attribute& normal = attribute(cut.mesh, Domain::vertex, cut_normal_name);
  ASSERT_EQ(normal.components, 3);
  std::vector<bool> on_loop(cut.mesh.vertex_count(), false);
  for (const auto& loop : cut.loops)
    for (const Index v : loop) on_loop[v] = true;
  for (Index v = 0; v < cut.mesh.vertex_count(); ++v) {
    const Eigen::Map<const Vector3d> n(normal.values.data() + 3 * v);
    if (!on_loop[v]) {
      EXPECT_TRUE(n.array().isNaN().all());
      continue;
    }
    EXPECT_NEAR(n.norm(), 1, 1e-12);
    EXPECT_GT(n.dot(cut.mesh.positions.row(v).normalized()), 0.999);
  }
  // Both halves have the same positions and normals along the cut.
  ASSERT_EQ(cut.loops.size(), 2u);
  const auto rows = [&](const std::vector<Index>& loop) {
    std::set<std::array<double, 6>> all;
    for (const Index v : loop) {
      const auto p = cut.mesh.positions.row(v);
      all.insert({p(0), p(1), p(2), normal.values[3 * v], normal.values[3 * v + 1], normal.values[3 * v + 2]});
    }
    return all;
  };
  EXPECT_EQ(rows(cut.loops[0]), rows(cut.loops[1]));

  // A second cut keeps what the first left.
  const CutResult again = cut_by_plane(cut.mesh, {0, 0, -0.3}, {0, 0, 1}, {.keep = CutKeep::above});
  for (const auto& loop : boundary_loops(again.mesh))
    for (const Index v : loop)
      EXPECT_TRUE(std::isfinite(attribute(again.mesh, Domain::vertex, cut_normal_name).values[3 * v]));
}

TEST(Cut, SnappingLeavesNoSlivers) {
  for (const test::TestMesh& family :
       {test::bumpy_sphere(4), test::torus(30, 60), test::irregular_grid(40, 30)}) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = mesh_of(family);
    double plain = 180, snapped = 180;
    for (const Vector3d& direction : directions(20)) {
      if (direction.normalized().z() > 0.9) continue;  // the plane is parallel to the sheet
      const Vector3d point = centre(mesh) + 0.013 * size_of(mesh) * Vector3d(1, -0.7, 0.4);
      plain = std::min(plain, smallest_angle_deg(cut_by_plane(mesh, point, direction, {.snap = 0}).mesh));
      snapped = std::min(snapped, smallest_angle_deg(cut_by_plane(mesh, point, direction, {.snap = 0.2}).mesh));
    }
    EXPECT_GT(snapped, 10 * plain);
    EXPECT_GT(snapped, 1.5);
  }
}

TEST(Cut, GoesThroughVerticesThatLieOnIt) {
  const Mesh sheet = shapes::grid(6, 4);
  const CutResult cut = cut_by_plane(sheet, {3, 0, 0}, {1, 0, 0});
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
  const CutResult equator = cut_by_plane(octahedron, {0, 0, 0}, {0, 0, 1});
  expect_sound(equator, octahedron);
  EXPECT_EQ(equator.mesh.face_count(), 8);
  EXPECT_EQ(equator.mesh.vertex_count(), 10);
}

TEST(Cut, APlaneThatOnlyTouchesCutsNothing) {
  const Mesh cube = shapes::cube();
  const auto id = [&](const Vector3d& point, const Vector3d& normal) -> std::string {
    try {
      cut_by_plane(cube, point, normal);
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
  EXPECT_THROW(cut_by_plane(two, {0, 0, 2}, {0, 0, 1}), Error);
  // The plane touches one cube and cuts the other.
  const CutResult cut = cut_by_plane(two, {0.5, 0, 3}, {0.01, 0, 1}, {.snap = 0});
  EXPECT_EQ(cut.loops.size(), 2u);
}

TEST(Cut, FacesInThePlaneGoToOneSide) {
  // A step whose tread lies in the cutting plane z = 0, between a riser below and one above.
  const Mesh step = shapes::polygons(
      {{0, 0, -1}, {0, 1, -1}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, 1}, {1, 1, 1}},
      {{0, 2, 3, 1}, {2, 4, 5, 3}, {4, 6, 7, 5}});
  const CutResult above = cut_by_plane(step, {0, 0, 0}, {0, 0, 1}, {.keep = CutKeep::above});
  const CutResult below = cut_by_plane(step, {0, 0, 0}, {0, 0, 1}, {.keep = CutKeep::below});
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
TEST(Cut, GoesOnBesideWhatIsSetAside) {
  Mesh mesh = shapes::torus(24, 16, true);  // in the plane z = 0
  mesh.attributes = {{.name = "group", .domain = Domain::face, .values = std::vector<double>(768, 1)}};
  Index highest = 0;
  mesh.positions.col(2).maxCoeff(&highest);
  const Eigen::RowVector3d place = mesh.positions.row(highest);
  mesh.positions(highest, 0) = NAN;
  mesh.faces.push_back(std::vector<Index>{0, 1, 9999});
  mesh.attributes[0].values.push_back(2);
  const Diagnostics findings = check_mesh(mesh);
  const SoundMesh usable(mesh, findings, "torus");
  ASSERT_TRUE(usable.any());
  EXPECT_EQ(usable.mesh().face_count(), 768 - 6);
  EXPECT_EQ(usable.mesh().attributes[0].values, std::vector<double>(762, 1));
  ASSERT_TRUE(usable.note().has_value());
  EXPECT_TRUE(usable.note()->text().starts_with("torus: 7 faces that have no place were left out"))
      << usable.note()->text();
  try {
    cut_by_plane(usable.mesh(), Vector3d(0, 0, 99), Vector3d(0, 0, 1));
    FAIL() << "no error";
  } catch (const Error& error) {
    const Error explained = usable.explained(error);
    EXPECT_EQ(explained.fact(), error.fact());
    ASSERT_EQ(explained.notes().size(), 1u);
    EXPECT_EQ(explained.notes()[0], *usable.note());
  }
  EXPECT_THROW(usable.require_beyond(std::vector<Index>{0}), Error);

  CutResult result = cut_by_plane(usable.mesh(), Vector3d(0, 0, -0.6 * place.z()), Vector3d(0, 0, 1));
  usable.require_beyond(vertices_at_cut(result));
  usable.put_back(result.vertex, result.mesh);
  const Index now = result.vertex.new_index[highest];
  ASSERT_GE(now, 0);
  EXPECT_TRUE(std::isnan(result.mesh.positions(now, 0)));
  EXPECT_EQ(result.mesh.positions(now, 2), place.z());
  EXPECT_EQ((result.mesh.positions.array().isNaN()).count(), 1);

  const CutResult through = cut_by_plane(usable.mesh(), Vector3d(0, 0, 0.98 * place.z()), Vector3d(0, 0, 1));
  EXPECT_THROW(usable.require_beyond(vertices_at_cut(through)), Error);

  const SoundMesh clean(result.mesh, Diagnostics(), "clean");
  EXPECT_FALSE(clean.any());
  EXPECT_EQ(&clean.mesh(), &result.mesh) << "nothing is copied";
}

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

TEST(CutAlongLoop, RefusesWhatIsNoLoop) {
  const Mesh sphere = mesh_of(test::icosphere(2));
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
}  // namespace meshgraft
