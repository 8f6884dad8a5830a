#pragma once

#include <memory>
#include <numbers>
#include <string>

#include <meshgraft/core/context.h>

#include "footprint.h"

namespace meshgraft {

/// Sizes are tried in this ratio, each to the one before.
inline constexpr double next_size_ratio = std::numbers::sqrt2 / 2;

/// An outline on a target that has room for it.
struct FitResult {
  std::shared_ptr<const Chart> chart;
  Footprint footprint;
  Placement placement;
  double size = 1;
};

/// What came of trying a size.
struct SizeTrial {
  std::shared_ptr<const FitResult> fit;  ///< null where there is no room
  std::string misfit;                    ///< why there is none
};

/// Sizes that a loop may have on a target at all.
struct SizeRange {
  SizeRange(const Mesh& target, const FlatLoop& loop);
  double least, largest;
};

/// Tries sizes of a loop at one point of a target. Keeps references to them.
class SizeSearch {
 public:
  /// The chart is made once, for sizes up to `largest`.
  SizeSearch(const Mesh& target, const FlatLoop& loop, const Drop& drop, double largest,
             const Context& context);

  /// Without `may_widen` the hole has to be as wide as the loop without having been widened much.
  SizeTrial at(double size, bool may_widen) const;

  /// The largest size below one that does not fit, to three digits; 0 where none does.
  double largest_below(double size, double least) const;

 private:
  double reach(double size) const { return most_widened * size * loop_.outline.reach(); }

  const FlatLoop& loop_;
  const Drop& drop_;
  const Context& context_;
  std::shared_ptr<const Chart> chart_;
};

}  // namespace meshgraft
