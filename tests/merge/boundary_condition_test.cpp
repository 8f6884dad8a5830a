#include "merge/boundary_condition.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "merge/closed_curves.h"
#include "merge/loop_pairs.h"

namespace meshgraft {
namespace {

/// A source loop and the same loop as the boundary of a target, which runs the other way.
struct BoundaryCase {
  std::string name;
  LoopPair pair;
  LoopGeometry source, target;
  Correspondence correspondence;
};

BoundaryCase boundary_case(const test::ClosedCurve& curve) {
  BoundaryCase result{curve.name, {}, {}, {}, {}};
  const Index n = curve.size();
  result.source = test::loop_of_curve(curve.points);
  result.target = test::reversed_loop(result.source);
  for (Index k = 0; k < n; ++k) {
    result.pair.source.push_back(10 + k);
    result.pair.target.push_back(n - 1 - k);
    result.correspondence.loop_parameter.push_back(n - 1 - k);
  }
  return result;
}

std::vector<BoundaryCase> boundary_cases() {
  std::vector<BoundaryCase> cases;
  for (const test::ClosedCurve& curve : test::closed_curves()) cases.push_back(boundary_case(curve));
  return cases;
}

TEST(BoundaryCondition, OfASimilarLoopIsTheSimilarity) {
  for (const BoundaryCase& test : boundary_cases())
    for (const Eigen::Affine3d& map : test::similarities()) {
      SCOPED_TRACE(test.name);
      const LoopGeometry target = test::mapped_loop(test.target, map);
      const auto constraints = boundary_constraints(test.pair, test.source, target, test.correspondence, {});
      ASSERT_EQ(constraints.size(), test.pair.source.size());
      for (std::size_t k = 0; k < constraints.size(); ++k) {
        const Eigen::Vector3d p = test.source.points.row(static_cast<Eigen::Index>(k));
        EXPECT_EQ(constraints[k].vertex, test.pair.source[k]);
        EXPECT_LT((*constraints[k].position - map * p).norm(), 1e-10 * (1 + map.linear().norm()));
        EXPECT_LT((*constraints[k].transform - map.linear()).norm(), 1e-9 * map.linear().norm());
      }
    }
}

TEST(BoundaryCondition, WithAKeptPoseDoesNotTurn) {
  for (const BoundaryCase& test : boundary_cases()) {
    const LoopGeometry target = test::mapped_loop(test.target, test::similarities()[1]);
    BoundaryOptions options{.pose = MergePose::keep};
    for (const VertexConstraint& held :
         boundary_constraints(test.pair, test.source, target, test.correspondence, options)) {
      const double scale = (*held.transform)(0, 0);
      EXPECT_LT((*held.transform - scale * Eigen::Matrix3d::Identity()).norm(), 1e-15) << test.name;
      EXPECT_NEAR(scale, 0.01, 1e-9);
    }
    options.scale = 3;
    for (const VertexConstraint& held :
         boundary_constraints(test.pair, test.source, target, test.correspondence, options))
      EXPECT_EQ(*held.transform, Eigen::Matrix3d(3 * Eigen::Matrix3d::Identity()));
  }
}

TEST(BoundaryCondition, TransformsAreScaledRotations) {
  const auto cases = boundary_cases();
  for (std::size_t k = 0; k + 3 < cases.size(); ++k) {  // loops of different shape, but of as many points
    const BoundaryCase &from = cases[k], &to = cases[k + 3];
    for (const VertexConstraint& held : boundary_constraints(
             from.pair, from.source, to.target, from.correspondence, {.scale = 1.5, .normal_angle_deg = 20})) {
      const Eigen::Matrix3d rotation = *held.transform / 1.5;
      EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12) << from.name;
      EXPECT_GT(rotation.determinant(), 0);
    }
  }
}

TEST(BoundaryCondition, TurnsNormalsAboutTheTangents) {
  for (const BoundaryCase& test : boundary_cases()) {
    const auto plain = boundary_constraints(test.pair, test.source, test.target, test.correspondence, {});
    for (const double angle : {-40.0, 25.0}) {
      const auto turned = boundary_constraints(test.pair, test.source, test.target, test.correspondence,
                                               {.normal_angle_deg = angle});
      for (std::size_t k = 0; k < plain.size(); ++k) {
        const Eigen::AngleAxisd turn(Eigen::Matrix3d(*turned[k].transform * plain[k].transform->inverse()));
        const auto n = static_cast<Eigen::Index>(plain.size()), i = static_cast<Eigen::Index>(k);
        const Eigen::Vector3d tangent =
            (test.source.points.row((i + 1) % n) - test.source.points.row((i + n - 1) % n)).normalized();
        EXPECT_NEAR(std::abs(turn.axis().dot(tangent)), 1, 1e-6) << test.name;
        EXPECT_EQ(turned[k].position, plain[k].position);
      }
    }
  }
}

Eigen::Affine3d affine(const Similarity& similarity) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = similarity.scale * similarity.rotation;
  map.translation() = similarity.translation;
  return map;
}

Similarity pose_of_case(const BoundaryCase& test, const LoopGeometry& source, const LoopGeometry& target,
                        std::optional<double> scale = {}) {
  return pose_of_boundary(std::span(&source, 1), std::span(&target, 1), std::span(&test.correspondence, 1),
                          scale);
}

TEST(PoseOfBoundary, FindsASimilarity) {
  for (const BoundaryCase& test : boundary_cases())
    for (const Eigen::Affine3d& map : test::similarities()) {
      const Similarity pose = pose_of_case(test, test.source, test::mapped_loop(test.target, map));
      EXPECT_LT((affine(pose).matrix() - map.matrix()).norm(), 1e-9 * map.matrix().norm()) << test.name;
    }
}

TEST(PoseOfBoundary, FollowsSimilaritiesOfEitherSide) {
  const auto cases = boundary_cases();
  for (std::size_t k = 0; k + 3 < cases.size(); ++k)
    for (const Eigen::Affine3d& map : test::similarities()) {
      const BoundaryCase &from = cases[k], &to = cases[k + 3];
      const Eigen::Affine3d pose = affine(pose_of_case(from, from.source, to.target));
      const Eigen::Affine3d after = affine(pose_of_case(from, from.source, test::mapped_loop(to.target, map)));
      const Eigen::Affine3d before = affine(pose_of_case(from, test::mapped_loop(from.source, map), to.target));
      EXPECT_LT((after.matrix() - (map * pose).matrix()).norm(), 1e-9 * after.matrix().norm()) << from.name;
      EXPECT_LT((before.matrix() - (pose * map.inverse()).matrix()).norm(), 1e-9 * before.matrix().norm())
          << from.name;
    }
}

TEST(PoseOfBoundary, KeepsAPrescribedScaleAndTheCentre) {
  for (const BoundaryCase& test : boundary_cases()) {
    const LoopGeometry target = test::mapped_loop(test.target, test::similarities()[2]);
    const Similarity free = pose_of_case(test, test.source, target),
                     fixed = pose_of_case(test, test.source, target, 7.0);
    EXPECT_EQ(fixed.scale, 7.0);
    EXPECT_LT((fixed.rotation - free.rotation).norm(), 1e-12) << test.name;
  }
}

}  // namespace
}  // namespace meshgraft
