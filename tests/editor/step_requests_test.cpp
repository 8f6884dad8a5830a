// Tests a page's requests for symmetry and for changes of any step.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>
#include <meshgraft/script/run_edit.h>

#include "io/file.h"
#include "io/temporary_folder.h"
#include "page_client.h"

namespace meshgraft::test {
namespace {

const Json open_a_bar = {{"do", "open"}, {"sample", "bar"}, {"resolution", 20}};

Json lift(double by) { return {{"translate", {0, 0, by}}}; }

std::vector<int> near(Page& page, double x, double z) {
  return page.vertices([&](double vx, double, double vz) { return std::hypot(vx - x, vz - z) < 0.25; });
}

Json paint(Page& page, const std::vector<int>& vertices, const std::string& name, double reach = 0.8) {
  return page.ask({{"do", "paint-handle"}, {"vertices", vertices}, {"name", name}, {"reach", reach}});
}

Json pose(Page& page, const std::string& handle, const Json& where) {
  return page.ask({{"do", "pose"}, {"poses", {{handle, where}}}})["pose"];
}

Json state(Page& page) { return page.ask({{"do", "state"}}); }

std::vector<float> run(Page& page, const std::filesystem::path& file) {
  page.ask({{"do", "save"}, {"edit", file.string()}, {"overwrite", true}});
  const Points positions = run_edit(read_edit_file(file)).mesh.positions;
  std::vector<float> numbers;
  for (Eigen::Index v = 0; v < positions.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      numbers.push_back(static_cast<float>(positions(v, k) - page.offset()[static_cast<std::size_t>(k)]));
  return numbers;
}

/// Returns the largest distance of these vertices' mirror images across x = 0 from their nearest vertices.
double asymmetry(const std::vector<float>& shown, const std::vector<int>& vertices) {
  double largest = 0;
  for (const int v : vertices) {
    const auto a = static_cast<std::size_t>(3 * v);
    double nearest = 1e9;
    for (std::size_t b = 0; b < shown.size(); b += 3)
      nearest = std::min(nearest, std::hypot(std::hypot(shown[a] + shown[b], shown[a + 1] - shown[b + 1]),
                                             static_cast<double>(shown[a + 2] - shown[b + 2])));
    largest = std::max(largest, nearest);
  }
  return largest;
}

TEST(EditorSettings, NoteWordsOfTheFileThatAreReadAsOthers) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  write_file_atomically(folder / "bar.json", R"({"format": "meshgraft-edit", "version": 2,
      "inputs": {"bar": {"sample": "bar", "resolution": 12}},
      "steps": [{"kind": "deform", "mesh": "bar", "settings": {"backend": "cholmod"}}]})");
  page.ask({{"do", "open"}, {"path", (folder / "bar.json").string()}});
  const Json opened = state(page);
  EXPECT_EQ(opened["settings"]["backend"], "multifrontal");
  EXPECT_EQ(opened["dirty"], false);
  ASSERT_EQ(opened["notes"].size(), 1U);
  EXPECT_EQ(opened["notes"][0]["id"], "script.former_backend");
  EXPECT_EQ(opened["notes"][0]["fields"]["name"], "multifrontal");
  page.ask({{"do", "settings"}, {"settings", {{"backend", "eigen"}}}});
  EXPECT_TRUE(state(page)["notes"].empty());
}

std::vector<double> heights(const Mesh& mesh, double side) {
  std::vector<double> found;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (side * mesh.positions(v, 0) > 0.4) found.push_back(std::abs(mesh.positions(v, 0)));
  std::sort(found.begin(), found.end());
  return found;
}

TEST(EditorSymmetry, ShapesTheImageOfASelection) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_a_bar);
  page.ask({{"do", "symmetry"}});
  const Json inflate = {{"do", "sculpt"}, {"action", "inflate"}, {"height", 0.2}};
  const auto select = [&](const std::vector<int>& vertices) {
    page.ask({{"do", "select"}, {"how", "set"}, {"what", {{"indices", vertices}}}});
  };
  const auto saved = [&] {
    const std::filesystem::path mesh = folder / "saved.ply";
    page.ask({{"do", "save"}, {"mesh", mesh.string()}, {"overwrite", true}});
    return read_mesh(mesh);
  };
  select(near(page, 0.5, 0));
  EXPECT_TRUE(page.ask(inflate)["notes"].empty());
  EXPECT_EQ(state(page)["steps"].size(), 2U) << "one step shapes both sides";
  const Mesh both = saved();
  const std::vector<double> right = heights(both, 1), left = heights(both, -1);
  ASSERT_EQ(right.size(), left.size());
  for (std::size_t i = 0; i < right.size(); ++i) EXPECT_NEAR(right[i], left[i], 1e-6);
  EXPECT_GT(right.back(), 0.6);
  page.ask({{"do", "undo"}});
  EXPECT_EQ(state(page)["steps"].size(), 1U) << "one undo takes both back";

  select(near(page, 0, 2));  // touches its image
  page.ask(inflate);
  EXPECT_EQ(state(page)["steps"].size(), 2U);
}

TEST(EditorSculpt, SaysWhereNothingMoved) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_a_bar);
  const std::vector<int> flat = page.vertices(
      [](double x, double y, double z) { return x > 0.49 && std::abs(y) < 0.2 && std::abs(z) < 0.4; });
  ASSERT_GT(flat.size(), 3U);
  page.ask({{"do", "select"}, {"how", "set"}, {"what", {{"indices", flat}}}});
  const Json notes = page.ask({{"do", "sculpt"}, {"action", "flatten"}, {"strength", 0.5}})["notes"];
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0]["id"], "editor.nothing_moved");
  EXPECT_LT(state(page)["steps"][0]["found"]["moved"].get<double>(), 1e-9);
  page.ask({{"do", "sculpt"}, {"action", "inflate"}, {"height", 0.1}});
  EXPECT_GT(state(page)["steps"][1]["found"]["moved"].get<double>(), 0.01);
}

TEST(EditorSculpt, ChangesTheReach) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_a_bar);
  const auto raised = [&] {
    const std::filesystem::path mesh = folder / "saved.ply";
    page.ask({{"do", "save"}, {"mesh", mesh.string()}, {"overwrite", true}});
    const Points moved = read_mesh(mesh).positions - make_sample("bar", 20).positions;
    return (moved.rowwise().norm().array() > 1e-6).count();
  };
  const Json region = {{"nearest", {0.5, 0, 2}}};
  page.ask({{"do", "sculpt"}, {"action", "inflate"}, {"height", 0.1}, {"select", region}, {"reach", 0.3}});
  const auto near = raised();
  EXPECT_GT(near, 1);
  const auto change = [](const Json& reach) {
    return Json{{"do", "step"}, {"what", "change"}, {"index", 0}, {"fields", {{"reach", reach}}}};
  };
  page.ask(change(0.6));
  EXPECT_GT(raised(), near);
  page.ask(change(nullptr));
  EXPECT_EQ(raised(), 1) << "it fades inside again";
  EXPECT_EQ(page.refusal(change(-1))["location"], "reach");
}

TEST(EditorSymmetry, MovesTheTwinWhileItIsDragged) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_a_bar);
  EXPECT_TRUE(state(page)["symmetry"].is_null());
  const std::vector<int> arm = near(page, 0.5, 2);
  ASSERT_FALSE(arm.empty());
  paint(page, arm, "arm");
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  page.ask({{"do", "symmetry"}});
  const Json symmetry = state(page)["symmetry"];
  EXPECT_EQ(symmetry["plane"]["normal"], (Json{1.0, 0.0, 0.0}));
  EXPECT_EQ(symmetry["twins"], (Json::array({{{"name", "arm, mirrored"}, {"of", "arm"}}})));
  const Frame roles = page.frame(5, [](const Frame& f) { return f.handles.contains("arm, mirrored"); });
  EXPECT_EQ(roles.handles.at("arm, mirrored").size(), arm.size());

  const Json out = {{"translate", {0.3, 0, 0}}, {"rotate", {{"axis", {0, 1, 0}}, {"angle_deg", 30}}}};
  const std::vector<float> dragged = page.exact(page.ask({{"do", "drag"}, {"poses", {{"arm", out}}}})["pose"]);
  const std::vector<float> posed = page.exact(pose(page, "arm", out));
  EXPECT_EQ(dragged, posed);
  EXPECT_EQ(posed, run(page, folder / "bar.json"));
  EXPECT_LT(asymmetry(posed, arm), 1e-5);
  EXPECT_TRUE(state(page)["notes"].empty());
  const Json refused = page.refusal({{"do", "drag"}, {"poses", {{"arm, mirrored", out}}}});
  EXPECT_EQ(refused["id"], "editor.handle_follows");
  EXPECT_EQ(refused["fields"]["leader"], "arm");

  page.ask({{"do", "accept"}});
  EXPECT_FALSE(state(page)["symmetry"].is_null()) << "it stays on";
  page.ask({{"do", "undo"}});
  const std::vector<float> alone = page.exact(page.ask({{"do", "symmetry"}, {"plane", nullptr}})["pose"]);
  EXPECT_GT(asymmetry(alone, arm), 0.1);
  EXPECT_TRUE(state(page)["symmetry"].is_null());
}

TEST(EditorSymmetry, TellsOfPosesThatAreNotSymmetric) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_a_bar);
  page.ask(
      {{"do", "symmetry"}, {"plane", {{"point", {0, 0, 0}}, {"normal", {2, 0, 0}}}}, {"tolerance_rel", 0.01}});
  paint(page, page.vertices([](double, double, double z) { return z > 3.7; }), "top", 2);
  pose(page, "top", {{"translate", {0, 0.2, 0}}});
  EXPECT_TRUE(state(page)["notes"].empty());
  pose(page, "top", {{"translate", {0.2, 0, 0}}});
  EXPECT_EQ(state(page)["notes"].size(), 1U);
  const Json refused = page.refusal(
      {{"do", "paint-handle"},
       {"vertices", page.vertices([](double x, double, double z) { return z < 0.2 && x > -0.2; })}});
  EXPECT_EQ(refused["id"], "script.overlaps_mirror_image");
  EXPECT_FALSE(refused["remedy"].get<std::string>().empty());
  EXPECT_EQ(
      page.refusal({{"do", "symmetry"}, {"plane", {{"point", {0, 0, 0}}, {"normal", {0, 0, 0}}}}})["code"],
      "input");
}

/// Makes two accepted steps and one in progress.
void make_three_steps(Page& page) {
  page.ask(open_a_bar);
  paint(page, page.vertices([](double, double, double z) { return z > 3.7; }), "top", 2);
  pose(page, "top", lift(0.5));
  page.ask({{"do", "accept"}});
  paint(page, page.vertices([](double, double, double z) { return z < 0.3; }), "foot", 1);
  page.exact(pose(page, "foot", {{"translate", {0, 0.4, 0}}}));
  page.ask({{"do", "accept"}});
  paint(page, near(page, 0.5, 2), "arm", 0.8);
  page.exact(pose(page, "arm", {{"translate", {0.3, 0, 0}}}));
}

TEST(EditorSteps, AnEarlierStepChangesAndTheLaterOnesFollow) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  make_three_steps(page);
  const std::vector<float> first = page.shown();
  const Json steps = state(page)["steps"];
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0]["fields"]["handles"][0]["pose"], (Json{{"translate", {0.0, 0.0, 0.5}}}));
  EXPECT_TRUE(steps[0]["fields"]["region"].dump().size() < 200) << steps[0]["fields"]["region"];

  const Json changed = page.ask(
      {{"do", "step"},
       {"what", "change"},
       {"index", 0},
       {"poses", {{"top", lift(1)}}},
       {"fields", {{"settings", {{"stiffness", 5}, {"iterations", nullptr}}}, {"about", "the lift"}}}});
  const std::vector<float> second = page.exact(changed["pose"]);
  EXPECT_NE(second, first);
  EXPECT_EQ(second, run(page, folder / "bar.json"));
  const Json after = state(page)["steps"][0]["fields"];
  EXPECT_EQ(after["settings"]["stiffness"], 5);
  EXPECT_EQ(after["about"], "the lift");
  EXPECT_EQ(page.exact(page.ask({{"do", "undo"}})["pose"]), first);
  EXPECT_EQ(page.exact(page.ask({{"do", "redo"}})["pose"]), second);
}

/// The saved mesh has the bytes that the edit file gives, whether saving uses the shown frame or runs the
/// step.
TEST(EditorSteps, SavesTheBytesThatTheFileGivesWheneverItIsAsked) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const auto expect_same = [&](const std::string& when) {
    page.ask({{"do", "save"},
              {"edit", (folder / "bar.json").string()},
              {"mesh", (folder / "saved.ply").string()},
              {"overwrite", true}});
    write_mesh(run_edit(read_edit_file(folder / "bar.json")).mesh, folder / "expected.ply");
    EXPECT_EQ(read_file(folder / "saved.ply"), read_file(folder / "expected.ply")) << when;
  };
  page.ask(open_a_bar);
  paint(page, page.vertices([](double, double, double z) { return z > 3.7; }), "top", 2);
  expect_same("before any pose");
  page.ask({{"do", "pose"}, {"poses", {{"top", lift(0.5)}}}});
  expect_same("while the set-up runs");
  page.ask({{"do", "region"}, {"select", "all"}});
  page.ask({{"do", "fixed"}, {"select", {{"half_space", {{"point", {0, 0, 0.3}}, {"normal", {0, 0, -1}}}}}}});
  page.exact(pose(page, "top", lift(0.6)));
  expect_same("with the exact frame there");
  page.exact(page.ask({{"do", "drag"}, {"poses", {{"top", lift(0.9)}}}})["pose"]);
  expect_same("after a drag, which is no part of the document");
  page.ask({{"do", "handle"},
            {"what", "add"},
            {"name", "waist"},
            {"select", {{"box", {{"min", {-9, -9, 1.9}}, {"max", {9, 9, 2.1}}}}}}});
  page.exact(pose(page, "waist", {{"translate", {0.2, 0, 0}}}));
  expect_same("with a set-up that shares the one before");
  page.ask({{"do", "accept"}});
  expect_same("with a step that does nothing yet");
  paint(page, near(page, 0.5, 3), "arm", 0.4);
  page.exact(pose(page, "arm", {{"translate", {0.2, 0, 0}}}));
  expect_same("with a second step");
  page.ask({{"do", "settings"}, {"settings", {{"refine_boundary", 1}}}});
  expect_same("with a step that cannot be dragged");
  page.ask({{"do", "accept"}});
  expect_same("with that accepted");
}

TEST(EditorSteps, StepsAreRemovedAndRenamed) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  make_three_steps(page);
  const std::vector<float> before = page.shown();
  page.ask({{"do", "step"}, {"what", "rename"}, {"index", 1}, {"name", "kick"}});
  EXPECT_EQ(state(page)["steps"][1]["name"], "kick");
  const std::vector<float> less =
      page.exact(page.ask({{"do", "step"}, {"what", "remove"}, {"index", 1}})["pose"]);
  EXPECT_NE(less, before);
  EXPECT_EQ(less, run(page, folder / "bar.json"));
  EXPECT_EQ(state(page)["steps"].size(), 2U);
  page.ask({{"do", "step"}, {"what", "remove"}, {"index", 1}});
  EXPECT_EQ(state(page)["handles"][0]["name"], "top") << "the step before is in work again";
  page.ask({{"do", "undo"}});
  page.exact(page.ask({{"do", "undo"}})["pose"]);
  EXPECT_EQ(page.shown(), before);
  page.ask({{"do", "step"}, {"what", "rename"}, {"index", 1}, {"name", ""}});
  EXPECT_FALSE(state(page)["steps"][1].contains("name"));
}

TEST(EditorSteps, AChangeThatCannotBeLeavesAllAsItWas) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  make_three_steps(page);
  const Json before = state(page);
  const std::vector<Json> impossible = {
      {{"what", "change"}, {"index", 3}},
      {{"what", "change"}, {"index", -1}},
      {{"what", "change"}, {"index", 0}, {"fields", {{"region", {{"indices", {999999}}}}}}},
      {{"what", "change"}, {"index", 0}, {"fields", {{"colour", "red"}}}},
      {{"what", "change"}, {"index", 0}, {"fields", {{"mesh", nullptr}}}},
      {{"what", "change"}, {"index", 0}, {"fields", {{"settings", {{"stiffness", "much"}}}}}},
      {{"what", "change"}, {"index", 0}, {"poses", {{"arm", lift(1)}}}},
      {{"what", "change"}, {"index", 0}, {"fields", {{"result", "other"}}}, {"poses", 3}},
      {{"what", "rename"}, {"index", 0}},
      {{"what", "drop"}, {"index", 0}},
  };
  for (Json request : impossible) {
    request["do"] = "step";
    page.refusal(request);
    EXPECT_EQ(state(page), before) << request;
  }
  Page other(editor.url());
  other.ask(open_a_bar);
  EXPECT_EQ(other.refusal({{"do", "step"}, {"what", "remove"}, {"index", 0}})["code"], "usage");
}

TEST(EditorSteps, SelectionsFollowTheNameOfTheStepThatMadeThem) {
  const TemporaryFolder folder;
  folder.file("cut.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"bar": {"sample": "bar"}},
    "selections": {"rim": {"produced": {"step": "saw", "what": "loop"}}},
    "steps": [{"kind": "cut", "name": "saw", "mesh": "bar", "plane": {"point": [0, 0, 2], "normal": [0, 0, 1]},
               "keep": "below"},
              {"kind": "deform", "mesh": "bar", "region": {"half_space": {"point": [0, 0, 0.5], "normal": [0, 0, 1]}},
               "handles": [{"name": "rim", "select": "rim", "pose": {"translate": [0, 0, 0.3]}}]}]})");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", (folder / "cut.json").string()}});
  page.ask({{"do", "step"}, {"what", "rename"}, {"index", 0}, {"name", "blade"}});
  const Json moved = page.ask({{"do", "step"},
                               {"what", "change"},
                               {"index", 0},
                               {"fields", {{"plane", {{"point", {0, 0, 3}}, {"normal", {0, 0, 1}}}}}}});
  const std::vector<float> shown = page.exact(moved["pose"]);
  EXPECT_EQ(shown, run(page, folder / "blade.json"));
}

}  // namespace
}  // namespace meshgraft::test
