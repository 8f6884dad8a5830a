#include "live_view.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <fmt/format.h>

#include <meshgraft/mesh/normals.h>

#include "core/memory.h"
#include "deform/setup/memory_estimate.h"
#include "editor/facts.h"
#include "mesh_messages.h"
#include "script/symmetry.h"

namespace meshgraft::editor {

namespace {

Location location_of(const Document& document) {
  return (Location::file(document.edit.location) / "steps")[*step_in_work(document.edit)];
}

// Returns whether a live frame of the region, driven by handles alone, shows exactly what the step computes.
bool is_plain(const DeformStep& step) {
  return step.targets.empty() && step.transforms.empty() && step.settings.refine_boundary.value_or(0) == 0 &&
         step.settings.proxy == 0;
}

Json key_of(const Document& document, const Object& base) {
  Json step = document.json["steps"].back();
  if (step.contains("handles"))
    for (Json& handle : step["handles"])
      if (handle.contains("pose") && !handle["pose"].contains("def")) handle.erase("pose");
  return {base.id, step, selections_used(document.json, step)};
}

// Returns whether two steps differ in their regions alone: mesh, settings and welding are the same.
bool shares_mesh(const Json& key, const Json& other) {
  const auto settings_of = [](const Json& one) {
    return one.is_array() ? one[1].value("settings", Json()) : Json();
  };
  return key.is_array() && other.is_array() && key[0] == other[0] && settings_of(key) == settings_of(other);
}

// Returns the similarity nearest to the motion of some points. It is the identity where all points moved by
// at most `least`. It is a translation where the points do not determine a rotation (fewer than three, or
// collinear).
Eigen::Affine3d nearest_similarity(const Points& rest, const Points& shown, double least) {
  Eigen::Affine3d moved = Eigen::Affine3d::Identity();
  if (rest.rows() == 0 || (shown - rest).rowwise().norm().maxCoeff() <= least) return moved;
  const Eigen::RowVector3d from = rest.colwise().mean(), to = shown.colwise().mean();
  moved.translation() = (to - from).transpose();
  if (rest.rows() < 3) return moved;
  const Eigen::Vector3d spread = (rest.transpose().colwise() - from.transpose()).jacobiSvd().singularValues();
  if (spread(1) <= 1e-6 * spread(0)) return moved;
  const Eigen::Affine3d similar(Eigen::umeyama(rest.transpose(), shown.transpose(), true));
  return similar.linear().determinant() > 1e-9 ? similar : moved;
}

// Writes a similarity as a pose of an edit file, x' = c + t + s R (x - c).
Json motion_json(const Eigen::Affine3d& similarity, const Eigen::Vector3d& pivot) {
  if (similarity.matrix().isIdentity(0)) return Json::object();
  const double scale = std::cbrt(similarity.linear().determinant());
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(similarity.linear() / scale));
  const Eigen::Vector3d translate = similarity * pivot - pivot, &axis = turn.axis();
  return {{"translate", {translate.x(), translate.y(), translate.z()}},
          {"rotate", {{"axis", {axis.x(), axis.y(), axis.z()}}, {"angle_deg", turn.angle() * 180 / EIGEN_PI}}},
          {"scale", scale}};
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
  if (shown_.live && plan.key == shown_.key) {
    plan.poses = poses_of(*step);
    return plan;
  }
  if (parked_ && plan.key == parked_->key) {
    plan.resumes = true;
    return plan;
  }
  plan.setup = set_up_deform(document.edit, *step, location_of(document), plan.base->state(), step->settings);
  plan.poses = plan.setup->problem.deform.poses;
  return plan;
}

bool LiveView::show(const Document& document, Plan plan, const Context& context) {
  const DeformStep* step = deform_in_work(document.edit);
  const bool goes_on = plan.ready && !plan.setup && !plan.resumes;
  outcome_.reset();
  std::shared_ptr<const Deformer> earlier;
  if (!goes_on) {
    if (shown_.live && !shown_.refined && shares_mesh(plan.key, shown_.key)) earlier = shown_.live->deformer();
    if (plan.setup && shown_.live && settled() && is_roomy()) park();
    if (shown_.live) {
      shown_.live.reset();
      tell_progress_ended(outbox_, "set-up");
    }
    if (!plan.setup && !plan.resumes) parked_.reset();
  }
  base_ = std::move(plan.base);
  shown_.key = std::move(plan.key);
  if (base_->id != shown_mesh_) {
    outbox_.send(mesh_frame(*base_, "model", folders_));
    exact_->forget();
  }
  shown_mesh_ = base_->id;
  if (!plan.ready) {
    show_rest();
    return false;
  }
  if (plan.resumes) {
    resume();
    plan.poses = poses_of(*step);
  }
  shown_.poses = std::move(plan.poses);
  if (plan.setup) set_up(*step, std::move(*plan.setup), std::move(earlier));
  if (shown_.live) {
    show_document();
  } else {
    parked_.reset();
    run_exactly(document, context);
  }
  return plan.setup.has_value() && shown_.live != nullptr;
}

// Returns whether memory suffices to keep the current set-up beside the next one, with room to spare for the
// choice of method.
bool LiveView::is_roomy() const {
  const Index free = static_cast<Index>(counts().value("free", std::int64_t{0}));
  return available_memory() / 4 > static_cast<std::uint64_t>(estimated_memory(free, shown_.options));
}

void LiveView::park() {
  shown_.dragged = last_pose_ - shown_.numbers->park();
  parked_ = std::move(shown_);
  shown_ = {};
}

void LiveView::resume() {
  shown_ = std::move(*parked_);
  parked_.reset();
  shown_.numbers->resume(last_pose_ - shown_.dragged);
  send_roles();
}

// Sends the roles of the vertices and resets what was told about the set-up.
void LiveView::send_roles() {
  outbox_.send(roles_frame(*base_, shown_.region), "roles");
  told_.reset();
  basis_sent_ = false;
}

void LiveView::show_rest() {
  exact_->forget();
  shown_.region = {};
  shown_.handles.clear();
  shown_.poses.clear();
  shown_.symmetry.reset();
  shown_.notes.clear();
  shown_.moving = std::make_shared<const std::vector<Index>>();
  outbox_.send(roles_frame(*base_, shown_.region), "roles");
  const auto rest = std::make_shared<const Points>(base_->mesh().positions);
  outbox_.send(position_frame(*base_, *shown_.moving, {++last_pose_, rest}), "frame");
}

void LiveView::set_up(const DeformStep& step, DeformSetup setup, std::shared_ptr<const Deformer> earlier) {
  shown_.region = setup.problem.deform.region;
  shown_.symmetry = setup.problem.deform.symmetry;
  shown_.notes = setup.problem.deform.notes;
  const IndexLists& rings = base_->selections->rings;
  shown_.handles.clear();
  for (const Handle& handle : shown_.region.handles)
    shown_.handles.push_back(shown_handle(handle, setup.problem.rest, rings));
  shown_.moving = std::make_shared<const std::vector<Index>>(moving_vertices(*base_, shown_.region));
  send_roles();
  if (!is_plain(step)) return;

  shown_.numbers = std::make_shared<FrameNumbers>(last_pose_);
  shown_.options = step.settings.deformer;
  const auto on_frame = [outbox = outbox_, base = base_, moving = shown_.moving, exact = exact_,
                         exact_alone = exact_alone_, numbers = shown_.numbers](LiveFrame frame) {
    numbers->number(frame.pose, [&](std::int64_t number) {
      frame.pose = number;
      exact->take(frame.pose, frame);
      if (frame.accuracy == FrameAccuracy::exact || !*exact_alone)
        outbox.send(position_frame(*base, *moving, frame), "frame");
      Json fields = {{"pose", frame.pose}, {"accuracy", to_string(frame.accuracy)}, {"seconds", frame.seconds}};
      if (frame.error_rel) fields["error_rel"] = *frame.error_rel;
      outbox.tell("live", std::move(fields), "live");
    });
  };
  const auto on_failure = [outbox = outbox_, exact = exact_, numbers = shown_.numbers](std::int64_t pose,
                                                                                       const Error& error) {
    numbers->number(pose, [&](std::int64_t number) {
      exact->fail(pose == 0 ? 0 : number);
      outbox.tell("live", {{"pose", pose == 0 ? 0 : number}, {"error", error_json(error)}});
    });
  };
  Context context;
  context.progress = [outbox = outbox_](const Progress& progress) {
    outbox.tell("progress", progress_fields(nullptr, progress), "set-up");
  };
  LiveOptions options;
  options.deformer = step.settings.deformer;
  options.earlier = std::move(earlier);
  ResolvedProblem& problem = setup.problem;
  const auto count = static_cast<Index>(problem.rest.rows());
  if (options.deformer.method == DeformMethod::ft05)
    options.normals =
        vertex_normals(problem.rest, problem.triangles, vertex_triangles(count, problem.triangles));
  problem = refine_boundary(std::move(problem), step.settings.refine_boundary, context);
  const Eigen::Index added = problem.rest.rows() - count;
  shown_.refined = added > 0;
  if (shown_.refined) options.earlier.reset();  // it solves on another mesh
  if (shown_.refined && options.normals.rows() > 0) {
    options.normals.conservativeResize(problem.rest.rows(), 3);
    options.normals.bottomRows(added).rowwise() = Eigen::RowVector3d(0, 0, 1);  // not shown
  }
  shown_.live = std::make_unique<LiveDeformer>(
      DeformProblem{std::move(problem.rest), std::move(problem.triangles), std::move(problem.deform.region)},
      LiveCallbacks{on_frame, on_failure}, options, context);
}

// Runs the step as saving does, where a frame of the region alone would not show its result.
void LiveView::run_exactly(const Document& document, const Context& context) {
  std::map<std::string, MeshState> states{{base_->name, base_->state()}};
  const EditStep& step = document.edit.steps.back();
  const StepReport report = run_step(document.edit, step, location_of(document), states, {}, context);
  const auto positions = std::make_shared<const Points>(states.at(outcome_of(step)).mesh.positions);
  const LiveFrame frame{++last_pose_, positions, FrameAccuracy::exact, report.seconds.total};
  outcome_ = std::make_shared<const MeshState>(std::move(states.at(outcome_of(step))));
  exact_->take(frame.pose, frame);
  outbox_.send(position_frame(*base_, *shown_.moving, frame), "frame");
  outbox_.tell("live",
               {{"stage", "ready"}, {"pose", frame.pose}, {"accuracy", "exact"}, {"seconds", frame.seconds}});
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
    throw Error(facts::editor::PoseFromFile{}, "poses");
  }
  return pose;
}

// Moves a handle's twin, where it has one, with the handle.
void LiveView::mirror_pose(const PoseSpec& spec, std::size_t handle, std::vector<HandlePose>& poses) const {
  if (!shown_.symmetry) return;
  const std::size_t first = shown_.handles.size() - shown_.symmetry->twin_of.size();
  for (std::size_t t = 0; t < shown_.symmetry->twin_of.size(); ++t)
    if (shown_.symmetry->twin_of[t] == handle)
      poses[first + t] = twin_pose(spec, poses[handle], shown_.handles[first + t].handle,
                                   base_->selections->mesh.positions, shown_.symmetry->reflection);
}

// Returns the poses of the step's handles. A pose from a file keeps its value.
std::vector<HandlePose> LiveView::poses_of(const DeformStep& step) const {
  std::vector<HandlePose> poses = shown_.poses;
  for (std::size_t h = 0; h < step.handles.size(); ++h) {
    if (std::holds_alternative<PoseSpec::DefFile>(step.handles[h].pose.kind)) continue;
    poses[h] = pose_of(step.handles[h].pose, shown_.handles[h]);
    mirror_pose(step.handles[h].pose, h, poses);
  }
  return poses;
}

std::vector<Note> LiveView::notes() const {
  std::vector<Note> notes = shown_.notes;
  if (!shown_.symmetry) return notes;
  const std::vector<Note> on_poses =
      pose_notes(*shown_.symmetry, shown_.region.handles, shown_.poses, base_->selections->mesh.positions);
  notes.insert(notes.end(), on_poses.begin(), on_poses.end());
  return notes;
}

void LiveView::ExactFrame::expect(std::int64_t next) {
  const std::lock_guard lock(mutex);
  pose = next;
  positions.reset();
  failed = false;
}

void LiveView::ExactFrame::take(std::int64_t number, const LiveFrame& frame) {
  const std::lock_guard lock(mutex);
  last = frame.positions;
  if (number != pose || frame.accuracy != FrameAccuracy::exact) return;
  positions = frame.positions;
  changed.notify_all();
}

// Marks the frame as failed; `number` 0 stands for all poses.
void LiveView::ExactFrame::fail(std::int64_t number) {
  const std::lock_guard lock(mutex);
  failed = failed || number == 0 || number == pose;
  changed.notify_all();
}

void LiveView::ExactFrame::forget() {
  const std::lock_guard lock(mutex);
  last.reset();
}

Json LiveView::pose_as_shown(const std::vector<Index>& vertices) const {
  std::shared_ptr<const Points> shown;
  {
    const std::lock_guard lock(exact_->mutex);
    shown = exact_->last;
  }
  if (!shown) return Json::object();
  const SelectionMesh& selections = *base_->selections;
  const Points& rest = selections.mesh.positions;
  Handle handle;
  for (const Index v : vertices) handle.vertices.push_back(base_->weld.of(v));
  return motion_json(nearest_similarity(rest(handle.vertices, Eigen::all),
                                        (*shown)(handle.vertices, Eigen::all), 1e-6 * base_->diagonal),
                     handle_pivot(handle, rest, selections.rings));
}

void LiveView::show_document() {
  exact_->expect(last_pose_ + 1);
  drag_to(shown_.poses);
}

// Returns the exact positions of the document's poses, or null. A solve that reuses an earlier set-up is
// refused: its result is close to that of running the step, but not the same bytes.
std::shared_ptr<const Points> LiveView::exact_positions(const Context& context) {
  const auto is_known = [&] {
    const std::lock_guard lock(exact_->mutex);
    return exact_->positions != nullptr;
  };
  if (last_pose_ != exact_->pose && !is_known()) show_document();  // another pose was dragged meanwhile
  std::unique_lock lock(exact_->mutex);
  constexpr auto patience = std::chrono::milliseconds(20);
  while (!exact_->positions && !exact_->failed && shown_.live->stage() != LiveStage::failed &&
         shown_.live->stage() != LiveStage::proxy_only) {
    context.throw_if_stopped();
    exact_->changed.wait_for(lock, patience);
  }
  const auto deformer = shown_.live->deformer();
  return deformer && !deformer->summary().reused ? exact_->positions : nullptr;
}

std::shared_ptr<const MeshState> LiveView::outcome(const Document& document, const Context& context) {
  if (outcome_ || !shown_.live) return outcome_;
  if (const auto deformer = shown_.live->deformer(); deformer && deformer->summary().reused) return nullptr;
  const auto positions = exact_positions(context);
  if (!positions) return nullptr;
  const EditStep& step = document.edit.steps.back();
  std::map<std::string, MeshState> states{{base_->name, base_->state()}};
  apply_solution(document.edit, step, location_of(document), states, *positions, context);
  return std::make_shared<const MeshState>(std::move(states.at(outcome_of(step))));
}

void LiveView::drag_to(const std::vector<HandlePose>& poses, bool exact_alone) {
  *exact_alone_ = exact_alone;
  try {
    shown_.live->drag(poses);
  } catch (const Error& error) {
    throw error.at({});  // the number of the pose means nothing to the page, which knows what it asked for
  }
  ++last_pose_;
}

std::int64_t LiveView::drag(const std::map<std::string, PoseSpec>& poses, bool exact_alone) {
  if (!shown_.live) return 0;
  std::vector<HandlePose> dragged = shown_.poses;
  for (const auto& [name, pose] : poses)
    for (std::size_t h = 0; h < shown_.handles.size(); ++h)
      if (shown_.handles[h].handle.name == name) {
        dragged[h] = pose_of(pose, shown_.handles[h]);
        mirror_pose(pose, h, dragged);
      }
  drag_to(dragged, exact_alone);
  return last_pose_;
}

HandleShape LiveView::shape_of(const std::string& handle) const {
  const std::size_t twins = shown_.symmetry ? shown_.symmetry->twin_of.size() : 0;
  for (std::size_t h = 0; h < shown_.handles.size(); ++h) {
    if (shown_.handles[h].handle.name != handle) continue;
    if (h + twins < shown_.handles.size()) return shown_.handles[h].handle.shape;
    const std::string& leader =
        shown_.handles[shown_.symmetry->twin_of[h - (shown_.handles.size() - twins)]].handle.name;
    throw Error(facts::editor::HandleFollows{.handle = handle, .leader = leader}, "poses");
  }
  throw Error(facts::editor::NoDraggableHandle{.handle = handle}, "poses");
}

void LiveView::poll() {
  if (!shown_.live) return;
  const LiveStage stage = shown_.live->stage();
  if (told_ != stage) outbox_.tell("live", live_fields(stage));
  told_ = stage;
  if (settled()) parked_.reset();
  if (basis_sent_) return;
  if (const auto basis = shown_.live->basis()) {
    outbox_.send(weights_frame(*base_, *basis), "weights");
    basis_sent_ = true;
  }
}

bool LiveView::settled() const {
  return !shown_.live || told_ == LiveStage::ready || told_ == LiveStage::proxy_only ||
         told_ == LiveStage::failed;
}

Json LiveView::counts() const {
  if (shown_.handles.empty()) return nullptr;
  std::size_t handle = 0;
  for (const ShownHandle& shown : shown_.handles) handle += shown.handle.vertices.size();
  const std::size_t inside = shown_.region.whole ? static_cast<std::size_t>(base_->mesh().vertex_count())
                                                 : shown_.region.vertices.size();
  return {{"region", inside},
          {"fixed", shown_.region.fixed.size()},
          {"handle", handle},
          {"free", inside - shown_.region.fixed.size() - handle}};
}

}  // namespace meshgraft::editor
