#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/deform/handle_basis.h>
#include <meshgraft/deform/reduced_frames.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// How a frame was found, from the roughest on.
enum class FrameQuality {
  proxy,    ///< a decimated proxy (`ProxyDeformer`), usually within some per cent
  reduced,  ///< `ReducedFrames`, usually within 2 %
  linear,   ///< `HandleBasis`, to rounding
  exact,    ///< the bytes of `Deformer::evaluate`
};

std::string_view to_string(FrameQuality value);

/// One state of the surface while it is dragged.
struct LiveFrame {
  std::int64_t pose = 0;                    ///< its number, as `LiveDeformer::drag` gave it
  std::shared_ptr<const Points> positions;  ///< n×3; the receiver may keep it, nobody writes to it any more
  FrameQuality quality = FrameQuality::exact;
  double seconds = 0;  ///< that it took to compute
  /// Largest distance from the exact positions, × largest displacement: 0 for `exact`; for the others what was
  /// measured on the last pose whose best frame but the exact one had this quality, absent before the first.
  std::optional<double> error_rel{};
};

/// What a `LiveDeformer` calls, on a thread of its own and never two at a time. They must not throw, may call
/// `drag`, and must not destroy the object.
struct LiveCallbacks {
  /// In the order of pose numbers; of one pose, each frame is of a better quality than the one before.
  std::function<void(const LiveFrame&)> frame{};
  /// May be empty. Pose 0: the set-up failed, with the `Deformer`'s own Error, and nothing answers any more;
  /// but after Error(memory) the proxy does. Other numbers: this pose cannot be evaluated. Each is told once.
  std::function<void(std::int64_t pose, const Error& error)> failed{};
};

struct LiveOptions {
  DeformerOptions deformer{};
  ReducedFramesOptions reduced{};  ///< of all methods but `ft05`
  Points normals{};                ///< for the `HandleBasis` of `ft05`, n×3; may be empty
  /// A proxy is made for regions of so many free vertices and more; below, the rest is there as soon.
  Index proxy_from = 10'000;
  Index proxy_vertices = 2000;
  /// Of the same mesh and options, for another region: what they have in common is not made again
  /// (`Deformer::with_region`), and exact frames are then within 1e-10 of the box of those without it. Let go
  /// of as soon as it has served. May be null.
  std::shared_ptr<const Deformer> earlier{};
  /// How long the handles have to rest before the exact evaluation starts.
  double settle_seconds = 0.1;  ///< 0 … 3600
};

/// What of the set-up is there.
enum class LiveStage {
  starting,    ///< nothing yet; poses wait
  preview,     ///< a proxy answers, the exact set-up is being made
  exact,       ///< the `Deformer` is there, what makes its frames quick is being made
  ready,       ///< all that there is going to be
  proxy_only,  ///< the exact set-up does not fit the memory: the proxy stays
  failed,
  closed,
};

std::string_view to_string(LiveStage value);

/// A deformation that can be dragged at once and is refined behind. The constructor returns without computing
/// anything; a thread makes one thing after the other that answers poses better: a `ProxyDeformer` for large
/// regions, the `Deformer`, and a `HandleBasis` (`ft05`) or `ReducedFrames` (the other methods). Another thread
/// answers the newest pose with the best that is quick, again when something better is there, and exactly once
/// the handles rest.
///
/// Where no quick frames are possible (`ReducedFrames` refuses features and redrawn curves; iterations are too
/// slow to prepare them) the proxy goes on answering, or the `Deformer` itself where there is none.
class LiveDeformer {
 public:
  /// `rest` n×3, `triangles` m×3. Throws Error(usage) without a callback for frames or for normals of another
  /// shape, and what the `Deformer` throws for bad indices, handles, features, anchors and options; what takes
  /// time to find (an unsolvable region, for one) is told by `failed`. Of `context`, the threads are those of
  /// the set-up and of frames once it is done; until then a quick frame keeps to one, and the set-up pauses
  /// between its steps while an exact evaluation runs. `progress` is called on the set-up's thread, by the
  /// stages' own names, those of the proxy with "proxy: " before them; a stop is as good as `close`.
  LiveDeformer(Points rest, Triangles triangles, Region region, LiveCallbacks callbacks,
               const LiveOptions& options = {}, const Context& context = {});
  /// Closes, and waits for the threads; what cannot be interrupted takes some tenths of a second at 250,000
  /// vertices. Frames that were kept stay valid.
  ~LiveDeformer();
  LiveDeformer(const LiveDeformer&) = delete;
  LiveDeformer& operator=(const LiveDeformer&) = delete;

  /// Asks for one pose per handle; returns its number, from 1 on, at once. It takes the place of a pose that is
  /// still waiting, and stops the exact evaluation of one that had a frame. Returns 0 after `close`. Throws
  /// Error(usage) for another number of poses, Error(input) for one that is not finite. Any thread may call it.
  std::int64_t drag(std::span<const HandlePose> poses);

  /// Waits until the newest pose had its exact frame; without a pose, until the `Deformer` is there. Throws the
  /// Error for which there will be none: that of the set-up or of the pose, Error(cancelled) after `close`,
  /// Error(usage) on the callbacks' thread.
  void wait_until_exact() const;

  LiveStage stage() const;
  /// Poses that were never computed, because a newer one came first.
  std::int64_t superseded() const;
  /// Of `ft05`, once it is there; null before, and for the other methods. It may outlive the object.
  std::shared_ptr<const HandleBasis> basis() const;

  /// What makes the exact frames, once it is there; null before. It may outlive the object.
  std::shared_ptr<const Deformer> deformer() const;

  /// Stops everything without waiting, and `drag` does nothing from then on; at most one frame that is on its
  /// way still comes. Any thread may call it, also while others drag. Threads that may drag while the object
  /// ends should be told by this, and joined before it is destroyed.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
