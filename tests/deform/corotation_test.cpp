#include "deform/solve/corotation.h"

#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "deform/solve/rotations.h"

namespace meshgraft {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Blended maps and the turns from them that the surface takes.
struct TurnCase {
  BlendedMap blended;
  Vector3d turn;
};

std::vector<TurnCase> turn_cases() {
  std::mt19937 random(11);
  const auto vector = [&] {
    const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1.0; };
    return Vector3d(number(), number(), number());
  };
  std::vector<TurnCase> cases;
  for (int k = 0; k < 30; ++k) {
    const Matrix3d axes = rotation_exp(2 * vector());
    const Vector3d sigma(1.5, 1.0, 0.4);
    cases.push_back(
        {{rotation_exp(2 * vector()), axes * sigma.asDiagonal() * axes.transpose()}, 1.2 * vector()});
  }
  return cases;
}

TEST(Corotation, FindsTheTurnFromTheBlendToTheSurface) {
  for (const TurnCase& test : turn_cases()) {
    const Matrix3d map = rotation_exp(test.turn) * test.blended.rotation * test.blended.stretch;
    const Vector3d turn = surface_turn(map, test.blended, Vector3d::Zero(), Vector3d::Zero());
    EXPECT_LT((turn - test.turn).norm(), 1e-10);
  }
}

TEST(Corotation, TakesTheTurnNearestToTheCurrentOne) {
  for (const TurnCase& test : turn_cases())
    for (const int whole : {-2, 1, 3}) {
      const Vector3d current = test.turn + 2 * std::numbers::pi * whole * test.turn.normalized();
      const Matrix3d map = rotation_exp(test.turn) * test.blended.rotation * test.blended.stretch;
      EXPECT_LT((surface_turn(map, test.blended, Vector3d::Zero(), current) - current).norm(), 1e-9);
    }
}

TEST(Corotation, IgnoresTheImageOfAFlatRingsNormal) {
  const Vector3d normal = Vector3d(1, 2, -2).normalized();
  for (const TurnCase& test : turn_cases()) {
    // The stretch keeps the normal's direction, so that the image of the plane tells the whole turn.
    const BlendedMap blended{
        test.blended.rotation,
        Matrix3d::Identity() + 0.5 * normal.unitOrthogonal() * normal.unitOrthogonal().transpose()};
    const Matrix3d map = rotation_exp(test.turn) * blended.rotation * blended.stretch;
    for (const Vector3d& wrong : {Vector3d(0, 0, 0), Vector3d(1, -3, 0.5), Vector3d(-map * normal)}) {
      const Matrix3d fitted = map + (wrong - map * normal) * normal.transpose();
      EXPECT_LT((surface_turn(fitted, blended, normal, Vector3d::Zero()) - test.turn).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace meshgraft
