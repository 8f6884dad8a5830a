#include "patch_operator.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <meshgraft/operators/laplacian.h>

namespace meshgraft {

namespace {

/// Returns whether a vertex of a feature has a neighbour outside that feature.
bool beside_others(Index vertex, const Triangles& triangles, std::span<const Index> faces,
                   const std::vector<Index>& feature) {
  return std::any_of(faces.begin(), faces.end(), [&](Index t) {
    return std::any_of(triangles.row(t).begin(), triangles.row(t).end(),
                       [&](Index w) { return feature[w] != feature[vertex]; });
  });
}

bool is_movable(const KnownParts& known, Index v) { return !known.position[v] && is_fitted(known, v); }

Flags flag_active(const KnownParts& known) {
  Flags active(known.position.size());
  for (std::size_t v = 0; v < active.size(); ++v) active[v] = !known.position[v] || !known.transform[v];
  return active;
}

AffineOperator::Extent extent_of(const CutPatch& cut, const KnownParts& known, const Flags& active,
                                 const IndexLists& rings, int laplacian_order) {
  const Index n = cut.patch.size();
  AffineOperator::Extent extent;
  extent.fitted.resize(static_cast<std::size_t>(n));
  extent.unknown.resize(static_cast<std::size_t>(n));
  extent.movable.resize(static_cast<std::size_t>(n));
  std::vector<Index> centres;
  for (Index v = 0; v < n; ++v) {
    extent.unknown[v] = !known.transform[v];
    extent.fitted[v] = is_fitted(known, v);
    extent.movable[v] = is_movable(known, v);
    if (active[v]) centres.push_back(v);
  }
  extent.numbers = cut.patch.vertices;
  extent.rows.assign(static_cast<std::size_t>(n), 0);
  for (Index v : grow_rings(centres, laplacian_order, rings)) extent.rows[v] = 1;
  return extent;
}

}  // namespace

/// The patch is large enough that every row with an unknown is complete, with all normals and weights in it.
/// Rows inside a feature are zero for any map, so only its vertices next to others are active.
CutPatch::CutPatch(std::shared_ptr<const RestMesh> rest, const VertexStates& states, int laplacian_order,
                   const Context& context)
    : mesh(std::move(rest)), feature(states.feature), rings(laplacian_order + 2) {
  const auto n = static_cast<Index>(mesh->points.rows());
  const IndexLists faces_at = vertex_triangles(n, mesh->triangles, context);
  in_faces.resize(static_cast<std::size_t>(n));
  active.resize(static_cast<std::size_t>(n));
  for (Index v = 0; v < n; ++v) {
    in_faces[v] = !faces_at[v].empty();
    active[v] = in_faces[v] && states.is_unknown(v);
    if (active[v] && feature[v] >= 0) active[v] = beside_others(v, mesh->triangles, faces_at[v], feature);
  }
  patch = make_patch(mesh->points, mesh->triangles, faces_at, active, rings, context);
}

std::optional<Flags> CutPatch::active_among(const VertexStates& states) const {
  Flags fewer(active.size());
  for (Index v = 0; v < static_cast<Index>(active.size()); ++v) {
    fewer[v] = in_faces[v] && states.is_unknown(v);
    if (fewer[v] && feature[v] >= 0) fewer[v] = active[v];
    if (fewer[v] && !active[v]) return {};
  }
  return fewer;
}

KnownParts CutPatch::known_parts(const VertexStates& states) const {
  KnownParts known;
  for (const Index v : patch.vertices) {
    known.position.push_back(states.position[v] || !in_faces[v]);
    known.transform.push_back(states.transform[v] || !in_faces[v]);
    known.feature.push_back(states.feature[v]);
  }
  known.anchored.assign(patch.vertices.size(), 0);
  return known;
}

std::optional<PatchPart> part_around(const CutPatch& cut, const Flags& active, const IndexLists& rings,
                                     const Context& context) {
  const Patch& patch = cut.patch;
  std::vector<Index> centres;
  for (Index v = 0; v < patch.size(); ++v)
    if (active[patch.vertices[v]]) centres.push_back(v);
  Flags inside(static_cast<std::size_t>(patch.size()), 0);
  PatchPart part;
  for (const Index v : grow_rings(centres, cut.rings + 1, rings)) {
    inside[v] = 1;
    ++part.size;
  }
  if (part.size == patch.size()) return {};
  part.triangles.resize(patch.triangles.rows(), 3);
  Eigen::Index faces = 0;
  for (const auto& t : patch.triangles.rowwise())
    if (inside[t[0]] && inside[t[1]] && inside[t[2]]) part.triangles.row(faces++) = t;
  part.triangles.conservativeResize(faces, Eigen::NoChange);
  part.rings = vertex_rings(patch.size(), part.triangles, context);
  return part;
}

PatchOperator::PatchOperator(const CutPatch& cut, const KnownParts& known, const IndexLists& rings,
                             const OperatorOptions& options, const Context& context)
    : options_(options),
      active_(flag_active(known)),
      extent_(extent_of(cut, known, active_, rings, options.laplacian_order)),
      rows_(cut.patch.points, cut.patch.triangles, options, extent_, context),
      P_transposed_(transpose(rows_.P(), context)) {}

bool PatchOperator::serves(const KnownParts& known) const {
  const bool moves = options_.degenerate == DegenerateTreatment::ft05_noise;
  const StencilNodes& nodes = rows_.nodes();
  for (Index v = 0; v < static_cast<Index>(active_.size()); ++v) {
    const bool is_known = known.position[v] && known.transform[v];
    if (!is_known && !active_[v]) return false;
    if (!known.transform[v] && !extent_.unknown[v]) return false;
    if (moves && nodes.flat[v] && is_movable(known, v) != (extent_.movable[v] != 0)) return false;
  }
  return moves || std::all_of(nodes.without_normal.begin(), nodes.without_normal.end(),
                              [&](Index v) { return is_fitted(known, v); });
}

bool PatchOperator::serves(const PatchPart& part, const Patch& patch) const {
  if (options_.density == Density::ft05) return true;
  const std::vector<double> lengths = mean_edge_lengths(patch.points, part.rings);
  const double mean = mean_of_positive(lengths);
  return std::all_of(lengths.begin(), lengths.end(), [&](double length) {
    return length <= 0 || (AffineOperator::is_scaled_by_density(mean / length) &&
                           AffineOperator::is_scaled_by_density(rows_.mean_edge_length() / length));
  });
}

std::optional<SparseRows> PatchOperator::fewer_maps(const KnownParts& known) const {
  const SparseRows& H = rows_.H();
  std::vector<int> lengths(static_cast<std::size_t>(H.rows()), 0);
  bool fewer = false;
  for (Index row = 0; row < static_cast<Index>(H.rows()); ++row) {
    const int length = H.outerIndexPtr()[row + 1] - H.outerIndexPtr()[row];
    if (is_fitted(known, row / 3))
      lengths[row] = length;
    else
      fewer = fewer || length > 0;
  }
  if (!fewer) return {};
  SparseRows kept = rows_of_lengths(lengths, H.cols());
  for (Index row = 0; row < static_cast<Index>(H.rows()); ++row) {
    const int from = H.outerIndexPtr()[row], to = kept.outerIndexPtr()[row];
    std::copy_n(H.innerIndexPtr() + from, lengths[row], kept.innerIndexPtr() + to);
    std::copy_n(H.valuePtr() + from, lengths[row], kept.valuePtr() + to);
  }
  return kept;
}

}  // namespace meshgraft
