#pragma once

#include <span>
#include <vector>

#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Measures the distortion of a source: `rest` and `grafted` n×3, `far` the vertices beyond the influence
/// radius, `component` their connected component. For a source of several components, returns the worst
/// numbers and the similarity of the largest one.
ShapeReport measure_shape(const Points& rest, const Points& grafted, const Triangles& triangles,
                          std::span<const Index> far, const std::vector<Index>& component);

}  // namespace meshgraft
