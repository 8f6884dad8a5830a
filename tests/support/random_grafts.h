#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge.h>

namespace meshgraft::test {

/// A graft of one built-in model on another, both cut at random, with random options.
struct RandomGraft {
  std::string text;  ///< description of models, cuts and options
  Mesh target, source;
  std::vector<MergePair> pairs;
  MergeOptions options;
};

/// Returns the same graft for the same seed.
RandomGraft make_random_graft(std::uint64_t seed);

/// The outcome of a graft: a result or a refusal.
struct Attempt {
  std::optional<MergeResult> result;
  std::optional<Error> refusal;
};

/// Merges and returns the result, or the error that the merge throws.
Attempt attempt(const RandomGraft& graft);

/// Follows a refusal's remedy: gives the pair the start that the refusal names. Returns false if it names none.
bool follow_remedy(RandomGraft& graft, const Error& refusal);

/// Root mean square distance of two loops with their normals after the best similarity, × their radius. `best`
/// and `worst` are over all starts; `rival` is the best at least a twelfth of a turn away from `best`. All
/// starts are tried, independently of how the library finds starts.
struct LoopFit {
  double best = 0, rival = 0, worst = 0;

  /// Returns whether the best start is hardly better than `rival`.
  bool is_ambiguous() const;
};

LoopFit fit_of_loops(const RandomGraft& graft, std::size_t pair);

}  // namespace meshgraft::test
