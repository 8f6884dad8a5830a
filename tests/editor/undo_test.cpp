// Changes are undone and redone, also while their set-up goes on.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/script/run_edit.h>

#include "bar_editing.h"
#include "io/temporary_folder.h"
#include "page_client.h"

namespace meshgraft::test {
namespace {

TEST(Editor, TakesBackTheChangeWhoseSetUpGoesOn) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 120}});
  page.ask({{"do", "region"}, {"select", "all"}});
  page.ask({{"do", "fixed"}, {"select", {{"half_space", {{"point", {0, 0, 0.2}}, {"normal", {0, 0, -1}}}}}}});
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  page.ask({{"do", "handle"},
            {"what", "add"},
            {"name", "top"},
            {"select", {{"half_space", {{"point", {0, 0, 3.8}}, {"normal", {0, 0, 1}}}}}}});
  const std::vector<float> before = page.exact(pose_top(page)["pose"]);
  page.event("live", [](const Json& live) { return live.value("stage", "") == "ready"; });
  const Json state = page.ask({{"do", "state"}});
  EXPECT_EQ(page.refusal({{"do", "cancel"}, {"of", nullptr}})["code"], "usage") << "all is set up";

  page.send({{"do", "settings"}, {"settings", {{"method", "corotational"}}}});
  const Json pose = page.ask({{"do", "cancel"}, {"of", nullptr}})["pose"];
  EXPECT_EQ(page.exact(pose), before);
  Json after = page.ask({{"do", "state"}});
  EXPECT_EQ(after["redo"], "settings") << "it can be asked for again";
  for (const char* field : {"steps", "handles", "settings", "counts", "undo"})
    EXPECT_EQ(after[field], state[field]) << field;
  page.ask({{"do", "redo"}});
  EXPECT_EQ(page.ask({{"do", "state"}})["set_up_for"], "settings");
}

// A preset stands for the settings that are not given beside it, and is undone like any setting.
TEST(Editor, APresetTakesThePlaceOfSettings) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  const auto settings = [&] { return page.ask({{"do", "state"}})["settings"]; };
  const auto change = [&](const Json& changes) {
    page.ask({{"do", "settings"}, {"settings", changes}});
    return settings();
  };
  Json usual = settings();
  const Json own = change({{"method", "rotation-aware"}, {"stiffness", 5}, {"seed", 4}});
  const std::string bytes = saved(page, folder / "own.json");
  const Json published = change({{"preset", "as-published"}});
  EXPECT_EQ(published["preset"], "as-published");
  EXPECT_EQ(published["method"], "ft05");
  EXPECT_EQ(published["noise_lengths"], "random");
  EXPECT_EQ(published["laplacian_weight"], 1);
  EXPECT_EQ(published["seed"], 4) << "no part of the preset";
  const std::vector<float> shown = page.exact(pose_top(page)["pose"]);
  saved(page, folder / "published.json");
  const EditFile edit = read_edit_file(folder / "published.json");
  EXPECT_EQ(shown, as_shown(run_edit(edit).mesh.positions, page.offset()));
  page.ask({{"do", "undo"}});
  page.ask({{"do", "undo"}});
  EXPECT_EQ(settings(), own);
  EXPECT_EQ(saved(page, folder / "again.json"), bytes);
  page.ask({{"do", "redo"}});
  EXPECT_EQ(settings(), published);
  EXPECT_EQ(change({{"density", "aware"}})["density"], "aware");
  EXPECT_EQ(change({{"preset", "as-published"}})["density"], "aware") << "it is no other preset";
  EXPECT_EQ(change({{"density", nullptr}}), published);
  usual["seed"] = 4;
  EXPECT_EQ(change({{"preset", nullptr}}), usual);
  EXPECT_EQ(page.refusal({{"do", "settings"}, {"settings", {{"preset", "draft"}}}})["code"], "input");
}

TEST(Editor, UndoesToTheFirstBytesAndRedoesToTheLast) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  const std::string first = saved(page, folder / "first.json");
  const std::vector<float> rest = page.exact(1);
  paint_top(page);
  page.ask({{"do", "reach"}, {"handle", "top"}, {"reach", 1.5}});
  page.ask({{"do", "settings"}, {"settings", {{"stiffness", 5}}}});
  page.ask({{"do", "handle"}, {"what", "rename"}, {"name", "top"}, {"to", "end"}});
  page.ask({{"do", "pose"}, {"poses", {{"end", turn}}}});
  page.ask({{"do", "accept"}});
  page.ask({{"do", "reset"}});
  page.ask({{"do", "undo"}});
  const std::vector<float> edited = page.exact(page.ask({{"do", "undo"}})["pose"]);
  const std::string last = saved(page, folder / "last.json");
  EXPECT_NE(edited, rest);

  for (int k = 0; k < 4; ++k) page.ask({{"do", "undo"}});
  const Json bottom = page.ask({{"do", "undo"}})["pose"];
  EXPECT_EQ(page.refusal({{"do", "undo"}})["code"], "usage");
  EXPECT_EQ(saved(page, folder / "again.json"), first);
  EXPECT_EQ(page.exact(bottom), rest);

  Json top;
  for (int k = 0; k < 5; ++k) top = page.ask({{"do", "redo"}})["pose"];
  EXPECT_EQ(saved(page, folder / "again.json"), last);
  EXPECT_EQ(page.exact(top), edited);
}

}  // namespace
}  // namespace meshgraft::test
