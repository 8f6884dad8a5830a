
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "mesh/interpolate_attribute.h"

namespace meshgraft {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// Returns the values of one element at `t` between the two elements `a` and `b`.
std::vector<double> between(Interpolation interpolation, const std::vector<double>& a,
                            const std::vector<double>& b, double t) {
  Attribute attribute{.name = "x", .components = static_cast<int>(a.size()), .values = a};
  attribute.interpolation = interpolation;
  attribute.values.insert(attribute.values.end(), b.begin(), b.end());
  const std::vector<EdgePoint> elements{{0, 1, t}};
  return interpolate_attribute(attribute, elements).values;
}

TEST(InterpolateAttribute, MixesByTheInterpolationRule) {
  EXPECT_EQ(between(Interpolation::linear, {1, 0}, {3, 8}, 0.25), (std::vector<double>{1.5, 2}));
  EXPECT_EQ(between(Interpolation::nearest, {1, 0}, {3, 8}, 0.25), (std::vector<double>{1, 0}));
  const std::vector<double> middle = between(Interpolation::direction, {1, 0, 0}, {0, 1, 0}, 0.5);
  EXPECT_NEAR(middle[0], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(middle[1], std::sqrt(0.5), 1e-15);
  EXPECT_EQ(middle[2], 0);
}

TEST(InterpolateAttribute, OppositeDirectionsHaveNoMiddle) {
  EXPECT_EQ(between(Interpolation::direction, {1, 0, 0}, {-1, 0, 0}, 0.5), (std::vector<double>{1, 0, 0}));
}

TEST(InterpolateAttribute, AMixtureWithAMissingValueIsMissing) {
  for (const Interpolation interpolation : {Interpolation::linear, Interpolation::direction}) {
    for (const double t : {0.25, 0.5, 0.75}) {
      for (const bool first : {false, true}) {
        const std::vector<double> none{missing, missing, missing}, some{0, 0, 1};
        for (const double value : between(interpolation, first ? none : some, first ? some : none, t)) {
          EXPECT_TRUE(std::isnan(value)) << t << first;
        }
      }
    }
  }
}

TEST(InterpolateAttribute, ADirectionWithOneMissingComponentIsMissing) {
  for (const double value : between(Interpolation::direction, {0, missing, 1}, {0, 0, 1}, 0.5)) {
    EXPECT_TRUE(std::isnan(value));
  }
}

TEST(InterpolateAttribute, AnEndKeepsItsValues) {
  const std::vector<double> end = between(Interpolation::direction, {0, 0, 2}, {missing, missing, missing}, 0);
  EXPECT_EQ(end, (std::vector<double>{0, 0, 2}));
}

}  // namespace
}  // namespace meshgraft
