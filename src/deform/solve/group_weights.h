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
/// that is constant on each group is a sum of the weights, which costs far less than a solve. The weights hold
/// for the given vertices of one `SurfaceFields`, whatever their values.
class GroupWeights {
 public:
  GroupWeights() = default;
  /// `given` flags the vertices with given values, which `fields` must have been built with.
  GroupWeights(const IndexLists& rings, std::span<const std::uint8_t> given, const SurfaceFields& fields,
               const Context& context);

  Index count() const { return count_; }
  /// Returns the group of each vertex, or -1 outside.
  const std::vector<Index>& group() const { return group_; }
  /// Returns the spread `indicators_of_groups`: one column per group, or shared ones for more than 16 groups.
  const Columns& weights() const { return weights_; }

  /// Returns the values of each group (groups×k), or nothing if they differ within a group, or if groups share
  /// columns.
  std::optional<Columns> common_values(const Columns& values) const;
  /// Returns what `spread(values)` of the constructor's fields does for the common values `of_groups` of
  /// `values`.
  Columns spread(const Columns& of_groups, Columns values, const Context& context) const;

 private:
  Index count_ = 0;
  std::vector<Index> group_, first_group_;  ///< per vertex: its group, and the first group of its component
  Columns weights_;
};

}  // namespace meshgraft
