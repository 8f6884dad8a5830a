#include "patch_operator.h"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <span>
#include <utility>

#include "core/parallel.h"
#include "linalg/sparse.h"
#include "operators/laplacian.h"

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

/// Returns whether two triangulations have the same edges with the same weights at the vertices with unknown
/// maps.
bool same_at_unknown_maps(const IntrinsicEdges& a, const IntrinsicEdges& b, const ConstraintMask& mask) {
  const auto counts = [&](const CotangentEdge& edge) {
    return !mask.transform[edge.ends[0]] || !mask.transform[edge.ends[1]];
  };
  return std::ranges::equal(
      a.edges | std::views::filter(counts), b.edges | std::views::filter(counts),
      [](const CotangentEdge& x, const CotangentEdge& y) { return x.ends == y.ends && x.weight == y.weight; });
}

}  // namespace

/// The patch is large enough that every row with an unknown is complete, with all normals and weights in it.
/// Rows inside a feature are zero for any map, so only its vertices next to others are active.
CutPatch::CutPatch(std::shared_ptr<const RestMesh> rest, const ConstraintMask& mask, int laplacian_order,
                   const Context& context)
    : mesh(std::move(rest)), feature(mask.feature), rings(laplacian_order + 2) {
  const auto n = static_cast<Index>(mesh->points.rows());
  const IndexLists faces_at = vertex_triangles(n, mesh->triangles, context);
  in_faces.resize(n);
  active.resize(n);
  for (Index v = 0; v < n; ++v) {
    in_faces[v] = !faces_at[v].empty();
    active[v] = in_faces[v] && mask.is_unknown(v);
    if (active[v] && feature[v] >= 0) active[v] = beside_others(v, mesh->triangles, faces_at[v], feature);
  }
  patch = make_patch(mesh->points, mesh->triangles, faces_at, active, rings, context);
}

std::optional<Flags> CutPatch::active_among(const ConstraintMask& mask) const {
  Flags fewer(active.size());
  for (Index v = 0; v < static_cast<Index>(active.size()); ++v) {
    fewer[v] = in_faces[v] && mask.is_unknown(v);
    if (fewer[v] && feature[v] >= 0) fewer[v] = active[v];
    if (fewer[v] && !active[v]) return {};
  }
  return fewer;
}

ConstraintMask CutPatch::patch_mask(const ConstraintMask& mask) const {
  ConstraintMask of_patch = mask.of(patch.vertices);
  for (Index v = 0; v < patch.size(); ++v)
    if (!in_faces[patch.vertices[v]]) of_patch.position[v] = of_patch.transform[v] = 1;
  return of_patch;
}

std::optional<PatchPart> part_around(const CutPatch& cut, const Flags& active, const IndexLists& rings,
                                     const Context& context) {
  const Patch& patch = cut.patch;
  std::vector<Index> centres;
  for (Index v = 0; v < patch.size(); ++v)
    if (active[patch.vertices[v]]) centres.push_back(v);
  Flags inside(patch.size(), 0);
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

PatchOperator::PatchOperator(const CutPatch& cut, const ConstraintMask& mask, const OperatorOptions& options,
                             const Context& context)
    : options_(options),
      mask_(mask),
      rows_(OperatorMesh{cut.patch.points, cut.patch.triangles, cut.patch.vertices}, mask, options, context) {}

bool PatchOperator::serves(const ConstraintMask& mask, const IntrinsicEdges* edges) const {
  if (edges != nullptr && rows_.intrinsic_edges() &&
      !same_at_unknown_maps(*edges, *rows_.intrinsic_edges(), mask))
    return false;
  const bool moves = options_.degenerate == DegenerateTreatment::ft05_noise;
  const StencilNodes& nodes = rows_.nodes();
  for (Index v = 0; v < mask_.size(); ++v) {
    if (mask.is_unknown(v) && !mask_.is_unknown(v)) return false;
    if (!mask.transform[v] && mask_.transform[v]) return false;
    if (moves && nodes.flat[v] && mask.is_movable(v) != mask_.is_movable(v)) return false;
  }
  return moves || std::all_of(nodes.without_normal.begin(), nodes.without_normal.end(),
                              [&](Index v) { return mask.is_fitted(v); });
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

std::optional<SparseRows> PatchOperator::fewer_maps(const ConstraintMask& mask, const Context& context) const {
  const SparseRows& H = rows_.H();
  std::vector<int> lengths(H.rows(), 0);
  bool fewer = false;
  for (Index row = 0; row < static_cast<Index>(H.rows()); ++row) {
    const int length = H.outerIndexPtr()[row + 1] - H.outerIndexPtr()[row];
    if (mask.is_fitted(row / 3))
      lengths[row] = length;
    else
      fewer = fewer || length > 0;
  }
  if (!fewer) return {};
  SparseRows kept = rows_of_lengths(lengths, H.cols());
  const auto copy = [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const int from = H.outerIndexPtr()[row], to = kept.outerIndexPtr()[row];
      std::copy_n(H.innerIndexPtr() + from, lengths[row], kept.innerIndexPtr() + to);
      std::copy_n(H.valuePtr() + from, lengths[row], kept.valuePtr() + to);
    }
  };
  parallel_blocks(lengths.size(), copy, context, 4096);
  return kept;
}

}  // namespace meshgraft
