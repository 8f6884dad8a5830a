// Repair of holes: boundary loops that are closed by triangles.

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <ranges>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "hole_boundary.h"
#include "hole_refinement.h"
#include "hole_triangulation.h"
#include "mesh/face_defects.h"
#include "mesh/facts.h"
#include "repair_surface.h"

namespace meshgraft {

namespace {

constexpr Index default_edges = 24;
constexpr double default_area_rel = 0.005;  // of the components around: larger openings are taken as intended

// A loop and the half-edges along it, in the direction of the faces that will close it.
struct Hole {
  std::vector<Index> vertices;
  std::vector<Index> outside;  // the half-edge of the surface from vertices[k+1] to vertices[k]
  /// Other vertices at the positions of the hole's, where other holes touch it, with the index of the position.
  std::vector<std::pair<Index, Index>> copies;

  std::map<Index, Index> index_of_vertices() const {
    std::map<Index, Index> index;
    for (Index k = 0; k < static_cast<Index>(vertices.size()); ++k) index[vertices[k]] = k;
    for (const auto& [copy, k] : copies) index[copy] = k;
    return index;
  }
};

double fan_area(const Points& positions, const std::vector<Index>& loop) {
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (const Index v : loop) centre += positions.row(v) / static_cast<double>(loop.size());
  double area = 0;
  for (std::size_t k = 0; k < loop.size(); ++k)
    area +=
        (positions.row(loop[k]) - centre).cross(positions.row(loop[(k + 1) % loop.size()]) - centre).norm() / 2;
  return area;
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

// Decides which holes are small: those of few edges, and without a limit given those of little area, too.
class HoleLimit {
 public:
  HoleLimit(const RepairSurface& surface, std::optional<Index> most_edges)
      : surface_(surface),
        components_(components_of(surface)),
        given_(most_edges.has_value()),
        most_edges_(static_cast<std::size_t>(most_edges.value_or(default_edges))) {}

  bool allows(const std::vector<Index>& loop) const {
    if (loop.size() > most_edges_) return false;
    std::vector<Index> vertices;
    for (const Index c : loop) vertices.push_back(surface_.faces().corners()[c]);
    Index faces = 0;
    double area = 0;
    for (const Index component : components_around(loop)) {
      faces += components_.faces[component];
      area += components_.area[component];
    }
    if (faces < 2) return false;  // a lone face
    return given_ || fan_area(surface_.positions(), vertices) <= default_area_rel * area;
  }

  bool is_between_components(const std::vector<Index>& loop) const {
    return components_around(loop).size() > 1;
  }

 private:
  std::vector<Index> components_around(const std::vector<Index>& loop) const {
    std::vector<Index> around;
    for (const Index c : loop) around.push_back(components_.of_face[surface_.face_of(c)]);
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    return around;
  }

  const RepairSurface& surface_;
  ConnectedComponents components_;
  bool given_;
  std::size_t most_edges_;
};

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

// Returns what fills a hole; no faces if nothing can.
HolePatch fill_of(const RepairSurface& surface, const Surroundings& surroundings, const Hole& hole,
                  HoleFill how) {
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

// Merges vertices at one position, after a hole between them is closed.
void rejoin(RepairSurface& surface, const std::vector<std::pair<Index, Index>>& pairs) {
  DisjointSets sets(surface.mesh().vertex_count());
  std::vector<Index> copies, others;
  Index copy_count = 0, other_count = 0;
  for (const auto& [a, b] : pairs) {
    const Index root = sets.root(a), other = sets.root(b);
    if (root == other) continue;
    sets.unite(a, b);
    const Index origin = surface.vertex_origin(std::max(root, other));
    const bool is_copy = origin == surface.vertex_origin(std::min(root, other));
    ++(is_copy ? copy_count : other_count);
    if (origin >= 0) (is_copy ? copies : others).push_back(origin);
  }
  if (other_count > 0)
    surface.report(RepairChangeKind::welded_vertex, Domain::vertex, std::move(others), other_count);
  if (copy_count > 0)
    surface.report(RepairChangeKind::rejoined_vertex, Domain::vertex, std::move(copies), copy_count);
  surface.unite_vertices(sets);
}

// Fills holes one by one. What it adds becomes part of the surface at the end.
class HoleFilling {
 public:
  HoleFilling(RepairSurface& surface, const HoleBoundary& boundary, HoleFill how)
      : surface_(surface),
        boundary_(boundary),
        how_(how),
        surroundings_(surface),
        faces_(surface.traced()),
        is_done_(surface.faces().corner_count(), 0),
        is_used_(surface.mesh().vertex_count(), 0) {}

  // Fills the hole along a loop. Leaves it for the next round if it shares two positions with a hole that is
  // filled already, because both could get the edge between them.
  void fill(const std::vector<Index>& loop) {
    surface_.context().throw_if_stopped();
    if (std::ranges::any_of(loop, [&](Index c) { return is_done_[c] != 0; })) return;
    const auto shared =
        std::ranges::count_if(loop, [&](Index c) { return is_used_[boundary_.position_of(c)] != 0; });
    if (shared < 2) {
      const Hole hole = hole_along(surface_, loop);
      const HolePatch patch = fill_of(surface_, surroundings_, hole, how_);
      if (patch.faces.empty()) {
        ++failed_;
        return;
      }
      add(hole, patch);
    }
    for (const Index c : loop) is_done_[c] = is_used_[boundary_.position_of(c)] = 1;
  }

  // Returns whether anything was filled.
  bool finish() {
    if (failed_ > 0) surface_.note(facts::mesh::HoleWithoutFill{.count = failed_});
    if (count_ == 0) return false;
    surface_.report(RepairChangeKind::filled_hole, Domain::vertex, std::move(given_), count_);
    surface_.add_vertices(added_);
    surface_.replace_faces(std::move(faces_));
    if (!joined_.empty()) rejoin(surface_, joined_);
    return true;
  }

 private:
  void add(const Hole& hole, const HolePatch& patch) {
    add_patch(surface_, hole, patch, faces_, added_);
    ++count_;
    for (const Index v : hole.vertices)
      if (surface_.vertex_origin(v) >= 0) given_.push_back(surface_.vertex_origin(v));
    for (const auto& [copy, index] : hole.copies) joined_.emplace_back(copy, hole.vertices[index]);
  }

  RepairSurface& surface_;
  const HoleBoundary& boundary_;
  HoleFill how_;
  Surroundings surroundings_;
  RepairFaces faces_;
  std::vector<NewVertex> added_;
  std::vector<Index> given_;
  std::vector<std::pair<Index, Index>> joined_;  // vertices at one position
  Flags is_done_;                                // per half-edge: whether its hole is filled, or next round
  Flags is_used_;                                // per position: whether a hole there is
  Index count_ = 0, failed_ = 0;
};

}  // namespace

bool fill_cracks(RepairSurface& surface, const RepairOptions& options) {
  if (components_of(surface).faces.size() < 2) return false;
  const HoleBoundary boundary(surface, options);
  const std::vector<std::vector<Index>> loops = boundary.touching_loops();
  if (loops.empty()) return false;
  surface.context().throw_if_stopped();
  const HoleLimit limit(surface, options.hole_edges);
  HoleFilling filling(surface, boundary, options.hole_fill);
  for (const std::vector<Index>& loop : loops)
    if (limit.is_between_components(loop) && limit.allows(loop)) filling.fill(loop);
  return filling.finish();
}

// Holes that touch others come first. Along the boundary of a component they may form one large loop.
bool fill_holes(RepairSurface& surface, const RepairOptions& options) {
  const HoleBoundary boundary(surface, options);
  Index unsound = 0;
  const std::vector<std::vector<Index>> loops = boundary.loops(options.hole_edges.value_or(0), unsound);
  if (unsound > 0) surface.note(facts::mesh::HoleBesideInconsistentFaces{.count = unsound});
  if (loops.empty()) return false;
  const HoleLimit limit(surface, options.hole_edges);
  HoleFilling filling(surface, boundary, options.hole_fill);
  for (const std::vector<Index>& loop : boundary.touching_loops())
    if (limit.allows(loop)) filling.fill(loop);
  for (const std::vector<Index>& loop : loops)
    if (limit.allows(loop)) filling.fill(loop);
  return filling.finish();
}

}  // namespace meshgraft
