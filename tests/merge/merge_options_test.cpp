// A merge follows its options for size, pose, features, fixed vertices and normals.
#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "merge/grafts.h"

namespace meshgraft::test {
namespace {

TEST(Merge, LocksTheScale) {
  const Graft graft = head_on_bust();
  for (const double size : {0.7, 1.3}) {
    const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, {.size = size});
    EXPECT_NEAR(result.report.shape.similarity.scale, size, 1e-9);
  }
}

TEST(Merge, KeepsThePoseBitForBitBeyondReach) {
  const Graft graft = head_on_bust();
  MergeOptions options{.pose = MergePose::keep, .reach = {.rings = 4, .length = {}}};
  Mesh source = graft.source;
  source.positions.col(2).array() += 0.05;
  const MergeResult result = merge_meshes(graft.target, source, graft.pairs, options);
  const std::vector<Index> near =
      grow_rings(graft.pairs[0].loops.source, 4, vertex_rings(source.vertex_count(), source.faces));
  Index moved = 0;
  for (Index v = 0; v < source.vertex_count(); ++v) {
    if (std::binary_search(near.begin(), near.end(), v)) {
      moved += source.positions.row(v) != result.grafted.row(v);
    } else {
      EXPECT_EQ(source.positions.row(v), result.grafted.row(v)) << v;
    }
  }
  EXPECT_GT(moved, 0);
}

TEST(Merge, FeaturesFollowOneMap) {
  const Graft graft = head_on_bust();
  for (const MergeShape shape : {MergeShape::ft05, MergeShape::similar}) {
    for (const bool similarity : {true, false}) {
      MergeFeature feature{{}, similarity};
      for (Index v = 0; v < graft.source.vertex_count(); ++v)
        if (graft.source.positions(v, 2) > 0 && graft.source.positions(v, 1) < -0.2)
          feature.vertices.push_back(v);
      ASSERT_GT(feature.vertices.size(), 20U);
      MergeOptions options{.shape = shape};
      options.features = {feature};
      const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, options);
      const auto count = static_cast<Eigen::Index>(feature.vertices.size());
      Eigen::MatrixXd before(count, 4), after(count, 3);
      for (Eigen::Index k = 0; k < count; ++k) {
        const Index v = feature.vertices[static_cast<std::size_t>(k)];
        before.row(k) << graft.source.positions.row(v), 1;
        after.row(k) = result.grafted.row(v);
      }
      const Eigen::MatrixXd map = before.colPivHouseholderQr().solve(after);
      EXPECT_LT((before * map - after).norm(), 1e-9 * after.norm());
      const Eigen::Matrix3d linear = map.topRows<3>().transpose();
      const double scale = std::cbrt(linear.determinant());
      const double shear = (linear.transpose() * linear / (scale * scale) - Eigen::Matrix3d::Identity()).norm();
      if (similarity) {
        EXPECT_LT(shear, 1e-9);
      } else if (shape == MergeShape::ft05) {
        EXPECT_GT(shear, 1e-6);
      }
    }
  }
}

TEST(Merge, AFeatureThatReachesIntoTheKeptPartStays) {
  Graft graft = head_on_bust(24);
  MergeOptions options{.pose = MergePose::keep};
  const IndexLists rings = vertex_rings(graft.source.vertex_count(), graft.source.faces);
  const std::vector<Index> near = grow_rings(graft.pairs[0].loops.source, 3, rings);
  for (Index v = 0; v < graft.source.vertex_count(); ++v)
    if (!std::binary_search(near.begin(), near.end(), v)) options.fixed.push_back(v);
  const std::vector<Index> wide = grow_rings(graft.pairs[0].loops.source, 5, rings),
                           loop = grow_rings(graft.pairs[0].loops.source, 1, rings);
  MergeFeature feature;
  std::set_difference(wide.begin(), wide.end(), loop.begin(), loop.end(), std::back_inserter(feature.vertices));
  options.features = {feature};
  const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, options);
  for (const Index v : feature.vertices)
    ASSERT_LT((result.grafted.row(v) - graft.source.positions.row(v)).norm(), 1e-12);
}

TEST(Merge, TurnsTheTargetsNormals) {
  const Graft graft = head_on_bust();
  MergeOptions options{.shape = MergeShape::ft05};
  const Points straight = merge_meshes(graft.target, graft.source, graft.pairs, options).grafted;
  options.normal_angle_deg = 20;
  const Points wider = merge_meshes(graft.target, graft.source, graft.pairs, options).grafted;
  options.normal_angle_deg = -20;
  const Points narrower = merge_meshes(graft.target, graft.source, graft.pairs, options).grafted;
  // A positive angle must change the neck's width one way, a negative angle the other way.
  const auto width = [](const Points& points) {
    return (points.col(0).maxCoeff() - points.col(0).minCoeff()) +
           (points.col(1).maxCoeff() - points.col(1).minCoeff());
  };
  EXPECT_GT(std::abs(width(wider) - width(straight)), 0.02 * width(straight));
  EXPECT_LT((width(wider) - width(straight)) * (width(narrower) - width(straight)), 0);
}

TEST(Merge, KeepsAPartThatIsFixedAsAWhole) {
  const Mesh target = holed(1, 0, true), source = peg(6, 16);
  const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
  MergeOptions options{.pose = MergePose::keep};
  const std::vector<Index> loop = first_loop(source);
  for (Index v = 0; v < source.vertex_count(); ++v)
    if (std::find(loop.begin(), loop.end(), v) == loop.end()) options.fixed.push_back(v);
  const MergeResult result = merge_meshes(target, source, {{pair}}, options);
  for (const Index v : options.fixed) EXPECT_EQ(result.grafted.row(v), source.positions.row(v)) << v;
}

}  // namespace
}  // namespace meshgraft::test
