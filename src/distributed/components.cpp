#include "components.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>

#include <Eigen/SVD>

#include <meshgraft/core/error.h>

#include "deform/facts.h"
#include "mesh/disjoint_sets.h"

namespace meshgraft::distributed {

std::vector<Number> find_components(const Communicator& comm, const LocalMesh& mesh,
                                    std::span<const std::uint8_t> flagged, std::span<const Number> names) {
  const Index count = mesh.vertices.size();
  DisjointSets sets(count);
  for (Index v = 0; v < count; ++v)
    for (const Index w : mesh.rings[v])
      if (flagged[v] && flagged[w]) sets.unite(v, w);
  std::vector<Number> labels(count, -1);
  for (Index v = 0; v < count; ++v)
    if (flagged[v]) labels[v] = names[v];
  for (bool changed = true; comm.any(changed);) {
    std::vector<Number> smallest = labels;
    for (Index v = 0; v < count; ++v)
      if (flagged[v]) smallest[sets.root(v)] = std::min(smallest[sets.root(v)], labels[v]);
    changed = false;
    for (Index v = 0; v < count; ++v) {
      if (!flagged[v]) continue;
      changed = changed || labels[v] != smallest[sets.root(v)];
      labels[v] = smallest[sets.root(v)];
    }
    mesh.vertices.update(labels);
  }
  return labels;
}

namespace {

/// Sums over the vertices of a component, on one rank or on all.
struct ComponentPart {
  Number label = -1;
  Number size = 0;
  Number has_free = 0, has_transform = 0;
  Number positions = 0;             ///< vertices with given positions that constrain it
  std::array<double, 3> sum{};      ///< of their positions
  std::array<double, 6> scatter{};  ///< Σ d dᵀ about their mean: xx, yy, zz, xy, xz, yz
};

using Parts = std::map<Number, ComponentPart>;

/// Adds up the ranks' parts of components, and returns to each rank the sums of those that it named.
Parts add_up(const Communicator& comm, const Parts& own) {
  ByRank<ComponentPart> to(comm.size());
  for (const auto& [label, part] : own) to[label % comm.size()].push_back(part);
  const ByRank<ComponentPart> from = comm.exchange(to);
  Parts sums;
  for (const auto& list : from)
    for (const ComponentPart& part : list) {
      ComponentPart& sum = sums[part.label];
      sum.label = part.label;
      sum.size += part.size;
      sum.has_free |= part.has_free;
      sum.has_transform |= part.has_transform;
      sum.positions += part.positions;
      for (std::size_t k = 0; k < 3; ++k) sum.sum[k] += part.sum[k];
      for (std::size_t k = 0; k < 6; ++k) sum.scatter[k] += part.scatter[k];
    }
  ByRank<ComponentPart> answers(comm.size());
  for (int rank = 0; rank < comm.size(); ++rank)
    for (const ComponentPart& part : from[rank]) answers[rank].push_back(sums[part.label]);
  Parts result;
  for (const auto& list : comm.exchange(answers))
    for (const ComponentPart& part : list) result[part.label] = part;
  return result;
}

/// Calls `body(label, vertex)` for each given position that constrains a component: those of its own vertices,
/// and of vertices beside it of which all is known. Each is met once, at the rank that owns the vertex.
template <class Body>
void for_each_position(const Part& part, const std::vector<Number>& labels, const Body& body) {
  std::vector<Number> beside;
  for (Index v = 0; v < part.mesh.vertices.own(); ++v) {
    if (labels[v] >= 0) {
      if (part.mask.position[v] || part.mask.anchored[v]) body(labels[v], v);
      continue;
    }
    beside.clear();
    for (const Index w : part.mesh.rings[v])
      if (labels[w] >= 0) beside.push_back(labels[w]);
    std::sort(beside.begin(), beside.end());
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    for (const Number label : beside) body(label, v);
  }
}

/// Returns the number of independent directions, 0 to 3, that the given positions span, or -1 without any.
int affine_rank(const ComponentPart& component) {
  if (component.positions == 0) return -1;
  const auto& s = component.scatter;
  Eigen::Matrix3d scatter;
  scatter << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2];
  const Eigen::Vector3d sigma = Eigen::JacobiSVD<Eigen::Matrix3d>(scatter).singularValues();
  constexpr double relative_thickness = 1e-6;
  int rank = 0;
  for (int k = 0; k < 3; ++k)
    if (sigma[k] > relative_thickness * relative_thickness * std::max(sigma[0], 1e-300)) ++rank;
  return sigma[0] > 1e-24 ? rank : 0;
}

Parts measure(const Communicator& comm, const Part& part, const std::vector<Number>& labels) {
  Parts own;
  const auto at = [&](Number label) -> ComponentPart& {
    own[label].label = label;
    return own[label];
  };
  for (Index v = 0; v < part.mesh.vertices.own(); ++v) {
    if (labels[v] < 0) continue;
    ComponentPart& component = at(labels[v]);
    ++component.size;
    component.has_free |= !part.mask.position[v];
    component.has_transform |= part.mask.transform[v];
  }
  for_each_position(part, labels, [&](Number label, Index v) {
    ComponentPart& component = at(label);
    ++component.positions;
    if (labels[v] < 0) component.has_transform = 1;  // both position and transform are known
    for (int k = 0; k < 3; ++k) component.sum[static_cast<std::size_t>(k)] += part.points(v, k);
  });
  const Parts sums = add_up(comm, own);
  for (auto& [label, component] : own) component.scatter = {};
  for_each_position(part, labels, [&](Number label, Index v) {
    const ComponentPart& all = sums.at(label);
    Eigen::Vector3d d = part.points.row(v).transpose();
    for (int k = 0; k < 3; ++k)
      d[k] -= all.sum[static_cast<std::size_t>(k)] / static_cast<double>(all.positions);
    auto& s = own[label].scatter;
    s[0] += d[0] * d[0], s[1] += d[1] * d[1], s[2] += d[2] * d[2];
    s[3] += d[0] * d[1], s[4] += d[0] * d[2], s[5] += d[1] * d[2];
  });
  return add_up(comm, own);
}

Flags unknown_vertices(const Part& part) {
  Flags unknown(part.mesh.vertices.size(), 0);
  for (Index v = 0; v < part.mesh.vertices.size(); ++v)
    unknown[v] = !part.mesh.rings[v].empty() && part.mask.is_unknown(v);
  return unknown;
}

}  // namespace

void fix_and_require_solvable(const Communicator& comm, Part& part) {
  const std::vector<Number> names(part.original.begin(), part.original.end());
  const std::vector<Number> labels = find_components(comm, part.mesh, unknown_vertices(part), names);
  const Parts components = measure(comm, part, labels);
  for (Index v = 0; v < part.mesh.vertices.own(); ++v)
    if (labels[v] >= 0 && components.at(labels[v]).has_free == 0) part.mask.transform[v] = 1;
  part.mesh.vertices.update(part.mask.transform);

  const auto is_held = [](const ComponentPart& component) {
    const int rank = affine_rank(component);
    return component.has_free == 0 || rank == 3 || (rank >= 0 && component.has_transform != 0);
  };
  constexpr Number none = std::numeric_limits<Number>::max();
  Number refused = none;
  for (const auto& [label, component] : components)
    if (!is_held(component)) refused = std::min(refused, label);
  refused = comm.smallest(refused);
  if (refused == none) return;
  // Components are numbered in the order of their smallest vertices, each at the rank that owns that vertex.
  Number before = 0;
  for (Index v = 0; v < part.mesh.vertices.own(); ++v)
    before += labels[v] == part.original[v] && labels[v] < refused && components.at(labels[v]).has_free != 0;
  const Number number = comm.sum(before) + 1;
  std::optional<Error> error;
  if (const auto found = components.find(refused); found != components.end()) {
    using facts::deform::Shape;
    static constexpr Shape shapes[] = {Shape::point, Shape::line, Shape::plane};
    const int rank = affine_rank(found->second);
    if (rank < 0)
      error = Error(
          facts::deform::ComponentNotHeld{.component = number, .count = found->second.size, .vertex = refused});
    else
      error = Error(facts::deform::ComponentHeldByPositions{
          .component = number, .count = found->second.size, .vertex = refused, .shape = shapes[rank]});
  }
  comm.agree(error);
}

}  // namespace meshgraft::distributed
