#include <meshgraft/mesh/repair.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/shapes.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

Mesh mesh_of(const test::TestMesh& family) { return make_mesh(family.positions, family.triangles); }

bool same_bits(const Mesh& a, const Mesh& b) {
  return a.faces == b.faces && a.positions.rows() == b.positions.rows() && a.positions == b.positions;
}

// Returns the names of a mesh's findings, except polygons, with their descriptions.
std::string findings_left(const Mesh& mesh) {
  std::string names;
  for (const Finding& finding : check_mesh(mesh).findings)
    if (finding.kind != FindingKind::polygon)
      names += fmt::format("{} ({}) ", name_of(finding.kind), finding.description());
  return names;
}

void expect_sound_maps(const Mesh& given, const RepairResult& result) {
  ASSERT_EQ(result.vertex.new_index.size(), static_cast<std::size_t>(given.vertex_count()));
  ASSERT_EQ(result.face.new_index.size(), static_cast<std::size_t>(given.face_count()));
  ASSERT_EQ(result.vertex_origin.size(), static_cast<std::size_t>(result.mesh.vertex_count()));
  ASSERT_EQ(result.face_origin.size(), static_cast<std::size_t>(result.mesh.face_count()));
  for (Index v = 0; v < result.mesh.vertex_count(); ++v) {
    const Index old = result.vertex_origin[v];
    if (old < 0) continue;
    ASSERT_LT(old, given.vertex_count());
    EXPECT_EQ(result.mesh.positions.row(v), given.positions.row(old));
  }
  for (const Index v : result.vertex.new_index) EXPECT_LT(v, result.mesh.vertex_count());
  for (std::size_t f = 0; f < result.face.new_index.size(); ++f)
    if (const Index now = result.face.new_index[f]; now >= 0) {
      EXPECT_EQ(result.face_origin[now], static_cast<Index>(f));
    }
}

TEST(Repair, LeavesCleanMeshesAsTheyAre) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = mesh_of(family);
    const RepairResult result = repair(mesh, {.remove_isolated = false});
    for (const RepairChange& change : result.changes)
      ADD_FAILURE() << name_of(change.kind) << ": " << change.description();
    EXPECT_TRUE(same_bits(result.mesh, mesh));
    expect_sound_maps(mesh, result);
  }
}

TEST(Repair, MendsEachDefectOfEachFamily) {
  for (const test::TestMesh& family : test::mesh_families()) {
    for (const FindingKind kind : test::defect_kinds()) {
      SCOPED_TRACE(fmt::format("{} {}", family.name, name_of(kind)));
      const test::Defective defective = test::inject(mesh_of(family), kind);
      const RepairResult result = repair(defective.mesh);
      EXPECT_EQ(findings_left(result.mesh), "");
      EXPECT_TRUE(result.changed() || defective.count == 0);
      expect_sound_maps(defective.mesh, result);
      const RepairResult again = repair(result.mesh);
      EXPECT_FALSE(again.changed()) << name_of(again.changes.front().kind);
      EXPECT_TRUE(same_bits(again.mesh, result.mesh));
    }
  }
}

Attribute numbered(Domain domain, const std::string& name, int components, std::size_t elements) {
  Attribute attribute{.name = name, .domain = domain, .components = components};
  for (std::size_t k = 0; k < elements * static_cast<std::size_t>(components); ++k)
    attribute.values.push_back(static_cast<double>(k));
  return attribute;
}

TEST(Repair, GivesTheSourceBackOfACleanMesh) {
  struct Document : SourceDocument {};
  Mesh mesh = shapes::cube();
  mesh.source = std::make_shared<Document>();
  mesh.attributes.push_back(numbered(Domain::vertex, "weight", 1, 8));
  EXPECT_EQ(repair(mesh).mesh.source, mesh.source);
  EXPECT_FALSE(repair(shapes::moebius_strip()).changed()) << "it has no winding";
  const std::vector<Note> notes = repair(shapes::moebius_strip()).notes;
  ASSERT_EQ(notes.size(), 1);
  EXPECT_EQ(notes[0].id(), "mesh.one_sided_surface");
  EXPECT_TRUE(notes[0].text().starts_with("2 edges keep")) << notes[0].text();
}

TEST(Repair, KeepsAttributesOfWhatItKeeps) {
  Mesh mesh = shapes::torus(12, 9, true);
  mesh.attributes = {numbered(Domain::vertex, "weight", 1, 108), numbered(Domain::face, "group", 1, 216),
                     numbered(Domain::corner, "uv", 2, 648)};
  mesh.faces.push_back(std::vector<Index>{0, 0, 1});
  mesh.attributes[1].values.push_back(7);
  mesh.attributes[2].values.resize(2 * 651, 0);
  const RepairResult result = repair(mesh);
  ASSERT_EQ(result.mesh.attributes.size(), 3);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto& kept = result.mesh.attributes[a].values;
    EXPECT_TRUE(std::equal(kept.begin(), kept.end(), mesh.attributes[a].values.begin()));
    EXPECT_FALSE(kept.empty());
  }
}

TEST(Repair, KeepsBothSidesOfASeamPerCorner) {
  Mesh mesh = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}},
                               {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}});
  mesh.attributes = {numbered(Domain::vertex, "uv", 2, 7),
                     {.name = "weight", .components = 1, .values = std::vector<double>(7, 3.0)}};
  const RepairResult result = repair(mesh);
  ASSERT_TRUE(result.find(RepairChangeKind::welded_vertex));
  EXPECT_EQ(result.find(RepairChangeKind::welded_vertex)->indices, (std::vector<Index>{4, 6}));
  EXPECT_EQ(result.vertex.new_index, (std::vector<Index>{0, 1, 2, 3, 1, 4, 2}));
  const Attribute* uv = result.mesh.find_attribute(Domain::corner, "uv");
  ASSERT_TRUE(uv);
  EXPECT_EQ(uv->values, (std::vector<double>{0, 1, 2, 3, 4, 5, 0, 1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}));
  EXPECT_TRUE(result.mesh.find_attribute(Domain::vertex, "weight")) << "equal values stay per vertex";
}

TEST(Repair, TurnsNormalsWithTheirFaces) {
  Mesh mesh = shapes::torus(8, 6, true);
  const Points up = Points::Constant(mesh.face_count(), 3, 0);
  mesh.attributes.push_back({.name = "normal",
                             .domain = Domain::face,
                             .interpolation = Interpolation::direction,
                             .components = 3,
                             .values = std::vector<double>(up.data(), up.data() + up.size())});
  for (Index f = 0; f < mesh.face_count(); ++f) {  // normals by the winding of `inward`
    const auto face = mesh.faces[f];
    const Eigen::RowVector3d a = mesh.positions.row(face[0]);
    const Eigen::RowVector3d normal =
        (mesh.positions.row(face[2]) - a).cross(mesh.positions.row(face[1]) - a).normalized();
    std::copy(normal.data(), normal.data() + 3, mesh.attributes[0].values.begin() + 3 * f);
  }
  Mesh inward = mesh;
  inward.faces = {};
  for (Index f = 0; f < mesh.face_count(); ++f)
    inward.faces.push_back(std::vector<Index>{mesh.faces[f][0], mesh.faces[f][2], mesh.faces[f][1]});
  const RepairResult result = repair(inward);
  ASSERT_TRUE(result.find(RepairChangeKind::turned_component));
  EXPECT_EQ(result.mesh.faces, mesh.faces);
  for (std::size_t k = 0; k < mesh.attributes[0].values.size(); ++k)
    EXPECT_EQ(result.mesh.attributes[0].values[k], -mesh.attributes[0].values[k]);
}

TEST(Repair, SwitchesStepsOff) {
  const Mesh torus = shapes::torus(30, 20, true);
  const auto changes = [](const Mesh& mesh, const RepairOptions& options) {
    return repair(mesh, options).changes.size();
  };
  EXPECT_EQ(changes(test::as_soup(torus), {.remove_duplicate_shells = false, .weld = false}), 0);
  EXPECT_EQ(changes(test::with_floating_bits(torus, 3, 1), {.remove_debris = false}), 0);
  EXPECT_EQ(changes(test::without_faces(torus, 3, 0, 1), {.hole_edges = 0}), 0);
  EXPECT_EQ(changes(test::with_isolated(torus, 3, 1), {.remove_isolated = false}), 0);
  EXPECT_EQ(changes(test::with_turned_patches(torus, 2, 1, 1), {.unify_winding = false}), 0);
  EXPECT_EQ(changes(test::both(torus, torus), {.remove_duplicate_shells = false}), 0);
  EXPECT_EQ(changes(test::with_repeated_faces(torus, 3, 1),
                    {.clean_faces = false, .split_non_manifold = false, .unify_winding = false}),
            0);
  EXPECT_EQ(changes(test::with_bow_ties(torus, 2, 1), {.split_non_manifold = false, .remove_isolated = false}),
            0);
  EXPECT_THROW(repair(test::with_bad_indices(torus, 3, 1), {.remove_invalid = false}), Error);
  EXPECT_THROW(repair(test::with_non_finite(torus, 3, 1), {.remove_invalid = false}), Error);
  EXPECT_THROW(repair(torus, {.weld_distance = -1}), Error);
  EXPECT_THROW(repair(torus, {.debris_rel = 2}), Error);
  EXPECT_THROW(repair(torus, {.hole_edges = -1}), Error);
}

TEST(Repair, WeldsWithinTheDistanceThatIsGiven) {
  const Mesh torus = shapes::torus(30, 20, true);
  const Mesh torn = test::with_noise(test::as_soup(torus), 1e-4, 3);
  EXPECT_GT(summarise_topology(repair(torn).mesh).components, 100);
  const TopologySummary welded = summarise_topology(repair(torn, {.weld_distance = 1e-2}).mesh);
  EXPECT_EQ(welded.components, 1);
  EXPECT_TRUE(welded.closed && welded.manifold && welded.oriented);
}

TEST(Repair, ClosesHolesThatAreAskedFor) {
  Mesh tube = shapes::tube(30, 8, true);
  tube.attributes = {numbered(Domain::vertex, "weight", 1, 270), numbered(Domain::face, "group", 1, 480),
                     numbered(Domain::corner, "uv", 2, 1440)};
  EXPECT_FALSE(repair(tube).changed()) << "the ends of a tube are meant";
  const RepairResult result = repair(tube, {.hole_edges = 30});
  EXPECT_EQ(result.find(RepairChangeKind::filled_hole)->count, 2);
  const TopologySummary topology = summarise_topology(result.mesh);
  EXPECT_TRUE(topology.closed && topology.manifold && topology.oriented);
  EXPECT_EQ(result.mesh.face_count(), tube.face_count() + 2 * 28);
  EXPECT_EQ(result.face_origin.back(), -1);
  for (const Attribute& attribute : result.mesh.attributes)
    EXPECT_TRUE(
        std::none_of(attribute.values.begin(), attribute.values.end(), [](double x) { return std::isnan(x); }));
}

TEST(Repair, DoesNotDependOnThreads) {
  const Mesh mesh =
      test::with_noise(test::as_soup(test::with_fins(shapes::torus(40, 30, true), 5, 1)), 1e-7, 2);
  const Mesh one = repair(mesh, {}, shapes::with_threads(1)).mesh;
  EXPECT_TRUE(same_bits(one, repair(mesh, {}, shapes::with_threads(4)).mesh));
}

// The smaller fan of a bow tie comes first and keeps the vertex. The fan is removed as debris; the vertex
// stays.
TEST(Repair, KeepsAVertexWhileOneOfItsFansRemains) {
  const Mesh mesh = shapes::polygons(
      {{0, 0, 0}, {-1, 0, 0}, {-1, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 2, 0}, {2, 0, 0}, {2, 2, 0}},
      {{0, 1, 2}, {0, 3, 4}, {0, 4, 5}, {3, 6, 4}, {4, 6, 7}, {4, 7, 5}});
  const RepairResult result = repair(mesh, {.debris_rel = 1});
  ASSERT_TRUE(result.find(RepairChangeKind::removed_debris));
  EXPECT_EQ(result.mesh.face_count(), 5);
  ASSERT_GE(result.vertex.new_index[0], 0);
  EXPECT_EQ(result.vertex_origin[result.vertex.new_index[0]], 0);
  EXPECT_EQ(result.vertex.new_index[1], -1);
  expect_sound_maps(mesh, result);
}

TEST(Repair, ListsVerticesThatItCannotKeep) {
  Mesh mesh = test::with_isolated(shapes::cube(), 3, 1);
  mesh.positions(9, 1) = NAN;
  const RepairResult result = repair(mesh, {.remove_isolated = false});
  ASSERT_TRUE(result.find(RepairChangeKind::removed_non_finite_vertex));
  EXPECT_EQ(result.find(RepairChangeKind::removed_non_finite_vertex)->indices, std::vector<Index>{9});
  EXPECT_EQ(result.vertex.new_index[9], -1);
  EXPECT_EQ(result.mesh.vertex_count(), 10);
}

// All triangles of the soup meet at one hub, so each is near all the others.
TEST(Repair, WeldsAWheelOfThousandsOfTriangles) {
  constexpr int count = 6000;
  Mesh wheel;
  wheel.positions.resize(3 * count, 3);
  for (int k = 0; k < count; ++k) {
    const auto rim = [&](int i) {
      const double angle = 2 * M_PI * (i % count) / count;
      return Eigen::RowVector3d(std::cos(angle), std::sin(angle), 0.1 * std::sin(7 * angle));
    };
    wheel.positions.row(3 * k) = Eigen::RowVector3d(0, 0, 1);
    wheel.positions.row(3 * k + 1) = rim(k);
    wheel.positions.row(3 * k + 2) = rim(k + 1);
    wheel.faces.push_back(std::vector<Index>{3 * k, 3 * k + 1, 3 * k + 2});
  }
  const RepairResult result = repair(wheel);
  EXPECT_EQ(result.mesh.vertex_count(), count + 1);
  EXPECT_EQ(result.mesh.face_count(), count);
  EXPECT_EQ(findings_left(result.mesh), "");
}

// The pages of a book are joined in pairs, the straightest ones, however many there are.
TEST(Repair, PairsThePagesOfABook) {
  for (const int pages : {4, 30, 400}) {
    SCOPED_TRACE(pages);
    Mesh book;
    book.positions.resize(2 + pages, 3);
    book.positions.row(0) = Eigen::RowVector3d(0, 0, 0);
    book.positions.row(1) = Eigen::RowVector3d(0, 0, 1);
    for (int k = 0; k < pages; ++k) {
      const double angle = 2 * M_PI * k / pages;
      book.positions.row(2 + k) = Eigen::RowVector3d(std::cos(angle), std::sin(angle), 0.5);
      book.faces.push_back(k < pages / 2 ? std::vector<Index>{0, 1, 2 + k} : std::vector<Index>{1, 0, 2 + k});
    }
    const RepairResult result = repair(book, {.weld = false});
    EXPECT_EQ(result.mesh.face_count(), pages);
    EXPECT_EQ(result.mesh.vertex_count(), 2 * (pages / 2) + pages);
    EXPECT_EQ(findings_left(result.mesh).find("non-manifold"), std::string::npos) << findings_left(result.mesh);
    const Index opposite = result.face.new_index[pages / 2];
    EXPECT_EQ(result.mesh.faces[0][0], result.mesh.faces[opposite][1]) << "page 0 goes on straight";
  }
}

// Repair ends for any faces, and leaves no finding that is refused or has to be repaired.
TEST(Repair, EndsForAnyFaces) {
  std::mt19937 random(5);
  const auto below = [&](unsigned n) { return static_cast<Index>(random() % n); };
  for (int seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    Mesh mesh;
    const Index vertices = 1 + below(12);
    mesh.positions.resize(vertices, 3);
    for (Eigen::Index k = 0; k < mesh.positions.size(); ++k) mesh.positions.data()[k] = below(4);
    if (below(6) == 0) mesh.positions(below(vertices), 1) = NAN;
    for (Index f = below(16); f > 0; --f) {
      std::vector<Index> face(below(4) ? 3 : below(7));
      for (Index& v : face) v = below(20) == 0 ? below(40) - 20 : below(vertices);
      mesh.faces.push_back(face);
    }
    const RepairResult result = repair(mesh);
    const TopologySummary topology = summarise_topology(result.mesh);
    EXPECT_TRUE(topology.manifold);
    for (const Finding& finding : check_mesh(result.mesh).findings)
      EXPECT_EQ(finding.severity, Severity::info) << name_of(finding.kind) << ": " << finding.description();
    EXPECT_FALSE(repair(result.mesh).changed());
    if (HasFailure()) break;
  }
}

// Returns a flat grid of triangles, n×n cells of side 1/n, without the faces at the vertices in `holes`.
Mesh grid_without(Index n, const std::set<std::array<Index, 2>>& holes) {
  Mesh mesh;
  mesh.positions.resize((n + 1) * (n + 1), 3);
  Attribute uv{.name = "uv", .domain = Domain::vertex, .components = 2};
  for (Index j = 0; j <= n; ++j)
    for (Index i = 0; i <= n; ++i) {
      mesh.positions.row(j * (n + 1) + i) << double(i) / n, double(j) / n, 0;
      uv.values.insert(uv.values.end(), {double(i) / n, double(j) / n});
    }
  mesh.attributes.push_back(uv);
  const auto add = [&](std::array<std::array<Index, 2>, 3> face) {
    if (std::any_of(face.begin(), face.end(), [&](const auto& at) { return holes.contains(at); })) return;
    std::array<Index, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) corners[c] = face[c][1] * (n + 1) + face[c][0];
    mesh.faces.push_back(corners);
  };
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
      add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  return mesh;
}

double total_area(const Mesh& mesh) {
  const Triangles triangles = triangulate(mesh).triangles;
  double area = 0;
  for (const auto& t : triangles.rowwise()) {
    const Eigen::RowVector3d a = mesh.positions.row(t[0]);
    area += (mesh.positions.row(t[1]) - a).cross(mesh.positions.row(t[2]) - a).norm() / 2;
  }
  return area;
}

// If the holes were filled as one loop, triangles would cross the faces at the common vertex.
TEST(RepairHoles, ThatTouchInAVertexAreClosedOneByOne) {
  using Vertices = std::set<std::array<Index, 2>>;
  const Vertices two{{4, 4}, {6, 6}}, three{{4, 4}, {6, 6}, {8, 8}};
  for (const HoleFill fill : {HoleFill::plain, HoleFill::refined, HoleFill::faired})
    for (const Vertices& holes : {two, three}) {
      const Mesh mesh = grid_without(12, holes);
      const RepairResult result = repair(mesh, {.hole_edges = 20, .hole_fill = fill});
      const TopologySummary topology = summarise_topology(result.mesh);
      EXPECT_TRUE(topology.manifold && topology.oriented);
      EXPECT_EQ(topology.boundary_loops, 1);
      EXPECT_NEAR(total_area(result.mesh), 1, 1e-9);
      EXPECT_EQ(check_mesh(result.mesh).find(FindingKind::duplicate_vertex), nullptr);
      EXPECT_TRUE(result.notes.empty());
      ASSERT_NE(result.find(RepairChangeKind::rejoined_vertex), nullptr);
      EXPECT_EQ(result.find(RepairChangeKind::rejoined_vertex)->count, static_cast<Index>(holes.size()) - 1);
      EXPECT_FALSE(repair(result.mesh, {.hole_edges = 20, .hole_fill = fill}).changed());
    }
}

// Returns a sheet with a hole, and a needle that stands in the hole if `through`, and beside the sheet if not.
Mesh sheet_and_needle(bool through) {
  const Mesh sheet = grid_without(12, {{5, 5}, {6, 5}, {5, 6}, {6, 6}});
  const Index n = sheet.vertex_count();
  const double x = through ? 0.51 : 2;
  Points positions(n + 4, 3);
  positions << sheet.positions, x, 0.52, -1, x + 0.01, 0.52, 1, x, 0.53, 1, x - 0.01, 0.52, 1;
  Mesh both;
  both.positions = positions;
  both.faces = sheet.faces;
  for (const auto& [a, b, c] : {std::array<Index, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}})
    both.faces.push_back(std::array{n + a, n + b, n + c});
  return both;
}

TEST(RepairHoles, AreNotedWhereTheirFillsIntersect) {
  for (const HoleFill fill : {HoleFill::plain, HoleFill::refined, HoleFill::faired}) {
    const RepairOptions options{.remove_debris = false, .hole_edges = 20, .hole_fill = fill};
    const Mesh mesh = sheet_and_needle(true);
    const RepairResult result = repair(mesh, options);
    ASSERT_EQ(result.notes.size(), 1);
    EXPECT_EQ(result.notes[0].id(), "mesh.hole_fill_intersects");
    const auto first = result.notes[0].get<std::int64_t>("first");
    EXPECT_TRUE(first >= mesh.face_count() && first < result.mesh.face_count()) << first;
    EXPECT_LE(result.notes[0].get<std::int64_t>("count"), 6);
    const RepairResult beside = repair(sheet_and_needle(false), options);
    EXPECT_NE(beside.find(RepairChangeKind::filled_hole), nullptr);
    EXPECT_TRUE(beside.notes.empty());
  }
}

// A harmonic function with linear values around a flat hole is that linear function.
TEST(RepairHoles, TakeLinearAttributesAsTheyRunAround) {
  std::set<std::array<Index, 2>> hole;
  for (Index j = 8; j <= 16; ++j)
    for (Index i = 8; i <= 16; ++i) hole.insert({i, j});
  for (const HoleFill fill : {HoleFill::refined, HoleFill::faired}) {
    const RepairResult result = repair(grid_without(24, hole), {.hole_edges = 60, .hole_fill = fill});
    const Attribute* uv = result.mesh.find_attribute(Domain::vertex, "uv");
    ASSERT_NE(uv, nullptr);
    EXPECT_GT(result.mesh.vertex_count(), 25 * 25 - 81 + 20);
    for (Index v = 0; v < result.mesh.vertex_count(); ++v)
      for (Index k = 0; k < 2; ++k)
        EXPECT_NEAR(uv->values[static_cast<std::size_t>(2 * v + k)], result.mesh.positions(v, k), 1e-6) << v;
  }
}

TEST(RepairHoles, AreClosedInAnyUnit) {
  const Mesh sheet = grid_without(12, {{4, 4}, {8, 7}});
  const RepairResult expected = repair(sheet, {.hole_edges = 20});
  for (const double unit : {1e-140, 1e-80, 1e80, 1e140}) {
    Mesh scaled = sheet;
    scaled.positions *= unit;
    const RepairResult result = repair(scaled, {.hole_edges = 20});
    EXPECT_EQ(result.mesh.face_count(), expected.mesh.face_count()) << unit;
    EXPECT_EQ(result.changes.size(), expected.changes.size()) << unit;
  }
}

}  // namespace
}  // namespace meshgraft
