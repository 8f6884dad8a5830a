#include "merge/validate_options.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "mesh/shapes.h"

namespace meshgraft {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Options that break one rule.
struct RefusedOptions {
  std::string id, location;
  MergeOptions options;
};

std::vector<RefusedOptions> refused_options() {
  std::vector<RefusedOptions> refused{
      {"merge.reach_less_than_one_ring", "reach", {.reach = {.rings = 0}}},
      {"merge.reach_less_than_one_ring", "reach", {.reach = {.rings = -5}}},
      {"merge.reach_given_twice", "reach", {.reach = {.rings = 2, .length = 0.5}}},
      {"merge.reach_given_twice", "reach", {.pose = MergePose::keep, .reach = {.rings = 2, .length = 0.5}}},
      {"merge.fixed_while_pose_found", "fixed", {.fixed = {0}}},
  };
  for (const double value : {0.0, -1.0, -infinite, not_a_number}) {
    refused.push_back({"core.not_positive", "size", {.size = value}});
    refused.push_back({"core.not_positive", "reach", {.reach = {.length = value}}});
  }
  for (const double value : {180.001, -180.001, 1e9, infinite, -infinite, not_a_number})
    refused.push_back({"core.out_of_range", "normal_angle_deg", {.normal_angle_deg = value}});
  for (const Index vertex : {-1, 12, 1 << 20})
    refused.push_back({"merge.no_such_vertex", "fixed", {.pose = MergePose::keep, .fixed = {0, vertex, 1}}});
  return refused;
}

std::vector<MergeOptions> accepted_options() {
  std::vector<MergeOptions> accepted{
      {},
      {.pose = MergePose::keep},
      {.shape = MergeShape::ft05},
      {.reach = {.rings = 1}},
      {.reach = {.length = 1e-300}},
      {.pose = MergePose::keep, .reach = {.rings = 3}, .fixed = {0, 11}},
      {.pose = MergePose::keep, .size = 2.0},
  };
  for (const double angle : {-180.0, -30.0, 180.0}) accepted.push_back({.normal_angle_deg = angle});
  return accepted;
}

Mesh source_of_twelve() { return shapes::tube(4, 2); }

TEST(ValidateOptions, AcceptsWhatIsInRange) {
  for (const MergeOptions& options : accepted_options())
    EXPECT_NO_THROW(validate_options(options, source_of_twelve(), shapes::cube()));
}

TEST(ValidateOptions, RefusesEachBrokenRuleAtItsOption) {
  for (const RefusedOptions& refused : refused_options()) {
    try {
      validate_options(refused.options, source_of_twelve(), shapes::cube());
      ADD_FAILURE() << refused.id << " was not thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), refused.id);
      EXPECT_EQ(error.location().text(), refused.location) << refused.id;
      EXPECT_EQ(error.code(), ErrorCode::input) << refused.id;
    }
  }
}

TEST(ValidateOptions, NamesTheVertexThatDoesNotExist) {
  try {
    validate_options({.pose = MergePose::keep, .fixed = {3, 12, -4}}, source_of_twelve(), shapes::cube());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fact().get<std::string>("side"), "source");
    EXPECT_EQ(error.fact().get<std::int64_t>("vertex"), 12);
    EXPECT_EQ(error.fact().get<std::int64_t>("count"), 12);
  }
}

TEST(ValidateOptions, BoundsTheSizeByThatOfTheTarget) {
  // The bound is relative, so it does not depend on the units of either mesh.
  for (const double source_scale : {1e-4, 1.0, 300.0})
    for (const double target_scale : {1e-3, 1.0, 5e4}) {
      Mesh source = shapes::cube(), target = shapes::cube();
      source.positions *= source_scale;
      target.positions *= target_scale;
      const double same = target_scale / source_scale;
      for (const double factor : {1.01e-6, 1.0, 0.99e6})
        EXPECT_NO_THROW(validate_options({.size = factor * same}, source, target));
      for (const double factor : {1e-12, 0.99e-6, 1.01e6, 1e12}) {
        try {
          validate_options({.size = factor * same}, source, target);
          ADD_FAILURE() << factor << " was accepted";
        } catch (const Error& error) {
          EXPECT_EQ(error.id(), factor < 1 ? "merge.size_makes_source_tiny" : "merge.size_makes_source_huge");
          EXPECT_EQ(error.location().text(), "size");
          EXPECT_EQ(error.fact().get<double>("size"), factor * same);
          EXPECT_NEAR(error.fact().get<double>("same_size"), same, 1e-12 * same);
        }
      }
    }
}

}  // namespace
}  // namespace meshgraft
