// Runs one edit by CGAL for bench/python/beside.py.
//
//   meshgraft_cgal_edit METHOD ITERATIONS < EDIT > RESULT
//
// EDIT and RESULT are raw numbers of this machine. EDIT: the counts of vertices, triangles, fixed vertices and
// vertices of the handle (int64), then these (float64, int32, int32, int32), then the pose (4×4 float64, row by
// row). RESULT: processor seconds of construction, preprocess() and deform() (float64), then the positions
// (float64).

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "cgal_deformation.h"

namespace meshgraft::bench {
namespace {

template <class T>
void read(T* to, std::size_t count) {
  if (std::fread(to, sizeof(T), count, stdin) != count) throw std::runtime_error("the edit is too short");
}

void write(const double* from, std::size_t count) {
  if (std::fwrite(from, sizeof(double), count, stdout) != count) throw std::runtime_error("cannot write");
}

BenchEdit read_edit() {
  std::array<std::int64_t, 4> counts{};
  read(counts.data(), counts.size());
  BenchEdit edit;
  edit.positions.resize(counts[0], 3);
  read(edit.positions.data(), 3 * counts[0]);
  edit.triangles.resize(counts[1], 3);
  read(edit.triangles.data(), 3 * counts[1]);
  edit.fixed.resize(counts[2]);
  read(edit.fixed.data(), edit.fixed.size());
  edit.handle.resize(counts[3]);
  read(edit.handle.data(), edit.handle.size());
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> pose;
  read(pose.data(), 16);
  edit.pose.matrix() = pose;
  return edit;
}

void run(const std::string& method, unsigned iterations) {
  const BenchEdit edit = read_edit();
  const CgalResult result = run_cgal(edit, method == "sre" ? CgalMethod::sre_arap : CgalMethod::spokes_and_rims,
                                     {.iterations = iterations, .clock = CgalClock::processor});
  const std::array<double, 3> seconds{result.times.construct_seconds, result.times.preprocess_seconds,
                                      result.times.deform_seconds};
  write(seconds.data(), seconds.size());
  write(result.positions.data(), static_cast<std::size_t>(result.positions.size()));
}

}  // namespace
}  // namespace meshgraft::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: meshgraft_cgal_edit sre|rims ITERATIONS < EDIT > RESULT\n", stderr);
    return 2;
  }
  try {
    meshgraft::bench::run(argv[1], static_cast<unsigned>(std::atoi(argv[2])));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
