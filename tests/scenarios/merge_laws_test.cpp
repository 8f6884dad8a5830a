// Laws of merging over the edit files that are kept, the examples, and the public merging tasks.
#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "edit_steps.h"
#include "merge/pose_source.h"
#include "mesh/box_diagonal.h"
#include "support/graft_faults.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

/// Checks a seam. Relaxation slides vertices until the angles of a strip are 17° or more.
void expect_sound_seam(const SeamReport& seam) {
  EXPECT_TRUE(seam.manifold && seam.oriented);
  EXPECT_EQ(seam.euler_characteristic, seam.expected_euler_characteristic);
  EXPECT_GT(seam.angle_p1_deg, 15);
}

double larger_surrounding_dihedral(const SeamReport& seam) {
  return std::max(seam.target_dihedral_p99_deg, seam.source_dihedral_p99_deg);
}

/// Options by which a public task, which names the shape `ft05`, is run by `similar` or not.
const RunOptions named_shape = plain;
RunOptions similar_shape() {
  RunOptions options = plain;
  options.overrides.shape = MergeShape::similar;
  return options;
}

class MergeScenarios : public testing::TestWithParam<Scenario> {
 protected:
  /// Runs the scenario and calls `visit` for its merge steps.
  static void visit_merge_steps(const std::function<void(const StepRun& run)>& visit, int largest_resolution,
                                const RunOptions& options) {
    visit_steps(read_scenario(GetParam(), largest_resolution), options, [&](const StepRun& run) {
      if (std::holds_alternative<MergeStep>(run.step.action)) visit(run);
    });
  }
};

/// Checks that a source ends with about the size that its loops ask for, and nearly with its shape.
void expect_size_and_shape(const MergeReport& report, double largest_distance_rel) {
  double asked = 1;
  for (const PairReport& pair : report.pairs)
    asked *= std::pow(pair.size_ratio, 1 / static_cast<double>(report.pairs.size()));
  EXPECT_GT(report.shape.similarity.scale, 0.7 * asked);
  EXPECT_LT(report.shape.similarity.scale, 1.3 * asked);
  EXPECT_LT(report.shape.distance_rel, largest_distance_rel);
}

class ExampleGrafts : public testing::TestWithParam<Scenario> {};

TEST_P(ExampleGrafts, OfOneSolveHaveTheSizeOfTheirLoops) {
  RunOptions by_ft05 = plain, as_published = plain;
  by_ft05.overrides.shape = MergeShape::ft05;
  as_published.overrides.preset = Preset::as_published;
  for (const RunOptions& options : {by_ft05, as_published})
    visit_steps(read_scenario(GetParam(), as_they_are), options, [&](const StepRun& run) {
      if (run.report.merge) expect_size_and_shape(run.report.merge->report, 0.025);
    });
}

INSTANTIATE_TEST_SUITE_P(Examples, ExampleGrafts, testing::ValuesIn(examples(StepKind::merge)),
                         name_of_scenario);

class LoopMergeScenarios : public MergeScenarios {
 protected:
  /// Calls `visit` with the call that each merge step makes.
  static void visit_merges(const std::function<void(const ResolvedMerge& merge)>& visit,
                           const RunOptions& options) {
    visit_merge_steps([&](const StepRun& run) { visit(resolve_merge(run)); }, coarse, options);
  }
};

TEST_P(MergeScenarios, JoinTwoSurfacesIntoOne) {
  visit_merge_steps(
      [](const StepRun& run) {
        const auto& step = std::get<MergeStep>(run.step.action);
        const MergeOutcome& merge = run.report.merge.value();
        const TopologySummary target = summarise_topology(run.before.at(step.target).mesh),
                              source = summarise_topology(run.before.at(step.source).mesh),
                              result = summarise_topology(run.result);
        // A drop opens a hole first.
        const Index opened = step.at ? 1 : 0, pairs = static_cast<Index>(merge.report.pairs.size());
        EXPECT_TRUE(result.manifold && result.oriented);
        EXPECT_EQ(result.euler_characteristic,
                  target.euler_characteristic + source.euler_characteristic - opened);
        EXPECT_EQ(result.boundary_loops, target.boundary_loops + source.boundary_loops + opened - 2 * pairs);
        EXPECT_EQ(result.closed, result.boundary_loops == 0);
        EXPECT_EQ(result.isolated_vertices, 0);
        EXPECT_EQ(merge.report.shape.inverted, 0);
        EXPECT_FALSE(merge.intersections.any_new());
        // A strip is bent like the surfaces that it joins.
        const SeamReport& seam = merge.report.seam;
        expect_sound_seam(seam);
        EXPECT_LT(seam.dihedral_p99_deg, larger_surrounding_dihedral(seam) + 3);
      },
      as_they_are, similar_shape());
}

/// Checks that two merges gave one result: the deformed source, and the mesh with its seam.
void expect_same(const MergeResult& first, const MergeResult& second) {
  const double size = box_diagonal(first.mesh.positions);
  EXPECT_LT(largest_distance(second.grafted, first.grafted), 1e-9 * size);
  ASSERT_EQ(second.mesh.vertex_count(), first.mesh.vertex_count());
  EXPECT_LT(largest_distance(second.mesh.positions, first.mesh.positions), 1e-9 * size);
}

TEST_P(LoopMergeScenarios, DoNotDependOnTheSourcesPose) {
  const auto law = [](const ResolvedMerge& merge) {
    if (merge.options.pose == MergePose::keep) GTEST_SKIP() << "the pose is kept";
    const double scale = 1.7;
    const Eigen::Affine3d similarity = Eigen::Translation3d(3, -2, 5) *
                                       Eigen::AngleAxisd(2.3, Eigen::Vector3d(1, 2, -0.5).normalized()) *
                                       Eigen::Scaling(scale);
    MergeOptions options = merge.options;
    if (options.reach.length) *options.reach.length *= scale;
    if (options.size) *options.size /= scale;
    expect_same(merge_meshes(merge.target, merge.source, merge.pairs, merge.options),
                merge_meshes(merge.target, transformed(merge.source, similarity, {}), merge.pairs, options));
  };
  RunOptions ft05 = plain;
  ft05.overrides.shape = MergeShape::ft05;
  for (const RunOptions& options : {similar_shape(), ft05}) visit_merges(law, options);
}

TEST_P(LoopMergeScenarios, DoNotDependOnWhereTheirLoopsAreListedFrom) {
  visit_merges(
      [](const ResolvedMerge& merge) {
        const MergeResult first = merge_meshes(merge.target, merge.source, merge.pairs, merge.options);
        for (const double fraction : {0.01, 0.4}) {
          std::vector<MergePair> pairs = merge.pairs;
          for (MergePair& pair : pairs) {
            const auto turn = [](std::vector<Index>& loop, double by) {
              const auto steps = static_cast<std::ptrdiff_t>(by * static_cast<double>(loop.size()));
              std::rotate(loop.begin(), loop.begin() + 1 + steps, loop.end());
            };
            turn(pair.loops.source, fraction);
            turn(pair.loops.target, 0.7 * fraction);
          }
          expect_same(first, merge_meshes(merge.target, merge.source, pairs, merge.options));
        }
      },
      named_shape);
}

TEST_P(LoopMergeScenarios, AreSoundFromStartsBesideTheBest) {
  visit_merges(
      [](const ResolvedMerge& merge) {
        const MergeResult first = merge_meshes(merge.target, merge.source, merge.pairs, merge.options);
        for (const int shift : {-4, 4}) {
          SCOPED_TRACE(fmt::format("shifted by {}", shift));
          RandomGraft graft{"", merge.target, merge.source, merge.pairs, merge.options};
          // One pair alone: to shift both ends of a tube would twist it.
          const std::vector<Index>& loop = graft.pairs.front().loops.target;
          const Match start = first.report.pairs.front().start;
          const auto at = std::find(loop.begin(), loop.end(), start.target) - loop.begin();
          const auto count = static_cast<std::ptrdiff_t>(loop.size());
          graft.pairs.front().matches = {
              {start.source, loop[static_cast<std::size_t>((at + shift + count) % count)]}};
          const MergeResult shifted = merge_meshes(graft.target, graft.source, graft.pairs, graft.options);
          EXPECT_EQ(faults_of(graft, shifted), std::vector<std::string>());
          const ShapeReport& shape = shifted.report.shape;
          EXPECT_EQ(shape.inverted, 0);
          if (summarise_topology(merge.source).components == 1) {  // loose parts may meet when one is turned
            EXPECT_EQ(intersections_of(graft, shifted).new_ones, 0);
          }
          EXPECT_LT(shape.distance_rel, 1e-9);
          EXPECT_GT(shape.smallest_singular_p5, 0.7 * first.report.shape.smallest_singular_p5);
          // The source is twisted by up to an eighth of a turn. Folds are reduced to 45°.
          const SeamReport& seam = shifted.report.seam;
          expect_sound_seam(seam);
          EXPECT_LT(seam.dihedral_p99_deg, std::max(45.0, larger_surrounding_dihedral(seam)));
        }
      },
      similar_shape());
}

INSTANTIATE_TEST_SUITE_P(Kept, MergeScenarios, testing::ValuesIn(kept_scenarios(StepKind::merge)),
                         name_of_scenario);
INSTANTIATE_TEST_SUITE_P(Examples, MergeScenarios, testing::ValuesIn(examples(StepKind::merge)),
                         name_of_scenario);
INSTANTIATE_TEST_SUITE_P(Data, MergeScenarios, testing::ValuesIn(data_scenarios(StepKind::merge)),
                         name_of_scenario);
INSTANTIATE_TEST_SUITE_P(Kept, LoopMergeScenarios, testing::ValuesIn(kept_scenarios(StepKind::loop_merge)),
                         name_of_scenario);
INSTANTIATE_TEST_SUITE_P(Examples, LoopMergeScenarios, testing::ValuesIn(examples(StepKind::loop_merge)),
                         name_of_scenario);
INSTANTIATE_TEST_SUITE_P(Data, LoopMergeScenarios, testing::ValuesIn(data_scenarios(StepKind::loop_merge)),
                         name_of_scenario);

}  // namespace
}  // namespace meshgraft::test
