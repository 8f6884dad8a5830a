#include "merge/retry.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge.h>

#include "support/random_grafts.h"

namespace meshgraft {
namespace {

constexpr OpenSettings all_open{
    .reach = true, .normal_angle = true, .size = true, .start_shift = true, .starts = 4};

/// Records what is tried. The faults grow with the distance from one variation.
struct Trials {
  Variation good;
  std::vector<Variation> tried;

  double faults(const Variation& variation) {
    tried.push_back(variation);
    return std::abs(variation.doublings - good.doublings) +
           std::abs(variation.normal_angle_deg - good.normal_angle_deg) / 20 +
           10 * std::abs(variation.size_ratio - good.size_ratio) + std::abs(variation.start - good.start) +
           20 * std::abs(variation.start_shift - good.start_shift);
  }
  FoundVariation find(const OpenSettings& open, const MostTries& most) {
    const double first = Trials{good, {}}.faults({});
    return find_variation(open, first, most, [this](const Variation& v) { return faults(v); });
  }
};

const std::vector<Variation> reachable{
    {.doublings = 2}, {.normal_angle_deg = -40}, {.size_ratio = 1.25},
    {.start = 3},     {.start_shift = -0.08},    {.doublings = 1, .normal_angle_deg = 20, .size_ratio = 0.8}};

TEST(FindVariation, ReachesWhatHasNoFaults) {
  for (const Variation& good : reachable) {
    Trials trials{good, {}};
    const FoundVariation found = trials.find(all_open, {1000, 0});
    EXPECT_EQ(found.best, good);
    EXPECT_EQ(found.faults, 0);
    EXPECT_EQ(found.tries, static_cast<int>(trials.tried.size()));
    EXPECT_EQ(trials.tried.back(), good) << "nothing is tried after it";
  }
}

TEST(FindVariation, TriesNothingTwiceAndNoMoreThanItMay) {
  const Variation unreachable{.doublings = 3, .normal_angle_deg = 13, .size_ratio = 1.1, .start = 2};
  for (const MostTries most :
       {MostTries{0, 0, 0}, {1, 0, 0}, {7, 5, 3}, {0, 9, 0}, {0, 0, 9}, {1000, 100, 100}}) {
    Trials trials{unreachable, {}};
    const FoundVariation found = trials.find(all_open, most);
    EXPECT_LE(found.tries, most.sum());
    EXPECT_EQ(std::set(trials.tried.begin(), trials.tried.end()).size(), trials.tried.size());
    EXPECT_LE(found.faults, (Trials{unreachable, {}}.faults({})));
  }
}

// No change of a single setting is better than none here.
TEST(FindVariation, CombinesSettingsWhereNoSingleOneHelps) {
  const auto faults = [](const Variation& v) {
    return v.normal_angle_deg < -20 && v.size_ratio < 0.8 && v.doublings >= 2 ? 0.0 : 5.0;
  };
  EXPECT_EQ(find_variation(all_open, 5, {1000, 0}, faults).faults, 5);
  const FoundVariation found = find_variation(all_open, 5, {1000, 60}, faults);
  EXPECT_EQ(found.faults, 0);
  EXPECT_EQ(faults(found.best), 0);
}

// The steps of single settings pass over what has no faults.
TEST(FindVariation, LooksBesideTheBest) {
  const auto faults = [](const Variation& v) {
    const double angle = std::abs(v.normal_angle_deg - 47), shift = std::abs(v.start_shift - 0.055);
    return angle < 5 && shift < 0.01 ? 0.0 : 1 + angle / 10 + 20 * shift;
  };
  const OpenSettings open{.normal_angle = true, .size = true, .start_shift = true};
  EXPECT_GT(find_variation(open, 9, {1000, 0, 0}, faults).faults, 0);
  const FoundVariation found = find_variation(open, 9, {1000, 0, 30}, faults);
  EXPECT_EQ(found.faults, 0);
  EXPECT_EQ(faults(found.best), 0);
}

TEST(FindVariation, TurnsSureStartsLittle) {
  for (const int starts : {1, 4}) {
    double largest = 0;
    OpenSettings open = all_open;
    open.starts = starts;
    find_variation(open, 5, {0, 60}, [&](const Variation& v) {
      largest = std::max(largest, std::abs(v.start_shift));
      return 5.0;
    });
    EXPECT_LE(largest, starts == 1 ? 0.15 : 0.5);
    EXPECT_GT(largest, starts == 1 ? 0.1 : 0.4);
  }
}

TEST(FindVariation, ChangesWhatIsOpenAlone) {
  const Variation good{
      .doublings = 2, .normal_angle_deg = 20, .size_ratio = 0.8, .start = 1, .start_shift = 0.04};
  const auto differing = [&](const OpenSettings& open, auto changed) {
    Trials trials{good, {}};
    trials.find(open, {1000, 20, 20});
    for (const Variation& v : trials.tried) EXPECT_TRUE(changed(v));
    return trials.tried.size();
  };
  EXPECT_EQ(differing({}, [](const Variation&) { return false; }), 0u);
  const auto only = [](auto Variation::* setting) {
    return [setting](Variation v) {
      v.*setting = Variation{}.*setting;
      return v == Variation{};
    };
  };
  EXPECT_GT(differing({.reach = true}, only(&Variation::doublings)), 0u);
  EXPECT_GT(differing({.normal_angle = true}, only(&Variation::normal_angle_deg)), 0u);
  EXPECT_GT(differing({.size = true}, only(&Variation::size_ratio)), 0u);
  EXPECT_GT(differing({.start_shift = true}, only(&Variation::start_shift)), 0u);
  EXPECT_GT(differing({.starts = 3}, only(&Variation::start)), 0u);
}

TEST(FindVariation, SkipsWhatIsImpossible) {
  const FoundVariation found = find_variation(
      all_open, 5, {1000, 100, 100}, [](const Variation&) { return std::numeric_limits<double>::infinity(); });
  EXPECT_EQ(found.best, Variation{});
  EXPECT_EQ(found.faults, 5);
}

MergeResult merged(const test::RandomGraft& graft, const MergeOptions& options) {
  return merge_meshes(graft.target, graft.source, graft.pairs, options);
}

// A part of a head on another, a neck on a cylinder's hole, a torus on a dinosaur's jaw.
class RetriedGraft : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RetriedGraft, HasNoFaultsWhereTheFirstOneHas) {
  const test::RandomGraft graft = test::make_random_graft(GetParam(), test::GraftKind::found);
  SCOPED_TRACE(graft.text);
  const MergeResult result = merged(graft, graft.options);
  const RetryReport& retry = result.report.retry;
  EXPECT_GT(retry.tries, 0);
  EXPECT_GT(retry.faults_before, 0);
  EXPECT_EQ(retry.faults, 0);
  EXPECT_EQ(result.report.shape.inverted + result.report.seam.faults.folded_edges +
                result.report.seam.faults.crossings + result.report.seam.faults.far_crossings,
            0);
  MergeOptions once = graft.options;
  once.retry = false;
  const MergeReport first = merged(graft, once).report;
  EXPECT_EQ(first.retry.tries, 0);
  EXPECT_EQ(first.shape.inverted + first.seam.faults.folded_edges + first.seam.faults.crossings +
                first.seam.faults.far_crossings,
            retry.faults_before);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RetriedGraft, testing::Values(23, 45, 41), testing::PrintToStringParamName());

TEST(Retry, LeavesWhatIsGiven) {
  test::RandomGraft graft = test::make_random_graft(45, test::GraftKind::found);
  graft.options.normal_angle_deg = -10;
  graft.options.reach.rings = 4;
  graft.options.size = 0.9;
  const RetryReport retry = merged(graft, graft.options).report.retry;
  EXPECT_GT(retry.tries, 0);
  EXPECT_EQ(retry.normal_angle_deg, 0);
  EXPECT_EQ(retry.reach_doublings, 0);
  EXPECT_EQ(retry.size, 0);
}

TEST(Retry, ChangesNothingWithoutFaultsOrOtherShapes) {
  test::RandomGraft graft = test::make_random_graft(1, test::GraftKind::found);
  MergeOptions once = graft.options;
  once.retry = false;
  EXPECT_EQ(merged(graft, graft.options).mesh.positions, merged(graft, once).mesh.positions);
  graft = test::make_random_graft(45, test::GraftKind::found);
  graft.options.shape = MergeShape::ft05;
  EXPECT_EQ(merged(graft, graft.options).report.retry.tries, 0);
}

// A bracket with two open tubes on a torus's two ends, and a torus on a bracket: the loops lie 2.3 and 1.8
// radii apart however the source is placed.
class InvertingPairs : public testing::TestWithParam<std::uint64_t> {};

TEST_P(InvertingPairs, AreRefusedByTheirPairButNotAlone) {
  const test::RandomGraft graft = test::make_random_graft(GetParam(), test::GraftKind::found);
  SCOPED_TRACE(graft.text);
  const test::Attempt refused = test::attempt(graft);
  ASSERT_TRUE(refused.refusal);
  EXPECT_EQ(refused.refusal->id(), "merge.pairs_invert_source");
  EXPECT_GT(refused.refusal->fact().get<double>("radii"), 1);
  EXPECT_GT(refused.refusal->fact().get<std::int64_t>("vertices"), 0);
  const auto pair = static_cast<std::size_t>(refused.refusal->fact().get<std::int64_t>("pair"));
  EXPECT_EQ(refused.refusal->location(), Location::pair(pair));

  test::RandomGraft once = graft;
  once.options.retry = false;
  const MergeReport first = merged(once, once.options).report;
  EXPECT_GT(first.shape.inverted, 0);
  for (const PairReport& report : first.pairs) EXPECT_LE(report.misfit_rel, first.pairs[pair].misfit_rel);

  test::RandomGraft alone = graft;
  alone.pairs = {graft.pairs[pair]};
  const test::Attempt made = test::attempt(alone);
  ASSERT_TRUE(made.result);
  EXPECT_EQ(made.result->report.shape.inverted, 0);
  EXPECT_EQ(made.result->report.seam.faults.total(), 0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, InvertingPairs, testing::Values(115, 469), testing::PrintToStringParamName());

// Pairs that are 8 and 2.6 radii apart, of which the source follows both.
TEST(PairsFarApart, AreGraftedWhereNothingTurnsInsideOut) {
  for (const std::uint64_t seed : {53, 278}) {
    const test::RandomGraft graft = test::make_random_graft(seed, test::GraftKind::found);
    SCOPED_TRACE(graft.text);
    const MergeReport report = merged(graft, graft.options).report;
    EXPECT_GT(std::max(report.pairs[0].misfit_rel, report.pairs[1].misfit_rel), 2);
    EXPECT_EQ(report.shape.inverted + report.seam.faults.total(), 0);
  }
}

}  // namespace
}  // namespace meshgraft
