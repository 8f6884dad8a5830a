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
  /// Number of points (centres) that store the field of maps; the field is interpolated between them. Memory
  /// (12 bytes per vertex and centre) and the time of set-up and frames grow with it, and errors fall.
  Index centres = 128;
  /// Number of cells per centre. The surface's own rotations are sampled as their mean over each cell.
  Index samples_per_centre = 4;
};

/// Throws Error(input), naming the field, for a value out of range.
void validate(const ReducedFramesOptions& options);

/// Computes approximate frames of the methods `corotational` and `rotation_aware` in real time
/// (docs/methods.md has the errors). They serve dragging; let the exact `Deformer::evaluate` follow when the
/// drag ends.
///
/// The field of maps F on the right-hand side is smooth. A few samples of it, and functions that spread them
/// as smoothly as possible over the surface, therefore represent the whole field. The solution is linear in
/// those samples and in the handles' affine maps, and the constructor solves for the vertices' response to
/// each of them. A frame repeats the method's steps on the samples alone, which takes a few milliseconds at
/// any size, and ends with one product. The object keeps no reference to the deformer.
class ReducedFrames {
 public:
  /// Throws Error(usage) for a deformer of method `ft05` (`HandleBasis` computes its frames exactly), or with
  /// constraints per vertex. Throws Error(input) for features and for options out of range.
  explicit ReducedFrames(const Deformer& deformer, const ReducedFramesOptions& options = {},
                         const Context& context = {});
  ReducedFrames(ReducedFrames&&) noexcept;
  ReducedFrames& operator=(ReducedFrames&&) noexcept;
  ~ReducedFrames();

  /// Computes new positions, near those of `Deformer::evaluate` for the same poses, in the caller's n×3
  /// `positions`. Handle vertices are exactly at `pose · p`; vertices outside the region keep their
  /// coordinates bit for bit. One affine map of all handles is reproduced to 1e-6. `report` gets the steps,
  /// and whether transforms were blended linearly. Throws Error(usage) for another shape or number of poses.
  /// Throws Error(input) for a redrawn curve and for non-finite values.
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
