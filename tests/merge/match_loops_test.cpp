#include "merge/match_loops.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "merge/loop_pairs.h"
#include "merge/loops.h"
#include "merge/match_automatically.h"
#include "merge/match_by_arc_length.h"
#include "mesh/shapes.h"

namespace meshgraft {
namespace {

/// Pairs of a source of several components. The source loop of pair p has the vertices 100 p, 100 p + 1, …
struct PairsOfParts {
  std::vector<PairGeometry> pairs;
  std::vector<MergePair> given;
  std::vector<Index> component;
};

/// Returns one pair per letter: b has a bump, o is round. `part` is the component of each pair's source loop.
PairsOfParts pairs_of_parts(const std::string& letters, const std::vector<Index>& part) {
  PairsOfParts result;
  for (std::size_t p = 0; p < letters.size(); ++p) {
    const double bump = letters[p] == 'b' ? 0.4 : 0;
    PairGeometry pair = test::numbered_pair(test::bumpy_loop(40, 0.1, false, bump),
                                            test::bumpy_loop(56, 0.4, true, bump), Location::pair(p));
    const Eigen::RowVector3d centre(5.0 * static_cast<double>(p), 0, 0);
    pair.source.points.rowwise() += centre;
    pair.target.points.rowwise() += centre;
    for (std::size_t i = 0; i < 40; ++i) pair.loops.source[i] = static_cast<Index>(100 * p + i);
    result.given.push_back({pair.loops, {}});
    result.pairs.push_back(std::move(pair));
    result.component.insert(result.component.end(), 100, part[p]);
  }
  return result;
}

std::vector<Correspondence> matched(const PairsOfParts& parts, bool posed = false) {
  return match_loops(parts.pairs, parts.given, parts.component, posed, {});
}

/// Returns the pairs whose starts were ranked.
std::vector<std::size_t> ranked_pairs(const PairsOfParts& parts, bool posed = false) {
  std::vector<std::size_t> ranked;
  const std::vector<Correspondence> found = matched(parts, posed);
  for (std::size_t p = 0; p < found.size(); ++p) {
    if (found[p].starts.empty()) continue;
    ranked.push_back(p);
    for (const StartCandidate& start : found[p].starts) {
      EXPECT_TRUE(std::ranges::count(parts.pairs[p].loops.source, start.start.source));
      EXPECT_TRUE(std::ranges::count(parts.pairs[p].loops.target, start.start.target));
    }
    EXPECT_EQ(found[p].confidence, found[p].starts.front().probability);
  }
  return ranked;
}

TEST(PairsByComponent, IsAPartition) {
  for (const std::vector<Index>& part : std::vector<std::vector<Index>>{
           {0}, {3, 3}, {1, 0}, {0, 1, 0, 1}, {2, 0, 0, 7, 2}, {5, 4, 3, 2, 1, 0}}) {
    const PairsOfParts parts = pairs_of_parts(std::string(part.size(), 'o'), part);
    std::vector<std::size_t> seen;
    Index last = -1;
    for (const std::vector<std::size_t>& members : pairs_by_component(parts.pairs, parts.component)) {
      ASSERT_FALSE(members.empty());
      EXPECT_TRUE(std::ranges::is_sorted(members));
      EXPECT_GT(part[members.front()], last);  // each component once
      last = part[members.front()];
      for (const std::size_t p : members) EXPECT_EQ(part[p], last);
      seen.insert(seen.end(), members.begin(), members.end());
    }
    std::ranges::sort(seen);
    for (std::size_t p = 0; p < part.size(); ++p) EXPECT_EQ(seen.at(p), p);
    EXPECT_EQ(seen.size(), part.size());
  }
}

TEST(MatchLoops, MatchesEachComponentByItself) {
  const PairsOfParts parts = pairs_of_parts("bobo", {1, 0, 0, 1});
  const std::vector<Correspondence> found = matched(parts);
  for (const std::vector<std::size_t>& members : {std::vector<std::size_t>{0, 3}, {1, 2}}) {
    const std::vector<PairGeometry> chosen{parts.pairs[members[0]], parts.pairs[members[1]]};
    const std::vector<Correspondence> expected = match_automatically(chosen, false, {});
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(found[members[k]].loop_parameter, expected[k].loop_parameter);
      EXPECT_EQ(found[members[k]].confidence, expected[k].confidence);
    }
  }
}

TEST(MatchLoops, FollowsGivenMatches) {
  PairsOfParts parts = pairs_of_parts("bob", {0, 0, 0});
  for (std::size_t p = 0; p < 3; ++p) {
    const LoopPair& loops = parts.pairs[p].loops;
    parts.given[p].matches = {{loops.source[3], loops.target[20]}};
    if (p == 2) parts.given[p].matches.push_back({loops.source[13], loops.target[9]});
  }
  const std::vector<Correspondence> found = matched(parts);
  for (std::size_t p = 0; p < 3; ++p)
    EXPECT_EQ(found[p].loop_parameter,
              match_by_arc_length(parts.pairs[p], parts.given[p].matches).loop_parameter);
}

TEST(MatchLoops, RanksTheStartsOfPairsThatAreAlone) {
  using Ranked = std::vector<std::size_t>;
  EXPECT_EQ(ranked_pairs(pairs_of_parts("o", {0})), Ranked({0}));
  EXPECT_EQ(ranked_pairs(pairs_of_parts("b", {0})), Ranked({0}));
  EXPECT_EQ(ranked_pairs(pairs_of_parts("ooo", {2, 1, 0})), Ranked({0, 1, 2}));
  EXPECT_EQ(ranked_pairs(pairs_of_parts("obo", {1, 1, 0})), Ranked({2}));
  EXPECT_EQ(ranked_pairs(pairs_of_parts("obo", {0, 1, 1})), Ranked({0}));
  EXPECT_EQ(ranked_pairs(pairs_of_parts("obo", {2, 1, 0}), true), Ranked());
}

TEST(MatchLoops, RanksNoGivenStart) {
  PairsOfParts parts = pairs_of_parts("ooo", {2, 1, 0});
  for (const std::size_t p : {1U, 0U, 2U}) {
    std::vector<std::size_t> expected = ranked_pairs(parts);
    std::erase(expected, p);
    parts.given[p].matches = {{parts.pairs[p].loops.source[0], parts.pairs[p].loops.target[0]}};
    EXPECT_EQ(ranked_pairs(parts), expected);
  }
}

TEST(MatchLoops, NearnessPlacesPairsOfAPosedSource) {
  const PairsOfParts parts = pairs_of_parts("obo", {2, 1, 0});
  const std::vector<Correspondence> found = matched(parts, true);
  for (std::size_t p = 0; p < 3; ++p)
    EXPECT_EQ(found[p].loop_parameter, match_automatically({&parts.pairs[p], 1}, true, {})[0].loop_parameter);
}

TEST(PairGeometryOfMeshes, HasPointsNormalsAndNames) {
  const Mesh target = shapes::together({shapes::tube(9, 3), shapes::tube(12, 2)});
  const Mesh source = shapes::together({shapes::tube(7, 4, true), shapes::tube(15, 2)});
  const auto of_target = boundary_loops(target), of_source = boundary_loops(source);
  std::vector<LoopPair> loops;
  for (std::size_t p = 0; p < 4; ++p) {
    loops.push_back({of_source[p], of_target[p]});
    for (const bool smooth : {false, true}) {
      const std::vector<PairGeometry> geometry = pair_geometry(target, source, loops, smooth);
      ASSERT_EQ(geometry.size(), loops.size());
      for (std::size_t k = 0; k < loops.size(); ++k) {
        EXPECT_EQ(geometry[k].location, p == 0 ? Location() : Location::pair(k));
        EXPECT_EQ(geometry[k].loops.source, loops[k].source);
        EXPECT_EQ(geometry[k].loops.target, loops[k].target);
        for (const bool is_source : {true, false}) {
          const Mesh& mesh = is_source ? source : target;
          const std::vector<Index>& loop = is_source ? loops[k].source : loops[k].target;
          const LoopGeometry& found = is_source ? geometry[k].source : geometry[k].target;
          const Points points = mesh.positions(loop, Eigen::all),
                       normals = vertex_normals(mesh)(loop, Eigen::all);
          EXPECT_EQ(found.points, smooth ? smoothed_loop(points) : points);
          EXPECT_EQ(found.normals, normals);
        }
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft
