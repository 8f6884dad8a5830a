// Tests the editor's engine through its socket, as a page sees it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>
#include <meshgraft/script/run_edit.h>

#include "io/temporary_folder.h"
#include "page_client.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;

const Json turn = {{"rotate", {{"axis", {1, 0, 0}}, {"angle_deg", 40}}}, {"translate", {0.1, 0, 0}}};
const Json open_bar = {{"do", "open"}, {"sample", "bar"}, {"resolution", 20}};

/// Makes a handle of the bar's upper end.
Json paint_top(Page& page, const std::string& name = "top") {
  const std::vector<int> top = page.vertices([](double, double, double z) { return z > 3.7; });
  return page.ask({{"do", "paint-handle"}, {"vertices", top}, {"name", name}, {"reach", 2.0}});
}

Json pose_top(Page& page) { return page.ask({{"do", "pose"}, {"poses", {{"top", turn}}}}); }

/// Returns the coordinates that the page shows for these positions, 3 floats a vertex.
std::vector<float> as_shown(const Points& positions, const std::vector<double>& offset) {
  std::vector<float> numbers;
  for (Eigen::Index v = 0; v < positions.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      numbers.push_back(static_cast<float>(positions(v, k) - offset[static_cast<std::size_t>(k)]));
  return numbers;
}

std::string saved(Page& page, const fs::path& file) {
  page.ask({{"do", "save"}, {"edit", file.string()}, {"overwrite", true}});
  return read_file(file);
}

fs::path bar_file(const TemporaryFolder& folder) {
  write_mesh(make_sample("bar", 16), folder / "bar.ply");
  return folder / "bar.ply";
}

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
#ifdef MESHGRAFT_PROGRAM
    const std::string run = "'" MESHGRAFT_PROGRAM "' run '" + (folder / "bar.json").string() + "' -o '" +
                            (folder / "bar_run.ply").string() + "' > /dev/null";
    ASSERT_EQ(std::system(run.c_str()), 0) << settings;
    EXPECT_EQ(read_file(folder / "bar_run.ply"), read_file(folder / "bar_shown.ply")) << settings;
#endif
  }
}

TEST(Editor, WritesTheModelAsItIsWhereNothingIsDone) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const fs::path model = bar_file(folder);
  page.ask({{"do", "open"}, {"path", model.string()}});
  page.ask({{"do", "export"}, {"path", (folder / "untouched.ply").string()}});
  EXPECT_EQ(read_file(folder / "untouched.ply"), read_file(model));
  paint_top(page);
  pose_top(page);
  page.ask({{"do", "undo"}});
  page.ask({{"do", "undo"}});
  page.ask({{"do", "export"}, {"path", (folder / "undone.ply").string()}});
  EXPECT_EQ(read_file(folder / "undone.ply"), read_file(model));
}

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

TEST(Editor, AsksBeforeItReplacesAnEditThatSomethingElseWrote) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  const fs::path file = folder / "bar.json";
  Page page(editor.url()), other(editor.url());
  for (Page* one : {&page, &other}) {
    one->ask(open_bar);
    paint_top(*one);
  }
  saved(page, file);
  const Json exists = other.refusal({{"do", "save"}, {"edit", file.string()}});
  EXPECT_EQ(exists["id"], "io.file_exists");
  EXPECT_EQ(exists["fields"]["file"], file.string());
  pose_top(other);
  saved(other, file);
  const Json changed = page.refusal({{"do", "save"}});
  EXPECT_EQ(changed["id"], "editor.file_changed");
  EXPECT_EQ(changed["fields"]["file"], file.string());
  page.ask({{"do", "save"}, {"edit", file.string()}, {"overwrite", true}});
  pose_top(page);
  page.ask({{"do", "save"}});
}

TEST(Editor, OpensAModelWithOthersBeside) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const std::string file = bar_file(folder).string();
  page.ask({{"do", "open"}, {"path", file}, {"parts", {file, file}}});
  const Json state = page.ask({{"do", "state"}});
  ASSERT_EQ(state["parts"].size(), 2U);
  EXPECT_EQ(state["parts"][0]["name"], "bar 2");
  EXPECT_EQ(state["undo"], nullptr);
  EXPECT_EQ(state["dirty"], false);
  EXPECT_EQ(page.refusal({{"do", "open"}, {"path", file}, {"parts", {"/etc/passwd"}}})["code"], "input");
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

TEST(Editor, SendsTheExactFrameAloneWhereThePageShowsTheOthers) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  page.frame(3);
  const Json moved = {{"top", {{"translate", {0.3, 0, 0}}}}};
  const Json pose = page.ask({{"do", "drag"}, {"poses", moved}, {"frames", "exact"}})["pose"];
  const Frame first = page.frame(2, [&](const Frame& frame) { return frame.header["pose"] == pose; });
  EXPECT_EQ(first.header["quality"], "exact");
  EXPECT_EQ(page.refusal({{"do", "drag"}, {"poses", moved}, {"frames", "few"}})["code"], "input");
}

TEST(Editor, SendsALargeMeshInParts) {
  const TemporaryFolder folder;
  const TestMesh sheet = grid(400, 400);
  write_mesh(make_mesh(sheet.positions, sheet.triangles), folder / "large.ply");
  const Mesh mesh = read_mesh(folder / "large.ply");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", (folder / "large.ply").string()}});
  Frame frame = page.frame(1);
  EXPECT_GE(page.parts_seen(), 2u);
  EXPECT_EQ(frame.numbers["positions"], as_shown(mesh.positions, page.offset()));
  ASSERT_EQ(frame.indices["triangles"].size(), 3 * static_cast<std::size_t>(mesh.face_count()));
  EXPECT_TRUE(
      std::equal(mesh.faces.corners().begin(), mesh.faces.corners().end(), frame.indices["triangles"].begin()));
}

TEST(Editor, SendsThePicturesOfItsFoldersAlone) {
  const TemporaryFolder folder, other;
  const auto put = [](const fs::path& file, const std::string& content) { std::ofstream(file) << content; };
  put(folder / "skin.png", "picture");
  put(other / "secret.png", "secret");
  put(folder / "looks.mtl", "newmtl a\nmap_Kd skin.png\n");
  put(folder / "model.obj",
      "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "usemtl a\nf 1/1 2/2 3/3 4/4\nusemtl b\nf 1/2 3/3 2/1\n");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", (folder / "model.obj").string()}});
  Frame frame = page.frame(1);
  EXPECT_EQ(frame.bytes["picture 1"], "picture");
  EXPECT_EQ(frame.indices["pictures"], (std::vector<std::int32_t>{1, 1, 0}));
  const std::vector<float>& uv = frame.numbers["corner_uv"];
  ASSERT_EQ(uv.size(), 18u);
  for (std::size_t c = 0; c < 6; ++c) {  // the model's UVs equal its x and y
    const auto v = static_cast<std::size_t>(frame.indices["triangles"][c]);
    EXPECT_EQ(uv[2 * c], frame.numbers["positions"][3 * v] + 0.5F);
    EXPECT_EQ(uv[2 * c + 1], frame.numbers["positions"][3 * v + 1] + 0.5F);
  }
  put(folder / "away.mtl", "newmtl a\nmap_Kd " + (other / "secret.png").string() + "\n");
  put(folder / "away.obj", "mtllib away.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\n");
  EXPECT_EQ(page.refusal({{"do", "open"}, {"path", (folder / "away.obj").string()}})["code"], "input");
}

TEST(Editor, SendsTheWeightsOfTheLinearMethod) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  Frame weights = page.frame(3);
  EXPECT_EQ(weights.header["width"], 16);
  EXPECT_EQ(weights.numbers["blocks"].size(), 16 * weights.indices["vertices"].size());
}

TEST(Editor, SendsWeightsToAllCopiesOfWeldedVertices) {
  const TemporaryFolder folder;
  write_mesh(as_soup(make_sample("bar", 12)), folder / "soup.ply");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", (folder / "soup.ply").string()}});
  paint_top(page);
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  const Frame mesh = page.frame(1);
  const Frame weights = page.frame(3);
  const auto& vertices = weights.indices.at("vertices");
  const auto& rows = weights.indices.at("rows");
  ASSERT_EQ(rows.size(), vertices.size());
  const auto place = [&](std::size_t v) {
    const auto& p = mesh.numbers.at("positions");
    return std::array<float, 3>{p[3 * v], p[3 * v + 1], p[3 * v + 2]};
  };
  std::map<std::array<float, 3>, std::int32_t> row_at;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_LT(3 * static_cast<std::size_t>(rows[i]), weights.numbers.at("positions").size());
    EXPECT_EQ(row_at.try_emplace(place(static_cast<std::size_t>(vertices[i])), rows[i]).first->second, rows[i]);
  }
  EXPECT_EQ(3 * row_at.size(), weights.numbers.at("positions").size());
  const std::set<std::int32_t> moving(vertices.begin(), vertices.end());
  for (std::size_t v = 0; 3 * v < mesh.numbers.at("positions").size(); ++v)
    EXPECT_EQ(moving.count(static_cast<std::int32_t>(v)), row_at.count(place(v))) << v;
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

TEST(Editor, GoesOnOnTheAcceptedMesh) {
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
    EXPECT_EQ(page.ask({{"do", "state"}})["undo"], "paint handle");
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

TEST(Editor, OpensAnEditFileAndWhatBelongsToIt) {
  const TemporaryFolder folder;
  bar_file(folder);
  fs::create_directory(folder / "edits");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", "bar.ply"}});
  const auto model = [&] { return page.ask({{"do", "list"}, {"folder", folder.path().string()}})["files"][0]; };
  EXPECT_FALSE(model()["unsaved"]);
  paint_top(page);
  EXPECT_TRUE(model()["unsaved"]);
  const std::vector<float> shown = page.exact(pose_top(page)["pose"]);
  page.ask({{"do", "save"}, {"edit", "edits/bar.json"}});
  EXPECT_FALSE(page.ask({{"do", "state"}})["dirty"]);
  const Json listed = page.ask({{"do", "list"}, {"folder", "edits"}});
  EXPECT_EQ(listed["files"][0]["kind"], "edit");
  EXPECT_EQ(page.ask({{"do", "list"}})["folders"].size(), 1u);

  Page other(editor.url());
  other.ask({{"do", "open"}, {"path", "edits/bar.json"}});
  const Json state = other.event("state");
  EXPECT_EQ(state["handles"][0]["name"], "top");
  EXPECT_EQ(other.exact(1), shown);
}

TEST(Editor, KeepsAnUploadBesideTheEditThatNeedsIt) {
  const TemporaryFolder folder;
  const std::string model = read_file(bar_file(folder));
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const std::string name = page.upload("from_afar.ply", model);
  page.ask({{"do", "open"}, {"upload", name}});
  paint_top(page);
  const std::vector<float> shown = page.exact(pose_top(page)["pose"]);
  fs::create_directory(folder / "edits");
  page.ask({{"do", "save"}, {"edit", "edits/afar.json"}});
  EXPECT_EQ(read_file(folder.path() / "edits" / name), model);
  const EditFile edit = read_edit_file(folder.path() / "edits" / "afar.json");
  EXPECT_EQ(edit.inputs[0].file, name);
  EXPECT_EQ(shown, as_shown(run_edit(edit).mesh.positions, page.offset()));
}

TEST(Editor, RefusesWaysOutOfItsFolders) {
  const TemporaryFolder outside, folder;
  const std::string secret = outside.file("secret.ply", read_file(bar_file(outside))).string();
  bar_file(folder);
  fs::create_symlink(secret, folder / "link.ply");
  fs::create_directory_symlink(outside.path(), folder / "folder");
  fs::create_symlink(outside / "new.ply", folder / "dangling.ply");
  fs::create_symlink(outside / "new.mtl", folder / "out.mtl");
  const std::string name = outside.path().filename().string();
  folder.file("refers.obj", "mtllib ../" + name + "/secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  outside.file("secret.mtl", "newmtl a\n");
  const std::string buffer = R"("buffers":[{"byteLength":36,"uri":"../)" + name + R"(/secret.bin"}])";
  outside.file("secret.bin", std::string(36, 'x'));
  folder.file("refers.gltf", R"({"asset":{"version":"2.0"},)" + buffer + "}");
  folder.file("other_name.ply", std::string("glTF") + std::string(40, '\0'));
  folder.file("indices.txt", "0 1 2");
  const auto edit_of = [&](const std::string& file, const std::string& region) {
    return R"({"format":"meshgraft-edit","version":2,"inputs":{"m":{"file":")" + file +
           R"("}},"steps":[{"kind":"deform","mesh":"m","region":)" + region + "}]}";
  };
  folder.file("input.json", edit_of("../" + name + "/secret.ply", "\"all\""));
  folder.file("selection.json",
              edit_of("bar.ply", R"({"file":")" + (outside / "indices.txt").string() + "\"}"));
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  for (const std::string& path :
       {secret, "../" + name + "/secret.ply", std::string("link.ply"), std::string("folder/secret.ply"),
        std::string("/etc/passwd"), std::string("refers.obj"), std::string("refers.gltf"),
        std::string("other_name.ply"), std::string("input.json"), std::string("selection.json")})
    EXPECT_EQ(page.refusal({{"do", "open"}, {"path", path}})["code"], "input") << path;
  EXPECT_EQ(page.refusal({{"do", "open"}, {"upload", "../../etc/passwd"}})["code"], "io");
  for (const char* path : {"..", "folder", "/", "/etc"})
    EXPECT_EQ(page.refusal({{"do", "list"}, {"folder", path}})["code"], "input") << path;

  page.ask(open_bar);
  paint_top(page);
  for (const std::string& path : {secret, std::string("../new.ply"), std::string("dangling.ply"),
                                  std::string("folder/new.ply"), std::string("out.obj")}) {
    EXPECT_EQ(page.refusal({{"do", "save"}, {"mesh", path}, {"overwrite", true}})["code"], "input") << path;
    EXPECT_EQ(page.refusal({{"do", "export"}, {"path", path}, {"overwrite", true}})["code"], "input") << path;
  }
  for (const char* path : {"../new.json", "folder/new.json"})
    EXPECT_EQ(page.refusal({{"do", "save"}, {"edit", path}})["code"], "input") << path;
  EXPECT_EQ(page.refusal({{"do", "save"}, {"edit", "bar.sh"}})["code"], "input");
  const Json elsewhere = {{"file", (outside / "indices.txt").string()}};
  EXPECT_EQ(page.refusal({{"do", "region"}, {"select", elsewhere}})["code"], "input");
  EXPECT_EQ(page.refusal({{"do", "select"}, {"how", "set"}, {"what", elsewhere}})["code"], "input");
  const Json def = {{"top", {{"def", (outside / "pose.def").string()}}}};
  EXPECT_EQ(page.refusal({{"do", "pose"}, {"poses", def}})["code"], "input");
  EXPECT_EQ(page.refusal({{"do", "drag"}, {"poses", def}})["code"], "input");
  page.ask({{"do", "select"}, {"how", "set"}, {"what", {{"file", "indices.txt"}}}});
  EXPECT_EQ(outside.entry_count(), 4u) << "nothing was written";
}

TEST(Editor, ReplacesNothingUnasked) {
  const TemporaryFolder folder;
  bar_file(folder);
  folder.file("there.ply", "x");
  folder.file("there.json", "x");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", "bar.ply"}});
  paint_top(page);
  EXPECT_EQ(page.refusal({{"do", "save"}, {"mesh", "there.ply"}})["code"], "io");
  EXPECT_EQ(page.refusal({{"do", "save"}, {"edit", "there.json"}})["code"], "io");
  EXPECT_EQ(page.refusal({{"do", "save"}, {"mesh", "bar.ply"}, {"overwrite", true}})["code"], "usage");
  EXPECT_EQ(page.refusal({{"do", "save"}})["code"], "input");
}

TEST(Editor, WritesNothingWhereItWouldBeLost) {
  const RunningEditor editor(std::vector<fs::path>{});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  EXPECT_EQ(page.refusal({{"do", "save"}, {"edit", "bar.json"}})["code"], "usage");
  EXPECT_EQ(page.refusal({{"do", "export"}, {"path", "bar.ply"}})["code"], "usage");
}

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
