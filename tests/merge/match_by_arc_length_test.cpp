#include "merge/match_by_arc_length.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "merge/loop_pairs.h"

namespace meshgraft {
namespace {

/// A pair of loops of different shapes and sizes, with matches in their order.
struct MatchedPair {
  std::string name;
  PairGeometry pair;
  std::vector<Match> matches;

  Index source_size() const { return static_cast<Index>(pair.loops.source.size()); }
  Index target_size() const { return static_cast<Index>(pair.loops.target.size()); }
};

std::vector<MatchedPair> matched_pairs() {
  const std::vector<test::ClosedCurve> curves = test::closed_curves();
  std::vector<MatchedPair> pairs;
  for (std::size_t c = 0; c < curves.size(); ++c)
    for (const int count : {1, 2, 3, 5}) {
      const test::ClosedCurve &from = curves[c], &to = curves[(c + 4) % curves.size()];
      MatchedPair matched{
          from.name + " on " + to.name + ", " + std::to_string(count) + " matches",
          test::numbered_pair(test::loop_of_curve(from.points),
                              test::reversed_loop(test::loop_of_curve(to.points)), Location::pair(7)),
          {}};
      const Index n = from.size(), t = to.size();
      for (int m = 0; m < count; ++m)
        matched.matches.push_back(
            {100 + (2 + m * n / count) % n, 500 + (2 * t - 1 - m * t / count - count) % t});
      pairs.push_back(matched);
    }
  return pairs;
}

std::vector<double> parameters_of(const PairGeometry& pair, const std::vector<Match>& matches) {
  return match_by_arc_length(pair, matches).loop_parameter;
}

/// Returns the length forwards along a closed polyline between two parameters.
double length_forwards(const Points& points, double from, double to) {
  const auto arc = [&](double parameter) {
    double sum = 0;
    const auto whole = static_cast<Eigen::Index>(std::floor(parameter));
    for (Eigen::Index k = 0; k <= whole; ++k) {
      const double edge = (points.row((k + 1) % points.rows()) - points.row(k % points.rows())).norm();
      sum += k < whole ? edge : (parameter - static_cast<double>(whole)) * edge;
    }
    return sum;
  };
  return arc(to < from ? to + static_cast<double>(points.rows()) : to) - arc(from);
}

TEST(MatchByArcLength, MatchedVerticesMeetExactly) {
  for (const MatchedPair& matched : matched_pairs()) {
    const Correspondence found = match_by_arc_length(matched.pair, matched.matches);
    EXPECT_EQ(found.confidence, 1);
    ASSERT_EQ(found.loop_parameter.size(), matched.pair.loops.source.size());
    for (const Match& match : matched.matches)
      EXPECT_EQ(found.loop_parameter[match.source - 100], match.target - 500) << matched.name;
  }
}

TEST(MatchByArcLength, GoesOnceRoundTheTargetBackwards) {
  for (const MatchedPair& matched : matched_pairs()) {
    const std::vector<double> parameters = parameters_of(matched.pair, matched.matches);
    double walked = 0;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      EXPECT_GE(parameters[i], 0) << matched.name;
      EXPECT_LT(parameters[i], matched.target_size()) << matched.name;
      double step = parameters[i] - parameters[(i + 1) % parameters.size()];
      if (step < 0) step += matched.target_size();
      EXPECT_GT(step, 0) << matched.name;
      walked += step;
    }
    EXPECT_NEAR(walked, matched.target_size(), 1e-9) << matched.name;
  }
}

TEST(MatchByArcLength, DividesBothLoopsInTheSameRatioBetweenMatches) {
  for (const MatchedPair& matched : matched_pairs()) {
    const std::vector<double> parameters = parameters_of(matched.pair, matched.matches);
    const Points &source = matched.pair.source.points, &target = matched.pair.target.points;
    for (std::size_t m = 0; m < matched.matches.size(); ++m) {
      const Match &from = matched.matches[m], &to = matched.matches[(m + 1) % matched.matches.size()];
      const bool whole = matched.matches.size() == 1;
      const Index first = from.source - 100, last = to.source - 100;
      const double source_length = length_forwards(source, first, whole ? first + matched.source_size() : last);
      const double target_length = length_forwards(
          target, to.target - 500, whole ? to.target - 500 + matched.target_size() : from.target - 500);
      for (Index i = (first + 1) % matched.source_size(); i != last; i = (i + 1) % matched.source_size())
        EXPECT_NEAR(length_forwards(source, first, i) / source_length,
                    length_forwards(target, parameters[i], from.target - 500) / target_length, 1e-12)
            << matched.name;
    }
  }
}

TEST(MatchByArcLength, DoesNotDependOnTheFirstVertices) {
  for (const MatchedPair& matched : matched_pairs()) {
    const std::vector<double> expected = parameters_of(matched.pair, matched.matches);
    const Index n = matched.source_size(), t = matched.target_size();
    for (const Index shift : {1, n - 2}) {
      PairGeometry shifted{matched.pair.loops, test::shifted_loop(matched.pair.source, shift),
                           test::shifted_loop(matched.pair.target, shift % t), ""};
      std::ranges::rotate(shifted.loops.source, shifted.loops.source.begin() + shift);
      std::ranges::rotate(shifted.loops.target, shifted.loops.target.begin() + shift % t);
      const std::vector<double> found = parameters_of(shifted, matched.matches);
      for (Index i = 0; i < n; ++i)
        EXPECT_LT(test::parameter_distance(found[i] + shift % t, expected[(i + shift) % n], t), 1e-11)
            << matched.name;
    }
  }
}

TEST(MatchByArcLength, DoesNotDependOnTheOrderOfMatchesOrOnRepeatedOnes) {
  for (const MatchedPair& matched : matched_pairs()) {
    std::vector<Match> listed(matched.matches.rbegin(), matched.matches.rend());
    listed.push_back(matched.matches.front());
    EXPECT_EQ(parameters_of(matched.pair, listed), parameters_of(matched.pair, matched.matches))
        << matched.name;
  }
}

TEST(MatchByArcLength, DoesNotDependOnThePosesAndScales) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  for (const MatchedPair& matched : matched_pairs()) {
    const std::vector<double> expected = parameters_of(matched.pair, matched.matches);
    for (std::size_t k = 0; k < maps.size(); ++k) {
      const PairGeometry moved{matched.pair.loops, test::mapped_loop(matched.pair.source, maps[k]),
                               test::mapped_loop(matched.pair.target, maps[(k + 1) % maps.size()]), ""};
      const std::vector<double> found = parameters_of(moved, matched.matches);
      for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_LT(test::parameter_distance(found[i], expected[i], matched.target_size()), 1e-9) << matched.name;
    }
  }
}

TEST(MatchByArcLength, AMatchThatHoldsAlreadyChangesNothing) {
  for (const test::ClosedCurve& curve : test::closed_curves()) {
    // On the same curve, each vertex meets its own copy from any start.
    const PairGeometry pair = test::numbered_pair(test::loop_of_curve(curve.points),
                                                  test::reversed_loop(test::loop_of_curve(curve.points)));
    const Index n = curve.size();
    for (const std::vector<Index>& starts : {std::vector<Index>{0}, {n / 2}, {1, n - 1}, {0, 2, 3}}) {
      std::vector<Match> matches;
      for (const Index i : starts) matches.push_back({100 + i, 500 + n - 1 - i});
      const std::vector<double> found = parameters_of(pair, matches);
      for (Index i = 0; i < n; ++i)
        EXPECT_LT(test::parameter_distance(found[i], n - 1 - i, n), 1e-12 * n) << curve.name;
    }
  }
}

Fact refusal_of_matches(const PairGeometry& pair, const std::vector<Match>& matches) {
  try {
    match_by_arc_length(pair, matches);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.location(), pair.location);
    return error.fact();
  }
  ADD_FAILURE() << "not refused";
  throw std::logic_error("not refused");
}

TEST(MatchByArcLength, RefusesMatchesThatCross) {
  for (const MatchedPair& matched : matched_pairs()) {
    if (matched.matches.size() < 3) continue;
    std::vector<Match> matches = matched.matches;
    for (int turn = 0; turn < 3; ++turn) {
      std::swap(matches[turn].target, matches[(turn + 1) % 3].target);
      const bool in_order = turn == 1 && matches.size() == 3;  // two swaps of three turn the loop
      if (in_order) {
        EXPECT_NO_THROW(match_by_arc_length(matched.pair, matches)) << matched.name;
        continue;
      }
      const Fact fact = refusal_of_matches(matched.pair, matches);
      EXPECT_EQ(fact.id(), "merge.matches_cross") << matched.name;
      // The fact names two matches, neighbours along the source.
      const auto is_given = [&](const char* source, const char* target) {
        return std::ranges::any_of(matches, [&](const Match& match) {
          return match.source == fact.get<std::int64_t>(source) &&
                 match.target == fact.get<std::int64_t>(target);
        });
      };
      EXPECT_TRUE(is_given("source", "target")) << matched.name;
      EXPECT_TRUE(is_given("next_source", "next_target")) << matched.name;
    }
  }
}

TEST(MatchByArcLength, TwoMatchesNeverCross) {
  for (const MatchedPair& matched : matched_pairs()) {
    if (matched.matches.size() != 2) continue;
    std::vector<Match> matches = matched.matches;
    std::swap(matches[0].target, matches[1].target);
    EXPECT_NO_THROW(match_by_arc_length(matched.pair, matches)) << matched.name;
  }
}

TEST(MatchByArcLength, RefusesVerticesOffTheLoopsAndMatchedTwice) {
  for (const MatchedPair& matched : matched_pairs()) {
    const Match first = matched.matches.front();
    for (const Index off : {-1, 99, 100 + matched.source_size(), 500}) {
      const Fact fact = refusal_of_matches(matched.pair, {{off, first.target}});
      EXPECT_EQ(fact.id(), "merge.match_not_on_loop");
      EXPECT_EQ(fact.get<std::string>("side"), "source");
      EXPECT_EQ(fact.get<std::int64_t>("vertex"), off);
    }
    for (const Index off : {-1, 100, 499, 500 + matched.target_size()}) {
      const Fact fact = refusal_of_matches(matched.pair, {first, {first.source, off}});
      EXPECT_EQ(fact.id(), "merge.match_not_on_loop");
      EXPECT_EQ(fact.get<std::string>("side"), "target");
      EXPECT_EQ(fact.get<std::int64_t>("vertex"), off);
    }
    const Index other_target = 500 + (first.target - 500 + 1) % matched.target_size();
    const Fact source_twice = refusal_of_matches(matched.pair, {first, {first.source, other_target}});
    EXPECT_EQ(source_twice.id(), "merge.source_matched_twice");
    EXPECT_EQ(source_twice.get<std::int64_t>("source"), first.source);
    const Index other_source = 100 + (first.source - 100 + 1) % matched.source_size();
    const Fact target_twice = refusal_of_matches(matched.pair, {first, {other_source, first.target}});
    EXPECT_EQ(target_twice.id(), "merge.target_matched_twice");
    EXPECT_EQ(target_twice.get<std::int64_t>("target"), first.target);
  }
}

}  // namespace
}  // namespace meshgraft
