#include "merge_sides.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <meshgraft/core/error.h>

namespace meshgraft {

namespace {

std::string loop_list(const MergeSide& side) {
  std::string list;
  constexpr std::size_t most = 8;
  const auto& loops = side.context.loops;
  for (std::size_t k = 0; k < std::min(most, loops.size()); ++k)
    list += fmt::format("{}{} ({} vertices)", k == 0 ? "" : ", ", k, loops[k].size());
  return loops.size() > most ? list + ", …" : list;
}

void require_loops(const MergeSide& side, const std::string& location) {
  if (!side.context.loops.empty()) return;
  const std::string name = fmt::format("the {} ({})", side.name, side.scene.label);
  if (side.scene.mesh.face_count() == 0)
    throw Error(ErrorCode::input, name + " has no faces", location, "Export it with its faces.");
  if (const Finding* edges = side.scene.diagnostics.find("non-manifold-edge"))
    throw Error(ErrorCode::input,
                fmt::format("{} has no closed boundary loop: {}, first at vertex {}", name, edges->description,
                            edges->indices.front()),
                location, edges->remedy);
  throw Error(ErrorCode::input, name + " has no boundary loop", location,
              "Cut it open first: 'meshgraft cut'.");
}

// Refuses a loop along which the surface is not an oriented manifold, because it cannot be joined to another
// one.
void require_sound(const MergeSide& side, std::size_t number, const std::string& location) {
  const std::vector<Index>& loop = side.context.loops[number];
  for (const char* defect : {"non-manifold-edge", "non-manifold-vertex", "inconsistent-winding"}) {
    const Finding* finding = side.scene.diagnostics.find(defect);
    if (!finding) continue;
    std::vector<Index> here;
    for (const Index v : loop)
      if (std::binary_search(finding->indices.begin(), finding->indices.end(), v)) here.push_back(v);
    if (here.empty()) continue;
    constexpr std::size_t most = 6;
    std::sort(here.begin(), here.end());
    const std::string more = here.size() > most ? ", …" : "";
    here.resize(std::min(most, here.size()));
    throw Error(ErrorCode::input,
                fmt::format("loop {} of the {} ({}) cannot be merged: {}, on the loop at vertices {}{}", number,
                            side.name, side.scene.label, finding->description, fmt::join(here, ", "), more),
                location, finding->remedy);
  }
}

// Returns the boundary loop that consists of exactly the selected vertices.
std::size_t loop_of(MergeSide& side, const SelectionSpec& spec, const std::string& location) {
  require_loops(side, location);
  const auto& loops = side.context.loops;
  if (const auto* loop = std::get_if<Selection::Loop>(&spec.kind)) {
    if (loop->number >= 0 && static_cast<std::size_t>(loop->number) < loops.size())
      return static_cast<std::size_t>(loop->number);
    throw Error(ErrorCode::input, fmt::format("the {} has no boundary loop {}", side.name, loop->number),
                location, fmt::format("Its loops are {}.", loop_list(side)));
  }
  const std::vector<Index> wanted = side.selections.vertices(spec, location);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if (loops[k].size() != wanted.size()) continue;
    std::vector<Index> sorted = loops[k];
    std::sort(sorted.begin(), sorted.end());
    if (sorted == wanted) return k;
  }
  const auto is_on_boundary = [&](Index v) {
    return std::any_of(loops.begin(), loops.end(),
                       [&](const auto& loop) { return std::find(loop.begin(), loop.end(), v) != loop.end(); });
  };
  const auto stray = std::find_if_not(wanted.begin(), wanted.end(), is_on_boundary);
  const std::string problem =
      stray != wanted.end()
          ? fmt::format("vertex {} is not on a boundary of the {}", *stray, side.name)
          : fmt::format("the {} selected vertices are not those of one boundary loop of the {}", wanted.size(),
                        side.name);
  throw Error(ErrorCode::input, problem, location, fmt::format("Its loops are {}.", loop_list(side)));
}

// Returns the boundary loop that contains a matched vertex.
std::size_t loop_through(const MergeSide& side, Index vertex, const std::string& location) {
  require_loops(side, location);
  const auto& loops = side.context.loops;
  for (std::size_t k = 0; k < loops.size(); ++k)
    if (std::find(loops[k].begin(), loops[k].end(), vertex) != loops[k].end()) return k;
  throw Error(ErrorCode::input,
              vertex < side.scene.mesh.vertex_count()
                  ? fmt::format("vertex {} is not on a boundary of the {}", vertex, side.name)
                  : fmt::format("there is no vertex {} among the {}'s {}", vertex, side.name,
                                side.scene.mesh.vertex_count()),
              location, fmt::format("Its loops are {}.", loop_list(side)));
}

// Returns the vertex that `vertex` specifies; a point stands for the nearest vertex of `loop`, or of all
// loops.
Index loop_vertex(const MergeSide& side, const VertexSpec& vertex, std::optional<std::size_t> loop,
                  const std::string& location) {
  if (const auto* number = std::get_if<Index>(&vertex)) return *number;
  require_loops(side, location);
  std::vector<Index> candidates;
  for (std::size_t k = 0; k < side.context.loops.size(); ++k)
    if (!loop || k == *loop)
      candidates.insert(candidates.end(), side.context.loops[k].begin(), side.context.loops[k].end());
  return nearest(side.scene.mesh, candidates, std::get<Eigen::Vector3d>(vertex));
}

/// A pair of loops, by their numbers.
struct LoopNumbers {
  std::size_t source = 0, target = 0;
  std::vector<Match> matches;
};

std::vector<LoopNumbers> listed_pairs(const MergeStep& step, MergeSide& source, MergeSide& target,
                                      const std::string& location) {
  std::vector<LoopNumbers> pairs;
  for (std::size_t i = 0; i < step.pairs.size(); ++i) {
    const std::string where = fmt::format("{}.pairs[{}]", location, i);
    pairs.push_back({loop_of(source, step.pairs[i].source_loop, where + ".source_loop"),
                     loop_of(target, step.pairs[i].target_loop, where + ".target_loop"),
                     {}});
    LoopNumbers& pair = pairs.back();
    for (const MatchSpec& match : step.pairs[i].matches)
      pair.matches.push_back({loop_vertex(source, match.source, pair.source, where),
                              loop_vertex(target, match.target, pair.target, where)});
  }
  return pairs;
}

// Assigns each match of the step to the pair whose loops contain it. Creates that pair where no pairs are
// listed.
void add_matches(const MergeStep& step, const MergeSide& source, const MergeSide& target,
                 std::vector<LoopNumbers>& pairs, const std::string& location) {
  for (std::size_t i = 0; i < step.matches.size(); ++i) {
    const std::string where = fmt::format("{}.matches[{}]", location, i);
    const Match match{loop_vertex(source, step.matches[i].source, {}, where),
                      loop_vertex(target, step.matches[i].target, {}, where)};
    const std::size_t from = loop_through(source, match.source, where);
    const std::size_t to = loop_through(target, match.target, where);
    auto pair = std::find_if(pairs.begin(), pairs.end(),
                             [&](const LoopNumbers& p) { return p.source == from || p.target == to; });
    if (pair == pairs.end() && step.pairs.empty()) pair = pairs.insert(pairs.end(), {from, to, {}});
    if (pair == pairs.end() || pair->source != from || pair->target != to)
      throw Error(
          ErrorCode::input,
          fmt::format("it joins loop {} of the target and loop {} of the source, which are no pair", to, from),
          where);
    pair->matches.push_back(match);
  }
}

}  // namespace

Index nearest(const Mesh& mesh, std::span<const Index> vertices, const Eigen::Vector3d& point) {
  const Points& positions = mesh.positions;
  return *std::min_element(vertices.begin(), vertices.end(), [&](Index a, Index b) {
    return (positions.row(a) - point.transpose()).squaredNorm() <
           (positions.row(b) - point.transpose()).squaredNorm();
  });
}

std::vector<MergePair> resolve_pairs(const MergeStep& step, MergeSide& source, MergeSide& target,
                                     const std::string& location) {
  std::vector<LoopNumbers> numbers = listed_pairs(step, source, target, location);
  add_matches(step, source, target, numbers, location);
  if (numbers.empty()) {
    for (const MergeSide* side : {&target, &source}) require_loops(*side, location);
    if (source.context.loops.size() != 1 || target.context.loops.size() != 1)
      throw Error(ErrorCode::input,
                  fmt::format("which loops meet is not clear: the target has the loops {}, the source has {}",
                              loop_list(target), loop_list(source)),
                  location,
                  "Say so with 'pairs' ('--pair TARGET_LOOP:SOURCE_LOOP'), or match a vertex of each loop.");
    numbers.push_back({});
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::string where = numbers.size() == 1 ? location : fmt::format("{}.pairs[{}]", location, i);
    require_sound(source, numbers[i].source, where);
    require_sound(target, numbers[i].target, where);
  }
  std::vector<MergePair> pairs;
  for (LoopNumbers& pair : numbers)
    pairs.push_back(
        {{source.context.loops[pair.source], target.context.loops[pair.target]}, std::move(pair.matches)});
  return pairs;
}

std::size_t dropped_loop(const DropSpec& drop, MergeSide& source, const std::string& location) {
  if (drop.source_loop) return loop_of(source, *drop.source_loop, location + ".source_loop");
  require_loops(source, location);
  if (source.context.loops.size() != 1)
    throw Error(ErrorCode::input,
                fmt::format("which loop of the source meets the target is not clear: it has the loops {}",
                            loop_list(source)),
                location, "Name one with 'source_loop' ('--source-loop LOOP').");
  return 0;
}

}  // namespace meshgraft
