
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/shapes.h"
#include "mesh/weld.h"

namespace meshgraft {
namespace {

std::vector<Mesh> shapes_to_tear() {
  return {shapes::cube(), shapes::grid(4, 3), shapes::tube(7, 4, true), shapes::torus(),
          shapes::moebius_strip()};
}

/// Returns a soup in which every face has vertices of its own, in random order.
Mesh soup_of(const Mesh& mesh, unsigned seed) {
  std::vector<Index> place(static_cast<std::size_t>(mesh.faces.corner_count()));
  for (std::size_t c = 0; c < place.size(); ++c) place[c] = static_cast<Index>(c);
  std::shuffle(place.begin(), place.end(), std::mt19937(seed));
  Mesh soup;
  soup.positions.resize(mesh.faces.corner_count(), 3);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    std::vector<Index> face;
    for (std::size_t c = 0; c < mesh.faces[f].size(); ++c) {
      face.push_back(place[mesh.faces.first_corner(f) + static_cast<Index>(c)]);
      soup.positions.row(face.back()) = mesh.positions.row(mesh.faces[f][c]);
    }
    soup.faces.push_back(face);
  }
  return soup;
}

// Welds the open seams of a mesh.
Weld weld_of(const Mesh& mesh) {
  const Diagnostics diagnostics = check_mesh(mesh);
  const Finding* torn = diagnostics.find(FindingKind::duplicate_vertex);
  return torn == nullptr ? Weld() : weld_at(mesh, torn->indices);
}

TEST(Weld, GivesASoupTheTopologyItCameFrom) {
  for (const Mesh& mesh : shapes_to_tear()) {
    const TopologySummary before = summarise_topology(mesh);
    for (unsigned seed = 0; seed < 5; ++seed) {
      const Mesh soup = soup_of(mesh, seed);
      const Weld weld = weld_of(soup);
      EXPECT_EQ(weld.copies, soup.vertex_count() - mesh.vertex_count());
      const TopologySummary after = summarise_topology(welded(soup, weld));
      EXPECT_EQ(after.vertices, before.vertices);
      EXPECT_EQ(after.edges, before.edges);
      EXPECT_EQ(after.components, before.components);
      EXPECT_EQ(after.boundary_loops, before.boundary_loops);
      EXPECT_EQ(after.genus, before.genus);
    }
  }
}

TEST(Weld, RepresentativesAreTheSmallestOfTheirPlace) {
  const Mesh soup = soup_of(shapes::torus(), 3);
  const Weld weld = weld_of(soup);
  for (Index v = 0; v < soup.vertex_count(); ++v) {
    EXPECT_LE(weld.of(v), v);
    EXPECT_EQ(weld.of(weld.of(v)), weld.of(v));
    EXPECT_EQ(soup.positions.row(weld.of(v)), soup.positions.row(v));
  }
}

TEST(Weld, FindsNothingInMeshesThatShareTheirVertices) {
  for (const Mesh& mesh : shapes_to_tear()) EXPECT_TRUE(weld_of(mesh).empty());
}

TEST(Weld, LeavesClosedPartsThatTouchApart) {
  Mesh two = shapes::cube();
  const Mesh one = shapes::cube();
  two.positions.conservativeResize(16, 3);
  two.positions.bottomRows(8) = one.positions.rowwise() + Eigen::RowVector3d(1, 0, 0);
  for (Index f = 0; f < one.face_count(); ++f) {
    std::vector<Index> face(one.faces[f].begin(), one.faces[f].end());
    for (Index& v : face) v += 8;
    two.faces.push_back(face);
  }
  EXPECT_TRUE(weld_of(two).empty());
}

TEST(Weld, KnowsNegativeZeroAndLeavesOutWhatIsNotFinite) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Mesh zeros = shapes::polygons(
      {{0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}, {1, -0.0, 0}, {0, -1, 0}}, {{0, 1, 2}, {4, 3, 5}});
  EXPECT_EQ(weld_of(zeros).of(3), 0);
  EXPECT_EQ(weld_of(zeros).of(4), 1);
  const Mesh nans = shapes::polygons({{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}, {1, 0, 0}, {0, -1, 0}},
                                     {{0, 1, 2}, {3, 4, 5}});
  EXPECT_TRUE(weld_of(nans).empty());
  const Mesh isolated = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}, {{0, 1, 2}});
  EXPECT_TRUE(weld_of(isolated).empty());
}

TEST(Weld, SkipsFacesWithIndicesOutOfRange) {
  Mesh soup = soup_of(shapes::cube(), 1);
  soup.faces.push_back(std::vector<Index>{0, 99, -1});
  const Weld weld = weld_of(soup);
  EXPECT_EQ(weld.copies, 16);
  const Mesh whole = welded(soup, weld);
  EXPECT_EQ(whole.faces[6][1], 99);
  unweld(whole, weld, soup);
  EXPECT_EQ(soup.faces[6][2], -1);
}

TEST(Weld, UnweldingPutsCopiesWhereTheirRepresentativeWent) {
  Mesh soup = soup_of(shapes::torus(), 2);
  const Faces faces = soup.faces;
  const Weld weld = weld_of(soup);
  Mesh whole = welded(soup, weld);
  for (Index v = 0; v < whole.vertex_count(); ++v)
    if (weld.of(v) == v) whole.positions.row(v) += Eigen::RowVector3d(v, 2 * v, 0.5);
  const Mesh moved = whole;
  unweld(moved, weld, soup);
  EXPECT_EQ(soup.faces, faces);
  for (Index v = 0; v < soup.vertex_count(); ++v)
    EXPECT_EQ(soup.positions.row(v), moved.positions.row(weld.of(v)));
}

// Values that differ across a seam still differ, and smooth normals stay smooth across it.
TEST(Weld, CarriesVertexAttributesOverTheSeam) {
  const Mesh tube = shapes::tube(12, 5, true);
  Mesh soup = soup_of(tube, 4);
  const auto count = static_cast<std::size_t>(soup.vertex_count());
  Attribute normal{.name = "normal", .interpolation = Interpolation::direction, .components = 3};
  Attribute uv{.name = "uv", .components = 2};
  for (std::size_t v = 0; v < count; ++v) {
    const Eigen::RowVector3d p = soup.positions.row(static_cast<Eigen::Index>(v));
    normal.values.insert(normal.values.end(), {p.x(), p.y(), 0});
    uv.values.insert(uv.values.end(), {double(v), 7});
  }
  soup.attributes = {normal, uv};

  const Weld weld = weld_of(soup);
  Mesh whole = welded(soup, weld);
  EXPECT_EQ(whole.attributes[0].domain, Domain::corner);
  const Points rest = whole.positions;
  for (Index v = 0; v < whole.vertex_count(); ++v)
    whole.positions(v, 0) += 0.1 * std::sin(3 * whole.positions(v, 2));
  update_normals(whole, rest);
  unweld(whole, weld, soup);
  EXPECT_EQ(soup.attributes[1].values, uv.values);
  EXPECT_NE(soup.attributes[0].values, normal.values);
  for (std::size_t v = 0; v < count; ++v) {
    const auto first = static_cast<std::size_t>(weld.of(static_cast<Index>(v)));
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(soup.attributes[0].values[3 * v + k], soup.attributes[0].values[3 * first + k]);
  }
}

}  // namespace
}  // namespace meshgraft
