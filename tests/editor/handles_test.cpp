// A page selects vertices, and makes, moves and removes handles.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/script/run_edit.h>

#include "bar_editing.h"
#include "io/temporary_folder.h"
#include "page_client.h"

namespace meshgraft::test {
namespace {

TEST(Editor, SelectsInEveryWay) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"sample", "posts"}, {"resolution", 40}});
  const auto count = page.ask({{"do", "state"}})["model"]["vertices"].get<int>();
  const auto select = [&](const Json& how, const Json& what) {
    page.ask({{"do", "select"}, {"how", how}, {"what", what}});
    return page.frame(4).indices["vertices"];
  };
  const auto part = select("set", {{"component", 0}});
  EXPECT_EQ(select("set", {{"component_of", part.back()}}), part);
  const auto loop = select("set", {{"loop", 0}});
  EXPECT_EQ(select("set", {{"loop_of", loop.front()}}), loop);
  EXPECT_EQ(page.refusal({{"do", "select"}, {"how", "set"}, {"what", {{"loop", 99}}}})["code"], "input");
  const auto added = select("add", {{"component", 1}});
  EXPECT_EQ(select("set", {{"union", {{{"loop", 0}}, {{"component", 1}}}}}), added);
  EXPECT_EQ(select("set", "all").size(), static_cast<std::size_t>(count));
  EXPECT_EQ(select("remove", {{"component", 0}}).size(), static_cast<std::size_t>(count) - part.size());
  page.ask({{"do", "select"}, {"how", "invert"}});
  EXPECT_EQ(page.frame(4).indices["vertices"], part);
  EXPECT_EQ(select("intersect", {{"indices", {part[0], part[1]}}}).size(), 2u);
  page.ask({{"do", "select"}, {"how", "grow"}, {"rings", 2}});
  const auto grown = page.frame(4).indices["vertices"];
  EXPECT_GT(grown.size(), 2u);
  page.ask({{"do", "select"}, {"how", "grow"}, {"rings", -1}});
  EXPECT_LT(page.frame(4).indices["vertices"].size(), grown.size());
  EXPECT_EQ(select("set", {{"flood", {{"vertex", part[0]}, {"angle_deg", 180}}}}), part);
  EXPECT_LT(select("set", {{"flood", {{"vertex", part[0]}, {"angle_deg", 1}}}}).size(), part.size());
  page.ask({{"do", "select"}, {"how", "set"}, {"what", {{"component", 2}}}});
  page.ask({{"do", "group"}, {"name", "third"}, {"colour", "#00aa55"}});
  EXPECT_EQ(page.refusal({{"do", "group"}, {"name", "third"}, {"colour", "green"}})["code"], "input");
  const Json groups = page.ask({{"do", "state"}})["groups"];
  EXPECT_EQ(groups, Json::array({{{"name", "third"}, {"colour", "#00aa55"}}}));
  page.frame(4);
  const auto third = select("set", {{"component", 2}});
  EXPECT_EQ(select("set", "third"), third);
  select("set", {{"component", 1}});
  page.ask({{"do", "group"}, {"name", "third"}, {"colour", "#112233"}, {"keep", true}});
  EXPECT_EQ(page.ask({{"do", "state"}})["groups"][0]["colour"], "#112233");
  EXPECT_EQ(select("set", "third"), third);
  EXPECT_EQ(page.refusal({{"do", "group"}, {"name", "fourth"}, {"colour", "#112233"}, {"keep", true}})["code"],
            "input");
  EXPECT_EQ(page.refusal({{"do", "select"}, {"how", "set"}, {"what", "fourth"}})["code"], "input");
}

TEST(Editor, HasHandlesOfEveryShape) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  page.ask({{"do", "region"}, {"select", "all"}});
  page.ask({{"do", "fixed"}, {"select", {{"half_space", {{"point", {0, 0, 0.5}}, {"normal", {0, 0, -1}}}}}}});
  page.ask({{"do", "handle"},
            {"what", "add"},
            {"name", "corner"},
            {"shape", "vertex"},
            {"select", {{"nearest", {0.5, 0.5, 4}}}}});
  page.ask(
      {{"do", "handle"},
       {"what", "add"},
       {"name", "belt"},
       {"shape", "curve"},
       {"closed", true},
       {"select",
        {{"path", {{"points", {{0.5, 0, 2}, {0, 0.5, 2}, {-0.5, 0, 2}, {0, -0.5, 2}}}, {"closed", true}}}}}});
  const Json pose =
      page.ask({{"do", "pose"},
                {"poses", {{"corner", {{"translate", {0, 0, 0.4}}}}, {"belt", {{"scale", 1.2}}}}}})["pose"];
  const std::vector<float> shown = page.exact(pose);
  const Json state = page.event("state", [](const Json& e) { return e["undo"] == "pose"; });
  EXPECT_EQ(state["handles"].size(), 2u);
  EXPECT_EQ(state["handles"][1]["closed"], true);
  EXPECT_EQ(state["handles"][0]["rim"].size(), 1u);
  saved(page, folder / "shapes.json");
  EXPECT_EQ(shown, as_shown(run_edit(read_edit_file(folder / "shapes.json")).mesh.positions, page.offset()));
  page.ask({{"do", "handle"}, {"what", "remove"}, {"name", "belt"}});
  EXPECT_EQ(page.ask({{"do", "state"}})["handles"].size(), 1u);
}

TEST(Editor, HoldsAHandleWhereItIsShown) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  const std::vector<int> belt = page.vertices([](double, double, double z) { return z > 2.9 && z < 3.2; });
  const std::vector<int> foot = page.vertices([](double, double, double z) { return z < 0.3; });
  ASSERT_GT(belt.size(), 8u);
  paint_top(page);
  const std::vector<float> rest = page.shown();
  const std::vector<float> bent = page.exact(pose_top(page)["pose"]);
  const auto farthest = [&](const std::vector<float>& a, const std::vector<float>& b) {
    double distance = 0;
    for (const int v : belt)
      for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(3 * v + k);
        distance = std::max(distance, static_cast<double>(std::abs(a[i] - b[i])));
      }
    return distance;
  };
  ASSERT_GT(farthest(bent, rest), 0.2) << "the belt moved";
  const Json ways[] = {{{"do", "paint-handle"}, {"vertices", belt}, {"name", "belt"}, {"reach", 0.2}},
                       {{"do", "handle"},
                        {"what", "add"},
                        {"select", {{"indices", belt}}},
                        {"name", "belt"},
                        {"shape", "region"}}};
  for (const Json& way : ways) {
    const std::vector<float>& held = page.exact(page.ask(way)["pose"]);
    EXPECT_LT(farthest(held, bent), 0.04) << "it stays about where it was painted";
    page.ask({{"do", "undo"}});
  }
  page.ask({{"do", "paint-handle"}, {"vertices", foot}, {"name", "foot"}});
  const Json state = page.ask({{"do", "state"}});
  EXPECT_EQ(state["handles"][1]["name"], "foot");
  EXPECT_FALSE(state["handles"][1].contains("pose") && !state["handles"][1]["pose"].empty())
      << "nothing moved it";
}

TEST(Editor, RemovesAHandleWithItsRegion) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  const std::string one = saved(page, folder / "one.json");
  const std::vector<int> low = page.vertices([](double, double, double z) { return z < 0.3; });
  const Json painted = page.ask({{"do", "paint-handle"}, {"vertices", low}, {"name", "foot"}});
  EXPECT_GT(painted["reach"], 0.1);
  page.ask({{"do", "handle"}, {"what", "remove"}, {"name", "foot"}});
  EXPECT_EQ(saved(page, folder / "two.json"), one);
}

}  // namespace
}  // namespace meshgraft::test
