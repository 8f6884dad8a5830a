// Measures what a decimated proxy costs and how far its result is from the direct solve. Prints the tables of
// docs/performance.md as Markdown.
//
//   meshgraft_proxy [--edit sheet|bar|sphere] [--vertices N] [--proxies N,N,…] [--method NAME] [--no-direct]

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/deform/quality.h>
#include <meshgraft/deform/quick_frames.h>

#include "../cli/blas_kernels.h"
#include "bench_edit.h"
#include "support/mesh_families.h"

namespace meshgraft::bench {
namespace {

struct Settings {
  std::string edit = "sheet";
  Index vertices = 100000;
  std::vector<Index> proxies{2000, 4000, 8000, 16000, 32000, 64000};
  DeformMethod method = DeformMethod::corotational;
  bool direct = true;
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

BenchEdit of_scene(test::Scene scene, const Eigen::Matrix3d& turn, const Eigen::Vector3d& move) {
  BenchEdit edit;
  Eigen::RowVector3d pivot = Eigen::RowVector3d::Zero();
  for (const Index v : scene.head)
    pivot += scene.mesh.positions.row(v) / static_cast<double>(scene.head.size());
  edit.positions = std::move(scene.mesh.positions);
  edit.triangles = std::move(scene.mesh.triangles);
  edit.fixed = std::move(scene.foot);
  edit.handle = std::move(scene.head);
  edit.pose = Eigen::Translation3d(pivot.transpose() + move) * turn * Eigen::Translation3d(-pivot.transpose());
  return edit;
}

BenchEdit make_edit(const Settings& settings) {
  using std::numbers::pi;
  if (settings.edit == "bar") {
    // Four times as long as wide: 16 across² vertices on its sides, 2 across² on its ends.
    const int across = static_cast<int>(std::lround(std::sqrt(settings.vertices / 18.0)));
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return of_scene(test::make_scene(test::bar(across, 4 * across), 0.1, 0.1), turn, {0, 0, 0});
  }
  if (settings.edit == "sphere") {
    int level = 0;
    while (10 * (1 << (2 * level)) < settings.vertices) ++level;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 1, 0).normalized()).toRotationMatrix();
    return of_scene(test::make_scene(test::bumpy_sphere(level)), turn, {0.3, 0.2, 0.5});
  }
  return make_bump_edit(settings.vertices);
}

void report(const Settings& settings, const BenchEdit& edit, const std::optional<Points>& direct, Index count) {
  const Region region = region_of(edit);
  HandlePose pose;
  pose.transform = edit.pose;
  const std::vector poses{pose};
  ProxyOptions options;
  options.vertices = count;
  options.deformer.method = settings.method;
  double start = seconds();
  const ProxyDeformer proxy(edit.positions, edit.triangles, region, options);
  const double set_up = seconds() - start;
  Points positions = edit.positions;
  std::vector<double> frames;
  for (int frame = 0; frame < 3; ++frame) {
    start = seconds();
    proxy.evaluate(poses, positions);
    frames.push_back(seconds() - start);
  }
  std::sort(frames.begin(), frames.end());
  const ProxySummary& s = proxy.summary();
  fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.1f} |", count, s.vertices,
             1e3 * s.decimate_seconds, 1e3 * s.skin_seconds, 1e3 * set_up, 1e3 * frames[1],
             static_cast<double>(s.skin_entries) / std::max<Index>(1, s.free_vertices));
  if (direct) {
    double moved = 0, largest = 0, sum = 0;
    for (const Index v : proxy.free_vertices()) {
      moved = std::max(moved, ((*direct).row(v) - edit.positions.row(v)).norm());
      const double error = ((*direct).row(v) - positions.row(v)).norm();
      largest = std::max(largest, error);
      sum += error * error;
    }
    for (const Index v : edit.handle)
      moved = std::max(moved, ((*direct).row(v) - edit.positions.row(v)).norm());
    // Dihedral angles against those of the direct solve show how rough the result is.
    const Quality beside = measure_quality({*direct, positions, edit.triangles, proxy.free_vertices()},
                                           {.self_intersections = false});
    fmt::print(" {:.3f} | {:.3f} | {:.2f} | {:.2f} | {:.2f} |", 100 * largest / moved,
               100 * std::sqrt(sum / static_cast<double>(s.free_vertices)) / moved, beside.dihedral_p99_deg,
               beside.dihedral_max_deg, beside.rim_jump_max_deg);
  }
  fmt::print(" {:.0f} |\n", peak_mib());
  std::fflush(stdout);
}

void run(const Settings& settings) {
  const BenchEdit edit = make_edit(settings);
  fmt::print("{}, {} vertices, {}; {:.0f} MiB before\n", settings.edit, edit.positions.rows(),
             to_string(settings.method), peak_mib());
  std::optional<Points> direct;
  if (settings.direct) {
    HandlePose pose;
    pose.transform = edit.pose;
    DeformerOptions options;
    options.method = settings.method;
    double start = seconds();
    const Deformer deformer(edit.positions, edit.triangles, region_of(edit), options);
    const double set_up = seconds() - start;
    start = seconds();
    direct = deformer.evaluate(std::vector{pose});
    const double frame = seconds() - start;
    const Quality quality = measure_quality({edit.positions, *direct, edit.triangles, deformer.free_vertices()},
                                            {.self_intersections = false});
    fmt::print(
        "direct: set-up {:.0f} ms, frame {:.0f} ms, solver {:.0f} MiB, dihedral change p99 {:.2f}, peak {:.0f} "
        "MiB\n",
        1e3 * set_up, 1e3 * frame, static_cast<double>(deformer.summary().solver.peak_memory_bytes) / 1048576,
        quality.dihedral_p99_deg, peak_mib());
  }
  fmt::print("| asked | proxy | decimate | skin | set-up | frame | entries |{} peak MiB |\n",
             direct ? " max error % | RMS % | dihedral p99 | max | rim max |" : "");
  for (const Index count : settings.proxies) report(settings, edit, direct, count);
}

Settings parse(int count, char** arguments) {
  Settings settings;
  for (int i = 1; i < count; ++i) {
    const std::string_view name = arguments[i];
    const std::string value = i + 1 < count ? arguments[i + 1] : "";
    if (name == "--no-direct") {
      settings.direct = false;
      continue;
    }
    ++i;
    if (name == "--edit") settings.edit = value;
    if (name == "--vertices") settings.vertices = static_cast<Index>(std::stol(value));
    if (name == "--method") {
      for (const DeformMethod method :
           {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational})
        if (to_string(method) == value) settings.method = method;
    }
    if (name == "--proxies") {
      settings.proxies.clear();
      for (std::size_t at = 0; at < value.size(); ++at) {
        settings.proxies.push_back(static_cast<Index>(std::stol(value.substr(at))));
        at = std::min(value.find(',', at), value.size());
      }
    }
  }
  return settings;
}

}  // namespace
}  // namespace meshgraft::bench

int main(int count, char** arguments) {
  meshgraft::cli::restart_with_better_blas_kernels(arguments);
  meshgraft::bench::run(meshgraft::bench::parse(count, arguments));
  return EXIT_SUCCESS;
}
