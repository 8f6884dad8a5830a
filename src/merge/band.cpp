#include "band.h"

#include <algorithm>

#include <meshgraft/mesh/topology.h>

namespace meshgraft {

namespace {

// How far each vertex follows its neighbours: 1 beside the strip, fading out with the rings; 0 where it stays.
std::vector<double> mobility(const SeamPatch& patch, const IndexLists& rings, const SeamOptions& options) {
  std::vector<bool> held = patch.on_border;
  for (const SeamEdge& edge : inner_edges(patch)) {
    if (edge.dihedral_deg <= options.sharp_angle_deg) continue;
    if (patch.side[edge.triangles[0]] != SeamSide::target || patch.side[edge.triangles[1]] != SeamSide::target)
      continue;
    for (const Index v : edge.ends) held[v] = true;
  }

  // Ring by ring from the strip, never past a vertex that is held.
  std::vector<double> result(patch.vertex.size(), 0);
  const auto limit = [&](Index v) {
    return patch.of[v] == SeamSide::target ? options.target_rings : options.source_rings;
  };
  for (int r = 1; r <= std::max(options.target_rings, options.source_rings); ++r) {
    for (std::size_t k = 0; k < result.size(); ++k) {
      const auto v = static_cast<Index>(k);
      if (patch.ring[k] != r || held[k] || r > limit(v)) continue;
      const auto beside = rings[v];
      const bool reached = r == 1 || std::any_of(beside.begin(), beside.end(), [&](Index w) {
                             return patch.ring[w] == r - 1 && patch.of[w] == patch.of[v] && result[w] > 0;
                           });
      if (reached) result[k] = 1 - (r - 1.0) / limit(v);
    }
  }
  return result;
}

}  // namespace

std::vector<Index> smooth_band(Mesh& mesh, const SeamLayout& layout, const SeamOptions& options,
                               const Context& context) {
  const SeamPatch patch =
      make_seam_patch(mesh, layout, std::max(options.target_rings, options.source_rings) + 1);
  const IndexLists rings = vertex_rings(static_cast<Index>(patch.vertex.size()), patch.triangles);
  const std::vector<double> weights = mobility(patch, rings, options);

  Points points = patch.points;
  for (int step = 0; step < options.smoothing_steps; ++step) {
    context.throw_if_stopped();
    const Points before = points;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if (weights[k] == 0) continue;
      const auto v = static_cast<Index>(k);
      Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
      for (const Index w : rings[v]) mean += before.row(w);
      mean /= static_cast<double>(rings[v].size());
      points.row(v) += 0.5 * weights[k] * (mean - before.row(v));
    }
  }

  std::vector<Index> band;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] == 0) continue;
    band.push_back(patch.vertex[k]);
    mesh.positions.row(patch.vertex[k]) = points.row(static_cast<Eigen::Index>(k));
  }
  return band;
}

}  // namespace meshgraft
