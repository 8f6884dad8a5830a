#pragma once

#include <memory>
#include <numbers>
#include <optional>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>

#include "footprint.h"
#include "mesh/mesh_part.h"

namespace meshgraft {

/// Ratio of each size that is tried to the previous one.
inline constexpr double next_size_ratio = std::numbers::sqrt2 / 2;

/// An outline on a target that has room for it.
struct FitResult {
  std::shared_ptr<const MeshPart> part;  ///< of the target, around the surface point
  std::shared_ptr<const Chart> chart;    ///< of the part, whose edges may have been halved
  std::vector<Index> face_parent;        ///< per face of the chart: the target's face that it is a piece of
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

/// Tries sizes of a loop at one point of a target. Keeps references to its arguments. It works on the part of
/// the target around the point, and widens the part where an outline needs more.
class SizeSearch {
 public:
  /// Makes the chart for sizes up to `largest`. Throws what `find_surface_point` throws.
  SizeSearch(const Mesh& target, const FlatLoop& loop, const Drop& drop, double largest,
             const Context& context);

  /// Tries a size. Without `may_widen` the hole must be as wide as the loop without widening the outline
  /// much.
  SizeTrial at(double size, bool may_widen);

  /// Returns the largest size below `size` that fits, to three digits. Returns 0 where none from `least` on
  /// fits.
  double largest_below(double size, double least);

  const PreparedTarget& target() const { return whole_.target; }

 private:
  double chart_radius(double size) const { return most_widened * size * loop_.outline.reach(); }
  void take_part();
  std::shared_ptr<const Chart> chart_of(std::shared_ptr<const Mesh> part, double size) const;
  bool reaches_rim(const Chart& chart) const;
  Index index_in_target(Index vertex) const;
  std::optional<FitResult> lay(double size, double longest) const;

  const Mesh& target_;
  const FlatLoop& loop_;
  const Drop& drop_;
  const Context& context_;
  double largest_;
  Chart whole_;                 // of the target
  std::vector<Index> charted_;  // vertices of the target that have coordinates in its chart
  int margin_ = 2;              // rings of the part around them
  std::shared_ptr<const MeshPart> part_;
  Flags at_rim_;                        // per vertex of the part: whether the target has more faces there
  Drop drop_on_part_;                   // with the part's index of its vertex
  std::shared_ptr<const Chart> chart_;  // of the part
};

}  // namespace meshgraft
