#include "mesh/mesh_part.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/refine.h"
#include "mesh/shapes.h"

namespace meshgraft {
namespace {

Attribute numbered(const std::string& name, Domain domain, std::size_t elements) {
  Attribute attribute{.name = name, .domain = domain, .components = 2};
  for (std::size_t k = 0; k < 2 * elements; ++k) attribute.values.push_back(0.5 * static_cast<double>(k));
  return attribute;
}

/// A mesh with one attribute in each domain.
struct Case {
  std::string name;
  Mesh mesh;

  Case(std::string case_name, Mesh bare) : name(std::move(case_name)), mesh(std::move(bare)) {
    mesh.attributes = {numbered("a", Domain::vertex, mesh.vertex_count()),
                       numbered("b", Domain::face, mesh.face_count()),
                       numbered("c", Domain::corner, mesh.faces.corner_count())};
  }
};

std::vector<Case> cases() {
  return {{"cube", shapes::cube()},
          {"grid", shapes::grid(5, 4)},
          {"grid of triangles", shapes::grid(5, 4, true)},
          {"torus", shapes::torus(8, 5, true)},
          {"bow tie", shapes::bow_tie()},
          {"three on an edge", shapes::three_on_an_edge()}};
}

std::vector<Index> range(Index first, Index last) {
  std::vector<Index> indices(last - first);
  std::iota(indices.begin(), indices.end(), first);
  return indices;
}

/// Returns some sets of faces: none, the first, a run, every second one, all.
std::vector<std::vector<Index>> selections(const Mesh& mesh) {
  const Index count = mesh.face_count();
  std::vector<Index> second;
  for (Index f = 0; f < count; f += 2) second.push_back(f);
  return {{}, {0}, range(count / 3, count / 2), second, range(0, count)};
}

/// Compares bits, so that missing values (NaN) are equal.
bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

void expect_equal(const Mesh& mesh, const Mesh& expected) {
  EXPECT_EQ(mesh.positions, expected.positions);
  EXPECT_EQ(mesh.faces, expected.faces);
  ASSERT_EQ(mesh.attributes.size(), expected.attributes.size());
  for (std::size_t k = 0; k < mesh.attributes.size(); ++k) {
    EXPECT_EQ(mesh.attributes[k].name, expected.attributes[k].name);
    EXPECT_TRUE(same_bits(mesh.attributes[k].values, expected.attributes[k].values));
  }
}

TEST(MeshPart, HasTheFacesVerticesAndAttributesOfTheWhole) {
  for (const auto& [name, mesh] : cases())
    for (const std::vector<Index>& faces : selections(mesh)) {
      SCOPED_TRACE(name);
      const MeshPart part = part_of(mesh, faces);
      EXPECT_EQ(part.faces, faces);
      EXPECT_TRUE(std::is_sorted(part.vertices.begin(), part.vertices.end()));
      ASSERT_EQ(part.mesh.face_count(), static_cast<Index>(faces.size()));
      for (std::size_t f = 0; f < faces.size(); ++f) {
        std::vector<Index> corners;
        for (const Index v : part.mesh.faces[static_cast<Index>(f)]) corners.push_back(part.vertices[v]);
        const auto of_whole = mesh.faces[faces[f]];
        EXPECT_TRUE(std::equal(corners.begin(), corners.end(), of_whole.begin(), of_whole.end()));
        EXPECT_EQ(part.mesh.attributes[1].values[2 * f], mesh.attributes[1].values[2 * faces[f]]);
      }
      for (std::size_t v = 0; v < part.vertices.size(); ++v) {
        EXPECT_EQ(part.mesh.positions.row(v), mesh.positions.row(part.vertices[v]));
        EXPECT_EQ(part.mesh.attributes[0].values[2 * v], mesh.attributes[0].values[2 * part.vertices[v]]);
      }
    }
}

TEST(ReplacePart, ByItselfChangesNothing) {
  for (const auto& [name, mesh] : cases())
    for (const std::vector<Index>& faces : selections(mesh)) {
      SCOPED_TRACE(name);
      const MeshPart part = part_of(mesh, faces);
      const ReplaceResult result = replace_part(mesh, part, {part.mesh, part.vertices, part.faces});
      expect_equal(result.mesh, mesh);
      EXPECT_EQ(result.whole.new_index, range(0, mesh.vertex_count()));
      EXPECT_EQ(result.replacement.new_index, part.vertices);
    }
}

TEST(ReplacePart, ByNothingRemovesFacesAndTheirVertices) {
  const Mesh mesh = shapes::grid(5, 4);
  const MeshPart part = part_of(mesh, range(0, mesh.face_count()));
  const ReplaceResult result = replace_part(mesh, part, {Mesh{}, {}, {}});
  EXPECT_EQ(result.mesh.vertex_count(), 0);
  EXPECT_EQ(result.mesh.face_count(), 0);
  EXPECT_EQ(result.whole.new_index, std::vector<Index>(mesh.vertex_count(), -1));
}

TEST(ReplacePart, OfARefinedPartEqualsTheRefinedWhole) {
  for (const auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    // The edges between vertices of face 0 are split, and the part has all faces at these vertices.
    const auto split = mesh.faces[0];
    const auto is_split = [&](Index v) { return std::find(split.begin(), split.end(), v) != split.end(); };
    std::vector<Index> faces, vertices;
    for (Index f = 0; f < mesh.face_count(); ++f)
      if (std::any_of(mesh.faces[f].begin(), mesh.faces[f].end(), is_split)) faces.push_back(f);
    const MeshPart part = part_of(mesh, faces);
    for (std::size_t v = 0; v < part.vertices.size(); ++v)
      if (is_split(part.vertices[v])) vertices.push_back(static_cast<Index>(v));
    const RefineResult refined = split_edges_within(part.mesh, vertices);
    Replacement replacement{refined.mesh, part.vertices, refined.face_parent};
    replacement.vertex.resize(refined.mesh.vertex_count(), -1);
    for (Index& parent : replacement.face) parent = part.faces[parent];
    expect_equal(replace_part(mesh, part, replacement).mesh,
                 split_edges_within(mesh, {split.data(), split.size()}).mesh);
  }
}

TEST(ReplacePart, ValuesThatTheWholeLacksAreMissing) {
  const Case sheet{"grid", shapes::grid(5, 4)};
  MeshPart part = part_of(sheet.mesh, {3});
  part.mesh.attributes.push_back(numbered("new", Domain::face, 1));
  const ReplaceResult result = replace_part(sheet.mesh, part, {part.mesh, part.vertices, part.faces});
  const Attribute* added = result.mesh.find_attribute(Domain::face, "new");
  ASSERT_NE(added, nullptr);
  for (Index f = 0; f < sheet.mesh.face_count(); ++f) EXPECT_EQ(std::isnan(added->values[2 * f]), f != 3);
}

}  // namespace
}  // namespace meshgraft
