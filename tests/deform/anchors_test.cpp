// Weights of anchors mean the same on every surface and at every resolution.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::AngleAxisd;
using Eigen::Translation3d;
using Eigen::Vector3d;

/// A mesh whose low end is held and whose high end is a handle; a part between is anchored.
struct AnchoredEdit {
  std::string name;
  std::function<TestMesh(int)> mesh;  ///< of a resolution
  Affine3d motion = Affine3d::Identity();
  double from = 0.5, to = 0.6;  ///< the anchors' part of the longest axis
};

std::vector<AnchoredEdit> anchored_edits() {
  const auto sheet = [](int n) { return irregular_grid(12 * n, 8 * n); };
  const auto limb = [](int n) { return bar(2 * n, 14 * n); };
  const auto pipe = [](int n) { return tube(8 * n, 16 * n); };
  const Affine3d lift(Translation3d(0.1, 0.2, 0.5)), shift(Translation3d(0.6, 0, 0)),
      along(Translation3d(0, 0, 0.8));
  return {{"sheet lifted", sheet, lift}, {"sheet lifted, anchors near the handle", sheet, lift, 0.7, 0.75},
          {"bar shifted", limb, shift},  {"bar stretched", limb, along, 0.4, 0.5},
          {"tube shifted", pipe, shift}, {"tube bent", pipe, Affine3d(AngleAxisd(0.7, Vector3d::UnitY()))}};
}

/// Returns the share of the anchors' motion that a weight leaves.
double share_left(const AnchoredEdit& edit, int resolution, double weight, DeformMethod method) {
  const TestMesh mesh = edit.mesh(resolution);
  const Eigen::RowVector3d low = mesh.positions.colwise().minCoeff(),
                           high = mesh.positions.colwise().maxCoeff();
  int axis = 0;
  (high - low).maxCoeff(&axis);
  Region region{.whole = true};
  Handle end = make_handle("end", {});
  std::vector<Index> middle;
  for (Index v = 0; v < mesh.size(); ++v) {
    const double at = (mesh.positions(v, axis) - low[axis]) / (high[axis] - low[axis]);
    if (at < 0.12) region.fixed.push_back(v);
    if (at > 0.88) end.vertices.push_back(v);
    if (at >= edit.from && at <= edit.to) middle.push_back(v);
  }
  region.handles = {end};
  const auto motion = [&] {
    DeformerOptions options;
    options.method = method;
    const Deformer deformer(mesh.positions, mesh.triangles, region, options);
    const Points moved = deformer.evaluate(std::vector{pose_of(edit.motion)}) - mesh.positions;
    double sum = 0;
    for (const Index v : middle) sum += moved.row(v).norm();
    return sum;
  };
  const double loose = motion();
  for (const Index v : middle) region.anchors.push_back({.vertex = v, .weight = weight});
  return motion() / loose;
}

TEST(Anchors, OfWeightOneLeaveAboutHalfOfTheMotion) {
  for (const DeformMethod method : {DeformMethod::corotational, DeformMethod::ft05})
    for (const AnchoredEdit& edit : anchored_edits())
      for (const int resolution : {1, 2, 3}) {
        SCOPED_TRACE(edit.name + ", " + std::string(to_string(method)) + ", " + std::to_string(resolution));
        const double share = share_left(edit, resolution, 1, method);
        EXPECT_GE(share, 0.3);
        EXPECT_LE(share, 0.7);
      }
}

TEST(Anchors, LeaveLessTheMoreTheyWeigh) {
  for (const AnchoredEdit& edit : anchored_edits()) {
    SCOPED_TRACE(edit.name);
    double last = 1;
    for (const double weight : {0.1, 0.3, 1.0, 3.0, 10.0, 100.0}) {
      const double share = share_left(edit, 2, weight, DeformMethod::corotational);
      EXPECT_LT(share, last) << weight;
      last = share;
    }
    EXPECT_LT(last, 0.01);
  }
}

}  // namespace
}  // namespace meshgraft::test
