#include "merge_sides.h"

#include <algorithm>
#include <optional>
#include <ranges>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "script/facts.h"

namespace meshgraft {

MergeSide::MergeSide(facts::script::Side name_, const EditFile& edit, const MeshState& state_)
    : name(name_),
      state(state_),
      sound(state.mesh, state.diagnostics, state.label),
      context(state.mesh),
      selections(edit, context, state.produced) {}

void MergeSide::require_sound(Index vertex, const Location& location) const {
  try {
    sound.require_beyond(std::vector<Index>{vertex});
  } catch (const Error& error) {
    throw error.within(location);
  }
}

std::vector<Index> MergeSide::reached(const IndexMap& map, const Mesh& result,
                                      const std::vector<Index>& new_faces) const {
  Flags at_seam(result.vertex_count(), 0);
  for (const Index face : new_faces)
    for (const Index v : result.faces[face]) at_seam[v] = 1;
  std::vector<Index> vertices;
  for (Index v = 0; v < state.mesh.vertex_count(); ++v) {
    const Index now = map.new_index[v];
    if (!sound.is_refused(v) && (now < 0 || at_seam[now])) vertices.push_back(v);
  }
  return vertices;
}

void MergeSide::finish(const IndexMap& map, MergeResult& result, std::vector<Note>& notes) const {
  if (!sound.any()) return;
  sound.require_beyond(reached(map, result.mesh, result.new_faces));
  sound.put_back(map, result.mesh);
  if (const auto note = sound.note()) notes.push_back(*note);
}

namespace {

// Returns the numbers of vertices of the first loops.
std::vector<std::size_t> sizes_of(const MergeSide& side) {
  constexpr std::size_t most = 8;
  std::vector<std::size_t> sizes;
  for (const auto& loop : std::views::take(side.context.loops, most)) sizes.push_back(loop.size());
  return sizes;
}

void require_loops(const MergeSide& side, const Location& location) {
  if (!side.context.loops.empty()) return;
  const std::string& mesh = side.state.label;
  if (side.state.mesh.face_count() == 0)
    throw Error(facts::script::SideWithoutFaces{.side = side.name, .mesh = mesh}, location);
  if (const Finding* edges = side.state.diagnostics.find(FindingKind::non_manifold_edge))
    throw Error(
        facts::script::SideWithoutClosedLoop{
            .side = side.name, .mesh = mesh, .edges = edges->count, .vertex = edges->indices.front()},
        location);
  throw Error(facts::script::SideWithoutLoop{.side = side.name, .mesh = mesh}, location);
}

// Throws a fact of the class Row if the defect is on the loop.
template <class Row>
void require_without(FindingKind defect, const MergeSide& side, std::size_t number, const Location& location) {
  const Finding* finding = side.state.diagnostics.find(defect);
  if (!finding) return;
  std::vector<Index> here;
  for (const Index v : side.context.loops[number])
    if (std::binary_search(finding->indices.begin(), finding->indices.end(), v)) here.push_back(v);
  if (here.empty()) return;
  constexpr std::size_t most = 6;
  std::sort(here.begin(), here.end());
  here.resize(std::min(most, here.size()));
  throw Error(Row{.loop = number,
                  .side = side.name,
                  .mesh = side.state.label,
                  .count = finding->count,
                  .vertices = here},
              location);
}

// Refuses a loop along which the surface is not an oriented manifold, because it cannot be joined to another
// one.
void require_sound(const MergeSide& side, std::size_t number, const Location& location) {
  using namespace facts::script;
  require_without<LoopOnNonManifoldEdge>(FindingKind::non_manifold_edge, side, number, location);
  require_without<LoopOnNonManifoldVertex>(FindingKind::non_manifold_vertex, side, number, location);
  require_without<LoopWoundInconsistently>(FindingKind::inconsistent_winding, side, number, location);
}

Error off_loops(const MergeSide& side, Index vertex, const Location& location) {
  return Error(
      facts::script::VertexOffLoops{
          .side = side.name, .vertex = vertex, .loops = side.context.loops.size(), .sizes = sizes_of(side)},
      location);
}

// Returns the boundary loop that consists of exactly the selected vertices.
std::size_t loop_of(MergeSide& side, const EditSelection& spec, const Location& location) {
  require_loops(side, location);
  const auto& loops = side.context.loops;
  if (const auto* loop = std::get_if<Selection::Loop>(&spec.kind)) {
    if (loop->number >= 0 && static_cast<std::size_t>(loop->number) < loops.size())
      return static_cast<std::size_t>(loop->number);
    throw Error(
        facts::script::NoSuchLoop{
            .side = side.name, .loop = loop->number, .loops = loops.size(), .sizes = sizes_of(side)},
        location);
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
  if (stray != wanted.end()) throw off_loops(side, *stray, location);
  throw Error(
      facts::script::NotOneLoop{
          .side = side.name, .count = wanted.size(), .loops = loops.size(), .sizes = sizes_of(side)},
      location);
}

// Returns the boundary loop that contains a matched vertex.
std::size_t loop_through(const MergeSide& side, Index vertex, const Location& location) {
  require_loops(side, location);
  const auto& loops = side.context.loops;
  for (std::size_t k = 0; k < loops.size(); ++k)
    if (std::find(loops[k].begin(), loops[k].end(), vertex) != loops[k].end()) return k;
  if (vertex < side.state.mesh.vertex_count()) throw off_loops(side, vertex, location);
  throw Error(facts::script::NoSuchVertex{.side = side.name,
                                          .vertex = vertex,
                                          .count = side.state.mesh.vertex_count(),
                                          .loops = loops.size(),
                                          .sizes = sizes_of(side)},
              location);
}

// Returns the vertex that `vertex` specifies; a point stands for the nearest vertex of `loop`, or of all
// loops.
Index loop_vertex(const MergeSide& side, const VertexSpec& vertex, std::optional<std::size_t> loop,
                  const Location& location) {
  if (const auto* number = std::get_if<Index>(&vertex)) return *number;
  require_loops(side, location);
  std::vector<Index> candidates;
  for (std::size_t k = 0; k < side.context.loops.size(); ++k)
    if (!loop || k == *loop)
      candidates.insert(candidates.end(), side.context.loops[k].begin(), side.context.loops[k].end());
  return nearest(side.state.mesh, candidates, std::get<Eigen::Vector3d>(vertex));
}

/// A pair of loops, by their numbers.
struct LoopNumbers {
  std::size_t source = 0, target = 0;
  std::vector<Match> matches;
};

std::vector<LoopNumbers> listed_pairs(const MergeStep& step, MergeSide& source, MergeSide& target,
                                      const Location& location) {
  std::vector<LoopNumbers> pairs;
  for (std::size_t i = 0; i < step.pairs.size(); ++i) {
    const Location where = (location / "pairs")[i];
    pairs.push_back({loop_of(source, step.pairs[i].source_loop, where / "source_loop"),
                     loop_of(target, step.pairs[i].target_loop, where / "target_loop"),
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
                 std::vector<LoopNumbers>& pairs, const Location& location) {
  for (std::size_t i = 0; i < step.matches.size(); ++i) {
    const Location where = (location / "matches")[i];
    const Match match{loop_vertex(source, step.matches[i].source, {}, where),
                      loop_vertex(target, step.matches[i].target, {}, where)};
    const std::size_t from = loop_through(source, match.source, where);
    const std::size_t to = loop_through(target, match.target, where);
    auto pair = std::find_if(pairs.begin(), pairs.end(),
                             [&](const LoopNumbers& p) { return p.source == from || p.target == to; });
    if (pair == pairs.end() && step.pairs.empty()) pair = pairs.insert(pairs.end(), {from, to, {}});
    if (pair == pairs.end() || pair->source != from || pair->target != to)
      throw Error(facts::script::MatchOfNoPair{.target = to, .source = from}, where);
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
                                     const Location& location) {
  std::vector<LoopNumbers> numbers = listed_pairs(step, source, target, location);
  add_matches(step, source, target, numbers, location);
  if (numbers.empty()) {
    for (const MergeSide* side : {&target, &source}) require_loops(*side, location);
    if (source.context.loops.size() != 1 || target.context.loops.size() != 1)
      throw Error(facts::script::PairsUnclear{.target_loops = target.context.loops.size(),
                                              .target_sizes = sizes_of(target),
                                              .source_loops = source.context.loops.size(),
                                              .source_sizes = sizes_of(source)},
                  location);
    numbers.push_back({});
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Location where = numbers.size() == 1 ? location : (location / "pairs")[i];
    require_sound(source, numbers[i].source, where);
    require_sound(target, numbers[i].target, where);
  }
  std::vector<MergePair> pairs;
  for (LoopNumbers& pair : numbers)
    pairs.push_back(
        {{source.context.loops[pair.source], target.context.loops[pair.target]}, std::move(pair.matches)});
  return pairs;
}

std::vector<Index> dropped_loop(const DropSpec& drop, MergeSide& source, const Location& location) {
  const auto& loops = source.context.loops;
  if (drop.source_loop) return loops[loop_of(source, *drop.source_loop, location / "source_loop")];
  const bool is_closed = loops.empty() && source.state.mesh.face_count() > 0 &&
                         source.state.diagnostics.find(FindingKind::non_manifold_edge) == nullptr;
  if (drop.base || is_closed) return {};
  require_loops(source, location);
  if (loops.size() != 1)
    throw Error(facts::script::SourceLoopUnclear{.loops = loops.size(), .sizes = sizes_of(source)}, location);
  return loops.front();
}

}  // namespace meshgraft
