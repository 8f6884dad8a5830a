// Repair of non-manifold edges and vertices, and of inconsistent orientation.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "mesh/closed_components.h"
#include "mesh/facts.h"
#include "mesh/fans.h"
#include "repair_surface.h"

namespace meshgraft {

namespace {

bool is_crowded(const EdgeTable& table, Index half_edge) {
  return table.half_edges[table.edge[half_edge]].size() > 2;
}

// Crosses the faces around the end of a half-edge, from its own face on, and returns the half-edge at the next
// edge of three or more faces, or -1 if a boundary comes first.
Index next_crowded(const EdgeTable& table, const std::vector<Index>& corners, Index half_edge, Index at) {
  Index c = half_edge;
  do {
    c = corners[c] == at ? table.previous[c] : table.next[c];  // the face's other edge there
    if (is_crowded(table, c)) return c;
    if (table.is_boundary(c)) return -1;
    const auto along = table.half_edges[table.edge[c]];
    c = along[0] == c ? along[1] : along[0];
  } while (c != half_edge);
  return -1;
}

// Sheets of faces along the curves where three or more of them meet: unites the half-edges on such a curve
// whose faces are connected around its vertices. At a vertex with a third edge of the kind a curve ends.
DisjointSets sheets_at_curves(const EdgeTable& table, const std::vector<Index>& corners, Index vertices) {
  std::vector<Index> crowded_edges(vertices, 0);
  for (Index e = 0; e < table.edge_count(); ++e)
    if (table.half_edges[e].size() > 2)
      for (const Index v : table.ends[e]) ++crowded_edges[v];
  DisjointSets sheets(static_cast<Index>(corners.size()));
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (table.half_edges[e].size() < 3) continue;
    for (const Index c : table.half_edges[e])
      for (const Index v : table.ends[e])
        if (crowded_edges[v] == 2)
          if (const Index other = next_crowded(table, corners, c, v); other >= 0) sheets.unite(c, other);
  }
  return sheets;
}

// Pairs the half-edges of each edge with three or more faces. All edges of a curve decide together which sheets
// stay joined, so that the sheets do not change partners along it.
std::vector<std::array<Index, 2>> joined_at_curves(const RepairSurface& surface) {
  const EdgeTable& table = surface.edges();
  DisjointSets sheets = sheets_at_curves(table, surface.faces().corners(), surface.mesh().vertex_count());
  const auto sheets_of = [&](const ScoredPair& pair) {
    const Index a = sheets.root(pair.half_edges[0]), b = sheets.root(pair.half_edges[1]);
    return std::pair(std::min(a, b), std::max(a, b));
  };
  std::vector<ScoredPair> pairs;
  std::map<std::pair<Index, Index>, double> scores;
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (table.half_edges[e].size() < 3) continue;
    for (const ScoredPair& pair : possible_pairs(surface, table.half_edges[e])) {
      scores[sheets_of(pair)] +=
          pair.score - worst_pair_score;  // negative, so that a longer contact counts more
      pairs.push_back(pair);
    }
  }
  for (ScoredPair& pair : pairs) pair.score = scores.at(sheets_of(pair));
  return pair_up(std::move(pairs));
}

// Unites the corners at each vertex into fans: faces that stay connected across an edge at the vertex.
DisjointSets joined_corners(const RepairSurface& surface) {
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  DisjointSets sets(static_cast<Index>(corners.size()));
  const auto join = [&](Index a, Index b) {
    const bool alike = corners[a] == corners[b];
    sets.unite(a, alike ? b : table.next[b]);
    sets.unite(table.next[a], alike ? table.next[b] : b);
  };
  for (Index e = 0; e < table.edge_count(); ++e)
    if (const auto along = table.half_edges[e]; along.size() == 2) join(along[0], along[1]);
  for (const auto& [a, b] : joined_at_curves(surface)) join(a, b);
  return sets;
}

// Gives each fan except the first its own copy of the vertex.
bool part_fans(RepairSurface& surface) {
  DisjointSets sets = joined_corners(surface);
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  const Index vertices = surface.mesh().vertex_count();
  std::vector<Index> first_fan(vertices, -1), copy(corners.size(), -1), given;
  std::vector<NewVertex> added;
  for (Index c = 0; c < static_cast<Index>(corners.size()); ++c) {
    if (table.next[c] < 0) continue;
    const Index v = corners[c], fan = sets.root(c);  // the smallest corner of the fan
    if (first_fan[v] < 0) first_fan[v] = fan;
    if (fan == first_fan[v]) continue;
    if (fan == c) {
      copy[c] = vertices + static_cast<Index>(added.size());
      added.push_back({surface.positions().row(v), surface.vertex_origin(v), v, v});
      if (surface.vertex_origin(v) >= 0) given.push_back(surface.vertex_origin(v));
    }
    copy[c] = copy[fan];
  }
  if (added.empty()) return false;
  surface.report(RepairChangeKind::split_non_manifold_vertex, Domain::vertex, std::move(given),
                 static_cast<Index>(added.size()));
  RepairFaces parted = surface.traced();
  parted.faces = {};
  std::vector<Index> face;
  for (Index f = 0; f < surface.faces().size(); ++f) {
    const Index first = surface.faces().first_corner(f);
    face.assign(surface.faces()[f].begin(), surface.faces()[f].end());
    for (std::size_t k = 0; k < face.size(); ++k)
      if (const Index own = copy[first + static_cast<Index>(k)]; own >= 0) face[k] = own;
    parted.faces.push_back(face);
  }
  surface.add_vertices(added);
  surface.replace_faces(std::move(parted));
  return true;
}

// Removes all but two faces of each edge with three or more. The faces of such an edge are connected around
// both its ends, so that splitting vertices cannot separate them.
bool thin_non_manifold_edges(RepairSurface& surface) {
  const EdgeTable& table = surface.edges();
  Flags doomed(surface.faces().size(), 0);
  bool any = false;
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (table.half_edges[e].size() < 3) continue;
    const auto [a, b] = pair_up(surface, table.half_edges[e]).front();
    for (const Index c : table.half_edges[e])
      if (c != a && c != b) doomed[surface.face_of(c)] = any = true;
  }
  if (!any) return false;
  surface.report_faces(RepairChangeKind::removed_non_manifold_face, doomed);
  surface.remove_faces(doomed);
  return true;
}

}  // namespace

bool split_non_manifold(RepairSurface& surface) {
  const bool parted = part_fans(surface);
  return thin_non_manifold_edges(surface) || parted;
}

namespace {

void turn_faces(RepairSurface& surface, const Flags& turn) {
  const Faces& faces = surface.faces();
  const RepairFaces& traced = surface.traced();
  RepairFaces turned;
  for (Index f = 0; f < faces.size(); ++f) {
    if (!turn[f]) {
      turned.keep(traced, f);
      continue;
    }
    const auto first = traced.corner.begin() + faces.first_corner(f);
    std::vector<Index> face(faces[f].begin(), faces[f].end());
    std::vector<EdgePoint> values(first, first + static_cast<std::ptrdiff_t>(face.size()));
    std::reverse(face.begin() + 1, face.end());
    std::reverse(values.begin() + 1, values.end());
    turned.add(face, values, traced.origin[f], traced.is_new[f], !traced.is_turned[f]);
  }
  surface.replace_faces(std::move(turned));
}

// Faces connected by edges, with counts of the edges between inconsistently oriented ones. Each edge counts
// from both sides.
struct OrientedComponent {
  std::vector<Index> faces;
  Index against = 0;         // edges whose faces are inconsistently oriented now
  Index contradictions = 0;  // the same after turning; 0 on an orientable surface
};

OrientedComponent follow_winding(const RepairSurface& surface, Index seed, Flags& reached, Flags& turn) {
  const EdgeTable& table = surface.edges();
  const Faces& faces = surface.faces();
  OrientedComponent component{.faces = {seed}};
  reached[seed] = 1;
  for (std::size_t k = 0; k < component.faces.size(); ++k) {
    const Index f = component.faces[k];
    for (Index c = faces.first_corner(f); c < faces.first_corner(f + 1); ++c) {
      if (table.edge[c] < 0) continue;
      const std::optional<bool> alike = consistently_oriented(surface.mesh(), table, table.edge[c]);
      if (!alike) continue;
      const auto along = table.half_edges[table.edge[c]];
      const Index other = surface.face_of(along[0] == c ? along[1] : along[0]);
      const char wanted = *alike ? turn[f] : !turn[f];
      component.against += !*alike;
      if (!reached[other]) {
        reached[other] = 1;
        turn[other] = wanted;
        component.faces.push_back(other);
      } else if (turn[other] != wanted) {
        ++component.contradictions;
      }
    }
  }
  return component;
}

// Returns the faces to turn so that neighbours are consistently oriented: the minority in each component.
Flags faces_against_the_rest(const RepairSurface& surface, Index& contradictions) {
  Flags turn(surface.faces().size(), 0), reached(surface.faces().size(), 0);
  contradictions = 0;
  for (Index seed = 0; seed < surface.faces().size(); ++seed) {
    if (reached[seed]) continue;
    const OrientedComponent component = follow_winding(surface, seed, reached, turn);
    const auto turned =
        std::count_if(component.faces.begin(), component.faces.end(), [&](Index f) { return turn[f] != 0; });
    const bool helps = component.contradictions < component.against;
    contradictions +=
        (helps ? component.contradictions : component.against) / 2;  // each edge was seen from both sides
    const bool most = 2 * turned > static_cast<std::ptrdiff_t>(component.faces.size());
    for (const Index f : component.faces) turn[f] = helps && (most ? !turn[f] : turn[f]);
  }
  return turn;
}

}  // namespace

bool unify_winding(RepairSurface& surface) {
  bool changed = false;
  Index contradictions = 0;
  const Flags against = faces_against_the_rest(surface, contradictions);
  if (contradictions > 0) surface.note(facts::mesh::OneSidedSurface{.count = contradictions});
  if (std::find(against.begin(), against.end(), 1) != against.end()) {
    surface.report_faces(RepairChangeKind::turned_face, against);
    turn_faces(surface, against);
    changed = true;
  }
  surface.context().throw_if_stopped();
  const InwardComponents inward = inward_components(surface.mesh(), surface.edges(), surface.context());
  if (inward.components.empty()) return changed;
  surface.context().throw_if_stopped();
  Flags turn(surface.faces().size(), 0);
  std::vector<Index> given;
  for (Index f = 0; f < surface.faces().size(); ++f) {
    const auto face = surface.faces()[f];
    if (face.empty()) continue;
    turn[f] = std::binary_search(inward.components.begin(), inward.components.end(), inward.component[face[0]]);
    if (turn[f] && !surface.traced().is_new[f]) given.push_back(surface.traced().origin[f]);
  }
  surface.report(RepairChangeKind::turned_component, Domain::face, std::move(given),
                 static_cast<Index>(inward.components.size()));
  turn_faces(surface, turn);
  return true;
}

}  // namespace meshgraft
