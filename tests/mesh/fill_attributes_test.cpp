#include "mesh/fill_attributes.h"

#include <gtest/gtest.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(InterpolateInFills, ReproducesLinearFunctionsOnFlatPatches) {
  const Eigen::RowVector3d slope(2, -3, 0);
  for (const test::TestMesh& family : {test::flat_sheet(8, 6), test::flat_sheet(12, 12)}) {
    SCOPED_TRACE(family.name);
    Mesh mesh = make_mesh(family.positions, family.triangles);
    const Eigen::RowVector3d middle = family.positions.colwise().mean();
    Flags is_new;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      double farthest = 0;
      for (const Index v : mesh.faces[f])
        farthest = std::max(farthest, (mesh.positions.row(v) - middle).norm() / family.box_diagonal());
      is_new.push_back(farthest < 0.3);
    }
    ASSERT_GT(std::ranges::count(is_new, 1), 10);
    Flags beside_old(mesh.vertex_count(), 0);
    for (Index f = 0; f < mesh.face_count(); ++f)
      if (!is_new[f])
        for (const Index v : mesh.faces[f]) beside_old[v] = 1;
    Attribute per_vertex{.name = "height", .domain = Domain::vertex},
        per_corner{.name = "u", .domain = Domain::corner};
    const auto value = [&](Index v) { return slope.dot(mesh.positions.row(v)); };
    for (Index v = 0; v < mesh.vertex_count(); ++v) per_vertex.values.push_back(beside_old[v] ? value(v) : 100);
    for (const Index v : mesh.faces.corners()) per_corner.values.push_back(beside_old[v] ? value(v) : 100);
    Attribute label = per_vertex;
    label.name = "label";
    label.interpolation = Interpolation::nearest;
    mesh.attributes = {per_vertex, per_corner, label};
    interpolate_in_fills(mesh, is_new, {});
    for (Index v = 0; v < mesh.vertex_count(); ++v) EXPECT_NEAR(mesh.attributes[0].values[v], value(v), 1e-9);
    for (Index c = 0; c < mesh.faces.corner_count(); ++c)
      EXPECT_NEAR(mesh.attributes[1].values[c], value(mesh.faces.corners()[c]), 1e-9);
    EXPECT_EQ(mesh.attributes[2].values, label.values) << "labels stay";
  }
}

}  // namespace
}  // namespace meshgraft
