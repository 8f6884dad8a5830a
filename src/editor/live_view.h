#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/deform/live_deformer.h>

#include "folders.h"
#include "frame_numbers.h"
#include "objects.h"
#include "protocol.h"

namespace meshgraft::editor {

/// A handle as the page draws it.
struct ShownHandle {
  Handle handle;
  Eigen::Vector3d centre, pivot;
  std::vector<Index> rim;  ///< vertices of the handle boundary: they have a neighbour outside
};

/// Shows the effect of the current step on the mesh, during a drag and afterwards. Sends the mesh, the roles
/// of its vertices, and frames. Call it from one thread only.
class LiveView {
 public:
  /// `folders`: textures of models are read from these alone.
  LiveView(Outbox outbox, const Folders& folders) : outbox_(std::move(outbox)), folders_(folders) {}

  /// A document that has been checked and can be shown. `plan` throws its errors before anything changes.
  struct Plan {
    std::shared_ptr<const Object> base;
    Json key;                          ///< all of the step that matters, except the poses
    std::optional<DeformSetup> setup;  ///< absent: the step is not ready, or only its poses changed
    std::vector<HandlePose> poses;
    bool ready = false;
    bool resumes = false;  ///< the parked set-up is shown again
  };
  Plan plan(const Document& document, std::shared_ptr<const Object> base) const;

  /// Shows the document and returns whether a set-up begins. `context` is for a step that cannot be dragged
  /// and is therefore run; throws what running it throws.
  bool show(const Document& document, Plan plan, const Context& context);

  /// Drags handles and returns the number of the pose, or 0 where nothing can be dragged. The other handles
  /// keep the document's poses. With `exact_alone` the positions of inexact frames are not sent: the page
  /// computes them from the handles' maps.
  std::int64_t drag(const std::map<std::string, PoseSpec>& poses, bool exact_alone);
  HandleShape shape_of(const std::string& handle) const;

  /// Returns the pose, in the form of an edit file, that keeps vertices near their shown positions when they
  /// become a handle: the similarity nearest to their motion. Empty where they have not moved.
  Json pose_as_shown(const std::vector<Index>& vertices) const;

  /// Returns the result of the document's steps, where the view has it or waits for an exact frame that is
  /// being computed. Returns null where the step has to be run. Throws Error(cancelled).
  std::shared_ptr<const MeshState> outcome(const Document& document, const Context& context);

  /// `poll` tells the page the stage of the set-up; `settled` is true once the stage is final.
  void poll();
  bool settled() const;

  const Object& base() const { return *base_; }
  std::int64_t last_pose() const { return last_pose_; }
  /// The handles of the step, then their mirrored twins where the step has a symmetry.
  const std::vector<ShownHandle>& handles() const { return shown_.handles; }
  /// The document's poses, one per element of `handles()`.
  const std::vector<HandlePose>& poses() const { return shown_.poses; }
  const std::optional<SymmetryReport>& symmetry() const { return shown_.symmetry; }
  /// Returns notes about deviations of the result from the request.
  std::vector<Note> notes() const;
  Json counts() const;

 private:
  void show_rest();
  bool is_roomy() const;
  void park();
  void resume();
  void send_roles();
  void set_up(const DeformStep& step, DeformSetup setup, std::shared_ptr<const Deformer> earlier);
  void run_exactly(const Document& document, const Context& context);
  HandlePose pose_of(const PoseSpec& spec, const ShownHandle& shown) const;
  std::vector<HandlePose> poses_of(const DeformStep& step) const;
  void mirror_pose(const PoseSpec& spec, std::size_t handle, std::vector<HandlePose>& poses) const;
  void drag_to(const std::vector<HandlePose>& poses, bool exact_alone = false);

  // The exact frame of the document's poses, written by the deformer's thread, and the last frame of any
  // accuracy.
  struct ExactFrame {
    std::mutex mutex;
    std::condition_variable changed;
    std::int64_t pose = 0;                    ///< number of the awaited pose
    std::shared_ptr<const Points> positions;  ///< of the awaited pose
    std::shared_ptr<const Points> last;       ///< last frame; null: all vertices are at rest
    bool failed = false;
    void expect(std::int64_t next);
    void take(std::int64_t pose, const LiveFrame& frame);
    void fail(std::int64_t pose);
    void forget();  ///< all vertices are at rest
  };
  void show_document();
  std::shared_ptr<const Points> exact_positions(const Context& context);

  // All state of a shown step, so that it can be parked and resumed at once.
  struct Shown {
    Json key;
    Region region;
    std::shared_ptr<const std::vector<Index>> moving;
    std::vector<ShownHandle> handles;
    std::optional<SymmetryReport> symmetry;
    std::vector<Note> notes;        ///< without those about poses
    std::vector<HandlePose> poses;  ///< of the document
    std::shared_ptr<FrameNumbers> numbers;
    std::int64_t dragged = 0;  ///< number of poses requested until it was parked
    DeformerOptions options;
    bool refined = false;                ///< whether the solve has more vertices than the mesh
    std::unique_ptr<LiveDeformer> live;  ///< last member: destroyed before what its callbacks use
  };

  Outbox outbox_;
  const Folders& folders_;
  std::shared_ptr<const Object> base_;
  int shown_mesh_ = 0;
  std::optional<LiveStage> told_;
  bool basis_sent_ = false;
  std::int64_t last_pose_ = 0;
  const std::shared_ptr<ExactFrame> exact_ = std::make_shared<ExactFrame>();
  const std::shared_ptr<std::atomic<bool>> exact_alone_ = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<const MeshState> outcome_;  ///< result of a step that cannot be dragged
  std::optional<Shown> parked_;               ///< the previous set-up, kept while the next one is made
  Shown shown_;
};

}  // namespace meshgraft::editor
