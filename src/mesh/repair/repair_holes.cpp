// Repair of holes: boundary loops that are closed by triangles.

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "hole_refinement.h"
#include "hole_triangulation.h"
#include "mesh/face_defects.h"
#include "mesh/facts.h"
#include "repair_surface.h"

namespace meshgraft {

namespace {

constexpr Index default_edges = 24;
constexpr double default_area_rel = 0.005;  // of the component: larger openings are taken as intended

// A loop and the half-edges along it, in the direction of the faces that will close it.
struct Hole {
  std::vector<Index> vertices;
  std::vector<Index> outside;  // the half-edge of the surface from vertices[k+1] to vertices[k]
  /// Copies of the hole's vertices, made where another hole touches it, with the index of the copied vertex.
  std::vector<std::pair<Index, Index>> copies;

  std::map<Index, Index> index_of_vertices() const {
    std::map<Index, Index> index;
    for (Index k = 0; k < static_cast<Index>(vertices.size()); ++k) index[vertices[k]] = k;
    for (const auto& [copy, k] : copies) index[copy] = k;
    return index;
  }
};

// Holes that are filled together or not at all: one, or several that touch each other in vertices.
using TouchingHoles = std::vector<Hole>;

double fan_area(const Points& positions, const std::vector<Index>& loop) {
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (const Index v : loop) centre += positions.row(v) / static_cast<double>(loop.size());
  double area = 0;
  for (std::size_t k = 0; k < loop.size(); ++k)
    area +=
        (positions.row(loop[k]) - centre).cross(positions.row(loop[(k + 1) % loop.size()]) - centre).norm() / 2;
  return area;
}

// Splits a loop where holes touch. Copies of the vertex at which the holes touch had joined them into one
// loop. Each result passes each vertex, or its copies, once. Loops are lists of half-edges along the
// boundary.
std::vector<std::vector<Index>> split_at_copies(const RepairSurface& surface, const std::vector<Index>& loop) {
  const std::vector<Index>& corners = surface.faces().corners();
  std::vector<std::vector<Index>> loops;
  std::vector<Index> rest;
  for (const Index half_edge : loop) {
    const auto origin_of = [&](Index c) { return surface.vertex_origin(corners[c]); };
    const Index origin = origin_of(half_edge);
    const auto before =
        std::find_if(rest.begin(), rest.end(), [&](Index c) { return origin >= 0 && origin_of(c) == origin; });
    if (rest.end() - before > 2) {
      loops.emplace_back(before, rest.end());
      rest.erase(before, rest.end());
    }
    rest.push_back(half_edge);
  }
  if (rest.size() > 2) loops.push_back(std::move(rest));
  return loops;
}

// Makes a hole from the half-edges along it.
Hole hole_along(const RepairSurface& surface, const std::vector<Index>& loop) {
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  const std::size_t n = loop.size();
  Hole hole;
  for (std::size_t k = 0; k < n; ++k) hole.vertices.push_back(corners[loop[n - 1 - k]]);
  for (std::size_t k = 0; k < n; ++k) hole.outside.push_back(loop[(2 * n - 2 - k) % n]);
  for (std::size_t k = 0; k < n; ++k)
    if (const Index end = corners[table.next[loop[n - 1 - k]]]; end != hole.vertices[(k + n - 1) % n])
      hole.copies.emplace_back(end, static_cast<Index>((k + n - 1) % n));
  return hole;
}

// Returns the holes to fill. Counts in `unsound` the loops within a given limit whose border is not simple.
std::vector<TouchingHoles> find_holes(const RepairSurface& surface, std::optional<Index> most_edges,
                                      Index& unsound) {
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  const auto limit = static_cast<std::size_t>(most_edges.value_or(default_edges));
  const std::vector<std::vector<Index>> loops = boundary_loops(surface.mesh());
  std::vector<Index> leaving(surface.mesh().vertex_count(), -1);  // the boundary half-edge from each vertex
  if (!loops.empty())
    for (Index c = 0; c < static_cast<Index>(corners.size()); ++c)
      if (table.next[c] >= 0 && table.is_boundary(c)) leaving[corners[c]] = c;
  const auto within_limit = [&](const std::vector<Index>& loop) { return loop.size() <= limit; };
  std::vector<std::vector<std::vector<Index>>> candidates;  // loops of half-edges that touch each other
  for (const std::vector<Index>& vertices : loops) {
    std::vector<Index> loop;
    for (const Index v : vertices) loop.push_back(leaving[v]);
    bool sound = true;
    for (std::size_t k = 0; k < loop.size() && sound; ++k)
      sound = loop[k] >= 0 && corners[table.next[loop[k]]] == vertices[(k + 1) % vertices.size()];
    if (!sound) {
      unsound += most_edges && within_limit(loop);
      continue;
    }
    std::vector<std::vector<Index>> touching = split_at_copies(surface, loop);
    if (!std::all_of(touching.begin(), touching.end(), within_limit)) touching = {loop};
    if (within_limit(touching.front())) candidates.push_back(std::move(touching));
  }
  std::vector<TouchingHoles> holes;
  if (candidates.empty()) return holes;

  const ConnectedComponents components = components_of(surface);
  const auto is_small = [&](const std::vector<Index>& loop) {
    const Index component = components.of_face[surface.face_of(loop.front())];
    if (components.faces[component] < 2) return false;  // a lone face
    std::vector<Index> vertices;
    for (const Index c : loop) vertices.push_back(corners[c]);
    return most_edges ||
           fan_area(surface.positions(), vertices) <= default_area_rel * components.area[component];
  };
  for (const auto& touching : candidates) {
    if (!std::all_of(touching.begin(), touching.end(), is_small)) continue;
    holes.emplace_back();
    for (const std::vector<Index>& along : touching) holes.back().push_back(hole_along(surface, along));
  }
  return holes;
}

// Finds the faces and edges around vertices.
class Surroundings {
 public:
  explicit Surroundings(const RepairSurface& surface)
      : surface_(surface), first_(static_cast<std::size_t>(surface.mesh().vertex_count()) + 1, 0) {
    const std::vector<Index>& corners = surface.faces().corners();
    const auto is_vertex = [&](Index v) { return is_vertex_of(surface.mesh(), v); };
    for (const Index v : corners)
      if (is_vertex(v)) ++first_[v + 1];
    for (std::size_t v = 0; v + 1 < first_.size(); ++v) first_[v + 1] += first_[v];
    corners_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (Index c = 0; c < static_cast<Index>(corners.size()); ++c)
      if (is_vertex(corners[c])) corners_[next[corners[c]]++] = c;
  }

  // Returns the faces that have one of the vertices, ascending.
  std::vector<Index> faces_at(const std::map<Index, Index>& vertices) const {
    std::vector<Index> faces;
    for (const auto& [v, k] : vertices)
      for (const Index c : corners_at(v)) faces.push_back(surface_.face_of(c));
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
  }

  // Returns the mean length of the edges at a vertex.
  double edge_length(Index vertex) const {
    const EdgeTable& table = surface_.edges();
    const std::vector<Index>& corners = surface_.faces().corners();
    std::vector<Index> others;
    for (const Index c : corners_at(vertex))
      for (const Index neighbour : {table.next[c], table.previous[c]})
        if (neighbour >= 0) others.push_back(corners[neighbour]);
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    double sum = 0;
    for (const Index other : others)
      sum += (surface_.positions().row(vertex) - surface_.positions().row(other)).norm();
    return sum / static_cast<double>(others.size());
  }

 private:
  std::span<const Index> corners_at(Index v) const {
    return std::span(corners_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

  const RepairSurface& surface_;
  std::vector<std::size_t> first_;
  std::vector<Index> corners_;
};

// Returns the chords of a hole that are edges of the surface, smaller index first.
std::vector<HoleChord> edges_across(const RepairSurface& surface, const Hole& hole) {
  const auto n = static_cast<Index>(hole.vertices.size());
  const auto& ends = surface.edges().ends;
  const std::map<Index, Index> index_in_hole = hole.index_of_vertices();
  std::vector<HoleChord> chords;
  for (const auto& [vertex, k] : index_in_hole)
    for (auto edge = std::lower_bound(ends.begin(), ends.end(), std::array{vertex, Index{-1}});
         edge != ends.end() && (*edge)[0] == vertex; ++edge)
      if (const auto other = index_in_hole.find((*edge)[1]); other != index_in_hole.end()) {
        const auto [low, high] = std::minmax(k, other->second);
        if (high - low > 1 && high - low < n - 1) chords.push_back({low, high});
      }
  std::sort(chords.begin(), chords.end());
  return chords;
}

HoleLoop loop_of(const RepairSurface& surface, const Hole& hole) {
  const auto n = static_cast<Eigen::Index>(hole.vertices.size());
  HoleLoop loop{Points(n, 3), Points(n, 3)};
  for (Eigen::Index k = 0; k < n; ++k) {
    loop.points.row(k) = surface.positions().row(hole.vertices[k]);
    loop.beyond.row(k) =
        surface.positions().row(surface.faces().corners()[surface.edges().previous[hole.outside[k]]]);
  }
  return loop;
}

// Returns whether all faces have area; a later step would remove the others.
bool have_area(const HolePatch& patch) {
  return std::none_of(patch.faces.begin(), patch.faces.end(),
                      [&](const HoleTriangle& face) { return has_no_area(face, patch.points); });
}

// Makes a fan around a new vertex in the middle. None of its edges can exist already.
HolePatch fan_over(const HoleLoop& loop) {
  const Index n = loop.size();
  HolePatch patch{Points(n + 1, 3), {}, {{0, n / 2, 0.5}}};
  patch.points << loop.points, loop.points.colwise().mean();
  for (Index k = 0; k < n; ++k) patch.faces.push_back({k, (k + 1) % n, n});
  return patch;
}

// Moves the new vertices so that the patch continues the surrounding surface.
void fair(const RepairSurface& surface, const Surroundings& surroundings, const Hole& hole, HolePatch& patch) {
  std::map<Index, Index> row_of = hole.index_of_vertices();
  std::vector<HoleTriangle> around;
  std::vector<Index> outside;
  for (const Index f : surroundings.faces_at(row_of)) {
    std::vector<Index> rows;
    for (const Index v : surface.faces()[f]) {
      const auto [entry, is_new] =
          row_of.try_emplace(v, static_cast<Index>(patch.points.rows()) + static_cast<Index>(outside.size()));
      if (is_new) outside.push_back(v);
      rows.push_back(entry->second);
    }
    for (std::size_t k = 2; k < rows.size(); ++k) around.push_back({rows[0], rows[k - 1], rows[k]});
  }
  Points points(static_cast<Eigen::Index>(outside.size()), 3);
  for (std::size_t k = 0; k < outside.size(); ++k)
    points.row(static_cast<Eigen::Index>(k)) = surface.positions().row(outside[k]);
  fair_hole(patch, points, around, surface.context());
}

// Fills a hole. Returns no faces if nothing can fill the hole.
HolePatch fill(const RepairSurface& surface, const Surroundings& surroundings, const Hole& hole, HoleFill how) {
  const auto beside = [&](Index k) { return surface.face_of(hole.outside[k]); };
  if (hole.vertices.size() == 3 && beside(0) == beside(1) && beside(1) == beside(2))
    return {};  // the other side of a single face
  const HoleLoop loop = loop_of(surface, hole);
  const std::vector<HoleChord> forbidden = edges_across(surface, hole);
  HolePatch patch{loop.points, triangulate_hole(loop, {.forbidden = forbidden}, surface.context()), {}};
  if (patch.faces.empty() || !have_area(patch)) {
    patch = fan_over(loop);
    return have_area(patch) ? patch : HolePatch{};
  }
  if (how == HoleFill::plain) return patch;
  const HolePatch plain = patch;
  HoleRefinementOptions refinement{.forbidden = forbidden};
  for (const Index v : hole.vertices) refinement.scale.push_back(surroundings.edge_length(v));
  patch = refine_hole(loop.points, plain.faces, refinement, surface.context());
  if (how == HoleFill::faired) fair(surface, surroundings, hole, patch);
  return have_area(patch) ? patch : plain;
}

// Adds the faces and continues the attributes of the faces beside them.
void add_patch(const RepairSurface& surface, const Hole& hole, const HolePatch& patch, RepairFaces& filled,
               std::vector<NewVertex>& added) {
  const auto n = static_cast<Index>(hole.vertices.size());
  const RepairFaces& traced = surface.traced();
  std::vector<Index> vertices = hole.vertices;
  std::vector<EdgePoint> values;
  for (Index k = 0; k < n; ++k) values.push_back(traced.corner[surface.edges().next[hole.outside[k]]]);
  for (Index k = n; k < static_cast<Index>(patch.points.rows()); ++k) {
    const auto& [from, to, t] = patch.between[k - n];
    vertices.push_back(surface.mesh().vertex_count() + static_cast<Index>(added.size()));
    values.push_back({values[from].from, values[to].from, t});
    added.push_back({patch.points.row(k), -1, hole.vertices[from], hole.vertices[to], t});
  }
  const Index origin = traced.origin[surface.face_of(hole.outside[0])];
  for (const auto& [a, b, c] : patch.faces)
    filled.add(std::array{vertices[a], vertices[b], vertices[c]}, std::array{values[a], values[b], values[c]},
               origin, true);
}

// Merges copies with their vertices again, after the holes that touched there are closed.
void rejoin(RepairSurface& surface, const std::vector<std::pair<Index, Index>>& copies) {
  DisjointSets sets(surface.mesh().vertex_count());
  std::vector<Index> given;
  for (const auto& [copy, vertex] : copies) {
    if (sets.root(copy) == sets.root(vertex)) continue;
    sets.unite(copy, vertex);
    given.push_back(surface.vertex_origin(copy));
  }
  const auto count = static_cast<Index>(given.size());
  surface.report(RepairChangeKind::rejoined_vertex, Domain::vertex, std::move(given), count);
  surface.unite_vertices(sets);
}

}  // namespace

bool fill_holes(RepairSurface& surface, const RepairOptions& options) {
  Index count = 0, left = 0, unsound = 0;
  const std::vector<TouchingHoles> holes = find_holes(surface, options.hole_edges, unsound);
  if (unsound > 0) surface.note(facts::mesh::HoleBesideInconsistentFaces{.count = unsound});
  if (holes.empty()) return false;
  RepairFaces filled = surface.traced();
  std::vector<NewVertex> added;
  std::vector<Index> given;
  std::vector<std::pair<Index, Index>> rejoined;  // copies and the vertices that they copy
  const Surroundings surroundings(surface);
  for (const TouchingHoles& touching : holes) {
    surface.context().throw_if_stopped();
    std::vector<HolePatch> patches;
    for (const Hole& hole : touching) patches.push_back(fill(surface, surroundings, hole, options.hole_fill));
    if (std::any_of(patches.begin(), patches.end(),
                    [](const HolePatch& patch) { return patch.faces.empty(); })) {
      left += static_cast<Index>(touching.size());
      continue;
    }
    for (std::size_t k = 0; k < touching.size(); ++k) {
      const Hole& hole = touching[k];
      add_patch(surface, hole, patches[k], filled, added);
      ++count;
      for (const Index v : hole.vertices)
        if (surface.vertex_origin(v) >= 0) given.push_back(surface.vertex_origin(v));
      for (const auto& [copy, index] : hole.copies) rejoined.emplace_back(copy, hole.vertices[index]);
    }
  }
  if (left > 0) surface.note(facts::mesh::HoleWithoutFill{.count = left});
  if (count == 0) return false;
  surface.report(RepairChangeKind::filled_hole, Domain::vertex, std::move(given), count);
  surface.add_vertices(added);
  surface.replace_faces(std::move(filled));
  if (!rejoined.empty()) rejoin(surface, rejoined);
  return true;
}

}  // namespace meshgraft
