// Laws of merging: what was cut is grafted back, and nothing else changes.
#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/grafts.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

Mesh posed(Mesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
  turn.normalize();
  const double scale = std::exp(normal(random));
  const Eigen::RowVector3d shift(normal(random), normal(random), normal(random));
  const auto map = [&](auto row) { return Eigen::RowVector3d(row * turn.toRotationMatrix().transpose()); };
  for (auto row : mesh.positions.rowwise()) row = scale * map(row) + 3 * shift;
  for (Attribute& attribute : mesh.attributes) {
    if (attribute.name != cut_normal_name) continue;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      Eigen::Map<Eigen::RowVector3d> value(attribute.values.data() + std::ptrdiff_t{3} * v);
      value = map(Eigen::RowVector3d(value));
    }
  }
  return mesh;
}

// Returns grafts with one or several loops, and of positive genus.
std::vector<Graft> grafts_back() {
  return {cut_sample("cactus", 28, {0, 0, 1.3}, {0.2, 0.1, 1}),
          cut_sample("dinosaur", 34, {-1, 0, 0}, {-1, 0.1, 0.2}),
          cut_sample("octopus", 40, {0, 0, 0.8}, {0, 0.1, 1}), cut_sample("head", 28, {0, 0, 0}, {0.1, 0.2, 1}),
          cut_sample("torus", 30, {0.1, 0, 0}, {1, 0.2, 0.3})};
}

void drop_cut_normals(Mesh& mesh) {
  std::erase_if(mesh.attributes, [](const Attribute& attribute) { return attribute.name == cut_normal_name; });
}

TEST(Merge, GraftsBackWhatWasCut) {
  for (const Graft& graft : grafts_back()) {
    ASSERT_FALSE(graft.pairs.empty()) << graft.name;
    for (const MergeShape shape : {MergeShape::ft05, MergeShape::similar}) {
      const MergeResult result =
          merge_meshes(graft.target, posed(graft.source, 3), graft.pairs, {.shape = shape});
      const double size = diagonal(graft.source.positions);
      EXPECT_LT(largest_distance(result.grafted, graft.source.positions), 1e-9 * size)
          << graft.name << " by " << to_string(shape);
      for (std::size_t p = 0; p < graft.pairs.size(); ++p) {
        const PairReport& pair = result.report.pairs[p];
        EXPECT_LT(pair.misfit_rel, 1e-9) << graft.name;
        EXPECT_EQ(pair.met.size(), graft.pairs[p].loops.source.size());
        for (std::size_t i = 0; i < pair.met.size(); ++i)
          EXPECT_LT(
              (pair.target_points.row(static_cast<Eigen::Index>(i)) - graft.source.positions.row(pair.met[i]))
                  .norm(),
              1e-9 * size)
              << graft.name;
      }
      EXPECT_TRUE(result.report.seam.manifold && result.report.seam.oriented) << graft.name;
      EXPECT_EQ(result.report.seam.closed, graft.closed) << graft.name;
      // Away from the seam the result is the uncut surface.
      std::vector<std::uint8_t> in_band(static_cast<std::size_t>(result.mesh.vertex_count()), 0);
      for (const Index v : result.band) in_band[v] = 1;
      for (Index v = 0; v < graft.source.vertex_count(); ++v) {
        const Index to = result.source.new_index[v];
        if (to < 0 || in_band[to]) continue;
        EXPECT_LT((result.mesh.positions.row(to) - graft.source.positions.row(v)).norm(), 1e-9 * size);
      }
    }
  }
}

TEST(Merge, GraftsBackNearlyWithEstimatedNormals) {
  for (Graft graft : grafts_back()) {
    drop_cut_normals(graft.target);
    drop_cut_normals(graft.source);
    for (const MergeShape shape : {MergeShape::ft05, MergeShape::similar}) {
      const MergeResult result =
          merge_meshes(graft.target, posed(graft.source, 4), graft.pairs, {.shape = shape});
      EXPECT_LT(largest_distance(result.grafted, graft.source.positions),
                (shape == MergeShape::ft05 ? 0.06 : 0.05) * diagonal(graft.source.positions))
          << graft.name << " by " << to_string(shape);
    }
  }
}

TEST(Merge, DoesNotDependOnThePoseOfTheSource) {
  Graft graft = head_on_bust();
  // A source in another pose has its up and front elsewhere, so the start is given.
  graft.pairs[0].matches = {find_starts(graft.target, graft.source, graft.pairs)[0][0].start};
  for (const MergeShape shape : {MergeShape::ft05, MergeShape::similar}) {
    for (const DeformMethod method :
         {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
      MergeOptions options{.shape = shape};
      options.deformer.method = method;
      const MergeResult first = merge_meshes(graft.target, graft.source, graft.pairs, options);
      for (const unsigned seed : {1U, 2U}) {
        const MergeResult again = merge_meshes(graft.target, posed(graft.source, seed), graft.pairs, options);
        EXPECT_LT(largest_distance(first.grafted, again.grafted), 1e-9 * diagonal(first.grafted))
            << to_string(shape) << ", " << to_string(method);
        EXPECT_LT(largest_distance(first.mesh.positions, again.mesh.positions), 1e-9 * diagonal(first.grafted));
        EXPECT_EQ(first.mesh.faces, again.mesh.faces);
      }
    }
  }
}

TEST(Merge, PairsMayComeInAnyOrder) {
  Graft graft = cut_sample("torus", 30, {0.1, 0, 0}, {1, 0.2, 0.3});
  ASSERT_EQ(graft.pairs.size(), 2U);
  const MergeResult first = merge_meshes(graft.target, graft.source, graft.pairs);
  std::swap(graft.pairs[0], graft.pairs[1]);
  const MergeResult second = merge_meshes(graft.target, graft.source, graft.pairs);
  EXPECT_LT(largest_distance(first.grafted, second.grafted), 1e-12 * diagonal(first.grafted));
  EXPECT_EQ(first.report.seam.euler_characteristic, 0);
  EXPECT_EQ(second.report.seam.euler_characteristic, 0);
}

TEST(Merge, LeavesTheTargetAloneOutsideTheBand) {
  const Graft graft = head_on_bust();
  for (const int rings : {0, 3}) {
    MergeOptions options;
    options.seam.target_rings = rings;
    const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, options);
    const std::vector<Index> near = grow_rings(graft.pairs[0].loops.target, rings + 1,
                                               vertex_rings(graft.target.vertex_count(), graft.target.faces));
    for (Index v = 0; v < graft.target.vertex_count(); ++v) {
      const Index to = result.target.new_index[v];
      if (to < 0 || graft.target.positions.row(v) == result.mesh.positions.row(to)) continue;
      EXPECT_TRUE(rings > 0 && std::binary_search(near.begin(), near.end(), v)) << v;
    }
  }
}

TEST(Merge, TheFarPartKeepsItsShape) {
  const Graft graft = head_on_bust();
  const MergeResult similar = merge_meshes(graft.target, graft.source, graft.pairs);
  EXPECT_LT(similar.report.shape.distance_rel, 1e-9);
  EXPECT_EQ(similar.report.shape.inverted, 0);
  EXPECT_GT(similar.report.shape.smallest_singular_p5, 0.5);
  const MergeResult linear = merge_meshes(graft.target, graft.source, graft.pairs, {.shape = MergeShape::ft05});
  EXPECT_GT(linear.report.shape.distance_rel, 1e-4);  // the loops differ, so it shears the source
}

TEST(Merge, BendsPartsOfFewRows) {
  for (const bool plate : {true, false})
    for (const Index rows : {2, 3, 5})
      for (const Index around : {8, 16, 40})
        for (const double tilt_deg : {0.0, plate ? 45.0 : 60.0}) {
          const Mesh target = holed(rows == 2 ? 0.5 : 2, tilt_deg, plate), source = peg(rows, around);
          const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
          const MergeResult result = merge_meshes(target, source, {{pair}});
          const std::string what =
              fmt::format("{} rows of {} on a {} at {}°", rows, around, plate ? "plate" : "tube", tilt_deg);
          EXPECT_EQ(result.report.shape.inverted, 0) << what;
          EXPECT_GE(result.report.shape.smallest_singular_p5, 0.5) << what;
          EXPECT_TRUE(result.report.seam.manifold && result.report.seam.oriented) << what;
          EXPECT_LT(result.report.seam.dihedral_p99_deg, 80) << what;
          EXPECT_EQ(result.grafted.rows(), source.vertex_count());
          EXPECT_EQ(result.source.new_index.size(), static_cast<std::size_t>(source.vertex_count()));
          // The source stands upright on the hole.
          const Eigen::Vector3d up = result.report.shape.similarity.rotation.col(2);
          const double slope = tilt_deg * std::numbers::pi / 180;
          EXPECT_GT(up.dot(Eigen::Vector3d(-std::sin(slope), 0, std::cos(slope))), std::cos(0.6)) << what;
        }
}

TEST(Merge, RefinesTheCoarserSide) {
  for (const auto& [target_resolution, source_resolution] : {std::pair(60, 24), std::pair(24, 60)}) {
    Graft graft{"", make_sample("bust", target_resolution), make_sample("head", source_resolution), {}};
    graft.pairs = {{{boundary_loops(graft.source).at(0), boundary_loops(graft.target).at(0)}, {}}};
    const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs);
    EXPECT_GT(result.report.source_vertices_added + result.report.seam.new_faces, 0);
    EXPECT_EQ(result.report.source_vertices_added > 0, source_resolution < target_resolution);
    EXPECT_LT(result.report.seam.source_edge_ratio, 2.2);
    EXPECT_GT(result.report.seam.source_edge_ratio, 1 / 2.2);
    EXPECT_TRUE(result.report.seam.closed && result.report.seam.manifold);
    EXPECT_EQ(result.grafted.rows(), graft.source.vertex_count());
  }
}

TEST(Merge, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  const Graft graft = head_on_bust(24);
  EXPECT_THROW(merge_meshes(graft.target, graft.source, graft.pairs, {}, context), Error);
}

TEST(Merge, TakesTheMostProbableStart) {
  Graft tubes{"tubes", make_sample("cylinder", 24), make_sample("cylinder", 16), {}};
  tubes.pairs = {{{boundary_loops(tubes.source).at(0), boundary_loops(tubes.target).at(1)}, {}}};
  for (Graft graft : {tubes, head_on_bust(24)}) {
    SCOPED_TRACE(graft.name);
    graft.pairs[0].matches.clear();
    const std::vector<StartCandidate> starts = find_starts(graft.target, graft.source, graft.pairs).at(0);
    ASSERT_FALSE(starts.empty());
    EXPECT_LE(starts.size(), 5U);
    const MergeResult found = merge_meshes(graft.target, graft.source, graft.pairs);
    const PairReport& pair = found.report.pairs[0];
    EXPECT_EQ(pair.confidence, starts[0].probability);
    ASSERT_EQ(pair.starts.size(), starts.size());
    EXPECT_EQ(starts[0].turn_deg, 0);
    for (std::size_t k = 0; k < starts.size(); ++k) {
      EXPECT_EQ(pair.starts[k].start.target, starts[k].start.target);
      if (k > 0) EXPECT_LE(starts[k].probability, starts[k - 1].probability);
      // Each start can be given, and gives what it says.
      graft.pairs[0].matches = {starts[k].start};
      const MergeResult given = merge_meshes(graft.target, graft.source, graft.pairs);
      EXPECT_TRUE(given.report.pairs[0].starts.empty());
      if (k == 0) EXPECT_EQ(given.mesh.positions, found.mesh.positions);
      const double turn = Eigen::AngleAxisd(given.report.shape.similarity.rotation *
                                            found.report.shape.similarity.rotation.transpose())
                              .angle();
      EXPECT_NEAR(turn * 180 / std::numbers::pi, std::abs(starts[k].turn_deg), 12);
    }
  }
}

// Two sides of one cut fit in one way, whatever is guessed of the models.
TEST(Merge, StartsOfTheSidesOfOneCutDoNotDependOnTheOrientations) {
  for (Graft graft : grafts_back()) {
    if (graft.pairs.size() > 1) continue;
    SCOPED_TRACE(graft.name);
    for (const auto& [up, front] : {std::pair(Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, -1, 0)),
                                    std::pair(Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0)),
                                    std::pair(Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, 1, 0))}) {
      MergeOptions options;
      options.source_orientations = {{make_orientation(up, front)}};
      const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, options);
      EXPECT_LT(largest_distance(result.grafted, graft.source.positions),
                1e-6 * diagonal(graft.source.positions));
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
