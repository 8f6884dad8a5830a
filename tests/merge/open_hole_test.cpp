#include <meshgraft/merge/open_hole.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

namespace meshgraft {
namespace {

using testing::HasSubstr;

double length(const Points& positions, const std::vector<Index>& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    sum += (positions.row(loop[i]) - positions.row(loop[(i + 1) % loop.size()])).norm();
  return sum;
}

Eigen::RowVector3d middle(const Points& positions, const std::vector<Index>& loop) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (const Index v : loop) sum += positions.row(v);
  return sum / static_cast<double>(loop.size());
}

// A part with one loop around z, 1.2 long.
Mesh head() { return make_sample("head", 40); }

std::vector<Index> only_loop(const Mesh& mesh) {
  const auto loops = boundary_loops(mesh);
  EXPECT_EQ(loops.size(), 1U);
  return loops.at(0);
}

std::string error_of(const Mesh& target, const Mesh& source, const std::vector<Index>& loop, const Drop& drop) {
  try {
    open_hole(target, source, loop, drop);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    return error.what();
  }
  return "nothing was refused";
}

const Eigen::Vector3d bar_side(0.5, 0, 2);

TEST(OpenHole, LaysTheLoopOnAFlatPlace) {
  const Mesh bar = make_sample("bar", 12), part = head();
  const std::vector<Index> loop = only_loop(part);
  for (const double size : {0.4, 1.2}) {
    for (const double spin_deg : {0.0, 77.0}) {
      const OpenedHole hole = open_hole(bar, part, loop, {bar_side, size, spin_deg});
      const std::vector<Index>& opened = hole.pair.loops.target;
      EXPECT_EQ(only_loop(hole.target).size(), opened.size());
      EXPECT_EQ(hole.size, size);
      EXPECT_NEAR(length(hole.target.positions, opened), size * length(part.positions, loop),
                  0.04 * size * length(part.positions, loop));
      // Where the matched vertices come to lie: turned from z to x, then spun about x.
      const Eigen::Matrix3d turn =
          (Eigen::AngleAxisd(spin_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitX()) *
           Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()))
              .toRotationMatrix();
      EXPECT_GE(hole.pair.matches.size(), 8U);
      const Match& first = hole.pair.matches.front();
      for (const Match& match : hole.pair.matches) {
        const Eigen::RowVector3d here = part.positions.row(match.source) - part.positions.row(first.source);
        const Eigen::RowVector3d there =
            hole.target.positions.row(match.target) - hole.target.positions.row(first.target);
        EXPECT_LT((there - size * here * turn.transpose()).norm(), 0.05 * size * length(part.positions, loop));
      }
    }
  }
}

TEST(OpenHole, KeepsTheTargetOutsideTheHole) {
  const Mesh bar = make_sample("bar", 12), part = head();
  const OpenedHole hole = open_hole(bar, part, only_loop(part), {bar_side, 1.0});
  ASSERT_EQ(hole.vertex.new_index.size(), static_cast<std::size_t>(bar.vertex_count()));
  const std::vector<Index>& rim = hole.pair.loops.target;
  Index kept = 0;
  for (Index v = 0; v < bar.vertex_count(); ++v) {
    const Index now = hole.vertex.new_index[static_cast<std::size_t>(v)];
    if (now < 0 || std::find(rim.begin(), rim.end(), now) != rim.end()) continue;
    EXPECT_EQ(hole.target.positions.row(now), bar.positions.row(v));
    ++kept;
  }
  EXPECT_GT(kept, bar.vertex_count() / 2);
}

TEST(OpenHole, GivesGraftsWithoutAGap) {
  const Mesh part = head();
  struct Case {
    std::string target;
    int resolution;
    Drop drop;
  };
  const std::vector<Case> cases = {{"bar", 12, {bar_side, 1.0}},
                                   {"bar", 12, {Eigen::Vector3d(0.1, 0.05, 4), 0.8, 120}},
                                   {"torus", 40, {Eigen::Vector3d(1, 0, 0.8), 0.5, 45}},
                                   {"torus", 40, {Index{7}, {}, -200}},
                                   {"octopus", 40, {Index{100}, {}}}};
  for (const Case& c : cases) {
    const Mesh target = make_sample(c.target, c.resolution);
    const OpenedHole hole = open_hole(target, part, only_loop(part), c.drop);
    const MergeResult result = merge_meshes(hole.target, part, {{hole.pair}}, {.size = hole.size});
    const SeamReport& seam = result.report.seam;
    EXPECT_TRUE(seam.manifold && seam.oriented && seam.closed) << c.target;
    EXPECT_EQ(seam.euler_characteristic, summarise_topology(target).euler_characteristic) << c.target;
    EXPECT_EQ(result.report.shape.inverted, 0) << c.target;
    EXPECT_NEAR(result.report.shape.similarity.scale, hole.size, 1e-9) << c.target;
  }
}

TEST(OpenHole, ShrinksAPartThatDoesNotFit) {
  const Mesh bar = make_sample("bar", 12);
  Mesh part = head();
  part.positions *= 10;
  const OpenedHole hole = open_hole(bar, part, only_loop(part), {bar_side});
  EXPECT_LT(hole.size, 0.4);
  ASSERT_EQ(hole.notes.size(), 1U);
  EXPECT_THAT(hole.notes.front(), HasSubstr("the part is scaled by"));
  part.positions *= 0.001;
  EXPECT_EQ(open_hole(bar, part, only_loop(part), {bar_side}).size, 1);
}

TEST(OpenHole, TurnsAPartOverToThePlaceAsLittleAsPossible) {
  // A part that stands on a surface as it stands in its file is not turned.
  const Mesh bar = make_sample("bar", 12), part = head();
  const std::vector<Index> loop = only_loop(part);
  const OpenedHole hole = open_hole(bar, part, loop, {Eigen::Vector3d(0, 0, 4), 0.8});
  const Eigen::RowVector3d here = middle(part.positions, loop),
                           there = middle(hole.target.positions, hole.pair.loops.target);
  for (const Match& match : hole.pair.matches) {
    const Eigen::RowVector3d from = part.positions.row(match.source) - here,
                             to = hole.target.positions.row(match.target) - there;
    EXPECT_GT(from.dot(to), 0.95 * from.norm() * to.norm());
  }
}

TEST(OpenHole, RefusesWhatCannotBeOpened) {
  const Mesh bar = make_sample("bar", 12), sheet = make_sample("bumpy_plane", 20),
             tube = make_sample("cylinder", 20), part = head();
  const std::vector<Index> loop = only_loop(part);
  EXPECT_THAT(error_of(bar, part, loop, {Index{1000000}}), HasSubstr("target vertex 1000000 does not exist"));
  EXPECT_THAT(error_of(bar, part, loop, {Eigen::Vector3d(9, 0, 0)}),
              HasSubstr("away from the target's surface"));
  EXPECT_THAT(error_of(bar, part, loop, {bar_side, -1.0}), HasSubstr("not a positive number"));
  EXPECT_THAT(error_of(bar, part, {0, 1, 2}, {bar_side}), HasSubstr("source"));
  EXPECT_THAT(error_of(bar, part, loop, {bar_side, 100.0}), HasSubstr("larger than the surface"));
  EXPECT_THAT(error_of(make_sample("torus", 40), part, loop, {Eigen::Vector3d(1.4, 0, 0.4), 6.0}),
              HasSubstr("no disc"));
  EXPECT_THAT(error_of(sheet, part, loop, {boundary_loops(sheet).at(0).at(3)}), HasSubstr("the boundary"));
  EXPECT_THAT(error_of(tube, part, loop, {Eigen::Vector3d(0.5, 0, 3.9), 1.0}), HasSubstr("the boundary"));
  EXPECT_THAT(error_of(bar, bar, loop, {bar_side}), HasSubstr("has no boundary loop"));
}

}  // namespace
}  // namespace meshgraft
