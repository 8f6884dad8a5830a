#include "solvability.h"

#include <algorithm>
#include <map>

#include <Eigen/SVD>

#include <meshgraft/core/error.h>

#include "deform/facts.h"
#include "mesh/disjoint_sets.h"

namespace meshgraft {

namespace {

struct Component {
  Index first = -1;  ///< local index of its smallest vertex
  Index size = 0;
  bool transform = false;
  std::vector<Index> positions;  ///< local indices of the vertices with given positions that constrain it
};

/// Returns the number of independent directions, 0 to 3, that the points span, or -1 if there are none.
int affine_rank(const Points& points, std::vector<Index>& vertices) {
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  if (vertices.empty()) return -1;
  Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
  for (Index v : vertices) mean += points.row(v);
  mean /= static_cast<double>(vertices.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (Index v : vertices) scatter += (points.row(v) - mean).transpose() * (points.row(v) - mean);
  const Eigen::Vector3d sigma = Eigen::JacobiSVD<Eigen::Matrix3d>(scatter).singularValues();
  constexpr double relative_thickness = 1e-6;
  int rank = 0;
  for (int k = 0; k < 3; ++k)
    if (sigma[k] > relative_thickness * relative_thickness * std::max(sigma[0], 1e-300)) ++rank;
  return sigma[0] > 1e-24 ? rank : 0;
}

[[noreturn]] void refuse(const Component& component, int rank, int number, const Patch& patch) {
  const Index vertex = patch.vertices[component.first];
  if (rank < 0)
    throw Error(
        facts::deform::ComponentNotHeld{.component = number, .count = component.size, .vertex = vertex});
  using facts::deform::Shape;
  static constexpr Shape shapes[] = {Shape::point, Shape::line, Shape::plane};
  throw Error(facts::deform::ComponentHeldByPositions{
      .component = number, .count = component.size, .vertex = vertex, .shape = shapes[rank]});
}

/// Returns whether the position or transform of v is unknown. Isolated vertices have no unknowns.
bool is_unknown(Index v, const IndexLists& rings, const ConstraintMask& mask) {
  return !rings[v].empty() && mask.is_unknown(v);
}

/// Joins vertices with an unknown along edges and within features.
DisjointSets join_unknown(const IndexLists& rings, const ConstraintMask& mask) {
  const Index n = rings.size();
  DisjointSets sets(n);
  std::map<Index, Index> feature_member;
  for (Index v = 0; v < n; ++v) {
    if (!is_unknown(v, rings, mask)) continue;
    for (Index w : rings[v])
      if (is_unknown(w, rings, mask)) sets.unite(v, w);
    if (mask.feature[v] >= 0) sets.unite(v, feature_member.try_emplace(mask.feature[v], v).first->second);
  }
  return sets;
}

}  // namespace

void fix_unconstrained_components(const IndexLists& rings, ConstraintMask& mask) {
  DisjointSets sets = join_unknown(rings, mask);
  Flags has_free(mask.position.size(), 0);
  for (Index v = 0; v < rings.size(); ++v)
    if (!mask.position[v]) has_free[sets.root(v)] = 1;
  for (Index v = 0; v < rings.size(); ++v)
    if (is_unknown(v, rings, mask) && !has_free[sets.root(v)]) mask.transform[v] = 1;
}

void require_solvable(const Patch& patch, const IndexLists& rings, const ConstraintMask& mask) {
  DisjointSets sets = join_unknown(rings, mask);
  std::map<Index, Component> components;  // by smallest vertex
  for (Index v = 0; v < patch.size(); ++v) {
    if (!is_unknown(v, rings, mask)) continue;
    Component& component = components[sets.root(v)];
    if (component.first < 0) component.first = v;
    ++component.size;
    if (mask.transform[v]) component.transform = true;
    if (mask.position[v] || mask.anchored[v]) component.positions.push_back(v);
    for (Index w : rings[v]) {
      if (is_unknown(w, rings, mask)) continue;
      component.transform = true;  // both position and transform of w are known
      component.positions.push_back(w);
    }
  }
  int number = 0;
  for (auto& [root, component] : components) {
    ++number;
    const int rank = affine_rank(patch.points, component.positions);
    const bool held = rank == 3 || (rank >= 0 && component.transform);
    if (!held) refuse(component, rank, number, patch);
  }
}

void require_solvable(const Points& rest, const Triangles& triangles, const ConstraintMask& mask,
                      const Context& context) {
  const auto n = static_cast<Index>(rest.rows());
  const IndexLists faces_at = vertex_triangles(n, triangles, context);
  Flags unknown(n, 0);
  for (Index v = 0; v < n; ++v) unknown[v] = !faces_at[v].empty() && mask.is_unknown(v);
  const Patch patch = make_patch(rest, triangles, faces_at, unknown, 1, context);
  ConstraintMask patch_mask = mask.of(patch.vertices);
  const IndexLists rings = vertex_rings(patch.size(), patch.triangles, context);
  fix_unconstrained_components(rings, patch_mask);
  require_solvable(patch, rings, patch_mask);
}

}  // namespace meshgraft
