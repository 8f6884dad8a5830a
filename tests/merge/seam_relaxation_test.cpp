#include "merge/seam_relaxation.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "merge/seam_scenes.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

/// A patch whose vertices next to the strip have been pushed along the surface, by up to `push` edges.
struct SlideScene {
  std::string name;
  SeamPatch patch;
  IndexLists triangles;
  Flags may_slide;

  SlideScene(test::SeamScene scene, double push) : name(scene.name) {
    for (Index v = 0; v < scene.mesh.vertex_count(); ++v) {
      if (!scene.is_on_strip(v)) continue;
      const double angle = push * 0.35 * std::sin(3.1 * v);
      scene.mesh.positions.row(v) *=
          Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix().transpose();
    }
    patch = make_seam_patch(scene.mesh, scene.layout, 4);
    triangles = vertex_triangles(static_cast<Index>(patch.vertex.size()), patch.triangles);
    for (std::size_t v = 0; v < patch.vertex.size(); ++v)
      may_slide.push_back(patch.ring[v] <= 2 && !patch.on_border[v]);
  }
  Points relaxed() const {
    Points points = patch.points;
    relax_seam(points, patch, triangles, may_slide, {});
    return points;
  }
};

std::vector<SlideScene> slide_scenes(double push) {
  std::vector<SlideScene> scenes;
  for (const test::SeamScene& scene : test::seam_scenes(0)) scenes.emplace_back(scene, push);
  return scenes;
}

/// Returns Σ max(0, q − r)² over the triangles, of which none may be inverted.
double shape_cost(const SlideScene& scene, const Points& points) {
  const auto index = [&](const Points& x, Eigen::Index t) {
    const Eigen::RowVector3d a = x.row(scene.patch.triangles(t, 0)), b = x.row(scene.patch.triangles(t, 1)),
                             c = x.row(scene.patch.triangles(t, 2));
    return ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm()) /
           (2 * (b - a).cross(c - a).norm());
  };
  double cost = 0;
  for (Eigen::Index t = 0; t < scene.patch.triangles.rows(); ++t) {
    double accepted = 3.5;
    if (scene.patch.side[t] != SeamSide::strip) accepted = std::max(accepted, index(scene.patch.points, t));
    cost += std::pow(std::max(0.0, index(points, t) - accepted), 2);
  }
  return cost;
}

Index inverted_in_plane(const SlideScene& scene, const Points& points) {
  Index count = 0;
  for (const auto& t : scene.patch.triangles.rowwise()) {
    const Eigen::RowVector3d u = points.row(t[1]) - points.row(t[0]), v = points.row(t[2]) - points.row(t[0]);
    count += u.cross(v).z() <= 0;
  }
  return count;
}

TEST(SeamRelaxation, ImprovesTheShapeOfTriangles) {
  int improved = 0;
  for (const double push : {0.3, 0.6})
    for (const SlideScene& scene : slide_scenes(push)) {
      const double before = shape_cost(scene, scene.patch.points), after = shape_cost(scene, scene.relaxed());
      EXPECT_LE(after, before * (1 + 1e-9)) << scene.name;
      improved += after < 0.5 * before;
    }
  EXPECT_GT(improved, 2);
}

TEST(SeamRelaxation, StaysInThePlaneAndTurnsInvertedTrianglesOver) {
  for (const double push : {0.3, 0.5, 0.8})
    for (const SlideScene& scene : slide_scenes(push)) {
      if (scene.name != "flat ring") continue;
      const Points points = scene.relaxed();
      EXPECT_TRUE((points.col(2).array() == scene.patch.points.col(2).array()).all());
      EXPECT_LE(inverted_in_plane(scene, points), inverted_in_plane(scene, scene.patch.points));
      EXPECT_EQ(inverted_in_plane(scene, points), 0) << push;
      if (push > 0.7) {
        EXPECT_GT(inverted_in_plane(scene, scene.patch.points), 0);
      }
    }
}

TEST(SeamRelaxation, MovesAlongTheSurface) {
  for (const SlideScene& scene : slide_scenes(0.9)) {
    if (scene.name != "tube") continue;
    const Points points = scene.relaxed();
    double moved = 0;
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
      const Eigen::RowVector3d p = scene.patch.points.row(v), step = points.row(v) - p;
      const Eigen::RowVector3d outward = Eigen::RowVector3d(p.x(), p.y(), 0).normalized();
      EXPECT_LE(std::abs(step.dot(outward)), 0.3 * step.norm());  // the normals are those of a polyhedron
      moved = std::max(moved, step.norm());
    }
    EXPECT_GT(moved, 0.01);
  }
}

TEST(SeamRelaxation, MovesOnlyWhatMaySlide) {
  for (const SlideScene& scene : slide_scenes(0.6)) {
    const Points points = scene.relaxed();
    for (Index v = 0; v < static_cast<Index>(points.rows()); ++v)
      if (!scene.may_slide[v]) {
        EXPECT_EQ(points.row(v), scene.patch.points.row(v)) << scene.name;
      }
  }
}

TEST(SeamRelaxation, LeavesWellShapedTrianglesAlone) {
  for (const SlideScene& scene : slide_scenes(0)) {
    EXPECT_EQ(shape_cost(scene, scene.patch.points), 0) << scene.name;
    EXPECT_TRUE(test::same_bytes(scene.relaxed(), scene.patch.points)) << scene.name;
  }
}

}  // namespace
}  // namespace meshgraft
