
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "merge/seam.h"
#include "merge/seam_grafts.h"

namespace meshgraft::test {
namespace {

const Attribute& attribute_of(const Mesh& mesh, Domain domain, const std::string& name) {
  const Attribute* found = mesh.find_attribute(domain, name);
  if (!found) throw std::runtime_error("no attribute " + name);
  return *found;
}

std::string label_of(const Attribute& attribute, Index face) {
  return attribute.labels.at(static_cast<std::size_t>(attribute.values.at(face)));
}

TEST(Seam, CarriesTheAttributesOfBoth) {
  Graft graft = tubes(17, 68, false);
  for (Mesh* mesh : {&graft.target, &graft.source}) {
    const bool is_target = mesh == &graft.target;
    Attribute colour{.name = "colour", .components = 3},
        uv{.name = "uv", .domain = Domain::corner, .components = 2},
        normal{.name = "normal", .interpolation = Interpolation::direction, .components = 3},
        material{.name = "material",
                 .domain = Domain::face,
                 .interpolation = Interpolation::nearest,
                 .type = ScalarType::int32,
                 .labels = {"skin"}};
    for (Index v = 0; v < mesh->vertex_count(); ++v) {
      const Eigen::RowVector3d p = mesh->positions.row(v);
      colour.values.insert(colour.values.end(), {is_target ? 0.0 : 1.0, p.y(), p.z()});
      const Eigen::RowVector3d radial = Eigen::RowVector3d(p.x(), p.y(), 0).normalized();
      normal.values.insert(normal.values.end(), radial.begin(), radial.end());
    }
    for (Index f = 0; f < mesh->face_count(); ++f) {
      material.values.push_back(0);
      for (const Index v : mesh->faces[f]) {
        uv.values.insert(uv.values.end(), {mesh->positions(v, 2), is_target ? 0.0 : 1.0});
      }
    }
    mesh->attributes = {colour, normal, uv, material};
  }
  const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
  const Mesh& mesh = result.mesh;
  for (const Attribute& attribute : mesh.attributes) {
    const Index elements = attribute.domain == Domain::vertex ? mesh.vertex_count()
                           : attribute.domain == Domain::face ? mesh.face_count()
                                                              : mesh.faces.corner_count();
    ASSERT_EQ(attribute.values.size(), static_cast<std::size_t>(elements * attribute.components))
        << attribute.name;
  }
  const Attribute& colour = attribute_of(mesh, Domain::vertex, "colour");
  for (Index v = 0; v < graft.source.vertex_count(); ++v) {
    EXPECT_EQ(colour.values[3 * result.source.new_index[v]], 1);
    EXPECT_EQ(colour.values[3 * result.source.new_index[v] + 1], graft.source.positions(v, 1));
  }
  for (Index v = 0; v < result.source.new_index[0]; ++v) EXPECT_EQ(colour.values[3 * v], 0);

  // Normals have unit length and point outward, also at moved and new vertices.
  const Attribute& normal = attribute_of(mesh, Domain::vertex, "normal");
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Eigen::Map<const Eigen::RowVector3d> n(normal.values.data() + 3 * v);
    EXPECT_NEAR(n.norm(), 1, 1e-12);
    EXPECT_GT(n.dot(Eigen::RowVector3d(mesh.positions(v, 0), mesh.positions(v, 1), 0).normalized()), 0.9);
  }

  const Attribute& group = attribute_of(mesh, Domain::face, "group");
  const Attribute& material = attribute_of(mesh, Domain::face, "material");
  const Attribute& uv = attribute_of(mesh, Domain::corner, "uv");
  const Index first_new = result.new_faces.front();
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const bool is_source = std::all_of(mesh.faces[f].begin(), mesh.faces[f].end(),
                                       [&](Index v) { return v >= result.source.new_index[0]; });
    const std::string expected = f >= first_new ? "seam" : is_source ? "source" : "target";
    EXPECT_EQ(label_of(group, f), expected);
    EXPECT_EQ(label_of(material, f), is_source ? "skin_2" : "skin");
    for (std::size_t c = 0; c < mesh.faces[f].size(); ++c) {
      const double* values = uv.values.data() + 2 * (mesh.faces.first_corner(f) + static_cast<Index>(c));
      if (f >= first_new) {
        // The strip continues the target's texture, in which u is the height.
        EXPECT_NEAR(values[0], mesh.positions(mesh.faces[f][c], 2), 0.05);
        EXPECT_EQ(values[1], 0);
      } else {
        EXPECT_EQ(values[1], is_source ? 1 : 0);
      }
    }
  }
  EXPECT_EQ(result.notes.size(), 1);
}

/// Gives a tube two charts: u is the height, v is 0 on one half and 5 on the other.
void give_two_charts(Mesh& mesh) {
  Attribute uv{.name = "uv", .domain = Domain::corner, .components = 2};
  for (Index f = 0; f < mesh.face_count(); ++f) {
    double x = 0;
    for (const Index v : mesh.faces[f]) x += mesh.positions(v, 0);
    for (const Index v : mesh.faces[f])
      uv.values.insert(uv.values.end(), {mesh.positions(v, 2), x > 0 ? 0.0 : 5.0});
  }
  mesh.attributes = {uv};
}

TEST(Seam, ContinuesEachChartOfTheTarget) {
  Graft graft = tubes(24, 31, false);
  give_two_charts(graft.target);
  const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
  const Attribute& uv = attribute_of(result.mesh, Domain::corner, "uv");
  int of_one = 0, of_other = 0;
  for (const Index f : result.new_faces) {
    const auto value = [&](Index c, int k) {
      return uv.values[2 * (result.mesh.faces.first_corner(f) + c) + k];
    };
    // All corners are of one chart, and none is between the two.
    for (Index c = 0; c < 3; ++c) {
      EXPECT_EQ(value(c, 1), value(0, 1));
      EXPECT_NEAR(value(c, 0), result.mesh.positions(result.mesh.faces[f][c], 2), 0.05);
    }
    (value(0, 1) == 0 ? of_one : of_other) += 1;
    EXPECT_TRUE(value(0, 1) == 0 || value(0, 1) == 5);
  }
  EXPECT_GT(of_one, 0);
  EXPECT_GT(of_other, 0);
}

TEST(Seam, KeepsTheUvsOfBothAtCommonVertices) {
  Graft graft = tubes(24, 24, false);
  for (Mesh* mesh : {&graft.target, &graft.source}) {
    Attribute uv{.name = "uv", .components = 2};  // per vertex
    for (Index v = 0; v < mesh->vertex_count(); ++v)
      uv.values.insert(uv.values.end(), {mesh->positions(v, 2), mesh == &graft.target ? 0.0 : 9.0});
    mesh->attributes = {uv};
  }
  const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
  const Attribute& uv = attribute_of(result.mesh, Domain::corner, "uv");
  for (const Index f : result.new_faces)
    for (Index c = 0; c < 3; ++c) EXPECT_EQ(uv.values[2 * (result.mesh.faces.first_corner(f) + c) + 1], 0);
}

/// Colours a tube by angle and height, in whole numbers up to 255.
void colour(Mesh& mesh, double blue) {
  Attribute colours{.name = "colour", .type = ScalarType::uint8, .components = 3};
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    colours.values.insert(colours.values.end(), {std::round(100 + 90 * mesh.positions(v, 0)),
                                                 std::round(100 + 90 * mesh.positions(v, 1)), blue});
  mesh.attributes = {colours};
}

Eigen::Vector3d colour_at(const Mesh& mesh, Index v) {
  return Eigen::Map<const Eigen::Vector3d>(attribute_of(mesh, Domain::vertex, "colour").values.data() + 3 * v);
}

/// Calls `visit` with the two ends of each edge of the strips between target and source.
template <class Visit>
void for_each_edge_across(const SeamResult& result, const Visit& visit) {
  const Index first_of_source = result.source.new_index.front();
  for (const Index f : result.new_faces)
    for (Index c = 0; c < 3; ++c) {
      const Index a = result.mesh.faces[f][c], b = result.mesh.faces[f][(c + 1) % 3];
      if (a < first_of_source && b >= first_of_source) visit(a, b);
    }
}

TEST(Seam, GivesAPartWithoutColoursThoseOfTheTarget) {
  Graft graft = tubes(24, 24, false);
  colour(graft.target, 7);
  const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
  for_each_edge_across(result, [&](Index a, Index b) {
    EXPECT_LT((colour_at(result.mesh, a) - colour_at(result.mesh, b)).norm(), 45)
        << "less than two edges around";
  });
  for (const Index v : result.source.new_index) EXPECT_EQ(colour_at(result.mesh, v).z(), 7);
}

TEST(Seam, MixesColoursWithinALength) {
  Graft graft = tubes(24, 24, false);
  colour(graft.target, 20);
  colour(graft.source, 220);
  const SeamResult apart = make_seam(graft.target, graft.source, graft.pairs);
  const SeamResult mixed = make_seam(graft.target, graft.source, graft.pairs, {.blend_colours = 0.8});
  EXPECT_EQ(mixed.mesh.positions, apart.mesh.positions);
  for_each_edge_across(mixed, [&](Index a, Index b) {
    EXPECT_EQ(colour_at(apart.mesh, a).z(), 20);
    EXPECT_EQ(colour_at(apart.mesh, b).z(), 220);
    EXPECT_NEAR(colour_at(mixed.mesh, a).z(), 120, 1);
    EXPECT_NEAR(colour_at(mixed.mesh, b).z(), 120, 1);
  });
  Index changed = 0, kept = 0;
  double seam = 0;
  for_each_edge_across(
      mixed, [&](Index a, Index b) { seam = (mixed.mesh.positions(a, 2) + mixed.mesh.positions(b, 2)) / 2; });
  for (Index v = 0; v < mixed.mesh.vertex_count(); ++v) {
    const bool far = std::abs(mixed.mesh.positions(v, 2) - seam) > 1.2;
    if (colour_at(mixed.mesh, v) == colour_at(apart.mesh, v))
      ++kept;
    else
      ++changed;
    if (far) EXPECT_EQ(colour_at(mixed.mesh, v), colour_at(apart.mesh, v));
  }
  EXPECT_GT(changed, 48);
  EXPECT_GT(kept, 0);
}

TEST(Seam, KeepsGroupsAndCornerNormals) {
  Graft graft = tubes(24, 24, false);
  Attribute group{.name = "group",
                  .domain = Domain::face,
                  .interpolation = Interpolation::nearest,
                  .type = ScalarType::int32,
                  .labels = {"pipe", "collar"}};
  Attribute normal{
      .name = "normal", .domain = Domain::corner, .interpolation = Interpolation::direction, .components = 3};
  for (Index f = 0; f < graft.target.face_count(); ++f) {
    group.values.push_back(f < 30 ? 0 : 1);
    for (const Index v : graft.target.faces[f]) {
      normal.values.insert(normal.values.end(),
                           {graft.target.positions(v, 0), graft.target.positions(v, 1), 0});
    }
  }
  graft.target.attributes = {group, normal};
  const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
  const Attribute& groups = attribute_of(result.mesh, Domain::face, "group");
  EXPECT_EQ(label_of(groups, 0), "pipe");
  EXPECT_EQ(label_of(groups, 31), "collar");
  EXPECT_EQ(label_of(groups, result.new_faces.front() - 1), "source");
  EXPECT_EQ(label_of(groups, result.new_faces.front()), "seam");
  const Attribute& normals = attribute_of(result.mesh, Domain::corner, "normal");
  for (const Index f : result.new_faces) {
    for (Index c = 0; c < 3; ++c) {
      const std::ptrdiff_t corner = result.mesh.faces.first_corner(f) + c;
      const Eigen::Map<const Eigen::RowVector3d> n(normals.values.data() + 3 * corner);
      EXPECT_GT(n.head<2>().dot(result.mesh.positions.row(result.mesh.faces[f][c]).head<2>()), 0.9);
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
