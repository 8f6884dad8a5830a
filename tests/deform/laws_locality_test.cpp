// An edit depends on what lies within its reach, and changes its region alone.
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "linear_edits.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

/// A long sheet whose middle is edited.
struct LocalEdit {
  TestMesh mesh = irregular_grid(60, 8);
  Region region;
  std::vector<Index> far;  ///< vertices at both ends, beyond the edit's reach

  LocalEdit() {
    Handle handle = make_handle("middle", {});
    for (Index v = 0; v < mesh.size(); ++v) {
      const Index column = v % 61;
      if (column >= 20 && column <= 40) region.vertices.push_back(v);
      if (column == 30 || column == 31) handle.vertices.push_back(v);
      if (column < 13 || column > 47) far.push_back(v);
    }
    region.handles = {handle};
  }
  Points result(const OperatorOptions& options) const {
    return Deformer(mesh.positions, mesh.triangles, region, linear_method(options))
        .evaluate(std::vector{
            pose_of(Affine3d(Eigen::Translation3d(0, 0, 0.1) * Eigen::AngleAxisd(0.3, Vector3d::UnitY())))});
  }
};

TEST(Laws, VerticesBeyondReachDoNotMatter) {
  for (const OperatorOptions& options : operator_variants()) {
    SCOPED_TRACE(describe(options));
    const LocalEdit edit;
    const Points expected = edit.result(options);
    for (const double value : {12.5, std::numeric_limits<double>::quiet_NaN()}) {
      LocalEdit other;
      for (Index v : other.far) other.mesh.positions(v, 1) += value;
      const Points result = other.result(options);
      std::vector<bool> is_far(static_cast<std::size_t>(edit.mesh.size()), false);
      for (Index v : edit.far) is_far[static_cast<std::size_t>(v)] = true;
      for (Index v = 0; v < edit.mesh.size(); ++v) {
        if (is_far[static_cast<std::size_t>(v)]) {
          EXPECT_EQ(result(v, 0), other.mesh.positions(v, 0));
        } else {
          EXPECT_EQ(result.row(v), expected.row(v)) << "vertex " << v;
        }
      }
    }
  }
}

TEST(Laws, VerticesOutsideTheRegionKeepTheirBits) {
  const LocalEdit edit;
  const Points result = edit.result({});
  std::vector<bool> inside(static_cast<std::size_t>(edit.mesh.size()), false);
  for (Index v : edit.region.vertices) inside[static_cast<std::size_t>(v)] = true;
  Index moved = 0;
  for (Index v = 0; v < edit.mesh.size(); ++v) {
    if (inside[static_cast<std::size_t>(v)]) {
      moved += result.row(v) != edit.mesh.positions.row(v) ? 1 : 0;
    } else {
      EXPECT_EQ(result.row(v), edit.mesh.positions.row(v));
    }
  }
  EXPECT_EQ(moved, static_cast<Index>(edit.region.vertices.size()));
}

TEST(Laws, OtherComponentsDoNotMatter) {
  const Scene scene = make_scene(irregular_grid(18, 12));
  const Index n = scene.mesh.size();
  // Adds a second component that is larger, coarser and far to the side.
  TestMesh other =
      transformed(irregular_grid(9, 6), Affine3d(Eigen::Translation3d(40, 0, 0) * Eigen::Scaling(3.0)), "");
  TestMesh both = scene.mesh;
  both.positions.conservativeResize(n + other.size(), Eigen::NoChange);
  both.positions.bottomRows(other.size()) = other.positions;
  const auto faces = both.triangles.rows();
  both.triangles.conservativeResize(faces + other.triangles.rows(), Eigen::NoChange);
  both.triangles.bottomRows(other.triangles.rows()) = other.triangles.array() + n;
  for (OperatorOptions options : operator_variants()) {
    for (const int order : {1, 2, 3}) {
      options.laplacian_order = order;
      Region alone;
      alone.fixed = scene.foot;
      for (Index v = 0; v < n; ++v) alone.vertices.push_back(v);
      alone.handles.push_back(make_handle("head", scene.head));
      Region with_other = alone;
      with_other.fixed.push_back(n);  // a corner of the other component, which is otherwise free
      for (Index v = n; v < both.size(); ++v) with_other.vertices.push_back(v);
      const std::vector<HandlePose> pose{pose_of(head_move(scene))};
      const DeformerOptions all = linear_method(options);
      const Points a = Deformer(both.positions, both.triangles, alone, all).evaluate(pose);
      const Points b = Deformer(both.positions, both.triangles, with_other, all).evaluate(pose);
      EXPECT_LT(largest_distance(a, b), 1e-9 * scene.mesh.box_diagonal())
          << describe(options) << ", order " << order;
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
