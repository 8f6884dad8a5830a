// Sparse handles and targets are refined by themselves: the surface bends less sharply there.
#include "script/refine_boundary.h"

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>
#include <meshgraft/script/run_edit.h>

#include "io/temporary_folder.h"
#include "mesh/refine.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using Json = nlohmann::ordered_json;

const Json lift_pose = {{"translate", {0, 0, 0.15}}};
const Json turn_pose = {{"translate", {0, 0, 0.1}}, {"rotate", {{"axis", {1, 0, 0}}, {"angle_deg", 30}}}};

struct Sheet {
  std::string name;
  Mesh mesh;
  std::vector<double> centre;  ///< of the region
  double radius = 0;
  double most_bend_deg = 0;  ///< around a refined tip
};

// Returns a square sheet of side × side vertices, numbered by rows.
Sheet sheet_of(int side) {
  return {"sheet " + std::to_string(side), make_sample("bumpy_plane", side), {0, 0, 0}, 0.4};
}

std::vector<Sheet> sheets() {
  std::vector<Sheet> sheets{sheet_of(40), sheet_of(80), sheet_of(120)};
  const test::TestMesh sphere = test::icosphere(4);
  sheets.push_back({"sphere", make_mesh(0.5 * sphere.positions, sphere.triangles), {0, 0, 0.5}, 0.5});
  constexpr double most_bend_deg[] = {15.5, 11, 11, 13.5};
  for (std::size_t s = 0; s < sheets.size(); ++s) sheets[s].most_bend_deg = most_bend_deg[s];
  return sheets;
}

// Returns a deform step on the mesh "sheet". Its region is a ball, and its handle the selection `select`.
Json step_of(const Sheet& sheet, const Json& select, const Json& pose, const Json& settings) {
  return {{"kind", "deform"},
          {"mesh", "sheet"},
          {"region", {{"sphere", {{"centre", sheet.centre}, {"radius", sheet.radius}}}}},
          {"handles", Json::array({{{"name", "tip"}, {"select", select}, {"pose", pose}}})},
          {"settings", settings}};
}

EditResult run(const Sheet& sheet, const Json& step, const RunOptions& options = {}) {
  const test::TemporaryFolder folder;
  write_mesh(sheet.mesh, folder / "sheet.ply");
  const Json edit = {{"format", "meshgraft-edit"},
                     {"version", 2},
                     {"inputs", {{"sheet", {{"file", "sheet.ply"}}}}},
                     {"steps", Json::array({step})}};
  return run_edit(parse_edit(edit.dump(), "edit.json", folder.path()), options);
}

Json nearest(const Sheet& sheet) { return {{"nearest", sheet.centre}}; }

Index added(const EditResult& result) { return result.report.steps.front().refined_vertices; }

// Without refinement, fewer vertices follow the turn of a single vertex, so that it may bend the surface less.
TEST(SparseHandles, BendTheSurfaceLess) {
  for (const Sheet& sheet : sheets())
    for (const Json& pose : {lift_pose, turn_pose}) {
      const EditResult plain = run(sheet, step_of(sheet, nearest(sheet), pose, {{"refine_boundary", 0}}));
      const EditResult refined = run(sheet, step_of(sheet, nearest(sheet), pose, Json::object()));
      const double bend = refined.report.quality.dihedral_max_deg;
      EXPECT_LT(bend, sheet.most_bend_deg) << sheet.name << " " << pose;
      if (pose == lift_pose) {
        EXPECT_LT(bend, plain.report.quality.dihedral_max_deg) << sheet.name;
      }
      EXPECT_EQ(added(plain), 0);
      EXPECT_GT(added(refined), 0);
      EXPECT_EQ(refined.mesh.positions.rows(), sheet.mesh.positions.rows());
      EXPECT_EQ(refined.report.counts.free, plain.report.counts.free);
      for (Index v = 0; v < sheet.mesh.vertex_count(); ++v)
        if (plain.mesh.positions.row(v) == plain.rest.row(v)) {
          EXPECT_EQ(refined.mesh.positions.row(v), refined.rest.row(v)) << sheet.name << " " << v;
        }
    }
}

TEST(RefineBoundary, GivesWhatSplittingTheWholeMeshGives) {
  const Mesh mesh = sheet_of(30).mesh;
  const Index tip = 15 * 30 + 15;
  ResolvedProblem problem{mesh.positions, triangulate(mesh).triangles, {}};
  problem.deform.region.whole = true;
  problem.deform.region.handles = {{.name = "tip", .vertices = {tip}}};
  problem.deform.poses.resize(1);
  const IndexLists rings = vertex_rings(mesh.vertex_count(), problem.triangles);
  const RefineResult split = split_edges_within(mesh, grow_rings(std::vector{tip}, 2, rings));
  for (const std::optional<int> levels : {1, 2}) {
    const ResolvedProblem refined = refine_boundary(problem, levels, {});
    EXPECT_EQ(refined.rest.topRows(split.mesh.vertex_count()), split.mesh.positions);
    EXPECT_EQ(refined.rest.rows() == split.mesh.vertex_count(), levels == 1);
    if (levels == 1) {
      EXPECT_EQ(refined.triangles, triangulate(split.mesh).triangles);
    }
  }
}

// Expects the automatic refinement to change nothing, to the bit.
void expect_plain(const Sheet& sheet, Json step) {
  step["settings"] = {{"refine_boundary", "auto"}};
  const EditResult automatic = run(sheet, step);
  step["settings"] = {{"refine_boundary", 0}};
  const EditResult plain = run(sheet, step);
  EXPECT_EQ(added(automatic), 0);
  EXPECT_EQ(automatic.mesh.positions, plain.mesh.positions);
}

TEST(SparseHandles, AreNotThoseWithAnInterior) {
  const Json ball = {{"sphere", {{"centre", {0, 0, 0}}, {"radius", 0.1}}}};
  expect_plain(sheet_of(30), step_of(sheet_of(30), ball, turn_pose, {}));
}

TEST(SparseHandles, AreRefinedPieceByPiece) {
  const Sheet sheet = sheet_of(60);
  const Json ball = {{"sphere", {{"centre", {0, 0, 0}}, {"radius", 0.1}}}}, stray = {{"nearest", {0.25, 0, 0}}};
  const Index one = added(run(sheet, step_of(sheet, stray, lift_pose, Json::object())));
  EXPECT_GT(one, 0);
  EXPECT_EQ(added(run(sheet, step_of(sheet, {{"union", {ball, stray}}}, lift_pose, Json::object()))), one);
}

TEST(SparseHandles, MayBeRings) {
  const Sheet sheet = sheet_of(120);
  const Json ball = {{"sphere", {{"centre", {0, 0, 0}}, {"radius", 0.04}}}};
  const Json ring = {{"rim", {{"of", ball}, {"rings", 1}}}};
  const EditResult refined = run(sheet, step_of(sheet, ring, lift_pose, Json::object()));
  const EditResult plain = run(sheet, step_of(sheet, ring, lift_pose, {{"refine_boundary", 0}}));
  EXPECT_GT(added(refined), 0);
  EXPECT_LT(refined.report.quality.dihedral_max_deg, 0.8 * plain.report.quality.dihedral_max_deg);
}

TEST(SparseHandles, MayBeTargets) {
  const Sheet sheet = sheet_of(60);
  const Index tip = 30 * 60 + 30;
  const Eigen::RowVector3d at = sheet.mesh.positions.row(tip) + Eigen::RowVector3d(0, 0, 0.15);
  Json step = step_of(sheet, nearest(sheet), lift_pose, Json::object());
  step.erase("handles");
  step["targets"] = Json::array({{{"vertex", tip}, {"position", {at.x(), at.y(), at.z()}}}});
  const EditResult refined = run(sheet, step);
  step["settings"] = {{"refine_boundary", 0}};
  const EditResult plain = run(sheet, step);
  EXPECT_EQ(refined.mesh.positions.row(tip), at);
  EXPECT_LT(refined.report.quality.dihedral_max_deg, 0.7 * plain.report.quality.dihedral_max_deg);
}

TEST(SparseHandles, AreNotRefinedIfTheyAreMany) {
  const Sheet sheet = sheet_of(30);
  std::vector<Index> every;
  for (Index y = 7; y < 23; y += 3)
    for (Index x = 7; x < 23; x += 3) every.push_back(30 * y + x);
  expect_plain(sheet, step_of(sheet, {{"indices", every}}, lift_pose, {}));
  every.resize(8);
  EXPECT_GT(added(run(sheet, step_of(sheet, {{"indices", every}}, lift_pose, Json::object()))), 0);
}

TEST(SparseHandles, AreRefinedBesideLargerOnes) {
  // An open rim is sparse, too, but has too many vertices.
  const Sheet sheet = sheet_of(40);
  std::vector<Index> rim;
  for (Index v = 0; v < 1600; ++v)
    if (v % 40 == 0 || v % 40 == 39 || v < 40 || v >= 1560) rim.push_back(v);
  Json step = step_of(sheet, nearest(sheet), lift_pose, Json::object());
  step.erase("region");
  step["fixed"] = {{"indices", rim}};
  const Index alone = added(run(sheet, step));
  EXPECT_GT(alone, 0);
  step.erase("fixed");
  step["handles"].push_back({{"name", "rim"}, {"select", {{"indices", rim}}}});
  EXPECT_EQ(added(run(sheet, step)), alone);
}

// Numbers of vertices in an error are those of the refined mesh, and its note says which were added.
TEST(RefineBoundary, ErrorsSayThatVerticesWereAdded) {
  const Sheet sheet = sheet_of(30);
  Json step = step_of(sheet, nearest(sheet), lift_pose, {{"refine_boundary", 1}});
  step["region"] = "all";
  step["fixed"] = {{"indices", Json::array()}};
  step["handles"][0]["constrain"] = "transform";
  const auto error_of = [&](int levels) {
    step["settings"]["refine_boundary"] = levels;
    try {
      run(sheet, step);
    } catch (const Error& error) {
      return std::optional(error);
    }
    return std::optional<Error>();
  };
  const std::optional<Error> plain = error_of(0), refined = error_of(1);
  ASSERT_TRUE(plain && refined);
  EXPECT_EQ(plain->id(), "deform.component_not_held");
  EXPECT_EQ(refined->id(), plain->id());
  EXPECT_TRUE(plain->notes().empty());
  ASSERT_EQ(refined->notes().size(), 1u);
  EXPECT_EQ(refined->notes()[0].id(), "script.refined_for_solve");
  EXPECT_NE(refined->notes()[0].text().find("numbered from 900 on"), std::string::npos)
      << refined->notes()[0].text();
}

TEST(SparseHandles, AreNotCurves) {
  const Sheet sheet = sheet_of(30);
  const Json path = {{"path", {{"points", {{-0.1, 0, 0}, {0.1, 0, 0}}}}}};
  Json step = step_of(sheet, path, turn_pose, {});
  step["handles"][0]["shape"] = "curve";
  expect_plain(sheet, step);
}

TEST(SparseHandles, LeaveACurveBesideThemAsItIsRedrawn) {
  const Sheet sheet = sheet_of(30);
  const Json tip = step_of(sheet, nearest(sheet), lift_pose, Json::object());
  Json both = tip;
  std::vector<Index> course;
  Json redrawn = Json::array();
  for (Index x = 12; x < 18; ++x) {
    course.push_back(30 * 17 + x);
    const Eigen::RowVector3d p = sheet.mesh.positions.row(course.back());
    redrawn.push_back({p.x(), p.y(), p.z() + 0.05});
  }
  both["handles"].push_back({{"name", "curve"},
                             {"shape", "curve"},
                             {"select", {{"indices", course}}},
                             {"pose", {{"curve", redrawn}}}});
  const EditResult result = run(sheet, both);
  EXPECT_GT(added(result), 0);
  EXPECT_LT(added(result), added(run(sheet, tip))) << "edges of the curve are not halved";
  for (std::size_t i = 0; i < course.size(); ++i)
    EXPECT_NEAR(result.mesh.positions(course[i], 2), redrawn[i][2].get<double>(), 1e-12);
}

TEST(SparseHandles, AreNotRefinedByPublishedMethodsAndProxies) {
  const Sheet sheet = sheet_of(60);
  const Json step = step_of(sheet, nearest(sheet), lift_pose, Json::object());
  EXPECT_EQ(added(run(sheet, step, {.overrides = {.method = method_named("arap-2007")}})), 0);
  EXPECT_EQ(added(run(sheet, step, {.overrides = {.proxy = 200}})), 0);
  EXPECT_GT(added(run(sheet, step, {.overrides = {.method = method_named("rotation-aware")}})), 0);
}

}  // namespace
}  // namespace meshgraft
