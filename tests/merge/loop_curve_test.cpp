#include "merge/loop_curve.h"

#include <cmath>

#include <gtest/gtest.h>

#include "merge/closed_curves.h"

namespace meshgraft {
namespace {

using test::closed_curves;
using test::ClosedCurve;

TEST(LoopCurve, ParametersAtItsVerticesAreTheVertices) {
  for (const ClosedCurve& curve : closed_curves()) {
    SCOPED_TRACE(curve.name);
    const LoopCurve loop(curve.points);
    ASSERT_EQ(loop.size(), curve.size());
    for (Index k = 0; k < loop.size(); ++k) {
      EXPECT_NEAR(loop.parameter_at(loop.arc(k)), k, 1e-12);
      EXPECT_EQ(at(curve.points, k), curve.points.row(k));
      EXPECT_EQ(at(curve.points, k + loop.size()), curve.points.row(k));
      // Arcs are cyclic.
      const double inside = loop.arc(k) + 0.3 * loop.length_between(k, (k + 1) % loop.size());
      EXPECT_NEAR(loop.parameter_at(inside + 3 * loop.length()), loop.parameter_at(inside), 1e-9);
      EXPECT_NEAR(loop.parameter_at(inside - 2 * loop.length()), k + 0.3, 1e-9);
    }
  }
}

TEST(LoopCurve, ParametersGoAlongByArcLength) {
  for (const ClosedCurve& curve : closed_curves()) {
    SCOPED_TRACE(curve.name);
    const LoopCurve loop(curve.points);
    constexpr int steps = 500;
    double before = -1, along = 0;
    Eigen::RowVector3d last = curve.points.row(0);
    for (int step = 0; step < steps; ++step) {
      const double parameter = loop.parameter_at(loop.length() * step / steps);
      EXPECT_GT(parameter, before);
      before = parameter;
      const Eigen::RowVector3d point = at(curve.points, parameter);
      EXPECT_LE((point - last).norm(), loop.length() / steps * (1 + 1e-9));  // shorter only across a corner
      along += (point - last).norm();
      last = point;
    }
    EXPECT_NEAR(along, loop.length(), 0.03 * loop.length());
  }
}

TEST(LoopCurve, LengthsThereAndBackAreTheWholeLength) {
  for (const ClosedCurve& curve : closed_curves()) {
    const LoopCurve loop(curve.points);
    for (Index a = 0; a < loop.size(); ++a)
      for (Index b = 0; b < loop.size(); ++b) {
        const double sum = loop.length_between(a, b) + loop.length_between(b, a);
        EXPECT_NEAR(sum, (a == b ? 2 : 1) * loop.length(), 1e-12) << curve.name;
      }
  }
}

TEST(LoopCurve, AxisIsThatOfTheAreaAndTurnsWithTheLoop) {
  for (const ClosedCurve& curve : closed_curves()) {
    SCOPED_TRACE(curve.name);
    const Eigen::RowVector3d axis = loop_axis(curve.points);
    EXPECT_NEAR(axis.norm(), 1, 1e-12);
    EXPECT_GT(axis.z(), 0.5);  // counter-clockwise about z
    if (curve.points.col(2).maxCoeff() == curve.points.col(2).minCoeff()) {
      EXPECT_LT((axis - Eigen::RowVector3d::UnitZ()).norm(), 1e-12);
    }
    EXPECT_LT((loop_axis(curve.points.colwise().reverse()) + axis).norm(), 1e-12);
    EXPECT_LT((loop_axis(test::rotated_rows(curve.points, 3)) - axis).norm(), 1e-12);
    for (const Eigen::Affine3d& map : test::similarities()) {
      const Eigen::RowVector3d turned = (map.linear() * axis.transpose()).transpose().normalized();
      EXPECT_LT((loop_axis(test::mapped(curve.points, map)) - turned).norm(), 1e-9);
    }
  }
}

TEST(FitSimilarity, FindsAnySimilarityOfPointsThatSpanAPlane) {
  for (const ClosedCurve& curve : closed_curves())
    for (const Eigen::Affine3d& map : test::similarities()) {
      const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(curve.size(), 0.1, 3);
      Similarity best;
      ASSERT_TRUE(fit_similarity(curve.points, test::mapped(curve.points, map), weights, best)) << curve.name;
      EXPECT_LT((best.scale * best.rotation - map.linear()).norm(), 1e-10 * best.scale) << curve.name;
      EXPECT_LT((best.translation - map.translation()).norm(), 1e-10 * (1 + map.translation().norm()));
      EXPECT_NEAR(best.rotation.determinant(), 1, 1e-12);
    }
}

TEST(FitSimilarity, IsBeatenByNoOther) {
  for (const ClosedCurve& curve : closed_curves()) {
    SCOPED_TRACE(curve.name);
    Points to = test::mapped(curve.points, test::similarities()[0]);
    for (Index k = 0; k < curve.size(); ++k)
      to.row(k) += 0.2 * Eigen::RowVector3d(std::sin(3 * k), std::cos(5 * k), std::sin(k));
    const Eigen::VectorXd weights = Eigen::VectorXd::Constant(curve.size(), 2.0);
    Similarity best;
    ASSERT_TRUE(fit_similarity(curve.points, to, weights, best));
    const auto error = [&](const Similarity& s) {
      return ((s.scale * curve.points * s.rotation.transpose()).rowwise() + s.translation.transpose() - to)
          .squaredNorm();
    };
    for (int k = 0; k < 12; ++k) {
      Similarity rival = best;
      const double step = k % 2 == 0 ? 1e-3 : 0.3;
      rival.rotation = Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(k / 2 % 3)) * best.rotation;
      EXPECT_LE(error(best), error(rival) + 1e-12);
      rival = best;
      rival.translation[k / 2 % 3] += step;
      EXPECT_LE(error(best), error(rival) + 1e-12);
      rival = best;
      rival.scale *= 1 + (k < 6 ? step : -step);
      EXPECT_LE(error(best), error(rival) + 1e-12);
    }
  }
}

TEST(FitSimilarity, IsNotDeterminedByPointsOnALine) {
  Points line(6, 3);
  for (int k = 0; k < 6; ++k) line.row(k) << k, 2 * k, -k * 0.5;
  Similarity best;
  EXPECT_FALSE(fit_similarity(line, line, Eigen::VectorXd::Ones(6), best));
  EXPECT_FALSE(fit_similarity(Points::Ones(4, 3), Points::Random(4, 3), Eigen::VectorXd::Ones(4), best));
}

}  // namespace
}  // namespace meshgraft
