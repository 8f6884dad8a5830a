// Repair of holes: boundary loops that are closed by triangles.

#include <algorithm>
#include <array>
#include <map>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "face_defects.h"
#include "hole_refinement.h"
#include "hole_triangulation.h"
#include "repair_surface.h"

namespace meshgraft {

namespace {

constexpr Index default_edges = 24;
constexpr double default_area_rel = 0.005;  // of the part: a larger opening is taken to be meant

// A loop with the half-edges along it, turned to run as the faces that are to close it.
struct Hole {
  std::vector<Index> vertices;
  std::vector<Index> outside;  // the half-edge of the surface from vertices[k+1] to vertices[k]
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

std::vector<Hole> find_holes(const RepairSurface& surface, std::optional<Index> most_edges) {
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  const auto limit = static_cast<std::size_t>(most_edges.value_or(default_edges));
  std::vector<std::vector<Index>> loops = boundary_loops(surface.mesh());
  std::erase_if(loops, [&](const auto& loop) { return loop.size() > limit; });
  std::vector<Hole> holes;
  if (loops.empty()) return holes;

  std::vector<Index> leaving(surface.mesh().vertex_count(), -1);  // the boundary half-edge from each vertex
  for (Index c = 0; c < static_cast<Index>(corners.size()); ++c)
    if (table.next[c] >= 0 && table.is_boundary(c)) leaving[corners[c]] = c;
  const ConnectedComponents components = components_of(surface);
  for (const auto& loop : loops) {
    Hole hole;
    const std::size_t n = loop.size();
    bool sound = true;
    for (std::size_t k = 0; k < n && sound; ++k) {
      const Index c = leaving[loop[k]];
      sound = c >= 0 && corners[table.next[c]] == loop[(k + 1) % n];
      hole.vertices.push_back(loop[n - 1 - k]);
    }
    if (!sound) continue;
    for (std::size_t k = 0; k < n; ++k) hole.outside.push_back(leaving[hole.vertices[(k + 1) % n]]);
    const Index component = components.of_face[surface.face_of(hole.outside[0])];
    if (static_cast<std::size_t>(components.faces[component]) < n / 2 + 1 && components.faces[component] < 2)
      continue;  // a lone face
    if (!most_edges && fan_area(surface.positions(), loop) > default_area_rel * components.area[component]) continue;
    holes.push_back(std::move(hole));
  }
  return holes;
}

// Chords of a hole that are edges of the surface, the smaller index first.
std::vector<HoleChord> edges_across(const RepairSurface& surface, const Hole& hole) {
  const auto n = static_cast<Index>(hole.vertices.size());
  const auto& ends = surface.edges().ends;
  std::map<Index, Index> index_in_hole;
  for (Index k = 0; k < n; ++k) index_in_hole[hole.vertices[k]] = k;
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

// Faces without area would be taken out again.
bool have_area(const HolePatch& patch) {
  return std::none_of(patch.faces.begin(), patch.faces.end(),
                      [&](const HoleTriangle& face) { return has_no_area(face, patch.points); });
}

// A fan about a new vertex in the middle: it makes no edge that can be there already.
HolePatch fan_over(const HoleLoop& loop) {
  const Index n = loop.size();
  HolePatch patch{Points(n + 1, 3), {}, {{0, n / 2, 0.5}}};
  patch.points << loop.points, loop.points.colwise().mean();
  for (Index k = 0; k < n; ++k) patch.faces.push_back({k, (k + 1) % n, n});
  return patch;
}

// Per vertex of the hole the mean length of its edges.
std::vector<double> edge_lengths(const RepairSurface& surface, const Hole& hole) {
  std::map<Index, std::pair<double, Index>> sums;
  for (const Index v : hole.vertices) sums[v] = {0, 0};
  for (const auto& [a, b] : surface.edges().ends) {
    const auto first = sums.find(a), second = sums.find(b);
    if (first == sums.end() && second == sums.end()) continue;
    const double length = (surface.positions().row(a) - surface.positions().row(b)).norm();
    for (const auto& end : {first, second})
      if (end != sums.end()) end->second = {end->second.first + length, end->second.second + 1};
  }
  std::vector<double> lengths;
  for (const Index v : hole.vertices) lengths.push_back(sums[v].first / static_cast<double>(sums[v].second));
  return lengths;
}

// Moves the new vertices so that the surface around the hole goes on in it.
void fair(const RepairSurface& surface, const Hole& hole, HolePatch& patch) {
  std::map<Index, Index> row_of;
  for (Index k = 0; k < static_cast<Index>(hole.vertices.size()); ++k) row_of[hole.vertices[k]] = k;
  const std::map<Index, Index> of_loop = row_of;
  std::vector<HoleTriangle> around;
  std::vector<Index> outside;
  for (Index f = 0; f < surface.faces().size(); ++f) {
    const auto face = surface.faces()[f];
    if (std::none_of(face.begin(), face.end(), [&](Index v) { return of_loop.contains(v); })) continue;
    std::vector<Index> rows;
    for (const Index v : face) {
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

// No faces where nothing can fill the hole.
HolePatch fill(const RepairSurface& surface, const Hole& hole, HoleFill how) {
  const auto beside = [&](Index k) { return surface.face_of(hole.outside[k]); };
  if (hole.vertices.size() == 3 && beside(0) == beside(1) && beside(1) == beside(2))
    return {};  // the other side of a lone face
  const HoleLoop loop = loop_of(surface, hole);
  const std::vector<HoleChord> forbidden = edges_across(surface, hole);
  HolePatch patch{loop.points, triangulate_hole(loop, {.forbidden = forbidden}, surface.context()), {}};
  if (patch.faces.empty() || !have_area(patch)) {
    patch = fan_over(loop);
    return have_area(patch) ? patch : HolePatch{};
  }
  if (how == HoleFill::plain) return patch;
  const HolePatch plain = patch;
  patch = refine_hole(loop.points, plain.faces, {.scale = edge_lengths(surface, hole), .forbidden = forbidden},
                      surface.context());
  if (how == HoleFill::faired) fair(surface, hole, patch);
  return have_area(patch) ? patch : plain;
}

// Adds the faces; their attributes continue those of the faces beside them.
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

}  // namespace

bool fill_holes(RepairSurface& surface, const RepairOptions& options) {
  RepairFaces filled = surface.traced();
  std::vector<NewVertex> added;
  std::vector<Index> given;
  Index count = 0, left = 0;
  for (const Hole& hole : find_holes(surface, options.hole_edges)) {
    surface.context().throw_if_stopped();
    const HolePatch patch = fill(surface, hole, options.hole_fill);
    if (patch.faces.empty()) {
      ++left;
      continue;
    }
    add_patch(surface, hole, patch, filled, added);
    ++count;
    for (const Index v : hole.vertices)
      if (surface.vertex_origin(v) >= 0) given.push_back(surface.vertex_origin(v));
  }
  if (left > 0)
    surface.note(std::to_string(left) + (left == 1 ? " hole was" : " holes were") +
                 " not closed: no triangles fit.");
  if (count == 0) return false;
  surface.report("filled-hole", Domain::vertex, std::move(given), count,
                 "hole was closed (the vertices around it are named)",
                 "holes were closed (the vertices around them are named)");
  surface.add_vertices(added);
  surface.replace_faces(std::move(filled));
  return true;
}

}  // namespace meshgraft
