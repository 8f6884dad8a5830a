#include "validate_options.h"

#include <cmath>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "merge/facts.h"
#include "merge_conflict.h"
#include "mesh/box_diagonal.h"

namespace meshgraft {

namespace {

/// A size goes with a kept pose here: it scales the source at its loops.
void require_no_conflict(const MergeOptions& options) {
  const auto conflict = find_conflict({.pose = options.pose,
                                       .reach_rings_given = options.reach.rings.has_value(),
                                       .reach_length_given = options.reach.length.has_value(),
                                       .fixed_given = !options.fixed.empty()});
  if (conflict == MergeConflict::reach_given_twice) throw Error(facts::merge::ReachGivenTwice{}, "reach");
  if (conflict == MergeConflict::fixed_pose_found) throw Error(facts::merge::FixedWhilePoseFound{}, "fixed");
}

}  // namespace

void validate_options(const MergeOptions& options, const Mesh& source, const Mesh& target) {
  const auto require = [](bool good, const auto& fact, const char* field) {
    if (!good) throw Error(fact, field);
  };
  if (options.size) {
    constexpr double extreme = 1e6;
    const double same =
        box_diagonal(target.positions) / box_diagonal(source.positions);  // makes both equally large
    require(*options.size > 0, facts::core::NotPositive{.value = *options.size}, "size");
    require(!(*options.size < same / extreme),
            facts::merge::SizeMakesSourceTiny{.size = *options.size, .same_size = same}, "size");
    require(!(*options.size > same * extreme),
            facts::merge::SizeMakesSourceHuge{.size = *options.size, .same_size = same}, "size");
  }
  require(std::abs(options.normal_angle_deg) <= 180,
          facts::core::OutOfRange{.value = options.normal_angle_deg, .low = -180, .high = 180},
          "normal_angle_deg");
  if (const auto rings = options.reach.rings)
    require(*rings >= 1, facts::merge::ReachLessThanOneRing{.rings = *rings}, "reach");
  if (const auto length = options.reach.length)
    require(*length > 0, facts::core::NotPositive{.value = *length}, "reach");
  require_no_conflict(options);
  for (const Index v : options.fixed)
    require(v >= 0 && v < source.vertex_count(),
            facts::merge::NoSuchVertex{
                .side = facts::merge::Side::source, .vertex = v, .count = source.vertex_count()},
            "fixed");
}

}  // namespace meshgraft
