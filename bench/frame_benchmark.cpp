#include "frame_benchmark.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include <meshgraft/deform/live_deformer.h>
#include <meshgraft/deform/quick_frames.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "../src/core/stopwatch.h"

namespace meshgraft::bench {

namespace {

constexpr int frames_timed = 21;

/// The edit's handle, or several discs in a circle around the middle, each with its own turn.
struct ManyHandles {
  Region region;
  std::vector<HandlePose> poses;
};

ManyHandles with_handles(const BenchEdit& edit, int count) {
  ManyHandles many;
  if (count == 1) {
    many.region = region_of(edit);
    many.poses.resize(1);
    many.poses[0].transform = edit.pose;
    return many;
  }
  many.region.whole = true;
  many.region.fixed = edit.fixed;
  for (int h = 0; h < count; ++h) {
    const double angle = 2 * std::numbers::pi * h / count;
    const Eigen::Vector3d centre(0.5 + 0.3 * std::cos(angle), 0.5 + 0.3 * std::sin(angle), 0);
    Handle handle{"disc " + std::to_string(h)};
    for (Index v = 0; v < static_cast<Index>(edit.positions.rows()); ++v)
      if ((edit.positions.row(v).transpose() - centre).head<2>().norm() < 0.04) handle.vertices.push_back(v);
    many.region.handles.push_back(std::move(handle));
    HandlePose pose;
    pose.transform = Eigen::Translation3d(centre + Eigen::Vector3d(0, 0, 0.05)) *
                     Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * Eigen::Translation3d(-centre);
    many.poses.push_back(pose);
  }
  return many;
}

/// Returns the largest distance between two results, relative to the largest displacement.
double relative_error(const Points& positions, const Points& exact, const Points& rest) {
  return (positions - exact).rowwise().norm().maxCoeff() / (exact - rest).rowwise().norm().maxCoeff();
}

void count(benchmark::State& state, const BenchEdit& edit, double set_up, std::int64_t peak_bytes,
           double error) {
  average(state);
  state.counters["vertices"] = static_cast<double>(edit.positions.rows());
  state.counters["set_up"] = set_up;
  state.counters["peak_bytes"] = static_cast<double>(peak_bytes);
  state.counters["error"] = error;
}

void run_linear(benchmark::State& state, const BenchEdit& edit, DegenerateTreatment treatment, int handles) {
  const ManyHandles many = with_handles(edit, handles);
  DeformerOptions options;
  options.method = DeformMethod::ft05;
  options.operators.degenerate = treatment;
  const auto count_of = static_cast<Index>(edit.positions.rows());
  const Points normals =
      vertex_normals(edit.positions, edit.triangles, vertex_triangles(count_of, edit.triangles));
  double set_up = 0, error = 0;
  const PeakMemory memory;
  for ([[maybe_unused]] auto iteration : state) {
    std::unique_ptr<Deformer> deformer;
    std::unique_ptr<HandleBasis> basis;
    set_up = seconds(
        [&] { deformer = std::make_unique<Deformer>(edit.positions, edit.triangles, many.region, options); });
    const double columns = seconds([&] { basis = std::make_unique<HandleBasis>(*deformer, normals); });
    Points positions(count_of, 3);
    Directions turned(count_of, 3);
    const double frame = median_seconds(frames_timed, [&] { basis->frame(many.poses, positions, &turned); });
    report(state, {{"basis", columns}, {"frame", frame}});
    error = relative_error(positions, deformer->evaluate(many.poses), edit.positions);
  }
  count(state, edit, set_up, memory.bytes(), error);
}

void run_reduced(benchmark::State& state, const BenchEdit& edit) {
  const ManyHandles one = with_handles(edit, 1);
  double set_up = 0, error = 0;
  const PeakMemory memory;
  for ([[maybe_unused]] auto iteration : state) {
    std::unique_ptr<Deformer> deformer;
    std::unique_ptr<ReducedFrames> reduced;
    set_up =
        seconds([&] { deformer = std::make_unique<Deformer>(edit.positions, edit.triangles, one.region); });
    const double columns = seconds([&] { reduced = std::make_unique<ReducedFrames>(*deformer); });
    Points positions(edit.positions.rows(), 3), exact(edit.positions.rows(), 3);
    const double frame = median_seconds(frames_timed, [&] { reduced->frame(one.poses, positions); });
    const double evaluate = seconds([&] { deformer->evaluate(one.poses, exact); });
    report(state, {{"basis", columns}, {"frame", frame}, {"evaluate", evaluate}});
    error = relative_error(positions, exact, edit.positions);
  }
  count(state, edit, set_up, memory.bytes(), error);
}

void run_proxy(benchmark::State& state, const BenchEdit& edit) {
  const ManyHandles one = with_handles(edit, 1);
  double set_up = 0;
  const PeakMemory memory;
  for ([[maybe_unused]] auto iteration : state) {
    std::unique_ptr<ProxyDeformer> proxy;
    set_up =
        seconds([&] { proxy = std::make_unique<ProxyDeformer>(edit.positions, edit.triangles, one.region); });
    Points positions(edit.positions.rows(), 3);
    const double frame = median_seconds(5, [&] { proxy->evaluate(one.poses, positions); });
    report(state, {{"frame", frame}});
  }
  count(state, edit, set_up, memory.bytes(), 0);
}

/// Drags a region at once: one pose right after construction, and another when everything is made.
void run_live(benchmark::State& state, const BenchEdit& edit, DeformMethod method) {
  const ManyHandles one = with_handles(edit, 1);
  LiveOptions options;
  options.deformer.method = method;
  for ([[maybe_unused]] auto iteration : state) {
    const Stopwatch watch;
    std::atomic<double> first = 0, quick = 0;  // set on the frames' thread
    const auto on_frame = [&](const LiveFrame& frame) {
      if (first == 0) first = watch.seconds();
      if (frame.accuracy != FrameAccuracy::exact) quick = frame.seconds;
    };
    LiveDeformer live({edit.positions, edit.triangles, one.region}, {on_frame, {}}, options);
    live.drag(one.poses);
    live.wait_until_exact();
    const double exact = watch.seconds();
    while (live.stage() != LiveStage::ready) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const double made = watch.seconds();
    live.drag(one.poses);
    live.wait_until_exact();
    report(state, {{"first", first}, {"exact", exact - first}, {"made", made - exact}, {"quick", quick}});
  }
  average(state);
  state.counters["vertices"] = static_cast<double>(edit.positions.rows());
}

}  // namespace

void register_frames(Edits& edits) {
  const auto noise = DegenerateTreatment::ft05_noise, apex = DegenerateTreatment::apex;
  struct Case {
    DegenerateTreatment treatment;
    int handles;
    Index size;
  };
  for (const auto& [treatment, handles, size] :
       {Case{apex, 1, 50'000}, Case{apex, 1, 100'000}, Case{apex, 1, 250'000}, Case{apex, 8, 250'000},
        Case{noise, 1, 1'000'000}})
    add("frames/linear-" + std::to_string(handles) + "/" + std::string(to_string(treatment)) + "/" +
            std::to_string(size),
        [&edits, treatment = treatment, handles = handles, size = size](benchmark::State& state) {
          run_linear(state, edits[size], treatment, handles);
        });
  for (const Index size : {10'000, 50'000, 100'000, 250'000})
    add("frames/reduced/corotational/" + std::to_string(size),
        [&edits, size](benchmark::State& state) { run_reduced(state, edits[size]); });
  for (const Index size : {50'000, 250'000, 1'000'000})
    add("frames/proxy/corotational/" + std::to_string(size),
        [&edits, size](benchmark::State& state) { run_proxy(state, edits[size]); });
  for (const auto method : {DeformMethod::corotational, DeformMethod::ft05})
    add("live/" + std::string(to_string(method)) + "/at-once/250000",
        [&edits, method](benchmark::State& state) { run_live(state, edits[250'000], method); });
}

}  // namespace meshgraft::bench
