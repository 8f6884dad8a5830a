#include <meshgraft/mesh/topology.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "mesh/shapes.h"
#include "support/paths.h"

namespace meshgraft {
namespace {

std::vector<Index> list(std::span<const Index> span) { return {span.begin(), span.end()}; }

struct Expected {
  std::string name;
  Mesh mesh;
  Index components, loops, euler;
  std::optional<Index> genus;
  bool closed, manifold, oriented;
};

std::vector<Expected> surfaces() {
  Mesh wound_against = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}},
                                        {{0, 1, 4, 3}, {1, 4, 5, 2}});
  Mesh with_isolated = shapes::cube();
  shapes::add_vertex(with_isolated, {5, 5, 5});
  return {
      {"empty", {}, 0, 0, 0, 0, false, true, true},
      {"cube", shapes::cube(), 1, 0, 2, 0, true, true, true},
      {"torus", shapes::torus(), 1, 0, 0, 1, true, true, true},
      {"torus of triangles", shapes::torus(7, 5, true), 1, 0, 0, 1, true, true, true},
      {"grid", shapes::grid(4, 3), 1, 1, 1, 0, false, true, true},
      {"tube", shapes::tube(6, 3), 1, 2, 0, 0, false, true, true},
      {"Möbius strip", shapes::moebius_strip(), 1, 1, 0, std::nullopt, false, true, false},
      {"bow tie", shapes::bow_tie(), 1, 2, 1, std::nullopt, false, false, true},
      {"wound against each other", wound_against, 1, 1, 1, std::nullopt, false, true, false},
      {"two components", shapes::together({shapes::torus(), shapes::tube(5, 2)}), 2, 2, 0, 1, false, true,
       true},
      {"isolated vertex", with_isolated, 1, 0, 2, 0, true, true, true},
  };
}

TEST(Connectivity, AgreesWithRingsComponentsAndLoops) {
  for (const Expected& expected : surfaces()) {
    SCOPED_TRACE(expected.name);
    const Connectivity all = connectivity(expected.mesh);
    const IndexLists rings = vertex_rings(expected.mesh.vertex_count(), expected.mesh.faces);
    EXPECT_EQ(all.rings.offsets, rings.offsets);
    EXPECT_EQ(all.rings.values, rings.values);
    EXPECT_EQ(all.components, connected_components(expected.mesh));
    EXPECT_EQ(all.loops, boundary_loops(expected.mesh));
  }
}

TEST(SummariseTopology, KnowsTheSurfaces) {
  for (const Expected& expected : surfaces()) {
    SCOPED_TRACE(expected.name);
    const TopologySummary summary = summarise_topology(expected.mesh);
    EXPECT_EQ(summary.components, expected.components);
    EXPECT_EQ(summary.boundary_loops, expected.loops);
    EXPECT_EQ(summary.euler_characteristic, expected.euler);
    EXPECT_EQ(summary.genus, expected.genus);
    EXPECT_EQ(summary.closed, expected.closed);
    EXPECT_EQ(summary.manifold, expected.manifold);
    EXPECT_EQ(summary.oriented, expected.oriented);
    EXPECT_EQ(summary.faces, expected.mesh.face_count());
    EXPECT_EQ(summary.vertices + summary.isolated_vertices, expected.mesh.vertex_count());
  }
}

TEST(SummariseTopology, IsNotManifoldWithThreeFacesOnAnEdge) {
  const TopologySummary summary = summarise_topology(shapes::three_on_an_edge());
  EXPECT_FALSE(summary.manifold);
  EXPECT_FALSE(summary.closed);
  EXPECT_EQ(summary.edges, 7);
  EXPECT_EQ(summary.genus, std::nullopt);
}

TEST(SummariseTopology, DoesNotChangeWhenPolygonsBecomeTriangles) {
  for (const Expected& expected : surfaces()) {
    SCOPED_TRACE(expected.name);
    const TopologySummary summary =
        summarise_topology(make_mesh(expected.mesh.positions, triangulate(expected.mesh).triangles));
    EXPECT_EQ(summary.euler_characteristic, expected.euler);
    EXPECT_EQ(summary.boundary_loops, expected.loops);
    EXPECT_EQ(summary.manifold, expected.manifold);
    EXPECT_EQ(summary.oriented, expected.oriented);
  }
}

TEST(SummariseTopology, SkipsCollapsedFaces) {
  // Edge 1–2 collapsed to a face without area between two good triangles.
  const Mesh mesh = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}},
                                     {{0, 1, 2}, {1, 2, 2}, {1, 3, 2}, {1, 3, 9}});
  const TopologySummary summary = summarise_topology(mesh);
  EXPECT_TRUE(summary.manifold);
  EXPECT_TRUE(summary.oriented);
  EXPECT_EQ(summary.boundary_loops, 1);
  EXPECT_EQ(summary.euler_characteristic, 1);
  EXPECT_EQ(summary.faces, 4);
}

TEST(BoundaryLoops, RunWithTheSurfaceAtTheLeft) {
  const auto loops = boundary_loops(shapes::grid(2, 2));
  ASSERT_EQ(loops.size(), 1);
  EXPECT_EQ(loops[0], (std::vector<Index>{0, 1, 2, 5, 8, 7, 6, 3}));
}

TEST(BoundaryLoops, FollowHalfEdgesOfOrientedSurfaces) {
  for (const Expected& expected : surfaces()) {
    if (!expected.oriented) continue;
    SCOPED_TRACE(expected.name);
    std::set<std::pair<Index, Index>> half_edges;
    std::map<std::pair<Index, Index>, int> uses;
    for (Index f = 0; f < expected.mesh.face_count(); ++f) {
      const auto face = expected.mesh.faces[f];
      for (std::size_t c = 0; c < face.size(); ++c) {
        const Index a = face[c], b = face[(c + 1) % face.size()];
        half_edges.insert({a, b});
        ++uses[std::minmax(a, b)];
      }
    }
    std::size_t boundary = 0, along_loops = 0;
    for (const auto& [edge, count] : uses) boundary += count == 1;
    for (const auto& loop : boundary_loops(expected.mesh)) {
      EXPECT_EQ(loop.front(), *std::min_element(loop.begin(), loop.end()));
      along_loops += loop.size();
      for (std::size_t k = 0; k < loop.size(); ++k) {
        EXPECT_TRUE(half_edges.contains({loop[k], loop[(k + 1) % loop.size()]}));
      }
    }
    EXPECT_EQ(along_loops, boundary);
  }
}

TEST(BoundaryLoops, PutTheLongestFirstThenTheSmallestVertex) {
  const auto loops = boundary_loops(shapes::together({shapes::tube(4, 1), shapes::tube(7, 1)}));
  ASSERT_EQ(loops.size(), 4);
  EXPECT_EQ(loops[0].size(), 7);
  EXPECT_EQ(loops[1].size(), 7);
  EXPECT_LT(loops[0].front(), loops[1].front());
  EXPECT_EQ(loops[2], (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(loops[3].front(), 4);
}

TEST(BoundaryLoops, SeparateFansThatMeetInAVertex) {
  const auto loops = boundary_loops(shapes::bow_tie());
  ASSERT_EQ(loops.size(), 2);
  EXPECT_EQ(loops[0], (std::vector<Index>{0, 2, 1}));
  EXPECT_EQ(loops[1], (std::vector<Index>{2, 3, 4}));
}

TEST(BoundaryLoops, OfAMoebiusStripIsOne) {
  const auto loops = boundary_loops(shapes::moebius_strip(9));
  ASSERT_EQ(loops.size(), 1);
  EXPECT_EQ(loops[0].size(), 18);
  EXPECT_EQ(std::set<Index>(loops[0].begin(), loops[0].end()).size(), 18);
}

TEST(BoundaryLoops, CloseBeyondANonManifoldEdgeWhereTheyCan) {
  // A grid with a fin on its edge 1–4. The outer boundary meets that edge at vertex 1. The fin's own chain
  // does not close and is left out.
  Mesh mesh = shapes::grid(2, 1);
  shapes::add_vertex(mesh, {1, 0.5, 1});
  mesh.faces.push_back(std::vector<Index>{1, 4, 6});
  const auto loops = boundary_loops(mesh);
  ASSERT_EQ(loops.size(), 1);
  EXPECT_EQ(loops[0], (std::vector<Index>{0, 1, 2, 5, 4, 3}));
}

// The public test data's OBJ models, with the facts that their makers state.
struct Model {
  std::string file;
  Index vertices, faces, genus;
  std::vector<std::size_t> loops;
};

Mesh read_obj(std::istream& in) {
  std::vector<double> coordinates;
  Mesh mesh;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      for (double x; words >> x;) coordinates.push_back(x);
    } else if (word == "f") {
      std::vector<Index> face;
      while (words >> word) face.push_back(std::stoi(word) - 1);
      mesh.faces.push_back(face);
    }
  }
  mesh.positions = Eigen::Map<Points>(coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3);
  return mesh;
}

TEST(SummariseTopology, AgreesWithTheFactsOfPublicModels) {
  const std::filesystem::path data = test::data_folder();
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no test data in " << data << "; set MESHGRAFT_DATA";
  for (const Model& model :
       {Model{"models/cactus.obj", 620, 1236, 0, {}}, Model{"models/venus_torso.obj", 711, 1396, 0, {24}},
        Model{"open/venus_neck_coarse.obj", 707, 1373, 0, {24, 17}},
        Model{"procedural/plane_irregular.obj", 2304, 4418, 0, {188}}}) {
    SCOPED_TRACE(model.file);
    std::ifstream file(data / model.file);
    const Mesh mesh = read_obj(file);
    const TopologySummary summary = summarise_topology(mesh);
    EXPECT_EQ(summary.vertices, model.vertices);
    EXPECT_EQ(summary.isolated_vertices, 0);
    EXPECT_EQ(summary.faces, model.faces);
    EXPECT_EQ(summary.components, 1);
    EXPECT_TRUE(summary.manifold);
    EXPECT_TRUE(summary.oriented);
    EXPECT_EQ(summary.genus, model.genus);
    std::vector<std::size_t> lengths;
    for (const auto& loop : boundary_loops(mesh)) lengths.push_back(loop.size());
    EXPECT_EQ(lengths, model.loops);
  }
}

TEST(VertexRings, AreSymmetricSortedAndAgree) {
  for (const Expected& expected : surfaces()) {
    SCOPED_TRACE(expected.name);
    const Mesh mesh = make_mesh(expected.mesh.positions, triangulate(expected.mesh).triangles);
    const Triangles triangles = triangulate(mesh).triangles;
    const IndexLists rings = vertex_rings(mesh.vertex_count(), triangles);
    const IndexLists from_faces = vertex_rings(mesh.vertex_count(), mesh.faces);
    EXPECT_EQ(rings.offsets, from_faces.offsets);
    EXPECT_EQ(rings.values, from_faces.values);
    for (Index v = 0; v < rings.size(); ++v) {
      EXPECT_TRUE(std::is_sorted(rings[v].begin(), rings[v].end(), std::less_equal<>()));
      for (const Index w : rings[v]) {
        EXPECT_NE(w, v);
        EXPECT_TRUE(std::binary_search(rings[w].begin(), rings[w].end(), v));
      }
    }
  }
}

TEST(VertexRings, OfPolygonsHaveNoDiagonals) {
  EXPECT_EQ(list(vertex_rings(8, shapes::cube().faces)[0]), (std::vector<Index>{1, 3, 4}));
  EXPECT_EQ(list(vertex_rings(9, shapes::grid(2, 2).faces)[4]), (std::vector<Index>{1, 3, 5, 7}));
}

TEST(VertexRings, IgnoreRepeatedCorners) {
  Triangles triangles(2, 3);
  triangles << 0, 0, 1, 1, 2, 3;
  EXPECT_EQ(list(vertex_triangles(4, triangles)[0]), (std::vector<Index>{0}));
  EXPECT_EQ(list(vertex_triangles(4, triangles)[1]), (std::vector<Index>{0, 1}));
  EXPECT_EQ(list(vertex_rings(4, triangles)[0]), (std::vector<Index>{1}));
  EXPECT_EQ(list(vertex_rings(4, triangles)[1]), (std::vector<Index>{0, 2, 3}));
}

TEST(VertexRings, DoNotDependOnTheNumberOfThreads) {
  const Mesh torus = shapes::torus(97, 61);
  const Triangles triangles = triangulate(torus).triangles;
  const IndexLists one = vertex_rings(torus.vertex_count(), triangles, shapes::with_threads(1));
  const IndexLists two = vertex_rings(torus.vertex_count(), triangles, shapes::with_threads(2));
  EXPECT_EQ(one.offsets, two.offsets);
  EXPECT_EQ(one.values, two.values);
}

TEST(VertexTriangles, NameATriangleWithAnIndexOutOfRange) {
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 1, 2, 3;
  try {
    vertex_triangles(3, triangles);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.id(), "core.no_such_vertex");
    EXPECT_EQ(error.location().text(), "triangle 1");
  }
}

TEST(VertexTriangles, StopWhenAskedTo) {
  std::stop_source source;
  source.request_stop();
  const Triangles triangles = triangulate(shapes::torus()).triangles;
  Context context;
  context.stop_token = source.get_token();
  EXPECT_THROW(vertex_triangles(40, triangles, context), Error);
}

TEST(ConnectedComponents, AreNumberedByTheirSmallestVertex) {
  Mesh mesh = shapes::together({shapes::bow_tie(), shapes::cube()});
  shapes::add_vertex(mesh, {0, 0, 9});
  Index count = -1;
  const std::vector<Index> component = connected_components(mesh, &count);
  EXPECT_EQ(count, 2);
  for (Index v = 0; v < 5; ++v) EXPECT_EQ(component[v], 0);
  for (Index v = 5; v < 13; ++v) EXPECT_EQ(component[v], 1);
  EXPECT_EQ(component[13], -1);
}

TEST(GrowRings, IsTheDistanceInEdges) {
  const Mesh grid = shapes::grid(6, 6);
  const IndexLists rings = vertex_rings(grid.vertex_count(), grid.faces);
  const std::vector<Index> centre = {24};
  for (int k = 0; k <= 3; ++k) {
    std::vector<Index> diamond;
    for (Index v = 0; v < 49; ++v) {
      if (std::abs(v / 7 - 3) + std::abs(v % 7 - 3) <= k) diamond.push_back(v);
    }
    EXPECT_EQ(grow_rings(centre, k, rings), diamond);
  }
  EXPECT_EQ(grow_rings(centre, 1000000, rings).size(), 49);
  EXPECT_EQ(grow_rings(std::vector<Index>{5, 2, 5}, 0, rings), (std::vector<Index>{2, 5}));
  EXPECT_THROW(grow_rings(std::vector<Index>{49}, 1, rings), Error);
}

TEST(EdgeDistance, IsShortestAlongEdgesAndEndsAtTheLimit) {
  const Mesh grid = shapes::grid(6, 6);
  const IndexLists rings = vertex_rings(grid.vertex_count(), grid.faces);
  const auto distance = edge_distance(std::vector<Index>{0, 48}, grid.positions, rings, {.limit = 4});
  for (Index v = 0; v < 49; ++v) {
    const int from_first = v / 7 + v % 7, from_last = 12 - from_first;
    const int nearest = std::min(from_first, from_last);
    if (nearest <= 4) {
      EXPECT_EQ(distance[v], nearest);
    } else {
      EXPECT_TRUE(std::isinf(distance[v]));
    }
  }
}

}  // namespace
}  // namespace meshgraft
