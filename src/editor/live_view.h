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
#include <meshgraft/deform/live_deformer.h>

#include "folders.h"
#include "objects.h"
#include "protocol.h"

namespace meshgraft::editor {

/// A handle as the page draws it.
struct ShownHandle {
  Handle handle;
  Eigen::Vector3d centre, pivot;
  std::vector<Index> rim;  ///< its vertices that have a neighbour outside
};

/// Shows what the step that is worked on makes of the mesh, while it is dragged and after: sends the mesh, who
/// is what, and frames. Used on one thread.
class LiveView {
 public:
  /// `folders`: pictures of models are read from these alone.
  LiveView(Outbox outbox, const Folders& folders) : outbox_(std::move(outbox)), folders_(folders) {}

  /// A document that can be shown. What is found to be wrong with it is thrown before anything changes.
  struct Plan {
    std::shared_ptr<const Object> base;
    Json key;                          ///< all that matters but the poses
    std::optional<DeformSetup> setup;  ///< absent: the step is not ready, or as it was but for the poses
    std::vector<HandlePose> poses;
    bool ready = false;
    bool resumes = false;  ///< what was shown before is shown again, as it was set up
  };
  Plan plan(const Document& document, std::shared_ptr<const Object> base) const;

  /// Returns whether a set-up begins. `context` is for a step that cannot be dragged, which is run as it is;
  /// throws what that throws.
  bool show(const Document& document, Plan plan, const Context& context);

  /// Returns the pose's number, 0 where nothing can be dragged. Other handles are where the document has them.
  /// With `exact_alone` other frames are told of and not sent: the page shows the handles' maps itself.
  std::int64_t drag(const std::map<std::string, PoseSpec>& poses, bool exact_alone);
  HandleShape shape_of(const std::string& handle) const;

  /// The pose, as an edit file has it, by which vertices that become a handle stay about where they are shown:
  /// the similarity nearest to what has become of them. Empty where nothing has.
  Json pose_as_shown(const std::vector<Index>& vertices) const;

  /// What the document's steps leave, where the view knows it or is about to: it waits for an exact frame that
  /// is on its way. Null where only running the step tells. Throws Error(cancelled).
  std::shared_ptr<const Scene> outcome(const Document& document, const Context& context);

  /// Tells what has become of the set-up; `settled` once nothing more will.
  void poll();
  bool settled() const;

  const Object& base() const { return *base_; }
  std::int64_t last_pose() const { return last_pose_; }
  /// Those of the step, then their twins behind the mirror of a symmetry.
  const std::vector<ShownHandle>& handles() const { return shown_.handles; }
  /// Of the document, one for each of them.
  const std::vector<HandlePose>& poses() const { return shown_.poses; }
  const std::optional<SymmetryFacts>& symmetry() const { return shown_.symmetry; }
  /// What of the step goes another way than asked, in sentences.
  std::vector<std::string> notes() const;
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

  // The exact frame of the document's poses, which the deformer's thread leaves here, and the last one of any.
  struct ExactFrame {
    std::mutex mutex;
    std::condition_variable changed;
    std::int64_t pose = 0;                    ///< that is waited for
    std::shared_ptr<const Points> positions;  ///< of it
    std::shared_ptr<const Points> last;       ///< that was shown; null: all is at rest
    bool failed = false;
    void expect(std::int64_t next);
    void take(std::int64_t pose, const LiveFrame& frame);
    void fail(std::int64_t pose);
    void forget();  ///< all is at rest
  };
  void show_document();
  std::shared_ptr<const Points> exact_positions(const Context& context);

  // What numbers of frames count from; below 0: what makes them is not shown.
  using Origin = std::shared_ptr<std::atomic<std::int64_t>>;

  // What is shown of a step, whole: it can be put aside, and taken back at once.
  struct Shown {
    Json key;
    Region region;
    std::shared_ptr<const std::vector<Index>> moving;
    std::vector<ShownHandle> handles;
    std::optional<SymmetryFacts> symmetry;
    std::vector<std::string> notes;  ///< but those on poses
    std::vector<HandlePose> poses;   ///< of the document
    Origin origin;
    std::int64_t dragged = 0;  ///< poses that it was asked for until it was put aside
    DeformerOptions options;
    std::unique_ptr<LiveDeformer> live;  ///< last: it ends before what its callbacks use
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
  std::shared_ptr<const Scene> outcome_;  ///< of a step that cannot be dragged
  std::optional<Shown> parked_;           ///< what was shown before, while the set-up of the next goes on
  Shown shown_;
};

}  // namespace meshgraft::editor
