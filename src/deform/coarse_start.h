#pragma once

#include <memory>
#include <span>
#include <utility>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/deform/quick_frames.h>

#include "deform/setup/patch.h"
#include "deform/setup/patch_operator.h"
#include "linalg/sparse.h"

namespace meshgraft {

/// A proxy of a large region that poses are solved on first. Its rotations are near the region's own, so that
/// fewer steps follow.
class CoarseStart {
 public:
  /// Returns null if so few vertices are free that it would save no time, if there are features, if the region
  /// is symmetric, and if no proxy can be made.
  static std::unique_ptr<const CoarseStart> make(const RestMesh& rest, const Region& region,
                                                 std::span<const VertexConstraint> constraints, Index free,
                                                 const DeformerOptions& options, const Context& context);

  /// Returns the local maps of a patch's vertices minus I: rows 3v … 3v+2 are (M_v − I)ᵀ. They are zero
  /// where only a position is given, and have no rows if the proxy does not settle for these constraints.
  Columns maps(std::span<const VertexConstraint> constraints, const Patch& patch, const Context& context) const;

 private:
  explicit CoarseStart(ProxyDeformer proxy) : proxy_(std::move(proxy)) {}

  ProxyDeformer proxy_;
};

}  // namespace meshgraft
