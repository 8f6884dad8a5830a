#pragma once

#include <span>
#include <vector>

#include "repair_surface.h"

namespace meshgraft {

/// The boundary of a surface under repair, with the loops around its holes. Loops are lists of half-edges, in
/// the direction of the faces. Invalid after a change of the surface.
class HoleBoundary {
 public:
  HoleBoundary(const RepairSurface& surface, const RepairOptions& options);

  /// Returns the loops along the boundary, each within its component. Counts in `unsound` those of up to
  /// `most_edges` edges that are not simple.
  std::vector<std::vector<Index>> loops(Index most_edges, Index& unsound) const;

  /// Returns the loops around holes that touch another hole. Components may meet at a position without a common
  /// edge, and a vertex may have had several fans. There such a loop continues across the gap, on the next fan
  /// around the position. So it is the loop around a crack, with both sides of the crack. Each passes a
  /// position once.
  std::vector<std::vector<Index>> touching_loops() const;

  /// Returns the first vertex at the position at which a half-edge starts.
  Index position_of(Index half_edge) const { return position_[surface_.faces().corners()[half_edge]]; }

 private:
  void find_positions(const RepairOptions& options);
  void cross_gaps();
  void order_fans(std::span<const Index> fans);
  std::vector<std::vector<Index>> simple_loops(const std::vector<Index>& loop) const;

  static constexpr Index none = -1, several = -2;
  const RepairSurface& surface_;
  std::vector<std::vector<Index>> vertex_loops_;
  std::vector<Index> leaving_, arriving_;  // per vertex: its half-edge on the boundary, or none, or several
  std::vector<Index> position_;            // per vertex: the first boundary vertex at its position, or none
  std::vector<Index> across_;  // per vertex at which the boundary arrives: the one where a hole's continues
};

}  // namespace meshgraft
