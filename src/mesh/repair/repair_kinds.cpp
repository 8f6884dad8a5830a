#include "repair_kinds.h"

namespace meshgraft {

namespace {

constexpr RepairOptions only_invalid{.clean_faces = false,
                                     .remove_duplicate_shells = false,
                                     .weld = false,
                                     .split_non_manifold = false,
                                     .remove_debris = false,
                                     .unify_winding = false,
                                     .hole_edges = 0,
                                     .remove_isolated = false};

void switch_on_for(FindingKind kind, RepairOptions& options) {
  switch (kind) {
    case FindingKind::degenerate_face:
    case FindingKind::duplicate_face: options.clean_faces = true; break;
    case FindingKind::zero_area_face:
      options.clean_faces = true;
      // Only where what lies together is joined does a face without area leave no hole.
      options.weld = true;
      break;
    case FindingKind::isolated_vertex: options.remove_isolated = true; break;
    case FindingKind::duplicate_vertex: options.weld = true; break;
    case FindingKind::non_manifold_edge:
    case FindingKind::non_manifold_vertex: options.split_non_manifold = true; break;
    case FindingKind::inconsistent_winding:
    case FindingKind::inward_facing_component: options.unify_winding = true; break;
    case FindingKind::non_finite:
    case FindingKind::outlying_vertex:
    case FindingKind::index_out_of_range:
    case FindingKind::coordinate_too_large:
    case FindingKind::polygon: break;
  }
}

}  // namespace

bool is_repairable(FindingKind kind) {
  return kind != FindingKind::coordinate_too_large && kind != FindingKind::polygon;
}

RepairOptions repair_for(std::span<const FindingKind> kinds) {
  RepairOptions options = only_invalid;
  for (const FindingKind kind : kinds) switch_on_for(kind, options);
  return options;
}

}  // namespace meshgraft
