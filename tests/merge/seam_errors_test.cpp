
#include <cmath>
#include <limits>
#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>

#include "merge/seam.h"
#include "merge/seam_grafts.h"

namespace meshgraft::test {
namespace {

void expect_refused(const Mesh& target, const Mesh& source, std::vector<LoopPair> pairs,
                    const SeamOptions& options, const std::string& id, const std::string& words = {}) {
  try {
    make_seam(target, source, pairs, options);
    FAIL() << "accepted: " << id;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    EXPECT_EQ(error.id(), id) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Seam, RefusesWhatItCannotJoin) {
  const Graft good = tubes(24, 24, true);
  const auto& [source, target] = good.pairs[0];
  const auto refused = [&](const LoopPair& pair, const std::string& id, const std::string& words = {}) {
    expect_refused(good.target, good.source, {pair}, {}, id, words);
  };
  refused({source, {1, 2}}, "merge.loop_too_short");
  refused({source, {0, 1, 9999}}, "merge.no_such_vertex", "target vertex 9999");
  refused({source, {0, 1, -1}}, "merge.no_such_vertex", "target vertex -1");
  refused({source, std::vector<Index>(target.rbegin(), target.rend())}, "merge.loop_runs_backwards");
  refused({source, {30, 31, 32}}, "merge.no_boundary_edge");
  std::vector<Index> twice = target;
  twice.insert(twice.end(), target.begin(), target.end());
  refused({source, twice}, "merge.loop_passes_twice");
  std::vector<Index> part(target.begin(), target.end() - 1);
  refused({source, part}, "merge.no_boundary_edge", "target");
  refused({part, target}, "merge.no_boundary_edge", "source");
  expect_refused(good.target, good.source, {good.pairs[0], good.pairs[0]}, {}, "merge.loops_meet");

  expect_refused(good.target, good.source, good.pairs, {.edge_ratio = 0.5}, "merge.edge_ratio_below_one");
  expect_refused(good.target, good.source, good.pairs, {.fairings = -1}, "core.negative");
  expect_refused(good.target, good.source, good.pairs, {.target_rings = -1}, "core.negative");
  expect_refused(good.target, good.source, good.pairs, {.sharp_angle_deg = std::nan("")}, "core.out_of_range");
  expect_refused(good.target, good.source, good.pairs, {.blend_colours = -1}, "core.negative");

  Graft bad = good;
  bad.source.positions(3, 1) = std::numeric_limits<double>::quiet_NaN();
  expect_refused(bad.target, bad.source, bad.pairs, {}, "merge.vertex_not_finite", "source vertex 3");
  bad = good;
  bad.source.positions(30, 1) = std::numeric_limits<double>::infinity();
  expect_refused(bad.target, bad.source, bad.pairs, {}, "merge.seam_vertex_not_finite");
}

// A loop whose vertices all lie at one point gives a poor seam, but a manifold and finite one.
TEST(Seam, SurvivesLoopsWithoutLength) {
  for (const bool of_target : {false, true}) {
    Graft graft = tubes(12, 12, true);
    Mesh& mesh = of_target ? graft.target : graft.source;
    for (const Index v : of_target ? graft.pairs[0].target : graft.pairs[0].source) {
      mesh.positions.row(v) = Eigen::RowVector3d(0, 0, 3);
    }
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    EXPECT_TRUE(result.report.manifold);
    EXPECT_TRUE(result.mesh.positions.allFinite());
  }
}

TEST(Seam, StopsWhenAsked) {
  const Graft graft = tubes(24, 24, true);
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  try {
    make_seam(graft.target, graft.source, graft.pairs, {}, context);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace meshgraft::test
