#include "live_view.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/mesh/normals.h>

#include "mesh_frames.h"

namespace meshgraft::editor {

namespace {

std::string place_of(const Document& document) {
  return fmt::format("{}: steps[{}]", document.edit.place, *step_in_work(document.edit));
}

// Whether a frame of the region itself, by handles alone, is what the step makes.
bool is_plain(const DeformStep& step) {
  return step.targets.empty() && step.transforms.empty() && step.settings.refine_boundary == 0 &&
         step.settings.proxy == 0;
}

Json key_of(const Document& document, const Object& base) {
  Json step = document.json["steps"].back();
  if (step.contains("handles"))
    for (Json& handle : step["handles"])
      if (handle.contains("pose") && !handle["pose"].contains("def")) handle.erase("pose");
  return {base.id, step, selections_used(document.json, step)};
}

ShownHandle shown_handle(const Handle& handle, const Points& rest, const IndexLists& rings) {
  ShownHandle shown{handle, Eigen::Vector3d::Zero(), handle_pivot(handle, rest, rings), {}};
  std::vector<Index> sorted = handle.vertices;
  std::sort(sorted.begin(), sorted.end());
  for (const Index v : handle.vertices) {
    shown.centre += rest.row(v).transpose() / static_cast<double>(handle.vertices.size());
    const auto ring = rings[v];
    if (std::any_of(ring.begin(), ring.end(),
                    [&](Index w) { return !std::binary_search(sorted.begin(), sorted.end(), w); }))
      shown.rim.push_back(v);
  }
  return shown;
}

Json live_fields(LiveStage stage) { return {{"stage", to_string(stage)}}; }

}  // namespace

LiveView::Plan LiveView::plan(const Document& document, std::shared_ptr<const Object> base) const {
  Plan plan;
  plan.base = std::move(base);
  const DeformStep* step = deform_in_work(document.edit);
  plan.key = step == nullptr ? Json(plan.base->id) : key_of(document, *plan.base);
  if (step == nullptr || !is_ready(*step)) return plan;
  plan.ready = true;
  if (live_ && plan.key == key_) {
    plan.poses = poses_of(*step);
    return plan;
  }
  plan.setup = set_up_deform(document.edit, *step, place_of(document), plan.base->scene(), step->settings);
  plan.poses = plan.setup->problem.deform.poses;
  return plan;
}

void LiveView::show(const Document& document, Plan plan, const Context& context) {
  const DeformStep* step = deform_in_work(document.edit);
  const bool goes_on = plan.ready && !plan.setup;
  if (!goes_on) live_.reset();
  base_ = std::move(plan.base);
  key_ = std::move(plan.key);
  if (base_->id != shown_mesh_) outbox_.send(mesh_frame(*base_, "model"));
  shown_mesh_ = base_->id;
  if (!plan.ready) return show_rest();

  poses_ = std::move(plan.poses);
  if (plan.setup) set_up(*step, std::move(*plan.setup));
  if (live_)
    drag_to(poses_);
  else
    run_exactly(document, context);
}

void LiveView::show_rest() {
  region_ = {};
  handles_.clear();
  poses_.clear();
  moving_ = std::make_shared<const std::vector<Index>>();
  outbox_.send(roles_frame(*base_, region_), "roles");
  const auto rest = std::make_shared<const Points>(base_->mesh().positions);
  outbox_.send(position_frame(*base_, *moving_, {++last_pose_, rest}), "frame");
}

void LiveView::set_up(const DeformStep& step, DeformSetup setup) {
  region_ = setup.problem.deform.region;
  const IndexLists& rings = base_->selections->rings;
  handles_.clear();
  for (const Handle& handle : region_.handles)
    handles_.push_back(shown_handle(handle, setup.problem.rest, rings));
  moving_ = std::make_shared<const std::vector<Index>>(moving_vertices(*base_, region_));
  outbox_.send(roles_frame(*base_, region_), "roles");
  told_.reset();
  basis_sent_ = false;
  if (!is_plain(step)) return;

  const auto on_frame = [outbox = outbox_, base = base_, moving = moving_,
                         first = last_pose_](LiveFrame frame) {
    frame.pose += first;
    outbox.send(position_frame(*base, *moving, frame), "frame");
    Json fields = {{"pose", frame.pose}, {"quality", to_string(frame.quality)}, {"seconds", frame.seconds}};
    if (frame.error_rel) fields["error_rel"] = *frame.error_rel;
    outbox.tell("live", std::move(fields), "live");
  };
  const auto on_failure = [outbox = outbox_, first = last_pose_](std::int64_t pose, const Error& error) {
    outbox.tell("live", {{"pose", pose == 0 ? 0 : pose + first}, {"error", error_json(error)}});
  };
  Context context;
  context.progress = [outbox = outbox_](std::string_view stage, double fraction) {
    outbox.tell("progress", {{"of", nullptr}, {"stage", stage}, {"fraction", fraction}}, "set-up");
  };
  LiveOptions options;
  options.deformer = step.settings.deformer;
  DeformProblem& problem = setup.problem;
  if (options.deformer.method == DeformMethod::ft05)
    options.normals =
        vertex_normals(problem.rest, problem.triangles,
                       vertex_triangles(static_cast<Index>(problem.rest.rows()), problem.triangles));
  live_ = std::make_unique<LiveDeformer>(std::move(problem.rest), std::move(problem.triangles),
                                         std::move(problem.deform.region), LiveCallbacks{on_frame, on_failure},
                                         options, context);
}

// What no frame of the region alone would show: as saving does it.
void LiveView::run_exactly(const Document& document, const Context& context) {
  std::map<std::string, Scene> scenes{{base_->name, base_->scene()}};
  const EditStep& step = document.edit.steps.back();
  const StepReport report =
      run_step(document.edit, step, place_of(document), scenes, {.estimate_condition = false}, context);
  const auto positions = std::make_shared<const Points>(scenes.at(outcome_of(step)).mesh.positions);
  const LiveFrame frame{++last_pose_, positions, FrameQuality::exact, report.seconds.total};
  outbox_.send(position_frame(*base_, *moving_, frame), "frame");
  outbox_.tell("live",
               {{"stage", "ready"}, {"pose", frame.pose}, {"quality", "exact"}, {"seconds", frame.seconds}});
}

HandlePose LiveView::pose_of(const PoseSpec& spec, const ShownHandle& shown) const {
  if (const auto* motion = std::get_if<HandleMotion>(&spec.kind))
    return make_pose(*motion, motion->pivot.value_or(shown.pivot));
  HandlePose pose;
  if (const auto* matrix = std::get_if<Eigen::Matrix4d>(&spec.kind)) {
    pose.transform.matrix() = *matrix;
  } else if (const auto* redrawn = std::get_if<PoseSpec::Redrawn>(&spec.kind)) {
    pose.curve = redraw_curve(shown.handle, base_->selections->mesh.positions, redrawn->polyline);
  } else {
    throw Error(ErrorCode::input, "a pose from a file cannot be dragged", "poses");
  }
  return pose;
}

// One from a file is what it was.
std::vector<HandlePose> LiveView::poses_of(const DeformStep& step) const {
  std::vector<HandlePose> poses = poses_;
  for (std::size_t h = 0; h < handles_.size(); ++h)
    if (!std::holds_alternative<PoseSpec::DefFile>(step.handles[h].pose.kind))
      poses[h] = pose_of(step.handles[h].pose, handles_[h]);
  return poses;
}

void LiveView::drag_to(const std::vector<HandlePose>& poses) {
  live_->drag(poses);
  ++last_pose_;
}

std::int64_t LiveView::drag(const std::map<std::string, PoseSpec>& poses) {
  if (!live_) return 0;
  std::vector<HandlePose> dragged = poses_;
  for (const auto& [name, pose] : poses)
    for (std::size_t h = 0; h < handles_.size(); ++h)
      if (handles_[h].handle.name == name) dragged[h] = pose_of(pose, handles_[h]);
  drag_to(dragged);
  return last_pose_;
}

HandleShape LiveView::shape_of(const std::string& handle) const {
  for (const ShownHandle& shown : handles_)
    if (shown.handle.name == handle) return shown.handle.shape;
  throw Error(ErrorCode::input, fmt::format("there is no handle named '{}' that can be dragged", handle),
              "poses");
}

void LiveView::poll() {
  if (!live_) return;
  const LiveStage stage = live_->stage();
  if (told_ != stage) outbox_.tell("live", live_fields(stage));
  told_ = stage;
  if (basis_sent_) return;
  if (const auto basis = live_->basis()) {
    outbox_.send(weights_frame(*base_, *basis), "weights");
    basis_sent_ = true;
  }
}

bool LiveView::settled() const {
  return !live_ || told_ == LiveStage::ready || told_ == LiveStage::proxy_only || told_ == LiveStage::failed;
}

Json LiveView::counts() const {
  if (handles_.empty()) return nullptr;
  std::size_t handle = 0;
  for (const ShownHandle& shown : handles_) handle += shown.handle.vertices.size();
  const std::size_t inside =
      region_.whole ? static_cast<std::size_t>(base_->mesh().vertex_count()) : region_.vertices.size();
  return {{"region", inside},
          {"fixed", region_.fixed.size()},
          {"handle", handle},
          {"free", inside - region_.fixed.size() - handle}};
}

}  // namespace meshgraft::editor
