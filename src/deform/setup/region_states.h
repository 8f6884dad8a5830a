#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/deform/options.h>
#include <meshgraft/deform/region.h>

namespace meshgraft {

/// The known position and transform of each vertex of the whole mesh before the solve.
struct VertexStates {
  Flags position, transform;
  std::vector<Index> feature;  ///< per vertex: index of its feature, or -1

  VertexStates(Index count, bool known)
      : position(static_cast<std::size_t>(count), known),
        transform(static_cast<std::size_t>(count), known),
        feature(static_cast<std::size_t>(count), -1) {}

  /// Returns whether the solve has to find the position or the transform.
  bool is_unknown(Index v) const { return !position[v] || !transform[v]; }
};

/// Throws Error(input) with the id core.no_such_vertex at `location` unless 0 ≤ vertex < count.
void require_vertex(Index vertex, Index count, const std::string& location);

/// Throws Error(input) with the id core.out_of_range at `location` unless low ≤ value ≤ high.
void require_between(double value, double low, double high, const char* location);

/// Throws Error(input) if a corner of a triangle is not a row of `rest`.
void require_triangles(const Points& rest, const Triangles& triangles);

/// Returns the states of a region. Vertices outside the region are known; vertices inside are unknown until a
/// constraint gives them.
VertexStates states_of_region(Index count, bool whole, std::span<const Index> region,
                              std::span<const Index> fixed);

/// Marks the features' vertices. Throws Error(input) if a feature is empty, or if its vertices belong to
/// another feature or a constraint.
void add_features(std::span<const Feature> features, VertexStates& states);

/// Throws Error(input) if a handle is empty or constrains nothing, two handles overlap, or one contains a
/// fixed vertex.
void require_disjoint(const Region& region, Index count);

/// The constrained vertices and whether their position and transform are given, in the order of the later
/// values.
struct ConstraintList {
  std::vector<Index> vertex;
  Flags gives_position, gives_transform;

  std::size_t size() const { return vertex.size(); }
  void add(Index v, bool position, bool transform, VertexStates& states);
  /// Throws Error(input) if a vertex does not exist, or is constrained twice or by nothing.
  void add(std::span<const VertexConstraint> constraints, VertexStates& states);
  /// Throws Error(usage) if the constraints do not match the list, Error(input) if a value cannot be used.
  void require_matching(std::span<const VertexConstraint> constraints) const;
};

/// Returns the states for a region's handles and features, and adds what the handles give to `constrained`.
/// Throws Error(input) for errors in triangles, region, handles or features.
VertexStates states_of_handles(const Points& rest, const Triangles& triangles, const Region& region,
                               ConstraintList& constrained);

/// Throws Error(input), naming the field, if an option of the method is out of range.
void require_usable(const DeformerOptions& options);
/// Throws Error(input) if a value of the constraint is not finite, or so large that squares overflow.
void require_usable(const VertexConstraint& constraint);
/// Throws Error(input) for an unusable anchor with this number on a mesh of `count` vertices.
void require_usable(const Anchor& anchor, std::size_t number, Index count);

/// Performs the check that `Deformer` makes before assembly. Throws Error(unsolvable) if the constraints do
/// not determine a connected free component.
void require_solvable(const Points& rest, const Triangles& triangles, const VertexStates& states,
                      std::span<const Anchor> anchors, const Context& context);

}  // namespace meshgraft
