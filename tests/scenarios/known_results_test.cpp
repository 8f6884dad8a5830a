// What is known of single edit files that are kept, and what holds for all of them.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "edit_steps.h"
#include "mesh/box_diagonal.h"
#include "support/paths.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

EditFile kept(const std::string& name) {
  return read_scenario({name, source_path("tests/scenarios") / (name + ".json")}, as_they_are);
}

TEST(KeptScenarios, AreSixDeformationsAndFourMerges) {
  EXPECT_EQ(kept_scenarios(StepKind::deform).size(), 6U);
  EXPECT_EQ(kept_scenarios(StepKind::merge).size(), 4U);
}

TEST(KeptScenarios, TheWholeBarFollowsTheMapOfItsEnds) {
  const EditResult result = run_edit(kept("bar_affine"));
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.matrix().topRows<3>() << 1.3, 0.25, -0.1, 0.4, -0.15, 0.8, 0.3, -0.2, 0.1, 0.05, 1.1, 0.3;
  EXPECT_LT(largest_distance(result.mesh.positions, image(result.rest, map)),
            1e-10 * box_diagonal(result.rest));
}

TEST(KeptScenarios, TheTwistedBarKeepsItsCrossSections) {
  EditFile edit = kept("bar_twist");
  const EditResult result = run_edit(edit, {.overrides = {.method = DeformMethod::ft05}});
  EXPECT_LT((result.mesh.positions.col(2) - result.rest.col(2)).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(KeptScenarios, TheHalfTubeReturnsToWhereItWasCut) {
  for (const MergeShape shape : {MergeShape::similar, MergeShape::ft05}) {
    const EditFile edit = kept("tube_on_tube");
    const EditResult result = run_edit(edit, {.overrides = {.shape = shape}, .keep = {"upper"}});
    const Points& upper = result.kept.at("upper").positions;
    const MergeOutcome& merge = result.report.steps.back().merge.value();
    ASSERT_GE(merge.grafted.rows(), upper.rows());
    EXPECT_LT(largest_distance(merge.grafted.topRows(upper.rows()), upper), 1e-9 * box_diagonal(upper));
    EXPECT_LT(merge.report.pairs.front().misfit_rel, 1e-9);
  }
}

TEST(KeptScenarios, TheHeadComesOutTheSameWithoutItsPose) {
  EditFile edit = kept("head_on_bust_posed");
  const Mesh posed = run_edit(edit).mesh;
  std::get<MergeStep>(edit.steps.back().action).source_transform.reset();
  const Mesh as_made = run_edit(edit).mesh;
  ASSERT_EQ(posed.vertex_count(), as_made.vertex_count());
  EXPECT_LT(largest_distance(posed.positions, as_made.positions), 1e-8 * box_diagonal(as_made.positions));
}

TEST(KeptScenarios, TheRingIsClosedAgain) {
  const TopologySummary topology = summarise_topology(run_edit(kept("ring_of_two_arcs")).mesh);
  EXPECT_TRUE(topology.closed);
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.genus.value(), 1);
}

TEST(KeptScenarios, TheDroppedTubeStaysOpen) {
  const TopologySummary topology = summarise_topology(run_edit(kept("tube_dropped_on_sheet")).mesh);
  EXPECT_EQ(topology.boundary_loops, 2);
  EXPECT_EQ(topology.genus.value(), 0);
}

class EveryScenario : public testing::TestWithParam<Scenario> {};

TEST_P(EveryScenario, GivesTheSameBytesForAnyNumberOfThreads) {
  const EditFile edit = read_scenario(GetParam(), coarse);
  const Mesh first = run_edit(edit, plain, {.threads = 2}).mesh;
  for (const int threads : {2, 1}) {
    const Mesh again = run_edit(edit, plain, {.threads = threads}).mesh;
    EXPECT_TRUE(same_bytes(again.positions, first.positions)) << threads << " threads";
    EXPECT_TRUE(again.faces == first.faces) << threads << " threads";
  }
}

std::vector<Scenario> of_both_kinds(std::vector<Scenario> (*list)(StepKind)) {
  std::vector<Scenario> all = list(StepKind::deform);
  for (Scenario& scenario : list(StepKind::merge)) all.push_back(std::move(scenario));
  return all;
}

INSTANTIATE_TEST_SUITE_P(Kept, EveryScenario, testing::ValuesIn(of_both_kinds(kept_scenarios)),
                         name_of_scenario);
INSTANTIATE_TEST_SUITE_P(Examples, EveryScenario, testing::ValuesIn(of_both_kinds(examples)), name_of_scenario);
INSTANTIATE_TEST_SUITE_P(Data, EveryScenario, testing::ValuesIn(of_both_kinds(data_scenarios)),
                         name_of_scenario);

}  // namespace
}  // namespace meshgraft::test
