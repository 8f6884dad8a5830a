#include <meshgraft/merge/merge_options.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "../../src/merge/match_automatically.h"
#include "../../src/merge/match_by_arc_length.h"

namespace meshgraft {
namespace {

// Returns a closed curve with one bump and unevenly spaced vertices. Its normals point outward and somewhat up.
LoopGeometry bumpy_loop(int count, double phase, bool backwards, double bump = 0.4) {
  LoopGeometry loop{Points(count, 3), Points(count, 3)};
  for (int i = 0; i < count; ++i) {
    const double s = static_cast<double>(backwards ? count - i : i) / count + phase;
    const double turn = 2 * std::numbers::pi * s + 0.1 * std::sin(2 * std::numbers::pi * s);
    const double radius = 1 + bump * std::exp(-8 * (1 - std::cos(turn - 1)));
    loop.points.row(i) << radius * std::cos(turn), radius * std::sin(turn), 0.2 * bump * std::sin(2 * turn);
    loop.normals.row(i) = Eigen::RowVector3d(std::cos(turn), std::sin(turn), 0.5).normalized();
  }
  return loop;
}

LoopPair numbered(int source, int target) {
  LoopPair pair;
  for (int i = 0; i < source; ++i) pair.source.push_back(100 + i);
  for (int i = 0; i < target; ++i) pair.target.push_back(500 + i);
  return pair;
}

Eigen::RowVector3d at(const Points& points, double place) {
  const auto k = static_cast<Eigen::Index>(std::floor(place));
  const double t = place - std::floor(place);
  return (1 - t) * points.row(k % points.rows()) + t * points.row((k + 1) % points.rows());
}

TEST(Correspondence, FollowsTheStartByArcLength) {
  const LoopGeometry source = bumpy_loop(50, 0, false), target = bumpy_loop(50, 0, true);
  const LoopPair pair = numbered(50, 50);
  const Match start{pair.source[0], pair.target[0]};
  const Correspondence found = match_by_arc_length({pair, source, target, ""}, {&start, 1});
  EXPECT_EQ(found.confidence, 1);
  for (int i = 0; i < 50; ++i)
    EXPECT_LT((at(target.points, found.loop_parameter[i]) - source.points.row(i)).norm(), 1e-12) << i;
}

TEST(Correspondence, KeepsAllMatchesAndTheOrderBetween) {
  const LoopGeometry source = bumpy_loop(40, 0, false), target = bumpy_loop(25, 0.3, true);
  const LoopPair pair = numbered(40, 25);
  const std::vector<Match> matches{{103, 520}, {115, 512}, {130, 501}};
  const Correspondence found = match_by_arc_length({pair, source, target, ""}, matches);
  for (const Match& match : matches) EXPECT_EQ(found.loop_parameter[match.source - 100], match.target - 500);
  double walked = 0;
  for (int i = 0; i < 40; ++i) {
    double step = found.loop_parameter[i] - found.loop_parameter[(i + 1) % 40];
    step -= 25 * std::floor(step / 25);
    EXPECT_GT(step, 0);
    walked += step;
  }
  EXPECT_NEAR(walked, 25, 1e-9);
}

TEST(Correspondence, IsFoundWhateverTheSamplingAndThePose) {
  for (const auto& [count, phase] : {std::pair(64, 0.0), std::pair(90, 0.37), std::pair(33, 0.8)}) {
    const LoopGeometry source = bumpy_loop(64, 0, false);
    LoopGeometry target = bumpy_loop(count, phase, true);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
    const Points unposed = target.points;
    target.points = (3 * target.points * turn.transpose()).eval();
    target.points.rowwise() += Eigen::RowVector3d(4, 5, 6);
    target.normals = (target.normals * turn.transpose()).eval();
    const PairGeometry pair{numbered(64, count), source, target, ""};
    const auto found = match_automatically({&pair, 1}, false);
    EXPECT_GT(found[0].confidence, 0.3);
    for (int i = 0; i < 64; ++i)
      EXPECT_LT((at(unposed, found[0].loop_parameter[i]) - source.points.row(i)).norm(), 0.1)
          << count << ", " << i;
  }
}

TEST(Correspondence, OfIdenticalLoopsIsExact) {
  const LoopGeometry source = bumpy_loop(77, 0, false), target = bumpy_loop(77, 12.0 / 77, true);
  const PairGeometry pair{numbered(77, 77), source, target, ""};
  const auto found = match_automatically({&pair, 1}, false);
  for (int i = 0; i < 77; ++i)
    EXPECT_LT((at(target.points, found[0].loop_parameter[i]) - source.points.row(i)).norm(), 1e-12) << i;
}

TEST(Correspondence, OfCirclesIsRefusedAlone) {
  const LoopGeometry source = bumpy_loop(64, 0, false, 0), target = bumpy_loop(48, 0, true, 0);
  const PairGeometry pair{numbered(64, 48), source, target, "pair 7"};
  try {
    match_automatically({&pair, 1}, false);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "merge.open_start");
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.location(), "pair 7");
    const std::vector<OpenStart> starts = open_starts(error.fact());
    ASSERT_EQ(starts.size(), 1U);
    EXPECT_EQ(starts[0].pair, 0U);
    EXPECT_EQ(starts[0].least_turned.source, error.fact().get<std::int64_t>("source"));
    EXPECT_EQ(starts[0].least_turned.target, error.fact().get<std::int64_t>("target"));
    EXPECT_EQ(starts[0].confidence, error.fact().get<double>("confidence"));
    EXPECT_EQ(starts[0].least_turned.source, pair.loops.source.front());
    EXPECT_NE(std::find(pair.loops.target.begin(), pair.loops.target.end(), starts[0].least_turned.target),
              pair.loops.target.end());
  }
  // Where the source has a pose, nearness decides.
  const auto posed = match_automatically({&pair, 1}, true);
  for (int i = 0; i < 64; ++i)
    EXPECT_LT((at(target.points, posed[0].loop_parameter[i]) - source.points.row(i)).norm(), 0.1);
}

TEST(Correspondence, OfCirclesIsPlacedByTheOthers) {
  std::vector<PairGeometry> pairs;
  for (int p = 0; p < 3; ++p) {
    const Eigen::RowVector3d centre(4 * std::cos(2.0 * p), 4 * std::sin(2.0 * p), p);
    pairs.push_back({numbered(40, 56), bumpy_loop(40, 0.1 * p, false, 0), bumpy_loop(56, 0.2, true, 0),
                     "pair " + std::to_string(p)});
    pairs.back().source.points.rowwise() += centre;
    pairs.back().target.points.rowwise() += centre;
  }
  const auto found = match_automatically(pairs, false);
  for (int p = 0; p < 3; ++p) {
    for (int i = 0; i < 40; ++i)
      EXPECT_LT((at(pairs[p].target.points, found[p].loop_parameter[i]) - pairs[p].source.points.row(i)).norm(),
                0.15)
          << p;
  }
}

}  // namespace
}  // namespace meshgraft
