#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_line.h"

namespace meshgraft::test {
namespace {

using nlohmann::json;

TEST_F(CommandLine, CompareTellsMethodsApart) {
  const Outcome table = run("compare edit.json --methods ft05,arap-2007");
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_NE(table.out.find("\n| ft05 "), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("\n| arap-2007 "), std::string::npos) << table.out;
  EXPECT_EQ(table.out.find("corotational"), std::string::npos) << table.out;
  EXPECT_TRUE(new_files().empty());

  const json all = json::parse(run("compare edit.json --json --threads 1").out);
  EXPECT_EQ(all["format"], "meshgraft-comparison");
  ASSERT_EQ(all["methods"].size(), 12u);
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

  // A second run into the same folder leaves a foreign file as it is.
  write("both/mine.txt", "mine");
  EXPECT_EQ(run(command).status, 0);
  EXPECT_EQ(read_text(folder_ / "both/mine.txt"), "mine");

  // A foreign file under the name of an output is an error.
  std::filesystem::create_directory(folder_ / "other");
  write("other/yu-2004.obj", "mine");
  const Outcome refused = run("compare edit.json --methods ft05,yu-2004 -o other");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("other/yu-2004.obj"), std::string::npos) << refused.err;
  EXPECT_EQ(read_text(folder_ / "other/yu-2004.obj"), "mine");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other/compare.json"));
}

TEST_F(CommandLine, CompareNeverWritesOverAnInput) {
  // The input is an earlier comparison's result, and the output goes into its folder.
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

}  // namespace
}  // namespace meshgraft::test
