#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge.h>

namespace meshgraft::test {

/// A graft of one built-in model on another, both cut at random, by random options.
struct RandomGraft {
  std::string text;  ///< what it is made of, for people
  Mesh target, source;
  std::vector<MergePair> pairs;
  MergeOptions options;
};

/// The same number always gives the same graft.
RandomGraft make_random_graft(std::uint64_t seed);

/// What became of a graft: a result, or the reason why there is none.
struct Attempt {
  std::optional<MergeResult> result;
  std::optional<Error> refusal;
};

/// Merges.
Attempt attempt(const RandomGraft& graft);

/// Does what a refusal's remedy says, as a person would: gives the pair the start that it names. False where
/// it names none.
bool follow_remedy(RandomGraft& graft, const Error& refusal);

/// How well two loops with their normals lie on one another after the best similarity, × their radius (root
/// mean square): at the best of all starts, at the best one a twelfth of a turn or more away from it, and at
/// the worst. Found by trying them, without what the library finds starts by.
struct LoopFit {
  double best = 0, rival = 0, worst = 0;

  /// Whether the best start is hardly better than a different one.
  bool is_ambiguous() const;
};

LoopFit fit_of_loops(const RandomGraft& graft, std::size_t pair);

/// What a result's topology, coordinates, faces and index maps violate, a sentence each; none for a valid one.
std::vector<std::string> faults_of(const RandomGraft& graft, const MergeResult& result);

/// Pairs of triangles of a result that intersect.
struct Intersections {
  Index new_ones = 0;  ///< beyond those of the target and of the source
  Index of_seam = 0;   ///< with a triangle of the seam in them
};

Intersections intersections_of(const RandomGraft& graft, const MergeResult& result);

}  // namespace meshgraft::test
