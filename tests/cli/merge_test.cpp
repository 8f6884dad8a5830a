#include <cmath>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <meshgraft/script/edit_file.h>
#include <nlohmann/json.hpp>

#include "command_line.h"

namespace meshgraft::test {
namespace {

using nlohmann::json;

TEST_F(CommandLine, RefusesMergesThatMakeNoSense) {
  const std::vector<std::tuple<std::string, int, std::string>> cases = {
      {"merge sheet.obj -o o.ply", 2, "the source is missing"},
      {"merge edit.json -o o.ply --start 1:2", 2, "--start goes with TARGET and SOURCE"},
      {"merge sheet.obj sheet.obj -o o.ply --start 1-2", 2, "--start: '1-2' is not TARGET:SOURCE"},
      {"merge sheet.obj sheet.obj -o o.ply --upright z,-y", 2, "--upright: 'z,-y' is not UP,FRONT:UP,FRONT"},
      {"merge sheet.obj sheet.obj -o o.ply --upright z,-y:z,-z", 2, "Give two different axes"},
      {"loops sheet.obj --starts", 2, "--starts and a source go together"},
      {"loops sheet.obj sheet.obj", 2, "--starts and a source go together"},
      {"loops sheet.obj sheet.obj --starts --pair 0:4", 3, "loop 4 does not exist; the mesh has 1 loop"},
      {"merge sheet.obj sheet.obj -o o.ply --spin 30", 2, "--spin goes with --at"},
      {"merge sheet.obj sheet.obj -o o.ply --base-height 1", 2, "--base-height goes with --at"},
      {"merge sheet.obj sheet.obj -o o.ply --base-tilt 5", 2, "--base-tilt goes with --at"},
      {"merge sheet.obj sheet.obj -o o.ply --at 1 --base-tilt 5,w", 2, "--base-tilt: '5,w' is not a tilt"},
      {"merge sheet.obj sheet.obj -o o.ply --at 1 --base-height 0", 2,
       "--base-height: '0' is not a positive number"},
      {"merge sheet.obj sheet.obj -o o.ply --at 1 --base-height 1 --source-loop 0", 3,
       "goes with a source that is opened"},
      {"merge sheet.obj sheet.obj -o o.ply --pose keep --fix all", 2, "--fix: 'all' is not a selection"},
      {"merge sheet.obj sheet.obj -o o.ply --pose keep --fix loop:0,7", 2, "--fix: '0,7' is not"},
      {"merge sheet.obj sheet.obj -o o.ply --fix loop:0", 2, "--fix goes with --pose keep: nothing stays"},
      {"merge sheet.obj sheet.obj -o o.ply --pose keep --size 2", 2, "--size goes without --pose keep"},
      {"merge sheet.obj sheet.obj -o o.ply --at 1 --pair 0:0", 2, "--at goes without --pair"},
      {"merge sheet.obj sheet.obj -o o.ply --align 1:2", 2, "--align is given 1 time"},
      {"merge sheet.obj sheet.obj -o o.ply --pair 3:0", 3, "error: --pair 3:0: "},
      {"merge sheet.obj sheet.obj -o o.ply --pair 0:1 --pair 0:2", 3,
       "error: --pair 0:2: the target's loop 0 is in --pair 0:1, too. Use each loop once: the target has only "
       "loop 0, the source only loop 0."},
      {"merge sheet.obj sheet.obj -o o.ply --pair 0:1 --pair 2:1", 3,
       "error: --pair 2:1: the source's loop 1 is in --pair 0:1, too. Use each loop once: "},
      {"merge sheet.obj sheet.obj -o o.ply --pair 0:0 --pair 0:0", 3,
       "error: --pair 0:0: this is given twice. Leave one of them out, or use other loops: the target has "
       "only"},
      {"merge sheet.obj sheet.obj -o o.ply --start 0:0 --match 9:1", 3,
       "error: --match 9:1: vertex 9 is not on"},
      {"merge sheet.obj sheet.obj -o o.ply --start 0:0 --align 0:0 --align 1:1 --align 999:2", 3,
       "error: --align 999:2: target vertex 999 does not exist; the mesh has 64"},
      {"merge sheet.obj gone.obj -o o.ply", 5, "error: gone.obj: "},
      {"merge sheet.obj sheet.obj -o o.ply --size nan", 2, "--size: 'nan' is not a positive number"},
      {"merge sheet.obj sheet.obj -o o.ply --size -1", 2, "--size: '-1' is not a positive number"},
      {"merge sheet.obj sheet.obj -o o.ply --size big", 2, "--size: 'big' is not a positive number"},
      {"merge sheet.obj sheet.obj -o o.ply --normal-angle inf", 2,
       "--normal-angle: 'inf' is not a number from -180"},
      {"merge sheet.obj sheet.obj -o o.ply --at 1 --spin nan", 2, "--spin: 'nan' is not a finite number"},
      {"merge sheet.obj sheet.obj -o o.ply --at 1,nan,0", 2, "--at: 'nan' is not a finite number"},
      {"merge sheet.obj sheet.obj -o o.ply --reach nan", 2, "--reach: 'nan' is not a finite number"},
      {"merge sheet.obj sheet.obj -o o.ply --reach -2", 2, "--reach: '-2' is neither"},
      {"merge sheet.obj sheet.obj -o o.ply --reach 0rings", 2, "--reach: '0rings' is neither"},
      {"merge sheet.obj sheet.obj -o o.ply --reach 5ringworm", 2, "--reach: '5ringworm' is not"},
      {"merge sheet.obj sheet.obj -o o.ply --band 1.5", 2, "--band: '1.5' is not a whole number from 0 to 100"},
      {"merge sheet.obj sheet.obj -o o.ply --mirror 0,0,0,0,0,0", 2, "--mirror: the plane's normal is zero"},
      {"merge edit.json sheet.obj -o o.ply", 2, "edit.json: an edit file takes no SOURCE"},
      {"merge sheet.obj sheet.obj -o o.ply --report ./o.ply", 2, "./o.ply: two outputs have this name"},
      {"merge sheet.obj sheet.obj -o o.ply --report r.json --save-edit ./r.json", 2,
       "two outputs have this name"},
      {"merge sheet.obj sheet.obj -o o.obj --report o.mtl", 2, "o.mtl: this name is kept for the materials"},
      {"merge sheet.obj sheet.obj -o o.ply --match 0:9", 3, "vertex 9 is not on a boundary of the source"},
      {"merge sheet.obj sheet.obj -o sheet.obj", 2, "this is an input"},
  };
  for (const auto& [arguments, status, words] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, status) << arguments;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << arguments << "\n" << outcome.err;
    EXPECT_EQ(new_files(), std::vector<std::string>()) << arguments;
  }
}

TEST_F(CommandLine, AMergedObjDefinesTheMaterialsOfBoth) {
  for (const char* sub : {"a", "b", "out"}) std::filesystem::create_directory(folder_ / sub);
  write("a/body.obj", tube(0, true, "body.mtl"));
  write("a/body.mtl", "newmtl skin\nKd 1 0 0\nmap_Kd tex.png\n");
  write("a/tex.png", "a picture");
  write("b/part.obj", tube(1, false, "part.mtl"));
  write("b/part.mtl", "newmtl skin\nKd 0 1 0\nmap_Kd tex.png\n");
  const std::string merge = "merge a/body.obj b/part.obj --start 0:0 -o ";
  const Outcome outcome = run(merge + "out/whole.obj --report out/r.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = json::parse(read_text(folder_ / "out/r.json"));
  EXPECT_EQ(report["outputs"], json({"out/whole.obj", "out/whole.mtl", "out/r.json"}));
  EXPECT_EQ(report["notes"], json::array());
  const std::string library = read_text(folder_ / "out/whole.mtl");
  EXPECT_NE(library.find("newmtl skin\nKd 1 0 0\nmap_Kd ../a/tex.png\n"), std::string::npos) << library;
  EXPECT_NE(library.find("newmtl skin_2\nKd 0 1 0\nmap_Kd ../b/tex.png\n"), std::string::npos) << library;
  const std::string whole = read_text(folder_ / "out/whole.obj");
  for (const char* line :
       {"\nmtllib whole.mtl\n", "\nusemtl skin\n", "\nusemtl skin_2\n", "\ng seam\n", "\nvt 1 1\n"})
    EXPECT_NE(whole.find(line), std::string::npos) << line;

  // PLY has no materials, so a note names the lost library.
  const Outcome ply = run(merge + "out/whole.ply --json");
  ASSERT_EQ(ply.status, 0) << ply.err;
  EXPECT_NE(json::parse(ply.out)["notes"].dump().find("body.mtl"), std::string::npos) << ply.out.substr(0, 400);

  // Files of an input are not written over.
  for (const char* output : {"a/body.mtl", "a/tex.png", "b/../a/tex.png"}) {
    const Outcome refused = run(merge + "out/other.ply --save-edit " + output);
    EXPECT_EQ(refused.status, 2) << output;
    EXPECT_NE(refused.err.find("this belongs to the input"), std::string::npos) << refused.err;
  }
  EXPECT_EQ(read_text(folder_ / "a/tex.png"), "a picture");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/other.ply"));
  ASSERT_EQ(run(merge + "a/body.obj --force").status, 0);
  EXPECT_EQ(read_text(folder_ / "a/body.mtl"), "newmtl skin\nKd 1 0 0\nmap_Kd tex.png\n");
  EXPECT_NE(read_text(folder_ / "a/body.obj").find("mtllib body_2.mtl"), std::string::npos);
}

TEST_F(CommandLine, TexturesInTheCurrentFolderAreNamedFromTheOutputsFolder) {
  for (const auto& [name, texture, z] : {std::tuple{"red", "r.png", 0}, {"green", "g.png", 1}}) {
    const std::string file = name;
    write(file + ".obj", tube(z, z == 0, (file + ".mtl").c_str()));
    write(file + ".mtl", std::string("newmtl skin\nmap_Kd ") + texture + "\n");
    write(texture, "a picture");
  }
  std::filesystem::create_directory(folder_ / "d");
  for (const auto& [output, from] : {std::pair<std::string, std::string>{"d/q", "../"}, {"q", ""}}) {
    const Outcome outcome = run("merge red.obj green.obj --start 0:0 -o " + output + ".obj");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string library = read_text(folder_ / (output + ".mtl"));
    for (const std::string texture : {"r.png", "g.png"})
      EXPECT_NE(library.find("map_Kd " + from + texture + "\n"), std::string::npos) << library;
  }
}

TEST_F(CommandLine, MergesAsPublishedAndSavesAnEditThatDoes) {
  write("body.obj", tube(0, true, ""));
  write("part.obj", tube(1, false, ""));
  const std::string merge = "merge body.obj part.obj --start 0:0 --as-published -o ";
  const Outcome outcome = run(merge + "whole.ply --save-edit graft.json --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json settings = json::parse(outcome.out)["steps"][0]["settings"];
  EXPECT_EQ(settings["preset"], "as-published");
  EXPECT_EQ(settings["fairing_method"], "umbrella");
  const json saved = json::parse(read_text(folder_ / "graft.json"));
  EXPECT_EQ(saved["made_with"]["methods"], current_methods);
  EXPECT_EQ(saved["steps"][0]["shape"], "ft05");
  EXPECT_EQ(saved["steps"][0]["settings"]["preset"], "as-published");
  ASSERT_EQ(run("merge graft.json -o again.ply").status, 0);
  EXPECT_EQ(read_text(folder_ / "again.ply"), read_text(folder_ / "whole.ply"));

  // Other options win, and the preset can be asked of a file that does not have it.
  ASSERT_EQ(run(merge + "other.ply --strip optimal --band 1 --save-edit other.json").status, 0);
  const json other = json::parse(read_text(folder_ / "other.json"))["steps"][0]["settings"];
  EXPECT_EQ(other["strip"], "optimal");
  EXPECT_EQ(other["band"], 1);
  ASSERT_EQ(run("merge body.obj part.obj --start 0:0 -o default.ply --save-edit default.json").status, 0);
  EXPECT_NE(read_text(folder_ / "default.ply"), read_text(folder_ / "whole.ply"));
  ASSERT_EQ(run("merge default.json --as-published -o asked.ply").status, 0);
  EXPECT_EQ(read_text(folder_ / "asked.ply"), read_text(folder_ / "whole.ply"));
}

TEST_F(CommandLine, MergesColoursWithMaterials) {
  std::string coloured = tube(0, true, "");
  for (std::size_t v = coloured.find("v "); v != std::string::npos; v = coloured.find("\nv ", v + 1))
    coloured.insert(coloured.find('\n', v + 1), " 1 0.5 0.25");
  write("body.obj", coloured);
  write("part.obj", tube(1, false, "part.mtl"));
  write("part.mtl", "newmtl skin\nKd 0 1 0\n");
  ASSERT_EQ(run("cut body.obj --plane z=-1.2 --keep above -o body.ply --snap 0").status, 0);
  const Outcome info = run("info body.ply --json");
  const json body = json::parse(info.out);
  // The rim at the top is the loop with its middle at z = 0.
  const int rim = std::abs(body["loops"][0]["centre"][2].get<double>()) < 0.1 ? 0 : 1;
  const Outcome outcome = run("merge body.ply part.obj -o whole.obj --json --start " +
                              std::to_string(body["loops"][rim]["first_vertex"].get<int>()) + ":0");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string whole = read_text(folder_ / "whole.obj");
  EXPECT_NE(whole.find(" 1 0.5"), std::string::npos) << "the colours of the target";
  EXPECT_NE(whole.find("usemtl skin\n"), std::string::npos);
  EXPECT_NE(whole.find("mtllib part.mtl\n"), std::string::npos);
  EXPECT_NE(whole.find("vt 1 1\n"), std::string::npos);
}

TEST_F(CommandLine, TurnsTheHeadTheWayTheBustFaces) {
  ASSERT_EQ(run("sample bust --resolution 40 -o bust.ply").status, 0);
  ASSERT_EQ(run("sample head --resolution 50 -o head.ply").status, 0);
  const json starts = json::parse(run("loops bust.ply head.ply --starts --json").out)["pairs"][0]["starts"];
  ASSERT_GE(starts.size(), 2U);
  EXPECT_GT(starts[0]["probability"], 0.6);
  EXPECT_NE(run("loops bust.ply head.ply --starts").out.find("(turned by"), std::string::npos);

  const Outcome outcome = run("merge bust.ply head.ply -o whole.ply --report found.json --save-edit e.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find(" % probable)"), std::string::npos) << outcome.out;
  const auto turn_of = [&](const std::string& report) {
    const json rotation =
        json::parse(read_text(folder_ / report))["steps"][0]["part"]["similarity"]["rotation"];
    return rotation[0][0].get<double>() + rotation[1][1].get<double>() + rotation[2][2].get<double>();
  };
  EXPECT_GT(turn_of("found.json"), 2.7);  // both files face the same way

  // The start that the report names gives the same bytes; what is known of the models turns the head.
  const std::string given =
      std::to_string(starts[0]["target"].get<int>()) + ":" + std::to_string(starts[0]["source"].get<int>());
  ASSERT_EQ(run("merge bust.ply head.ply -o again.ply --start " + given).status, 0);
  EXPECT_EQ(read_text(folder_ / "again.ply"), read_text(folder_ / "whole.ply"));
  ASSERT_EQ(run("merge bust.ply head.ply -o back.ply --upright z,-y:z,y --report back.json").status, 0);
  EXPECT_LT(turn_of("back.json"), -0.7);
}

TEST_F(CommandLine, OffersToSmoothARaggedLoop) {
  std::string ragged = tube(0, true, "");
  std::size_t line = 0;
  for (int v = 0; v < 12; ++v) {  // lowers every other vertex of the rim
    const std::size_t end = ragged.find('\n', line), z = ragged.rfind(' ', end);
    if (v % 2 == 0) ragged.replace(z, end - z, " -0.3");
    line = ragged.find('\n', line) + 1;
  }
  write("body.obj", ragged);
  write("part.obj", tube(1, false, ""));
  const Outcome plain = run("merge body.obj part.obj --start 0:0 -o o.ply");
  ASSERT_EQ(plain.status, 0) << plain.err;
  EXPECT_NE(plain.out.find("is ragged"), std::string::npos) << plain.out;
  EXPECT_NE(plain.out.find("--smooth-boundary smooths it first"), std::string::npos) << plain.out;
  const Outcome smooth = run("merge body.obj part.obj --start 0:0 -o o.ply --smooth-boundary");
  ASSERT_EQ(smooth.status, 0) << smooth.err;
  EXPECT_EQ(smooth.out.find("is ragged"), std::string::npos) << smooth.out;
}

TEST_F(CommandLine, SaysWhyALoopCannotBeMerged) {
  write("body.obj", tube(0, true, ""));
  write("three.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
  write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  std::string band;
  constexpr int around = 16;
  for (int i = 0; i < around; ++i)
    for (const double side : {-0.3, 0.3}) {
      const double angle = 2 * 3.14159265358979 * i / around, r = 1 + side * std::cos(angle / 2);
      band += "v " + std::to_string(r * std::cos(angle)) + " " + std::to_string(r * std::sin(angle)) + " " +
              std::to_string(side * std::sin(angle / 2)) + "\n";
    }
  for (int i = 0; i < around; ++i) {
    const int p = 2 * i + 1, r = i + 1 < around ? p + 2 : 2, s = i + 1 < around ? p + 3 : 1;
    band += "f " + std::to_string(p) + " " + std::to_string(r) + " " + std::to_string(p + 1) + "\nf " +
            std::to_string(p + 1) + " " + std::to_string(r) + " " + std::to_string(s) + "\n";
  }
  write("moebius.obj", band);
  const auto says = [&](const std::string& command, const std::string& words) {
    const Outcome outcome = run(command);
    EXPECT_NE((outcome.out + outcome.err).find(words), std::string::npos) << command << "\n"
                                                                          << outcome.out << outcome.err;
  };
  const std::string merge = "merge body.obj ", to = " -o o.ply";
  says(merge + "three.obj" + to,
       "loop 0 of the source (three.obj) cannot be merged: 1 edge has more than two faces, on the loop, "
       "first at vertices 0, 1. Take faces away");
  says("merge moebius.obj body.obj" + to,
       "loop 0 of the target (moebius.obj) cannot be merged: 1 edge has two faces that are oriented "
       "inconsistently, on the loop, first at vertices 0, 1. Make the faces' orientation consistent");
  says(merge + "points.obj" + to, "the source (points.obj) has no faces. Export it");
  says("cut points.obj --plane x=0.5" + to, "the mesh has no faces");
  says("info points.obj", "none, there are no faces");
  says("info moebius.obj", "inconsistent-winding at vertex 0");
  says("info three.obj", "non-manifold-edge at vertex 0");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "o.ply"));
}

TEST_F(CommandLine, DropsAPartOnAClosedSurface) {
  ASSERT_EQ(run("sample bar --resolution 12 -o bar.ply").status, 0);
  ASSERT_EQ(run("sample head --resolution 40 -o head.ply").status, 0);
  const std::string drop = "merge bar.ply head.ply -o whole.ply --at ";
  EXPECT_EQ(run(drop + "9,0,0").status, 3);
  EXPECT_EQ(run(drop + "0.5,0,2 --pose keep").status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "whole.ply"));
  const Outcome outcome = run(drop + "0.5,0,2 --spin 30 --source-loop 0");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Outcome info = run("info whole.ply");
  EXPECT_NE(info.out.find("closed"), std::string::npos) << info.out;
}

TEST_F(CommandLine, OpensAClosedPartWhereItStands) {
  ASSERT_EQ(run("sample bar --resolution 12 -o bar.ply").status, 0);
  ASSERT_EQ(run("sample cactus --resolution 24 -o cactus.ply").status, 0);
  const std::string drop =
      "merge bar.ply cactus.ply -o whole.ply --force --report r.json --at 0.5,0,2 --size 0.3 ";
  const auto base = [&](const std::string& options) {
    const Outcome outcome = run(drop + options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("a plane opened the source at 1 loop"), std::string::npos) << outcome.out;
    return json::parse(read_text(folder_ / "r.json"))["steps"][0]["base"];
  };
  const json found = base("");
  EXPECT_EQ(found["loops"], 1);
  EXPECT_GT(found["normal"][2], 0.99);
  const json higher = base("--base-height 0.3 --base-tilt 10,y --save-edit again.json");
  EXPECT_EQ(higher["height"], 0.3);
  EXPECT_GT(higher["cut_away"], found["cut_away"]);
  EXPECT_NEAR(higher["normal"][0].get<double>(), std::sin(10 * M_PI / 180), 0.01);
  EXPECT_NE(run("info whole.ply").out.find("closed"), std::string::npos);
  // The edit file that was saved repeats the command.
  ASSERT_EQ(run("merge again.json -o again.ply").status, 0);
  EXPECT_EQ(read_text(folder_ / "again.ply"), read_text(folder_ / "whole.ply"));
  for (const auto& [options, words] :
       {std::pair{"--base-height 99", "error: --base-height: a base 99 above the lowest point does not cut"},
        {"--base-tilt 90", "error: --base-tilt: a tilt of the base must be less than 90 degrees"},
        {"--base-tilt 95", "error: --base-tilt: "},
        {"--base-tilt 5,z --base-height 0.2",
         "error: --base-tilt: the base's plane is turned about its own"}}) {
    const Outcome refused = run(drop + options);
    EXPECT_EQ(refused.status, 3) << options;
    EXPECT_NE(refused.err.find(words), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace meshgraft::test
