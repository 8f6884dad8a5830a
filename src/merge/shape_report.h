#pragma once

#include <span>
#include <vector>

#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// What became of a source's shape: `rest` and `grafted` n×3, `far` the vertices beyond reach, `component`
/// their connected component. Where a source has several components, the worst numbers and the largest one's
/// similarity.
ShapeReport measure_shape(const Points& rest, const Points& grafted, const Triangles& triangles,
                          std::span<const Index> far, const std::vector<Index>& component);

}  // namespace meshgraft
