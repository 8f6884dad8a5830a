// Malformed, cancelled and unsolvable requests are answered with errors.
#include <string>

#include <gtest/gtest.h>

#include "bar_editing.h"
#include "io/temporary_folder.h"
#include "page_client.h"

namespace meshgraft::test {
namespace {

TEST(Editor, AnswersAndSurvivesWhatIsMalformed) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  EXPECT_EQ(page.refusal({{"do", "undo"}})["id"], "editor.nothing_open");
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), std::string("null"), std::string("{}"),
        std::string(R"({"id":[1],"do":"undo"})"), std::string(100'000, '['), std::string(R"({"do":"undo"})"),
        std::string("{\"id\":null}")}) {
    page.send_text(text);
    EXPECT_EQ(page.reply_to(0)["error"]["code"], "input") << text.substr(0, 40);
    page = Page(editor.url());
  }
  page.ask(open_bar);
  paint_top(page);
  const std::string before = saved(page, folder / "before.json");
  for (const Json& request :
       {Json{{"do", "fly"}},
        Json{{"do", 3}},
        Json{{"do", "undo"}, {"more", 1}},
        Json{{"do", "drag"}},
        Json{{"do", "drag"}, {"poses", 1}},
        Json{{"do", "drag"}, {"poses", {{"none", turn}}}},
        Json{{"do", "drag"}, {"poses", {{"top", {{"scale", "large"}}}}}},
        Json{{"do", "pose"}, {"poses", {{"none", turn}}}},
        Json{{"do", "pose"}, {"poses", {{"top", {{"rotate", {{"axis", {0, 0, 0}}, {"angle_deg", 1}}}}}}}},
        Json{{"do", "paint-handle"}, {"vertices", {-1}}},
        Json{{"do", "paint-handle"}, {"vertices", {1 << 30}}},
        Json{{"do", "paint-handle"}, {"vertices", Json::array()}},
        Json{{"do", "paint-handle"}, {"vertices", {0}}, {"name", "top"}},
        Json{{"do", "region"}, {"select", {{"indices", {0}}}}},
        Json{{"do", "settings"}, {"settings", {{"nose", 1}}}},
        Json{{"do", "settings"}, {"anchors", 5}},
        Json{{"do", "handle"}, {"what", "remove"}, {"name", "none"}},
        Json{{"do", "reach"}, {"handle", "none"}, {"reach", 1}},
        Json{{"do", "reach"}, {"handle", "top"}, {"reach", -1}},
        Json{{"do", "select"}, {"how", "set"}, {"what", {{"flood", {{"vertex", 1 << 30}, {"angle_deg", 1}}}}}},
        Json{{"do", "export"}, {"path", "bar.xyz"}}})
    EXPECT_EQ(page.refusal(request)["code"], "input") << request;
  EXPECT_EQ(saved(page, folder / "after.json"), before);
  page.exact(pose_top(page)["pose"]);
  EXPECT_EQ(page.refusal({{"do", "open"}})["code"], "input");
  EXPECT_EQ(page.refusal({{"do", "open"}, {"sample", "unicorn"}})["code"], "input");
  EXPECT_EQ(page.ask({{"do", "state"}})["name"], "bar") << "what was open stays";
}

TEST(Editor, CancelsWhatRunsAndWhatWaits) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const int opening = page.send({{"do", "open"}, {"sample", "octopus"}, {"resolution", 500}});
  const int waiting = page.send({{"do", "state"}});
  const int cancelling = page.send({{"do", "cancel"}});
  EXPECT_TRUE(page.reply_to(cancelling).contains("result"));
  EXPECT_EQ(page.reply_to(opening)["error"]["code"], "cancelled");
  EXPECT_EQ(page.reply_to(waiting)["error"]["code"], "cancelled");
  const int needless = page.send({{"do", "open"}, {"sample", "octopus"}, {"resolution", 500}});
  page.ask(open_bar);
  EXPECT_EQ(page.reply_to(needless)["error"]["code"], "cancelled");
}

TEST(Editor, TellsWhatCannotBeSolved) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  page.ask({{"do", "region"}, {"select", "all"}});
  page.ask({{"do", "handle"},
            {"what", "add"},
            {"name", "one"},
            {"shape", "vertex"},
            {"constrain", "position"},
            {"select", {{"nearest", {0, 0, 4}}}}});
  const Json live = page.event("live", [](const Json& event) { return event.contains("error"); });
  EXPECT_EQ(live["error"]["code"], "unsolvable");
  page.ask({{"do", "undo"}});
}

}  // namespace
}  // namespace meshgraft::test
