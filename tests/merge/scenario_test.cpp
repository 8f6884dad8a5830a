// The results of the public merging tasks are those that their files expect.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/run_edit.h>

#include "io/file.h"
#include "support/paths.h"

namespace meshgraft {
namespace {

using nlohmann::json;

std::filesystem::path scenario_folder() { return test::data_folder() / "scenarios"; }

std::vector<std::filesystem::path> merge_scenarios() {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(scenario_folder())) return files;
  for (const auto& entry : std::filesystem::directory_iterator(scenario_folder()))
    if (entry.path().extension() == ".json" && entry.path().stem().string().starts_with("merge_"))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

EditResult run(const std::filesystem::path& path, MergeShape shape) {
  RunOptions options;
  options.overrides.shape = shape;
  return run_edit(read_edit_file(path), options);
}

const MergeOutcome& merge_of(const EditResult& result) { return result.report.steps.at(0).merge.value(); }

double diagonal(const Points& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

// Returns the largest distance between vertices with the same index, since refinement may append vertices.
double largest_distance(const Points& a, const Points& b) {
  const Eigen::Index count = std::min(a.rows(), b.rows());
  return (a.topRows(count) - b.topRows(count)).rowwise().norm().maxCoeff();
}

void expect_topology(const EditResult& result, const json& expected) {
  const TopologySummary topology = summarise_topology(result.mesh);
  EXPECT_EQ(topology.manifold, expected["manifold"].get<bool>());
  EXPECT_TRUE(topology.oriented);
  EXPECT_EQ(topology.components, expected["components"].get<Index>());
  EXPECT_EQ(topology.boundary_loops, expected["boundary_loops"].get<Index>());
  EXPECT_EQ(topology.genus.value_or(-1), expected["genus"].get<Index>());
  EXPECT_EQ(topology.isolated_vertices, 0);
  const SeamReport& seam = merge_of(result).report.seam;
  EXPECT_TRUE(seam.manifold && seam.oriented);
  EXPECT_EQ(seam.euler_characteristic, seam.expected_euler_characteristic);
  EXPECT_EQ(seam.closed, expected["boundary_loops"].get<Index>() == 0);
}

class MergeScenarios : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(MergeScenarios, MeetWhatTheirFilesExpectByThePaper) {
  const json expected = json::parse(read_file(GetParam()))["expected"];
  const EditResult result = run(GetParam(), MergeShape::ft05);
  EXPECT_TRUE(result.mesh.positions.allFinite());
  expect_topology(result, expected);
  const Points& grafted = merge_of(result).grafted;
  if (expected.contains("source_becomes")) {
    const Mesh known = read_mesh(scenario_folder() / expected["source_becomes"].get<std::string>());
    ASSERT_GE(grafted.rows(), known.vertex_count());
    const double error = largest_distance(grafted, known.positions) / diagonal(known.positions);
    RecordProperty("distance_rel", std::to_string(error));
    EXPECT_LT(error, expected["tolerance"].get<double>());
  }
  if (expected.contains("same_result_as")) {
    const auto other = scenario_folder() / (expected["same_result_as"].get<std::string>() + ".json");
    const EditResult same = run(other, MergeShape::ft05);
    ASSERT_EQ(grafted.rows(), merge_of(same).grafted.rows());
    const double error = largest_distance(grafted, merge_of(same).grafted) / diagonal(same.mesh.positions);
    RecordProperty("distance_rel", std::to_string(error));
    EXPECT_LT(error, expected["tolerance"].get<double>());
  }
}

TEST_P(MergeScenarios, KeepTheirShapeBySimilarity) {
  const json expected = json::parse(read_file(GetParam()))["expected"];
  const EditResult result = run(GetParam(), MergeShape::similar);
  EXPECT_TRUE(result.mesh.positions.allFinite());
  expect_topology(result, expected);
  const ShapeReport& shape = merge_of(result).report.shape;
  RecordProperty("distance_rel", std::to_string(shape.distance_rel));
  RecordProperty("smallest_singular_p5", std::to_string(shape.smallest_singular_p5));
  EXPECT_EQ(shape.inverted, 0);
  EXPECT_LE(shape.distance_rel, 0.03);
  EXPECT_GE(shape.smallest_singular_p5, 0.5);
}

INSTANTIATE_TEST_SUITE_P(Files, MergeScenarios, testing::ValuesIn(merge_scenarios()),
                         [](const auto& file) { return file.param.stem().string(); });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MergeScenarios);

TEST(MergeScenarioFolder, HoldsTheMergingTasks) {
  if (!std::filesystem::is_directory(scenario_folder()))
    GTEST_SKIP() << "no test data in " << scenario_folder() << "; set MESHGRAFT_DATA";
  EXPECT_GE(merge_scenarios().size(), 19U);
}

}  // namespace
}  // namespace meshgraft
