#include "deform/solve/rotations.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

namespace meshgraft {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

double symmetric(std::mt19937& random) { return static_cast<double>(random()) / 2147483648.0 - 1.0; }

Vector3d any_vector(std::mt19937& random) { return {symmetric(random), symmetric(random), symmetric(random)}; }

Matrix3d any_matrix(std::mt19937& random) {
  Matrix3d matrix;
  for (int c = 0; c < 3; ++c) matrix.col(c) = any_vector(random);
  return matrix;
}

/// Returns rotation vectors about many axes, from tiny angles to nearly half a turn.
std::vector<Vector3d> rotation_vectors() {
  std::mt19937 random(3);
  std::vector<Vector3d> vectors;
  for (const double angle : {1e-9, 1e-4, 0.1, 1.0, 2.0, 3.0, pi - 1e-4})
    for (int k = 0; k < 5; ++k) vectors.push_back(angle * any_vector(random).normalized());
  return vectors;
}

/// Returns symmetric positive definite matrices of condition numbers up to 1e4, at several scales.
std::vector<Matrix3d> stretches() {
  std::mt19937 random(4);
  std::vector<Matrix3d> found{Matrix3d::Identity()};
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const Vector3d& sigma :
         {Vector3d(1, 1, 1), Vector3d(2, 1, 0.5), Vector3d(1, 1, 1e-2), Vector3d(100, 1, 1e-2)}) {
      const Matrix3d axes = rotation_exp(any_vector(random));
      found.emplace_back(scale * axes * sigma.asDiagonal() * axes.transpose());
    }
  return found;
}

void expect_rotation(const Matrix3d& map) {
  EXPECT_LT((map * map.transpose() - Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_GT(map.determinant(), 0);
}

TEST(Rotations, TheRightJacobianIsTheDerivativeOfTheExponentialMap) {
  std::mt19937 random(6);
  for (const Vector3d& vector : rotation_vectors()) {
    const Vector3d change = 1e-6 * any_vector(random);
    const Matrix3d between = rotation_exp(vector - change).transpose() * rotation_exp(vector + change);
    EXPECT_LT((rotation_log(between) - 2 * right_jacobian(vector) * change).norm(), 1e-9) << vector.transpose();
  }
}

TEST(Rotations, LogarithmInvertsTheExponential) {
  EXPECT_EQ(rotation_exp(Vector3d::Zero()), Matrix3d(Matrix3d::Identity()));
  for (const Vector3d& vector : rotation_vectors()) {
    const Matrix3d rotation = rotation_exp(vector);
    expect_rotation(rotation);
    EXPECT_LT((rotation_log(rotation) - vector).norm(), 1e-9) << vector.transpose();
    EXPECT_LT((rotation * vector - vector).norm(), 1e-14);  // the axis stays
    EXPECT_LT((rotation_exp(-vector) - rotation.transpose()).norm(), 1e-14);
    EXPECT_LT((rotation_exp(2 * vector) - rotation * rotation).norm(), 1e-13);
  }
}

TEST(Rotations, NearestTurnIsTheSameRotationAndNoOtherIsNearer) {
  std::mt19937 random(5);
  for (const Vector3d& vector : rotation_vectors())
    for (int k = 0; k < 4; ++k) {
      const Vector3d other = 12 * any_vector(random);
      const Vector3d turn = nearest_turn(vector, other);
      EXPECT_LT((rotation_exp(turn) - rotation_exp(vector)).norm(), 1e-12);
      for (int whole = -4; whole <= 4; ++whole) {
        const Vector3d rival = vector + 2 * pi * whole * vector.normalized();
        EXPECT_LE((turn - other).norm(), (rival - other).norm() + 1e-9);
      }
    }
}

TEST(Rotations, NearestTurnFollowsAnAngleContinuously) {
  const Vector3d axis = Vector3d(1, -2, 3).normalized();
  Vector3d turn = Vector3d::Zero();
  for (int step = 1; step <= 400; ++step) {
    const double angle = 0.1 * step;  // up to more than six turns
    turn = nearest_turn(rotation_log(rotation_exp(angle * axis)), turn);
    EXPECT_LT((turn - angle * axis).norm(), 1e-9) << angle;
  }
}

TEST(Rotations, PolarFactorOfARotatedStretchIsTheRotation) {
  for (const Vector3d& vector : rotation_vectors())
    for (const Matrix3d& stretch : stretches()) {
      const Matrix3d rotation = rotation_exp(vector), map = rotation * stretch;
      const double condition = stretch.norm() * stretch.inverse().norm();
      EXPECT_LT((nearest_rotation(map) - rotation).norm(), 1e-13 * condition);
      PolarParts parts;
      ASSERT_TRUE(polar_decompose(map, parts));
      EXPECT_LT((parts.rotation - rotation).norm(), 1e-13 * condition);
      EXPECT_LT((parts.stretch - stretch).norm(), 1e-13 * stretch.norm());
    }
}

TEST(Rotations, NearestRotationIsBeatenByNoOther) {
  std::mt19937 random(6);
  for (int k = 0; k < 60; ++k) {
    Matrix3d map = any_matrix(random);
    if (k % 3 == 1) map.col(2) = map.col(0) + map.col(1);          // flat
    if (k % 3 == 2) map.col(0) *= map.determinant() > 0 ? -1 : 1;  // reflects
    const Matrix3d nearest = nearest_rotation(map);
    expect_rotation(nearest);
    for (int rival = 0; rival < 20; ++rival) {
      const Matrix3d other = rotation_exp((rival % 2 == 0 ? 0.05 : pi) * any_vector(random)) * nearest;
      EXPECT_LE((map - nearest).norm(), (map - other).norm() + 1e-12);
    }
  }
}

TEST(Rotations, NearestRotationTurnsWithTheMap) {
  std::mt19937 random(7);
  for (int k = 0; k < 40; ++k) {
    const Matrix3d map = Matrix3d::Identity() + 0.5 * any_matrix(random);
    const Matrix3d before = rotation_exp(any_vector(random)), after = rotation_exp(3 * any_vector(random));
    const Matrix3d turned = after * map * before;
    EXPECT_LT((nearest_rotation(turned) - after * nearest_rotation(map) * before).norm(), 1e-10);
    EXPECT_LT((nearest_rotation(1e5 * map) - nearest_rotation(map)).norm(), 1e-12);
  }
}

TEST(Rotations, ReflectionsAndFlatMapsHaveNoPolarParts) {
  PolarParts parts;
  for (const Matrix3d& stretch : stretches()) {
    EXPECT_FALSE(polar_decompose(-stretch, parts));
    Matrix3d flat = stretch;
    flat.col(2) = flat.col(0);
    EXPECT_FALSE(polar_decompose(flat, parts));
  }
  EXPECT_FALSE(polar_decompose(Matrix3d::Zero(), parts));
}

TEST(Rotations, StretchesAndTheirLogarithmsInvertEachOther) {
  for (const Matrix3d& stretch : stretches()) {
    const Eigen::Matrix<double, 6, 1> log = stretch_log(stretch);
    EXPECT_LT((stretch_exp(log) - stretch).norm(), 1e-12 * stretch.norm());
    EXPECT_LT((stretch_exp(-log) * stretch - Matrix3d::Identity()).norm(), 1e-9);
    EXPECT_LT((stretch_exp(2 * log) - stretch * stretch).norm(), 1e-11 * stretch.squaredNorm());
    EXPECT_NEAR(log.head<3>().sum(), std::log(stretch.determinant()), 1e-9);  // trace log = log det
  }
  EXPECT_EQ(stretch_exp(Eigen::Matrix<double, 6, 1>::Zero()), Matrix3d(Matrix3d::Identity()));
}

}  // namespace
}  // namespace meshgraft
