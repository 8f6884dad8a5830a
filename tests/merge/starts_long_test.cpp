// Starts that a person would choose, over tasks whose start is known.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "merge/match_loops.h"
#include "support/paths.h"
#include "support/start_tasks.h"
#include "support/starts_found.h"

namespace meshgraft::test {
namespace {

/// Prints a row of the table in docs/merging.md, "Starts".
void print_rows(const char* known, const std::map<std::string, StartsFound>& by_kind) {
  for (const auto& [kind, found] : by_kind)
    fmt::print("| {} | {} | {} | {:.0f} % | {:.0f} % | {:.2f} |\n", known, kind, found.count(),
               100 * found.right_first(), 100 * found.right_among_three(), found.calibration_error());
}

TEST(StartsOfAllModels, AreThoseThatAPersonWouldChoose) {
  if (!std::filesystem::exists(data_folder())) GTEST_SKIP() << "no models in " << data_folder();
  const std::vector<StartTask> tasks = start_tasks(true, 5);
  EXPECT_GE(tasks.size(), 300U);
  std::map<std::string, StartsFound> whole, alone;
  for (const StartTask& task : tasks)
    for (const bool is_whole : {true, false}) {
      const std::vector<StartCandidate> starts = starts_of(task, is_whole);
      for (const std::string& kind : {task.kind, std::string("all")})
        (is_whole ? whole : alone)[kind].add(task, starts);
    }
  print_rows("whole", whole);
  print_rows("piece", alone);
  EXPECT_GE(whole["all"].right_first(), 0.9);
  EXPECT_GE(whole["all"].right_among_three(), 0.95);
  EXPECT_LE(whole["all"].calibration_error(), 0.1);
  EXPECT_GE(alone["all"].right_first(), 0.55);
  EXPECT_GE(alone["all"].right_among_three(), 0.8);
  EXPECT_LE(alone["all"].calibration_error(), 0.1);
}

}  // namespace
}  // namespace meshgraft::test
