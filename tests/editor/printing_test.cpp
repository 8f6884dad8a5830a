// Tests the check before printing and the steps that give a model its size and place, as a page asks for them.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/run_edit.h>

#include "bar_editing.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

constexpr std::uint32_t print_marks = 9;

class PrintingEditor : public testing::Test {
 protected:
  TemporaryFolder folder_;
  RunningEditor editor_{{folder_.path()}};
  Page page_{editor_.url()};

  Json state() { return page_.ask({{"do", "state"}}); }
  void open(const Mesh& mesh) {
    write_mesh(mesh, folder_ / "model.ply");
    page_.ask({{"do", "open"}, {"path", (folder_ / "model.ply").string()}});
  }
  Json check(Json options = Json::object()) {
    options["do"] = "print-check";
    return page_.ask(options)["print"];
  }
  Mesh replayed() {
    page_.ask({{"do", "save"}, {"edit", "edit.json"}, {"mesh", "saved.ply"}, {"overwrite", true}});
    Mesh mesh = run_edit(read_edit_file(folder_ / "edit.json")).mesh;
    write_mesh(mesh, folder_ / "replayed.ply");
    EXPECT_EQ(read_file(folder_ / "saved.ply"), read_file(folder_ / "replayed.ply"));
    return mesh;
  }
};

TEST_F(PrintingEditor, ChecksTheMeshAsItIsEdited) {
  page_.ask(open_bar);
  const Json before = check();
  EXPECT_GT(before["volume"], 0);
  EXPECT_EQ(before["open_edges"], 0);
  EXPECT_EQ(before["intersections"], 0);
  const Mesh bar = make_sample("bar", 20);
  EXPECT_NEAR(before["size"][2].get<double>(),
              bar.positions.col(2).maxCoeff() - bar.positions.col(2).minCoeff(), 1e-9);
  paint_top(page_);
  page_.exact(page_.ask({{"do", "pose"}, {"poses", {{"top", {{"translate", {0, 0, 1}}}}}}})["pose"]);
  EXPECT_NEAR(check()["size"][2].get<double>(), before["size"][2].get<double>() + 1, 1e-6);
}

TEST_F(PrintingEditor, MarksWhatItFound) {
  open(without_faces(make_sample("bar", 20), 1, 0, 3));
  EXPECT_EQ(page_.refusal({{"do", "mark"}, {"print", "overhangs"}})["id"], "editor.no_print_check");
  const Json found = check({{"up", {1, 0.3, 0}}, {"overhang_deg", 30}, {"least_wall", 5}});
  EXPECT_EQ(found["holes"], 1);
  EXPECT_TRUE(found["volume"].is_null());
  EXPECT_EQ(page_.ask({{"do", "mark"}, {"print", "open-edges"}})["marked"], found["open_edges"]);
  EXPECT_EQ(page_.frame(print_marks).numbers.at("lines").size(), 6 * found["open_edges"].get<std::size_t>());
  for (const auto& [finding, count] :
       {std::pair("thin-walls", "thin"), std::pair("overhangs", "overhanging")}) {
    EXPECT_GT(found[count], 0);
    EXPECT_EQ(page_.ask({{"do", "mark"}, {"print", finding}})["marked"], found[count]);
    EXPECT_EQ(page_.frame(print_marks).numbers.at("triangles").size(), 9 * found[count].get<std::size_t>());
  }
  EXPECT_EQ(page_.ask({{"do", "mark"}, {"print", "intersections"}})["marked"], 0);
  EXPECT_EQ(page_.refusal({{"do", "mark"}, {"print", "cracks"}})["code"], "input");
  EXPECT_EQ(page_.refusal({{"do", "mark"}})["code"], "input");
}

TEST_F(PrintingEditor, ClosesAllHolesAsAStep) {
  open(without_faces(make_sample("bar", 20), 2, 1, 3));
  const int holes = check()["holes"];
  EXPECT_GT(holes, 0);
  const Json notes = page_.ask({{"do", "repair"}, {"holes", true}})["notes"];
  EXPECT_EQ(notes[0]["id"], "mesh.filled_hole");
  EXPECT_EQ(notes[0]["fields"]["count"], holes);
  EXPECT_EQ(check()["open_edges"], 0);
  EXPECT_FALSE(check()["volume"].is_null());
  EXPECT_EQ(page_.refusal({{"do", "repair"}, {"holes", true}})["id"], "editor.nothing_to_repair");
  replayed();
}

/// The border of a sheet is open, but there is nothing to close.
TEST_F(PrintingEditor, KeepsNoStepThatClosesNothing) {
  TestMesh ball = bumpy_sphere(2);
  const Eigen::Index count = ball.positions.rows(), faces = ball.triangles.rows();
  ball.positions.conservativeResize(count + 3, 3);
  ball.positions.bottomRows(3) << 5, 0, 0, 6, 0, 0, 5, 1, 0;
  ball.triangles.conservativeResize(faces + 1, 3);
  ball.triangles.row(faces) << static_cast<Index>(count), static_cast<Index>(count + 1),
      static_cast<Index>(count + 2);
  open(make_mesh(ball.positions, ball.triangles));
  const Json before = state();
  EXPECT_EQ(check()["open_edges"], 3);
  EXPECT_TRUE(page_.ask({{"do", "repair"}, {"holes", true}})["notes"].empty());
  EXPECT_EQ(state()["steps"], before["steps"]);
  EXPECT_EQ(state()["undo"], before["undo"]);
}

TEST_F(PrintingEditor, ScalesAndTurnsAsSteps) {
  page_.ask(open_bar);
  const Json before = check();
  page_.ask({{"do", "transform"}, {"pose", {{"scale", 10}, {"pivot", {0, 0, 0}}}}});
  EXPECT_NEAR(check()["volume"].get<double>(), 1000 * before["volume"].get<double>(), 1e-6);
  page_.ask({{"do", "transform"}, {"pose", {{"rotate", {{"axis", {1, 0, 0}}, {"angle_deg", 90}}}}}});
  const Json turned = check();
  EXPECT_NEAR(turned["size"][1].get<double>(), 10 * before["size"][2].get<double>(), 1e-6);
  const Json steps = state()["steps"];
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[0]["kind"], "transform");
  replayed();
  page_.ask({{"do", "step"}, {"what", "change"}, {"index", 0}, {"fields", {{"pose", {{"scale", 1}}}}}});
  EXPECT_NEAR(check()["volume"].get<double>(), before["volume"].get<double>(), 1e-9);
  page_.ask({{"do", "undo"}});
  page_.ask({{"do", "undo"}});
  EXPECT_EQ(state()["steps"].size(), 2u);
  EXPECT_EQ(page_.refusal({{"do", "transform"}, {"pose", {{"scale", 0}}}})["id"], "script.pose_flattens");
  EXPECT_EQ(page_.refusal({{"do", "transform"}, {"pose", {{"def", "a.def"}}}})["code"], "input");
}

TEST_F(PrintingEditor, ShapesTheSelectionAsSteps) {
  page_.ask(open_bar);
  EXPECT_EQ(page_.refusal({{"do", "sculpt"}, {"action", "smooth"}})["id"], "editor.nothing_selected");
  page_.ask({{"do", "select"},
             {"how", "set"},
             {"what", {{"half_space", {{"point", {0, 0, 3}}, {"normal", {0, 0, 1}}}}}}});
  const double volume = check()["volume"];
  page_.ask({{"do", "sculpt"}, {"action", "inflate"}, {"height", 0.3}});
  EXPECT_GT(check()["volume"], volume);
  page_.ask({{"do", "sculpt"}, {"action", "smooth"}, {"strength", 0.3}});
  page_.ask({{"do", "sculpt"}, {"action", "flatten"}, {"strength", 0.3}});
  const Json steps = state()["steps"];
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_EQ(steps[1]["kind"], "sculpt");
  EXPECT_EQ(steps[1]["fields"]["action"], "smooth");
  EXPECT_EQ(page_.refusal({{"do", "sculpt"}, {"action", "inflate"}})["code"], "input");
  replayed();
}

}  // namespace
}  // namespace meshgraft::test
