#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/deform/deformer.h>

namespace meshgraft {

/// What is known of each vertex of the whole mesh before the solve.
struct VertexStates {
  Flags position, transform;
  std::vector<Index> feature;  ///< its number, or -1

  VertexStates(Index count, bool known)
      : position(static_cast<std::size_t>(count), known),
        transform(static_cast<std::size_t>(count), known),
        feature(static_cast<std::size_t>(count), -1) {}

  /// True where the solve has to find the position or the transform.
  bool is_unknown(Index v) const { return !position[v] || !transform[v]; }
};

/// Throws Error(input) at `location` unless 0 ≤ vertex < count.
void require_vertex(Index vertex, Index count, const std::string& location);

/// Throws Error(input) where a corner of a triangle is no row of `rest`.
void require_triangles(const Points& rest, const Triangles& triangles);

/// Vertices outside the region are known; those inside are not, until a constraint says otherwise.
VertexStates states_of_region(Index count, bool whole, std::span<const Index> region,
                              std::span<const Index> fixed);

/// Marks the features' vertices; throws Error(input) where one is empty, shared or constrained too.
void add_features(std::span<const Feature> features, VertexStates& states);

/// Throws Error(input) where a handle is empty or does nothing, two of them meet, or one meets the fixed part.
void require_disjoint(const Region& region, Index count);

/// What is constrained of which vertex, in an order that values are given in later.
struct ConstraintList {
  std::vector<Index> vertex;
  Flags gives_position, gives_transform;

  std::size_t size() const { return vertex.size(); }
  void add(Index v, bool position, bool transform, VertexStates& states);
  /// Throws Error(input) for a vertex that does not exist, is constrained twice, or by nothing.
  void add(std::span<const VertexConstraint> constraints, VertexStates& states);
  /// Throws Error(usage) where the constraints are not these, Error(input) for values that cannot be used.
  void require_matching(std::span<const VertexConstraint> constraints) const;
};

/// What is known of which vertex of the region, and in `constrained` what its handles give. Throws Error(input)
/// for what is wrong with triangles, region, handles or features.
VertexStates states_of_handles(const Points& rest, const Triangles& triangles, const Region& region,
                               ConstraintList& constrained);

/// Throws Error(input), naming the field, for an option of the method that is out of range.
void require_usable(const DeformerOptions& options);
/// Throws Error(input) where a value of the constraint is not finite or so large that squares are not.
void require_usable(const VertexConstraint& constraint);
/// The same for the anchor of that number on a mesh of `count` vertices.
void require_usable(const Anchor& anchor, std::size_t number, Index count);

/// What `Deformer` finds before it assembles anything: throws Error(unsolvable) where the constraints do not
/// hold a free component well enough.
void require_solvable(const Points& rest, const Triangles& triangles, const VertexStates& states,
                      std::span<const Anchor> anchors, const Context& context);

}  // namespace meshgraft
