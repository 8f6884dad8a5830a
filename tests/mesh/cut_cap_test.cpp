#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "cut_cases.h"
#include "mesh/cut/cap.h"
#include "mesh/cut/pin_fit.h"
#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;

double volume(const Mesh& mesh) {
  const Triangles triangles = triangulate(mesh).triangles;
  const Vector3d origin = centre(mesh);
  double six = 0;
  for (Index t = 0; t < triangles.rows(); ++t) {
    const auto at = [&](int k) -> Vector3d { return mesh.positions.row(triangles(t, k)).transpose() - origin; };
    six += at(0).dot(at(1).cross(at(2)));
  }
  return six / 6;
}

double prism(double radius, double height) {
  return pin_sides / 2.0 * std::sin(2 * std::numbers::pi / pin_sides) * radius * radius * height;
}

double volume_of_pin(const CutPin& pin) {
  const double chamfer = pin_chamfer_rel * pin.diameter, r = pin.diameter / 2, s = r - chamfer;
  return prism(r, pin.length - chamfer) +
         (prism(r, 1) + prism(s, 1) + prism(std::sqrt(r * s), 1)) * chamfer / 3;
}

double volume_of_hole(const CutPin& pin) {
  return prism(pin.diameter / 2 + pin.clearance, pin.length + pin.clearance);
}

std::int64_t intersections(const Mesh& mesh) {
  std::vector<Index> all(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) all[v] = v;
  return count_self_intersections(mesh.positions, triangulate(mesh).triangles, all);
}

std::string id_of_error(const Mesh& mesh, const Plane& plane, const CutOptions& options) {
  try {
    cut_by_plane(mesh, plane, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    return std::string(error.id());
  }
  return "";
}

bool has_note(const CutResult& cut, std::string_view id) {
  return std::any_of(cut.notes.begin(), cut.notes.end(), [&](const Note& note) { return note.id() == id; });
}

Mesh moved(Mesh mesh, const Vector3d& by) {
  mesh.positions.rowwise() += by.transpose();
  return mesh;
}

Mesh scaled(Mesh mesh, double by) {
  mesh.positions *= by;
  return mesh;
}

Mesh turned_over(const Mesh& mesh) {
  Mesh over;
  over.positions = mesh.positions;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    over.faces.push_back(std::vector<Index>(face.rbegin(), face.rend()));
  }
  return over;
}

// A round bar along z, closed, of radius 1 and length 6.
Mesh cylinder() {
  Mesh mesh = shapes::tube(40, 6, true);
  std::vector<Index> bottom, top;
  for (Index k = 0; k < 40; ++k) {
    bottom.push_back(39 - k);
    top.push_back(240 + k);
  }
  mesh.faces.push_back(bottom);
  mesh.faces.push_back(top);
  return mesh;
}

// A thick-walled pipe along z, one closed surface: a torus with a rectangular section.
Mesh pipe() {
  return shapes::sheet({.columns = 48, .rows = 4, .close_columns = true, .close_rows = true, .triangles = true},
                       [](double u, double v) {
                         const double a = 2 * std::numbers::pi * u;
                         const int corner = static_cast<int>(std::lround(4 * v)) % 4;
                         const double r = corner == 0 || corner == 3 ? 2 : 1;
                         const double z = corner < 2 ? 2 : -2;
                         return Vector3d(r * std::cos(a), r * std::sin(a), corner == 0 || corner == 1 ? z : -2);
                       });
}

struct CapCase {
  std::string name;
  Mesh mesh;
  Plane plane;
  std::size_t caps = 1;  // on each half
};

std::vector<CapCase> cap_cases() {
  const Mesh ball = mesh_of(bumpy_sphere(4)), ring = mesh_of(torus(48, 24));
  const Vector3d middle = centre(ring);
  Mesh hollow = shapes::together({ball, turned_over(scaled(ball, 0.5))});
  return {{"cylinder", cylinder(), {{0, 0, 2.7}, {0, 0, 1}}},
          {"cylinder, slanted", cylinder(), {{0, 0, 3}, {0.3, 0.2, 1}}},
          {"cylinder, along", cylinder(), {{0.1, 0, 3}, {1, 0, 0}}},
          {"bar", mesh_of(bar(4, 12)), {centre(mesh_of(bar(4, 12))), {0.1, 0.2, 1}}},
          {"bumpy ball", ball, {{0, 0, 0.1}, {0.2, -0.3, 1}}},
          {"torus in two caps", ring, {middle, {1, 0.13, 0.02}}, 2},
          {"torus, flat", ring, {middle + Vector3d(0, 0, 0.01), {0, 0, 1}}, 1},
          {"pipe", pipe(), {{0, 0, 0.3}, {0, 0, 1}}},
          {"pipe, along", pipe(), {{0.2, 0, 0}, {1, 0, 0}}, 2},
          {"hollow ball", hollow, {{0, 0, 0.1}, {0, 0, 1}}},
          {"several components",
           shapes::together({ball, moved(ball, {5, 0, 0}), moved(cylinder(), {0, 5, -3})}),
           {{0, 0, 0.1}, {0, 0, 1}},
           3},
          {"minute", scaled(ball, 1e-6), {{0, 0, 1e-7}, {0.2, -0.3, 1}}},
          {"far away", moved(ball, {1000, -2000, 3000}), {{1000, -2000, 3000.1}, {0.2, -0.3, 1}}}};
}

void expect_closed(const Mesh& mesh) {
  const TopologySummary topology = summarise_topology(mesh);
  EXPECT_TRUE(topology.closed);
  EXPECT_TRUE(topology.manifold);
  EXPECT_TRUE(topology.oriented);
  EXPECT_EQ(topology.isolated_vertices, 0);
}

void expect_sound_half(const Mesh& mesh) {
  expect_closed(mesh);
  EXPECT_EQ(intersections(mesh), 0);
}

TEST(CutCap, HalvesAreClosedAndMakeUpTheWhole) {
  for (const CapCase& test : cap_cases()) {
    for (const double snap : {0.0, 0.2}) {
      SCOPED_TRACE(test.name + ", snap " + std::to_string(snap));
      const auto cut = [&](CutKeep keep) {
        return cut_by_plane(test.mesh, test.plane, {.keep = keep, .snap = snap, .cap = CutCap::flat});
      };
      const CutResult above = cut(CutKeep::above), below = cut(CutKeep::below), both = cut(CutKeep::both);
      for (const CutResult* half : {&above, &below}) expect_sound_half(half->mesh);
      expect_closed(both.mesh);
      const double whole = volume(both.mesh);
      EXPECT_GT(volume(above.mesh), 0);
      EXPECT_GT(volume(below.mesh), 0);
      EXPECT_NEAR(volume(above.mesh) + volume(below.mesh), whole, 1e-9 * whole);
      if (snap == 0) {
        EXPECT_NEAR(whole, volume(test.mesh), 1e-9 * whole);
      }
      // A cap adds no vertex, and names no parent.
      EXPECT_EQ(static_cast<Index>(both.origin.size()), both.mesh.vertex_count());
      EXPECT_GT(std::count(both.face_parent.begin(), both.face_parent.end(), -1), 0);
      EXPECT_EQ(both.mesh.find_attribute(Domain::vertex, cut_normal_name), nullptr);
    }
  }
}

TEST(CutCap, PinsAndHolesFit) {
  for (const CapCase& test : cap_cases()) {
    for (const PinSide side : {PinSide::below, PinSide::above}) {
      SCOPED_TRACE(test.name + (side == PinSide::below ? ", pins below" : ", pins above"));
      const auto cut = [&](CutKeep keep, CutCap cap) {
        return cut_by_plane(test.mesh, test.plane, {.keep = keep, .cap = cap, .pin_side = side});
      };
      const CutKeep pins = side == PinSide::below ? CutKeep::below : CutKeep::above;
      const CutKeep holes = side == PinSide::below ? CutKeep::above : CutKeep::below;
      const CutResult pinned = cut(pins, CutCap::pins), drilled = cut(holes, CutCap::pins);
      expect_sound_half(pinned.mesh);
      expect_sound_half(drilled.mesh);
      ASSERT_EQ(pinned.pins.size(), drilled.pins.size());
      EXPECT_EQ(pinned.pins.size(), 2 * test.caps);
      double of_pins = 0, of_holes = 0;
      const Vector3d normal = test.plane.normal.normalized();
      for (std::size_t k = 0; k < pinned.pins.size(); ++k) {
        const CutPin& pin = pinned.pins[k];
        EXPECT_EQ(pin.centre, drilled.pins[k].centre) << "both halves have the same pins, kept apart or not";
        EXPECT_EQ(pin.diameter, drilled.pins[k].diameter);
        EXPECT_NEAR((pin.centre - test.plane.point).dot(normal), 0, 1e-9 * size_of(test.mesh));
        EXPECT_NEAR(pin.clearance, 0.05 * pin.diameter, 1e-12 * pin.diameter);
        EXPECT_GE(pin.length, 0.5 * pin.diameter);
        of_pins += volume_of_pin(pin);
        of_holes += volume_of_hole(pin);
        EXPECT_LT(volume_of_pin(pin), volume_of_hole(pin));
      }
      const double scale = volume(test.mesh);
      EXPECT_NEAR(volume(pinned.mesh), volume(cut(pins, CutCap::flat).mesh) + of_pins, 1e-9 * scale);
      EXPECT_NEAR(volume(drilled.mesh), volume(cut(holes, CutCap::flat).mesh) - of_holes, 1e-9 * scale);
      const CutResult both = cut(CutKeep::both, CutCap::pins);
      EXPECT_EQ(both.pins.size(), pinned.pins.size());
      EXPECT_NEAR(volume(both.mesh), volume(pinned.mesh) + volume(drilled.mesh), 1e-9 * scale);
      // Put together, the pinned half does not meet the drilled one except in the caps.
      EXPECT_EQ(summarise_topology(both.mesh).components,
                summarise_topology(pinned.mesh).components + summarise_topology(drilled.mesh).components);
    }
  }
}

// The nearest point of the surface behind the cut is at least a quarter of the diameter from a hole.
TEST(CutCap, HolesLeaveAWall) {
  for (const CapCase& test : cap_cases()) {
    SCOPED_TRACE(test.name);
    const CutResult plain = cut_by_plane(test.mesh, test.plane, {.keep = CutKeep::above});
    const CutResult drilled =
        cut_by_plane(test.mesh, test.plane, {.keep = CutKeep::above, .cap = CutCap::pins});
    const Vector3d normal = test.plane.normal.normalized();
    const Triangles triangles = triangulate(plain.mesh).triangles;
    const double slack = 1e-9 * size_of(test.mesh);
    for (const CutPin& pin : drilled.pins) {
      const double wall = 0.25 * pin.diameter, radius = pin.diameter / 2 + pin.clearance;
      for (Index t = 0; t < triangles.rows(); ++t)
        for (int i = 0; i <= 3; ++i)  // points all over the triangle
          for (int j = 0; i + j <= 3; ++j) {
            const Vector3d p =
                (plain.mesh.positions.row(triangles(t, 0)) * i + plain.mesh.positions.row(triangles(t, 1)) * j +
                 plain.mesh.positions.row(triangles(t, 2)) * (3 - i - j)) /
                3;
            const double depth = (p - pin.centre).dot(normal);
            const double away = (p - pin.centre - depth * normal).norm();
            const bool far =
                away >= radius + wall - slack || depth >= pin.length + pin.clearance + wall - slack;
            ASSERT_TRUE(far) << "a point " << away << " beside and " << depth << " behind a pin";
          }
    }
  }
}

// A block along x with a notch from below, whose upper edge lies in the plane z = 0 from outline to outline.
Mesh notched_block() {
  const std::vector<Eigen::Vector2d> section{{-1, -1}, {-0.5, -1}, {0, 0},  {0.5, -1}, {1, -1},
                                             {1, 0},   {1, 1},     {-1, 1}, {-1, 0}};
  const auto count = static_cast<Index>(section.size());
  Mesh mesh;
  mesh.positions.resize(2 * count, 3);
  for (Index k = 0; k < count; ++k) {
    mesh.positions.row(k) << 0.2, section[k].x(), section[k].y();
    mesh.positions.row(count + k) << -0.2, section[k].x(), section[k].y();
  }
  const std::vector<std::array<Index, 3>> end{{0, 1, 8}, {1, 2, 8}, {2, 7, 8}, {2, 6, 7},
                                              {2, 5, 6}, {2, 3, 5}, {3, 4, 5}};
  for (const auto& [a, b, c] : end) {
    mesh.faces.push_back(std::array{a, b, c});
    mesh.faces.push_back(std::array{count + a, count + c, count + b});
  }
  for (Index k = 0; k < count; ++k) {
    const Index next = (k + 1) % count;
    mesh.faces.push_back(std::array{k, count + k, count + next});
    mesh.faces.push_back(std::array{k, count + next, next});
  }
  return mesh;
}

TEST(CutCap, HasNoEdgeThatTheSurfaceHasInThePlane) {
  const Mesh block = notched_block();
  ASSERT_TRUE(summarise_topology(block).closed);
  const CutResult legs =
      cut_by_plane(block, {{0, 0, 0}, {0, 0, 1}}, {.keep = CutKeep::below, .cap = CutCap::flat});
  const TopologySummary topology = summarise_topology(legs.mesh);
  EXPECT_TRUE(topology.manifold);
  EXPECT_TRUE(topology.closed);
  EXPECT_NEAR(volume(legs.mesh), 0.4 * (2 - 0.5), 1e-12);
}

TEST(CutCap, NamesTheSizeOfPinsAtFault) {
  const auto place = [](const CutOptions& options) {
    try {
      cut_by_plane(cylinder(), {{0, 0, 2.7}, {0, 0, 1}}, options);
    } catch (const Error& error) {
      return error.location().text();
    }
    return std::string();
  };
  EXPECT_EQ(place({.cap = CutCap::pins, .pin_diameter = 0.2, .pin_clearance = 3}), "pin_clearance");
  EXPECT_EQ(place({.cap = CutCap::pins, .pin_diameter = 3, .pin_clearance = 0.01}), "pin_diameter");
  EXPECT_EQ(place({.cap = CutCap::pins, .pin_diameter = 3, .pin_clearance = 3}), "pin_diameter")
      << "neither fits without the other";
}

TEST(CutCap, GivenSizesAreKept) {
  const CutOptions options{
      .cap = CutCap::pins, .pin_count = 3, .pin_diameter = 0.3, .pin_length = 0.5, .pin_clearance = 0.02};
  const CutResult cut = cut_by_plane(cylinder(), {{0, 0, 2.7}, {0, 0, 1}}, options);
  ASSERT_EQ(cut.pins.size(), 3u);
  for (const CutPin& pin : cut.pins) {
    EXPECT_EQ(pin.diameter, 0.3);
    EXPECT_EQ(pin.length, 0.5);
    EXPECT_EQ(pin.clearance, 0.02);
    EXPECT_NEAR(Vector3d(pin.centre - Vector3d(0, 0, 2.7)).norm(), 0.54, 0.05)
        << "as three circles in a circle";
  }
  EXPECT_TRUE(cut.notes.empty());
}

TEST(CutCap, PinsBecomeShorterOrFewerWithANote) {
  // A cut half a unit below the top.
  const Plane high{{0, 0, 5.5}, {0, 0, 1}};
  const CutResult shorter =
      cut_by_plane(cylinder(), high, {.cap = CutCap::pins, .pin_diameter = 0.4, .pin_length = 1});
  ASSERT_EQ(shorter.pins.size(), 2u);
  EXPECT_NEAR(shorter.pins[0].length, 0.5 - 0.1 - 0.02, 1e-9) << "less the wall and the clearance";
  EXPECT_TRUE(has_note(shorter, "mesh.pins_shortened"));
  // With the pins above, the holes have the long side.
  EXPECT_EQ(
      cut_by_plane(cylinder(), high,
                   {.cap = CutCap::pins, .pin_diameter = 0.4, .pin_length = 1, .pin_side = PinSide::above})
          .pins[0]
          .length,
      1);
  const CutResult fewer = cut_by_plane(cylinder(), {{0, 0, 2.7}, {0, 0, 1}},
                                       {.cap = CutCap::pins, .pin_count = 32, .pin_diameter = 0.4});
  EXPECT_GE(fewer.pins.size(), 3u);
  EXPECT_LT(fewer.pins.size(), 32u);
  EXPECT_TRUE(has_note(fewer, "mesh.pins_left_out"));
  // One of two caps is too small.
  const Mesh two = shapes::together({cylinder(), moved(scaled(cylinder(), 0.1), {5, 0, 2.4})});
  const CutResult some =
      cut_by_plane(two, {{0, 0, 2.7}, {0, 0, 1}}, {.cap = CutCap::pins, .pin_diameter = 0.4});
  EXPECT_EQ(some.pins.size(), 2u);
  EXPECT_TRUE(has_note(some, "mesh.caps_without_pins"));
}

TEST(CutCap, RefusesWhatCannotBeClosed) {
  const Plane plane{{0, 0, 2.7}, {0, 0, 1}};
  const CutOptions flat{.cap = CutCap::flat}, pins{.cap = CutCap::pins};
  EXPECT_EQ(id_of_error(shapes::tube(40, 6), {{0, 0, 3}, {1, 0, 0}}, flat), "mesh.cap_outline_open");
  for (const CutOptions& options : {flat, pins})
    EXPECT_EQ(id_of_error(shapes::sheets_at_a_line({0, 120, 240}), {{0.47, 0, 0}, {1, 0, 0}}, options),
              "mesh.cap_outline_branches");
  EXPECT_EQ(id_of_error(shapes::tube(40, 6), plane, flat), "") << "the hole is elsewhere";
  EXPECT_EQ(id_of_error(turned_over(cylinder()), plane, flat), "mesh.cap_inside_out");
  EXPECT_EQ(id_of_error(cylinder(), plane, {.cap = CutCap::pins, .pin_diameter = 3}), "mesh.pins_do_not_fit");
  EXPECT_EQ(id_of_error(cylinder(), {{0, 0, 5.9999}, {0, 0, 1}}, pins), "mesh.no_room_for_pins");
  EXPECT_EQ(id_of_error(cylinder(), plane, {.cap = CutCap::pins, .pin_count = 0}), "core.out_of_range");
  EXPECT_EQ(id_of_error(cylinder(), plane, {.cap = CutCap::pins, .pin_diameter = -1}), "core.not_positive");
  EXPECT_EQ(id_of_error(cylinder(), plane, {.cap = CutCap::pins, .pin_clearance = -1}),
            "core.negative_or_not_finite");
  EXPECT_THROW(cut_along_loop(cylinder(), std::vector<Index>{120, 133, 146}, flat), Error);
  EXPECT_THROW(cut_at_zero(cylinder(), std::vector<double>(280, 1), flat), Error);
}

// A surface that crosses itself has an outline without an inside.
TEST(CutCap, RefusesAnOutlineThatCrossesItself) {
  Mesh eight = shapes::sheet({.columns = 40, .rows = 2, .close_columns = true, .triangles = true},
                             [](double u, double v) {
                               const double a = 2 * std::numbers::pi * u;
                               return Vector3d(std::cos(a) + 0.2, std::sin(2 * a) + 0.3 * std::sin(a), 2 * v);
                             });
  EXPECT_EQ(id_of_error(eight, {{0, 0, 0.9}, {0, 0, 1}}, {.cap = CutCap::flat}), "mesh.cap_outline_crosses");
}

TEST(CutCap, CapsTakeAttributesFromTheirOutline) {
  Mesh mesh = cylinder();
  Attribute height{.name = "height"},
      group{.name = "group",
            .domain = Domain::face,
            .interpolation = Interpolation::nearest,
            .labels = {"a", "b"}},
      uv{.name = "uv", .domain = Domain::corner, .components = 2};
  for (Index v = 0; v < mesh.vertex_count(); ++v) height.values.push_back(mesh.positions(v, 0));
  group.values.assign(mesh.face_count(), 1);
  for (const Index v : mesh.faces.corners())
    uv.values.insert(uv.values.end(), {mesh.positions(v, 0), mesh.positions(v, 1)});
  mesh.attributes = {height, group, uv};
  const CutResult cut = cut_by_plane(mesh, {{0, 0, 2.7}, {0, 0, 1}}, {.snap = 0, .cap = CutCap::pins});
  const Attribute& heights = *cut.mesh.find_attribute(Domain::vertex, "height");
  ASSERT_EQ(static_cast<Index>(heights.values.size()), cut.mesh.vertex_count());
  const Attribute& groups = *cut.mesh.find_attribute(Domain::face, "group");
  EXPECT_EQ(groups.values, std::vector<double>(cut.mesh.face_count(), 1));
  const Attribute& uvs = *cut.mesh.find_attribute(Domain::corner, "uv");
  ASSERT_EQ(static_cast<Index>(uvs.values.size()), 2 * cut.mesh.faces.corner_count());
  for (Index c = 0; c < cut.mesh.faces.corner_count(); ++c) {
    const Index v = cut.mesh.faces.corners()[c];
    if (cut.origin[v].from < 0) {
      EXPECT_LE(std::hypot(uvs.values[2 * c], uvs.values[2 * c + 1]), 1.01);
    } else {
      EXPECT_NEAR(uvs.values[2 * c], cut.mesh.positions(v, 0), 1e-12) << "as the surface beside it";
    }
  }
}

TEST(PackCircles, FindsTheKnownPackings) {
  std::vector<Point2> points;
  CapRegion disc, square;
  for (int k = 0; k < 200; ++k) {
    const double a = 2 * std::numbers::pi * k / 200;
    disc.outer.push_back(static_cast<Index>(points.size()));
    points.push_back({std::cos(a), std::sin(a)});
  }
  for (const Point2& corner : {Point2{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    square.outer.push_back(static_cast<Index>(points.size()));
    points.push_back(corner);
  }
  EXPECT_NEAR(pack_circles(points, disc, 1).radius, 1, 0.02);
  EXPECT_NEAR(pack_circles(points, disc, 2).radius, 0.5, 0.02);
  EXPECT_NEAR(pack_circles(points, disc, 3).radius, 1 / (1 + 2 / std::sqrt(3)), 0.03);
  EXPECT_NEAR(pack_circles(points, square, 4).radius, 0.5, 0.03);
}

TEST(FreeDepth, IsTheLowestPointOverADisc) {
  // A slanted triangle z = 2 + x over a large area.
  const std::vector<DeepTriangle> slant{{Vector3d(-10, -10, -8), Vector3d(10, -10, 12), Vector3d(0, 20, 2)}};
  EXPECT_NEAR(free_depth(slant, {0, 0}, 0.5), 1.5, 1e-12);
  // A needle that passes over the rim, and one that misses.
  const std::vector<DeepTriangle> needle{{Vector3d(0.4, -5, 1), Vector3d(0.4, 5, 3), Vector3d(0.4, 0, 9)}};
  EXPECT_NEAR(free_depth(needle, {0, 0}, 0.5), 1 + 2 * (5 - 0.3) / 10, 1e-12);
  EXPECT_EQ(free_depth(needle, {0, 0}, 0.4), std::numeric_limits<double>::infinity());
  // A corner inside.
  const std::vector<DeepTriangle> spike{{Vector3d(0.1, 0, 0.7), Vector3d(5, 1, 9), Vector3d(5, -1, 9)}};
  EXPECT_NEAR(free_depth(spike, {0, 0}, 0.5), 0.7, 1e-12);
}

}  // namespace
}  // namespace meshgraft::test
