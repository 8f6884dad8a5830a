#include "render/viewpoint.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/shapes.h"

namespace meshgraft::render {
namespace {

// Returns a sphere, nearly closed at its poles.
Mesh sphere() {
  return shapes::sheet({.columns = 64, .rows = 48, .close_columns = true}, [](double u, double v) {
    const double around = 2 * std::numbers::pi * u, up = 3.1 * (v - 0.5);
    return Eigen::Vector3d(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
  });
}

// Returns the sphere with a bump of this radius (radians) where the direction points.
Mesh with_bump(Mesh sphere, const Eigen::Vector3d& direction, double radius) {
  for (Eigen::Index v = 0; v < sphere.positions.rows(); ++v) {
    const double cosine = sphere.positions.row(v).normalized().dot(direction.normalized().transpose());
    if (cosine > std::cos(radius)) sphere.positions.row(v) *= 1.2;
  }
  return sphere;
}

TEST(Viewpoint, FramesASmallChangeWithItsSurroundings) {
  const Mesh before = sphere(), after = with_bump(before, {1, 0, 0}, 0.2);
  const std::vector<const Mesh*> meshes{&before, &after};
  const Eigen::AlignedBox3d all = box_of(meshes), shown = box_of_change(meshes);
  EXPECT_TRUE(all.contains(shown));
  EXPECT_LT(shown.diagonal().norm(), 0.5 * all.diagonal().norm());
  for (Eigen::Index v = 0; v < before.positions.rows(); ++v)
    if (before.positions.row(v) != after.positions.row(v)) {
      EXPECT_TRUE(shown.contains(before.positions.row(v).transpose()));
      EXPECT_TRUE(shown.contains(after.positions.row(v).transpose()));
    }
}

TEST(Viewpoint, FramesAllWhereNothingOrMuchChanged) {
  const Mesh before = sphere(), after = with_bump(before, {1, 0, 0}, 2.0);
  for (const Mesh* other : {&before, &after}) {
    const std::vector<const Mesh*> meshes{&before, other};
    EXPECT_TRUE(box_of_change(meshes).isApprox(box_of(meshes)));
  }
}

TEST(Viewpoint, SharedFacesAreNoChangeWhateverTheirOrder) {
  const Mesh before = sphere();
  Mesh after = before;
  Faces reversed;
  for (Index f = after.face_count(); f-- > 0;) reversed.push_back(after.faces[f]);
  after.faces = reversed;
  EXPECT_EQ(direction_to_change(before, after, Eigen::Vector3d::UnitZ()),
            usual_direction(Eigen::Vector3d::UnitZ()));
  const std::vector<const Mesh*> meshes{&before, &after};
  EXPECT_TRUE(box_of_change(meshes).isApprox(box_of(meshes)));
}

TEST(Viewpoint, TurnsToAChangeBehind) {
  const Mesh before = sphere();
  for (const Eigen::Vector3d& up : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 1, 0)}) {
    const Eigen::Vector3d usual = usual_direction(up);
    EXPECT_NEAR(usual.dot(up), 0.35 / std::sqrt(0.25 + 1 + 0.35 * 0.35), 1e-12);
    EXPECT_EQ(direction_to_change(before, with_bump(before, usual, 0.3), up), usual);
    const Eigen::Vector3d behind = usual.cross(up);
    const Eigen::Vector3d chosen = direction_to_change(before, with_bump(before, behind, 0.3), up);
    EXPECT_GT(chosen.dot(behind.normalized()), 0.7);
    EXPECT_NEAR(chosen.norm(), 1, 1e-12);
  }
}

TEST(Viewpoint, LooksFromBelowAtAChangeBelow) {
  const Mesh before = sphere();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  EXPECT_LT(direction_to_change(before, with_bump(before, -up, 0.3), up).dot(up), -0.3);
}

TEST(Viewpoint, LooksPastWhatHidesTheChange) {
  // A plate before the eye hides the bump from the usual direction.
  Mesh before = sphere();
  const Eigen::Vector3d up(0, 0, 1), usual = usual_direction(up), side = up.cross(usual).normalized();
  const Index first = before.vertex_count();
  before.positions.conservativeResize(first + 4, 3);
  for (int corner = 0; corner < 4; ++corner)
    before.positions.row(first + corner) =
        (3 * usual + (corner % 3 == 0 ? -1 : 1) * side + (corner < 2 ? -1 : 1) * usual.cross(side)).transpose();
  before.faces.push_back(std::vector<Index>{first, first + 1, first + 2, first + 3});
  Mesh after = before;
  const Eigen::Index sphere = first;
  for (Eigen::Index v = 0; v < sphere; ++v)
    if (after.positions.row(v).normalized().dot(usual.transpose()) > 0.95) after.positions.row(v) *= 1.2;
  EXPECT_LT(direction_to_change(before, after, up).dot(usual), 0.95);
}

}  // namespace
}  // namespace meshgraft::render
