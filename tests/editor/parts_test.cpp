// Tests parts beside the model, their loops, and cuts, as a page sees them.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "graft_editor.h"

namespace meshgraft::test {
namespace {

TEST_F(GraftEditor, ShowsAPartBesideTheModel) {
  open_bust();
  const Json alone = state();
  EXPECT_TRUE(alone["parts"].empty());
  EXPECT_EQ(alone["model"]["name"], "bust");
  EXPECT_EQ(alone["model"]["loops"], 1);
  EXPECT_EQ(add_head(), "head");
  EXPECT_EQ(add_head(), "head 2") << "a name that is free";
  const Json both = state();
  ASSERT_EQ(both["parts"].size(), 2u);
  EXPECT_EQ(both["model"], alone["model"]) << "the model stays as it was";
  const Json& part = both["parts"][0];
  EXPECT_EQ(part["name"], "head");
  EXPECT_FALSE(part["grafted"]);
  const Frame mesh = page_.frame(1, [&](const Frame& frame) { return frame.header["mesh"] == part["mesh"]; });
  EXPECT_EQ(mesh.header["role"], "part");
  EXPECT_EQ(mesh.numbers.at("positions").size(), 3 * part["vertices"].get<std::size_t>());

  page_.ask({{"do", "part"}, {"what", "remove"}, {"name", "head"}});
  EXPECT_EQ(state()["parts"].size(), 1u);
  page_.ask({{"do", "undo"}});
  EXPECT_EQ(state()["parts"][0], part) << "the same mesh again";
  page_.frame(1, [&](const Frame& frame) { return frame.header["mesh"] == part["mesh"]; });
}

TEST_F(GraftEditor, NamesTheFileOfTheModelThatWasOpened) {
  write_mesh(make_sample("bar", 8), folder_ / "zebra.ply");
  write_mesh(make_sample("bar", 8), folder_ / "ant.ply");
  page_.ask({{"do", "open"}, {"path", (folder_ / "zebra.ply").string()}});
  EXPECT_EQ(state()["file"], "zebra.ply");
  page_.ask({{"do", "part"}, {"what", "add"}, {"path", (folder_ / "ant.ply").string()}});
  EXPECT_EQ(state()["file"], "zebra.ply") << "inputs are in the order of their names";
}

TEST_F(GraftEditor, RefusesPartsThatAreNone) {
  EXPECT_EQ(page_.refusal({{"do", "part"}, {"what", "add"}, {"sample", "head"}})["code"], "usage")
      << "nothing is open";
  open_bust_and_head();
  folder_.file("text.ply", "no mesh");
  const std::string before = saved("before.json");
  for (const Json& request :
       {Json{{"do", "part"}}, Json{{"do", "part"}, {"what", "fly"}}, Json{{"do", "part"}, {"what", "add"}},
        Json{{"do", "part"}, {"what", "add"}, {"sample", "unicorn"}},
        Json{{"do", "part"}, {"what", "add"}, {"sample", "head"}, {"path", "text.ply"}},
        Json{{"do", "part"}, {"what", "add"}, {"path", "text.ply"}},
        Json{{"do", "part"}, {"what", "add"}, {"path", "before.json"}},
        Json{{"do", "part"}, {"what", "add"}, {"sample", "head"}, {"name", "bust"}},
        Json{{"do", "part"}, {"what", "remove"}, {"name", "bust"}},
        Json{{"do", "part"}, {"what", "remove"}, {"name", "none"}},
        Json{{"do", "part"}, {"what", "edit"}, {"name", "none"}}, Json{{"do", "loops"}, {"mesh", "none"}},
        Json{{"do", "select"}, {"mesh", "none"}, {"how", "set"}, {"what", "all"}}})
    EXPECT_EQ(page_.refusal(request)["code"], "input") << request;
  EXPECT_EQ(page_.refusal({{"do", "part"}, {"what", "add"}, {"path", "none.ply"}})["code"], "io");
  EXPECT_EQ(saved("after.json"), before);
}

TEST_F(GraftEditor, ListsTheLoopsOfAnObject) {
  open_bust();
  page_.ask({{"do", "part"}, {"what", "add"}, {"sample", "posts"}, {"resolution", 24}, {"name", "four"}});
  const Json loops = page_.ask({{"do", "loops"}, {"mesh", "four"}})["loops"];
  ASSERT_EQ(loops.size(), 4u);
  const Frame frame = page_.frame(7);
  const auto expected = boundary_loops(make_sample("posts", 24));
  const auto& offsets = frame.indices.at("offsets");
  ASSERT_EQ(offsets.size(), 5u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(std::vector<Index>(frame.indices.at("vertices").begin() + offsets[k],
                                 frame.indices.at("vertices").begin() + offsets[k + 1]),
              expected[k]);
    EXPECT_EQ(loops[k]["vertices"], expected[k].size());
    EXPECT_NEAR(loops[k]["centre"][2].get<double>(), 1.2, 0.01);
  }
  EXPECT_EQ(page_.ask({{"do", "loops"}})["loops"].size(), 1u) << "the model's";
}

TEST_F(GraftEditor, SelectsOnOneObjectAtATime) {
  open_bust_and_head();
  const Json on_head = {{"do", "select"}, {"mesh", "head"}, {"how", "set"}, {"what", loop_0}};
  const auto count = page_.ask(on_head)["selected"];
  const Frame frame = page_.frame(4);
  EXPECT_EQ(frame.header["mesh"], state()["parts"][0]["mesh"]);
  EXPECT_EQ(frame.indices.at("vertices").size(), count.get<std::size_t>());
  EXPECT_EQ(state()["selected_on"], "head");
  EXPECT_EQ(page_.refusal({{"do", "region"}})["code"], "usage") << "that is the model's";
  page_.ask({{"do", "select"}, {"mesh", "head"}, {"how", "grow"}, {"rings", 1}});
  EXPECT_GT(state()["selected"], count);
  page_.ask({{"do", "select"}, {"how", "add"}, {"what", {{"indices", {5}}}}});
  EXPECT_EQ(state()["selected"], 1) << "on another object it begins anew";
  EXPECT_EQ(state()["selected_on"], "bust");
}

TEST_F(GraftEditor, CutsByAPlane) {
  open_bust_and_head();
  const Json whole = state();
  page_.ask({{"do", "cut"},
             {"mesh", "head"},
             {"plane", {{"point", {0, 0, 0.2}}, {"normal", {0, 0, 1}}}},
             {"keep", "below"}});
  const Json cut = state();
  EXPECT_EQ(cut["model"], whole["model"]);
  EXPECT_EQ(cut["parts"][0]["loops"], 2);
  EXPECT_NE(cut["parts"][0]["mesh"], whole["parts"][0]["mesh"]);
  const Frame mesh =
      page_.frame(1, [&](const Frame& frame) { return frame.header["mesh"] == cut["parts"][0]["mesh"]; });
  double top = -1e9;
  for (std::size_t v = 0; v < mesh.numbers.at("positions").size() / 3; ++v)
    top = std::max(top, mesh.numbers.at("positions")[3 * v + 2] + mesh.header["offset"][2].get<double>());
  EXPECT_NEAR(top, 0.2, 1e-5);
  saved("cut.json");
  const EditFile edit = read_edit_file(folder_ / "cut.json");
  EXPECT_EQ(run_edit(edit).mesh.vertex_count(), whole["model"]["vertices"]) << "the model comes out";
  page_.ask({{"do", "open"}, {"path", "cut.json"}});
  EXPECT_EQ(state()["model"]["name"], "bust");
  EXPECT_EQ(state()["parts"][0]["loops"], 2);
}

TEST_F(GraftEditor, CutsTheDeformedModel) {
  page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 16}});
  const std::vector<int> top = page_.vertices([](double, double, double z) { return z > 3.7; });
  page_.ask({{"do", "paint-handle"}, {"vertices", top}, {"name", "top"}, {"reach", 2.0}});
  page_.ask({{"do", "pose"}, {"poses", {{"top", {{"translate", {1, 0, 0}}}}}}});
  const Json pose =
      page_.ask({{"do", "cut"}, {"plane", {{"point", {0.7, 0, 0}}, {"normal", {1, 0, 0}}}}, {"keep", "below"}});
  const std::vector<float> shown = page_.exact(pose["pose"]);
  EXPECT_EQ(state()["model"]["loops"], 1) << "only the deformed bar is cut there";
  EXPECT_EQ(state()["steps"].size(), 3u);
  expect_replayed(shown, page_.offset());
}

TEST_F(GraftEditor, CutsAlongAStroke) {
  page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 16}});
  std::vector<int> belt;
  for (const auto& [x, y] : {std::pair{0.5, 0.0}, {0.0, 0.5}, {-0.5, 0.0}, {0.0, -0.5}}) {
    const auto near = page_.vertices([x = x, y = y](double a, double b, double c) {
      return std::abs(a - x) < 0.08 && std::abs(b - y) < 0.08 && std::abs(c - 2) < 0.15;
    });
    ASSERT_FALSE(near.empty());
    belt.push_back(near.front());
  }
  const Json whole = state()["model"];
  page_.ask({{"do", "cut"}, {"loop", belt}, {"keep", "above"}});
  const Json above = state()["model"];
  EXPECT_EQ(above["loops"], 1);
  page_.ask({{"do", "undo"}});
  EXPECT_EQ(state()["model"], whole);
  std::reverse(belt.begin(), belt.end());
  page_.ask({{"do", "cut"}, {"loop", belt}, {"keep", "below"}});
  EXPECT_EQ(state()["model"]["vertices"], above["vertices"]) << "the same side, the other way round";
  for (const Json& request : {Json{{"do", "cut"}}, Json{{"do", "cut"}, {"loop", {1, 2}}},
                              Json{{"do", "cut"}, {"loop", {1, 2, 1 << 30}}},
                              Json{{"do", "cut"}, {"plane", {{"point", {0, 0, 9}}, {"normal", {0, 0, 1}}}}},
                              Json{{"do", "cut"}, {"loop", belt}, {"keep", "none"}}})
    EXPECT_EQ(page_.refusal(request)["code"], "input") << request;
}

}  // namespace
}  // namespace meshgraft::test
