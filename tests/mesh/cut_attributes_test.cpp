// Attributes are interpolated along a cut, and its loops keep the normals of the whole surface.
#include <meshgraft/mesh/cut.h>

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "cut_cases.h"
#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;

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
  for (const CutCase& test : {CutCase{"torus", mesh_of(torus(14, 30))}, CutCase{"cube", shapes::cube()},
                              CutCase{"sheet", shapes::grid(7, 5)}}) {
    SCOPED_TRACE(test.name);
    const Mesh mesh = with_linear_attributes(test.mesh, gradient);
    for (const double snap : {0.0, 0.3}) {
      const CutResult cut =
          cut_by_plane(mesh, {centre(mesh) + Vector3d(0.07, 0.03, 0), {1, 0.2, 0.1}}, {.snap = snap});
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
  Mesh mesh = with_linear_attributes(mesh_of(irregular_grid(22, 16)), gradient);
  Attribute& uv = mesh.attributes[1];
  std::size_t corner = 0;
  for (Index f = 0; f < mesh.face_count(); ++f)
    for (const Index v : mesh.faces[f]) uv.values[corner++] = mesh.positions.row(v).dot(gradient);
  const CutResult cut = cut_by_plane(mesh, {centre(mesh), {1, 0.4, 0}}, {.snap = 0.3});
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
  const Mesh sphere = mesh_of(icosphere(3));
  const CutResult cut = cut_by_plane(sphere, {{0.02, 0, 0.3}, {0.1, 0.2, 1}});
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
  const CutResult again = cut_by_plane(cut.mesh, {{0, 0, -0.3}, {0, 0, 1}}, {.keep = CutKeep::above});
  for (const auto& loop : boundary_loops(again.mesh))
    for (const Index v : loop)
      EXPECT_TRUE(std::isfinite(attribute(again.mesh, Domain::vertex, cut_normal_name).values[3 * v]));
}

}  // namespace
}  // namespace meshgraft::test
