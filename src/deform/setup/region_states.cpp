#include "region_states.h"

#include <cmath>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "core/facts.h"
#include "deform/facts.h"
#include "solvability.h"

namespace meshgraft {

void require_vertex(Index vertex, Index count, const std::string& location) {
  if (vertex < 0 || vertex >= count)
    throw Error(facts::core::NoSuchVertex{.vertex = vertex, .count = count}, location);
}

void require_between(double value, double low, double high, const char* location) {
  if (!(value >= low && value <= high))
    throw Error(facts::core::OutOfRange{.value = value, .low = low, .high = high}, location);
}

void require_triangles(const Points& rest, const Triangles& triangles) {
  const auto n = static_cast<Index>(rest.rows());
  for (Index t = 0; t < triangles.rows(); ++t)
    for (const Index v : triangles.row(t))
      if (v < 0 || v >= n) require_vertex(v, n, fmt::format("triangle {}", t));
}

VertexStates states_of_region(Index count, bool whole, std::span<const Index> region,
                              std::span<const Index> fixed) {
  VertexStates states(count, !whole);
  for (Index v : region) {
    require_vertex(v, count, "region");
    states.position[v] = states.transform[v] = 0;
  }
  for (Index v : fixed) {
    require_vertex(v, count, "fixed");
    states.position[v] = states.transform[v] = 1;
  }
  return states;
}

void add_features(std::span<const Feature> features, VertexStates& states) {
  const auto count = static_cast<Index>(states.feature.size());
  for (std::size_t f = 0; f < features.size(); ++f) {
    if (features[f].vertices.empty()) throw Error(facts::deform::NoVertices{}, fmt::format("feature {}", f));
    if (features[f].scale && !(*features[f].scale > 0 && *features[f].scale < 1e100))
      throw Error(facts::core::NotPositive{.value = *features[f].scale}, fmt::format("feature {}, scale", f));
    for (Index v : features[f].vertices) {
      require_vertex(v, count, fmt::format("feature {}", f));
      if (states.feature[v] >= 0)
        throw Error(facts::deform::VertexInTwoFeatures{.vertex = v}, fmt::format("feature {}", f));
      if (states.position[v] || states.transform[v])
        throw Error(facts::deform::FeatureVertexHeld{.vertex = v}, fmt::format("feature {}", f));
      states.feature[v] = static_cast<Index>(f);
    }
  }
}

void require_disjoint(const Region& region, Index count) {
  constexpr int nobody = -2, fixed = -1;
  std::vector<int> owner(static_cast<std::size_t>(count), nobody);
  for (Index v : region.fixed) {
    require_vertex(v, count, "fixed");
    owner[v] = fixed;
  }
  for (std::size_t h = 0; h < region.handles.size(); ++h) {
    const Handle& handle = region.handles[h];
    const std::string location = fmt::format("handle '{}'", handle.name);
    if (handle.vertices.empty()) throw Error(facts::deform::NoVertices{}, location);
    if (!handle.constrain_position && !handle.constrain_transform)
      throw Error(facts::deform::HandleConstrainsNothing{}, location);
    for (Index v : handle.vertices) {
      require_vertex(v, count, location);
      if (owner[v] == static_cast<int>(h)) throw Error(facts::deform::VertexNamedTwice{.vertex = v}, location);
      if (owner[v] == fixed) throw Error(facts::deform::VertexAlsoFixed{.vertex = v}, location);
      if (owner[v] != nobody)
        throw Error(facts::deform::VertexOfTwoHandles{.vertex = v, .handle = region.handles[owner[v]].name},
                    location);
      owner[v] = static_cast<int>(h);
    }
  }
}

void ConstraintList::add(Index v, bool position, bool transform, VertexStates& states) {
  // Outside the region both are known already. The one that is not given stays at rest.
  states.position[v] |= static_cast<std::uint8_t>(position);
  states.transform[v] |= static_cast<std::uint8_t>(transform);
  vertex.push_back(v);
  gives_position.push_back(position);
  gives_transform.push_back(transform);
}

void ConstraintList::add(std::span<const VertexConstraint> constraints, VertexStates& states) {
  const auto count = static_cast<Index>(states.position.size());
  Flags seen(states.position.size(), 0);
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    const VertexConstraint& constraint = constraints[c];
    const std::string location = fmt::format("constraint {}", c);
    require_vertex(constraint.vertex, count, location);
    if (seen[constraint.vertex]++)
      throw Error(facts::deform::VertexNamedTwice{.vertex = constraint.vertex}, location);
    if (!constraint.position && !constraint.transform)
      throw Error(facts::deform::VertexConstrainsNothing{.vertex = constraint.vertex}, location);
    add(constraint.vertex, constraint.position.has_value(), constraint.transform.has_value(), states);
  }
}

void ConstraintList::require_matching(std::span<const VertexConstraint> constraints) const {
  if (constraints.size() != size())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::constraints, .given = constraints.size(), .needed = size()});
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    const VertexConstraint& constraint = constraints[c];
    if (constraint.vertex != vertex[c] || constraint.position.has_value() != (gives_position[c] != 0) ||
        constraint.transform.has_value() != (gives_transform[c] != 0))
      throw Error(facts::deform::ConstraintDiffers{.constraint = c});
    require_usable(constraint);
  }
}

VertexStates states_of_handles(const Points& rest, const Triangles& triangles, const Region& region,
                               ConstraintList& constrained) {
  const auto n = static_cast<Index>(rest.rows());
  require_triangles(rest, triangles);
  require_disjoint(region, n);
  VertexStates states = states_of_region(n, region.whole, region.vertices, region.fixed);
  for (const Handle& handle : region.handles)
    for (const Index v : handle.vertices)
      constrained.add(v, handle.constrain_position, handle.constrain_transform, states);
  add_features(region.features, states);
  return states;
}

void require_usable(const DeformerOptions& options) {
  require_between(options.stiffness, 0, 1e6, "stiffness");
  require_between(options.iterations, 0, 1000, "iterations");
  require_between(options.smoothing_length_rel, 0, 10, "smoothing_length_rel");
}

void require_usable(const VertexConstraint& constraint) {
  if (constraint.rotation &&
      !(std::isfinite(constraint.rotation->angle()) && constraint.rotation->axis().allFinite()))
    throw Error(facts::core::NotFinite{.what = facts::core::Quantity::rotation},
                fmt::format("the constraint of vertex {}", constraint.vertex));
  const auto require = [&](const auto& matrix, facts::deform::Quantity what) {
    constexpr double largest = 1e100;  // so that squares and volumes stay finite
    if (matrix && !(matrix->array().abs() < largest).all())
      throw Error(facts::deform::TooLargeOrNotFinite{.what = what},
                  fmt::format("the constraint of vertex {}", constraint.vertex));
  };
  require(constraint.position, facts::deform::Quantity::position);
  require(constraint.transform, facts::deform::Quantity::transform);
}

void require_usable(const Anchor& anchor, std::size_t number, Index count) {
  require_vertex(anchor.vertex, count, fmt::format("anchor {}", number));
  if (!(anchor.weight > 0) || !std::isfinite(anchor.weight))
    throw Error(facts::core::NotPositive{.value = anchor.weight},
                fmt::format("anchor {} (vertex {}), weight", number, anchor.vertex));
  if (anchor.target && !anchor.target->allFinite())
    throw Error(facts::core::NotFinite{.what = facts::core::Quantity::target},
                fmt::format("anchor {} (vertex {})", number, anchor.vertex));
}

void require_solvable(const Points& rest, const Triangles& triangles, const VertexStates& states,
                      std::span<const Anchor> anchors, const Context& context) {
  const auto n = static_cast<Index>(rest.rows());
  const IndexLists faces_at = vertex_triangles(n, triangles, context);
  Flags unknown(static_cast<std::size_t>(n), 0);
  for (Index v = 0; v < n; ++v)
    unknown[v] = !faces_at[v].empty() && (!states.position[v] || !states.transform[v]);
  const Patch patch = make_patch(rest, triangles, faces_at, unknown, 1, context);
  KnownParts known;
  for (const Index v : patch.vertices) {
    known.position.push_back(states.position[v]);
    known.transform.push_back(states.transform[v]);
    known.feature.push_back(states.feature[v]);
  }
  known.anchored.assign(patch.vertices.size(), 0);
  for (const Anchor& anchor : anchors)
    if (const Index v = patch.local(anchor.vertex); v >= 0) known.anchored[v] = 1;
  const IndexLists rings = vertex_rings(patch.size(), patch.triangles, context);
  fix_unconstrained_components(rings, known);
  require_solvable(patch, rings, known);
}

}  // namespace meshgraft
