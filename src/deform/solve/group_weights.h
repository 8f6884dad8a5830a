#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

#include "linalg/sparse.h"
#include "surface_fields.h"

namespace meshgraft {

/// Connected groups of vertices with given values, and the weights that they spread over a surface. A field
/// that is constant on each group is a sum of the weights, which costs far less than a solve.
class GroupWeights {
 public:
  GroupWeights() = default;
  /// `given` flags the vertices with given values, which `fields` must have been built with.
  GroupWeights(const IndexLists& rings, std::span<const std::uint8_t> given, const SurfaceFields& fields,
               const Context& context);

  Index count() const { return count_; }
  /// Returns the group of each vertex, or -1 outside.
  const std::vector<Index>& group() const { return group_; }
  /// Returns the spread `indicators_of_groups`: one column per group unless there are many.
  const Columns& weights() const { return weights_; }

  /// Returns the values of each group (groups×k), or nothing if they differ within a group, or if there are so
  /// many groups that they share columns.
  std::optional<Columns> common_values(const Columns& values) const;
  /// Returns what `fields.spread(values)` does for the common values `of_groups` of `values`.
  Columns spread(const Columns& of_groups, const Columns& values, const SurfaceFields& fields,
                 const Context& context) const;

 private:
  Index count_ = 0;
  std::vector<Index> group_;
  Columns weights_;
};

}  // namespace meshgraft
