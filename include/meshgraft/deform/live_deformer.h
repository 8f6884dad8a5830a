#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quick_frames.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The way in which a frame was computed, from the roughest on.
enum class FrameAccuracy {
  proxy,    ///< by a decimated proxy (`ProxyDeformer`), usually within some per cent
  reduced,  ///< by `ReducedFrames`, usually within 2 %
  linear,   ///< by `HandleBasis`, to rounding
  exact,    ///< bit for bit the positions of `Deformer::evaluate`
};

std::string_view to_string(FrameAccuracy value);

/// One state of the surface while it is dragged.
struct LiveFrame {
  std::int64_t pose = 0;  ///< number of the pose that `LiveDeformer::drag` returned
  /// Positions, n×3, model units; the receiver may keep them, and nobody writes to them any more.
  std::shared_ptr<const Points> positions;
  FrameAccuracy accuracy = FrameAccuracy::exact;
  double seconds = 0;  ///< computing time
  /// Largest distance from the exact positions, × the largest displacement; 0 for `exact`. For other
  /// accuracies it is an earlier measurement. It was taken on the last pose whose best frame before the exact
  /// one had this accuracy. Absent before the first measurement.
  std::optional<double> error_rel{};
};

/// Callbacks of a `LiveDeformer`. It calls them on a thread of its own and never two at a time. They must not
/// throw, may call `drag`, and must not destroy the object.
struct LiveCallbacks {
  /// Receives frames in the order of pose numbers; each further frame of one pose has a greater accuracy than
  /// the last.
  std::function<void(const LiveFrame&)> frame{};
  /// Receives errors, each once; may be empty. Pose 0 means that the set-up failed, with the `Deformer`'s own
  /// Error. Then no pose is answered any more, except that the proxy goes on answering after Error(memory).
  /// Another number means that this pose cannot be evaluated.
  std::function<void(std::int64_t pose, const Error& error)> failed{};
};

struct LiveOptions {
  DeformerOptions deformer{};
  ReducedFramesOptions reduced{};  ///< for all methods but `ft05`
  Points normals{};                ///< for the `HandleBasis` of `ft05`, n×3; may be empty
  /// Number of free vertices of a region from which on a proxy is made. For smaller regions the exact set-up
  /// is ready as soon.
  Index proxy_from = 10'000;
  Index proxy_vertices = 2000;  ///< approximate number of vertices of the proxy
  /// A Deformer of the same mesh and options for another region; may be null. Parts that both have in common
  /// are not computed again (`Deformer::with_region`). Exact frames are then within 1e-10 of the bounding box
  /// of those without it. The reference is released as soon as it is no longer needed.
  std::shared_ptr<const Deformer> earlier{};
  /// Time for which the handles have to rest before the exact evaluation starts.
  double settle_seconds = 0.1;  ///< 0 … 3600
};

/// Stages of the set-up.
enum class LiveStage {
  starting,    ///< nothing is ready; poses wait
  preview,     ///< a proxy answers while the exact set-up is computed
  exact,       ///< the `Deformer` is ready while its quick frames are prepared
  ready,       ///< the set-up is complete
  proxy_only,  ///< the exact set-up does not fit the memory, and the proxy stays
  failed,
  closed,
};

std::string_view to_string(LiveStage value);

/// A deformation that can be dragged at once and is refined in the background. The constructor returns
/// without computing anything. A set-up thread then makes one means of answering poses after the other, each
/// better than the last. These are a `ProxyDeformer` for large regions, the `Deformer`, and a `HandleBasis`
/// (`ft05`) or `ReducedFrames` (other methods). Another thread answers the newest pose by the best quick
/// means, and again when a better one is ready. Once the handles rest, that thread evaluates the pose
/// exactly.
class LiveDeformer {
 public:
  /// The problem's region has the handles. Throws Error(usage) for constraints per vertex, without a callback
  /// for frames, or for normals of another shape. Throws what the `Deformer` throws for bad indices, handles,
  /// features, anchors and options. Errors that take time to find (an unsolvable region, for one) are reported
  /// by `failed`.
  ///
  /// The threads of `context` are used by the set-up, and by frames once it is done. Until then a quick frame
  /// uses one thread, and the set-up pauses between its steps while an exact evaluation runs. `progress` is
  /// called on the set-up's thread. `Progress::within` is "proxy" for the stages of the proxy, and otherwise
  /// empty. A requested stop has the effect of `close`.
  LiveDeformer(DeformProblem problem, LiveCallbacks callbacks, const LiveOptions& options = {},
               const Context& context = {});
  /// Closes, and waits for the threads. Steps that cannot be interrupted take some tenths of a second at
  /// 250,000 vertices. Frames that were kept stay valid.
  ~LiveDeformer();
  LiveDeformer(const LiveDeformer&) = delete;
  LiveDeformer& operator=(const LiveDeformer&) = delete;

  /// Requests one pose per handle, and returns its number at once, from 1 on. The pose replaces one that is
  /// still waiting, and stops the exact evaluation of one that already had a frame. Returns 0 after `close`.
  /// Throws Error(usage) for another number of poses, Error(input) for a non-finite pose. May be called from
  /// any thread.
  std::int64_t drag(std::span<const HandlePose> poses);

  /// Waits until the newest pose had its exact frame; without a pose, until the `Deformer` is ready. If that
  /// cannot happen, it throws the reason: the Error of the set-up or of the pose, Error(cancelled) with the id
  /// deform.live_deformer_closed after `close`, or Error(usage) on the callbacks' thread.
  void wait_until_exact() const;

  LiveStage stage() const;
  /// Returns the number of poses that were never computed, because a newer one came first.
  std::int64_t superseded() const;
  /// Returns the basis of method `ft05`; null before it is ready, and for other methods. It may outlive the
  /// object.
  std::shared_ptr<const HandleBasis> basis() const;

  /// Returns the Deformer that computes exact frames; null before it is ready. It may outlive the object.
  std::shared_ptr<const Deformer> deformer() const;

  /// Stops all work without waiting; `drag` does nothing from then on. At most one frame that is already on
  /// its way is still delivered. May be called from any thread, also while others drag. Call it before the
  /// object is destroyed to tell threads that may still drag, and join these threads first.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
