#include "merge/match_automatically.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "merge/loop_curve.h"
#include "merge/loop_pairs.h"

namespace meshgraft {
namespace {

Correspondence alone(const PairGeometry& pair) { return match_automatically({&pair, 1}, false)[0]; }

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

TEST(MatchAutomatically, RefusesLoopsThatFitFromOtherStarts) {
  const auto star = [](int tips) {
    return test::loop_of_curve(test::around_z(60, [tips](double angle) {
      return Eigen::Vector2d(tips == 0 ? 1 : 1 + 0.3 * std::cos(tips * angle), 0);
    }));
  };
  for (const int tips : {0, 2, 3, 5}) {  // 0 makes a circle
    LoopGeometry loop = star(tips);
    loop.normals = Eigen::RowVector3d(0, 0, 1).replicate(60, 1);
    const PairGeometry pair = planted_pair(loop, 11);
    try {
      alone(pair);
      ADD_FAILURE() << tips << " tips were matched";
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), "merge.ambiguous_start");
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_EQ(error.location().text(), "pair 3");
      const std::vector<AmbiguousStart> starts = ambiguous_starts(error.fact());
      ASSERT_EQ(starts.size(), 1U);
      EXPECT_EQ(starts[0].pair, 0U);
      EXPECT_LT(starts[0].confidence, 0.03);
      // The source is on the target already, so no turn is the least one.
      EXPECT_EQ(starts[0].least_turned.source, 100);
      EXPECT_EQ(starts[0].least_turned.target, 500 + 60 - 1 - 11) << tips;
    }
  }
  EXPECT_NO_THROW(alone(planted_pair(star(1), 11)));
}

TEST(MatchAutomatically, NearnessDecidesWhereTheSourceIsPosed) {
  for (const double bump : {0.0, 0.4}) {
    const LoopGeometry loop = test::bumpy_loop(48, 0, false, bump);
    for (const Index shift : {0, 5, 30}) {
      const PairGeometry pair = planted_pair(loop, shift);
      const Correspondence found = match_automatically({&pair, 1}, true)[0];
      for (Index i = 0; i < 48; ++i)
        EXPECT_LT(test::parameter_distance(found.loop_parameter[i], 47 - i - shift, 48), 1e-9) << bump;
    }
  }
  // The bump of a source that is turned about its axis stays beside that of the target.
  const LoopGeometry source = test::bumpy_loop(64, 0, false, 0.1);
  const Eigen::Affine3d turn(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitZ()));
  const PairGeometry turned =
      test::numbered_pair(test::mapped_loop(source, turn), test::bumpy_loop(64, 0, true, 0.1));
  const Correspondence found = match_automatically({&turned, 1}, true)[0];
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
      expect_in_place(pairs, unmoved, match_automatically(pairs, false));
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
      expect_in_place(pairs, unmoved, match_automatically(pairs, false));
    }
}

}  // namespace
}  // namespace meshgraft
