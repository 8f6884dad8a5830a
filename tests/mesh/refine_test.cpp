
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/refine.h"
#include "mesh/shapes.h"

namespace meshgraft {
namespace {

std::vector<Index> range(Index begin, Index end) {
  std::vector<Index> indices(end - begin);
  std::iota(indices.begin(), indices.end(), begin);
  return indices;
}

double area(const Mesh& mesh) {
  double sum = 0;
  const Triangles triangles = triangulate(mesh).triangles;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = mesh.positions.row(triangles(t, 1)) - mesh.positions.row(triangles(t, 0));
    const Eigen::Vector3d b = mesh.positions.row(triangles(t, 2)) - mesh.positions.row(triangles(t, 0));
    sum += 0.5 * a.cross(b).norm();
  }
  return sum;
}

struct Family {
  std::string name;
  Mesh mesh;
};

std::vector<Family> families() {
  return {{"cube", shapes::cube()},
          {"grid", shapes::grid(5, 4)},
          {"grid of triangles", shapes::grid(5, 4, true)},
          {"tube", shapes::tube(7, 4, true)},
          {"torus", shapes::torus(8, 5, true)},
          {"bow tie", shapes::bow_tie()},
          {"three on an edge", shapes::three_on_an_edge()}};
}

// A few selections per mesh: none, one vertex, a part, everything.
std::vector<std::vector<Index>> selections(const Mesh& mesh) {
  const Index n = mesh.vertex_count();
  return {{}, {0}, range(0, n / 3), range(n / 4, n / 2), {0, 1, n / 2, n - 1}, range(0, n)};
}

TEST(SplitEdgesWithin, KeepsAreaAndTopology) {
  for (const auto& [name, mesh] : families()) {
    const TopologySummary before = summarise_topology(mesh);
    for (const auto& selection : selections(mesh)) {
      SCOPED_TRACE(name + ", " + std::to_string(selection.size()) + " vertices");
      const RefineResult fine = split_edges_within(mesh, selection);
      const TopologySummary after = summarise_topology(fine.mesh);
      EXPECT_EQ(after.manifold, before.manifold);
      EXPECT_EQ(after.oriented, before.oriented);
      EXPECT_EQ(after.closed, before.closed);
      EXPECT_EQ(after.genus, before.genus);
      EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
      EXPECT_EQ(after.boundary_loops, before.boundary_loops);
      EXPECT_NEAR(area(fine.mesh), area(mesh), 1e-13 * area(mesh));
    }
  }
}

TEST(SplitEdgesWithin, SplitsExactlyTheEdgesWithBothEndsInside) {
  const Mesh mesh = shapes::torus(8, 5, true);
  const std::vector<Index> inside = range(3, 21);
  std::set<std::array<Index, 2>> expected;
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  for (const Index v : inside) {
    for (const Index w : rings[v]) {
      if (v < w && w < 21 && w >= 3) expected.insert({v, w});
    }
  }
  const RefineResult fine = split_edges_within(mesh, inside);
  EXPECT_EQ(std::set(fine.parents.begin(), fine.parents.end()), expected);
  EXPECT_EQ(fine.parents.size(), expected.size());
  const IndexLists fine_rings = vertex_rings(fine.mesh.vertex_count(), fine.mesh.faces);
  for (Index k = 0; k < static_cast<Index>(fine.parents.size()); ++k) {
    const auto [a, b] = fine.parents[k];
    const Eigen::RowVector3d middle = (mesh.positions.row(a) + mesh.positions.row(b)) / 2;
    EXPECT_EQ(fine.mesh.positions.row(mesh.vertex_count() + k), middle);
    EXPECT_FALSE(std::binary_search(fine_rings[a].begin(), fine_rings[a].end(), b));
  }
  EXPECT_EQ(fine.mesh.positions.topRows(mesh.vertex_count()), mesh.positions);
  EXPECT_EQ(fine.vertex.new_index, range(0, mesh.vertex_count()));
}

TEST(SplitEdgesAt, ChangesNothingBeyondTheFacesAtThem) {
  for (const auto& [name, mesh] : families()) {
    SCOPED_TRACE(name);
    const TopologySummary before = summarise_topology(mesh);
    const std::vector<Index> selection = range(0, mesh.vertex_count() / 3);
    const RefineResult fine = split_edges_at(mesh, selection);
    const TopologySummary after = summarise_topology(fine.mesh);
    EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
    EXPECT_EQ(after.manifold, before.manifold);
    EXPECT_NEAR(area(fine.mesh), area(mesh), 1e-13 * area(mesh));
    const auto is_selected = [&](Index v) { return v < static_cast<Index>(selection.size()); };
    for (const auto& [a, b] : fine.parents) EXPECT_TRUE(is_selected(a) || is_selected(b));
    std::vector<int> pieces(mesh.face_count(), 0);
    for (const Index f : fine.face_parent) ++pieces[f];
    for (Index f = 0; f < mesh.face_count(); ++f) {
      const auto face = mesh.faces[f];
      EXPECT_EQ(pieces[f] > 1, std::any_of(face.begin(), face.end(), is_selected));
    }
  }
  EXPECT_THROW(split_edges_at(shapes::cube(), std::vector<Index>{8}), Error);
}

TEST(SplitEdgesWithin, LeavesPolygonsBeyondReachAlone) {
  const Mesh mesh = shapes::grid(4, 1);
  const RefineResult fine = split_edges_within(mesh, std::vector<Index>{0, 5});  // the left side
  ASSERT_EQ(fine.parents.size(), 1);
  int quads = 0;
  for (Index f = 0; f < fine.mesh.face_count(); ++f) quads += fine.mesh.faces[f].size() == 4;
  EXPECT_EQ(quads, 3);
  EXPECT_EQ(fine.mesh.face_count(), 6);
  EXPECT_EQ(fine.face_parent, (std::vector<Index>{0, 0, 0, 1, 2, 3}));
}

TEST(SplitEdgesWithin, InterpolatesLinearFunctionsExactly) {
  for (const auto& [name, shape] : families()) {
    SCOPED_TRACE(name);
    Mesh mesh = shape;
    const auto f = [](const Eigen::RowVector3d& p) { return 1 + 2 * p.x() - 3 * p.y() + 0.5 * p.z(); };
    Attribute of_vertices{.name = "scalar", .domain = Domain::vertex};
    Attribute of_corners{.name = "uv", .domain = Domain::corner, .components = 2};
    Attribute of_faces{.name = "group",
                       .domain = Domain::face,
                       .interpolation = Interpolation::nearest,
                       .type = ScalarType::int32};
    for (Index v = 0; v < mesh.vertex_count(); ++v) of_vertices.values.push_back(f(mesh.positions.row(v)));
    for (Index face = 0; face < mesh.face_count(); ++face) {
      of_faces.values.push_back(7 * face);
      for (const Index v : mesh.faces[face]) {  // every face has a chart of its own: all edges are seams
        of_corners.values.push_back(f(mesh.positions.row(v)) + 100 * face);
        of_corners.values.push_back(face);
      }
    }
    mesh.attributes = {of_vertices, of_corners, of_faces};
    for (const auto& selection : selections(mesh)) {
      const RefineResult result = split_edges_within(mesh, selection);
      const Mesh& fine = result.mesh;
      ASSERT_EQ(fine.attributes.size(), 3);
      for (Index v = 0; v < fine.vertex_count(); ++v) {
        EXPECT_NEAR(fine.attributes[0].values[v], f(fine.positions.row(v)), 1e-13);
      }
      for (Index face = 0; face < fine.face_count(); ++face) {
        const Index parent = result.face_parent[face];
        EXPECT_EQ(fine.attributes[2].values[face], 7 * parent);
        for (std::size_t c = 0; c < fine.faces[face].size(); ++c) {
          const std::size_t corner = fine.faces.first_corner(face) + c;
          EXPECT_EQ(fine.attributes[1].values[2 * corner + 1], parent);
          EXPECT_NEAR(fine.attributes[1].values[2 * corner],
                      f(fine.positions.row(fine.faces[face][c])) + 100 * parent, 1e-11);
        }
      }
    }
  }
}

TEST(SplitEdgesWithin, FollowsTheInterpolationRule) {
  Mesh mesh = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  mesh.attributes = {{.name = "normal",
                      .interpolation = Interpolation::direction,
                      .components = 3,
                      .values = {1, 0, 0, 0, 1, 0, -1, 0, 0}},
                     {.name = "label", .interpolation = Interpolation::nearest, .values = {5, 9, 2}},
                     {.name = "colour", .type = ScalarType::uint8, .values = {0, 255, 10}}};
  const RefineResult fine = split_edges_within(mesh, std::vector<Index>{0, 1, 2});
  ASSERT_EQ(fine.mesh.face_count(), 4);
  ASSERT_EQ(fine.parents, (std::vector<std::array<Index, 2>>{{0, 1}, {0, 2}, {1, 2}}));
  const double r = std::sqrt(0.5);
  const std::vector<double>& normal = fine.mesh.attributes[0].values;
  EXPECT_NEAR(normal[9], r, 1e-15);
  EXPECT_NEAR(normal[10], r, 1e-15);
  EXPECT_EQ(normal[12], 1);  // the mean of opposite directions is the first
  EXPECT_EQ(fine.mesh.attributes[1].values, (std::vector<double>{5, 9, 2, 5, 5, 9}));
  EXPECT_EQ(fine.mesh.attributes[2].values, (std::vector<double>{0, 255, 10, 128, 5, 133}));
}

TEST(SplitEdgesWithin, SurvivesDamagedFacesAndRefusesBadIndices) {
  Mesh mesh = shapes::grid(2, 2);
  mesh.faces.push_back(std::vector<Index>{0, 0, 1});
  mesh.faces.push_back(std::vector<Index>{0, 1, 99});
  mesh.faces.push_back(std::vector<Index>{3, 4, 4, 8, 7});
  const RefineResult fine = split_edges_within(mesh, range(0, 9));
  EXPECT_GT(fine.parents.size(), 12);
  EXPECT_EQ(fine.mesh.faces[fine.mesh.face_count() - 1].size(), 3);
  EXPECT_THROW(split_edges_within(mesh, std::vector<Index>{9}), Error);
}

}  // namespace
}  // namespace meshgraft
