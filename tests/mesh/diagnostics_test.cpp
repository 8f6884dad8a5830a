#include <meshgraft/mesh/diagnostics.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "mesh/shapes.h"
#include "mesh/winding.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using Indices = std::vector<Index>;

void expect_finding(const Mesh& mesh, FindingKind kind, Severity severity, Index count, Domain domain,
                    const Indices& indices) {
  SCOPED_TRACE(name_of(kind));
  const Diagnostics report = check_mesh(mesh);
  const Finding* finding = report.find(kind);
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->severity, severity);
  EXPECT_EQ(finding->count, count);
  EXPECT_EQ(finding->domain, domain);
  EXPECT_EQ(finding->indices, indices);
  EXPECT_TRUE(finding->description().starts_with(std::to_string(count) + " ")) << finding->description();
  std::string id = fmt::format("mesh.{}", name_of(kind));
  std::ranges::replace(id, '-', '_');
  EXPECT_EQ(finding->note.id(), id);
}

TEST(CheckMesh, FindsNothingInGoodTriangles) {
  for (const Mesh& mesh :
       {Mesh{}, shapes::torus(7, 5, true), shapes::grid(3, 3, true), shapes::tube(5, 2, true)}) {
    EXPECT_TRUE(check_mesh(mesh).clean());
  }
}

// A vertex without faces is a finding; a repeated position of such vertices is no further one.
TEST(CheckMesh, FindsNothingInCleanFamilies) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    for (const Finding& finding : check_mesh(make_mesh(family.positions, family.triangles)).findings)
      EXPECT_EQ(finding.kind, FindingKind::isolated_vertex) << finding.description();
  }
}

TEST(CheckMesh, FindsWhatWasInjectedAndNothingElse) {
  for (const test::TestMesh& family : test::mesh_families()) {
    const Mesh clean = make_mesh(family.positions, family.triangles);
    const Diagnostics before = check_mesh(clean);
    for (const FindingKind kind : test::defect_kinds()) {
      SCOPED_TRACE(fmt::format("{} {}", family.name, name_of(kind)));
      const test::Defective defective = test::inject(clean, kind);
      if (defective.count == 0) continue;  // an open mesh has no inside
      const Diagnostics report = check_mesh(defective.mesh);
      const Finding* finding = report.find(kind);
      ASSERT_NE(finding, nullptr);
      EXPECT_EQ(finding->domain, defective.domain);
      if (kind == FindingKind::isolated_vertex && before.find(kind)) {
        EXPECT_EQ(finding->count, before.find(kind)->count + 1);
        EXPECT_EQ(finding->indices.back(), defective.indices.back());
        continue;
      }
      EXPECT_EQ(finding->count, defective.count);
      EXPECT_EQ(finding->indices, defective.indices);
      for (const Finding& other : report.findings) {
        // A duplicate face also makes its edges non-manifold or inconsistently wound.
        if (kind == FindingKind::duplicate_face &&
            (other.kind == FindingKind::non_manifold_edge || other.kind == FindingKind::inconsistent_winding))
          continue;
        EXPECT_TRUE(other.kind == kind || before.find(other.kind))
            << name_of(other.kind) << ": " << other.description();
      }
    }
  }
}

TEST(CheckMesh, TellsSeamsFromTouchingParts) {
  // `seam` is a grid whose right half has vertices of its own; the parts of `point` share a single position.
  const Mesh seam =
      shapes::polygons({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}},
                       {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}});
  expect_finding(seam, FindingKind::duplicate_vertex, Severity::worked_around, 4, Domain::vertex, {1, 2, 4, 6});
  const Mesh point = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-1, 0, 0}, {0, -1, 0}},
                                      {{0, 1, 2}, {3, 4, 5}});
  EXPECT_FALSE(check_mesh(point).has_defects());
  EXPECT_FALSE(check_mesh(shapes::together({shapes::cube(), shapes::cube()})).has_defects()) << "closed parts";
}

TEST(CheckMesh, KnowsCavitiesFromPartsInsideOut) {
  const auto cube = [](double size, bool inward) {
    Mesh mesh = inward ? turned_over(shapes::cube()) : shapes::cube();
    mesh.positions = ((mesh.positions.array() - 0.5) * size).matrix();
    return mesh;
  };
  EXPECT_FALSE(check_mesh(shapes::together({cube(3, false), cube(1, true)})).has_defects()) << "a hollow cube";
  expect_finding(shapes::together({cube(3, true), cube(1, false)}), FindingKind::inward_facing_component,
                 Severity::info, 1, Domain::vertex, {0});
  EXPECT_FALSE(check_mesh(turned_over(shapes::tube(6, 2))).has_defects()) << "open surfaces have no inside";
}

TEST(CheckMesh, NamesEachDefect) {
  Mesh non_finite = shapes::cube();
  non_finite.positions(3, 1) = std::nan("");
  non_finite.positions(5, 0) = INFINITY;
  expect_finding(non_finite, FindingKind::non_finite, Severity::refused, 2, Domain::vertex, {3, 5});

  Mesh out_of_range = shapes::cube();
  out_of_range.faces.push_back(Indices{0, 1, 8});
  out_of_range.faces.push_back(Indices{0, -1, 2});
  expect_finding(out_of_range, FindingKind::index_out_of_range, Severity::refused, 2, Domain::face, {6, 7});

  Mesh degenerate = shapes::cube();
  degenerate.faces.push_back(Indices{0, 1});
  degenerate.faces.push_back(Indices{2, 2, 3});
  degenerate.faces.push_back(Indices{0, 1, 0, 4});
  degenerate.faces.push_back({});
  expect_finding(degenerate, FindingKind::degenerate_face, Severity::worked_around, 4, Domain::face,
                 {6, 7, 8, 9});

  const Mesh no_area = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  expect_finding(no_area, FindingKind::zero_area_face, Severity::worked_around, 1, Domain::face, {0});

  Mesh isolated = shapes::cube();
  shapes::add_vertex(isolated, {0, 0, 7});
  expect_finding(isolated, FindingKind::isolated_vertex, Severity::worked_around, 1, Domain::vertex, {8});

  expect_finding(shapes::three_on_an_edge(), FindingKind::non_manifold_edge, Severity::info, 1, Domain::vertex,
                 {0, 1});
  expect_finding(shapes::bow_tie(), FindingKind::non_manifold_vertex, Severity::info, 1, Domain::vertex, {2});
  expect_finding(shapes::cube(), FindingKind::polygon, Severity::info, 6, Domain::face, {0, 1, 2, 3, 4, 5});

  Mesh wound_against = shapes::grid(2, 1);
  wound_against.faces = {};
  wound_against.faces.push_back(Indices{0, 1, 4, 3});
  wound_against.faces.push_back(Indices{1, 4, 5, 2});
  expect_finding(wound_against, FindingKind::inconsistent_winding, Severity::info, 1, Domain::vertex, {1, 4});
}

TEST(CheckMesh, MeasuresAreaAgainstTheFaceAndThePrecision) {
  const auto sliver = [](double size, double height, double offset) {
    return shapes::polygons({{offset, 0, 0}, {offset + size, 0, 0}, {offset + size / 2, height, 0}},
                            {{0, 1, 2}});
  };
  // Triangles of tiny models and of thin CAD fans have area.
  EXPECT_TRUE(check_mesh(sliver(1e-9, 1e-9, 0)).clean());
  EXPECT_TRUE(check_mesh(sliver(1, 1e-6, 0)).clean());
  EXPECT_TRUE(check_mesh(sliver(1e6, 1, 1e9)).clean());
  // A triangle has no area if the coordinates cannot tell its height from zero.
  EXPECT_NE(check_mesh(sliver(1, 1e-14, 0)).find(FindingKind::zero_area_face), nullptr);
  EXPECT_NE(check_mesh(sliver(1e-3, 1e-7, 1e9)).find(FindingKind::zero_area_face), nullptr);
}

TEST(CheckMesh, PutsTheWorstFirst) {
  Mesh mesh = shapes::together({shapes::cube(), shapes::three_on_an_edge()});
  shapes::add_vertex(mesh, {0, 0, std::nan("")});
  mesh.faces.push_back(Indices{0, 1, 99});
  const Diagnostics report = check_mesh(mesh);
  ASSERT_GE(report.findings.size(), 4);
  for (std::size_t k = 1; k < report.findings.size(); ++k) {
    EXPECT_GE(static_cast<int>(report.findings[k - 1].severity), static_cast<int>(report.findings[k].severity));
  }
  EXPECT_EQ(report.find(FindingKind::duplicate_face), nullptr);
}

TEST(RequireUsable, RefusesOnlyWithinReach) {
  Mesh mesh = shapes::together({shapes::cube(), shapes::cube()});
  mesh.positions(3, 0) = std::nan("");
  mesh.faces.push_back(Indices{1, 2, 99});
  const Diagnostics report = check_mesh(mesh);
  EXPECT_NO_THROW(require_sound(report, mesh, {.vertices = Indices{8, 9, 15}, .name = "model.ply"}));
  try {
    require_sound(report, mesh, {.vertices = Indices{3, 9}, .name = "model.ply"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.location().text(), "model.ply");
    EXPECT_EQ(error.id(), "mesh.non_finite_within_reach");
    EXPECT_EQ(error.problem(),
              "1 vertex has a coordinate that is not a finite number (first within reach: vertex 3)");
    EXPECT_FALSE(error.remedy().empty());
  }
  try {
    require_sound(report, mesh, {.vertices = Indices{2}, .name = "model.ply"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "mesh.index_out_of_range_within_reach");
    EXPECT_EQ(error.fact().get<std::vector<std::int64_t>>("first"), std::vector<std::int64_t>{12});
  }
  EXPECT_THROW(require_sound(report, mesh, {.name = "model.ply"}), Error);
}

TEST(RequireUsable, AcceptsWhatIsWorkedAround) {
  Mesh mesh = shapes::together({shapes::three_on_an_edge(), shapes::bow_tie(), shapes::cube()});
  shapes::add_vertex(mesh, {1, 2, 3});
  mesh.faces.push_back(Indices{0, 0, 1});
  const Diagnostics report = check_mesh(mesh);
  EXPECT_FALSE(report.clean());
  EXPECT_NO_THROW(require_sound(report, mesh, {.name = "model.ply"}));
}

}  // namespace
}  // namespace meshgraft
