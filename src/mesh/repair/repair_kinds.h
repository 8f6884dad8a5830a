#pragma once

#include <span>

#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>

namespace meshgraft {

/// Returns whether a repair removes findings of this kind. It does not for coordinates that are too large, and
/// polygons are no defect.
bool is_repairable(FindingKind kind);

/// Returns the options of a repair that removes findings of these kinds. All steps that they do not need are
/// switched off. Invalid elements are removed in any case, because no other step works with them.
RepairOptions repair_for(std::span<const FindingKind> kinds);

}  // namespace meshgraft
