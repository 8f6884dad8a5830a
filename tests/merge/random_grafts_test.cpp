// Random grafts give valid meshes.
// meshgraft_random_grafts makes more of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>

#include "support/graft_faults.h"
#include "support/random_grafts.h"

namespace meshgraft {
namespace {

class RandomGrafts : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomGrafts, GiveValidMeshesWithWellShapedSeams) {
  const test::RandomGraft graft = test::make_random_graft(GetParam());
  SCOPED_TRACE(graft.text);
  const test::Attempt made = test::attempt(graft);
  ASSERT_TRUE(made.result) << made.refusal->what();
  EXPECT_EQ(test::faults_of(graft, *made.result), std::vector<std::string>());
  const SeamReport& seam = made.result->report.seam;
  EXPECT_GT(seam.angle_p1_deg, 10);
  EXPECT_LT(seam.dihedral_p99_deg, std::max(seam.target_dihedral_p99_deg, seam.source_dihedral_p99_deg) + 5);
}

// These seeds once were slow (183, 246, 283), or had seams with folds or thin triangles.
INSTANTIATE_TEST_SUITE_P(Seeds, RandomGrafts,
                         testing::Values(4, 6, 10, 19, 22, 23, 36, 183, 246, 269, 274, 283),
                         testing::PrintToStringParamName());

/// The first that take less than a third of a second each.
/// FiveHundredFoundGrafts has all.
const std::vector<std::uint64_t> quick_seeds{1,  2,  3,  4,  5,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16,
                                             17, 18, 20, 21, 22, 23, 25, 26, 27, 29, 30, 31, 32, 34, 38,
                                             40, 41, 43, 45, 46, 48, 50, 52, 53, 54, 55, 57, 58, 59, 60,
                                             62, 63, 64, 66, 67, 68, 69, 70, 72, 73, 74, 75, 77, 78};

class FoundGrafts : public testing::TestWithParam<std::size_t> {};

TEST_P(FoundGrafts, HaveNoFaultsAtTheSeam) {
  constexpr std::size_t at_once = 15;
  const std::size_t begin = at_once * GetParam(), end = std::min(begin + at_once, quick_seeds.size());
  for (std::size_t k = begin; k < end; ++k) {
    const std::uint64_t seed = quick_seeds[k];
    const test::RandomGraft graft = test::make_random_graft(seed, test::GraftKind::found);
    SCOPED_TRACE(std::to_string(seed) + ": " + graft.text);
    const test::Attempt made = test::attempt(graft);
    ASSERT_TRUE(made.result) << made.refusal->what();
    EXPECT_EQ(test::faults_of(graft, *made.result), std::vector<std::string>());
    const MergeReport& report = made.result->report;
    EXPECT_EQ(report.shape.inverted, 0);
    EXPECT_EQ(report.seam.faults.folded_edges, 0);
    EXPECT_EQ(report.seam.faults.crossings, 0);
    EXPECT_EQ(report.seam.faults.far_crossings, 0);
    EXPECT_EQ(test::intersections_of(graft, *made.result).of_seam, 0) << "by an exact test of the whole mesh";
  }
}

INSTANTIATE_TEST_SUITE_P(Fifteen, FoundGrafts, testing::Range<std::size_t>(0, 4),
                         testing::PrintToStringParamName());

TEST(LoopsOfDifferentShape, AreNamedWhereTheSeamIsFolded) {
  const test::RandomGraft graft = test::make_random_graft(101);
  const test::Attempt made = test::attempt(graft);
  ASSERT_TRUE(made.result) << graft.text;
  const std::vector<Note>& notes = made.result->report.notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(),
                          [](const Note& note) { return note.id() == "merge.loops_differ"; }));
}

}  // namespace
}  // namespace meshgraft
