// A million vertices under a limit of the address space: the program solves, if need be on a proxy, or says
// that the memory is too small. It never ends by a signal.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_line.h"

namespace meshgraft::test {
namespace {

using nlohmann::json;

class Million : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    ASSERT_EQ(run("sample bumpy_plane --resolution 1000 -o million.ply").status, 0);
    write("million.json",
          R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "million.ply"}},
      "steps": [{"kind": "deform", "mesh": "sheet", "fixed": {"grow": {"of": {"loop": 0}, "rings": 2}},
        "handles": [{"name": "disc", "select": {"sphere": {"centre": [0, 0, 0], "radius": 0.1}},
                     "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 45}}}]}]})");
  }

  Outcome run_within(int megabytes, const std::string& more = "") const {
    return run("run million.json -o out.ply --report report.json " + more,
               "ulimit -v " + std::to_string(1024 * megabytes) + " && ");
  }

  // Returns the first step of the report of the last run.
  json first_step() const { return json::parse(read_text(folder_ / "report.json"))["steps"][0]; }

  static std::vector<std::string> ids_of_notes(const json& step) {
    std::vector<std::string> ids;
    for (const json& note : step["notes"]) ids.push_back(note["id"]);
    return ids;
  }
};

TEST_F(Million, AProxyTakesTwoGibibytes) {
  const Outcome outcome = run_within(2048, "--proxy 8000");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(first_step()["proxy"]["vertices"], 2000);
  EXPECT_EQ(ids_of_notes(first_step()), std::vector<std::string>{"script.proxy_solved"});
}

TEST_F(Million, AProxyIsChosenWhereTheRestDoesNotFit) {
  const Outcome outcome = run_within(2048);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json step = first_step();
  EXPECT_FALSE(step["proxy"].is_null());
  EXPECT_EQ(ids_of_notes(step), (std::vector<std::string>{"script.proxy_for_memory", "script.proxy_solved"}));
}

// Below some 200 MiB the system does not load the program's libraries.
TEST_F(Million, EveryLimitEndsInAResultOrAMessage) {
  for (const int megabytes : {300, 500, 700, 900, 1100, 1400, 1700, 3000, 5000}) {
    const Outcome outcome = run_within(megabytes);
    EXPECT_TRUE(outcome.status == 0 || outcome.status == 6)
        << megabytes << " MiB: status " << outcome.status << ", " << outcome.err;
    RecordProperty(std::to_string(megabytes) + " MiB", outcome.status);
  }
}

}  // namespace
}  // namespace meshgraft::test
