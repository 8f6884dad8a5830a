#include "outlying.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "core/percentile.h"
#include "face_defects.h"

namespace meshgraft {

namespace {

// The solve loses all digits of the near vertices between 1e7 and 1e10 radii.
constexpr double far_rel = 1e6;

constexpr std::size_t vertices_per_block = 16384;

// Calls `work(block, begin, end)` for blocks of vertices in parallel.
template <class Work>
void for_each_block(Index vertices, const Work& work, const Context& context) {
  const auto count = static_cast<std::size_t>(vertices);
  parallel_blocks((count + vertices_per_block - 1) / vertices_per_block,
                  [&](std::size_t first, std::size_t last) {
                    for (std::size_t block = first; block < last; ++block)
                      work(block, static_cast<Index>(block * vertices_per_block),
                           static_cast<Index>(std::min(count, (block + 1) * vertices_per_block)));
                  },
                  context, 1);
}

Flags vertices_of_faces(const Mesh& mesh, const Context& context) {
  Flags in_face(mesh.vertex_count(), 0);
  share_out(
      mesh.vertex_count(),
      [&](int begin, int end) {
        for (const Index v : mesh.faces.corners())
          if (v >= begin && v < end) in_face[v] = 1;
      },
      context);
  return in_face;
}

// Finite vertices of faces, some of the mesh or all.
struct UsedVertices {
  std::size_t count = 0;
  Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  std::vector<Index> huge;  // vertices beyond `largest_coordinate`, also those of no face
};

UsedVertices find_used(const Mesh& mesh, const Flags& in_face, const Context& context) {
  std::vector<UsedVertices> blocks(in_face.size() / vertices_per_block + 1);
  for_each_block(
      mesh.vertex_count(),
      [&](std::size_t block, Index begin, Index end) {
        UsedVertices& used = blocks[block];
        for (Index v = begin; v < end; ++v) {
          const Eigen::Array3d point = mesh.positions.row(v).transpose();
          if (!point.allFinite()) continue;
          if (point.abs().maxCoeff() > largest_coordinate) used.huge.push_back(v);
          if (!in_face[v]) continue;
          ++used.count;
          used.low = used.low.min(point);
          used.high = used.high.max(point);
        }
      },
      context);
  UsedVertices all;
  for (const UsedVertices& used : blocks) {
    all.count += used.count;
    all.low = all.low.min(used.low);
    all.high = all.high.max(used.high);
    all.huge.insert(all.huge.end(), used.huge.begin(), used.huge.end());
  }
  return all;
}

// Returns whether three quarters of the vertices may lie within a millionth of the box's longest side, as they
// do where a vertex is far away. Ordinary meshes cost one pass and no sorting.
bool may_be_crowded(const Mesh& mesh, const Flags& in_face, const UsedVertices& used, const Context& context) {
  constexpr int bins = 64;
  using Counts = std::array<std::array<std::uint32_t, bins + 1>, 3>;
  const Eigen::Array3d size = used.high - used.low;
  if (!size.allFinite()) return true;
  std::vector<Counts> blocks(in_face.size() / vertices_per_block + 1, Counts{});
  for_each_block(
      mesh.vertex_count(),
      [&](std::size_t block, Index begin, Index end) {
        for (Index v = begin; v < end; ++v) {
          const Eigen::Array3d point = mesh.positions.row(v).transpose();
          if (!in_face[v] || !point.allFinite()) continue;
          for (int axis = 0; axis < 3; ++axis) {
            if (size[axis] == 0) continue;
            const int bin = static_cast<int>(bins * ((point[axis] - used.low[axis]) / size[axis]));
            ++blocks[block][axis][std::min(bins - 1, bin)];
          }
        }
      },
      context);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<std::size_t, bins + 1> counts{};
    for (const Counts& block : blocks)
      for (std::size_t k = 0; k < bins; ++k) counts[k] += block[axis][k];
    for (std::size_t k = 0; k < bins; ++k)
      if (4 * (counts[k] + counts[k + 1]) >= 3 * used.count) return true;
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

OutlyingVertices find_outlying(const Mesh& mesh, const Context& context) {
  OutlyingVertices found;
  const Points& positions = mesh.positions;
  const Flags in_face = vertices_of_faces(mesh, context);
  UsedVertices near_and_far = find_used(mesh, in_face, context);
  std::vector<Index>& huge = near_and_far.huge;
  if (near_and_far.count == 0 || (huge.empty() && !may_be_crowded(mesh, in_face, near_and_far, context))) {
    found.too_large = std::move(huge);
    return found;
  }

  std::vector<Index> used;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (in_face[v] && positions.row(v).allFinite()) used.push_back(v);
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
