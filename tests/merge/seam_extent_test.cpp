// A seam leaves vertices and sharp edges beyond its rings in place.

#include <gtest/gtest.h>

#include "merge/seam.h"
#include "merge/seam_grafts.h"

namespace meshgraft::test {
namespace {

TEST(Seam, LeavesTheTargetAloneWhereAsked) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamResult still = make_seam(graft.target, graft.source, graft.pairs, {.target_rings = 0});
    for (Index v = 0; v < graft.target.vertex_count(); ++v) {
      const Index now = still.target.new_index[v];
      if (now >= 0) {
        EXPECT_EQ(still.mesh.positions.row(now), graft.target.positions.row(v));
      }
    }
    EXPECT_EQ(still.report.band_displacement_rel, 0);
    const SeamResult stiff =
        make_seam(graft.target, graft.source, graft.pairs, {.target_rings = 0, .source_rings = 0});
    EXPECT_TRUE(stiff.band.empty());
    const SeamResult unsmoothed = make_seam(graft.target, graft.source, graft.pairs, {.fairings = 0});
    EXPECT_TRUE(same_positions(stiff.mesh.positions, unsmoothed.mesh.positions));
  }
}

TEST(Seam, KeepsSharpEdgesOfTheTarget) {
  for (const Graft& graft : grafts()) {
    if (graft.name != "bar") continue;
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    const Eigen::RowVector3d low = graft.target.positions.colwise().minCoeff();
    const Eigen::RowVector3d high = graft.target.positions.colwise().maxCoeff();
    int edges = 0;
    for (Index v = 0; v < graft.target.vertex_count(); ++v) {
      const Eigen::RowVector3d p = graft.target.positions.row(v);
      const int extreme =
          static_cast<int>((p.array() == low.array()).count() + (p.array() == high.array()).count());
      if (extreme < 2 || result.target.new_index[v] < 0) continue;
      EXPECT_EQ(result.mesh.positions.row(result.target.new_index[v]), p);
      ++edges;
    }
    EXPECT_GT(edges, 20);
  }
}

TEST(Seam, KeepsOtherLoopsInPlace) {
  const Graft graft = tubes(24, 24, true);
  const SeamResult result =
      make_seam(graft.target, graft.source, graft.pairs, {.target_rings = 20, .source_rings = 20});
  for (Index v = 0; v < 24; ++v) {
    EXPECT_EQ(result.mesh.positions.row(result.target.new_index[v]), graft.target.positions.row(v));
    const Index end = graft.source.vertex_count() - 24 + v;
    EXPECT_EQ(result.mesh.positions.row(result.source.new_index[end]), graft.source.positions.row(end));
  }
}

}  // namespace
}  // namespace meshgraft::test
