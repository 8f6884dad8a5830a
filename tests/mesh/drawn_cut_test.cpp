#include "mesh/cut/drawn_cut.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "mesh/edge_table.h"
#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

// Draws a cut between the first third of the faces, which is above, and the rest.
DrawnCut cut_between_faces(const Mesh& mesh) {
  DrawnCut cut;
  cut.faces = triangulate_chosen(mesh, [](Index) { return false; });
  cut.positions = mesh.positions;
  cut.vertex_side.assign(mesh.vertex_count(), 0);
  for (Index v = 0; v < mesh.vertex_count(); ++v) cut.origin.push_back(same(v));
  for (Index f = 0; f < mesh.face_count(); ++f) cut.face_side.push_back(f < mesh.face_count() / 3 ? 1 : -1);
  cut.side.assign(mesh.faces.corner_count(), 0);
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  for (Index e = 0; e < table.edge_count(); ++e) {
    const auto along = table.half_edges[e];  // faces have three corners
    if (along.size() != 2 || cut.face_side[along[0] / 3] == cut.face_side[along[1] / 3]) continue;
    for (const Index c : along) cut.side[c] = cut.face_side[c / 3];
  }
  cut.normals = whole_normals(mesh, cut);
  return cut;
}

TEST(Separate, LeavesNoEdgeBetweenTheSides) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    const CutResult result = separate(mesh, cut_between_faces(mesh), CutKeep::both, {});
    ASSERT_EQ(result.mesh.face_count(), mesh.face_count());
    const EdgeTable table(result.mesh.vertex_count(), result.mesh.faces);
    Index inner = 0, inner_before = 0;
    for (Index e = 0; e < table.edge_count(); ++e) {
      const auto along = table.half_edges[e];
      inner += along.size() == 2;
      if (along.size() == 2) {
        EXPECT_EQ(result.face_side[along[0] / 3], result.face_side[along[1] / 3]);
      }
    }
    const DrawnCut cut = cut_between_faces(mesh);
    const EdgeTable before(mesh.vertex_count(), mesh.faces);
    for (Index e = 0; e < before.edge_count(); ++e)
      inner_before += before.half_edges[e].size() == 2 && cut.side[before.half_edges[e][0]] == 0;
    EXPECT_EQ(inner, inner_before) << "no edge is opened off the cut";
    for (Index f = 0; f < mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(result.mesh.positions.row(result.mesh.faces[f][k]), mesh.positions.row(mesh.faces[f][k]));
  }
}

TEST(Separate, KeepsTheSideThatIsAskedFor) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    const DrawnCut cut = cut_between_faces(mesh);
    const CutResult above = separate(mesh, cut, CutKeep::above, {}),
                    below = separate(mesh, cut, CutKeep::below, {});
    EXPECT_EQ(above.mesh.face_count(), mesh.face_count() / 3);
    EXPECT_EQ(above.mesh.face_count() + below.mesh.face_count(), mesh.face_count());
    for (const Side side : above.face_side) EXPECT_EQ(side, 1);
    for (const Side side : below.face_side) EXPECT_EQ(side, -1);
    for (Index f = 0; f < above.mesh.face_count(); ++f) EXPECT_EQ(above.face_parent[f], f);
  }
}

TEST(WholeNormals, AreThoseOfTheUncutSurface) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    DrawnCut cut = cut_between_faces(mesh);
    const Points normals = vertex_normals(mesh);
    EXPECT_EQ(cut.normals, normals);
    const Index v = family.triangles(0, 0), w = family.triangles(0, 1);
    cut.positions.conservativeResize(family.size() + 1, 3);
    cut.positions.row(family.size()) = (family.positions.row(v) + family.positions.row(w)) / 2;
    cut.origin.push_back({v, w, 0.5});
    const Eigen::RowVector3d between = normals.row(v) + normals.row(w);
    if (between.norm() > 1e-6) {
      EXPECT_LT((whole_normals(mesh, cut).row(family.size()) - between.normalized()).norm(), 1e-12);
    }
  }
}

TEST(CheckOfACut, RefusesWhatCannotBeCut) {
  Mesh mesh = shapes::cube();
  EXPECT_NO_THROW(check(mesh, {}));
  for (const double snap : {-0.1, 0.6, std::nan("")}) EXPECT_THROW(check(mesh, {.snap = snap}), Error) << snap;
  mesh.positions(2, 1) = 2e60;
  EXPECT_THROW(check(mesh, {}), Error);
  EXPECT_THROW(check(Mesh(), {}), Error);
}

}  // namespace
}  // namespace meshgraft
