#include <cstdio>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_line.h"

namespace meshgraft::test {
namespace {

using nlohmann::json;

#if !defined(MESHGRAFT_SANITIZES_ADDRESSES) && \
    !defined(MESHGRAFT_SANITIZES_THREADS)  // sanitizers map more than these limits
TEST_F(CommandLine, TooLittleMemoryEndsInGoodTime) {
  write("bar.json",
        R"({"format": "meshgraft-edit", "version": 2, "inputs": {"bar": {"sample": "bar", "resolution": 100}},
      "steps": [{"kind": "deform", "mesh": "bar", "settings": {"method": "ft05"},
        "fixed": {"half_space": {"point": [0, 0, 0.4], "normal": [0, 0, -1]}},
        "handles": [{"name": "end", "select": {"half_space": {"point": [0, 0, 3.6], "normal": [0, 0, 1]}},
                     "pose": {"translate": [0, 0, 0.2]}}]}]})");
  ASSERT_EQ(run("deform bar.json -o out.ply").status, 0);
  for (const int megabytes : {200, 250, 300, 450, 600, 800, 2000}) {
    const Outcome outcome =
        run("deform bar.json -o out.ply", "ulimit -v " + std::to_string(1000 * megabytes) + " && timeout 60 ");
    EXPECT_TRUE(outcome.status == 0 || outcome.status == 6)
        << megabytes << " MB: status " << outcome.status << ", " << outcome.err;
  }
}
#endif

TEST_F(CommandLine, AnEditCanBecomeAMorphTarget) {
  const Outcome outcome = run("deform edit.json -o out.gltf --as-morph-target wave");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json file = json::parse(read_text(folder_ / "out.gltf"));
  EXPECT_EQ(file["meshes"][0]["extras"]["targetNames"], json({"wave"}));
  EXPECT_EQ(file["meshes"][0]["primitives"][0]["targets"].size(), 1U);
  ASSERT_EQ(run("deform edit.json --as-morph-target -o out.gltf").status, 0);
  EXPECT_EQ(json::parse(read_text(folder_ / "out.gltf"))["meshes"][0]["extras"]["targetNames"], json({"edit"}));
  const Outcome refused = run("deform edit.json -o out.ply --as-morph-target wave");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find(".glb"), std::string::npos) << refused.err;
}

TEST_F(CommandLine, DeformsWritesAndReports) {
  const Outcome outcome = run("deform edit.json -o out.obj --report report.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_NE(outcome.out.find("wrote out.obj"), std::string::npos) << outcome.out;
  const std::string mesh = read_text(folder_ / "out.obj");
  EXPECT_NE(mesh.find("# a sheet"), std::string::npos);
  EXPECT_NE(mesh.find("f 1 2 10 9"), std::string::npos) << "polygons stay polygons";
  const json report = json::parse(read_text(folder_ / "report.json"));
  EXPECT_EQ(report["counts"]["fixed"], 16);
  EXPECT_EQ(report["counts"]["free"], 32);
  EXPECT_EQ(report["method"], "corotational");
  EXPECT_EQ(report["outputs"], json({"out.obj", "report.json"}));
  EXPECT_GT(report["seconds"]["total"], 0);
  EXPECT_EQ(report["quality"]["new_self_intersections"], 0);
  EXPECT_NE(outcome.out.find(" 0 new self-intersections"), std::string::npos) << outcome.out;
}

// Returns an edit that cuts the sheet in two, lifts the edge of one part, and shears the other.
std::string cut_and_deform() {
  const std::string lift = R"("handles": [{"name": "edge", "pose": {"translate": [0, 0, 1]},
      "select": {"half_space": {"point": [0, 6.5, 0], "normal": [0, 1, 0]}}}])";
  return R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "sheet.obj"}},
    "steps": [
      {"kind": "cut", "name": "split", "mesh": "sheet", "result": "part", "keep": "above",
       "plane": {"point": [0, 2.5, 0], "normal": [0, 1, 0]}},
      {"kind": "deform", "mesh": "part",
       "fixed": {"half_space": {"point": [0, 3.5, 0], "normal": [0, -1, 0]}}, )" +
         lift + R"(},
      {"kind": "deform", "mesh": "sheet", "result": "whole",
       "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}}, )" +
         lift + R"(}], "output": "part"})";
}

TEST_F(CommandLine, RunsStepsOfAnyKindAndSavesAnyMesh) {
  write("many.json", cut_and_deform());
  const Outcome outcome =
      run("run many.json -o part.ply --save whole=whole.off --save sheet=same.obj --report report.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("split: cut along "), std::string::npos) << outcome.out;
  EXPECT_EQ(read_text(folder_ / "same.obj"), sheet());
  EXPECT_NE(json::parse(run("info whole.off --json").out)["box"],
            json::parse(run("info same.obj --json").out)["box"]);
  const json report = json::parse(read_text(folder_ / "report.json"));
  EXPECT_EQ(report["steps"].size(), 3U);
  EXPECT_EQ(report["outputs"], (json{"part.ply", "whole.off", "same.obj", "report.json"}));
  ASSERT_EQ(run("deform many.json -o deform.ply").status, 0);
  EXPECT_EQ(read_text(folder_ / "deform.ply"), read_text(folder_ / "part.ply"));
}

TEST_F(CommandLine, RunsWithoutWritingAndAsAskedOtherwise) {
  const Outcome told = run("run edit.json --json --method ft05");
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_EQ(json::parse(told.out)["steps"][0]["method"], "ft05");
  EXPECT_EQ(json::parse(told.out)["outputs"].size(), 0U);
  EXPECT_TRUE(new_files().empty());
}

TEST_F(CommandLine, RunRefusesOutputsThatMakeNoSense) {
  write("many.json", cut_and_deform());
  const std::vector<std::tuple<std::string, int, std::string>> cases = {
      {"run many.json --save part", 2, "--save: 'part' is not NAME=FILE"},
      {"run many.json --save =a.ply", 2, "--save: '=a.ply' is not NAME=FILE"},
      {"run many.json --save port=a.ply", 2, "no mesh named 'port'. It has sheet, part, whole."},
      {"run many.json -o a.ply --save part=a.ply", 2, "two outputs have this name"},
      {"run many.json --save part=a.obj --report a.mtl", 2, "kept for the materials"},
      {"run many.json --save part=sheet.obj", 2, "this is an input"},
      {"run many.json --save part=many.json", 2, "this is an input"},
      {"run many.json --save part=a.xyz", 3, "a.xyz"},
      {"run many.json --save part=gone/a.ply", 5, "there is no such folder"},
      {"run edit.json --as-morph-target", 2, "--as-morph-target goes with -o"},
      {"run many.json -o a.glb --as-morph-target", 2, "the edit does more than deform"},
  };
  for (const auto& [arguments, status, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, status) << arguments;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << arguments << ": " << outcome.err;
  }
  EXPECT_EQ(new_files(), std::vector<std::string>{"many.json"});
}

TEST_F(CommandLine, JsonGoesToStandardOutputAlone) {
  const Outcome outcome = run("deform edit.json -o out.ply --json --threads 1");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report["format"], "meshgraft-report");
  EXPECT_TRUE(report["condition_estimate"].is_null());
  const Outcome info = run("info out.ply --json");
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_EQ(json::parse(info.out)["counts"]["vertices"], 64);
}

TEST_F(CommandLine, TheConditionIsEstimatedWhereThatIsAskedFor) {
  const Outcome outcome = run("deform edit.json -o out.ply --json --condition");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(json::parse(outcome.out)["condition_estimate"], 1);
}

TEST_F(CommandLine, OptionsOverrideTheFile) {
  const Outcome outcome =
      run("deform edit.json -o o.ply --json --method ft05 --weights cotangent --density ft05 "
          "--degenerate ft05-noise --backend eigen");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json settings = json::parse(outcome.out)["steps"][0]["settings"];
  EXPECT_EQ(settings["weights"], "cotangent");
  EXPECT_EQ(settings["density"], "ft05");
  EXPECT_EQ(settings["degenerate"], "ft05-noise");
  EXPECT_EQ(settings["backend"], "eigen");

  const Outcome turned =
      run("deform edit.json -o o.ply --json --method rotation-aware --stiffness 2.5 --iterations 3");
  ASSERT_EQ(turned.status, 0) << turned.err;
  const json step = json::parse(turned.out)["steps"][0];
  EXPECT_EQ(step["method"], "rotation-aware");
  EXPECT_EQ(step["settings"]["stiffness"], 2.5);
  EXPECT_EQ(step["settings"]["iterations"], 3);
}

TEST_F(CommandLine, SolvesAsPublished) {
  const Outcome outcome = run("deform edit.json -o o.ply --json --as-published --density aware");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json settings = json::parse(outcome.out)["steps"][0]["settings"];
  EXPECT_EQ(settings["preset"], "as-published");
  EXPECT_EQ(settings["method"], "ft05");
  EXPECT_EQ(settings["noise_lengths"], "random");
  EXPECT_EQ(settings["laplacian_weight"], 1);
  EXPECT_EQ(settings["density"], "aware");
}

TEST_F(CommandLine, TellsOfAnEditMadeWithOtherMethods) {
  std::string old = edit();
  old.insert(old.find("\"inputs\""), R"("made_with": {"version": "0.0.1", "methods": 1000},)");
  write("old.json", old);
  const Outcome outcome = run("run old.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("note: the edit was made with meshgraft 0.0.1"), std::string::npos) << outcome.out;
  EXPECT_EQ(run("run old.json --as-published").out.find("0.0.1"), std::string::npos);
}

TEST_F(CommandLine, TheFormerNameOfASolverIsTakenWithANote) {
  if (const Outcome built_in = run("deform edit.json -o o.ply --backend multifrontal"); built_in.status != 0) {
    EXPECT_NE(built_in.err.find("MESHGRAFT_WITH_MULTIFRONTAL"), std::string::npos) << built_in.err;
    GTEST_SKIP() << "this build has no multifrontal solver";
  }
  const Outcome asked = run("deform edit.json -o o.ply --json --backend cholmod");
  ASSERT_EQ(asked.status, 0) << asked.err;
  const json report = json::parse(asked.out);
  EXPECT_EQ(report["solver"]["backend"], "multifrontal");
  EXPECT_EQ(report["steps"][0]["settings"]["backend"], "multifrontal");
  ASSERT_EQ(report["notes"].size(), 1U);
  EXPECT_EQ(report["notes"][0]["id"], "script.former_backend");
  EXPECT_EQ(report["notes"][0]["fields"]["location"], "--backend");
  EXPECT_EQ(json::parse(run("deform edit.json -o o.ply --json --backend multifrontal").out)["notes"],
            json::array());

  json edit = json::parse(read_text(folder_ / "edit.json"));
  for (json& step : edit["steps"]) step["settings"]["backend"] = "cholmod";
  write("former.json", edit.dump());
  const Outcome told = run("deform former.json -o o.ply");
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_NE(told.out.find("note: former.json: steps[0].settings.backend"), std::string::npos) << told.out;
  EXPECT_EQ(run("deform edit.json -o o.ply --backend cholesky").err.find("cholmod"), std::string::npos);
}

TEST_F(CommandLine, VersionOneFilesAreSolvedByFt05UnlessAskedOtherwise) {
  write("one.json", R"({"format": "meshgraft-edit", "version": 1, "kind": "deform", "mesh": "sheet.obj",
      "roi": "all", "fixed": [0, 1, 2, 3, 4, 5, 6, 7], "handles": [{"name": "h", "shape": "region",
      "vertices": [60, 61, 62], "transform": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]}]})");
  const Outcome plain = run("deform one.json -o o.ply --json");
  ASSERT_EQ(plain.status, 0) << plain.err;
  EXPECT_EQ(json::parse(plain.out)["method"], "ft05");
  EXPECT_EQ(json::parse(run("deform one.json -o o.ply --json --method corotational").out)["method"],
            "corotational");
}

TEST_F(CommandLine, TheSummarySaysThatAMirroringHandleIsFollowedLinearly) {
  std::string mirroring = edit();
  const std::string pose = R"({"translate": [0, 0, 2]})";
  mirroring.replace(mirroring.find(pose), pose.size(), R"({"scale": [-1, 1, 1]})");
  write("mirror.json", mirroring);
  const Outcome outcome = run("deform mirror.json -o o.ply");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("note: a handle mirrors or flattens"), std::string::npos) << outcome.out;
  EXPECT_EQ(run("deform edit.json -o o.ply").out.find("note:"), std::string::npos);
}

TEST_F(CommandLine, TheSummarySaysWhereNothingIsHeldInPlace) {
  const auto edit_with = [](const std::string& pose_of_rest) {
    return R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "sheet.obj"}},
      "steps": [{"kind": "deform", "mesh": "sheet", "handles": [
        {"name": "edge", "select": {"half_space": {"point": [0, 5.5, 0], "normal": [0, 1, 0]}},
         "pose": {"translate": [0, 0, 2]}},
        {"name": "rest", "select": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
         "pose": )" +
           pose_of_rest + "}]}]}";
  };
  const auto says_so = [&](const std::string& pose_of_rest) {
    write("two.json", edit_with(pose_of_rest));
    const Outcome outcome = run("deform two.json -o o.ply");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out.find("nothing is held in place") != std::string::npos;
  };
  EXPECT_TRUE(says_so(R"({"translate": [0, 1, 0]})"));
  EXPECT_FALSE(says_so("{}")) << "a handle at rest holds the region";
  EXPECT_FALSE(says_so(R"({"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]})"));
}

TEST_F(CommandLine, SaysWhereAStepMovesNothing) {
  const auto says = [&](const std::string& step) {
    write("still.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"bar": {"sample": "bar"}},
      "steps": [{"mesh": "bar", )" +
                            step + "}]}");
    const Outcome outcome = run("run still.json -o o.ply --force");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  EXPECT_NE(says(R"("kind": "deform", "fixed": {"half_space": {"point": [0, 0, 1], "normal": [0, 0, -1]}})")
                .find("nothing moves it"),
            std::string::npos);
  EXPECT_NE(says(R"("kind": "sculpt", "action": "flatten", "region": {"indices": [5]})").find("nothing moved"),
            std::string::npos);
  EXPECT_NE(says(R"("kind": "transform", "pose": {})").find("nothing was moved"), std::string::npos);
  EXPECT_NE(says(R"("kind": "transform", "pose": {"translate": [1, 0, 0]})").find("the whole mesh was moved"),
            std::string::npos);
}

TEST_F(CommandLine, TheSameBytesWithOneThreadAndWithTwo) {
  ASSERT_EQ(run("deform edit.json -o a.ply --threads 1").status, 0);
  ASSERT_EQ(run("deform edit.json -o b.ply --threads 2").status, 0);
  EXPECT_EQ(read_text(folder_ / "a.ply"), read_text(folder_ / "b.ply"));
}

}  // namespace
}  // namespace meshgraft::test
