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

/// The options of random grafts.
enum class GraftKind : std::uint8_t {
  any,    ///< all of them, also those that ask for what cannot be well: random starts, poses by hand, any size
  found,  ///< shape `similar`; pose and start are found, and a size is 0.7 to 1.4 × the ratio of the loops
};

/// Returns the same graft for the same seed.
RandomGraft make_random_graft(std::uint64_t seed, GraftKind kind = GraftKind::any);

/// The outcome of a graft: a result or a refusal.
struct Attempt {
  std::optional<MergeResult> result;
  std::optional<Error> refusal;
};

/// Merges and returns the result, or the error that the merge throws.
Attempt attempt(const RandomGraft& graft);

}  // namespace meshgraft::test
