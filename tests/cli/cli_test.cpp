#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

namespace {

using nlohmann::json;

struct Outcome {
  int status = -1;
  std::string out, err;
};

std::string read_text(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// The built program in a folder of its own, with a flat sheet and an edit of it.
class CommandLine : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("meshgraft_cli_") + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("sheet.obj", sheet());
    write("edit.json", edit());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string sheet() {
    std::string text = "# a sheet\n";
    const int side = 8;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + (((x + y) % 3) == 0 ? "0.2" : "0") +
                "\n";
    text += "g sheet\n";
    for (int y = 0; y + 1 < side; ++y)
      for (int x = 0; x + 1 < side; ++x) {
        const int v = y * side + x + 1;
        text += "f " + std::to_string(v) + " " + std::to_string(v + 1) + " " + std::to_string(v + side + 1) +
                " " + std::to_string(v + side) + "\n";
      }
    return text;
  }

  static std::string edit(const std::string& handle_more = "") {
    return R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "sheet.obj"}},
      "steps": [{"kind": "deform", "mesh": "sheet",
        "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
        "handles": [{"name": "edge", "select": {"half_space": {"point": [0, 5.5, 0], "normal": [0, 1, 0]}},
                     "pose": {"translate": [0, 0, 2]})" +
           handle_more + "}]}]}";
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  Outcome run(const std::string& arguments, const std::string& before = "") const {
    const std::string command = "cd '" + folder_.string() + "' && " + before + "'" MESHGRAFT_PROGRAM "' " +
                                arguments + " > .out 2> .err < /dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(folder_ / ".out"),
            read_text(folder_ / ".err")};
  }

  // Everything in the folder but what the test itself put there.
  std::vector<std::string> new_files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name != ".out" && name != ".err" && name != "sheet.obj" && name != "edit.json") names.push_back(name);
    }
    return names;
  }

  std::filesystem::path folder_;
};

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they map more than any limit here
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

// Cuts the sheet in two, lifts the edge of one part, and shears what was cut off.
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
  EXPECT_NE(outcome.out.find("split: cut: loops of"), std::string::npos) << outcome.out;
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
      {"run many.json --save port=a.ply", 2, "no mesh named 'port'. It has 'sheet', 'part', 'whole'."},
      {"run many.json -o a.ply --save part=a.ply", 2, "two outputs have this name"},
      {"run many.json --save part=a.obj --report a.mtl", 2, "kept for the materials"},
      {"run many.json --save part=sheet.obj", 2, "this is an input"},
      {"run many.json --save part=many.json", 2, "this is an input"},
      {"run many.json --save part=a.xyz", 3, "a.xyz"},
      {"run many.json --save part=gone/a.ply", 5, "there is no such folder"},
      {"run edit.json --as-morph-target", 2, "--as-morph-target goes with -o"},
      {"run many.json -o a.glb --as-morph-target", 2, "the edit changes the faces"},
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
  EXPECT_EQ(json::parse(outcome.out)["format"], "meshgraft-report");
  const Outcome info = run("info out.ply --json");
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_EQ(json::parse(info.out)["counts"]["vertices"], 64);
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
  EXPECT_NE(report["notes"][0].get<std::string>().find("--backend"), std::string::npos) << report["notes"];
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

TEST_F(CommandLine, TheSameBytesWithOneThreadAndWithTwo) {
  ASSERT_EQ(run("deform edit.json -o a.ply --threads 1").status, 0);
  ASSERT_EQ(run("deform edit.json -o b.ply --threads 2").status, 0);
  EXPECT_EQ(read_text(folder_ / "a.ply"), read_text(folder_ / "b.ply"));
}

TEST_F(CommandLine, ExitStatusesTellWhatIsWrong) {
  write("broken.json", "{");
  write("loose.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "sheet.obj"}},
      "steps": [{"kind": "deform", "mesh": "sheet", "handles": [
        {"name": "h", "select": {"indices": [3]}, "constrain": "position"}]}]})");
  write("no_mesh.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "no.obj"}},
      "steps": [{"kind": "deform", "mesh": "sheet"}]})");
  struct Case {
    const char* arguments;
    int status;
    const char* message;
  };
  const Case cases[] = {
      {"", 2, "subcommand"},
      {"defrom edit.json", 2, "'defrom' is not a command"},
      {"deform edit.json", 2, "--output"},
      {"deform edit.json -o o.ply --weights cotan", 2, "'cotan' is not one of uniform, cotangent"},
      {"deform edit.json -o o.ply --method linear", 2,
       "'linear' is not one of ft05, rotation-aware, corotational"},
      {"deform edit.json -o o.ply --stiffness -1", 2, "--stiffness"},
      {"deform edit.json -o o.ply --stiffness soft", 2, "--stiffness"},
      {"deform edit.json -o o.ply --iterations 1001", 2, "--iterations"},
      {"deform edit.json -o o.ply --iterations 1.5", 2, "--iterations"},
      {"deform edit.json -o o.ply --stiffness nan", 2, "--stiffness: 'nan' is not a number from 0 to 1000000"},
      {"deform edit.json -o o.ply --threads 0", 2, "not a whole number from 1 to 1024"},
      {"deform edit.json -o o.ply --picture p.png --from nan 0 1", 2, "--from: 'nan' is not a finite number"},
      {"deform edit.json -o o.ply --picture p.png --up 0 0 0", 2, "--up: 0 0 0 is no direction"},
      {"deform edit.json -o o.ply --from 1 0 0", 2, "--picture"},
      {"deform edit.json -o o.ply --report .", 5, ".: is a folder"},
      {"deform edit.json -o o.ply --report nowhere/r.json", 5, "nowhere"},
      {"deform edit.json -o o.ply --picture nowhere/p.png", 5, "nowhere"},
      {"deform edit.json -o o.ply --picture p.jpg", 2, "pictures are PNG files"},
      {"deform edit.json -o . --report r.json", 5, ".: is a folder"},
      {"deform edit.json -o out --report r.json", 3, "no extension"},
      {"sample bar --resolution 3.5 -o o.ply", 2, "--resolution: '3.5' is not a whole number from 4 to 4096"},
      {"deform edit.json -o edit.json", 2, "this is an input"},
      {"compare", 2, "edit"},
      {"compare edit.json --methods ft05,arpa-2007", 2, "Did you mean 'arap-2007'? Known are corotational"},
      {"compare edit.json --methods ft05,,arap-2007", 2, "there is no method named ''"},
      {"compare edit.json --methods ft05,ft05", 2, "'ft05' is given twice"},
      {"compare edit.json -o sheet.obj", 5, "this is not a folder"},
      {"compare edit.json -o nowhere/there", 5, "nowhere"},
      {"sample", 2, "no sample is named"},
      {"deform broken.json -o o.ply", 3, "broken.json: line 1, column 2: not valid JSON"},
      {"deform edit.json -o o.xyz", 3, ".xyz"},
      {"sample nothing -o o.ply", 3, "octopus"},
      {"deform loose.json -o o.ply", 4, "loose.json: steps[0]"},
      {"deform no.json -o o.ply", 5, "no.json"},
      {"deform no_mesh.json -o o.ply", 5, "no_mesh.json: inputs.sheet"},
      {"compare no_mesh.json -o there", 5, "no_mesh.json: inputs.sheet"},
      {"deform edit.json -o nowhere/o.ply", 5, "nowhere"},
      {"info no.ply", 5, "no.ply"},
  };
  const std::vector<std::string> before = new_files();
  for (const Case& wrong : cases) {
    const Outcome outcome = run(wrong.arguments);
    EXPECT_EQ(outcome.status, wrong.status) << wrong.arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.err.find("meshgraft: error: "), 0u) << outcome.err;
    EXPECT_NE(outcome.err.find(wrong.message), std::string::npos) << wrong.arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "") << wrong.arguments;
    EXPECT_EQ(new_files(), before) << wrong.arguments << " left something behind";
  }
}

TEST_F(CommandLine, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const std::string mesh = (folder_ / "sheet.obj").string();
  const int status =
      std::system(("'" MESHGRAFT_PROGRAM "' info '" + mesh + "' > /dev/full 2> /dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 5);
}

TEST_F(CommandLine, NeverWritesOverAnInputUnlessAsked) {
  const std::string before = read_text(folder_ / "sheet.obj");
  std::filesystem::create_symlink("sheet.obj", folder_ / "link.obj");
  for (const char* output : {"sheet.obj", "./sheet.obj", "link.obj"}) {
    const Outcome outcome = run(std::string("deform edit.json -o ") + output);
    EXPECT_EQ(outcome.status, 2) << output;
    EXPECT_NE(outcome.err.find("--force"), std::string::npos) << outcome.err;
    EXPECT_EQ(read_text(folder_ / "sheet.obj"), before);
  }
  for (const char* option : {"--report", "--force --report"}) {
    EXPECT_EQ(run(std::string("deform edit.json -o o.obj ") + option + " sheet.obj").status, 2);
    EXPECT_EQ(run(std::string("deform edit.json -o o.obj ") + option + " edit.json").status, 2);
    EXPECT_EQ(run(std::string("deform edit.json -o o.obj ") + option + " o.obj").status, 2);
  }
  EXPECT_EQ(run("deform edit.json --force -o edit.json").status, 2);
  EXPECT_EQ(read_text(folder_ / "sheet.obj"), before);
  EXPECT_EQ(read_text(folder_ / "edit.json"), edit());

  const Outcome outcome = run("deform edit.json -o sheet.obj --in-place");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(read_text(folder_ / "sheet.obj"), before);
}

TEST_F(CommandLine, CtrlCLeavesNothingBehind) {
  write(
      "long.json",
      R"({"format": "meshgraft-edit", "version": 2, "inputs": {"m": {"sample": "bumpy_plane", "resolution": 1500}},
      "steps": [{"kind": "deform", "mesh": "m", "fixed": {"loop": 0}}]})");
  for (const char* command : {"deform", "compare"}) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      if (chdir(folder_.c_str()) != 0 || !std::freopen(".err", "w", stderr)) _exit(99);
      execl(MESHGRAFT_PROGRAM, MESHGRAFT_PROGRAM, command, "long.json", "-o", "long.ply", nullptr);
      _exit(99);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    kill(child, SIGINT);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status)) << command;
    EXPECT_EQ(WEXITSTATUS(status), 130) << command << read_text(folder_ / ".err");
    EXPECT_NE(read_text(folder_ / ".err").find("cancelled"), std::string::npos) << command;
    EXPECT_EQ(new_files(), std::vector<std::string>{"long.json"}) << command;
  }
}

#ifdef MESHGRAFT_HAS_EDITOR
TEST_F(CommandLine, EditServesUntilCtrlC) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (chdir(folder_.c_str()) != 0 || !std::freopen(".out", "w", stdout)) _exit(99);
    execl(MESHGRAFT_PROGRAM, MESHGRAFT_PROGRAM, "edit", "--no-browser", "--folder", ".", "sheet.obj", nullptr);
    _exit(99);
  }
  for (int waits = 0; waits < 1000 && read_text(folder_ / ".out").empty(); ++waits)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(read_text(folder_ / ".out").find("http://127.0.0.1:"), 0u);
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(run("edit missing.ply --no-browser").status, 5);
}
#endif

TEST_F(CommandLine, CompareTellsMethodsApart) {
  const Outcome table = run("compare edit.json --methods ft05,arap-2007");
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_NE(table.out.find("\n| ft05 "), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("\n| arap-2007 "), std::string::npos) << table.out;
  EXPECT_EQ(table.out.find("corotational"), std::string::npos) << table.out;
  EXPECT_TRUE(new_files().empty());

  const json all = json::parse(run("compare edit.json --json --threads 1").out);
  EXPECT_EQ(all["format"], "meshgraft-comparison");
  ASSERT_EQ(all["methods"].size(), 8u);
  for (const json& method : all["methods"]) {
    EXPECT_TRUE(method["failure"].is_null()) << method;
    EXPECT_GT(method["quality"]["area_ratio"], 0) << method;
    EXPECT_EQ(method["counts"]["free"], 32) << method;
  }
}

TEST_F(CommandLine, CompareWritesAFolderAndOnlyItsOwnFilesIntoIt) {
  const bool pictures = run("render --help").status == 0;
  const std::string command = "compare edit.json --methods corotational,yu-2004 -o both/" +
                              std::string(pictures ? " --width 40 --height 30" : "");
  const Outcome outcome = run(command);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::vector<std::string> expected{"compare.json", "compare.md", "corotational.obj", "yu-2004.obj"};
  if (pictures) expected.insert(expected.end(), {"compare.png", "corotational.png", "yu-2004.png"});
  std::sort(expected.begin(), expected.end());
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "both"))
    found.push_back(entry.path().filename().string());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
  const json written = json::parse(read_text(folder_ / "both/compare.json"));
  EXPECT_EQ(written["methods"][1]["outputs"][0], "both/yu-2004.obj");
  const std::string text = read_text(folder_ / "both/compare.md");
  for (const std::string& name : expected)
    EXPECT_EQ(text.find("(" + name + ")") != std::string::npos,
              !name.starts_with("compare.") || name == "compare.png")
        << name;
  ASSERT_EQ(run("deform edit.json -o alone.obj").status, 0);
  EXPECT_EQ(read_text(folder_ / "both/corotational.obj"), read_text(folder_ / "alone.obj"));

  // Again into the same folder, beside a file that is nobody's business.
  write("both/mine.txt", "mine");
  EXPECT_EQ(run(command).status, 0);
  EXPECT_EQ(read_text(folder_ / "both/mine.txt"), "mine");

  // A file of somebody else's that is in the way.
  std::filesystem::create_directory(folder_ / "other");
  write("other/yu-2004.obj", "mine");
  const Outcome refused = run("compare edit.json --methods ft05,yu-2004 -o other");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("other/yu-2004.obj"), std::string::npos) << refused.err;
  EXPECT_EQ(read_text(folder_ / "other/yu-2004.obj"), "mine");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other/compare.json"));
}

TEST_F(CommandLine, CompareNeverWritesOverAnInput) {
  // An edit of an earlier comparison's result, compared into the same folder.
  ASSERT_EQ(run("compare edit.json --methods ft05 -o f").status, 0);
  std::string again = edit();
  const std::string input = R"("file": "sheet.obj")";
  again.replace(again.find(input), input.size(), R"("file": "f/ft05.obj")");
  write("again.json", again);
  const std::string before = read_text(folder_ / "f/ft05.obj");
  const Outcome outcome = run("compare again.json --methods ft05 -o f");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("this is an input"), std::string::npos) << outcome.err;
  EXPECT_EQ(read_text(folder_ / "f/ft05.obj"), before);
}

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
  expect("sheet.obj --plane 1,2,3 -o out.ply", 2, "is not a plane");
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

std::vector<std::string> commands() {
  return {"info", "check", "repair", "deform", "compare", "cut", "sample", "completion", "man"};
}

TEST_F(CommandLine, EveryCommandHasHelpWithAnExample) {
  const std::string overview = run("--help").out;
  for (const std::string& command : commands()) {
    EXPECT_NE(overview.find("\n  " + command), std::string::npos) << overview;
    const Outcome outcome = run(command + " --help");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.out.find("Example"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("meshgraft " + command), std::string::npos) << outcome.out;
  }
  EXPECT_EQ(run("--version").out.find("meshgraft "), 0u);
}

TEST_F(CommandLine, TheManualAndTheCompletionsKnowEveryCommandAndOption) {
  const std::string manual = run("man").out;
  EXPECT_EQ(manual.find(".TH MESHGRAFT 1"), 0u);
  for (const std::string& command : commands())
    EXPECT_NE(manual.find(".SS meshgraft " + command), std::string::npos) << command;
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Outcome outcome = run(std::string("completion ") + shell);
    EXPECT_EQ(outcome.status, 0);
    for (const std::string& command : commands())
      EXPECT_NE(outcome.out.find(command), std::string::npos) << shell << " " << command;
    for (const char* option : {"degenerate", "report", "in-place", "cotangent", "octopus"})
      EXPECT_NE(outcome.out.find(option), std::string::npos) << shell << " " << option;
  }
  for (const char* option : {"\\-\\-degenerate", "\\-\\-report", "\\-\\-in\\-place", "ft05\\-noise|apex|auto"})
    EXPECT_NE(manual.find(option), std::string::npos) << option;
}

TEST_F(CommandLine, BashCompletesCommandsOptionsAndValues) {
  write("complete.sh", "source <('" MESHGRAFT_PROGRAM
                       "' completion bash)\n"
                       "complete_words() { COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _meshgraft; echo "
                       "\"${COMPREPLY[*]}\"; }\n"
                       "complete_words meshgraft de\n"
                       "complete_words meshgraft deform --wei\n"
                       "complete_words meshgraft deform --weights c\n"
                       "complete_words meshgraft sample oct\n"
                       "complete_words meshgraft info she\n"
                       "complete_words meshgraft compare --methods ar\n");
  const Outcome outcome = run("--version > /dev/null; bash complete.sh");
  EXPECT_EQ(outcome.out, "deform\n--weights\ncotangent\noctopus\nsheet.obj\narap-2007\n") << outcome.err;
}

TEST_F(CommandLine, RefusesMergesThatMakeNoSense) {
  const std::vector<std::tuple<std::string, int, std::string>> cases = {
      {"merge sheet.obj -o o.ply", 2, "the source is missing"},
      {"merge edit.json -o o.ply --start 1:2", 2, "--start goes with TARGET and SOURCE"},
      {"merge sheet.obj sheet.obj -o o.ply --start 1-2", 2, "--start: '1-2' is not TARGET:SOURCE"},
      {"merge sheet.obj sheet.obj -o o.ply --spin 30", 2, "--spin goes with --at"},
      {"merge sheet.obj sheet.obj -o o.ply --pose keep --fix all", 2, "--fix: 'all' is not a selection"},
      {"merge sheet.obj sheet.obj -o o.ply --fix loop:0", 2, "--fix goes with --pose keep: nothing stays"},
      {"merge sheet.obj sheet.obj -o o.ply --pose keep --size 2", 2, "--size goes without --pose keep"},
      {"merge sheet.obj sheet.obj -o o.ply --at 1 --pair 0:0", 2, "--at goes without --pair"},
      {"merge sheet.obj sheet.obj -o o.ply --align 1:2", 2, "--align is given 1 time"},
      {"merge sheet.obj sheet.obj -o o.ply --pair 3:0", 3, "error: --pair 3:0: "},
      {"merge sheet.obj sheet.obj -o o.ply --start 0:0 --match 9:1", 3,
       "error: --match 9:1: vertex 9 is not on"},
      {"merge sheet.obj sheet.obj -o o.ply --start 0:0 --align 0:0 --align 1:1 --align 999:2", 3,
       "error: --align 999:2: there is no vertex 999"},
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
      {"merge sheet.obj sheet.obj -o o.ply --band 1.5", 2, "--band: '1.5' is not a whole number from 0 to 100"},
      {"merge sheet.obj sheet.obj -o o.ply --mirror 0,0,0,0,0,0", 2, "--mirror: the plane's normal is zero"},
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

// A tube with a lid, or upside down; its rim are vertices 0 to 11. Faces have UVs and the material "skin".
std::string tube(double bottom, bool upside_down, const std::string& library) {
  constexpr int around = 12, rings = 6;
  std::string text = library.empty() ? "" : "mtllib " + library + "\n";
  const double sign = upside_down ? -1 : 1;
  for (int k = 0; k < rings; ++k)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * 3.14159265358979 * i / around;
      text += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(sign * std::sin(angle)) + " " +
              std::to_string(bottom + sign * k * 0.5) + "\n";
    }
  text += "v 0 0 " + std::to_string(bottom + sign * (rings - 1) * 0.5) + "\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  if (!library.empty()) text += "usemtl skin\n";
  const auto corner = [](int v, int uv) { return " " + std::to_string(v + 1) + "/" + std::to_string(uv); };
  for (int k = 0; k + 1 < rings; ++k)
    for (int i = 0; i < around; ++i) {
      const int a = k * around + i, b = k * around + (i + 1) % around;
      text += "f" + corner(a, 1) + corner(b, 2) + corner(b + around, 3) + corner(a + around, 4) + "\n";
    }
  for (int i = 0; i < around; ++i)
    text += "f" + corner((rings - 1) * around + i, 1) + corner((rings - 1) * around + (i + 1) % around, 2) +
            corner(rings * around, 3) + "\n";
  return text;
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

  // Onto PLY, which has no materials.
  const Outcome ply = run(merge + "out/whole.ply --json");
  ASSERT_EQ(ply.status, 0) << ply.err;
  EXPECT_NE(json::parse(ply.out)["notes"].dump().find("body.mtl"), std::string::npos) << ply.out.substr(0, 400);

  // What belongs to an input is not written over.
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

TEST_F(CommandLine, OutputsAreToldApartHoweverTheyAreSpelled) {
  std::filesystem::create_directory(folder_ / "sub");
  std::filesystem::create_directory_symlink(folder_, folder_ / "sub/here");
  for (const char* report : {"./o.obj", "sub/../o.obj", "sub/here/o.obj"}) {
    const Outcome outcome = run(std::string("deform edit.json -o o.obj --report ") + report);
    EXPECT_EQ(outcome.status, 2) << report;
    EXPECT_NE(outcome.err.find("two outputs have this name"), std::string::npos) << outcome.err;
    const Outcome cut = run(std::string("cut sheet.obj --plane x=3.3 -o o.obj --report ") + report);
    EXPECT_EQ(cut.status, 2) << report;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "o.obj"));
}

TEST_F(CommandLine, OffersToSmoothARaggedLoop) {
  std::string ragged = tube(0, true, "");
  std::size_t line = 0;
  for (int v = 0; v < 12; ++v) {  // every other vertex of the rim lower
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
       "loop 0 of the source (three.obj) cannot be merged: 1 edge has more than two faces, on the loop at "
       "vertices 0, 1. "
       "A loop there cannot be merged: take faces away");
  says("merge moebius.obj body.obj" + to,
       "loop 0 of the target (moebius.obj) cannot be merged: 1 edge has two faces that are wound against each "
       "other, on "
       "the loop at vertices 0, 1. Normals there");
  says(merge + "points.obj" + to, "the source (points.obj) has no faces. Export it");
  says("cut points.obj --plane x=0.5" + to, "the mesh has no faces");
  says("info points.obj", "none, there are no faces");
  says("info moebius.obj", "inconsistent-winding at vertex 0");
  says("info three.obj", "non-manifold-edge at vertex 0");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "o.ply"));
}

TEST_F(CommandLine, CutTellsOfPlacesAndSizesAsTheyAre) {
  EXPECT_NE(run("cut sheet.obj --plane x=7 -o o.ply").err.find("below it, 0 to 7 away"), std::string::npos);
  std::string huge = "v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n";
  write("huge.obj", huge);
  const Outcome outcome = run("cut huge.obj --plane x=1e199 -o o.ply");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.err.find("--plane: vertex 1: a coordinate is as large as 1.0e+200. Scale the mesh down"),
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

TEST_F(CommandLine, ChecksAndRepairs) {
  // A face whose corners are one, and two vertices without faces.
  write("damaged.obj", sheet() + "v 3 0 0.2\nv 90 90 90\nf 1 1 1\n");
  const Outcome clean = run("check sheet.obj");
  EXPECT_EQ(clean.status, 0) << clean.out << clean.err;
  EXPECT_NE(clean.out.find("polygon (note)"), std::string::npos) << "a form, and no defect";
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

TEST_F(CommandLine, OutputsThatLinksMakeOneAreRefused) {
  std::filesystem::create_symlink("later.obj", folder_ / "link.obj");  // to nothing yet
  EXPECT_EQ(run("repair sheet.obj -o later.obj --report link.obj").status, 2);
  EXPECT_EQ(run("repair sheet.obj -o link.obj --report later.obj").status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "later.obj"));
}

TEST_F(CommandLine, VerticesWithoutAPlaceAreNamedWhereTheyMatter) {
  write("ball.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"file": "nan.off"}},
      "steps": [{"kind": "deform", "mesh": "a", "region": "all",
                 "handles": [{"name": "h", "select": {"indices": [2]}, "pose": {"translate": [1, 0, 0]}}]}]})");
  // A square of triangles about vertex 4, with a bad corner 2.
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
