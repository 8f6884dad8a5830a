#pragma once

#include <memory>
#include <numbers>
#include <optional>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>

#include "footprint.h"

namespace meshgraft {

/// Ratio of each size that is tried to the previous one.
inline constexpr double next_size_ratio = std::numbers::sqrt2 / 2;

/// An outline on a target that has room for it.
struct FitResult {
  std::shared_ptr<const Chart> chart;
  Footprint footprint;
  Placement placement;
  double size = 1;
};

/// The result of trying a size.
struct SizeTrial {
  std::shared_ptr<const FitResult> fit;  ///< null where the outline has no room
  std::optional<Note> misfit;            ///< reason, where `fit` is null
};

/// The range of sizes that are tried for a loop on a target.
struct SizeRange {
  SizeRange(const Mesh& target, const FlatLoop& loop);
  double least, largest;
};

/// Tries sizes of a loop at one point of a target. Keeps references to its arguments.
class SizeSearch {
 public:
  /// Makes the chart once, for sizes up to `largest`.
  SizeSearch(const Mesh& target, const FlatLoop& loop, const Drop& drop, double largest,
             const Context& context);

  /// Tries a size. Without `may_widen` the hole must be as wide as the loop without widening the outline
  /// much.
  SizeTrial at(double size, bool may_widen) const;

  /// Returns the largest size below `size` that fits, to three digits. Returns 0 where none from `least` on
  /// fits.
  double largest_below(double size, double least) const;

 private:
  double chart_radius(double size) const { return most_widened * size * loop_.outline.reach(); }

  const FlatLoop& loop_;
  const Drop& drop_;
  const Context& context_;
  std::shared_ptr<const Chart> chart_;
};

}  // namespace meshgraft
