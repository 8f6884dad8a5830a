#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/script/run_edit.h>

#include "io/temporary_folder.h"
#include "script/facts.h"
#include "support/defects.h"
#include "support/mesh_families.h"
#include "support/paths.h"

namespace meshgraft {
namespace {

using Json = nlohmann::ordered_json;

// Has a bumpy ball with turned faces, loose vertices and a small hole in a file.
class RepairStepTest : public testing::Test {
 protected:
  void SetUp() override {
    const test::TestMesh ball = test::bumpy_sphere(3);
    damaged_ = test::without_faces(make_mesh(ball.positions, ball.triangles), 1, 0, 7);
    damaged_ = test::with_isolated(test::with_turned_patches(damaged_, 2, 1, 3), 5, 5);
    write_mesh(damaged_, folder_ / "ball.ply");
  }
  EditFile edit(const std::string& steps) const {
    return parse_edit(R"({"format": "meshgraft-edit", "version": 2, "inputs": {"ball": {"file": "ball.ply"}},
                          "steps": [)" +
                          steps + "]}",
                      "edit.json", folder_.path());
  }
  Mesh given() const { return read_mesh(folder_ / "ball.ply"); }

  const test::TemporaryFolder folder_;
  Mesh damaged_;
};

void expect_same(const Mesh& one, const Mesh& other) {
  EXPECT_EQ(one.positions, other.positions);
  EXPECT_EQ(one.faces, other.faces);
}

TEST_F(RepairStepTest, DoesWhatRepairDoes) {
  const EditResult result = run_edit(edit(R"({"kind": "repair", "mesh": "ball"})"));
  const RepairResult expected = repair(given());
  expect_same(result.mesh, expected.mesh);
  const StepReport& step = result.report.steps.front();
  ASSERT_TRUE(step.repair);
  EXPECT_FALSE(step.is_deform());
  EXPECT_FALSE(result.report.deformed);
  EXPECT_EQ(step.repair->map.new_index, expected.vertex.new_index);
  ASSERT_EQ(step.repair->changes.size(), expected.changes.size());
  EXPECT_GE(expected.changes.size(), 3u);
  for (std::size_t k = 0; k < expected.changes.size(); ++k)
    EXPECT_EQ(step.repair->changes[k].note.text(), expected.changes[k].note.text());
}

TEST_F(RepairStepTest, TakesTheOptionsOfRepair) {
  const EditResult result = run_edit(edit(
      R"({"kind": "repair", "mesh": "ball", "unify_winding": false, "hole_edges": 0, "remove_isolated": false})"));
  EXPECT_TRUE(result.report.steps.front().repair->changes.empty());
  expect_same(result.mesh, given());
  const EditResult holes = run_edit(
      edit(R"({"kind": "repair", "mesh": "ball", "hole_edges": 30, "hole_fill": "faired", "weld": false})"));
  expect_same(holes.mesh,
              repair(given(), {.weld = false, .hole_edges = 30, .hole_fill = HoleFill::faired}).mesh);
}

TEST_F(RepairStepTest, IsReported) {
  const EditResult result =
      run_edit(edit(R"({"kind": "repair", "name": "mend", "mesh": "ball", "result": "whole"})"));
  const Json report = Json::parse(write_report(result.report));
  EXPECT_TRUE(report["quality"].is_null());
  const Json& step = report["steps"][0];
  EXPECT_EQ(step["kind"], "repair");
  EXPECT_EQ(step["name"], "mend");
  EXPECT_EQ(step["mesh"], "ball");
  EXPECT_EQ(step["result"], "whole");
  EXPECT_EQ(step["settings"]["hole_edges"], "auto");
  EXPECT_EQ(step["counts"]["vertices"], result.mesh.vertex_count());
  EXPECT_EQ(step["map"].size(), static_cast<std::size_t>(damaged_.vertex_count()));
  const auto isolated = std::ranges::find_if(
      step["changes"], [](const Json& change) { return change["name"] == "removed-isolated-vertex"; });
  ASSERT_NE(isolated, step["changes"].end());
  EXPECT_EQ((*isolated)["count"], 5);
}

// A deformation works on the repaired mesh, and the selections of a cut follow the vertices.
TEST_F(RepairStepTest, GoesBetweenOtherSteps) {
  const EditResult result = run_edit(edit(R"(
    {"kind": "cut", "name": "open", "mesh": "ball", "plane": {"point": [0, 0, 0.3], "normal": [0, 0, 1]},
     "keep": "below"},
    {"kind": "repair", "mesh": "ball"},
    {"kind": "deform", "mesh": "ball", "handles": [
      {"name": "rim", "select": {"produced": {"step": "open", "what": "loop"}}, "pose": {"translate": [0, 0, 1]}},
      {"name": "bottom", "select": {"half_space": {"point": [0, 0, -0.8], "normal": [0, 0, -1]}}}]})"));
  EXPECT_TRUE(result.report.deformed);
  EXPECT_GT(result.report.max_displacement, 0.99);
  EXPECT_EQ(result.rest.rows(), result.mesh.positions.rows());
  EXPECT_FALSE(check_mesh(result.mesh).has_defects());
}

TEST_F(RepairStepTest, LeavesTheMeshOfAnotherNameAlone) {
  EditFile both = edit(R"({"kind": "repair", "mesh": "ball", "result": "whole"})");
  both.output = "ball";
  expect_same(run_edit(both).mesh, given());
}

TEST_F(RepairStepTest, IsRefusedWhereNoFaceWouldBeLeft) {
  write_mesh(make_mesh(Points::Zero(3, 3), (Triangles(1, 3) << 0, 1, 2).finished()), folder_ / "ball.ply");
  try {
    run_edit(edit(R"({"kind": "repair", "mesh": "ball"})"));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), facts::script::NoFacesLeft::id);
    EXPECT_EQ(error.location().text(), "edit.json: steps[0]");
  }
}

TEST_F(RepairStepTest, ReadsBackWhatItWrites) {
  const EditFile all = read_edit_file(test::source_path("tests/script/accepted/repair.json"));
  const std::string written = write_edit(all);
  EXPECT_EQ(write_edit(parse_edit(written, "edit.json")), written);
  const auto& step = std::get<RepairStep>(all.steps.at(1).action);
  EXPECT_EQ(outcome_of(all.steps[1]), "closed");
  EXPECT_FALSE(step.options.remove_invalid || step.options.clean_faces || step.options.remove_debris);
  EXPECT_EQ(step.options.weld_distance, 0.01);
  EXPECT_EQ(step.options.hole_edges, 60);
  EXPECT_EQ(step.options.hole_fill, HoleFill::faired);
  EXPECT_FALSE(std::get<RepairStep>(all.steps.at(2).action).options.hole_edges);
}

}  // namespace
}  // namespace meshgraft
