#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "mesh/repair/repair_surface.h"
#include "mesh/winding.h"
#include "shapes.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

const Context without_limits;

TEST(SplitNonManifold, TakesEdgesAndVerticesApart) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh clean = make_mesh(family.positions, family.triangles);
    for (const Mesh& mesh :
         {test::with_fins(clean, 2, 1), test::with_bow_ties(clean, 2, 1), shapes::bow_tie()}) {
      const bool manifold = summarise_topology(mesh).manifold;
      RepairSurface surface(mesh, without_limits);
      EXPECT_EQ(split_non_manifold(surface), !manifold);
      EXPECT_TRUE(summarise_topology(surface.mesh()).manifold);
      EXPECT_FALSE(split_non_manifold(surface));
    }
  }
}

// The sheets that stay joined are the same all along the line.
TEST(SplitNonManifold, JoinsTheSameSheetsAlongACurve) {
  for (const std::vector<double>& degrees :
       {std::vector<double>{0, 120, 240}, {0, 180, 90}, {0, 150, 230}, {0, 90, 180, 270}})
    for (const double noise : {0.0, 0.004})
      for (const bool turned : {false, true}) {
        SCOPED_TRACE(fmt::format("{} sheets, noise {}, {}", degrees.size(), noise, turned ? "one turned" : ""));
        RepairSurface surface(shapes::sheets_at_a_line(degrees, noise, turned), without_limits);
        const Index faces = surface.faces().size();
        EXPECT_TRUE(split_non_manifold(surface));
        EXPECT_EQ(surface.faces().size(), faces);
        const TopologySummary topology = summarise_topology(surface.mesh());
        EXPECT_TRUE(topology.manifold);
        EXPECT_EQ(topology.components, 2);
      }
}

// The two halves of a slit sheet do not outweigh the sheet that goes on straight.
TEST(SplitNonManifold, JoinsTheSheetsThatRunAlongMostOfACurve) {
  const Mesh whole = shapes::sheets_at_a_line({0, 90, 180, 270});
  Mesh slit = whole;
  slit.faces = {};
  for (Index f = 0; f < whole.face_count(); ++f) {
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (const Index v : whole.faces[f]) centre += whole.positions.row(v) / 3;
    if (centre.z() < 0.01 || std::abs(centre.x() - 0.5) > 0.02)
      slit.faces.push_back(std::vector<Index>(whole.faces[f].begin(), whole.faces[f].end()));
  }
  ASSERT_LT(slit.face_count(), whole.face_count());
  RepairSurface surface(slit, without_limits);
  EXPECT_TRUE(split_non_manifold(surface));
  EXPECT_EQ(surface.faces().size(), slit.face_count());
  // The sheets at 0 and 180° go on straight, and so do those at 90 and 270°.
  const Mesh& mesh = surface.mesh();
  const std::vector<Index> component = connected_components(mesh);
  std::set<Index> flat, upright;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    double height = 0;
    for (const Index v : mesh.faces[f]) height = std::max(height, std::abs(mesh.positions(v, 2)));
    (height < 1e-9 ? flat : upright).insert(component[mesh.faces[f][0]]);
  }
  EXPECT_EQ(flat.size(), 1u);
  EXPECT_EQ(upright.size(), 1u);
  EXPECT_NE(flat, upright);
}

TEST(UnifyWinding, OrientsFacesConsistentlyAndOutward) {
  for (const test::TestMesh& family : test::mesh_families()) {
    if (family.triangles.rows() < 100) continue;
    SCOPED_TRACE(family.name);
    const Mesh clean = make_mesh(family.positions, family.triangles);
    for (const Mesh& mesh : {test::with_turned_patches(clean, 2, 1, 1), turned_over(clean)}) {
      RepairSurface surface(mesh, without_limits);
      unify_winding(surface);
      const TopologySummary topology = summarise_topology(surface.mesh());
      EXPECT_TRUE(topology.oriented);
      if (topology.closed) {
        EXPECT_GT(enclosed_volume(surface.mesh()), 0);
      }
      EXPECT_FALSE(unify_winding(surface));
    }
  }
}

TEST(UnifyWinding, NotesSurfacesWithOneSide) {
  for (const int around : {5, 9, 20}) {
    const Mesh mesh = shapes::moebius_strip(around);
    RepairSurface surface(mesh, without_limits);
    unify_winding(surface);
    const RepairResult result = surface.finish(false);
    ASSERT_EQ(result.notes.size(), 1);
    EXPECT_EQ(result.notes[0].id(), "mesh.one_sided_surface");
  }
}

TEST(PairUp, JoinsFacesThatContinueEachOther) {
  for (int faces = 1; faces < 12; ++faces) {  // pages of a book, in pairs that lie opposite
    Mesh book = shapes::polygons({{0, 0, 0}, {0, 0, 1}}, {});
    for (int k = 0; k < faces; ++k) {
      const double angle = (k / 2) * 0.3 + (k % 2) * std::numbers::pi;
      shapes::add_vertex(book, {std::cos(angle), std::sin(angle), 0.5});
      book.faces.push_back(k % 2 ? std::vector<Index>{1, 0, 2 + k} : std::vector<Index>{0, 1, 2 + k});
    }
    const RepairSurface surface(book, without_limits);
    const auto along = surface.edges().half_edges[0];
    const auto pairs = pair_up(surface, along);
    EXPECT_EQ(pairs.size(), faces / 2);
    for (const auto& [a, b] : pairs) EXPECT_EQ(surface.face_of(a) / 2, surface.face_of(b) / 2);
  }
}

}  // namespace
}  // namespace meshgraft
