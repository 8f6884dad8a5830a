#include "region_mask.h"

#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "checks.h"
#include "core/facts.h"
#include "deform/facts.h"

namespace meshgraft {

ConstraintMask mask_of_region(Index count, const Region& region) {
  ConstraintMask mask(count, !region.whole);
  for (Index v : region.vertices) {
    require_vertex(v, count, "region");
    mask.position[v] = mask.transform[v] = 0;
  }
  for (Index v : region.fixed) {
    require_vertex(v, count, "fixed");
    mask.position[v] = mask.transform[v] = 1;
  }
  return mask;
}

namespace {

/// Throws Error(input) if a handle is empty or constrains nothing, two handles overlap, or one contains a
/// fixed vertex.
void require_disjoint(const Region& region, Index count) {
  constexpr int nobody = -2, fixed = -1;
  std::vector<int> owner(count, nobody);
  for (Index v : region.fixed) {
    require_vertex(v, count, "fixed");
    owner[v] = fixed;
  }
  for (std::size_t h = 0; h < region.handles.size(); ++h) {
    const Handle& handle = region.handles[h];
    const Location location = Location::handle(handle.name);
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

/// Marks what is given at a vertex and appends it to the list. Outside the region both are known already. The
/// one that is not given stays at rest.
void add_constrained(Index v, bool position, bool transform, ConstraintMask& mask, ConstraintList& list) {
  mask.position[v] |= static_cast<std::uint8_t>(position);
  mask.transform[v] |= static_cast<std::uint8_t>(transform);
  list.vertex.push_back(v);
  list.gives_position.push_back(position);
  list.gives_transform.push_back(transform);
}

/// Throws Error(input) if a vertex does not exist, or is constrained twice or by nothing.
void add_constraints(std::span<const VertexConstraint> constraints, ConstraintMask& mask,
                     ConstraintList& list) {
  Flags seen(mask.position.size(), 0);
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    const VertexConstraint& constraint = constraints[c];
    const Location location = Location("constraints")[c];
    require_vertex(constraint.vertex, mask.size(), location);
    if (seen[constraint.vertex]++)
      throw Error(facts::deform::VertexNamedTwice{.vertex = constraint.vertex}, location);
    if (!constraint.position && !constraint.transform)
      throw Error(facts::deform::VertexConstrainsNothing{.vertex = constraint.vertex}, location);
    add_constrained(constraint.vertex, constraint.position.has_value(), constraint.transform.has_value(), mask,
                    list);
  }
}

/// Throws Error(input) if a feature is empty, or if its vertices belong to another feature or a constraint.
void add_features(std::span<const Feature> features, ConstraintMask& mask) {
  for (std::size_t f = 0; f < features.size(); ++f) {
    const Location location = Location("features")[f];
    if (features[f].vertices.empty()) throw Error(facts::deform::NoVertices{}, location);
    if (features[f].scale && !(*features[f].scale > 0 && *features[f].scale < 1e100))
      throw Error(facts::core::NotPositive{.value = *features[f].scale}, location / "scale");
    for (Index v : features[f].vertices) {
      require_vertex(v, mask.size(), location);
      if (mask.feature[v] >= 0) throw Error(facts::deform::VertexInTwoFeatures{.vertex = v}, location);
      if (mask.position[v] || mask.transform[v])
        throw Error(facts::deform::FeatureVertexHeld{.vertex = v}, location);
      mask.feature[v] = static_cast<Index>(f);
    }
  }
}

/// Throws Error(input) if a vertex does not exist, or a weight or target cannot be used.
void add_anchors(std::span<const Anchor> anchors, ConstraintMask& mask) {
  for (std::size_t a = 0; a < anchors.size(); ++a) {
    const Anchor& anchor = anchors[a];
    const Location location = Location("anchors")[a];
    require_vertex(anchor.vertex, mask.size(), location);
    if (!(anchor.weight > 0) || !std::isfinite(anchor.weight))
      throw Error(facts::core::NotPositive{.value = anchor.weight}, location / "weight");
    if (anchor.target && !anchor.target->allFinite())
      throw Error(facts::core::NotFinite{.what = facts::core::Quantity::target}, location);
    mask.anchored[anchor.vertex] = 1;
  }
}

}  // namespace

ConstraintMask make_mask(Index count, const Region& region, std::span<const VertexConstraint> constraints,
                         ConstraintList& constrained) {
  if (!region.handles.empty() && !constraints.empty()) throw Error(facts::deform::HandlesAndConstraints{});
  require_disjoint(region, count);
  ConstraintMask mask = mask_of_region(count, region);
  for (const Handle& handle : region.handles)
    for (const Index v : handle.vertices)
      add_constrained(v, handle.constrain_position, handle.constrain_transform, mask, constrained);
  add_constraints(constraints, mask, constrained);
  add_features(region.features, mask);
  add_anchors(region.anchors, mask);
  return mask;
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
    validate(constraint);
  }
}

}  // namespace meshgraft
