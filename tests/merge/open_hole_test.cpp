
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/open_hole.h"

namespace meshgraft {
namespace {

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

// Returns a part with one loop around z, 1.2 long.
Mesh head() { return make_sample("head", 24); }

std::vector<Index> only_loop(const Mesh& mesh) {
  const auto loops = boundary_loops(mesh);
  EXPECT_EQ(loops.size(), 1U);
  return loops.at(0);
}

// Returns the drop with the source's loop that meets the surface.
Drop meeting_by(const std::vector<Index>& loop, Drop drop) {
  drop.source_loop = loop;
  return drop;
}

std::optional<Error> refusal_of(const Mesh& target, const Mesh& source, const std::vector<Index>& loop,
                                const Drop& drop) {
  try {
    open_hole(target, source, meeting_by(loop, drop));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    return error;
  }
  return std::nullopt;
}

// Returns the id of the note that gives a refusal's reason, or that of the refusal itself.
std::string cause_of(const Mesh& target, const Mesh& source, const std::vector<Index>& loop, const Drop& drop) {
  const std::optional<Error> refusal = refusal_of(target, source, loop, drop);
  if (!refusal) return "nothing was refused";
  return std::string(refusal->notes().empty() ? refusal->id() : refusal->notes().front().id());
}

const Eigen::Vector3d bar_side(0.5, 0, 2);

TEST(OpenHole, LaysTheLoopOnAFlatPlace) {
  const Mesh bar = make_sample("bar", 12), part = head();
  const std::vector<Index> loop = only_loop(part);
  for (const double size : {0.4, 1.2}) {
    for (const double spin_deg : {0.0, 77.0}) {
      const OpenedHole hole = open_hole(bar, part, meeting_by(loop, {bar_side, size, spin_deg}));
      const std::vector<Index>& opened = hole.pair.loops.target;
      EXPECT_EQ(only_loop(hole.target).size(), opened.size());
      EXPECT_EQ(hole.size, size);
      EXPECT_NEAR(length(hole.target.positions, opened), size * length(part.positions, loop),
                  0.04 * size * length(part.positions, loop));
      // The matched target vertices are the source's, turned from z to x and then spun about x.
      const Eigen::Matrix3d turn =
          (Eigen::AngleAxisd(spin_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitX()) *
           Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()))
              .toRotationMatrix();
      EXPECT_GE(hole.pair.matches.size(), 6U);
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

TEST(OpenHole, APartStandsWhereItsHoleIs) {
  const Mesh bar = make_sample("bar", 12), part = head();
  const std::vector<Index> loop = only_loop(part);
  const DropGuide guide(std::make_shared<const Mesh>(bar), part, std::vector<std::vector<Index>>{loop});
  for (const double size : {0.4, 1.2}) {
    const Drop drop{bar_side, size, 77.0};
    const Eigen::Affine3d pose = guide.pose(drop);
    EXPECT_NEAR(pose.linear().determinant(), std::pow(size, 3), 1e-9);
    EXPECT_LT((pose.linear() * Eigen::Vector3d::UnitZ() - size * Eigen::Vector3d::UnitX()).norm(), 0.01 * size);
    const OpenedHole hole = open_hole(bar, part, meeting_by(loop, drop));
    for (const Match& match : hole.pair.matches) {
      const Eigen::Vector3d here = pose * Eigen::Vector3d(part.positions.row(match.source));
      EXPECT_LT((here - hole.target.positions.row(match.target).transpose()).norm(),
                0.05 * size * length(part.positions, loop));
    }
  }
  EXPECT_THROW(guide.pose({Eigen::Vector3d(9, 9, 9)}), Error);
  EXPECT_THROW(guide.pose({bar_side, -1.0}), Error);
  EXPECT_THROW(DropGuide(std::make_shared<const Mesh>(bar), part, std::vector<std::vector<Index>>{{0, 1}}),
               Error);
}

TEST(OpenHole, KeepsTheTargetOutsideTheHole) {
  const Mesh bar = make_sample("bar", 12), part = head();
  const OpenedHole hole = open_hole(bar, part, meeting_by(only_loop(part), {bar_side, 1.0}));
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
                                   {"torus", 24, {Eigen::Vector3d(1, 0, 0.8), 0.5, 45}},
                                   {"torus", 24, {Index{7}, {}, -200}},
                                   {"octopus", 28, {Index{100}, {}}}};
  for (const Case& c : cases) {
    const Mesh target = make_sample(c.target, c.resolution);
    const OpenedHole hole = open_hole(target, part, meeting_by(only_loop(part), c.drop));
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
  const OpenedHole hole = open_hole(bar, part, meeting_by(only_loop(part), {bar_side}));
  EXPECT_LT(hole.size, 0.4);
  ASSERT_EQ(hole.notes.size(), 2U);
  EXPECT_EQ(hole.notes[0].id(), "merge.source_scaled");
  EXPECT_EQ(hole.notes[0].get<double>("size"), hole.size);
  EXPECT_GT(hole.notes[1].get<double>("size"), hole.size) << hole.notes[1].text();
  part.positions *= 0.001;
  EXPECT_EQ(open_hole(bar, part, meeting_by(only_loop(part), {bar_side})).size, 1);
}

TEST(OpenHole, TurnsAPartOverToThePlaceAsLittleAsPossible) {
  // On a surface that faces +z a part keeps the orientation that it has in its file.
  const Mesh bar = make_sample("bar", 12), part = head();
  const std::vector<Index> loop = only_loop(part);
  const OpenedHole hole = open_hole(bar, part, meeting_by(loop, {Eigen::Vector3d(0, 0, 4), 0.8}));
  const Eigen::RowVector3d here = middle(part.positions, loop),
                           there = middle(hole.target.positions, hole.pair.loops.target);
  for (const Match& match : hole.pair.matches) {
    const Eigen::RowVector3d from = part.positions.row(match.source) - here,
                             to = hole.target.positions.row(match.target) - there;
    EXPECT_GT(from.dot(to), 0.95 * from.norm() * to.norm());
  }
}

// Returns the largest size that a refusal names, or 0 if it names none.
double size_that_fits(const std::optional<Error>& refusal) {
  return refusal && refusal->id() == "merge.no_hole" ? refusal->fact().get<double>("largest") : 0;
}

TEST(OpenHole, NamesTheLargestSizeThatFits) {
  const Mesh part = head();
  const std::vector<Index> loop = only_loop(part);
  const std::vector<std::pair<Mesh, Eigen::Vector3d>> cases = {{make_sample("bar", 12), bar_side},
                                                               {make_sample("torus", 30), {1.4, 0, 0.4}},
                                                               {make_sample("bumpy_plane", 24), {0.3, 0.1, 0}},
                                                               {make_sample("cactus", 24), {0, 0, 2.7}}};
  for (const auto& [target, place] : cases) {
    for (const double size : {6.0, 1e6}) {
      const std::optional<Error> refusal = refusal_of(target, part, loop, {place, size});
      const double fitting = size_that_fits(refusal);
      ASSERT_GT(fitting, 0) << (refusal ? refusal->what() : "nothing was refused");
      EXPECT_EQ(open_hole(target, part, meeting_by(loop, {place, fitting})).size, fitting);
      EXPECT_GT(size_that_fits(refusal_of(target, part, loop, {place, 1.3 * fitting})), 0);
    }
  }
}

TEST(OpenHole, FindsRoomOrTellsAllOverASurface) {
  // At every vertex the hole is a disc of the loop's size, and the part can be merged there. Only the tips of
  // cones are too narrow at any size.
  const Mesh part = head();
  int refused = 0;
  const std::vector<Index> loop = only_loop(part);
  for (const char* name : {"cactus", "octopus", "bust"}) {
    const Mesh target = make_sample(name, 24);
    const Index euler = summarise_topology(target).euler_characteristic;
    std::vector<bool> on_boundary(static_cast<std::size_t>(target.vertex_count()), false);
    for (const auto& boundary : boundary_loops(target))
      for (const Index v : boundary) on_boundary[v] = true;
    for (Index k = 1; k <= 3; ++k) {
      const Index v = k * target.vertex_count() / 4;
      if (on_boundary[v]) {
        EXPECT_EQ(cause_of(target, part, loop, {v}), "merge.vertex_on_boundary");
        continue;
      }
      OpenedHole hole;
      try {
        hole = open_hole(target, part, meeting_by(loop, {v}));
      } catch (const Error& error) {
        EXPECT_EQ(error.id(), "merge.no_hole_at_any_size") << name << " at " << v;
        ASSERT_EQ(error.notes().size(), 1U) << name << " at " << v;
        EXPECT_EQ(error.notes()[0].id(), "merge.surface_too_narrow") << name << " at " << v;
        ++refused;
        continue;
      }
      EXPECT_LE(hole.size, 1);
      EXPECT_EQ(hole.size < 1, !hole.notes.empty() && hole.notes.front().id() == "merge.source_scaled");
      EXPECT_NEAR(length(hole.target.positions, hole.pair.loops.target),
                  hole.size * length(part.positions, loop), 0.35 * hole.size * length(part.positions, loop))
          << name << " at " << v;
      EXPECT_EQ(summarise_topology(hole.target).euler_characteristic, euler - 1) << name << " at " << v;
      const MergeResult result = merge_meshes(hole.target, part, {{hole.pair}}, {.size = hole.size});
      EXPECT_TRUE(result.report.seam.manifold && result.report.seam.oriented) << name << " at " << v;
      EXPECT_EQ(result.report.seam.euler_characteristic, euler) << name << " at " << v;
    }
  }
  EXPECT_LE(refused, 1);
}

TEST(OpenHole, ShrinksAPartThatWouldReachIntoTheTarget) {
  // In a corner of two walls the head would reach into a wall, since it is wider than its neck.
  Mesh corner = make_sample("bumpy_plane", 40);
  for (auto point : corner.positions.rowwise())
    point = Eigen::RowVector3d(std::min(point.x(), 0.0), point.y(), std::max(point.x(), 0.0));
  Mesh part = head();
  part.positions *= 0.35;
  const std::vector<Index> loop = only_loop(part);
  const OpenedHole hole = open_hole(corner, part, meeting_by(loop, {Eigen::Vector3d(-0.1, 0, 0)}));
  EXPECT_LT(hole.size, 1);
  EXPECT_TRUE(hole.clear);
  ASSERT_EQ(hole.notes.size(), 2U);
  EXPECT_EQ(hole.notes[0].id(), "merge.source_scaled");
  EXPECT_EQ(hole.notes[1].id(), "merge.source_would_reach_in");
  const OpenedHole asked = open_hole(corner, part, meeting_by(loop, {Eigen::Vector3d(-0.1, 0, 0), 1.0}));
  EXPECT_FALSE(asked.clear);
  ASSERT_EQ(asked.notes.size(), 1U);
  EXPECT_EQ(asked.notes.front().id(), "merge.intersection_avoided_if_smaller");
}

TEST(DropPart, GraftsOnAClosedTargetAndMapsItsVertices) {
  const Mesh part = head();
  for (const char* name : {"bar", "cactus"}) {
    const Mesh target = make_sample(name, 20);
    const Index top = [&] {
      Eigen::Index highest = 0;
      target.positions.col(2).maxCoeff(&highest);
      return static_cast<Index>(highest);
    }();
    const Drop drop{std::string(name) == "bar" ? Drop{bar_side} : Drop{top, 0.3}};
    const DropResult result = drop_source(target, part, meeting_by(only_loop(part), drop));
    EXPECT_TRUE(result.merge.report.seam.manifold && result.merge.report.seam.oriented) << name;
    EXPECT_EQ(result.merge.report.seam.euler_characteristic, summarise_topology(target).euler_characteristic);
    EXPECT_EQ(result.merge.report.shape.inverted, 0);
    EXPECT_FALSE(result.intersections.any_new()) << name;
    ASSERT_TRUE(result.options.size.has_value());
    EXPECT_EQ(*result.options.size, drop.size.value_or(1));
    ASSERT_EQ(result.merge.target.new_index.size(), static_cast<std::size_t>(target.vertex_count()));
    // Most target vertices keep their position under a new index.
    Index unmoved = 0;
    for (Index v = 0; v < target.vertex_count(); ++v) {
      const Index now = result.merge.target.new_index[v];
      unmoved += now >= 0 && result.merge.mesh.positions.row(now) == target.positions.row(v) ? 1 : 0;
    }
    EXPECT_GT(unmoved, target.vertex_count() / 2) << name;
  }
}

TEST(OpenHole, RefusesWhatCannotBeOpened) {
  const Mesh bar = make_sample("bar", 12), sheet = make_sample("bumpy_plane", 20),
             tube = make_sample("cylinder", 20), part = head();
  const std::vector<Index> loop = only_loop(part);
  EXPECT_EQ(cause_of(bar, part, loop, {Index{1000000}}), "merge.no_such_surface_vertex");
  EXPECT_EQ(cause_of(bar, part, loop, {Eigen::Vector3d(9, 0, 0)}), "merge.point_off_surface");
  EXPECT_EQ(cause_of(bar, part, loop, {bar_side, -1.0}), "core.not_positive");
  const std::optional<Error> refusal = refusal_of(bar, part, {0, 1, 2}, {bar_side});
  ASSERT_TRUE(refusal.has_value());
  EXPECT_EQ(refusal->fact().get<std::string>("side"), "source");
  EXPECT_EQ(cause_of(bar, part, loop, {bar_side, 1e9}), "merge.loop_larger_than_target");
  const std::optional<Error> huge = refusal_of(bar, part, loop, {bar_side, 1e9});
  EXPECT_EQ(huge->notes().front().text(), "the source's loop is larger than the target, at size 1e+09");
  EXPECT_EQ(cause_of(bar, part, loop, {bar_side, 1e-12}), "merge.size_too_small");
  EXPECT_EQ(cause_of(bar, part, loop, {bar_side, std::nan("")}), "core.not_positive");
  EXPECT_EQ(cause_of(make_sample("torus", 24), part, loop, {Eigen::Vector3d(1.4, 0, 0.4), 6.0}),
            "merge.hole_not_disc");
  EXPECT_EQ(cause_of(sheet, part, loop, {boundary_loops(sheet).at(0).at(3)}), "merge.vertex_on_boundary");
  EXPECT_EQ(cause_of(tube, part, loop, {Eigen::Vector3d(0.5, 0, 3.9), 1.0}), "merge.hole_reaches_boundary");
  EXPECT_EQ(cause_of(bar, bar, loop, {bar_side}), "merge.no_boundary_loop");
}

}  // namespace
}  // namespace meshgraft
