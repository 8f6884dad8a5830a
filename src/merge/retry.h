#pragma once

#include <functional>
#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/merge/merge_report.h>

#include "graft_meshes.h"
#include "match_meshes.h"

namespace meshgraft {

/// Values of settings that the options of a merge leave open.
struct Variation {
  int doublings = 0;  ///< of the influence radius, at least
  double normal_angle_deg = 0;
  double size_ratio = 1;   ///< × the size of the first graft
  int start = 0;           ///< of the starts that were found, the most probable first
  double start_shift = 0;  ///< of the start along the target's loop, × the loop's length
  auto operator<=>(const Variation&) const = default;
};

/// The settings that are left open.
struct OpenSettings {
  bool reach = false, normal_angle = false, size = false, start_shift = false;
  int starts = 1;  ///< of the first ones, any will do
};

/// The outcome of a search for a variation without faults.
struct FoundVariation {
  Variation best;
  double faults = 0;  ///< of the best one
  int tries = 0;
};

/// Largest numbers of tries: with one setting changed at a time, with all of them changed at once, and with all
/// of them changed a little.
struct MostTries {
  int one_by_one = 0, combined = 0, beside = 0;
  int sum() const { return one_by_one + combined + beside; }
};

/// Changes one setting after another, and keeps each change that has fewer faults than the best graft so far,
/// until one has none or no change helps. Then tries combinations of values of all open settings, and others
/// beside the best one, until one has no faults. `first` is the number of faults without a change; `faults_of`
/// returns those with a variation, infinity where it is not possible.
FoundVariation find_variation(const OpenSettings& open, double first, const MostTries& most,
                              const std::function<double(const Variation&)>& faults_of);

/// Grafts with other values of the settings that are left open, and keeps the graft with the fewest faults in
/// `best`.
RetryReport retry_graft(const MatchedMeshes& matched, std::span<const MergePair> pairs,
                        const MergeOptions& options, const Context& context, MadeGraft& best);

}  // namespace meshgraft
