#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/affine_operator.h>
#include <meshgraft/operators/options.h>

#include "patch.h"
#include "region_states.h"
#include "solvability.h"

namespace meshgraft {

// What of a deformation's set-up does not depend on which of its unknowns are known: a system with fewer of
// them (another handle, more that is fixed) takes it over. Its result is then that of a set-up from nothing but
// for rounding: the patch may be larger than need be, which moves its centre, and ℓ̄, a factor of all rows.

struct RestMesh {
  Points points;
  Triangles triangles;
};

/// The part of a mesh that can have an influence on what is unknown.
struct CutPatch {
  std::shared_ptr<const RestMesh> mesh;
  // Of the mesh's vertices: whether they have faces; whether rows and maps around them are complete in the
  // patch; the number of their feature, or -1.
  Flags in_faces, active;
  std::vector<Index> feature;
  int rings = 0;  ///< around what is active
  Patch patch;

  CutPatch(std::shared_ptr<const RestMesh> rest, const VertexStates& states, int laplacian_order,
           const Context& context);

  /// What would be active for other states with the same features; nothing where that is more than is.
  std::optional<Flags> active_among(const VertexStates& states) const;
  /// What is known of the patch's vertices.
  KnownParts known_parts(const VertexStates& states) const;
};

/// The patch that would have been cut for less that is active: some faces of the one there is, by its numbers.
struct PatchPart {
  Index size = 0;  ///< its vertices
  Triangles triangles;
  IndexLists rings;  ///< empty for vertices outside
};

/// Nothing where the part is all of the patch.
std::optional<PatchPart> part_around(const CutPatch& cut, const Flags& active, const IndexLists& rings,
                                     const Context& context);

/// The rows of the energy over a patch.
class PatchOperator {
 public:
  /// `known` is settled (`fix_unconstrained_components`).
  PatchOperator(const CutPatch& cut, const KnownParts& known, const IndexLists& rings,
                const OperatorOptions& options, const Context& context);

  const AffineOperator& rows() const { return rows_; }
  const SparseRows& P_transposed() const { return P_transposed_; }

  /// Whether the rows are those of a system that knows this much: nothing is unknown for which they were not
  /// made, no vertex was moved off its plane that would stay there, no direction depends on what was unknown.
  bool serves(const KnownParts& known) const;
  /// Whether the rows of the part, made alone, would be multiples of these by one factor.
  bool serves(const PatchPart& part, const Patch& patch) const;
  /// H without the maps that are known by now; nothing where it is H.
  std::optional<SparseRows> fewer_maps(const KnownParts& known) const;

 private:
  OperatorOptions options_;
  Flags active_;  ///< of the patch's vertices: a part is unknown
  AffineOperator::Extent extent_;
  AffineOperator rows_;
  SparseRows P_transposed_;
};

/// Whether a vertex of the patch has a map that is fitted to positions.
inline bool is_fitted(const KnownParts& known, Index v) { return !known.transform[v] && known.feature[v] < 0; }

}  // namespace meshgraft
