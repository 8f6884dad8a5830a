#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/merge/merge.h>
#include <meshgraft/script/run_edit.h>

#include "script/run_steps.h"

/// The edit files that the laws are tested on, and their steps.
namespace meshgraft::test {

/// An edit file, with a name for the test's parameter.
struct Scenario {
  std::string name;
  std::filesystem::path path;
  bool public_task = false;  ///< a task of the public test data; those name the method and the shape `ft05`
};

/// Names a parameter of a test.
inline std::string name_of_scenario(const testing::TestParamInfo<Scenario>& info) { return info.param.name; }

/// `loop_merge` is a merge that is no drop.
enum class StepKind { deform, merge, loop_merge };

/// Returns the edit files beside the tests that have a step of a kind, sorted by name.
std::vector<Scenario> kept_scenarios(StepKind kind);

/// Returns the edit files of the folder `examples`.
std::vector<Scenario> examples(StepKind kind);

/// Returns the editing tasks of the public test data; none where that is not there.
std::vector<Scenario> data_scenarios(StepKind kind);

/// Resolutions for `read_scenario`: those of the file, and those with which a law takes a second or less.
inline constexpr int as_they_are = 0, coarse = 40;

/// Reads a scenario. Built-in models get at most the given resolution, unless that is 0.
EditFile read_scenario(const Scenario& scenario, int largest_resolution);

/// Options without what only reports need.
inline const RunOptions plain;

/// A step that was run, with the meshes as they were before it.
struct StepRun {
  const EditFile& edit;
  const EditStep& step;
  Location location;
  const std::map<std::string, MeshState>& before;
  const Mesh& result;
  const StepReport& report;
};

/// Runs an edit and visits each of its steps.
void visit_steps(const EditFile& edit, const RunOptions& options,
                 const std::function<void(const StepRun& run)>& visit);

/// A merge with all that it is called with.
struct ResolvedMerge {
  Mesh target, source;  ///< the source as it was posed
  std::vector<MergePair> pairs;
  MergeOptions options;
};

/// Returns the call that a merge step without `at` makes.
ResolvedMerge resolve_merge(const StepRun& run);

}  // namespace meshgraft::test
