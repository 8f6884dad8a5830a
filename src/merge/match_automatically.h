#pragma once

#include <span>
#include <vector>

#include "pair_geometry.h"

namespace meshgraft {

/// Finds the best cyclic alignment of each pair. It is the arc-length start from which a similarity maps the
/// loops, normals included, best onto one another. The pairs belong to one connected source and share the
/// similarity; loops without features of their own (circles) are thus placed by the others. With `posed` the
/// source is already in its pose, and nearness decides. Throws Error(input) with the id merge.ambiguous_start
/// where the best start is not distinguished from others: the loops alone do not determine which vertices meet.
/// Its location is the first such pair's; `ambiguous_starts` returns all of them.
std::vector<Correspondence> match_automatically(std::span<const PairGeometry> pairs, bool posed);

}  // namespace meshgraft
