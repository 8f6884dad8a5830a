#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/affine_operator.h>

#include "operators/intrinsic_delaunay.h"
#include "patch.h"

namespace meshgraft {

// The part of a deformation's set-up that does not depend on which unknowns are known. A system with fewer
// unknowns (another handle, more fixed vertices) can reuse it. Its result equals that of a new set-up up to
// rounding. The patch may be larger than needed, which changes its centre and ℓ̄, a common factor of all
// rows.

struct RestMesh {
  Points points;
  Triangles triangles;
};

/// The part of a mesh that can influence the unknowns.
struct CutPatch {
  std::shared_ptr<const RestMesh> mesh;
  // Per vertex of the mesh: whether it has faces; whether rows and maps around it are complete in the patch;
  // the index of its feature, or -1.
  Flags in_faces, active;
  std::vector<Index> feature;
  int rings = 0;  ///< rings around active vertices
  Patch patch;

  CutPatch(std::shared_ptr<const RestMesh> rest, const ConstraintMask& mask, int laplacian_order,
           const Context& context);

  /// Returns the vertices that would be active for another mask with the same features. Returns nullopt if
  /// any of them is not active here.
  std::optional<Flags> active_among(const ConstraintMask& mask) const;
  /// Returns the mask of the patch's vertices. All of a vertex without faces is known.
  ConstraintMask patch_mask(const ConstraintMask& mask) const;
};

/// A sub-patch: the faces of a patch that would be cut for fewer active vertices, in the patch's numbering.
struct PatchPart {
  Index size = 0;  ///< number of vertices
  Triangles triangles;
  IndexLists rings;  ///< per vertex of the patch: empty if outside the part
};

/// Returns the part around the active vertices, or nullopt if it is the whole patch.
std::optional<PatchPart> part_around(const CutPatch& cut, const Flags& active, const IndexLists& rings,
                                     const Context& context);

/// The rows of the energy over a patch.
class PatchOperator {
 public:
  /// `mask` must come from `fix_unconstrained_components`.
  PatchOperator(const CutPatch& cut, const ConstraintMask& mask, const OperatorOptions& options,
                const Context& context);

  const AffineOperator& rows() const { return rows_; }

  /// Returns whether the rows are valid for a system with this mask. Every unknown must have had rows
  /// made for it. A vertex that was moved off its plane must still be movable. No direction may depend on a
  /// former unknown. `edges` are the intrinsic edges that a set-up alone would have, or null for the same ones.
  bool serves(const ConstraintMask& mask, const IntrinsicEdges* edges = nullptr) const;
  /// Returns whether the rows of the part, set up alone, would be multiples of these rows by one common
  /// factor.
  bool serves(const PatchPart& part, const Patch& patch) const;
  /// Returns H without the maps that are known now, or nullopt if H has none of them.
  std::optional<SparseRows> fewer_maps(const ConstraintMask& mask, const Context& context) const;

 private:
  OperatorOptions options_;
  ConstraintMask mask_;  ///< of the patch's vertices, for which the rows were made
  AffineOperator rows_;
};

}  // namespace meshgraft
