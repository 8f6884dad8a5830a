// Triangles of a seam are well shaped, and its bend goes on from target to source.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "merge/seam.h"
#include "merge/seam_grafts.h"
#include "mesh/shapes.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

TEST(Seam, HasWellShapedTrianglesAndNoFolds) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamReport report = make_seam(graft.target, graft.source, graft.pairs).report;
    EXPECT_GE(report.angle_p1_deg, 15);
    EXPECT_LE(report.dihedral_p99_deg,
              std::max(report.target_dihedral_p99_deg, report.source_dihedral_p99_deg) + 5);
  }
}

// Checks that fairing does not narrow a tube at the seam.
TEST(Seam, KeepsARoundTubeRound) {
  for (const int around : {12, 24, 96}) {
    const Graft graft = tubes(around, around, true);
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    const Eigen::VectorXd radius = result.mesh.positions.leftCols(2).rowwise().norm();
    EXPECT_NEAR(radius.minCoeff(), 1, 0.4 / around) << around;
    EXPECT_NEAR(radius.maxCoeff(), 1, 0.4 / around) << around;
  }
}

// Returns the largest angle between the normals of a strip triangle and of a face beside it.
double largest_bend_deg(const SeamResult& result) {
  const std::set<Index> strip(result.new_faces.begin(), result.new_faces.end());
  const auto normal = [&](Index f) {
    const auto face = result.mesh.faces[f];
    const Eigen::Vector3d a = result.mesh.positions.row(face[0]), b = result.mesh.positions.row(face[1]),
                          c = result.mesh.positions.row(face[2]);
    return Eigen::Vector3d((b - a).cross(c - a).normalized());
  };
  std::map<std::array<Index, 2>, std::vector<Index>> beside;
  for (Index f = 0; f < result.mesh.face_count(); ++f) {
    const auto face = result.mesh.faces[f];
    for (std::size_t c = 0; c < face.size(); ++c) {
      const auto [a, b] = std::minmax(face[c], face[(c + 1) % face.size()]);
      beside[{a, b}].push_back(f);
    }
  }
  double cosine = 1;
  for (const auto& [edge, faces] : beside) {
    if (faces.size() != 2 || (!strip.contains(faces[0]) && !strip.contains(faces[1]))) continue;
    cosine = std::min(cosine, normal(faces[0]).dot(normal(faces[1])));
  }
  return std::acos(cosine) * 180 / std::numbers::pi;
}

// The target's row at the strip is ragged and may reach past the source's loop.
TEST(Seam, MendsARaggedLoopOfTheTarget) {
  constexpr int around = 48, below_top = 5;
  for (const bool past_the_source : {false, true}) {
    Graft graft = tubes(around, around, true);
    const double row = 2 * std::numbers::pi / around;
    for (int k = 0; k < around; k += 2) graft.target.positions(below_top * around + k, 2) += 0.8 * row;
    if (past_the_source) {
      for (const int k : {10, 30}) graft.target.positions(below_top * around + k, 2) += row;
    }
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    EXPECT_GE(result.report.angle_p1_deg, 15) << past_the_source;
    EXPECT_LE(largest_bend_deg(result), 45) << past_the_source;
    EXPECT_LE(result.report.band_displacement_rel, 0.06) << past_the_source;
    for (Index v = 0; v < (below_top - 2) * around; ++v) {
      EXPECT_EQ(result.mesh.positions.row(result.target.new_index[v]), graft.target.positions.row(v)) << v;
    }
  }
}

// Creases of the target end in the strip without a fold where the source has none.
TEST(Seam, LetsCreasesEndWithoutAFold) {
  Graft graft = tubes(6, 48, true);
  graft.target = shapes::tube(48, 6, true);
  graft.target.positions.col(2) *= 2 * std::numbers::pi / 48;
  graft.pairs[0].target.clear();
  for (int k = 47; k >= 0; --k) graft.pairs[0].target.push_back(6 * 48 + k);
  const double top = graft.target.positions.col(2).maxCoeff();
  for (Index v = 0; v < graft.target.vertex_count(); ++v) {
    graft.target.positions.row(v) = on_polygon(v % 48, 48, 4, graft.target.positions(v, 2));
  }
  graft.source.positions.col(2).array() += top - graft.source.positions.col(2).minCoeff();
  EXPECT_LE(largest_bend_deg(make_seam(graft.target, graft.source, graft.pairs)), 75);
  // If the source has the same creases, they continue through the strip.
  Graft alike = graft;
  for (Index v = 0; v < alike.source.vertex_count(); ++v) {
    alike.source.positions.row(v) = on_polygon(v % 48, 48, 4, alike.source.positions(v, 2));
  }
  EXPECT_NEAR(largest_bend_deg(make_seam(alike.target, alike.source, alike.pairs)), 90, 10);
}

TEST(Seam, HalvesACoarseRingAndNothingElse) {
  const Graft graft = tubes(17, 128, false);
  const SeamResult result = make_seam(graft.target, graft.source, graft.pairs, {.target_rings = 0});
  EXPECT_GT(result.mesh.vertex_count(), graft.target.vertex_count() + graft.source.vertex_count() - 17);
  EXPECT_LE(1 / result.report.source_edge_ratio, 2.2);
  // Quads that do not touch the ring stay quads: five rows of the target and all of the source.
  Index quads = 0;
  for (Index f = 0; f < result.mesh.face_count(); ++f) quads += result.mesh.faces[f].size() == 4;
  EXPECT_EQ(quads, 5 * 17 + 6 * 128);
}

}  // namespace
}  // namespace meshgraft::test
