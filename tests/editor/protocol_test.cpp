// Sends every request that a page may send, and checks the messages against their schema.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <sys/wait.h>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>

#include "core/facts.h"
#include "editor/document.h"
#include "io/temporary_folder.h"
#include "page_client.h"
#include "support/defects.h"
#include "support/mesh_families.h"
#include "support/paths.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;

void ask_all_of_deforming(Page& page, const fs::path& model) {
  const Json turn = {{"rotate", {{"axis", {1, 0, 0}}, {"angle_deg", 40}}}, {"translate", {0.1, 0, 0}}};
  page.ask({{"do", "list"}});
  page.ask({{"do", "add-folder"}, {"path", model.parent_path().string()}});
  page.ask({{"do", "list"}, {"folder", model.parent_path().string()}, {"deep", true}});
  page.ask({{"do", "open"}, {"path", model.string()}});
  page.ask({{"do", "select"}, {"how", "set"}, {"what", {{"flood", {{"vertex", 0}, {"angle_deg", 30}}}}}});
  page.ask({{"do", "select"}, {"how", "grow"}, {"rings", 1}});
  page.ask({{"do", "select"}, {"how", "invert"}});
  page.ask({{"do", "group"}, {"name", "rest"}, {"colour", "#ff8800"}});
  page.ask({{"do", "group"}, {"name", "rest"}, {"remove", true}});
  const std::vector<int> top = page.vertices([](double, double, double z) { return z > 3.7; });
  page.ask({{"do", "paint-handle"}, {"vertices", top}, {"name", "top"}, {"reach", 2.0}});
  page.ask({{"do", "reach"}, {"handle", "top"}, {"reach", 1.5}});
  page.ask({{"do", "fixed"}, {"select", {{"half_space", {{"point", {0, 0, 2.5}}, {"normal", {0, 0, -1}}}}}}});
  page.ask({{"do", "fixed"}, {"rim", true}});
  page.ask({{"do", "region"}, {"select", {{"half_space", {{"point", {0, 0, 2}}, {"normal", {0, 0, 1}}}}}}});
  page.ask({{"do", "undo"}});
  page.ask({{"do", "drag"}, {"poses", {{"top", turn}}}});
  page.exact(page.ask({{"do", "pose"}, {"poses", {{"top", turn}}}})["pose"]);
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  page.frame(3);
  page.ask({{"do", "handle"}, {"what", "rename"}, {"name", "top"}, {"to", "end"}});
  page.ask({{"do", "symmetry"}});
  page.ask({{"do", "symmetry"}, {"plane", nullptr}});
  page.ask({{"do", "step"}, {"what", "change"}, {"index", 0}, {"fields", {{"about", "bent"}}}});
  page.ask({{"do", "step"}, {"what", "rename"}, {"index", 0}, {"name", "bend"}});
  page.ask({{"do", "save"}, {"edit", "bar.json"}, {"mesh", "out.obj"}});
  page.ask({{"do", "export"}, {"path", "out.glb"}, {"as", "morph-target"}, {"name", "bent"}});
  page.ask({{"do", "accept"}});
  page.ask({{"do", "step"}, {"what", "remove"}, {"index", 1}});
  page.ask({{"do", "undo"}});
  for (const char* what : {"undo", "redo", "reset", "state"}) page.ask({{"do", what}});
}

void ask_all_of_mending(Page& page, const fs::path& folder) {
  const TestMesh ball = bumpy_sphere(2);
  write_mesh(with_isolated(make_mesh(ball.positions, ball.triangles), 3, 1), folder / "scan.ply");
  page.ask({{"do", "open"}, {"path", (folder / "scan.ply").string()}});
  page.ask({{"do", "mark"}, {"finding", "isolated-vertex"}});
  page.ask({{"do", "repair"}, {"kinds", {"isolated-vertex"}}});
  page.ask({{"do", "undo"}});
  page.ask({{"do", "repair"}});
}

void ask_all_of_printing(Page& page) {
  page.ask({{"do", "open"}, {"sample", "bust"}, {"resolution", 20}});
  page.ask({{"do", "print-check"}, {"up", {0, 0, 1}}, {"overhang_deg", 30}, {"least_wall", 0.1}});
  page.ask({{"do", "mark"}, {"print", "open-edges"}});
  page.ask({{"do", "repair"}, {"holes", true}});
  page.ask({{"do", "print-check"}});
  page.ask({{"do", "transform"}, {"pose", {{"scale", 2}}}});
  page.ask({{"do", "sculpt"}, {"action", "smooth"}, {"select", "all"}, {"strength", 0.2}});
  page.ask({{"do", "sculpt"}, {"action", "flatten"}, {"select", {{"nearest", {0, 0, 0}}}}, {"reach", 0.5}});
}

void ask_all_of_grafting(Page& page) {
  const Json loop = {{"loop", 0}};
  page.ask({{"do", "open"}, {"sample", "bust"}, {"resolution", 24}});
  page.ask({{"do", "part"}, {"what", "add"}, {"sample", "head"}, {"resolution", 20}, {"name", "face"}});
  page.ask({{"do", "part"}, {"what", "add"}, {"sample", "bar"}, {"resolution", 8}});
  page.ask({{"do", "part"}, {"what", "edit"}, {"name", "bar"}});
  page.ask({{"do", "part"}, {"what", "edit"}, {"name", "bust"}});
  page.ask({{"do", "part"}, {"what", "remove"}, {"name", "bar"}});
  page.ask({{"do", "loops"}, {"mesh", "face"}});
  page.ask({{"do", "select"}, {"mesh", "face"}, {"how", "set"}, {"what", loop}});
  page.ask({{"do", "cut"},
            {"mesh", "face"},
            {"plane", {{"point", {0, 0, -0.3}}, {"normal", {0, 0, 1}}}},
            {"keep", "above"},
            {"snap", 0.2}});
  const auto told = [&](const Json& request) {
    const Json number = page.ask(request)["graft"];
    return page.event("graft", [&](const Json& event) { return event["graft"] >= number; });
  };
  EXPECT_TRUE(told({{"do", "graft"}, {"source", "face"}, {"target", "bust"}}).contains("seam"));
  EXPECT_TRUE(
      told({{"do", "graft"}, {"pairs", {{{"source_loop", loop}, {"target_loop", loop}}}}, {"size", 0.9}})
          .contains("pairs"));
  EXPECT_TRUE(told({{"do", "graft"}, {"what", "swap"}}).contains("transform"));
  page.ask({{"do", "graft"}, {"what", "swap"}});
  EXPECT_EQ(told({{"do", "graft-drag"}, {"normal_angle_deg", 20}})["dragged"], true);
  EXPECT_TRUE(told({{"do", "graft-drag"}, {"pairs", nullptr}, {"at", {{"point", {9, 9, 9}}, {"spin_deg", 5}}}})
                  .contains("error"));
  page.ask({{"do", "state"}});
  page.ask({{"do", "graft"}, {"what", "cancel"}});
  page.ask({{"do", "graft"}, {"source", "face"}});
  page.ask({{"do", "accept"}});
  page.ask({{"do", "graft"}, {"what", "resume"}});
  page.ask({{"do", "state"}});
  page.ask({{"do", "accept"}});
  page.ask({{"do", "cut"}, {"plane", {{"point", {0, 0, 0.2}}, {"normal", {0, 0, 1}}}}, {"halves", true}});
  page.ask({{"do", "export"}, {"path", "half.ply"}, {"mesh", "bust 2"}, {"overwrite", true}});
  page.reply_to(page.send({{"do", "thumbnail"}, {"mesh", "face"}, {"size", 32}}));  // refused without renderer
}

TEST(Protocol, TakesLocationsApart) {
  const Location edit = Location::file("edit");
  const auto step = [&](std::size_t number) { return (edit / "steps")[number]; };
  const auto parts = [](const Location& location) {
    const editor::ErrorLocation found = editor::parts_of_location(location);
    return std::pair(found.step ? static_cast<int>(*found.step) : -1, found.rest);
  };
  const Location pair = (step(0) / "pairs")[1] / "source_loop";
  EXPECT_EQ(parts((step(12) / "handles")[0] / "pose"), std::pair(12, std::string("handles[0].pose")));
  EXPECT_EQ(parts(pair), std::pair(0, std::string("pairs[1].source_loop")));
  EXPECT_EQ(parts(step(3)), std::pair(3, std::string()));
  EXPECT_EQ(parts(edit / "selections" / "ear"), std::pair(-1, std::string("selections.ear")));
  EXPECT_EQ(parts(edit), std::pair(-1, std::string()));
  EXPECT_EQ(parts(Location::file("/models/steps[1].ply")), std::pair(-1, std::string("/models/steps[1].ply")));
  const Location line = Location::file("/models/a.ply") / Location::place("line 3");
  EXPECT_EQ(editor::parts_of_location(line).file, "/models/a.ply, line 3");
  EXPECT_EQ(editor::parts_of_location(edit / "inputs" / "a" / line).file, "/models/a.ply, line 3");
  EXPECT_FALSE(editor::parts_of_location("select").file);
  EXPECT_EQ(editor::parts_of_location(pair).pair, 1u);
  for (const std::string name : {"it's", "': pairs[3]"})
    EXPECT_EQ(editor::parts_of_location(step(0) / Location::handle(name) / "pose").handle, name);
}

TEST(Protocol, NamesHandlesAndFilesWhereErrorsLie) {
  const Json document = {{"steps", {{{"handles", {{{"name", "a"}}, {{"name", "nose"}}}}}}}};
  const Location edit = Location::file("edit"), step = (edit / "steps")[0];
  const Error numbered(facts::core::NoFaces{}, (step / "handles")[1] / "pose" / "axis");
  EXPECT_EQ(editor::with_handle_name(numbered, document).location(),
            step / Location::handle("nose") / "pose" / "axis");
  for (const Location& location :
       {(step / "handles")[7], ((edit / "steps")[2] / "handles")[0], step, Location("select")})
    EXPECT_EQ(editor::with_handle_name(numbered.at(location), document).location(), location);
  EXPECT_EQ(editor::in_file(numbered, "/m/e.json").location().text(),
            "/m/e.json: steps[0].handles[1].pose.axis");
  const Location other = Location::file("/m/a.ply");
  EXPECT_EQ(editor::in_file(numbered.at(other), "/m/e.json").location(), other);
}

TEST(Protocol, IsSpokenAsItsSchemaSays) {
  const TemporaryFolder folder;
  const fs::path model = folder / "bar.ply";
  write_mesh(make_sample("bar", 16), model);
  const RunningEditor editor({folder.path()}, {model});
  Page page(editor.url());
  page.event("welcome");
  ask_all_of_deforming(page, model);
  ask_all_of_grafting(page);
  ask_all_of_mending(page, folder.path());
  ask_all_of_printing(page);
  page.ask({{"do", "cancel"}});
  page.refusal({{"do", "restore"}});
  page.refusal({{"do", "discard"}});
  page.refusal({{"do", "done"}});
  const fs::path file = folder.file("conversation.jsonl", page.conversation());
  const std::string command = std::string(python()) + " " +
                              source_path("tests/editor/protocol_schema_test.py").string() + " " +
                              source_path("").string() + " " + file.string();
  const int status = std::system(command.c_str());
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "python3-jsonschema is missing";
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace meshgraft::test
