#include "merge/closed_drops.h"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/open_base.h"

namespace meshgraft::test {
namespace {

class ClosedDrops : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(ClosedDrops, AreGraftedAndValid) {
  const auto [model, place] = GetParam();
  const auto drop = closed_drop(model, place, 32);
  if (!drop) GTEST_SKIP() << "the public test data are not there";
  SCOPED_TRACE(drop->name);
  const DropResult result = drop_source(drop->target, drop->source, {drop->vertex});
  EXPECT_EQ(faults_of(*drop, result), std::vector<std::string>());
  ASSERT_TRUE(result.base.has_value());
  EXPECT_EQ(result.merge.report.pairs.size(), static_cast<std::size_t>(result.base->loops));
}

std::string name_of(const testing::TestParamInfo<std::pair<int, int>>& info) {
  return std::to_string(info.param.first) + "_" + std::to_string(info.param.second);
}

// Each built-in model once; the dinosaur and the bracket stand on four feet.
INSTANTIATE_TEST_SUITE_P(Models, ClosedDrops,
                         testing::Values(std::pair(0, 0), std::pair(1, 4), std::pair(2, 1), std::pair(3, 2),
                                         std::pair(4, 3), std::pair(5, 0), std::pair(6, 4), std::pair(7, 3),
                                         std::pair(8, 2), std::pair(9, 1), std::pair(3, 3), std::pair(5, 2)),
                         name_of);

TEST(ClosedDrop, NamesVerticesAsTheClosedSourceDoes) {
  const Mesh target = make_sample("bumpy_plane", 40), source = [] {
    Mesh cactus = make_sample("cactus", 24);
    cactus.positions *= 0.1;
    return cactus;
  }();
  const DropResult result = drop_source(target, source, {Eigen::Vector3d::Zero()});
  const MergeResult& merge = result.merge;
  ASSERT_EQ(merge.source.new_index.size(), static_cast<std::size_t>(source.vertex_count()));
  ASSERT_EQ(merge.grafted.rows(), source.vertex_count());
  const Similarity& map = merge.report.shape.similarity;
  Index gone = 0, far = 0;
  const std::set<Index> band(merge.band.begin(), merge.band.end());
  for (Index v = 0; v < source.vertex_count(); ++v) {
    const Index now = merge.source.new_index[v];
    if (now < 0) {
      ++gone;
      continue;
    }
    if (!band.contains(now)) {
      EXPECT_EQ(merge.mesh.positions.row(now), merge.grafted.row(v));
    }
    const Eigen::Vector3d moved =
        map.scale * map.rotation * source.positions.row(v).transpose() + map.translation;
    far += (moved - merge.grafted.row(v).transpose()).norm() < 1e-9 ? 1 : 0;
  }
  EXPECT_EQ(gone, result.base->cut_away);
  EXPECT_GT(far, source.vertex_count() / 3);  // all beyond the influence radius
  for (const PairReport& pair : merge.report.pairs)
    for (const Index v : pair.met) EXPECT_TRUE(v >= 0 && v < source.vertex_count());
  ASSERT_FALSE(result.notes.empty());
  EXPECT_EQ(result.notes.front().id(), "merge.base_cut");
}

// A source that was cut open by hand, at the plane that the report names, is grafted alike.
TEST(ClosedDrop, IsTheDropOfWhatThePlaneLeaves) {
  const Mesh target = make_sample("bumpy_plane", 40);
  Mesh source = make_sample("cactus", 24);
  source.positions *= 0.1;
  const DropResult closed = drop_source(target, source, {Eigen::Vector3d::Zero()});
  const OpenedSource opened = open_base(source);
  const DropResult open = drop_source(
      target, opened.mesh, {.surface_point = Eigen::Vector3d(0, 0, 0), .source_loop = opened.loops.front()});
  EXPECT_EQ(closed.merge.mesh.positions, open.merge.mesh.positions);
  EXPECT_EQ(closed.merge.mesh.faces.corners(), open.merge.mesh.faces.corners());
}

TEST(ClosedDrop, IsRefusedWithABaseAndALoop) {
  const Mesh target = make_sample("bumpy_plane", 20), source = make_sample("head", 24);
  Drop drop{
      .surface_point = Index{210}, .source_loop = boundary_loops(source).front(), .base = {.height = 0.1}};
  try {
    drop_source(target, source, drop);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "merge.base_with_source_loop");
  }
}

}  // namespace
}  // namespace meshgraft::test
