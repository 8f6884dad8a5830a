#include "merge_conflict.h"

#include "pose_source.h"

namespace meshgraft {

std::optional<MergeConflict> find_conflict(const MergeRequest& request) {
  const bool kept = request.pose == MergePose::keep;
  if (request.dropped && request.pairs_given) return MergeConflict::dropped_with_pairs;
  if (request.dropped && request.matches_given) return MergeConflict::dropped_with_matches;
  if (request.dropped && kept) return MergeConflict::dropped_pose_kept;
  if (request.transform_given && request.aligned_pairs) return MergeConflict::posed_twice;
  if (request.aligned_pairs && *request.aligned_pairs < fewest_aligned_pairs)
    return MergeConflict::too_few_aligned;
  if (request.reach_rings_given && request.reach_length_given) return MergeConflict::reach_given_twice;
  if (request.fixed_given && !kept) return MergeConflict::fixed_pose_found;
  if (request.size_given && kept) return MergeConflict::size_pose_kept;
  return std::nullopt;
}

}  // namespace meshgraft
