// Work that was not saved is restored from the journal beside the model.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>

#include "bar_editing.h"
#include "io/file.h"
#include "io/temporary_folder.h"
#include "page_client.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;

TEST(Editor, RestoresWhatWasNotSaved) {
  const TemporaryFolder folder;
  const fs::path model = bar_file(folder), journal = model.string() + ".meshgraft-session";
  const RunningEditor editor({}, {model});
  std::vector<float> shown;
  {
    Page page(editor.url());
    page.ask({{"do", "open"}, {"path", model.string()}});
    EXPECT_FALSE(fs::exists(journal)) << "nothing was changed";
    paint_top(page);
    shown = page.exact(pose_top(page)["pose"]);
    page.ask({{"do", "settings"}, {"settings", {{"stiffness", 7}}}});
  }
  const std::string whole = read_file(journal);
  for (const std::size_t cut : {whole.size() - 1, whole.size() - 20}) {
    SCOPED_TRACE(cut);
    fs::remove(journal);
    std::ofstream(journal, std::ios::binary) << whole.substr(0, cut);
    Page page(editor.url());
    page.ask({{"do", "open"}, {"path", model.string()}});
    EXPECT_EQ(page.event("offer-restore")["changes"], 2);
    EXPECT_EQ(page.exact(page.ask({{"do", "restore"}})["pose"]), shown);
    const Json state = page.ask({{"do", "state"}});
    EXPECT_EQ(state["undo"], "pose");
    EXPECT_EQ(state["dirty"], true);
    page.ask({{"do", "undo"}});
    EXPECT_EQ(page.ask({{"do", "state"}})["undo"], "paint_handle");
  }
  {
    Page page(editor.url());
    page.ask({{"do", "open"}, {"path", model.string()}});
    const Json offer = page.event("offer-restore");
    EXPECT_EQ(offer["changes"], 1);
    EXPECT_EQ(offer["undone"], 1) << "the undo went to the journal, too";
    const fs::path aside = page.ask({{"do", "discard"}})["aside"].get<std::string>();
    EXPECT_TRUE(fs::exists(aside));
    paint_top(page);
    page.ask({{"do", "save"}, {"edit", (folder / "bar.json").string()}});
  }
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", model.string()}});
  EXPECT_EQ(page.refusal({{"do", "restore"}})["code"], "usage") << "all was saved";
}

TEST(Editor, KnowsAfterARestoreWhatWasSaved) {
  for (const bool in_edit : {false, true})
    for (const bool before_the_first_change : {false, true}) {
      SCOPED_TRACE(in_edit);
      SCOPED_TRACE(before_the_first_change);
      const TemporaryFolder folder;
      const fs::path model = bar_file(folder), edit = folder / "bar.json";
      const RunningEditor editor({}, {model});
      {
        Page page(editor.url());
        page.ask({{"do", "open"}, {"path", model.string()}});
        if (in_edit && before_the_first_change) saved(page, edit);
        paint_top(page);
        if (in_edit && !before_the_first_change) saved(page, edit);
        pose_top(page);
      }
      Page page(editor.url());
      page.ask({{"do", "open"}, {"path", model.string()}});
      page.ask({{"do", "restore"}});
      const auto is_dirty = [&] { return page.ask({{"do", "state"}})["dirty"].get<bool>(); };
      const bool first_is_saved = !in_edit || before_the_first_change;
      EXPECT_TRUE(is_dirty());
      EXPECT_EQ(page.ask({{"do", "state"}})["edit"], in_edit ? edit.string() : "");
      page.ask({{"do", "undo"}});
      EXPECT_EQ(is_dirty(), first_is_saved);
      page.ask({{"do", "undo"}});
      EXPECT_EQ(is_dirty(), !first_is_saved);
      page.ask({{"do", "redo"}});
      EXPECT_EQ(is_dirty(), first_is_saved);
      if (!in_edit) continue;
      page.ask({{"do", "save"}});
      EXPECT_FALSE(is_dirty());
    }
}

TEST(Editor, CallsNothingSavedWhereTheEditFileIsNoLongerTheSame) {
  for (const bool gone : {false, true}) {
    const TemporaryFolder folder;
    const fs::path model = bar_file(folder), edit = folder / "bar.json";
    const RunningEditor editor({}, {model});
    {
      Page page(editor.url());
      page.ask({{"do", "open"}, {"path", model.string()}});
      paint_top(page);
      saved(page, edit);
      pose_top(page);
    }
    if (gone)
      fs::remove(edit);
    else
      (void)std::ofstream(edit, std::ios::app).put(' ');
    Page page(editor.url());
    page.ask({{"do", "open"}, {"path", model.string()}});
    page.ask({{"do", "restore"}});
    for (int undone = 0; undone < 3; ++undone) {
      EXPECT_EQ(page.ask({{"do", "state"}})["dirty"], true) << undone;
      if (undone < 2) page.ask({{"do", "undo"}});
    }
    EXPECT_EQ(page.ask({{"do", "state"}})["edit"], "");
  }
}

TEST(Editor, RestoresNoPartThatWasWithdrawn) {
  const TemporaryFolder folder;
  const fs::path model = bar_file(folder);
  const RunningEditor editor({}, {model});
  {
    Page page(editor.url());
    page.ask({{"do", "open"}, {"path", model.string()}});
    paint_top(page);
    page.ask({{"do", "part"}, {"what", "add"}, {"sample", "head"}, {"resolution", 12}});
    page.ask({{"do", "part"}, {"what", "withdraw"}, {"name", "head"}});
  }
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", model.string()}});
  const Json offer = page.event("offer-restore");
  EXPECT_EQ(offer["changes"], 1);
  EXPECT_EQ(offer["undone"], 0);
  page.ask({{"do", "restore"}});
  EXPECT_EQ(page.ask({{"do", "state"}})["redo"], Json());
}

TEST(Editor, LetsEachSessionHaveItsOwnJournal) {
  const TemporaryFolder folder;
  const fs::path model = bar_file(folder);
  const RunningEditor editor({}, {model});
  Page first(editor.url()), second(editor.url());
  for (Page* page : {&first, &second}) {
    page->ask({{"do", "open"}, {"path", model.string()}});
    paint_top(*page);
  }
  EXPECT_TRUE(fs::exists(model.string() + ".meshgraft-session"));
  EXPECT_TRUE(fs::exists(model.string() + ".meshgraft-session-2"));
}

}  // namespace
}  // namespace meshgraft::test
