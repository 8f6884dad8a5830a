#include <meshgraft/deform/quality.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;
using Pairs = std::vector<TrianglePair>;

std::vector<Index> all_vertices(const Points& points) {
  std::vector<Index> all(static_cast<std::size_t>(points.rows()));
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

Pairs found(const Points& points, const Triangles& triangles) {
  return self_intersections(points, triangles, all_vertices(points));
}

Pairs found_new(const Points& rest, const Points& edited, const Triangles& triangles) {
  return new_self_intersections({rest, edited, triangles, all_vertices(rest)});
}

TestMesh joined(const TestMesh& a, const TestMesh& b) {
  TestMesh both{a.name + " and " + b.name, Points(a.size() + b.size(), 3),
                Triangles(a.triangles.rows() + b.triangles.rows(), 3)};
  both.positions << a.positions, b.positions;
  both.triangles << a.triangles, (b.triangles.array() + a.size()).matrix();
  return both;
}

// Returns two spheres of radius 1 whose centres are `distance` apart. No edge has the direction between them.
TestMesh two_spheres(int level, double distance) {
  const Eigen::Affine3d move(Eigen::Translation3d(distance * Vector3d(0.36, 0.48, 0.8)) *
                             Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
  return joined(icosphere(level), transformed(icosphere(level), move, "moved"));
}

// Returns a strip along a polyline in the plane y = 0, `rows` cells wide in y.
TestMesh strip(const std::vector<std::array<double, 2>>& profile, Index rows) {
  const auto width = static_cast<Index>(profile.size());
  TestMesh mesh{"strip", Points(width * (rows + 1), 3), Triangles(2 * (width - 1) * rows, 3)};
  Index t = 0;
  for (Index r = 0; r <= rows; ++r)
    for (Index c = 0; c < width; ++c) {
      const Index v = r * width + c;
      const auto [x, z] = profile[static_cast<std::size_t>(c)];
      mesh.positions.row(v) << x, r, z;
      if (c + 1 == width || r == rows) continue;
      mesh.triangles.row(t++) << v, v + 1, v + width + 1;
      mesh.triangles.row(t++) << v, v + width + 1, v + width;
    }
  return mesh;
}

// Returns whether an edge of triangle s passes through triangle t. Plain floating point suffices for surfaces
// in general position.
bool pierces(const Points& p, const Triangles& triangles, Index s, Index t) {
  const auto corner = [&](Index f, int c) -> Vector3d { return p.row(triangles(f, c)).transpose(); };
  const auto volume = [](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    return (b - a).cross(c - a).dot(d - a);
  };
  const Vector3d a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
  for (int k = 0; k < 3; ++k) {
    const Vector3d from = corner(s, k), to = corner(s, (k + 1) % 3);
    if (volume(a, b, c, from) * volume(a, b, c, to) >= 0) continue;
    const double u = volume(from, to, a, b), v = volume(from, to, b, c), w = volume(from, to, c, a);
    if ((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0)) return true;
  }
  return false;
}

TEST(Intersections, QualityCountsThemWhereThatIsAskedFor) {
  const TestMesh mesh = tetrahedron();
  const auto free = all_vertices(mesh.positions);
  const auto quality = [&](const QualityOptions& options) {
    return measure_quality({mesh.positions, mesh.positions, mesh.triangles, free}, options);
  };
  EXPECT_EQ(quality({}).new_self_intersections, 0);
  EXPECT_FALSE(quality({.self_intersections = false}).new_self_intersections.has_value());
}

TEST(Intersections, SurfacesAsTheyAreHaveNone) {
  const Eigen::Affine3d motion(Eigen::Translation3d(5, -40, 11) *
                               Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.5).normalized()));
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    EXPECT_EQ(found(mesh.positions, mesh.triangles), Pairs()) << "neighbours touch, and do not intersect";
    EXPECT_EQ(found_new(mesh.positions, mesh.positions, mesh.triangles), Pairs());
    const Points moved = transformed(mesh, motion, "moved").positions;
    EXPECT_EQ(found_new(mesh.positions, moved, mesh.triangles), Pairs());
  }
}

TEST(Intersections, AStripThroughItself) {
  for (const Index rows : {1, 2, 7}) {
    const TestMesh flat = strip({{0, 0}, {4, 0}, {7, 0}, {13, 0}}, rows);
    // The third column, at 0.5 of its length, passes through the first, at 0.625 of its length. So in each row
    // three pairs of triangles intersect, and two more across the end of each row but the last.
    const TestMesh folded = strip({{0, 0}, {4, 0}, {4, 3}, {1, -3}}, rows);
    const Pairs pairs = found_new(flat.positions, folded.positions, flat.triangles);
    EXPECT_EQ(static_cast<Index>(pairs.size()), 3 * rows + 2 * (rows - 1));
    for (const auto& [first, second] : pairs) {
      EXPECT_EQ(std::min(first % 6, second % 6) / 2, 0) << "the first column";
      EXPECT_EQ(std::max(first % 6, second % 6) / 2, 2) << "the third column";
      EXPECT_LE(std::abs(first / 6 - second / 6), 1);
    }
    const Quality quality =
        measure_quality({flat.positions, folded.positions, flat.triangles, all_vertices(flat.positions)});
    EXPECT_EQ(quality.new_self_intersections, static_cast<Index>(pairs.size()));
  }
}

TEST(Intersections, AFoldOntoItselfIsOneAndAnyOtherFoldIsNone) {
  const TestMesh flat = strip({{0, 0}, {1, 0}, {2, 0}}, 1);
  for (const double height : {0.5, 1e-3, 1e-15, 1e-300}) {
    const TestMesh folded = strip({{0, 0}, {1, 0}, {0, height}}, 1);
    EXPECT_EQ(found_new(flat.positions, folded.positions, flat.triangles), Pairs()) << height;
  }
  // Both triangles of each side overlap both of the other side. Triangles 0 and 3 share the fold's edge.
  const TestMesh closed = strip({{0, 0}, {1, 0}, {0, 0}}, 1);
  EXPECT_EQ(found_new(flat.positions, closed.positions, flat.triangles),
            (Pairs{{0, 2}, {0, 3}, {1, 2}, {1, 3}}));
}

TEST(Intersections, SpheresMovedIntoEachOtherAgreeWithATestOfAllPairs) {
  const TestMesh apart = two_spheres(2, 2.5);
  for (const double distance : {2.2, 1.9, 1.2, 0.3}) {
    const TestMesh moved = two_spheres(2, distance);
    Pairs expected;
    std::vector<Eigen::AlignedBox3d> boxes(moved.triangles.rows());
    for (Index t = 0; t < moved.triangles.rows(); ++t)
      for (int c = 0; c < 3; ++c) boxes[t].extend(moved.positions.row(moved.triangles(t, c)).transpose());
    for (Index s = 0; s < moved.triangles.rows() / 2; ++s)
      for (Index t = static_cast<Index>(moved.triangles.rows() / 2); t < moved.triangles.rows(); ++t)
        if (boxes[s].intersects(boxes[t]) && (pierces(moved.positions, moved.triangles, s, t) ||
                                              pierces(moved.positions, moved.triangles, t, s)))
          expected.push_back({s, t});
    const Pairs pairs = found_new(apart.positions, moved.positions, apart.triangles);
    EXPECT_EQ(pairs, expected);
    EXPECT_EQ(pairs.empty(), distance > 2);
    EXPECT_EQ(found_new(moved.positions, moved.positions, moved.triangles), Pairs())
        << "they were there at rest";
    EXPECT_EQ(found_new(moved.positions, apart.positions, moved.triangles), Pairs()) << "they are gone";
  }
}

TEST(Intersections, TheUnitAndTheWindingDoNotMatter) {
  const TestMesh moved = two_spheres(2, 1.2);
  const Pairs pairs = found(moved.positions, moved.triangles);
  ASSERT_FALSE(pairs.empty());
  for (const double size : {1e-200, 1e-6, 1e9, 1e150})
    EXPECT_EQ(found(size * moved.positions, moved.triangles), pairs) << size;
  Triangles turned = moved.triangles;
  for (Eigen::Index t = 0; t < turned.rows(); t += 3) std::swap(turned(t, 0), turned(t, 2));
  EXPECT_EQ(found(moved.positions, turned), pairs);
}

TEST(Intersections, OnlyTrianglesThatTouchFreeVerticesCount) {
  const TestMesh apart = two_spheres(2, 2.5), moved = two_spheres(2, 1.2);
  const Pairs pairs = found(moved.positions, moved.triangles);
  const auto touches = [&](Index triangle, const std::vector<Index>& free) {
    return std::any_of(free.begin(), free.end(),
                       [&](Index v) { return (moved.triangles.row(triangle).array() == v).any(); });
  };
  const Index half = moved.size() / 2;
  const std::vector<Index> free{3, 17, 40, 41, half + 5, half + 30};
  Pairs expected;
  for (const TrianglePair& pair : pairs)
    if (touches(pair[0], free) || touches(pair[1], free)) expected.push_back(pair);
  EXPECT_LT(expected.size(), pairs.size());
  EXPECT_EQ(self_intersections(moved.positions, moved.triangles, free), expected);
  EXPECT_EQ(self_intersections(moved.positions, moved.triangles, {}), Pairs());

  // With one sphere free, each of its intersections is listed once.
  std::vector<Index> first_sphere(static_cast<std::size_t>(half));
  std::iota(first_sphere.begin(), first_sphere.end(), Index{0});
  EXPECT_EQ(new_self_intersections({apart.positions, moved.positions, moved.triangles, first_sphere}), pairs);
}

TEST(Intersections, CountsAreThoseOfTheLists) {
  const TestMesh apart = two_spheres(2, 2.5), moved = two_spheres(2, 1.2), deeper = two_spheres(2, 0.9);
  for (const Index stride : {1, 7, 50, 1000}) {
    std::vector<Index> free;
    for (Index v = 0; v < moved.size(); v += stride) free.push_back(v);
    const auto count = [&](const Points& points) {
      return count_self_intersections(points, moved.triangles, free);
    };
    EXPECT_EQ(count(apart.positions), 0);
    EXPECT_EQ(count(moved.positions), std::ssize(self_intersections(moved.positions, moved.triangles, free)));
    EXPECT_EQ(count_new_self_intersections({moved.positions, deeper.positions, moved.triangles, free}),
              std::ssize(new_self_intersections({moved.positions, deeper.positions, moved.triangles, free})));
  }
}

TEST(Intersections, AFarTriangleDoesNotBlurTheOthers) {
  // The far triangle makes the spheres as small against the box as a float's last bit, and smaller.
  const TestMesh moved = two_spheres(2, 1.2);
  const Pairs pairs = found(moved.positions, moved.triangles);
  for (const double far : {1e9, 1e17, 1e300}) {
    TestMesh with_stray = joined(moved, tetrahedron());
    with_stray.positions.bottomRows(4).array() = far * (1 + with_stray.positions.bottomRows(4).array() / 8);
    EXPECT_EQ(found(with_stray.positions, with_stray.triangles), pairs) << far;
  }
}

TEST(Intersections, AroundASharedVertexWhatLiesBeyondItCounts) {
  // Two triangles share vertex 0. The tests move the second triangle's edge opposite to it.
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 3, 4, 0;
  Points rest(5, 3);
  rest << 0, 0, 0, 2, -1, 0, 2, 1, 0, -1, 0, 1, -1, 0, -1;
  EXPECT_EQ(found(rest, triangles), Pairs()) << "they touch in the vertex";
  Points pierced = rest;
  pierced.bottomRows(2) << 1, 0, 1, 1, 0, -1;
  EXPECT_EQ(found_new(rest, pierced, triangles), (Pairs{{0, 1}})) << "its far side goes through the first";
  pierced.bottomRows(2) << 5, 0, 1, 5, 0, -1;
  EXPECT_EQ(found_new(rest, pierced, triangles), (Pairs{{0, 1}})) << "the first one's far side goes through it";
  pierced.bottomRows(2) << 1, 0, 1, 1, 0, 0.25;
  EXPECT_EQ(found_new(rest, pierced, triangles), Pairs());
  pierced.bottomRows(2) << 1, 0, 0, 1, -2, 0;
  EXPECT_EQ(found_new(rest, pierced, triangles), (Pairs{{0, 1}})) << "they overlap in one plane";
  pierced.bottomRows(2) << 0, 2, 0, -2, 1, 0;
  EXPECT_EQ(found_new(rest, pierced, triangles), Pairs()) << "they lie side by side in one plane";
}

TEST(Intersections, WhatCoincidesAtRestIsNotNew) {
  // A sheet and its copy with vertices of its own coincide, and each face is listed twice.
  const TestMesh side = grid(6, 5);
  TestMesh sheet = joined(side, side);
  const Triangles once = sheet.triangles;
  sheet.triangles.resize(2 * once.rows(), 3);
  sheet.triangles << once, once;
  EXPECT_GE(found(sheet.positions, sheet.triangles).size(), static_cast<std::size_t>(once.rows()));
  Points bent = sheet.positions;
  for (Eigen::Index v = 0; v < bent.rows(); ++v) bent(v, 2) += 0.1 * bent(v, 0) * bent(v, 0);
  EXPECT_EQ(found_new(sheet.positions, bent, sheet.triangles), Pairs());

  TestMesh twice = side;
  twice.triangles.resize(2 * side.triangles.rows(), 3);
  twice.triangles << side.triangles, side.triangles;
  EXPECT_EQ(found(twice.positions, twice.triangles), Pairs())
      << "faces with the same vertices share all of them";
}

TEST(Intersections, ManyFacesMayMeetInAnEdge) {
  Triangles leaves(3, 3);
  leaves << 0, 1, 2, 1, 0, 3, 0, 1, 4;
  Points book(5, 3);
  book << 0, 0, 0, 0, 1, 0, 1, 0, 0, -1, 0, 0.5, -1, 0, -0.5;
  EXPECT_EQ(found(book, leaves), Pairs());
  Points closed = book;
  closed.row(4) << 3, 0.5, 0;
  EXPECT_EQ(found_new(book, closed, leaves), (Pairs{{0, 2}}));
}

TEST(Intersections, DegenerateAndNonFiniteTrianglesAreIgnored) {
  const TestMesh apart = two_spheres(2, 2.5), moved = two_spheres(2, 1.2);
  const Pairs pairs = found(moved.positions, moved.triangles);
  // Appends faces that repeat corners, as points or needles, to the spheres' triangles.
  Triangles triangles(moved.triangles.rows() + 3, 3);
  triangles << moved.triangles, Triangles::Constant(1, 3, 4), Triangles::Constant(2, 3, 9);
  triangles.bottomRows(2) << 4, 9, 9, 100, 4, 100;
  EXPECT_EQ(found_new(apart.positions, moved.positions, triangles), pairs);
  EXPECT_EQ(found(Points::Ones(moved.size(), 3), triangles), Pairs()) << "all in one point";

  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Index lost = moved.triangles(pairs.front()[0], 1);
    Points broken = moved.positions;
    broken(lost, 1) = bad;
    Pairs without, with;
    for (const TrianglePair& pair : pairs) {
      const bool has_it = (moved.triangles.row(pair[0]).array() == lost).any() ||
                          (moved.triangles.row(pair[1]).array() == lost).any();
      (has_it ? with : without).push_back(pair);
    }
    EXPECT_EQ(found(broken, moved.triangles), without);
    EXPECT_EQ(found_new(broken, moved.positions, moved.triangles), with) << "nowhere at rest";
    EXPECT_EQ(found(Points::Constant(moved.size(), 3, bad), moved.triangles), Pairs());
  }
  EXPECT_EQ(found(Points(0, 3), Triangles(0, 3)), Pairs());
}

TEST(Intersections, LayersWhoseBoxesAllOverlapAreToldApart) {
  // The layers are parallel to no axis; the last triangle passes through all of them.
  constexpr Index layers = 1500;
  Points points(3 * (layers + 1), 3);
  Triangles triangles(layers + 1, 3);
  for (Index t = 0; t <= layers; ++t) {
    const double z = 1e-4 * t;
    points.middleRows(3 * t, 3) << 0, 0, z, 1, 0, z + 0.3, 0, 1, z + 0.7;
    triangles.row(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  }
  points.bottomRows(3) << 0.2, 0.2, -1, 0.3, 0.2, -1, 0.2, 0.2, 5;
  Pairs expected;
  for (Index t = 0; t < layers; ++t) expected.push_back({t, layers});
  for (const double size : {1.0, 1e-200, 1e150})
    for (const int threads : {0, 1})
      EXPECT_EQ(self_intersections(size * points, triangles, all_vertices(points), {.threads = threads}),
                expected)
          << size;
}

TEST(Intersections, TheNumberOfThreadsDoesNotMatter) {
  const TestMesh apart = two_spheres(4, 2.5), moved = two_spheres(4, 1.2);
  const auto free = all_vertices(apart.positions);
  const auto with_threads = [&](int threads) {
    return new_self_intersections({apart.positions, moved.positions, apart.triangles, free},
                                  {.threads = threads});
  };
  const auto one = with_threads(1);
  EXPECT_GT(one.size(), 100u);
  EXPECT_TRUE(std::is_sorted(one.begin(), one.end()));
  EXPECT_EQ(with_threads(2), one);
  EXPECT_EQ(with_threads(0), one);
}

TEST(Intersections, MalformedCallsAreNamed) {
  const TestMesh mesh = tetrahedron();
  const auto id = [&](const Points& edited, const Triangles& triangles, const std::vector<Index>& free) {
    try {
      new_self_intersections({mesh.positions, edited, triangles, free});
    } catch (const Error& error) {
      return std::string(error.id());
    }
    return std::string("no error");
  };
  EXPECT_EQ(id(Points::Zero(3, 3), mesh.triangles, {}), "core.size_mismatch");
  EXPECT_EQ(id(mesh.positions, mesh.triangles, {4}), "deform.no_such_free_vertex");
  EXPECT_EQ(id(mesh.positions, mesh.triangles, {-1}), "deform.no_such_free_vertex");
  EXPECT_EQ(id(mesh.positions, Triangles::Constant(1, 3, 9), {}), "core.no_such_vertex");
}

TEST(Intersections, ARequestToStopIsHeard) {
  const TestMesh mesh = two_spheres(3, 1.2);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(self_intersections(mesh.positions, mesh.triangles, all_vertices(mesh.positions),
                                  {.stop_token = stop.get_token()}),
               Error);
}

}  // namespace
}  // namespace meshgraft::test
