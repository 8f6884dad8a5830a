#include "editor/running_steps.h"

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "editor/document.h"
#include "editor/step_actions.h"
#include "io/temporary_folder.h"

namespace meshgraft::test {
namespace {

using editor::Json;
using editor::RunningSteps;
using Keys = std::vector<std::string>;

TEST(RunningSteps, AreInTheFileWhileTheyRun) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.running", other = folder / "b.running";
  RunningSteps steps;
  auto first = std::make_optional(steps.begin("first"));
  EXPECT_FALSE(std::filesystem::exists(file));
  steps.keep_in(file);
  EXPECT_EQ(RunningSteps::left_in(file), Keys{"first"}) << "it runs since before";
  auto second = std::make_optional(steps.begin("second"));
  EXPECT_EQ(RunningSteps::left_in(file), (Keys{"first", "second"}));
  first.reset();
  EXPECT_EQ(RunningSteps::left_in(file), Keys{"second"});
  steps.keep_in(other);
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(RunningSteps::left_in(other), Keys{"second"});
  second = steps.begin("third");
  EXPECT_EQ(RunningSteps::left_in(other), Keys{"third"});
  second.reset();
  EXPECT_FALSE(std::filesystem::exists(other));
  EXPECT_TRUE(RunningSteps::left_in(other).empty());
}

TEST(RunningSteps, AnEndInOrderLeavesNoFileAndATornFileTellsNothing) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.running";
  {
    RunningSteps steps;
    steps.keep_in(file);
    const auto step = steps.begin("step");
    EXPECT_TRUE(std::filesystem::exists(file));
    steps.keep_in({});
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  for (const char* text : {"", "[\"st", "{}", "[1]"}) {
    std::ofstream(file) << text;
    EXPECT_TRUE(RunningSteps::left_in(file).empty()) << text;
  }
}

TEST(RunningSteps, WhatComesFromLeftOutStepsIsLeftOut) {
  const Json document = Json::parse(R"({
    "inputs": {"bar": {"sample": "bar"}}, "output": "half",
    "selections": {"here": "all", "edge": {"produced": {"step": "cut", "what": "above"}},
                   "more": {"union": ["here", {"produced": {"step": "cut", "what": "above"}}]}},
    "steps": [{"kind": "deform", "mesh": "bar"}, {"kind": "cut", "name": "cut"}, {"kind": "deform"}]})");
  Json some = document;
  editor::leave_out_steps(some, 1, "bar");
  ASSERT_EQ(some["steps"].size(), 2);
  EXPECT_EQ(some["steps"][0], document["steps"][0]);
  EXPECT_TRUE(some["steps"][1]["handles"].empty());
  EXPECT_EQ(some["selections"], Json({{"here", "all"}}));
  EXPECT_FALSE(some.contains("output"));
  Json last = document;
  editor::leave_out_steps(last, 2, "bar");
  EXPECT_EQ(last["steps"].size(), 3);
  EXPECT_EQ(last["selections"], document["selections"]);
  Json all = document;
  editor::leave_out_steps(all, 0, "bar");
  ASSERT_EQ(all["steps"].size(), 1);
  EXPECT_EQ(all["steps"][0]["mesh"], "bar");
  EXPECT_TRUE(all["steps"][0]["handles"].empty());
}

}  // namespace
}  // namespace meshgraft::test
