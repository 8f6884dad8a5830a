#include <meshgraft/merge/seam.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/cut_halves.h"
#include "mesh/shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using test::coinciding_loops;
using test::side_of_plane;

struct Graft {
  std::string name;
  Mesh target, source;
  std::vector<LoopPair> pairs;
  Index euler_characteristic = 0;
  bool closed = false;
};

// Returns a mesh in two pieces, to be joined again.
Graft cut_in_two(const std::string& name, const Mesh& mesh, const Eigen::RowVector3d& normal, double offset) {
  Graft graft{name, side_of_plane(mesh, normal, offset, false), side_of_plane(mesh, normal, offset, true), {}};
  graft.pairs = coinciding_loops(graft.target, graft.source);
  const TopologySummary whole = summarise_topology(mesh);
  graft.euler_characteristic = whole.euler_characteristic;
  graft.closed = whole.closed;
  return graft;
}

// Returns point k of `around` points that divide a regular polygon inscribed in the unit circle evenly.
Eigen::RowVector3d on_polygon(int k, int around, int corners, double z) {
  const double place = static_cast<double>(k) * corners / around;
  const auto corner = [&](double i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    return Eigen::RowVector3d(std::cos(angle), std::sin(angle), z);
  };
  const double t = place - std::floor(place);
  return (1 - t) * corner(std::floor(place)) + t * corner(std::floor(place) + 1);
}

// Returns a tube on the upper end of another one, with different numbers of vertices around.
Graft tubes(int target_around, int source_around, bool triangles) {
  Graft graft{std::to_string(source_around) + " on " + std::to_string(target_around), {}, {}, {}, 0, false};
  graft.target = shapes::tube(target_around, 6, triangles);
  graft.target.positions.col(2) *= 2 * std::numbers::pi / target_around;
  graft.source = shapes::tube(source_around, 6, triangles);
  graft.source.positions.col(2) *= 2 * std::numbers::pi / source_around;
  const double top = graft.target.positions.col(2).maxCoeff();
  graft.source.positions.col(2).array() += top;
  LoopPair pair;
  for (int k = 0; k < source_around; ++k) {
    pair.source.push_back(k);
    graft.source.positions.row(k) = on_polygon(k, source_around, target_around, top);
  }
  for (int k = target_around - 1; k >= 0; --k) pair.target.push_back(6 * target_around + k);
  graft.pairs = {pair};
  return graft;
}

std::vector<Graft> grafts() {
  const test::TestMesh sphere = test::icosphere(3), bar = test::bar(6, 24);
  const Mesh closed_bar = make_mesh(bar.positions, bar.triangles);
  Eigen::Index longest = 0;
  (bar.positions.colwise().maxCoeff() - bar.positions.colwise().minCoeff()).maxCoeff(&longest);
  const Eigen::RowVector3d along = Eigen::RowVector3d::Unit(longest);
  return {cut_in_two("tube of quads", shapes::tube(24, 12), {0, 0, 1}, 6),
          cut_in_two("tube of triangles", shapes::tube(24, 12, true), {0, 0, 1}, 6),
          cut_in_two("torus, two pairs", shapes::torus(40, 16, true), {0.3, 1, 0}, 0.02),
          cut_in_two("torus of quads, two pairs", shapes::torus(40, 16), {0, 1, 0}, 0.02),
          cut_in_two("sphere", make_mesh(sphere.positions, sphere.triangles), {0.1, 0.2, 1}, 0.2),
          cut_in_two("bar", closed_bar, along, closed_bar.positions.col(longest).mean() + 0.01),
          cut_in_two("sample cylinder", make_sample("cylinder", 40), {0, 0, 1}, 2),
          cut_in_two("sample torus", make_sample("torus", 40), {1, 0.2, 0}, 0.05),
          tubes(17, 68, true),
          tubes(17, 128, false),
          tubes(64, 16, true),
          tubes(24, 24, false)};
}

bool same_positions(const Points& a, const Points& b) { return a.rows() == b.rows() && a == b; }

TEST(Seam, IsWatertightAndOfThePredictedTopology) {
  for (const Graft& graft : grafts()) {
    for (const StripMethod strip : {StripMethod::optimal, StripMethod::greedy}) {
      SCOPED_TRACE(graft.name);
      ASSERT_FALSE(graft.pairs.empty());
      const SeamResult result = make_seam(graft.target, graft.source, graft.pairs, {.strip = strip});
      const TopologySummary topology = summarise_topology(result.mesh);
      EXPECT_TRUE(topology.manifold);
      EXPECT_TRUE(topology.oriented);
      EXPECT_EQ(topology.closed, graft.closed);
      EXPECT_EQ(topology.components, 1);
      EXPECT_EQ(topology.isolated_vertices, 0);
      EXPECT_EQ(topology.euler_characteristic, graft.euler_characteristic);
      EXPECT_EQ(result.report.euler_characteristic, graft.euler_characteristic);
      EXPECT_EQ(result.report.expected_euler_characteristic, graft.euler_characteristic);
      EXPECT_TRUE(result.report.manifold && result.report.oriented);
      EXPECT_EQ(result.report.closed, graft.closed);
    }
  }
}

TEST(Seam, HasWellShapedTrianglesAndNoFolds) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamReport report = make_seam(graft.target, graft.source, graft.pairs).report;
    EXPECT_GE(report.angle_p1_deg, 15);
    EXPECT_LE(report.dihedral_p99_deg,
              std::max(report.target_dihedral_p99_deg, report.source_dihedral_p99_deg) + 5);
  }
}

TEST(Seam, MapsEveryVertex) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    const std::set<Index> band(result.band.begin(), result.band.end());
    std::set<Index> loops, reached;
    for (const LoopPair& pair : graft.pairs) loops.insert(pair.target.begin(), pair.target.end());
    ASSERT_EQ(result.target.new_index.size(), graft.target.vertex_count());
    ASSERT_EQ(result.source.new_index.size(), graft.source.vertex_count());
    Index last = -1;
    for (Index v = 0; v < graft.target.vertex_count(); ++v) {
      const Index now = result.target.new_index[v];
      EXPECT_EQ(now < 0, loops.contains(v));
      if (now < 0) continue;
      EXPECT_GT(now, last);
      last = now;
      reached.insert(now);
      if (!band.contains(now)) {
        EXPECT_EQ(result.mesh.positions.row(now), graft.target.positions.row(v));
      }
    }
    for (Index v = 0; v < graft.source.vertex_count(); ++v) {
      const Index now = result.source.new_index[v];
      EXPECT_GT(now, last);
      last = now;
      reached.insert(now);
      if (!band.contains(now)) {
        EXPECT_EQ(result.mesh.positions.row(now), graft.source.positions.row(v));
      }
    }
    EXPECT_EQ(last, result.mesh.vertex_count() - 1);
    EXPECT_LE(reached.size(), result.mesh.vertex_count());  // refining the ring adds vertices
  }
}

TEST(Seam, VisitsAllVerticesOfBothSides) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    std::set<Index> visited;
    for (const Index f : result.new_faces) {
      visited.insert(result.mesh.faces[f].begin(), result.mesh.faces[f].end());
      EXPECT_EQ(result.mesh.faces[f].size(), 3);
    }
    for (const LoopPair& pair : graft.pairs) {
      for (const Index v : pair.source) EXPECT_TRUE(visited.contains(result.source.new_index[v]));
    }
    EXPECT_EQ(result.report.new_faces, result.new_faces.size());
    // Each strip triangle has exactly one edge of a loop, so there are as many as vertices on the loops.
    EXPECT_EQ(visited.size(), result.new_faces.size());
  }
}

TEST(Seam, LeavesTheTargetAloneWhereAsked) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamResult still = make_seam(graft.target, graft.source, graft.pairs, {.target_rings = 0});
    for (Index v = 0; v < graft.target.vertex_count(); ++v) {
      const Index now = still.target.new_index[v];
      if (now >= 0) {
        EXPECT_EQ(still.mesh.positions.row(now), graft.target.positions.row(v));
      }
    }
    EXPECT_EQ(still.report.band_displacement_rel, 0);
    const SeamResult stiff =
        make_seam(graft.target, graft.source, graft.pairs, {.target_rings = 0, .source_rings = 0});
    EXPECT_TRUE(stiff.band.empty());
    const SeamResult unsmoothed = make_seam(graft.target, graft.source, graft.pairs, {.smoothing_steps = 0});
    EXPECT_TRUE(same_positions(stiff.mesh.positions, unsmoothed.mesh.positions));
  }
}

TEST(Seam, DoesNotDependOnTheOrderOfPairsTheStartsOrTheThreads) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamResult one = make_seam(graft.target, graft.source, graft.pairs);
    std::vector<LoopPair> pairs(graft.pairs.rbegin(), graft.pairs.rend());
    for (LoopPair& pair : pairs) {
      std::rotate(pair.source.begin(), pair.source.begin() + 5, pair.source.end());
      std::rotate(pair.target.begin(), pair.target.begin() + 3, pair.target.end());
    }
    const SeamResult other = make_seam(graft.target, graft.source, pairs, {}, shapes::with_threads(3));
    EXPECT_TRUE(same_positions(one.mesh.positions, other.mesh.positions));
    EXPECT_EQ(one.mesh.faces, other.mesh.faces);
  }
}

// Checks that fairing does not narrow a tube at the seam.
TEST(Seam, KeepsARoundTubeRound) {
  for (const int around : {12, 24, 96}) {
    const Graft graft = tubes(around, around, true);
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    const Eigen::VectorXd radius = result.mesh.positions.leftCols(2).rowwise().norm();
    EXPECT_NEAR(radius.minCoeff(), 1, 0.4 / around) << around;
    EXPECT_NEAR(radius.maxCoeff(), 1, 0.4 / around) << around;
  }
}

// Returns the largest angle between the normals of a strip triangle and of a face beside it.
double largest_bend_deg(const SeamResult& result) {
  const std::set<Index> strip(result.new_faces.begin(), result.new_faces.end());
  const auto normal = [&](Index f) {
    const auto face = result.mesh.faces[f];
    const Eigen::Vector3d a = result.mesh.positions.row(face[0]), b = result.mesh.positions.row(face[1]),
                          c = result.mesh.positions.row(face[2]);
    return Eigen::Vector3d((b - a).cross(c - a).normalized());
  };
  std::map<std::array<Index, 2>, std::vector<Index>> beside;
  for (Index f = 0; f < result.mesh.face_count(); ++f) {
    const auto face = result.mesh.faces[f];
    for (std::size_t c = 0; c < face.size(); ++c) {
      const auto [a, b] = std::minmax(face[c], face[(c + 1) % face.size()]);
      beside[{a, b}].push_back(f);
    }
  }
  double cosine = 1;
  for (const auto& [edge, faces] : beside) {
    if (faces.size() != 2 || (!strip.contains(faces[0]) && !strip.contains(faces[1]))) continue;
    cosine = std::min(cosine, normal(faces[0]).dot(normal(faces[1])));
  }
  return std::acos(cosine) * 180 / std::numbers::pi;
}

// The target's row at the strip is ragged and may reach past the source's loop.
TEST(Seam, MendsARaggedLoopOfTheTarget) {
  constexpr int around = 48, below_top = 5;
  for (const bool past_the_source : {false, true}) {
    Graft graft = tubes(around, around, true);
    const double row = 2 * std::numbers::pi / around;
    for (int k = 0; k < around; k += 2) graft.target.positions(below_top * around + k, 2) += 0.8 * row;
    if (past_the_source) {
      for (const int k : {10, 30}) graft.target.positions(below_top * around + k, 2) += row;
    }
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    EXPECT_GE(result.report.angle_p1_deg, 15) << past_the_source;
    EXPECT_LE(largest_bend_deg(result), 45) << past_the_source;
    EXPECT_LE(result.report.band_displacement_rel, 0.06) << past_the_source;
    for (Index v = 0; v < (below_top - 2) * around; ++v) {
      EXPECT_EQ(result.mesh.positions.row(result.target.new_index[v]), graft.target.positions.row(v)) << v;
    }
  }
}

// Creases of the target end in the strip without a fold where the source has none.
TEST(Seam, LetsCreasesEndWithoutAFold) {
  Graft graft = tubes(6, 48, true);
  graft.target = shapes::tube(48, 6, true);
  graft.target.positions.col(2) *= 2 * std::numbers::pi / 48;
  graft.pairs[0].target.clear();
  for (int k = 47; k >= 0; --k) graft.pairs[0].target.push_back(6 * 48 + k);
  const double top = graft.target.positions.col(2).maxCoeff();
  for (Index v = 0; v < graft.target.vertex_count(); ++v) {
    graft.target.positions.row(v) = on_polygon(v % 48, 48, 4, graft.target.positions(v, 2));
  }
  graft.source.positions.col(2).array() += top - graft.source.positions.col(2).minCoeff();
  EXPECT_LE(largest_bend_deg(make_seam(graft.target, graft.source, graft.pairs)), 75);
  // If the source has the same creases, they continue through the strip.
  Graft alike = graft;
  for (Index v = 0; v < alike.source.vertex_count(); ++v) {
    alike.source.positions.row(v) = on_polygon(v % 48, 48, 4, alike.source.positions(v, 2));
  }
  EXPECT_NEAR(largest_bend_deg(make_seam(alike.target, alike.source, alike.pairs)), 90, 10);
}

TEST(Seam, KeepsSharpEdgesOfTheTarget) {
  for (const Graft& graft : grafts()) {
    if (graft.name != "bar") continue;
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    const Eigen::RowVector3d low = graft.target.positions.colwise().minCoeff();
    const Eigen::RowVector3d high = graft.target.positions.colwise().maxCoeff();
    int edges = 0;
    for (Index v = 0; v < graft.target.vertex_count(); ++v) {
      const Eigen::RowVector3d p = graft.target.positions.row(v);
      const int extreme =
          static_cast<int>((p.array() == low.array()).count() + (p.array() == high.array()).count());
      if (extreme < 2 || result.target.new_index[v] < 0) continue;
      EXPECT_EQ(result.mesh.positions.row(result.target.new_index[v]), p);
      ++edges;
    }
    EXPECT_GT(edges, 20);
  }
}

TEST(Seam, HalvesACoarseRingAndNothingElse) {
  const Graft graft = tubes(17, 128, false);
  const SeamResult result = make_seam(graft.target, graft.source, graft.pairs, {.target_rings = 0});
  EXPECT_GT(result.mesh.vertex_count(), graft.target.vertex_count() + graft.source.vertex_count() - 17);
  EXPECT_LE(1 / result.report.edge_ratio, 2.2);
  // Quads that do not touch the ring stay quads: five rows of the target and all of the source.
  Index quads = 0;
  for (Index f = 0; f < result.mesh.face_count(); ++f) quads += result.mesh.faces[f].size() == 4;
  EXPECT_EQ(quads, 5 * 17 + 6 * 128);
}

// With few rows of faces between two loops, refining keeps the loops' rings apart.
TEST(Seam, HalvesRingsThatWouldMeet) {
  for (const bool triangles : {false, true}) {
    for (const int rows : {1, 2, 3}) {
      SCOPED_TRACE(rows);
      const Mesh whole = shapes::tube(20, rows + 8, triangles);
      const Mesh target = test::faces_where(whole, [&](Index f) {
        const Index row = f / (triangles ? 40 : 20);
        return row >= 4 && row < 4 + rows;
      });
      const Mesh source = test::faces_where(whole, [&](Index f) {
        const Index row = f / (triangles ? 40 : 20);
        return row < 4 || row >= 4 + rows;
      });
      const std::vector<LoopPair> pairs = coinciding_loops(target, source);
      ASSERT_EQ(pairs.size(), 2);
      const SeamResult both = make_seam(target, source, pairs);
      EXPECT_TRUE(both.report.manifold && both.report.oriented);
      EXPECT_EQ(both.report.euler_characteristic, 0);
      EXPECT_EQ(summarise_topology(both.mesh).boundary_loops, 2);
      // A single pair must leave the target's other loop alone.
      const SeamResult one = make_seam(target, source, std::span(pairs).first(1));
      EXPECT_EQ(summarise_topology(one.mesh).boundary_loops, 4);
      EXPECT_TRUE(one.report.manifold && one.report.oriented);
    }
  }
}

TEST(Seam, KeepsOtherLoopsInPlace) {
  const Graft graft = tubes(24, 24, true);
  const SeamResult result =
      make_seam(graft.target, graft.source, graft.pairs, {.target_rings = 20, .source_rings = 20});
  for (Index v = 0; v < 24; ++v) {
    EXPECT_EQ(result.mesh.positions.row(result.target.new_index[v]), graft.target.positions.row(v));
    const Index end = graft.source.vertex_count() - 24 + v;
    EXPECT_EQ(result.mesh.positions.row(result.source.new_index[end]), graft.source.positions.row(end));
  }
}

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
        EXPECT_TRUE(std::isnan(values[0]) && std::isnan(values[1]));
      } else {
        EXPECT_EQ(values[1], is_source ? 1 : 0);
      }
    }
  }
  EXPECT_EQ(result.notes.size(), 1);
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

void expect_refused(const Mesh& target, const Mesh& source, std::vector<LoopPair> pairs,
                    const SeamOptions& options, const std::string& id, const std::string& words = {}) {
  try {
    make_seam(target, source, pairs, options);
    FAIL() << "accepted: " << id;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    EXPECT_EQ(error.id(), id) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Seam, RefusesWhatItCannotJoin) {
  const Graft good = tubes(24, 24, true);
  const auto& [source, target] = good.pairs[0];
  const auto refused = [&](const LoopPair& pair, const std::string& id, const std::string& words = {}) {
    expect_refused(good.target, good.source, {pair}, {}, id, words);
  };
  refused({source, {1, 2}}, "merge.loop_too_short");
  refused({source, {0, 1, 9999}}, "merge.no_such_vertex", "target vertex 9999");
  refused({source, {0, 1, -1}}, "merge.no_such_vertex", "target vertex -1");
  refused({source, std::vector<Index>(target.rbegin(), target.rend())}, "merge.loop_runs_backwards");
  refused({source, {30, 31, 32}}, "merge.no_boundary_edge");
  std::vector<Index> twice = target;
  twice.insert(twice.end(), target.begin(), target.end());
  refused({source, twice}, "merge.loop_passes_twice");
  std::vector<Index> part(target.begin(), target.end() - 1);
  refused({source, part}, "merge.no_boundary_edge", "target");
  refused({part, target}, "merge.no_boundary_edge", "source");
  expect_refused(good.target, good.source, {good.pairs[0], good.pairs[0]}, {}, "merge.loops_meet");

  expect_refused(good.target, good.source, good.pairs, {.edge_ratio = 0.5}, "merge.edge_ratio_below_one");
  expect_refused(good.target, good.source, good.pairs, {.smoothing_steps = -1}, "core.negative");
  expect_refused(good.target, good.source, good.pairs, {.target_rings = -1}, "core.negative");
  expect_refused(good.target, good.source, good.pairs, {.sharp_angle_deg = std::nan("")}, "core.out_of_range");

  Graft bad = good;
  bad.source.positions(3, 1) = std::numeric_limits<double>::quiet_NaN();
  expect_refused(bad.target, bad.source, bad.pairs, {}, "merge.vertex_not_finite", "source vertex 3");
  bad = good;
  bad.source.positions(30, 1) = std::numeric_limits<double>::infinity();
  expect_refused(bad.target, bad.source, bad.pairs, {}, "merge.seam_vertex_not_finite");
}

// A loop whose vertices all lie at one point gives a poor seam, but a manifold and finite one.
TEST(Seam, SurvivesLoopsWithoutLength) {
  for (const bool of_target : {false, true}) {
    Graft graft = tubes(12, 12, true);
    Mesh& mesh = of_target ? graft.target : graft.source;
    for (const Index v : of_target ? graft.pairs[0].target : graft.pairs[0].source) {
      mesh.positions.row(v) = Eigen::RowVector3d(0, 0, 3);
    }
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    EXPECT_TRUE(result.report.manifold);
    EXPECT_TRUE(result.mesh.positions.allFinite());
  }
}

TEST(Seam, StopsWhenAsked) {
  const Graft graft = tubes(24, 24, true);
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  try {
    make_seam(graft.target, graft.source, graft.pairs, {}, context);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace meshgraft
