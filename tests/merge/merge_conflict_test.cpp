
#include <vector>

#include <gtest/gtest.h>

#include "merge/merge_conflict.h"

namespace meshgraft {
namespace {

struct Contradiction {
  MergeConflict conflict;
  MergeRequest request;
};

// Each conflict with a request that has no other.
std::vector<Contradiction> contradictions() {
  return {
      {MergeConflict::dropped_with_pairs, {.dropped = true, .pairs_given = true}},
      {MergeConflict::dropped_with_matches, {.dropped = true, .matches_given = true}},
      {MergeConflict::dropped_pose_kept, {.pose = MergePose::keep, .dropped = true}},
      {MergeConflict::posed_twice, {.transform_given = true, .aligned_pairs = 3}},
      {MergeConflict::too_few_aligned, {.aligned_pairs = 2}},
      {MergeConflict::reach_given_twice, {.reach_rings_given = true, .reach_length_given = true}},
      {MergeConflict::fixed_pose_found, {.fixed_given = true}},
      {MergeConflict::size_pose_kept, {.pose = MergePose::keep, .size_given = true}},
  };
}

TEST(MergeConflict, IsFoundForEachContradiction) {
  for (const auto& [conflict, request] : contradictions())
    EXPECT_EQ(find_conflict(request), conflict) << static_cast<int>(conflict);
}

TEST(MergeConflict, IsFoundInTheOrderOfTheEnumerators) {
  MergeRequest all{.dropped = true,
                   .pairs_given = true,
                   .matches_given = true,
                   .transform_given = true,
                   .aligned_pairs = 0,
                   .reach_rings_given = true,
                   .reach_length_given = true,
                   .fixed_given = true,
                   .size_given = true};
  EXPECT_EQ(find_conflict(all), MergeConflict::dropped_with_pairs);
  all.pairs_given = false;
  EXPECT_EQ(find_conflict(all), MergeConflict::dropped_with_matches);
  all.dropped = false;
  EXPECT_EQ(find_conflict(all), MergeConflict::posed_twice);
  all.transform_given = false;
  EXPECT_EQ(find_conflict(all), MergeConflict::too_few_aligned);
  all.aligned_pairs.reset();
  EXPECT_EQ(find_conflict(all), MergeConflict::reach_given_twice);
  all.reach_rings_given = false;
  EXPECT_EQ(find_conflict(all), MergeConflict::fixed_pose_found);
  all.pose = MergePose::keep;
  EXPECT_EQ(find_conflict(all), MergeConflict::size_pose_kept);
  all.size_given = false;
  EXPECT_EQ(find_conflict(all), std::nullopt);
}

TEST(MergeConflict, IsNotFoundInWhatGoesTogether) {
  const std::vector<MergeRequest> requests = {
      {},
      {.pairs_given = true, .matches_given = true, .transform_given = true, .size_given = true},
      {.dropped = true, .aligned_pairs = 3, .reach_rings_given = true, .size_given = true},
      {.pose = MergePose::keep, .pairs_given = true, .reach_length_given = true, .fixed_given = true},
  };
  for (std::size_t i = 0; i < requests.size(); ++i) EXPECT_EQ(find_conflict(requests[i]), std::nullopt) << i;
}

}  // namespace
}  // namespace meshgraft
