#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

struct ReducedFramesOptions {
  /// Places where the field of maps is kept; it is interpolated between them. Memory (12 bytes a vertex and
  /// centre) and the time of set-up and frames grow with it, errors fall.
  Index centres = 128;
  /// Places per centre where the surface's own rotations are taken: the means over that many cells.
  Index samples_per_centre = 4;
};

/// Throws Error(input), naming the field, for a value out of range.
void validate(const ReducedFramesOptions& options);

/// Frames of the methods `corotational` and `rotation_aware` in real time, a little off (docs/methods.md has by
/// how much): for dragging; let the exact `Deformer::evaluate` follow when the drag ends.
///
/// The field of maps F on the right-hand side is smooth, so that few samples of it, with functions that spread
/// them over the surface as smoothly as can be, make up the whole; and the solution is linear in those samples
/// and in the handles' affine maps. The constructor finds the vertices' response to each of them. A frame
/// repeats the steps of the method on the samples alone, a few milliseconds at any size, and ends with one
/// product. Keeps nothing of the deformer.
class ReducedFrames {
 public:
  /// Throws Error(usage) for a deformer of method `ft05` (whose frames `HandleBasis` has exactly), or with
  /// constraints per vertex; Error(input) for features and for options out of range.
  explicit ReducedFrames(const Deformer& deformer, const ReducedFramesOptions& options = {},
                         const Context& context = {});
  ReducedFrames(ReducedFrames&&) noexcept;
  ReducedFrames& operator=(ReducedFrames&&) noexcept;
  ~ReducedFrames();

  /// New positions, near those of `Deformer::evaluate` for the same poses, into the caller's n×3. Handle
  /// vertices are exactly at `pose · p`, vertices outside the region keep their bits; one affine map of all
  /// handles is reproduced to 1e-6. `report` gets the steps and whether the blend fell back to a linear one.
  /// Throws Error(usage) for another shape or number of poses; Error(input) for a redrawn curve and for what is
  /// not finite.
  void frame(std::span<const HandlePose> poses, Points& positions, const Context& context = {},
             EvaluationReport* report = nullptr) const;
  Points frame(std::span<const HandlePose> poses, const Context& context = {},
               EvaluationReport* report = nullptr) const;

  Index centres() const;
  std::int64_t memory_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
