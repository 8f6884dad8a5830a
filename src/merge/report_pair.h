#pragma once

#include <span>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

#include "pair_geometry.h"

namespace meshgraft {

/// Returns the report on a matched pair, but for `misfit_rel`. The source's vertices from `given` on were added
/// by refinement; `met` leaves them out.
PairReport report_pair(const PairGeometry& pair, const Correspondence& correspondence, Index given);

/// Returns the RMS distance of a posed loop (k×3) from its constraints' positions, × their radius.
double misfit_rel(const Points& posed, std::span<const VertexConstraint> constraints);

}  // namespace meshgraft
