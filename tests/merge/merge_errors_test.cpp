// A merge refuses wrong input by name, and notes doubtful results.
#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/cut_halves.h"
#include "merge/grafts.h"
#include "mesh/shapes.h"
#include "mesh/winding.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

std::optional<Error> refusal_of(const Graft& graft, const MergeOptions& options = {}) {
  try {
    merge_meshes(graft.target, graft.source, graft.pairs, options);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

// Returns the id of a refusal, followed by its side if it has one. Returns "" if nothing was refused.
std::string cause_of(const Graft& graft, const MergeOptions& options = {}) {
  const std::optional<Error> refusal = refusal_of(graft, options);
  if (!refusal) return "";
  std::string cause(refusal->id());
  for (const FieldType& field : refusal->fact().type().fields)
    if (field.name == "side") cause += " " + refusal->fact().get<std::string>("side");
  return cause;
}

TEST(MergeErrors, NameWhatIsWrong) {
  const Graft good = head_on_bust(24);
  Graft bad = good;
  bad.pairs.clear();
  EXPECT_EQ(cause_of(bad), "merge.no_pairs");

  bad = good;
  bad.source = make_sample("cactus", 24);
  EXPECT_EQ(cause_of(bad), "merge.no_boundary_loop source");

  bad = good;
  bad.target = make_sample("cactus", 24);
  EXPECT_EQ(cause_of(bad), "merge.no_boundary_loop target");

  bad = good;
  bad.pairs[0].loops.source.pop_back();
  EXPECT_EQ(cause_of(bad), "merge.loop_not_listed_whole source");
  EXPECT_EQ(refusal_of(bad)->fact().get<std::int64_t>("listed") + 1,
            refusal_of(bad)->fact().get<std::int64_t>("count"));

  bad = good;
  std::swap(bad.pairs[0].loops.source[3], bad.pairs[0].loops.source[7]);
  EXPECT_EQ(cause_of(bad), "merge.loop_not_listed_in_order source");

  bad = good;
  const std::vector<std::uint8_t> on_loop = [&] {
    std::vector<std::uint8_t> flags(static_cast<std::size_t>(good.source.vertex_count()), 0);
    for (const Index v : good.pairs[0].loops.source) flags[v] = 1;
    return flags;
  }();
  const auto inner = static_cast<Index>(std::find(on_loop.begin(), on_loop.end(), 0) - on_loop.begin());
  bad.pairs[0].loops.source[0] = inner;
  EXPECT_EQ(cause_of(bad), "merge.vertex_not_on_boundary source");
  EXPECT_EQ(refusal_of(bad)->fact().get<std::int64_t>("vertex"), inner);
  bad.pairs[0].loops.source[0] = 1 << 20;
  EXPECT_EQ(cause_of(bad), "merge.no_such_vertex source");

  bad = good;
  bad.pairs.push_back(bad.pairs[0]);
  EXPECT_EQ(cause_of(bad), "merge.loop_named_twice source");

  // Matched vertices must follow each other in opposite directions on the two loops, so these matches cross.
  bad = good;
  const auto& s = good.pairs[0].loops.source;
  const auto& t = good.pairs[0].loops.target;
  bad.pairs[0].matches = {{s[0], t[0]}, {s[5], t[5]}, {s[10], t[10]}};
  EXPECT_EQ(cause_of(bad), "merge.matches_cross");
  bad.pairs[0].matches = {{s[0], t[0]}, {s[5], t[0]}};
  EXPECT_EQ(cause_of(bad), "merge.target_matched_twice");
  bad.pairs[0].matches = {{s[0], t[0]}, {s[0], t[5]}};
  EXPECT_EQ(cause_of(bad), "merge.source_matched_twice");
  bad.pairs[0].matches = {{inner, t[0]}};
  EXPECT_EQ(cause_of(bad), "merge.match_not_on_loop source");

  bad = good;  // a second component of the source without a pair
  const Mesh lone = make_sample("cylinder", 8);
  const Index offset = bad.source.vertex_count();
  Points positions(offset + lone.vertex_count(), 3);
  positions << bad.source.positions, lone.positions;
  bad.source.positions = positions;
  bad.source.attributes.clear();
  for (Index f = 0; f < lone.face_count(); ++f) {
    std::vector<Index> face(lone.faces[f].begin(), lone.faces[f].end());
    for (Index& v : face) v += offset;
    bad.source.faces.push_back(face);
  }
  EXPECT_EQ(cause_of(bad), "merge.component_without_pair");
  EXPECT_EQ(refusal_of(bad)->fact().get<std::int64_t>("component"), 1);

  bad = good;
  for (const Index v : good.pairs[0].loops.source) bad.source.positions.row(v).setConstant(0.25);
  EXPECT_EQ(cause_of(bad), "merge.loop_without_length source");

  EXPECT_EQ(cause_of(good, {.size = -1}), "core.not_positive");
  EXPECT_EQ(cause_of(good, {.reach = {.rings = 0, .length = {}}}), "merge.reach_less_than_one_ring");
  EXPECT_EQ(cause_of(good, {.fixed = {0}}), "merge.fixed_while_pose_found");
}

TEST(MergeErrors, InwardFacesAreNamedOrTurned) {
  Graft graft = head_on_bust(24);
  const MergeResult expected = merge_meshes(graft.target, graft.source, graft.pairs);
  graft.source = turned_over(graft.source);
  ASSERT_EQ(cause_of(graft), "merge.orientations_disagree");
  EXPECT_EQ(refusal_of(graft)->fact().get<std::string>("inward"), "source");
  const MergeResult turned = merge_meshes(graft.target, graft.source, graft.pairs, {.fix_winding = true});
  EXPECT_LT(largest_distance(turned.grafted, expected.grafted), 1e-9 * diagonal(expected.grafted));
}

TEST(MergeErrors, NoSideIsReadIntoSheetsAndDents) {
  Mesh ball = make_sample("torus", 24);
  const Mesh dent = turned_over(side_of_plane(ball, {0, 0, 1}, 0.3, true));
  EXPECT_EQ(enclosed_volume(dent), 0) << "as much opening as surface";
  EXPECT_EQ(enclosed_volume(make_sample("bumpy_plane", 24)), 0);
  EXPECT_GT(enclosed_volume(make_sample("cylinder", 24)), 0.1);
}

TEST(MergeErrors, LoopsThatTouchThemselvesAreNamed) {
  // Two holes in a grid share a corner.
  const Mesh sheet = make_sample("bumpy_plane", 12);
  std::vector<Index> taken;
  const IndexLists rings = vertex_rings(sheet.vertex_count(), sheet.faces);
  const Index pivot = 5 * 12 + 5;
  Index kept = 0;
  const Mesh holed = faces_where(sheet, [&](Index f) {
    const bool at_pivot =
        std::find(sheet.faces[f].begin(), sheet.faces[f].end(), pivot) != sheet.faces[f].end();
    return !at_pivot || (kept++ % 3 == 0);
  });
  const auto loops = boundary_loops(holed);
  ASSERT_GT(loops.size(), 1U);
  Graft graft{"", make_sample("bust", 24), holed, {}};
  graft.pairs = {{{loops[1], boundary_loops(graft.target).at(0)}, {}}};
  EXPECT_EQ(cause_of(graft), "merge.boundary_touches_itself source");
}

TEST(Merge, RefusesSizesAMillionTimesOff) {
  const Mesh target = holed(1, 0, true), source = peg(6, 16);
  const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
  for (const double size : {1e-300, 1e-20, 1e9, 1e99, 1e300}) {
    try {
      merge_meshes(target, source, {{pair}}, {.size = size});
      ADD_FAILURE() << size << " was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.location().text(), "size");
      EXPECT_EQ(error.id(), size < 1 ? "merge.size_makes_source_tiny" : "merge.size_makes_source_huge");
      EXPECT_EQ(error.fact().get<double>("size"), size);
    }
  }
}

/// Matches a note with this id.
auto HasId(std::string_view id) { return testing::Property(&Note::id, id); }

TEST(Merge, TellsWhenTheResultIsNoManifold) {
  const Mesh target = holed(1, 0, true);
  Mesh source = peg(6, 16);
  const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
  const auto merged = [&] { return merge_meshes(target, source, {{pair}}).report; };
  EXPECT_TRUE(merged().seam.manifold);
  EXPECT_THAT(merged().notes, testing::Not(testing::Contains(HasId("merge.result_not_manifold"))));
  source.faces.push_back(std::vector<Index>{5 * 16, 5 * 16 + 8, 6 * 16});  // a wall within the cap
  EXPECT_FALSE(merged().seam.manifold);
  EXPECT_THAT(merged().notes, testing::Contains(HasId("merge.result_not_manifold")));
}

TEST(Merge, TellsWhenAKeptPoseDrawsOutANeck) {
  const Mesh target = holed(1, 0, true);
  Mesh source = peg(6, 16);
  const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
  const auto notes = [&] {
    return merge_meshes(target, source, {{pair}}, {.pose = MergePose::keep}).report.notes;
  };
  EXPECT_THAT(notes(), testing::Not(testing::Contains(HasId("merge.source_stretched"))));
  source.positions.col(2).array() += 5;
  const std::vector<Note> told = notes();
  const auto drawn_out = std::find_if(told.begin(), told.end(),
                                      [](const Note& note) { return note.id() == "merge.source_stretched"; });
  ASSERT_NE(drawn_out, told.end());
  EXPECT_THAT(drawn_out->text(), testing::HasSubstr("is 5 times the radius of the target's away"));
}

// Merges where nobody would: the target's faces have no area, or one face near its loop is turned over. Each
// ends with a closed seam or with an error that names the mesh, and damages nothing.
TEST(MergeErrors, DamagedTargetsEndInASeamOrAnError) {
  const Mesh source = peg(4, 12);
  const Mesh line = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2, 3}});
  const Mesh strip = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {0, 2, 3}});
  const Mesh tube = shapes::tube(8, 5, true);
  std::vector<Mesh> targets{line, strip, shapes::together({shapes::grid(4, 4), line})};
  for (Index flipped = 1; flipped < 32; flipped += 3) {
    Mesh target = tube;
    target.faces = {};
    for (Index f = 0; f < tube.face_count(); ++f) {
      std::vector<Index> face(tube.faces[f].begin(), tube.faces[f].end());
      if (f == flipped) std::ranges::reverse(face);
      target.faces.push_back(face);
    }
    targets.push_back(std::move(target));
  }
  int merged = 0;
  for (const Mesh& target : targets)
    for (const MergePose pose : {MergePose::find, MergePose::keep}) {
      const std::vector<Index> loop = boundary_loops(target).back();
      const Graft graft{
          "damaged", target, source, {{{boundary_loops(source).at(0), loop}, {{0, loop.front()}}}}};
      try {
        const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, {.pose = pose});
        EXPECT_TRUE(result.mesh.positions.allFinite());
        ++merged;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
      }
    }
  EXPECT_GT(merged, 10);
}

}  // namespace
}  // namespace meshgraft::test
