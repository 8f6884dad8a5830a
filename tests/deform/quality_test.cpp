#include <meshgraft/deform/quality.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "deform/measure/quality_of_surface.h"
#include "support/limb_cases.h"

namespace meshgraft {
namespace {

struct Surface {
  std::string name;
  Points positions;
  Triangles triangles;
  bool closed = false;
};

// Returns a grid of (columns+1)×(rows+1) vertices over [0, columns]×[0, rows], with two triangles a cell.
Surface grid(Index columns, Index rows) {
  Surface sheet{"sheet", Points((columns + 1) * (rows + 1), 3), Triangles(2 * columns * rows, 3), false};
  for (Index r = 0; r <= rows; ++r) {
    for (Index c = 0; c <= columns; ++c) sheet.positions.row(r * (columns + 1) + c) << c, r, 0;
  }
  Index t = 0;
  for (Index r = 0; r < rows; ++r) {
    for (Index c = 0; c < columns; ++c) {
      const Index v = r * (columns + 1) + c, above = v + columns + 1;
      sheet.triangles.row(t++) << v, v + 1, above + 1;
      sheet.triangles.row(t++) << v, above + 1, above;
    }
  }
  return sheet;
}

Surface bumpy_sheet() {
  Surface sheet = grid(30, 24);
  sheet.name = "bumpy sheet";
  for (Eigen::Index v = 0; v < sheet.positions.rows(); ++v) {
    const auto p = sheet.positions.row(v);
    sheet.positions(v, 2) = 0.8 * std::sin(0.7 * p[0]) * std::cos(0.9 * p[1]);
  }
  return sheet;
}

// Returns a closed torus of m×n vertices, oriented outward.
Surface torus(Index m, Index n) {
  Surface ring{"torus", Points(m * n, 3), Triangles(2 * m * n, 3), true};
  Index t = 0;
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < n; ++j) {
      const double u = 2 * std::numbers::pi * i / m, w = 2 * std::numbers::pi * j / n;
      const double radius = 3 + std::cos(w);
      ring.positions.row(i * n + j) << radius * std::cos(u), radius * std::sin(u), std::sin(w);
      const Index i1 = (i + 1) % m, j1 = (j + 1) % n;
      ring.triangles.row(t++) << i * n + j, i1 * n + j, i1 * n + j1;
      ring.triangles.row(t++) << i * n + j, i1 * n + j1, i * n + j1;
    }
  }
  return ring;
}

Surface tetrahedron() {
  Surface solid{"tetrahedron", Points(4, 3), Triangles(4, 3), true};
  solid.positions << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  solid.triangles << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
  return solid;
}

// Returns a flat fan of needles, with height to length down to 1:1000.
Surface needles() {
  Surface fan{"needles", Points(12, 3), Triangles(10, 3), false};
  fan.positions.row(0) << 0, 0, 0;
  for (Index k = 0; k < 11; ++k) fan.positions.row(k + 1) << 1000, k, 0;
  for (Index k = 0; k < 10; ++k) fan.triangles.row(k) << 0, k + 1, k + 2;
  return fan;
}

std::vector<Surface> families() {
  return {grid(12, 9), bumpy_sheet(), torus(40, 18), tetrahedron(), needles()};
}

std::vector<Index> all_vertices(const Surface& surface) {
  std::vector<Index> all(static_cast<std::size_t>(surface.positions.rows()));
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

Points transformed(const Points& points, const Eigen::Affine3d& map) {
  Points result(points.rows(), 3);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    result.row(v) = (map * points.row(v).transpose()).transpose();
  }
  return result;
}

Eigen::Affine3d rigid_motion() {
  return Eigen::Translation3d(5, -40, 11) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized());
}

std::array<double, 7> sigmas(const Quality& q) {
  return {q.sigma_min, q.sigma_p1, q.sigma_p5, q.sigma_p50, q.sigma_p95, q.sigma_p99, q.sigma_max};
}

std::vector<double> numbers(const Quality& q) {
  std::vector<double> all{q.area_ratio,       q.area_ratio_free,  q.volume_ratio.value_or(-1),
                          q.edge_rms,         q.dihedral_p50_deg, q.dihedral_p99_deg,
                          q.dihedral_max_deg, q.rim_jump_max_deg, static_cast<double>(q.flipped_faces),
                          q.width_min};
  const auto s = sigmas(q);
  all.insert(all.end(), s.begin(), s.end());
  return all;
}

void expect_unmoved(const Quality& q, double tolerance) {
  EXPECT_NEAR(q.area_ratio, 1, tolerance);
  EXPECT_NEAR(q.area_ratio_free, 1, tolerance);
  if (q.volume_ratio) {
    EXPECT_NEAR(*q.volume_ratio, 1, tolerance);
  }
  EXPECT_NEAR(q.edge_rms, 0, tolerance);
  for (const double sigma : sigmas(q)) EXPECT_NEAR(sigma, 1, tolerance);
  EXPECT_NEAR(q.dihedral_max_deg, 0, 60 * tolerance);
  EXPECT_NEAR(q.rim_jump_max_deg, 0, 60 * tolerance);
  EXPECT_EQ(q.flipped_faces, 0);
}

TEST(Quality, IdentityIsExact) {
  for (const Surface& s : families()) {
    SCOPED_TRACE(s.name);
    const Quality q = measure_quality({s.positions, s.positions, s.triangles, all_vertices(s)});
    expect_unmoved(q, 0);
    EXPECT_EQ(q.volume_ratio.has_value(), s.closed);
  }
}

TEST(Quality, RigidMotionsLeaveEverythingAsItWas) {
  for (const Surface& s : families()) {
    SCOPED_TRACE(s.name);
    const Points moved = transformed(s.positions, rigid_motion());
    expect_unmoved(measure_quality({s.positions, moved, s.triangles, all_vertices(s)}), 1e-9);
  }
}

TEST(Quality, UniformScaleShowsInEveryDimension) {
  for (const Surface& s : families()) {
    for (const double scale : {0.25, 1.5, 30.0}) {
      SCOPED_TRACE(s.name + " × " + std::to_string(scale));
      const Quality q = measure_quality({s.positions, scale * s.positions, s.triangles, all_vertices(s)});
      EXPECT_NEAR(q.edge_rms, std::abs(scale - 1), 1e-12 * scale);
      for (const double sigma : sigmas(q)) EXPECT_NEAR(sigma, scale, 1e-12 * scale);
      EXPECT_NEAR(q.area_ratio, scale * scale, 1e-12 * scale * scale);
      EXPECT_NEAR(q.area_ratio_free, scale * scale, 1e-12 * scale * scale);
      if (s.closed) {
        EXPECT_NEAR(q.volume_ratio.value(), std::pow(scale, 3), 1e-12 * std::pow(scale, 3));
      }
      EXPECT_NEAR(q.dihedral_max_deg, 0, 1e-9);
      EXPECT_EQ(q.flipped_faces, 0);
    }
  }
}

TEST(Quality, StretchOfAPlaneGivesItsSingularValues) {
  for (const double squash : {0.0, 1e-3, 0.5}) {
    const Surface sheet = grid(12, 9);
    const Eigen::Affine3d stretch(Eigen::Scaling(2.0, squash, 7.0));
    const Points edited = transformed(sheet.positions, rigid_motion() * stretch);
    const Quality q = measure_quality({sheet.positions, edited, sheet.triangles, all_vertices(sheet)});
    EXPECT_NEAR(q.sigma_min, squash, 1e-12);
    EXPECT_NEAR(q.sigma_p1, squash, 1e-12);
    EXPECT_NEAR(q.sigma_p50, squash, 1e-12) << "half of all values, and the nearest rank takes the lower one";
    EXPECT_NEAR(q.sigma_p95, 2, 1e-12);
    EXPECT_NEAR(q.sigma_max, 2, 1e-12);
    EXPECT_NEAR(q.area_ratio, 2 * squash, 1e-12);
  }
}

TEST(Quality, ShearHasTheSingularValuesOfItsMatrix) {
  const Surface sheet = grid(7, 5);
  const double k = 0.8;
  Points edited = sheet.positions;
  edited.col(0) += k * sheet.positions.col(1);
  const Quality q = measure_quality({sheet.positions, edited, sheet.triangles, all_vertices(sheet)});
  const double larger = k / 2 + std::sqrt(1 + k * k / 4);  // of (1 k; 0 1); the smaller one is its inverse
  EXPECT_NEAR(q.sigma_max, larger, 1e-12);
  EXPECT_NEAR(q.sigma_min, 1 / larger, 1e-12);
  EXPECT_NEAR(q.area_ratio, 1, 1e-12);
}

// Returns a strip along x, folded about the lines x = 1, 2, … by these angles without stretch.
Surface folded_strip(const std::vector<double>& fold_deg) {
  Surface strip = grid(static_cast<Index>(fold_deg.size()) + 1, 2);
  const auto columns = static_cast<Eigen::Index>(fold_deg.size()) + 2;
  double x = 0, z = 0, heading = 0;
  for (Eigen::Index c = 0; c < columns; ++c) {
    for (Eigen::Index v = c; v < strip.positions.rows(); v += columns) {
      strip.positions(v, 0) = x;
      strip.positions(v, 2) = z;
    }
    if (c > 0 && c + 1 < columns) heading += fold_deg[static_cast<std::size_t>(c - 1)] * std::numbers::pi / 180;
    x += std::cos(heading);
    z += std::sin(heading);
  }
  return strip;
}

TEST(Quality, FoldsOfAStripAreItsDihedralChanges) {
  const Surface flat = folded_strip({0, 0, 0, 0});
  const Surface folded = folded_strip({10, -25, 70, 150});
  const Quality q = measure_quality({flat.positions, folded.positions, flat.triangles, all_vertices(flat)});
  EXPECT_NEAR(q.dihedral_max_deg, 150, 1e-9);
  EXPECT_NEAR(q.dihedral_p50_deg, 0, 1e-9) << "most edges lie within a facet or along the strip";
  EXPECT_NEAR(q.edge_rms, 0, 1e-12);
  for (const double sigma : sigmas(q)) EXPECT_NEAR(sigma, 1, 1e-12);
}

TEST(Quality, FoldsCountWithTheirSign) {
  const Surface up = folded_strip({30}), down = folded_strip({-30});
  EXPECT_NEAR(measure_quality({up.positions, down.positions, up.triangles, all_vertices(up)}).dihedral_max_deg,
              60, 1e-9);
  const Surface sharp_up = folded_strip({170}), sharp_down = folded_strip({-170});
  const Quality through_closed =
      measure_quality({sharp_up.positions, sharp_down.positions, sharp_up.triangles, all_vertices(sharp_up)});
  EXPECT_NEAR(through_closed.dihedral_max_deg, 20, 1e-9) << "the short way round";
}

TEST(Quality, FoldsDoNotDependOnTheWinding) {
  Surface flat = folded_strip({0, 0, 0});
  const Surface folded = folded_strip({40, 40, 40});
  for (Eigen::Index t = 0; t < flat.triangles.rows(); t += 3)
    std::swap(flat.triangles(t, 1), flat.triangles(t, 2));
  const Quality q = measure_quality({flat.positions, folded.positions, flat.triangles, all_vertices(flat)});
  EXPECT_NEAR(q.dihedral_max_deg, 40, 1e-9);
}

TEST(Quality, NearestRankPercentiles) {
  // The k-th of 100 separate triangles is stretched along x by 1 + k/100, k = 1 … 100. So 100 of the 200
  // singular values are 1.
  Points rest(300, 3), edited(300, 3);
  Triangles triangles(100, 3);
  for (Index k = 0; k < 100; ++k) {
    rest.middleRows(3 * k, 3) << k, 0, 0, k + 0.5, 0, 0, k, 0.5, 0;
    edited.middleRows(3 * k, 3) = rest.middleRows(3 * k, 3);
    edited.middleRows(3 * k, 3).col(0) *= 1 + (k + 1) / 100.0;
    triangles.row(k) << 3 * k, 3 * k + 1, 3 * k + 2;
  }
  std::vector<Index> free(300);
  std::iota(free.begin(), free.end(), Index{0});
  const Quality q = measure_quality({rest, edited, triangles, free});
  EXPECT_NEAR(q.sigma_p50, 1.00, 1e-12);  // rank 100 of 200
  EXPECT_NEAR(q.sigma_p95, 1.90, 1e-12);  // rank 190
  EXPECT_NEAR(q.sigma_p99, 1.98, 1e-12);  // rank 198
  EXPECT_NEAR(q.sigma_max, 2.00, 1e-12);
}

TEST(Quality, FlippedFacesAreCounted) {
  const Surface sheet = grid(8, 8);
  Points edited = sheet.positions;
  edited.row(8) << 6.5, 1.5, 0;  // a corner of the sheet, pulled over the opposite side of its one or two faces
  const Quality q = measure_quality({sheet.positions, edited, sheet.triangles, all_vertices(sheet)});
  EXPECT_EQ(q.flipped_faces, 1);

  const Points turned = transformed(sheet.positions, rigid_motion());
  const Quality turned_as_one =
      measure_quality({sheet.positions, turned, sheet.triangles, all_vertices(sheet)});
  EXPECT_EQ(turned_as_one.flipped_faces, 0) << "a face is compared with its neighbours, not with its past";
}

TEST(Quality, FacesThatLookedAwayAtRestAreNotFlipped) {
  Surface sheet = grid(8, 8);
  sheet.positions.row(8) << 6.5, 1.5, 0;
  Points edited = sheet.positions;
  edited.col(2).setLinSpaced(0, 0.1);
  EXPECT_EQ(measure_quality({sheet.positions, edited, sheet.triangles, all_vertices(sheet)}).flipped_faces, 0);
}

TEST(Quality, OnlyWhatTouchesFreeVerticesMatters) {
  const Surface sheet = bumpy_sheet();
  const std::vector<Index> free{200, 201, 202, 231, 232};
  Points edited = sheet.positions;
  edited.row(201) << 14, 6, 3;
  const Quality q = measure_quality({sheet.positions, edited, sheet.triangles, free});
  ASSERT_GT(q.dihedral_max_deg, 1);

  // Changes beyond the rings of the free vertices affect only the total area.
  Points crumpled = edited;
  crumpled.bottomRows(300) *= 0.1;
  auto here = numbers(q), there = numbers(measure_quality({sheet.positions, crumpled, sheet.triangles, free}));
  EXPECT_NE(here[0], there[0]);
  here.erase(here.begin());
  there.erase(there.begin());
  EXPECT_EQ(here, there);

  const Quality nothing_free = measure_quality({sheet.positions, crumpled, sheet.triangles, {}});
  EXPECT_EQ(nothing_free.area_ratio_free, 1);
  EXPECT_EQ(nothing_free.sigma_min, 1);
  EXPECT_EQ(nothing_free.edge_rms, 0);
  EXPECT_LT(nothing_free.area_ratio, 1);
}

TEST(Quality, OnlyAreaAndVolumeDependOnFacesFarAway) {
  const Surface ring = torus(60, 18);
  std::vector<Index> free;  // columns 28 … 31, at the other side of the ring than its first vertex
  for (Index v = 28 * 18; v < 32 * 18; ++v) free.push_back(v);
  Points edited = ring.positions;
  for (const Index v : free) edited.row(v) += Eigen::RowVector3d(0, 0.1 * std::sin(v), 0.2 * std::cos(3 * v));
  const Quality whole = measure_quality({ring.positions, edited, ring.triangles, free});
  ASSERT_GT(whole.dihedral_max_deg, 1);
  ASSERT_TRUE(whole.volume_ratio);

  // The ring without the faces of its first column, and what of it shares a vertex with a free face.
  const Triangles open = ring.triangles.bottomRows(ring.triangles.rows() - 36);
  const Triangles near = ring.triangles.middleRows(26 * 36, 8 * 36);
  for (const Triangles& part : {open, near}) {
    const Quality q = measure_quality({ring.positions, edited, part, free});
    EXPECT_FALSE(q.volume_ratio);
    EXPECT_NE(q.area_ratio, whole.area_ratio);
    EXPECT_NEAR(q.area_ratio_free, whole.area_ratio_free, 1e-12);
    EXPECT_NEAR(q.edge_rms, whole.edge_rms, 1e-12);
    EXPECT_NEAR(q.dihedral_p50_deg, whole.dihedral_p50_deg, 1e-9);
    EXPECT_NEAR(q.dihedral_p99_deg, whole.dihedral_p99_deg, 1e-9);
    EXPECT_NEAR(q.rim_jump_max_deg, whole.rim_jump_max_deg, 1e-9);
    EXPECT_EQ(q.flipped_faces, whole.flipped_faces);
    EXPECT_EQ(q.new_self_intersections, whole.new_self_intersections);
    for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(sigmas(q)[k], sigmas(whole)[k], 1e-12);
  }
}

TEST(Quality, AFoldAlongARimIsAJump) {
  const Surface flat = folded_strip({0, 0, 0, 0, 0});
  std::vector<Index> free;  // columns 3 … 6; no vertex of the fold along column 2 is free
  for (Index v = 0; v < static_cast<Index>(flat.positions.rows()); ++v) {
    if (v % 7 >= 3) free.push_back(v);
  }
  const Surface folded = folded_strip({0, 35, 0, 0, 0});
  const Quality q = measure_quality({flat.positions, folded.positions, flat.triangles, free});
  EXPECT_NEAR(q.rim_jump_max_deg, 35, 1e-9);
  EXPECT_NEAR(q.dihedral_max_deg, 0, 1e-9);

  const Surface folded_within = folded_strip({0, 0, 0, 35, 0});
  const Quality within = measure_quality({flat.positions, folded_within.positions, flat.triangles, free});
  EXPECT_NEAR(within.rim_jump_max_deg, 0, 1e-9);
  EXPECT_NEAR(within.dihedral_max_deg, 35, 1e-9);
}

TEST(Quality, WidthIsThatOfTheNarrowestPlace) {
  for (const test::LimbShape& shape : {test::LimbShape{}, test::LimbShape{.square = true, .uneven = true}}) {
    const test::Limb limb = test::make_limb(shape);
    const auto pinched_by = [&](double share) {  // at the middle
      Points edited = limb.mesh.positions;
      for (const Index v : limb.middle) {
        const double height = (edited(v, 2) - limb.length / 2) / limb.length;
        edited.row(v).head<2>() *= 1 - (1 - share) * std::exp(-60 * height * height);
      }
      return measure_quality({limb.mesh.positions, edited, limb.mesh.triangles, limb.middle});
    };
    for (const double share : {1.0, 0.7, 0.2}) {
      const Quality quality = pinched_by(share);
      EXPECT_NEAR(quality.width_min, share, 0.02) << limb.mesh.name;
      ASSERT_GE(quality.narrowest_vertex, 0);
      if (share < 1) {
        EXPECT_NEAR(limb.mesh.positions(quality.narrowest_vertex, 2), limb.length / 2, 0.5);
      }
    }
    const Points moved = transformed(limb.mesh.positions, rigid_motion());
    EXPECT_NEAR(measure_quality({limb.mesh.positions, moved, limb.mesh.triangles, limb.middle}).width_min, 1,
                1e-9);
    Triangles inward = limb.mesh.triangles;
    inward.col(0).swap(inward.col(1));  // rays leave the body at once: nothing is enclosed on that side
    const Quality outside = measure_quality({limb.mesh.positions, moved, inward, limb.middle});
    EXPECT_EQ(outside.narrowest_vertex, -1);
    EXPECT_EQ(outside.width_min, 1);
  }
  const test::TestMesh ball = test::icosphere(3);
  for (const double depth : {2.5, 4.0}) {  // the cap comes out on the other side
    Points edited = ball.positions;
    for (Index v = 0; v < ball.size(); ++v)
      if (edited(v, 2) > 0.7) edited(v, 2) -= depth;
    std::vector<Index> all(static_cast<std::size_t>(ball.size()));
    std::iota(all.begin(), all.end(), Index{0});
    EXPECT_EQ(measure_quality({ball.positions, edited, ball.triangles, all}).width_min, 0) << depth;
  }
  // A vertex without faces, far away, changes nothing.
  Points rest(ball.size() + 1, 3), squashed = rest;
  rest << ball.positions, Eigen::RowVector3d(1e9, 0, 0);
  squashed << ball.positions * Eigen::Vector3d(1, 1, 0.4).asDiagonal(), Eigen::RowVector3d(1e9, 1, 0);
  std::vector<Index> ball_and_far(static_cast<std::size_t>(rest.rows()));
  std::iota(ball_and_far.begin(), ball_and_far.end(), Index{0});
  EXPECT_NEAR(measure_quality({rest, squashed, ball.triangles, ball_and_far}).width_min, 0.4, 0.02);

  const Surface sheet = folded_strip({0, 0, 0, 0, 0});
  std::vector<Index> all(static_cast<std::size_t>(sheet.positions.rows()));
  std::iota(all.begin(), all.end(), Index{0});
  EXPECT_EQ(measure_quality({sheet.positions, 0.5 * sheet.positions, sheet.triangles, all}).narrowest_vertex,
            -1);
}

TEST(Quality, VolumeOnlyOfClosedOrientedSurfaces) {
  const Surface ring = torus(20, 12);
  const auto volume_ratio = [&](const Points& rest, const Triangles& triangles) {
    return measure_quality({rest, 2 * rest, triangles, {}}).volume_ratio;
  };
  EXPECT_NEAR(volume_ratio(ring.positions, ring.triangles).value(), 8, 1e-12);
  EXPECT_FALSE(volume_ratio(ring.positions, ring.triangles.topRows(100)).has_value());

  Triangles one_turned = ring.triangles;
  std::swap(one_turned(7, 0), one_turned(7, 1));
  EXPECT_FALSE(volume_ratio(ring.positions, one_turned).has_value());

  Points flattened = ring.positions;
  flattened.col(2).setZero();
  EXPECT_FALSE(volume_ratio(flattened, ring.triangles).has_value()) << "closed, but it encloses nothing";
}

TEST(Quality, DegenerateFacesAreLeftOut) {
  Surface sheet = bumpy_sheet();
  const Points edited = transformed(sheet.positions, rigid_motion() * Eigen::Scaling(1.0, 2.0, 0.5));
  const Quality clean = measure_quality({sheet.positions, edited, sheet.triangles, all_vertices(sheet)});

  // Appends faces that repeat a vertex and have edges that the surface lacks.
  Triangles triangles(sheet.triangles.rows() + 3, 3);
  triangles.topRows(sheet.triangles.rows()) = sheet.triangles;
  triangles.bottomRows(3) << 5, 5, 400, 0, 744, 744, 9, 9, 9;
  const Quality q = measure_quality({sheet.positions, edited, triangles, all_vertices(sheet)});
  EXPECT_EQ(sigmas(q), sigmas(clean));
  EXPECT_EQ(q.edge_rms, clean.edge_rms);
  EXPECT_EQ(q.dihedral_max_deg, clean.dihedral_max_deg);
  EXPECT_EQ(q.area_ratio, clean.area_ratio);
}

TEST(Quality, NeverNaN) {
  Surface sheet = grid(6, 6);
  sheet.positions.row(8) = sheet.positions.row(9);  // makes faces without area at rest
  Points edited = sheet.positions;
  edited.topRows(20).rowwise() = edited.row(3).eval();  // collapses faces to points in the edit
  const Quality q = measure_quality({sheet.positions, edited, sheet.triangles, all_vertices(sheet)});
  for (const double number : numbers(q)) EXPECT_TRUE(std::isfinite(number));
  EXPECT_EQ(q.sigma_min, 0);

  edited(30, 1) = std::numeric_limits<double>::quiet_NaN();
  sheet.positions(45, 2) = std::numeric_limits<double>::infinity();
  const Quality broken = measure_quality({sheet.positions, edited, sheet.triangles, all_vertices(sheet)});
  for (const double number : numbers(broken)) EXPECT_TRUE(std::isfinite(number));

  const Quality all_in_a_point = measure_quality(
      {Points::Ones(4, 3), Points::Ones(4, 3), tetrahedron().triangles, std::vector<Index>{0, 1, 2, 3}});
  expect_unmoved(all_in_a_point, 0);
  expect_unmoved(measure_quality({Points(0, 3), Points(0, 3), Triangles(0, 3), {}}), 0);
}

TEST(Quality, FarAndTinyScenesMeasureAlike) {
  for (const Surface& s : families()) {
    SCOPED_TRACE(s.name);
    const Eigen::Affine3d edit = rigid_motion() * Eigen::Scaling(1.0, 1.5, 0.75);
    const Points edited = transformed(s.positions, edit);
    const auto near = numbers(measure_quality({s.positions, edited, s.triangles, all_vertices(s)}));

    const auto expect_near = [&](const std::vector<double>& other, double tolerance) {
      for (std::size_t k = 0; k < near.size(); ++k) EXPECT_NEAR(other[k], near[k], tolerance) << "number " << k;
    };
    for (const double size : {1e-200, 1e-6, 1e150}) {
      expect_near(numbers(measure_quality({size * s.positions, size * edited, s.triangles, all_vertices(s)})),
                  1e-9);
    }
    Eigen::RowVector3d offset(1e9, -1e9, 1e9);
    const Points far_rest = s.positions.rowwise() + offset, far_edited = edited.rowwise() + offset;
    // Coordinates are rounded by 1e-7, edges are down to 0.3 long, and angles are in degrees.
    expect_near(numbers(measure_quality({far_rest, far_edited, s.triangles, all_vertices(s)})), 1e-4);
  }
}

TEST(Quality, IsTheSameWithKnownConnectivity) {
  for (const Surface& s : families()) {
    const auto surface = find_simple_surface(make_mesh(s.positions, s.triangles));
    ASSERT_TRUE(surface) << s.name;
    for (const double size : {0.0, 0.05, 2.0}) {  // within the box of the surface, and beyond it
      SCOPED_TRACE(s.name + ", moved by " + std::to_string(size));
      Points moved = s.positions;
      std::vector<Index> free;
      for (Index v = 0; v < static_cast<Index>(moved.rows()) / 3; ++v) {
        free.push_back(v);
        moved.row(v) += size * Eigen::RowVector3d(std::sin(v), std::cos(2.0 * v), std::sin(3.0 * v));
      }
      const EditedMesh mesh{s.positions, moved, s.triangles, free};
      const Quality with = measure_quality(mesh, *surface, {}), without = measure_quality(mesh);
      EXPECT_EQ(numbers(with), numbers(without));
      EXPECT_EQ(with.narrowest_vertex, without.narrowest_vertex);
    }
  }
}

TEST(Quality, TheNumberOfThreadsDoesNotMatter) {
  const Surface ring = torus(150, 90);
  Points edited = ring.positions;
  std::mt19937 random(7);
  for (double& x : edited.reshaped()) x += 0.02 * (static_cast<double>(random()) / 4294967296.0 - 0.5);
  const auto with_threads = [&](int threads) {
    Context context;
    context.threads = threads;
    return numbers(measure_quality({ring.positions, edited, ring.triangles, all_vertices(ring)}, {}, context));
  };
  EXPECT_EQ(with_threads(1), with_threads(2));
  EXPECT_EQ(with_threads(1), with_threads(0));
}

TEST(Quality, MalformedCallsAreNamed) {
  const Surface sheet = grid(2, 2);
  const auto id = [&](const Points& edited, const Triangles& triangles, std::vector<Index> free) {
    try {
      measure_quality({sheet.positions, edited, triangles, free});
    } catch (const Error& error) {
      return std::string(error.id());
    }
    return std::string("no error");
  };
  EXPECT_EQ(id(Points::Zero(4, 3), sheet.triangles, {}), "core.size_mismatch");
  EXPECT_EQ(id(sheet.positions, sheet.triangles, {9}), "deform.no_such_free_vertex");
  EXPECT_EQ(id(sheet.positions, Triangles::Constant(1, 3, 9), {}), "core.no_such_vertex");
}

}  // namespace
}  // namespace meshgraft
