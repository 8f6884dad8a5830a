#include "merge/outline.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "merge/closed_curves.h"

namespace meshgraft {
namespace {

using std::numbers::pi;

struct PlaneCase {
  std::string name;
  PlanePoints points;
};

/// Returns the closed curves projected to the plane: simple, around the origin, counter-clockwise.
std::vector<PlaneCase> plane_cases() {
  std::vector<PlaneCase> cases;
  for (const test::ClosedCurve& curve : test::closed_curves())
    cases.push_back({curve.name, curve.points.leftCols<2>()});
  return cases;
}

PlanePoints regular_polygon(int corners, double radius, int step = 1) {
  PlanePoints points(corners, 2);
  for (int k = 0; k < corners; ++k)
    points.row(k) << radius * std::cos(2 * pi * k * step / corners),
        radius * std::sin(2 * pi * k * step / corners);
  return points;
}

PlanePoints turned_by(const PlanePoints& points, double angle) {
  return points * Eigen::Rotation2Dd(angle).toRotationMatrix().transpose();
}

std::vector<Eigen::RowVector2d> probes() {
  std::vector<Eigen::RowVector2d> points;
  for (double x = -2.03; x < 2.1; x += 0.37)
    for (double y = -2.11; y < 2.1; y += 0.41) points.emplace_back(x, y);
  return points;
}

TEST(PlanePolygons, AreSimpleUnlessTheyCrossThemselves) {
  for (const PlaneCase& test : plane_cases()) {
    EXPECT_TRUE(is_simple(test.points)) << test.name;
    EXPECT_TRUE(is_simple(test.points.colwise().reverse())) << test.name;
    if (test.name.find("star") != std::string::npos) continue;  // not convex: a swap need not cross
    PlanePoints crossed = test.points;
    crossed.row(1).swap(crossed.row(3));
    EXPECT_FALSE(is_simple(crossed)) << test.name;
    EXPECT_FALSE(is_simple(turned_by(1e-5 * crossed, 1))) << test.name;
  }
  for (const int corners : {5, 7, 9, 11}) {
    EXPECT_TRUE(is_simple(regular_polygon(corners, 2)));
    EXPECT_FALSE(is_simple(regular_polygon(corners, 2, 2)));  // a pentagram
  }
}

TEST(PlanePolygons, HaveAnAreaWithASign) {
  for (const int corners : {3, 4, 17})
    EXPECT_NEAR(double_area(regular_polygon(corners, 2)), 4 * corners * std::sin(2 * pi / corners), 1e-12);
  for (const PlaneCase& test : plane_cases()) {
    const double area = double_area(test.points);
    EXPECT_GT(area, 0) << test.name;
    EXPECT_NEAR(double_area(test.points.colwise().reverse()), -area, 1e-12);
    EXPECT_NEAR(double_area(turned_by(test.points, 0.7)), area, 1e-12);
    EXPECT_NEAR(double_area(test.points.rowwise() + Eigen::RowVector2d(5, -3)), area, 1e-10);
    EXPECT_NEAR(double_area(3 * test.points), 9 * area, 1e-10);
    EXPECT_NEAR(Outline(test.points).width(), std::sqrt(area / 2), 1e-12);
  }
}

TEST(Outline, DistanceOfARegularPolygonsMiddleIsItsApothem) {
  for (const int corners : {3, 4, 6, 25}) {
    const Outline outline(regular_polygon(corners, 2));
    EXPECT_NEAR(outline.signed_distance({0, 0}), -2 * std::cos(pi / corners), 1e-12);
    EXPECT_NEAR(outline.signed_distance({5, 0}), 3, 1e-12);
    EXPECT_NEAR(outline.length(), 4 * corners * std::sin(pi / corners), 1e-12);
    EXPECT_NEAR(outline.reach(), 2, 1e-12);
  }
}

TEST(Outline, DistanceIsNegativeWhereTheOutlineWindsRound) {
  for (const PlaneCase& test : plane_cases()) {
    const Outline outline(test.points);
    for (const Eigen::RowVector2d& p : probes()) {
      double angle = 0;  // by which the outline turns round the point
      for (Eigen::Index i = 0; i < test.points.rows(); ++i) {
        const Eigen::RowVector2d a = test.points.row(i) - p,
                                 b = test.points.row((i + 1) % test.points.rows()) - p;
        angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      }
      EXPECT_EQ(outline.signed_distance(p) < 0, angle > pi) << test.name << " at " << p;
    }
  }
}

TEST(Outline, DistanceIsThatOfTheNearestPoint) {
  for (const PlaneCase& test : plane_cases()) {
    const Outline outline(test.points);
    for (const Eigen::RowVector2d& p : probes()) {
      const double distance = std::abs(outline.signed_distance(p));
      double sampled = std::numeric_limits<double>::infinity();
      constexpr int samples = 20;
      for (Eigen::Index i = 0; i < test.points.rows(); ++i)
        for (int s = 0; s < samples; ++s) {
          const double t = static_cast<double>(s) / samples;
          const Eigen::RowVector2d q =
              (1 - t) * test.points.row(i) + t * test.points.row((i + 1) % test.points.rows());
          sampled = std::min(sampled, (q - p).norm());
        }
      EXPECT_LE(distance, sampled + 1e-12) << test.name;
      EXPECT_GE(distance, sampled - outline.length() / (2 * samples)) << test.name;
      // No point is farther from the outline than its neighbour by more than their distance.
      const Eigen::RowVector2d step(0.013, -0.021);
      EXPECT_LE(std::abs(outline.signed_distance(p + step) - outline.signed_distance(p)), step.norm() + 1e-12);
    }
  }
}

TEST(Outline, ArcsGoRoundTheOutline) {
  for (const PlaneCase& test : plane_cases()) {
    const Outline outline(test.points);
    ASSERT_EQ(outline.size(), test.points.rows());
    for (Index i = 0; i < outline.size(); ++i) {
      EXPECT_EQ(outline.signed_distance(test.points.row(i)), 0) << test.name;
      const Eigen::RowVector2d end = test.points.row((i + 1) % outline.size());
      const double edge = (end - test.points.row(i)).norm();
      const double next = i + 1 < outline.size() ? outline.arc(i + 1) : outline.length();
      EXPECT_NEAR(next - outline.arc(i), edge, 1e-12);
      const Eigen::RowVector2d inside = 0.75 * test.points.row(i) + 0.25 * end;
      EXPECT_NEAR(outline.arc_of_nearest(inside), outline.arc(i) + edge / 4, 1e-9) << test.name;
    }
  }
}

}  // namespace
}  // namespace meshgraft
