#include "merge/report_pair.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "merge/loop_curve.h"
#include "merge/loop_pairs.h"
#include "merge/loops.h"
#include "merge/match_by_arc_length.h"

namespace meshgraft {
namespace {

/// A pair of different curves, matched from one start.
struct ReportedPair {
  std::string name;
  PairGeometry pair;
  Correspondence correspondence;
};

std::vector<ReportedPair> reported_pairs() {
  const std::vector<test::ClosedCurve> curves = test::closed_curves();
  std::vector<ReportedPair> pairs;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const test::ClosedCurve& to = curves[(c + 4) % curves.size()];
    ReportedPair result{curves[c].name + " on " + to.name,
                        test::numbered_pair(test::loop_of_curve(curves[c].points),
                                            test::reversed_loop(test::loop_of_curve(to.points))),
                        {}};
    const Match start{102, 500 + to.size() - 1};
    result.correspondence = match_by_arc_length(result.pair, {&start, 1});
    result.correspondence.confidence = 0.1 + 0.01 * static_cast<double>(c);
    pairs.push_back(result);
  }
  return pairs;
}

/// The vertices from this one on count as added by refinement.
constexpr Index none_added = 1000;

std::vector<VertexConstraint> constraints_at(const Points& points) {
  std::vector<VertexConstraint> constraints;
  for (Index k = 0; k < static_cast<Index>(points.rows()); ++k)
    constraints.push_back({k, Eigen::Vector3d(points.row(k).transpose())});
  return constraints;
}

TEST(ReportPair, CountsTheLoops) {
  for (const ReportedPair& given : reported_pairs()) {
    const PairReport report = report_pair(given.pair, given.correspondence, none_added);
    EXPECT_EQ(report.source_vertices, given.pair.source.points.rows()) << given.name;
    EXPECT_EQ(report.target_vertices, given.pair.target.points.rows()) << given.name;
    EXPECT_EQ(report.edge_ratio * report.target_vertices, report.source_vertices) << given.name;
    EXPECT_EQ(report.confidence, given.correspondence.confidence) << given.name;
  }
}

TEST(ReportPair, NamesTheTargetVertexNearestToTheStart) {
  for (const ReportedPair& given : reported_pairs()) {
    const PairReport report = report_pair(given.pair, given.correspondence, none_added);
    EXPECT_EQ(report.start.source, given.pair.loops.source.front()) << given.name;
    const auto count = static_cast<Eigen::Index>(given.pair.loops.target.size());
    EXPECT_LE(
        test::parameter_distance(report.start.target - 500, given.correspondence.loop_parameter[0], count), 0.5)
        << given.name;
  }
  // Beyond the middle of the last edge, the nearest vertex is the first one.
  ReportedPair last = reported_pairs()[0];
  const auto count = static_cast<double>(last.pair.loops.target.size());
  last.correspondence.loop_parameter[0] = count - 0.4;
  EXPECT_EQ(report_pair(last.pair, last.correspondence, none_added).start.target, 500);
}

TEST(ReportPair, ListsWhereGivenVerticesMeetTheTarget) {
  for (const ReportedPair& given : reported_pairs()) {
    const auto count = static_cast<Index>(given.pair.loops.source.size());
    for (const Index first_added : {none_added, 100 + count, 100 + count / 2, 101, 100}) {
      const PairReport report = report_pair(given.pair, given.correspondence, first_added);
      std::vector<Index> expected = given.pair.loops.source;
      std::erase_if(expected, [&](Index v) { return v >= first_added; });
      ASSERT_EQ(report.met, expected) << given.name;
      ASSERT_EQ(report.target_points.rows(), static_cast<Eigen::Index>(expected.size()));
      for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_EQ(report.target_points.row(static_cast<Eigen::Index>(k)),
                  at(given.pair.target.points, given.correspondence.loop_parameter[expected[k] - 100]))
            << given.name;
    }
  }
}

TEST(ReportPair, LeavesOutAddedVerticesBetweenGivenOnes) {
  for (ReportedPair& given : reported_pairs()) {
    std::vector<Index>& loop = given.pair.loops.source;
    for (std::size_t i = 1; i < loop.size(); i += 2) loop[i] += none_added;
    const PairReport report = report_pair(given.pair, given.correspondence, none_added);
    ASSERT_EQ(report.met.size(), (loop.size() + 1) / 2);
    for (std::size_t k = 0; k < report.met.size(); ++k) {
      EXPECT_EQ(report.met[k], loop[2 * k]);
      EXPECT_EQ(report.target_points.row(static_cast<Eigen::Index>(k)),
                at(given.pair.target.points, given.correspondence.loop_parameter[2 * k]));
    }
  }
}

TEST(ReportPair, IsTheSameAtAnyPoseAndScale) {
  const std::vector<Eigen::Affine3d> maps = test::similarities();
  for (const ReportedPair& given : reported_pairs()) {
    const PairReport expected = report_pair(given.pair, given.correspondence, none_added);
    for (std::size_t k = 0; k < maps.size(); ++k) {
      PairGeometry moved = given.pair;
      moved.source = test::mapped_loop(given.pair.source, maps[k]);
      moved.target = test::mapped_loop(given.pair.target, maps[(k + 1) % maps.size()]);
      const PairReport report = report_pair(moved, given.correspondence, none_added);
      EXPECT_NEAR(report.raggedness_deg, expected.raggedness_deg, 1e-6) << given.name;
      EXPECT_EQ(report.edge_ratio, expected.edge_ratio);
      const double factor =
          std::cbrt(maps[(k + 1) % maps.size()].linear().determinant() / maps[k].linear().determinant());
      EXPECT_NEAR(report.size_ratio, factor * expected.size_ratio, 1e-9 * report.size_ratio) << given.name;
      EXPECT_EQ(report.start.target, expected.start.target);
      EXPECT_EQ(report.met, expected.met);
    }
  }
}

TEST(ReportPair, TellsTheRaggednessOfTheWorseLoop) {
  for (const ReportedPair& given : reported_pairs()) {
    const double before = report_pair(given.pair, given.correspondence, none_added).raggedness_deg;
    for (const bool of_source : {true, false}) {
      PairGeometry ragged = given.pair;
      LoopGeometry& loop = of_source ? ragged.source : ragged.target;
      if (loop.points.rows() < 12) continue;
      const double edge = mean_edge_length(loop.points);
      for (Eigen::Index k = 0; k < loop.points.rows(); k += 2) loop.points(k, 2) += 2 * edge;
      const double after = report_pair(ragged, given.correspondence, none_added).raggedness_deg;
      EXPECT_GT(after, before + 20) << given.name;
      EXPECT_EQ(after, raggedness_deg(loop.points)) << given.name;
    }
  }
}

TEST(MisfitRel, IsZeroOnTheConstraints) {
  for (const test::ClosedCurve& curve : test::closed_curves())
    EXPECT_EQ(misfit_rel(curve.points, constraints_at(curve.points)), 0) << curve.name;
}

TEST(MisfitRel, OfAShiftIsItsLengthOverTheRadius) {
  for (const test::ClosedCurve& curve : test::closed_curves()) {
    const Points centred = curve.points.rowwise() - curve.points.colwise().mean();
    const double radius = std::sqrt(centred.rowwise().squaredNorm().mean());
    for (const double length : {0.001, 0.5, 8.0}) {
      const Points shifted = curve.points.rowwise() + length * Eigen::RowVector3d(2, -1, 2) / 3;
      EXPECT_NEAR(misfit_rel(shifted, constraints_at(curve.points)), length / radius, 1e-12 * length / radius)
          << curve.name;
    }
  }
}

TEST(MisfitRel, OfAScaledLoopIsTheExcess) {
  for (const test::ClosedCurve& curve : test::closed_curves()) {
    const Points centred = curve.points.rowwise() - curve.points.colwise().mean();
    for (const double factor : {0.0, 0.9, 1.5, 4.0})
      EXPECT_NEAR(misfit_rel(factor * centred, constraints_at(centred)), std::abs(factor - 1), 1e-12)
          << curve.name;
  }
}

TEST(MisfitRel, DoesNotDependOnACommonSimilarity) {
  for (const ReportedPair& given : reported_pairs()) {
    const Points& posed = given.pair.source.points;
    Points there(posed.rows(), 3);
    for (Eigen::Index i = 0; i < posed.rows(); ++i)
      there.row(i) =
          at(given.pair.target.points, given.correspondence.loop_parameter[static_cast<std::size_t>(i)]);
    const double misfit = misfit_rel(posed, constraints_at(there));
    EXPECT_GT(misfit, 0);
    for (const Eigen::Affine3d& map : test::similarities())
      EXPECT_NEAR(misfit_rel(test::mapped(posed, map), constraints_at(test::mapped(there, map))), misfit,
                  1e-9 * misfit)
          << given.name;
  }
}

}  // namespace
}  // namespace meshgraft
