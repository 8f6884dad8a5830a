#include <algorithm>
#include <filesystem>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "support/paths.h"

namespace meshgraft {
namespace {

constexpr int planes_per_model = 6, loops_per_model = 3;

std::vector<std::filesystem::path> models() {
  std::vector<std::filesystem::path> files;
  for (const char* part : {"models", "open"}) {
    const std::filesystem::path folder = test::data_folder() / part;
    if (!std::filesystem::is_directory(folder)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".ply" || extension == ".obj") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

class RandomPlanes {
 public:
  explicit RandomPlanes(const Mesh& mesh)
      : low_(mesh.positions.colwise().minCoeff()), high_(mesh.positions.colwise().maxCoeff()) {}

  CutResult cut(const Mesh& mesh, const CutOptions& options) {
    Eigen::Vector3d point, normal;
    for (int k = 0; k < 3; ++k) {
      point[k] = low_[k] + (0.3 + 0.4 * uniform()) * (high_[k] - low_[k]);
      normal[k] = 2 * uniform() - 1;
    }
    return cut_by_plane(mesh, {point, normal}, options);
  }

 private:
  double uniform() { return static_cast<double>(random_()) / 4294967296.0; }

  Eigen::Vector3d low_, high_;
  std::mt19937 random_{3};
};

void expect_sound(const CutResult& cut, const TopologySummary& before) {
  const TopologySummary after = summarise_topology(cut.mesh);
  EXPECT_FALSE(cut.loops.empty());
  if (before.manifold) {
    EXPECT_TRUE(after.manifold);
    std::set<Index> seen;
    for (const auto& loop : boundary_loops(cut.mesh))
      for (const Index v : loop) EXPECT_TRUE(seen.insert(v).second) << "vertex " << v << " is on two loops";
  }
  EXPECT_TRUE(after.oriented || !before.oriented);
  if (before.closed) {
    EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
    EXPECT_EQ(after.boundary_loops, static_cast<Index>(cut.loops.size()));
  }
}

// Returns vertices of the uncut mesh beside the first loop of a plane's cut, at equal steps.
std::vector<Index> stations_beside(const CutResult& cut, std::size_t count) {
  std::vector<Index> stations;
  const std::vector<Index>& loop = cut.loops.front();
  for (std::size_t k = 0; k < count; ++k) {
    const Index v = cut.origin[loop[loop.size() * k / count]].from;
    if (std::find(stations.begin(), stations.end(), v) == stations.end()) stations.push_back(v);
  }
  return stations;
}

TEST(CutData, RandomPlanesAndLoopsThroughTheModels) {
  const auto files = models();
  if (files.empty()) GTEST_SKIP() << "no models in " << test::data_folder() << "; set MESHGRAFT_DATA";
  for (const auto& path : files) {
    const Mesh mesh = read_mesh(path);
    if (mesh.vertex_count() > 50000) continue;
    const TopologySummary before = summarise_topology(mesh);
    RandomPlanes planes(mesh);
    int cuts = 0;
    for (int k = 0; k < planes_per_model; ++k) {
      SCOPED_TRACE(path.filename().string() + ", plane " + std::to_string(k));
      try {
        const CutResult cut = planes.cut(mesh, {.snap = k % 2 == 0 ? 0.1 : 0.0});
        expect_sound(cut, before);
        ++cuts;
        if (k >= loops_per_model) continue;
        const auto stations = stations_beside(cut, 3 + k);
        if (stations.size() >= 3) expect_sound(cut_along_loop(mesh, stations), before);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();  // missing plane, or loop at the border
      }
    }
    EXPECT_GT(cuts, 0) << path;  // some planes miss
  }
}

}  // namespace
}  // namespace meshgraft
