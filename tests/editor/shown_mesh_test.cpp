// The mesh that the page shows is the one that the saved edit gives.
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/script/run_edit.h>

#include "bar_editing.h"
#include "io/file.h"
#include "io/temporary_folder.h"
#include "page_client.h"
#include "support/paths.h"

namespace meshgraft::test {
namespace {

TEST(Editor, ShowsWhatTheSavedFileGives) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  for (const Json& settings : {Json::object(), Json{{"method", "ft05"}}, Json{{"refine_boundary", 1}},
                               Json{{"method", "rotation-aware"}}}) {
    Page page(editor.url());
    page.ask(open_bar);
    paint_top(page);
    page.ask({{"do", "settings"}, {"settings", settings}});
    const Json pose = pose_top(page)["pose"];
    const std::vector<float> shown = page.exact(pose);
    page.ask({{"do", "save"},
              {"edit", "bar.json"},
              {"mesh", (folder / "bar_shown.ply").string()},
              {"overwrite", true}});

    const Mesh expected = run_edit(read_edit_file(folder / "bar.json")).mesh;
    EXPECT_EQ(shown, as_shown(expected.positions, page.offset())) << settings;
    write_mesh(expected, folder / "bar_expected.ply");
    EXPECT_EQ(read_file(folder / "bar_shown.ply"), read_file(folder / "bar_expected.ply")) << settings;
    if (std::string_view(program()).empty()) continue;
    // The program restarts itself with better kernels where OpenBLAS takes its oldest ones; this process has
    // those.
    const std::string kernels = better_blas_kernels().empty() ? "" : "OPENBLAS_CORETYPE=Prescott ";
    const std::string run = kernels + "'" + std::string(program()) + "' run '" +
                            (folder / "bar.json").string() + "' -o '" + (folder / "bar_run.ply").string() +
                            "' > /dev/null";
    ASSERT_EQ(std::system(run.c_str()), 0) << settings;
    EXPECT_EQ(read_file(folder / "bar_run.ply"), read_file(folder / "bar_shown.ply")) << settings;
  }
}

// The mesh is refined around a handle of one vertex, in live frames as in the saved file's run.
TEST(Editor, ShowsWhatTheSavedFileGivesForASingleVertex) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  const Json lift = {
      {"tip", {{"translate", {0, 0, 0.15}}, {"rotate", {{"axis", {1, 0, 0}}, {"angle_deg", 20}}}}}};
  for (const char* method : {"corotational", "rotation-aware", "ft05"}) {
    Page page(editor.url());
    page.ask({{"do", "open"}, {"sample", "bumpy_plane"}, {"resolution", 25}});
    const std::size_t numbers = page.frame(1).numbers["positions"].size();
    page.ask({{"do", "settings"}, {"settings", {{"method", method}}}});
    page.ask({{"do", "paint-handle"}, {"vertices", {312}}, {"name", "tip"}, {"reach", 0.3}});
    const auto expect_same = [&](const std::vector<float>& shown) {
      EXPECT_EQ(shown.size(), numbers);
      const std::string file = folder / "tip.json";
      page.ask({{"do", "save"}, {"edit", file}, {"mesh", (folder / "tip.ply").string()}, {"overwrite", true}});
      const EditResult expected = run_edit(read_edit_file(file));
      EXPECT_GT(expected.report.steps.front().refined_vertices, 0);
      EXPECT_EQ(shown, as_shown(expected.mesh.positions, page.offset())) << method;
      write_mesh(expected.mesh, folder / "expected.ply");
      EXPECT_EQ(read_file(folder / "tip.ply"), read_file(folder / "expected.ply")) << method;
    };
    page.exact(page.ask({{"do", "drag"}, {"poses", lift}})["pose"]);
    expect_same(page.exact(page.ask({{"do", "pose"}, {"poses", lift}})["pose"]));
    page.ask({{"do", "reach"}, {"handle", "tip"}, {"reach", 5}});
    const Json counts = page.ask({{"do", "state"}})["counts"];
    EXPECT_GT(4 * (counts["region"].get<int>() - counts["fixed"].get<int>()), 3 * (25 * 25 + 200))
        << "all positions are sent";
    expect_same(page.exact(page.ask({{"do", "pose"}, {"poses", lift}})["pose"]));
    page.ask({{"do", "paint-handle"}, {"vertices", {162}}, {"name", "other"}, {"reach", 0.3}});
    expect_same(page.exact(page.ask({{"do", "pose"}, {"poses", lift}})["pose"]));
  }
}

TEST(Editor, DragsAndEndsWhereItWasDraggedLast) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  const std::string before = saved(page, folder / "before.json");
  int last = 0;
  for (int step = 1; step <= 40; ++step)
    last = page.send(
        {{"do", "drag"},
         {"poses",
          {{"top", {{"rotate", {{"axis", {1, 0, 0}}, {"angle_deg", step}}}, {"translate", {0.1, 0, 0}}}}}}});
  const Json dragged = page.reply_to(last)["result"]["pose"];
  EXPECT_GT(dragged, 0);
  const std::vector<float> shown = page.exact(dragged);
  EXPECT_EQ(saved(page, folder / "after.json"), before) << "a drag is no part of the document";
  EXPECT_EQ(page.exact(pose_top(page)["pose"]), shown);
}

TEST(Editor, EditsTheAcceptedMeshFurther) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  pose_top(page);
  const std::vector<float> accepted = page.exact(page.ask({{"do", "accept"}})["pose"]);
  saved(page, folder / "one.json");
  EXPECT_EQ(accepted, as_shown(run_edit(read_edit_file(folder / "one.json")).mesh.positions, page.offset()));
  const std::vector<int> low = page.vertices([](double, double, double z) { return z < 0.3; });
  page.ask({{"do", "paint-handle"}, {"vertices", low}, {"name", "foot"}, {"reach", 1.0}});
  const Json pose = page.ask({{"do", "pose"}, {"poses", {{"foot", {{"translate", {0, 0.3, 0}}}}}}})["pose"];
  const std::vector<float> twice = page.exact(pose);
  EXPECT_NE(twice, accepted);
  saved(page, folder / "two.json");
  EXPECT_EQ(twice, as_shown(run_edit(read_edit_file(folder / "two.json")).mesh.positions, page.offset()));
}

TEST(Editor, SettingsChangeTheOutcome) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  std::vector<std::vector<float>> outcomes{page.exact(pose_top(page)["pose"])};
  for (const Json& settings :
       {Json{{"method", "ft05"}}, Json{{"weights", "cotangent"}}, Json{{"density", "ft05"}}})
    outcomes.push_back(page.exact(page.ask({{"do", "settings"}, {"settings", settings}})["pose"]));
  for (std::size_t a = 0; a < outcomes.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_NE(outcomes[a], outcomes[b]) << a << " " << b;
  const Json refused = page.refusal({{"do", "settings"}, {"settings", {{"stiffness", -1}}}});
  EXPECT_EQ(refused["step"], 0);
  EXPECT_EQ(refused["location"], "settings.stiffness");
  EXPECT_EQ(page.ask({{"do", "state"}})["settings"]["density"], "ft05");
}

TEST(Editor, KeepsTabsApart) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page first(editor.url()), second(editor.url());
  first.ask(open_bar);
  second.ask({{"do", "open"}, {"sample", "cylinder"}, {"resolution", 16}});
  second.exact(1);
  paint_top(first);
  first.exact(pose_top(first)["pose"]);
  const Json state = second.ask({{"do", "state"}});
  EXPECT_EQ(state["name"], "cylinder");
  EXPECT_TRUE(state["handles"].empty());
  EXPECT_EQ(state["undo"], nullptr);
  EXPECT_EQ(second.waiting_frames(), 2u) << "the mesh, and who is what";
}

}  // namespace
}  // namespace meshgraft::test
