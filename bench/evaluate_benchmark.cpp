// Times evaluations into the caller's memory, for bench/python/overhead.py.
//
//   meshgraft_evaluate RESOLUTION COUNT
//
// Prints the median microseconds of COUNT calls, on one thread, on the sample "bar" with both ends as handles
// and method ft05: one of Deformer::evaluate, and one of HandleBasis::frame.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quick_frames.h>
#include <meshgraft/samples/samples.h>

namespace meshgraft::bench {
namespace {

template <class Call>
double median_microseconds(int count, Call&& call) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  for (int k = 0; k < count; ++k) {
    const auto start = Clock::now();
    call();
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  std::nth_element(times.begin(), times.begin() + count / 2, times.end());
  return times[static_cast<std::size_t>(count / 2)];
}

void run(int resolution, int count) {
  const Mesh bar = make_sample("bar", resolution);
  const Triangles triangles = triangulate(bar).triangles;
  Region region{.whole = true};
  region.handles.resize(2);
  for (Index v = 0; v < bar.vertex_count(); ++v) {
    if (bar.positions(v, 2) < 0.3) region.handles[0].vertices.push_back(v);
    if (bar.positions(v, 2) > 3.7) region.handles[1].vertices.push_back(v);
  }
  const Deformer deformer(bar.positions, triangles, region, {.method = DeformMethod::ft05});
  const HandleBasis basis(deformer, Points());
  std::vector<HandlePose> poses(2);
  poses[1] = make_pose({.axis = Eigen::Vector3d::UnitY(), .angle_deg = 20}, Eigen::Vector3d(0, 0, 3.7));
  Points out(bar.vertex_count(), 3);
  const Context one_thread{.threads = 1};
  std::printf("%.2f %.2f\n", median_microseconds(count, [&] { deformer.evaluate(poses, out, one_thread); }),
              median_microseconds(count, [&] { basis.frame(poses, out, nullptr, one_thread); }));
}

}  // namespace
}  // namespace meshgraft::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: meshgraft_evaluate RESOLUTION COUNT\n", stderr);
    return 2;
  }
  meshgraft::bench::run(std::atoi(argv[1]), std::atoi(argv[2]));
}
