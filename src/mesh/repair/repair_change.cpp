#include <meshgraft/mesh/repair.h>

#include <stdexcept>

#include "mesh/facts.h"
#include "repair_surface.h"

namespace meshgraft {

std::string_view name_of(RepairChangeKind kind) {
  switch (kind) {
    case RepairChangeKind::removed_out_of_range_face: return "removed-out-of-range-face";
    case RepairChangeKind::removed_non_finite_face: return "removed-non-finite-face";
    case RepairChangeKind::removed_non_finite_vertex: return "removed-non-finite-vertex";
    case RepairChangeKind::removed_outlying_vertex: return "removed-outlying-vertex";
    case RepairChangeKind::mended_degenerate_face: return "mended-degenerate-face";
    case RepairChangeKind::removed_duplicate_face: return "removed-duplicate-face";
    case RepairChangeKind::removed_zero_area_face: return "removed-zero-area-face";
    case RepairChangeKind::removed_duplicate_shell: return "removed-duplicate-shell";
    case RepairChangeKind::welded_vertex: return "welded-vertex";
    case RepairChangeKind::split_t_junction: return "split-t-junction";
    case RepairChangeKind::split_non_manifold_vertex: return "split-non-manifold-vertex";
    case RepairChangeKind::removed_non_manifold_face: return "removed-non-manifold-face";
    case RepairChangeKind::removed_debris: return "removed-debris";
    case RepairChangeKind::turned_face: return "turned-face";
    case RepairChangeKind::turned_component: return "turned-component";
    case RepairChangeKind::rejoined_vertex: return "rejoined-vertex";
    case RepairChangeKind::filled_hole: return "filled-hole";
    case RepairChangeKind::removed_isolated_vertex: return "removed-isolated-vertex";
  }
  return "";
}

Note note_of(RepairChangeKind kind, Index count) {
  switch (kind) {
    case RepairChangeKind::removed_out_of_range_face: return facts::mesh::RemovedOutOfRangeFace{.count = count};
    case RepairChangeKind::removed_non_finite_face: return facts::mesh::RemovedNonFiniteFace{.count = count};
    case RepairChangeKind::removed_non_finite_vertex:
      return facts::mesh::RemovedNonFiniteVertex{.count = count};
    case RepairChangeKind::removed_outlying_vertex: return facts::mesh::RemovedOutlyingVertex{.count = count};
    case RepairChangeKind::mended_degenerate_face: return facts::mesh::MendedDegenerateFace{.count = count};
    case RepairChangeKind::removed_duplicate_face: return facts::mesh::RemovedDuplicateFace{.count = count};
    case RepairChangeKind::removed_zero_area_face: return facts::mesh::RemovedZeroAreaFace{.count = count};
    case RepairChangeKind::removed_duplicate_shell: return facts::mesh::RemovedDuplicateShell{.count = count};
    case RepairChangeKind::welded_vertex: return facts::mesh::WeldedVertex{.count = count};
    case RepairChangeKind::split_t_junction: return facts::mesh::SplitTJunction{.count = count};
    case RepairChangeKind::split_non_manifold_vertex:
      return facts::mesh::SplitNonManifoldVertex{.count = count};
    case RepairChangeKind::removed_non_manifold_face:
      return facts::mesh::RemovedNonManifoldFace{.count = count};
    case RepairChangeKind::removed_debris: return facts::mesh::RemovedDebris{.count = count};
    case RepairChangeKind::turned_face: return facts::mesh::TurnedFace{.count = count};
    case RepairChangeKind::turned_component: return facts::mesh::TurnedComponent{.count = count};
    case RepairChangeKind::rejoined_vertex: return facts::mesh::RejoinedVertex{.count = count};
    case RepairChangeKind::filled_hole: return facts::mesh::FilledHole{.count = count};
    case RepairChangeKind::removed_isolated_vertex: return facts::mesh::RemovedIsolatedVertex{.count = count};
  }
  throw std::logic_error("no such kind of change");
}

}  // namespace meshgraft
