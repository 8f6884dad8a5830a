#pragma once

#include <cstddef>
#include <optional>

#include <meshgraft/merge/merge_options.h>

namespace meshgraft {

/// Tells which settings of a merge are given, as far as they may contradict each other. Each interface fills
/// in those that it offers.
struct MergeRequest {
  MergePose pose = MergePose::find;
  bool dropped = false;                             ///< onto a surface without a hole
  bool pairs_given = false, matches_given = false;  ///< loops and vertices that meet
  bool transform_given = false;                     ///< of the source, before the merge
  std::optional<std::size_t> aligned_pairs{};       ///< number of pairs that pose the source, if given
  bool reach_rings_given = false, reach_length_given = false;
  bool fixed_given = false, size_given = false;
};

/// Ways in which a merge contradicts itself.
enum class MergeConflict {
  dropped_with_pairs,    ///< the target's loop is made where the source is dropped
  dropped_with_matches,  ///< likewise
  dropped_pose_kept,     ///< the drop says where the source goes
  posed_twice,           ///< by a transform and by aligned pairs
  too_few_aligned,       ///< fewer pairs than `fewest_aligned_pairs`
  reach_given_twice,     ///< in rings and as a length
  fixed_pose_found,      ///< vertices are fixed while the pose is to be found
  size_pose_kept,        ///< the size is kept with the pose
};

/// Returns the first conflict of a request, in the order of the enumerators. Only this function decides which
/// settings of a merge exclude each other; callers turn the conflict into their own error. The library itself
/// allows a size with a kept pose.
std::optional<MergeConflict> find_conflict(const MergeRequest& request);

}  // namespace meshgraft
