#include "outlying.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/percentile.h"
#include "face_defects.h"

namespace meshgraft {

namespace {

// The solve loses all digits of the near vertices between 1e7 and 1e10 radii.
constexpr double far_rel = 1e6;

// Returns whether three quarters of the vertices may lie within a millionth of the box's longest side, as they
// do where a vertex is far away. Ordinary meshes cost one pass and no sorting.
bool may_be_crowded(const std::vector<Index>& used, const Points& positions) {
  constexpr int bins = 64;
  for (int axis = 0; axis < 3; ++axis) {
    double low = positions(used.front(), axis), high = low;
    for (const Index v : used) {
      low = std::min(low, positions(v, axis));
      high = std::max(high, positions(v, axis));
    }
    const double size = high - low;
    if (!std::isfinite(size)) return true;
    if (size == 0) continue;
    std::size_t counts[bins + 1] = {};
    for (const Index v : used)
      ++counts[std::min(bins - 1, static_cast<int>(bins * ((positions(v, axis) - low) / size)))];
    std::size_t most = 0;
    for (int k = 0; k < bins; ++k) most = std::max(most, counts[k] + counts[k + 1]);
    if (4 * most >= 3 * used.size()) return true;
  }
  return false;
}

/// Returns a vertex for each component of faces, the same for all vertices of it.
std::vector<Index> component_roots(const Mesh& mesh) {
  std::vector<Index> parent(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (Index f = 0; f < mesh.face_count(); ++f) {
    Index first = -1;
    for (const Index v : mesh.faces[f]) {
      if (!is_vertex_of(mesh, v)) continue;
      if (first < 0) first = root(v);
      parent[root(v)] = first;
    }
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v) parent[v] = root(v);
  return parent;
}

}  // namespace

double OutlyingVertices::distance(const Eigen::RowVector3d& point) const {
  return std::max(
      {std::abs(point[0] - centre[0]), std::abs(point[1] - centre[1]), std::abs(point[2] - centre[2])});
}

OutlyingVertices find_outlying(const Mesh& mesh) {
  OutlyingVertices found;
  const Points& positions = mesh.positions;
  Flags in_face(mesh.vertex_count(), 0);
  for (const Index v : mesh.faces.corners())
    if (is_vertex_of(mesh, v)) in_face[v] = 1;
  std::vector<Index> used, huge;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (!positions.row(v).allFinite()) continue;
    if (in_face[v]) used.push_back(v);
    if (positions.row(v).cwiseAbs().maxCoeff() > largest_coordinate) huge.push_back(v);
  }
  if (used.empty() || (huge.empty() && !may_be_crowded(used, positions))) {
    found.too_large = std::move(huge);
    return found;
  }

  std::vector<double> values(used.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(used, values.begin(), [&](Index v) { return positions(v, axis); });
    found.centre[axis] = percentile(values, 50);
  }
  const auto distance = [&](Index v) { return found.distance(positions.row(v)); };
  std::ranges::transform(used, values.begin(), distance);
  found.radius = percentile(values, 75);
  const double limit = far_rel * found.radius;
  if (found.radius > 0 && *std::ranges::max_element(values) > limit) {
    for (Index f = 0; f < mesh.face_count(); ++f) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Index v : mesh.faces[f])
        if (is_vertex_of(mesh, v) && positions.row(v).allFinite()) nearest = std::min(nearest, distance(v));
      for (const Index v : mesh.faces[f])
        if (is_vertex_of(mesh, v) && positions.row(v).allFinite() &&
            distance(v) > std::max(limit, far_rel * nearest))
          found.far.push_back(v);
    }
  }
  if (!found.far.empty()) {
    // A component that lies far out as a whole, or is large, is meant so.
    const std::vector<Index> component = component_roots(mesh);
    std::vector<std::array<Index, 2>> counts(component.size(), {0, 0});  // all, near
    for (const Index v : used) {
      ++counts[component[v]][0];
      if (distance(v) <= limit) ++counts[component[v]][1];
    }
    std::erase_if(found.far,
                  [&](Index v) { return 4 * counts[component[v]][1] < 3 * counts[component[v]][0]; });
  }
  for (const Index v : huge)
    (found.radius > 0 && distance(v) > limit ? found.far : found.too_large).push_back(v);
  std::ranges::sort(found.far);
  const auto repeated = std::ranges::unique(found.far);
  found.far.erase(repeated.begin(), repeated.end());
  return found;
}

}  // namespace meshgraft
