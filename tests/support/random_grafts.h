#pragma once

#include <cstdint>
#include <string>
#include <vector>

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

/// What a result's topology, coordinates and index maps violate, a sentence each; none for a valid one.
std::vector<std::string> faults_of(const RandomGraft& graft, const MergeResult& result);

}  // namespace meshgraft::test
