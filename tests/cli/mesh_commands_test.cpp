#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_line.h"

namespace meshgraft::test {
namespace {

using nlohmann::json;

TEST_F(CommandLine, InfoTellsCountsLoopsAndFindings) {
  write("odd.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\n");
  const Outcome outcome = run("info odd.obj --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json facts = json::parse(outcome.out);
  EXPECT_EQ(facts["counts"]["vertices"], 4);
  EXPECT_EQ(facts["counts"]["isolated_vertices"], 1);
  EXPECT_EQ(facts["counts"]["faces"], 1);
  EXPECT_EQ(facts["boundary_loops"], json({3}));
  ASSERT_EQ(facts["loops"].size(), 1u);
  EXPECT_EQ(facts["loops"][0]["number"], 0);
  EXPECT_EQ(facts["loops"][0]["first_vertex"], 0);
  EXPECT_NEAR(facts["loops"][0]["length"].get<double>(), 2 + std::sqrt(2.0), 1e-12);
  EXPECT_EQ(facts["genus"], 0);
  EXPECT_EQ(facts["box"]["max"], json({9, 9, 9}));
  EXPECT_EQ(facts["findings"][0]["name"], "isolated-vertex");
  const Outcome text = run("info sheet.obj");
  EXPECT_EQ(text.status, 0);
  for (const char* part :
       {"64", "49 quads", "1 loop of 28 vertices", "loop 0: 28 vertices from 0, length", "diagonal"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << "\n" << text.out;
}

TEST_F(CommandLine, CutTellsComponentsAndLoops) {
  const Outcome outcome = run("cut sheet.obj --plane x=3.3 --snap 0 -o parts.ply --report parts.json --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report, json::parse(read_text(folder_ / "parts.json")));
  EXPECT_EQ(report["format"], "meshgraft-cut");
  EXPECT_EQ(report["plane"], (json{{"point", {3.3, 0, 0}}, {"normal", {1, 0, 0}}}));
  EXPECT_EQ(report["outputs"], json({"parts.ply", "parts.json"}));
  ASSERT_EQ(report["components"].size(), 2u);
  EXPECT_EQ(report["components"][0]["side"], "below");
  EXPECT_EQ(report["components"][1]["side"], "above");
  ASSERT_EQ(report["loops"].size(), 2u);
  const json loops = json::parse(run("info parts.ply --json").out)["loops"];
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(report["loops"][k]["made_by_cut"], true);
    EXPECT_EQ(report["loops"][k]["vertices"], loops[k]["vertices"]) << "numbered as info numbers them";
    EXPECT_EQ(report["components"][report["loops"][k]["component"].get<int>()]["loops"], json({k}));
  }
  const json facts = json::parse(run("info parts.ply --json").out);
  EXPECT_NE(facts["attributes"].dump().find(R"({"components":3,"domain":"vertex","name":"cut_normal")"),
            std::string::npos)
      << facts["attributes"];

  const Outcome half = run("cut sheet.obj --plane 3.3,0,0,2,0,0 --keep above -o half.obj");
  ASSERT_EQ(half.status, 0) << half.err;
  for (const char* part : {"component 0: above", "loop 0, made by the cut", "wrote half.obj"})
    EXPECT_NE(half.out.find(part), std::string::npos) << part << "\n" << half.out;
  EXPECT_EQ(json::parse(run("info half.obj --json").out)["components"], 1);
}

TEST_F(CommandLine, CutsWithCapsAndPins) {
  ASSERT_EQ(run("sample bar --resolution 12 -o bar.ply").status, 0);
  const Outcome flat = run("cut bar.ply --plane z=2.1 --cap --json -o flat.ply");
  ASSERT_EQ(flat.status, 0) << flat.err;
  EXPECT_EQ(json::parse(flat.out)["cap"], "flat");
  EXPECT_EQ(json::parse(flat.out)["loops"].size(), 0u);
  EXPECT_TRUE(json::parse(run("info flat.ply --json").out)["loops"].empty());

  const std::string pins = "cut bar.ply --plane z=2.1 --pin-diameter 0.2 --pin-count 1 --force ";
  const Outcome lower = run(pins + "--keep below -o lower.stl --json");
  ASSERT_EQ(lower.status, 0) << lower.err;
  const json report = json::parse(lower.out);
  EXPECT_EQ(report["cap"], "pins");
  ASSERT_EQ(report["pins"].size(), 1u);
  EXPECT_EQ(report["pins"][0]["diameter"], 0.2);
  EXPECT_EQ(json::parse(run(pins + "--keep above -o upper.stl --json").out)["pins"], report["pins"]);
  EXPECT_NE(run(pins + "--keep above -o upper.stl").out.find("diameter 0.2, length 0.3, clearance 0.01"),
            std::string::npos);

  const Outcome thick = run("cut bar.ply --plane z=2.1 --pin-diameter 3 -o thick.ply");
  EXPECT_EQ(thick.status, 3);
  EXPECT_NE(thick.err.find("--pin-diameter: no pin of the given size fits"), std::string::npos) << thick.err;
  const std::string cut = "cut bar.ply --plane z=2.1 -o thick.ply ";
  for (const char* option : {"--pin-length", "--pin-clearance", "--pin-diameter"}) {
    const Outcome refused = run(cut + option + "=-1");
    EXPECT_EQ(refused.status, 3) << option;
    EXPECT_NE(refused.err.find(std::string("error: ") + option + ":"), std::string::npos) << refused.err;
  }
}

TEST_F(CommandLine, CutsAlongALoop) {
  const Outcome outcome = run("cut sheet.obj --loop 18,21,44 --keep above -o patch.ply --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report["components"].size(), 1u);
  EXPECT_EQ(report["loops"].size(), 1u);
  EXPECT_LT(report["counts"]["faces"], 60);
}

TEST_F(CommandLine, CutRefusesWhatItCannotDo) {
  const auto expect = [&](const std::string& arguments, int status, const std::string& message) {
    const Outcome outcome = run("cut " + arguments);
    EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << arguments << "\n" << outcome.err;
  };
  expect("sheet.obj -o out.ply", 2, "--plane");
  expect("sheet.obj --plane x=1 --loop 1,2,3 -o out.ply", 2, "--plane");
  expect("sheet.obj --plane w=1 -o out.ply", 2, "not a");
  expect("sheet.obj --plane x=1x -o out.ply", 2, "'1x' is not a number");
  for (const std::string plane : {"1,2,3", "w=0.2", "x", "x=", "0.2"})
    expect("sheet.obj --plane " + plane + " -o out.ply", 2, "'" + plane + "' is not a plane");
  expect("sheet.obj --plane x=99 -o out.ply", 3, "Move the plane");
  expect("sheet.obj --plane x=0.5 --pin-count 1.5 -o out.ply", 2, "'1.5' is not a whole number from 1 to 32");
  expect("sheet.obj --plane x=nan -o out.ply", 2, "--plane: 'nan' is not a finite number");
  expect("sheet.obj --plane 0,0,0,0,0,0 -o out.ply", 2, "--plane: the plane's normal is zero");
  expect("sheet.obj --plane x=1e999 -o out.ply", 2, "--plane: '1e999' is too large");
  expect("sheet.obj --plane x=100 -o out.ply", 3,
         "--plane: the plane does not cut the mesh, which lies below it, 93");
  expect("sheet.obj --loop 18,21 -o out.ply", 3, "three vertices");
  expect("sheet.obj --loop 18,21,999 -o out.ply", 3, "999");
  expect("sheet.obj --loop 18,45,21,42 -o out.ply", 3, "crosses");
  expect("sheet.obj --plane x=1 --snap 0.7 -o out.ply", 2, "--snap: '0.7' is not a number from 0 to 0.5");
  expect("sheet.obj --plane x=1 --snap nan -o out.ply", 2, "--snap: 'nan' is not");
  expect("sheet.obj --plane x=3.3 -o out.xyz --report r.json", 3, "xyz");
  expect("sheet.obj --plane x=3.3 -o out.ply --report nowhere/r.json", 5, "nowhere");
  expect("sheet.obj --plane x=3.3 -o sheet.obj", 2, "--force");
  expect("sheet.obj --plane x=3.3 -o out.ply --report sheet.obj", 2, "this is an input");
  EXPECT_EQ(new_files(), std::vector<std::string>{});
  EXPECT_EQ(run("cut sheet.obj --plane x=3.3 -o sheet.obj --force").status, 0);
}

TEST_F(CommandLine, SamplesCanBeListedAndMade) {
  const json list = json::parse(run("sample --list --json").out);
  ASSERT_GE(list.size(), 5u);
  EXPECT_NE(run("sample --list").out.find(list[0]["name"].get<std::string>()), std::string::npos);
  const Outcome outcome = run("sample bar --resolution 12 -o bar.ply --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(json::parse(run("info bar.ply --json").out)["counts"]["vertices"],
            json::parse(outcome.out)["vertices"]);
}

TEST_F(CommandLine, CutTellsOfPlacesAndSizesAsTheyAre) {
  EXPECT_NE(run("cut sheet.obj --plane x=7 -o o.ply").err.find("below it, 0 to 7 away"), std::string::npos);
  std::string huge = "v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n";
  write("huge.obj", huge);
  const Outcome outcome = run("cut huge.obj --plane x=1e199 -o o.ply");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.err.find("huge.obj, vertex 1: a coordinate is as large as 1.0e+200. Scale the mesh down"),
            std::string::npos)
      << outcome.err;
}

TEST_F(CommandLine, PicturesTakeAView) {
  if (run("render --help").status != 0) GTEST_SKIP() << "built without the renderer";
  const std::string size = " --width 40 --height 30";
  const auto picture = [&](const std::string& command, const std::string& name) {
    const Outcome outcome = run(command + " --picture " + name + size);
    EXPECT_EQ(outcome.status, 0) << command << outcome.err;
    return read_text(folder_ / name);
  };
  for (const std::string& command :
       {std::string("deform edit.json -o o.ply"), std::string("cut sheet.obj --plane x=3.3 -o o.ply")})
    EXPECT_NE(picture(command, "a.png"), picture(command + " --from 0 0.1 1 --up 0 1 0", "b.png")) << command;
  write("body.obj", tube(0, true, ""));
  write("part.obj", tube(1, false, ""));
  const std::string merge = "merge body.obj part.obj --start 0:0 -o o.ply";
  EXPECT_NE(picture(merge, "a.png"), picture(merge + " --from 0 0.1 1 --up 0 1 0", "b.png"));
}

TEST_F(CommandLine, RenderNamesTheFileThatHasNoFaceToShow) {
  if (run("render --help").status != 0) GTEST_SKIP() << "built without the renderer";
  write("hollow.obj", "v nan 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome outcome = run("render sheet.obj hollow.obj -o a.png");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.err.find("hollow.obj: there is no face to make a picture of"), std::string::npos)
      << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png"));
}

// A picture shows a model as it stands, and so does that of its edit. `--up` wins.
TEST_F(CommandLine, PicturesStandAsTheModelDoes) {
  if (run("render --help").status != 0) GTEST_SKIP() << "built without the renderer";
  const auto picture = [&](const std::string& command) {
    const Outcome outcome = run(command + " --width 40 --height 30");
    EXPECT_EQ(outcome.status, 0) << command << outcome.err;
    return read_text(folder_ / "p.png");
  };
  const std::string render_as = "render as.obj -o p.png", y_up = " --up 0 1 0", z_up = " --up 0 0 1";
  write("as.obj", tube(0, true, ""));
  EXPECT_EQ(picture(render_as), picture(render_as + y_up)) << "as most programs write the format";
  EXPECT_NE(picture(render_as), picture(render_as + z_up));
  write("as.obj", "# Vertical axis: z\n" + tube(0, true, ""));
  EXPECT_EQ(picture(render_as), picture(render_as + z_up)) << "as the file says";
  ASSERT_EQ(run("sample dinosaur --resolution 24 -o d.ply").status, 0);
  ASSERT_EQ(run("cut d.ply --plane z=1.5 --keep below -o half.obj").status, 0);
  ASSERT_EQ(run("repair half.obj --fill-holes 400 -o whole.ply").status, 0);
  ASSERT_EQ(run("sample dinosaur --resolution 24 -o d.glb").status, 0);
  for (const std::string file : {"d.ply", "half.obj", "whole.ply", "d.glb"}) {
    const std::string render = "render " + file + " -o p.png";
    EXPECT_EQ(picture(render), picture(render + (file == "d.glb" ? y_up : z_up))) << file;
  }
  for (const std::string& command : {std::string("cut d.ply --plane z=1.5 -o o.ply --force"),
                                     std::string("cut half.obj --plane z=0.5 -o o.ply --force")})
    EXPECT_EQ(picture(command + " --picture p.png"), picture(command + " --picture p.png" + z_up)) << command;
}

TEST_F(CommandLine, CheckSaysInJsonWhatItPrints) {
  write("torn.obj", sheet() + "v nan 0 0\nf 1 2 65\n");
  const std::string printed = run("check torn.obj").out;
  std::string remedies;
  const json checked = json::parse(run("check torn.obj --json").out);
  for (const json& finding : checked["findings"])
    for (const char* said : {"description", "remedy"}) {
      remedies += finding[said];
      EXPECT_NE(printed.find(finding[said].get<std::string>()), std::string::npos) << finding;
    }
  EXPECT_NE(remedies.find("'meshgraft repair' removes them"), std::string::npos) << remedies;
}

TEST_F(CommandLine, ChecksAndRepairs) {
  // Adds a face of three equal corners, and two vertices without faces.
  write("damaged.obj", sheet() + "v 3 0 0.2\nv 90 90 90\nf 1 1 1\n");
  const Outcome clean = run("check sheet.obj");
  EXPECT_EQ(clean.status, 0) << clean.out << clean.err;
  EXPECT_NE(clean.out.find("polygon (info)"), std::string::npos) << "a form, and no defect";
  const Outcome dirty = run("check damaged.obj");
  EXPECT_EQ(dirty.status, 3);
  EXPECT_EQ(dirty.err, "") << "what was found is the answer, and no error";
  EXPECT_NE(dirty.out.find("degenerate-face"), std::string::npos) << dirty.out;
  EXPECT_NE(dirty.out.find("meshgraft repair damaged.obj -o damaged_repaired.obj"), std::string::npos)
      << dirty.out;
  const Outcome as_json = run("check damaged.obj --json");
  EXPECT_EQ(as_json.status, 3);
  EXPECT_EQ(json::parse(as_json.out)["format"], "meshgraft-check");
  EXPECT_EQ(run("check missing.obj").status, 5);

  EXPECT_EQ(run("repair damaged.obj").status, 2) << "no output is named";
  const Outcome dry = run("repair damaged.obj --dry-run");
  EXPECT_EQ(dry.status, 0) << dry.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "damaged_repaired.obj"));
  const Outcome repaired = run("repair damaged.obj -o damaged_repaired.obj --report repair.json");
  EXPECT_EQ(repaired.status, 0) << repaired.err;
  EXPECT_NE(repaired.out.find("wrote damaged_repaired.obj"), std::string::npos) << repaired.out;
  const json report = json::parse(read_text(folder_ / "repair.json"));
  EXPECT_EQ(report["format"], "meshgraft-repair");
  EXPECT_EQ(report["changes"].size(), 2);
  EXPECT_EQ(report["maps"]["vertices"][65], -1);
  EXPECT_EQ(run("check damaged_repaired.obj").status, 0);
  EXPECT_EQ(run("repair damaged.obj -o damaged.obj").status, 2) << "an input is not replaced";
}

TEST_F(CommandLine, PointsAloneAreNoSurface) {
  write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  const Outcome check = run("check points.obj");
  EXPECT_EQ(check.status, 3);
  EXPECT_NE(check.out.find("no faces"), std::string::npos) << check.out;
  EXPECT_EQ(json::parse(run("check points.obj --json").out)["clean"], false);
  const Outcome repaired = run("repair points.obj -o out.ply");
  EXPECT_EQ(repaired.status, 3);
  EXPECT_NE(repaired.err.find("no surface to repair"), std::string::npos) << repaired.err;
  write("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n");
  EXPECT_EQ(run("repair broken.obj -o out.ply").status, 3);
  EXPECT_EQ(run("repair broken.obj --dry-run").status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.ply"));
}

TEST_F(CommandLine, ADryRepairReportsWithoutAnOutput) {
  write("damaged.obj", sheet() + "f 1 1 1\n");
  const Outcome dry = run("repair damaged.obj --dry-run --report dry.json --picture dry.png");
  EXPECT_EQ(dry.status, 0) << dry.err;
  EXPECT_EQ(json::parse(read_text(folder_ / "dry.json"))["changes"].size(), 1);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "dry.png"));
}

TEST_F(CommandLine, VerticesWithoutAPlaceAreNamedWhereTheyMatter) {
  write("ball.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"file": "nan.off"}},
      "steps": [{"kind": "deform", "mesh": "a", "region": "all",
                 "handles": [{"name": "h", "select": {"indices": [2]}, "pose": {"translate": [1, 0, 0]}}]}]})");
  // A square of four triangles around vertex 4; its corner 2 is not finite.
  write("nan.off", "OFF 5 4 0\n0 0 0\n1 0 0\n1 nan 0\n0 1 0\n.5 .5 0\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n");
  const Outcome posed = run("deform ball.json -o out.ply");
  EXPECT_EQ(posed.status, 3);
  EXPECT_NE(posed.err.find("vertex 2"), std::string::npos) << posed.err;
  const Outcome cut = run("cut nan.off --loop 1,2,3 -o out.off");
  EXPECT_EQ(cut.status, 3);
  EXPECT_NE(cut.err.find("within reach: vertex 2"), std::string::npos) << cut.err;
  EXPECT_EQ(run("cut nan.off --loop 1,2000000000,3 -o out.off").status, 3)
      << "no such vertex, beside a bad one";
  EXPECT_NE(run("info nan.off").out.find("non-finite at vertex 2"), std::string::npos)
      << run("info nan.off").out;
}

TEST_F(CommandLine, RepairGivesACleanFileBack) {
  const Outcome outcome = run("repair sheet.obj -o same.obj");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("nothing to repair"), std::string::npos);
  EXPECT_EQ(read_text(folder_ / "same.obj"), sheet());
}

}  // namespace
}  // namespace meshgraft::test
