#include "merge/match_automatically.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/orientation.h>

#include "merge/loop_curve.h"
#include "merge/loop_pairs.h"

namespace meshgraft {
namespace {

/// Matches a pair whose models may have any orientation.
Correspondence alone(const PairGeometry& pair) { return match_automatically({&pair, 1}, false, {})[0]; }

/// Returns the same loop as source and target. The target runs the other way and begins elsewhere, so that
/// source vertex i meets target vertex n - 1 - i - shift.
PairGeometry planted_pair(const LoopGeometry& loop, Index shift) {
  return test::numbered_pair(loop, test::shifted_loop(test::reversed_loop(loop), shift), Location::pair(3));
}

std::vector<LoopGeometry> loops_with_features() {
  return {test::bumpy_loop(77, 0, false), test::bumpy_loop(30, 0.6, false),
          test::bumpy_loop(12, 0.1, false, 0.8), test::bumpy_loop(130, 0.3, false, 0.25)};
}

TEST(MatchAutomatically, FindsAPlantedStartExactly) {
  for (const LoopGeometry& loop : loops_with_features()) {
    const auto n = static_cast<Index>(loop.points.rows());
    for (const Index shift : {0, 1, n / 3, n - 2}) {
      const Correspondence found = alone(planted_pair(loop, shift));
      for (Index i = 0; i < n; ++i)
        EXPECT_LT(test::parameter_distance(found.loop_parameter[i], n - 1 - i - shift, n), 1e-11 * n)
            << n << ", " << shift;
      EXPECT_GT(found.confidence, 0.3);
      EXPECT_LE(found.confidence, 1);
    }
  }
}

TEST(MatchAutomatically, DoesNotDependOnThePosesAndScales) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  for (const LoopGeometry& loop : loops_with_features()) {
    const auto n = static_cast<Index>(loop.points.rows());
    PairGeometry pair = planted_pair(loop, n / 2);
    const double confidence = alone(pair).confidence;
    for (std::size_t k = 0; k < maps.size(); ++k) {
      PairGeometry moved = pair;
      moved.source = test::mapped_loop(pair.source, maps[k]);
      moved.target = test::mapped_loop(pair.target, maps[(k + 1) % maps.size()]);
      const Correspondence found = alone(moved);
      EXPECT_NEAR(found.confidence, confidence, 1e-6);
      for (Index i = 0; i < n; ++i)
        EXPECT_LT(test::parameter_distance(found.loop_parameter[i], n - 1 - i - n / 2, n), 1e-8);
    }
  }
}

TEST(MatchAutomatically, DoesNotDependOnTheSampling) {
  const LoopGeometry source = test::bumpy_loop(64, 0, false);
  for (const auto& [count, phase] : {std::pair(64, 0.0), std::pair(90, 0.37), std::pair(33, 0.8)}) {
    const LoopGeometry target = test::bumpy_loop(count, phase, true);
    for (const Eigen::Affine3d& map : test::similarities()) {
      const Correspondence found = alone(test::numbered_pair(source, test::mapped_loop(target, map)));
      EXPECT_GT(found.confidence, 0.3);
      for (int i = 0; i < 64; ++i)
        EXPECT_LT((at(target.points, found.loop_parameter[i]) - source.points.row(i)).norm(), 0.1)
            << count << ", " << i;
    }
  }
}

TEST(MatchAutomatically, RounderLoopsAreLessCertain) {
  double last = 0;
  for (const double bump : {0.1, 0.2, 0.4, 0.8}) {
    const double confidence = alone(planted_pair(test::bumpy_loop(60, 0, false, bump), 7)).confidence;
    EXPECT_GT(confidence, last) << bump;
    last = confidence;
  }
}

/// Returns a flat loop with so many tips; 0 makes a circle.
LoopGeometry star(int tips, int count = 60) {
  LoopGeometry loop = test::loop_of_curve(test::around_z(count, [tips](double angle) {
    return Eigen::Vector2d(tips == 0 ? 1 : 1 + 0.3 * std::cos(tips * angle), 0);
  }));
  loop.normals = Eigen::RowVector3d(0, 0, 1).replicate(count, 1);
  return loop;
}

TEST(MatchAutomatically, ListsTheStartsOfAStarAlike) {
  for (const int tips : {2, 3, 5}) {
    const PairGeometry pair = test::numbered_pair(star(tips), test::reversed_loop(star(tips, 87)));
    const std::vector<StartCandidate> starts = alone(pair).starts;
    ASSERT_EQ(starts.size(), static_cast<std::size_t>(tips));
    for (const StartCandidate& start : starts) {
      EXPECT_NEAR(start.probability, 1.0 / tips, 0.2);
      EXPECT_NEAR(std::remainder(start.turn_deg * tips / 360, 1), 0, 0.05);
    }
  }
}

TEST(MatchAutomatically, VerticesThatCoincideDecideBetweenStartsThatFitAlike) {
  for (const int tips : {1, 2, 3, 5}) {
    const Correspondence found = alone(planted_pair(star(tips), 11));
    EXPECT_GT(found.confidence, 0.9) << tips;
    for (Index i = 0; i < 60; ++i)
      EXPECT_LT(test::parameter_distance(found.loop_parameter[i], 60 - 1 - i - 11, 60), 1e-9) << tips;
  }
}

TEST(MatchAutomatically, LoopsThatCoincideAsGivenStayAsTheyAre) {
  // A regular polygon coincides from each of its vertices; guesses that want another turn do not matter.
  LoopGeometry loop{Points(32, 3), Points(32, 3)};
  for (int k = 0; k < 32; ++k) {
    const double angle = 2 * std::numbers::pi * k / 32;
    loop.points.row(k) << std::cos(angle), std::sin(angle), 0;
  }
  loop.normals = loop.points;
  const PairGeometry pair = planted_pair(loop, 9);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const std::vector<OrientationGuess> one{{make_orientation(up, {1, 0, 0}), 0.99},
                                          {make_orientation(up, {0, 1, 0}), 0.01}},
      other{{make_orientation(up, {-1, 0, 0}), 0.99}, {make_orientation(up, {0, 1, 0}), 0.01}};
  const Correspondence found = match_automatically({&pair, 1}, false, {one, other})[0];
  for (Index i = 0; i < 32; ++i)
    EXPECT_LT(test::parameter_distance(found.loop_parameter[i], 32 - 1 - i - 9, 32), 1e-9);
}

TEST(MatchAutomatically, ProbabilitiesAddUpToOneAtMost) {
  for (const int tips : {0, 2, 3, 5, 7})
    for (const int count : {31, 60, 87})
      for (const double turn : {0.3, 1.1, 2.4}) {
        const PairGeometry pair = test::numbered_pair(star(tips), test::reversed_loop(star(tips + 2, count)));
        const OrientationGuess here{make_orientation(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()), 0.6};
        const OrientationGuess there{
            make_orientation(Eigen::Vector3d::UnitZ(), {std::cos(turn), std::sin(turn), 0}), 0.4};
        const Correspondence found = match_automatically({&pair, 1}, false, {{here, there}, {here, there}})[0];
        double sum = 0;
        for (const StartCandidate& start : found.starts) sum += start.probability;
        EXPECT_LE(sum, 1 + 1e-9);
      }
}

TEST(MatchAutomatically, KnownOrientationsDecideBetweenStartsThatFitAlike) {
  for (const int tips : {0, 2, 3, 5}) {
    const PairGeometry pair = planted_pair(star(tips), 11);
    const OrientationGuess here{make_orientation(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX())};
    for (const double turn : {0.0, 2 * std::numbers::pi / 3, -2 * std::numbers::pi / 5}) {
      if (tips > 0 && std::abs(std::remainder(turn * tips / (2 * std::numbers::pi), 1)) > 1e-9) continue;
      const OrientationGuess there{
          make_orientation(Eigen::Vector3d::UnitZ(), Eigen::Vector3d(std::cos(turn), std::sin(turn), 0))};
      const Correspondence found = match_automatically({&pair, 1}, false, {{there}, {here}})[0];
      EXPECT_GT(found.confidence, 0.9) << tips << ", " << turn;
      for (int i = 0; i < 60; ++i) {
        const Eigen::RowVector3d expected =
            pair.source.points.row(i) *
            Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix().transpose();
        EXPECT_LT((at(pair.target.points, found.loop_parameter[i]) - expected).norm(), 0.15)
            << tips << ", " << turn;
      }
    }
  }
}

TEST(MatchAutomatically, NearnessDecidesWhereTheSourceIsPosed) {
  for (const double bump : {0.0, 0.4}) {
    const LoopGeometry loop = test::bumpy_loop(48, 0, false, bump);
    for (const Index shift : {0, 5, 30}) {
      const PairGeometry pair = planted_pair(loop, shift);
      const Correspondence found = match_automatically({&pair, 1}, true, {})[0];
      for (Index i = 0; i < 48; ++i)
        EXPECT_LT(test::parameter_distance(found.loop_parameter[i], 47 - i - shift, 48), 1e-9) << bump;
    }
  }
  // The bump of a source that is turned about its axis stays beside that of the target.
  const LoopGeometry source = test::bumpy_loop(64, 0, false, 0.1);
  const Eigen::Affine3d turn(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitZ()));
  const PairGeometry turned =
      test::numbered_pair(test::mapped_loop(source, turn), test::bumpy_loop(64, 0, true, 0.1));
  const Correspondence found = match_automatically({&turned, 1}, true, {})[0];
  for (int i = 0; i < 64; ++i)
    EXPECT_LT((at(turned.target.points, found.loop_parameter[i]) - turned.source.points.row(i)).norm(), 0.2);
}

/// Returns round pairs on a circle around z.
std::vector<PairGeometry> round_pairs(int count) {
  std::vector<PairGeometry> pairs;
  for (int p = 0; p < count; ++p) {
    const Eigen::RowVector3d centre(4 * std::cos(2.0 * p), 4 * std::sin(2.0 * p), p);
    pairs.push_back(test::numbered_pair(test::bumpy_loop(40, 0.1 * p, false, 0),
                                        test::bumpy_loop(56, 0.2, true, 0), Location::pair(p)));
    pairs.back().source.points.rowwise() += centre;
    pairs.back().target.points.rowwise() += centre;
  }
  return pairs;
}

/// Expects that each source vertex meets the target close to its own place.
void expect_in_place(const std::vector<PairGeometry>& pairs, const std::vector<PairGeometry>& unmoved,
                     const std::vector<Correspondence>& found) {
  ASSERT_EQ(found.size(), pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p)
    for (Eigen::Index i = 0; i < pairs[p].source.points.rows(); ++i)
      EXPECT_LT(
          (at(unmoved[p].target.points, found[p].loop_parameter[i]) - unmoved[p].source.points.row(i)).norm(),
          0.15)
          << p;
}

TEST(MatchAutomatically, SeveralCirclesPlaceEachOther) {
  for (const int count : {3, 4})
    for (const Eigen::Affine3d& map : test::similarities()) {
      const std::vector<PairGeometry> unmoved = round_pairs(count);
      std::vector<PairGeometry> pairs = unmoved;
      for (PairGeometry& pair : pairs) pair.source = test::mapped_loop(pair.source, map);
      expect_in_place(pairs, unmoved, match_automatically(pairs, false, {}));
    }
}

TEST(MatchAutomatically, ALoopWithFeaturesPlacesACircle) {
  for (const Eigen::Affine3d& map : test::similarities())
    for (const bool first : {true, false}) {
      std::vector<PairGeometry> unmoved = round_pairs(1);
      unmoved.insert(first ? unmoved.begin() : unmoved.end(),
                     test::numbered_pair(test::bumpy_loop(64, 0, false), test::bumpy_loop(90, 0.37, true)));
      std::vector<PairGeometry> pairs = unmoved;
      for (PairGeometry& pair : pairs) pair.source = test::mapped_loop(pair.source, map);
      expect_in_place(pairs, unmoved, match_automatically(pairs, false, {}));
    }
}

}  // namespace
}  // namespace meshgraft
