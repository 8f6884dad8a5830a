#include "merge/ring_removal.h"

#include <algorithm>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

struct RingCase {
  std::string name;
  Mesh mesh;
};

Mesh mesh_of(const test::TestMesh& mesh) { return make_mesh(mesh.positions, mesh.triangles); }

/// Returns meshes with one boundary or two, of triangles and of quads.
std::vector<RingCase> ring_cases() {
  return {
      {"tube of quads", shapes::tube(14, 9)},        {"tube of triangles", shapes::tube(9, 7, true)},
      {"grid", mesh_of(test::grid(11, 8))},          {"irregular grid", mesh_of(test::irregular_grid(9, 9))},
      {"twisted tube", mesh_of(test::tube(12, 10))}, {"pyramid", mesh_of(test::pyramid_without_base())}};
}

constexpr double any_length = std::numeric_limits<double>::infinity();

std::vector<RingRequest> all_loops(const Mesh& mesh, double longest_edge = any_length) {
  std::vector<RingRequest> requests;
  for (const auto& loop : boundary_loops(mesh)) requests.push_back({loop, longest_edge, "pair"});
  return requests;
}

TEST(RingRemoval, LeavesOneSimpleLoopInPlaceOfEach) {
  for (const RingCase& test : ring_cases())
    for (const double share : {1e9, 0.6}) {  // as they are, and with halved edges
      SCOPED_TRACE(test.name);
      const auto loops = boundary_loops(test.mesh);
      const double edge = (test.mesh.positions.row(loops[0][0]) - test.mesh.positions.row(loops[0][1])).norm();
      const auto requests = all_loops(test.mesh, share * edge);
      const RingRemoval result = remove_rings(test.mesh, requests, {});
      const TopologySummary was = summarise_topology(test.mesh), is = summarise_topology(result.mesh);
      EXPECT_TRUE(is.manifold && is.oriented);
      EXPECT_EQ(is.isolated_vertices, 0);
      EXPECT_EQ(is.euler_characteristic, was.euler_characteristic);
      EXPECT_EQ(is.components, was.components);
      ASSERT_EQ(result.loops.size(), requests.size());
      const auto left = boundary_loops(result.mesh);
      EXPECT_EQ(std::set(left.begin(), left.end()), std::set(result.loops.begin(), result.loops.end()));
      for (const auto& loop : result.loops)
        EXPECT_EQ(loop.front(), *std::min_element(loop.begin(), loop.end()));
    }
}

TEST(RingRemoval, RemovesTheLoopAndKeepsTheOtherVertices) {
  for (const RingCase& test : ring_cases()) {
    SCOPED_TRACE(test.name);
    const auto requests = all_loops(test.mesh);
    const RingRemoval result = remove_rings(test.mesh, requests, {});
    std::set<Index> removed;
    for (const RingRequest& request : requests) removed.insert(request.loop.begin(), request.loop.end());
    ASSERT_EQ(static_cast<Index>(result.vertex.new_index.size()), test.mesh.vertex_count());
    Index last = -1;
    for (Index v = 0; v < test.mesh.vertex_count(); ++v) {
      const Index now = result.vertex.new_index[v];
      EXPECT_EQ(now < 0, removed.contains(v));
      if (now < 0) continue;
      EXPECT_GT(now, last);
      last = now;
      EXPECT_EQ(result.mesh.positions.row(now), test.mesh.positions.row(v));
    }
  }
}

TEST(RingRemoval, WithoutHalvingRemovesTheFacesAtTheLoopAlone) {
  for (const RingCase& test : {ring_cases()[0], ring_cases()[1], ring_cases()[4]}) {
    SCOPED_TRACE(test.name);
    const auto requests = all_loops(test.mesh);
    const RingRemoval result = remove_rings(test.mesh, requests, {});
    EXPECT_EQ(result.halvings, std::vector<int>(requests.size(), 0));
    std::multiset<std::vector<Index>> expected, found;
    for (Index f = 0; f < test.mesh.face_count(); ++f) {
      std::vector<Index> face;
      for (const Index v : test.mesh.faces[f]) face.push_back(result.vertex.new_index[v]);
      if (std::count(face.begin(), face.end(), -1) == 0) expected.insert(face);
    }
    for (Index f = 0; f < result.mesh.face_count(); ++f)
      found.emplace(result.mesh.faces[f].begin(), result.mesh.faces[f].end());
    EXPECT_EQ(found, expected);
  }
}

TEST(RingRemoval, HalvesUntilTheEdgesAreShortEnough) {
  for (const RingCase& test : {ring_cases()[0], ring_cases()[1]}) {
    const auto loop = boundary_loops(test.mesh)[0];
    const double edge = (test.mesh.positions.row(loop[0]) - test.mesh.positions.row(loop[1])).norm();
    for (const int halvings : {0, 1, 2, 3}) {
      // Even loops meet the bound exactly.
      const std::vector<RingRequest> requests{{loop, edge / (1 << halvings), "pair"}};
      const RingRemoval result = remove_rings(test.mesh, requests, {});
      EXPECT_EQ(result.halvings, (std::vector<int>{halvings})) << test.name;
      const TopologySummary topology = summarise_topology(result.mesh);
      EXPECT_EQ(topology.boundary_loops, 2);
      EXPECT_TRUE(topology.manifold && topology.oriented);
    }
  }
}

TEST(RingRemoval, LeavesOtherLoopsAlone) {
  const Mesh tube = shapes::tube(10, 5);
  const auto loops = boundary_loops(tube);
  const std::vector<RingRequest> requests{{loops[0], any_length, "pair"}};
  const RingRemoval result = remove_rings(tube, requests, {});
  for (const Index v : loops[1]) EXPECT_GE(result.vertex.new_index[v], 0);
  EXPECT_EQ(boundary_loops(result.mesh).size(), 2U);
}

TEST(RingRemoval, CarriesAttributesOfKeptElements) {
  for (const RingCase& test : ring_cases()) {
    Mesh mesh = test.mesh;
    const auto add = [&](Domain domain, Index count) {
      Attribute attribute{.name = "number", .domain = domain};
      for (Index k = 0; k < count; ++k) attribute.values.push_back(k);
      mesh.attributes.push_back(attribute);
    };
    add(Domain::vertex, mesh.vertex_count());
    add(Domain::face, mesh.face_count());
    add(Domain::corner, mesh.faces.corner_count());
    const RingRemoval result = remove_rings(mesh, all_loops(mesh), {});
    const auto values = [&](Domain domain) { return result.mesh.find_attribute(domain, "number")->values; };
    EXPECT_EQ(static_cast<Index>(values(Domain::vertex).size()), result.mesh.vertex_count()) << test.name;
    EXPECT_EQ(static_cast<Index>(values(Domain::face).size()), result.mesh.face_count()) << test.name;
    EXPECT_EQ(static_cast<Index>(values(Domain::corner).size()), result.mesh.faces.corner_count()) << test.name;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (const Index now = result.vertex.new_index[v]; now >= 0) {
        EXPECT_EQ(values(Domain::vertex)[now], v);
      }
  }
}

TEST(RingRemoval, RefusesARingThatIsNoAnnulus) {
  // Two triangles are all ring: however often their edges are halved, the boundary's midpoints stay on it.
  const Mesh triangle = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const std::vector<RingRequest> requests{{{0, 1, 2}, any_length, "pair 3"}};
  try {
    const RingRemoval result = remove_rings(triangle, requests, {});
    const TopologySummary topology = summarise_topology(result.mesh);  // or it finds an annulus after halving
    EXPECT_EQ(topology.boundary_loops, 1);
    EXPECT_GT(result.halvings[0], 0);
  } catch (const Error& error) {
    EXPECT_EQ(error.location().text(), "pair 3");
  }
  EXPECT_THROW(remove_rings(shapes::bow_tie(), std::vector<RingRequest>{{{0, 2, 1}, any_length, "pair"}}, {}),
               Error);
}

}  // namespace
}  // namespace meshgraft
