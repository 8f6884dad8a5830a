// The results of the public editing tasks are those that their files expect.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/run_edit.h>
#include <meshgraft/select/selection.h>

#include "io/file.h"
#include "support/mesh_families.h"
#include "support/paths.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

std::filesystem::path scenario_folder() { return test::data_folder() / "scenarios"; }

std::vector<std::filesystem::path> deform_scenarios() {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(scenario_folder())) return files;
  for (const auto& entry : std::filesystem::directory_iterator(scenario_folder()))
    if (entry.path().extension() == ".json" && json::parse(read_file(entry.path()))["kind"] == "deform")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

Eigen::Affine3d affine_of(const json& matrix) {
  Eigen::Affine3d map;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) map.matrix()(row, column) = matrix[row][column].get<double>();
  return map;
}

/// The contents of a scenario file.
struct Scenario {
  json file;
  Mesh mesh;
  Triangles triangles;
  Region region;
  std::vector<HandlePose> poses;

  explicit Scenario(const std::filesystem::path& path) : file(json::parse(read_file(path))) {
    mesh = read_mesh(path.parent_path() / file["mesh"].get<std::string>());
    triangles = triangulate(mesh).triangles;
    region.whole = file["roi"] == "all";
    if (!region.whole) region.vertices = file["roi"].get<std::vector<Index>>();
    region.fixed = file["fixed"].get<std::vector<Index>>();
    for (const json& handle : file["handles"]) {
      region.handles.push_back(
          make_handle(handle["name"].get<std::string>(), handle["vertices"].get<std::vector<Index>>()));
      poses.push_back(pose_of(affine_of(handle["transform"])));
    }
  }

  double diagonal() const {
    return (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).norm();
  }
};

/// Checks a result against the file's `expected` block.
void expect_as_told(const Scenario& scenario, const Points& result) {
  const json& expected = scenario.file["expected"];
  if (expected.is_null()) return;
  const double tolerance = expected["tolerance"].get<double>() * scenario.diagonal();
  const Points& rest = scenario.mesh.positions;
  if (expected["kind"] == "affine") {
    const Points target = image(rest, affine_of(expected["transform"]));
    double error = 0;
    const auto check = [&](Index v) { error = std::max(error, (result.row(v) - target.row(v)).norm()); };
    if (scenario.region.whole)
      for (Index v = 0; v < rest.rows(); ++v) check(v);
    else
      for (Index v : scenario.region.vertices) check(v);
    EXPECT_LT(error, tolerance);
    testing::Test::RecordProperty("error_over_tolerance", std::to_string(error / tolerance));
  } else if (expected["kind"] == "unchanged_axes") {
    double error = 0;
    for (const int axis : expected["axes"].get<std::vector<int>>())
      error = std::max(error, (result.col(axis) - rest.col(axis)).cwiseAbs().maxCoeff());
    EXPECT_LT(error, tolerance);
    testing::Test::RecordProperty("error_over_tolerance", std::to_string(error / tolerance));
  } else {
    ADD_FAILURE() << "the file expects something unknown: " << expected;
  }
}

class Scenarios : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(Scenarios, MeetWhatTheirFilesExpect) {
  const Scenario scenario(GetParam());
  const json& counts = scenario.file["counts"];
  EXPECT_EQ(scenario.mesh.vertex_count(), counts["vertices"].get<Index>());
  EXPECT_EQ(scenario.mesh.face_count(), counts["faces"].get<Index>());
  const Points& rest = scenario.mesh.positions;
  const EditResult edit = run_edit(read_edit_file(GetParam()));
  EXPECT_EQ(edit.report.counts.free, counts["free"].get<Index>());
  EXPECT_EQ(edit.report.counts.handle, counts["handle"].get<Index>());
  EXPECT_EQ(edit.report.counts.fixed, counts["fixed"].get<Index>());

  const Points& result = edit.mesh.positions;
  expect_as_told(scenario, result);
  // Every file also implies finite positions, constraints that are met, and a small residual.
  EXPECT_TRUE(result.allFinite());
  for (std::size_t h = 0; h < scenario.poses.size(); ++h)
    for (Index v : scenario.region.handles[h].vertices)
      EXPECT_EQ(Vector3d(result.row(v)), scenario.poses[h].transform * Vector3d(rest.row(v)));
  std::vector<bool> moves(static_cast<std::size_t>(rest.rows()), scenario.region.whole);
  for (Index v : scenario.region.vertices) moves[static_cast<std::size_t>(v)] = true;
  for (Index v : scenario.region.fixed) moves[static_cast<std::size_t>(v)] = false;
  for (Index v = 0; v < rest.rows(); ++v) {
    if (!moves[static_cast<std::size_t>(v)]) {
      ASSERT_EQ(result.row(v), rest.row(v)) << "vertex " << v;
    }
  }
  EXPECT_LT(edit.report.evaluation.value().residual, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Files, Scenarios, testing::ValuesIn(deform_scenarios()),
                         [](const auto& file) { return file.param.stem().string(); });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Scenarios);

TEST(ScenarioFolder, HoldsTheEditingTasks) {
  if (!std::filesystem::is_directory(scenario_folder()))
    GTEST_SKIP() << "no test data in " << scenario_folder() << "; set MESHGRAFT_DATA";
  EXPECT_GE(deform_scenarios().size(), 30U);
}

/// Returns the number of common vertices of two sets over that of their union.
double overlap(const std::vector<Index>& a, const std::vector<Index>& b) {
  const std::set<Index> first(a.begin(), a.end()), second(b.begin(), b.end());
  std::size_t common = 0;
  for (Index v : first) common += second.count(v);
  return static_cast<double>(common) / static_cast<double>(first.size() + second.size() - common);
}

/// A limb, described as a user would: by a point and two lengths along the surface.
struct Limb {
  Vector3d tip;
  double handle_length = 0, region_length = 0;
};

struct Rebuilt {
  const char* scenario;
  std::vector<Limb> limbs;
};

const Limb horse_head{{-0.2, 0.2, -0.5}, 0.2, 0.5748};
const Limb octopus_arm_1{{0.3268, -0.3121, 0.1748}, 0.06, 0.77736};
const Limb octopus_arm_2{{-0.1486, -0.0425, 0.4198}, 0.06, 0.7495};

class Selections : public testing::TestWithParam<Rebuilt> {};

TEST_P(Selections, RebuildTheScenario) {
  const auto path = scenario_folder() / (std::string(GetParam().scenario) + ".json");
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no test data in " << scenario_folder() << "; set MESHGRAFT_DATA";
  Scenario scenario(path);
  const SelectionMesh context(scenario.mesh);
  const auto part = [](const Vector3d& tip, double length) {
    return Selection(Selection::GrowLength{
        std::make_shared<const Selection>(Selection(Selection::NearestVertex{tip})), length});
  };
  std::vector<Selection> parts, rims;
  Region region;
  for (std::size_t k = 0; k < GetParam().limbs.size(); ++k) {
    const Limb& limb = GetParam().limbs[k];
    const Selection whole = part(limb.tip, limb.region_length);
    parts.push_back(whole);
    rims.push_back(Selection(Selection::Rim{std::make_shared<const Selection>(whole), 2}));
    region.handles.push_back(make_handle(scenario.region.handles[k].name,
                                         resolve(part(limb.tip, limb.handle_length), context, "handle")));
    EXPECT_EQ(overlap(region.handles[k].vertices, scenario.region.handles[k].vertices), 1.0);
  }
  region.vertices = resolve(Selection(Selection::Union{parts}), context, "region");
  region.fixed = resolve(Selection(Selection::Union{rims}), context, "fixed");
  EXPECT_EQ(overlap(region.vertices, scenario.region.vertices), 1.0);
  EXPECT_GT(overlap(region.fixed, scenario.region.fixed), 0.9);

  const Points rebuilt =
      Deformer(scenario.mesh.positions, scenario.triangles, region, linear_method()).evaluate(scenario.poses);
  const Points told = Deformer(scenario.mesh.positions, scenario.triangles, scenario.region, linear_method())
                          .evaluate(scenario.poses);
  EXPECT_LT(largest_distance(rebuilt, told), 0.01 * scenario.diagonal());
}

INSTANTIATE_TEST_SUITE_P(Parts, Selections,
                         testing::Values(Rebuilt{"horse_translate", {horse_head}},
                                         Rebuilt{"horse_rotate", {horse_head}},
                                         Rebuilt{"horse_scale", {horse_head}},
                                         Rebuilt{"horse_combined", {horse_head}},
                                         Rebuilt{"octopus_one_arm", {octopus_arm_1}},
                                         Rebuilt{"octopus_two_arms", {octopus_arm_1, octopus_arm_2}}),
                         [](const auto& rebuilt) { return std::string(rebuilt.param.scenario); });

}  // namespace
}  // namespace meshgraft::test
