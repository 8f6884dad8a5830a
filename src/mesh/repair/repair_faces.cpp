// Repair of single faces: invalid, duplicate or without area.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "mesh/face_defects.h"
#include "mesh/face_keys.h"
#include "mesh/facts.h"
#include "mesh/outlying.h"
#include "repair_surface.h"

namespace meshgraft {

bool remove_invalid(RepairSurface& surface) {
  const Mesh& mesh = surface.mesh();
  const std::vector<Index> outlying = find_outlying(mesh).far;
  enum : std::uint8_t { sound, non_finite, far };
  std::vector<std::uint8_t> state(mesh.vertex_count(), sound);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!mesh.positions.row(v).allFinite()) state[v] = non_finite;
  for (const Index v : outlying) state[v] = far;
  Flags out_of_range(mesh.face_count(), 0), without_place(mesh.face_count(), 0), doomed(mesh.face_count(), 0);
  Flags removed(mesh.vertex_count(), 0);
  bool any_out = false, any_non_finite = false, any_far = false;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!in_range(mesh, f)) {
      any_out = true;
      out_of_range[f] = doomed[f] = 1;
      continue;
    }
    for (const Index v : mesh.faces[f]) {
      if (state[v] == sound) continue;
      doomed[f] = 1;
      (state[v] == far ? any_far : any_non_finite) = true;
      (state[v] == far ? removed[v] : without_place[f]) = 1;
    }
  }
  if (any_out) surface.report_faces(RepairChangeKind::removed_out_of_range_face, out_of_range);
  if (any_non_finite) surface.report_faces(RepairChangeKind::removed_non_finite_face, without_place);
  if (any_far) surface.report_vertices(RepairChangeKind::removed_outlying_vertex, removed);
  if (!any_out && !any_non_finite && !any_far) return false;
  surface.remove_faces(doomed);
  return true;
}

namespace {

struct Corners {
  std::vector<Index> face;
  std::vector<EdgePoint> values;
};

// Splits a face that repeats a vertex into faces that have each vertex once. Drops those with fewer than
// three corners.
std::vector<Corners> simple_faces(std::span<const Index> face, std::span<const EdgePoint> values) {
  std::vector<Corners> simple;
  Corners open;
  for (std::size_t c = 0; c < face.size(); ++c) {
    const auto before = std::find(open.face.begin(), open.face.end(), face[c]);
    if (before != open.face.end()) {
      const auto k = before - open.face.begin();
      Corners closed{{before, open.face.end()}, {open.values.begin() + k, open.values.end()}};
      open.face.resize(k);
      open.values.resize(k);
      if (closed.face.size() > 2) simple.push_back(std::move(closed));
    }
    open.face.push_back(face[c]);
    open.values.push_back(values[c]);
  }
  if (open.face.size() > 2) simple.push_back(std::move(open));
  return simple;
}

}  // namespace

bool clean_corners(RepairSurface& surface) {
  const Faces& faces = surface.faces();
  Flags degenerate(faces.size(), 0);
  bool any = false;
  for (Index f = 0; f < faces.size(); ++f) any |= (degenerate[f] = is_degenerate(faces[f])) != 0;
  if (!any) return false;
  surface.report_faces(RepairChangeKind::mended_degenerate_face, degenerate);
  const RepairFaces& traced = surface.traced();
  RepairFaces mended;
  for (Index f = 0; f < faces.size(); ++f) {
    if (!degenerate[f]) {
      mended.keep(traced, f);
      continue;
    }
    const auto values = std::span(traced.corner).subspan(faces.first_corner(f), faces[f].size());
    for (const Corners& simple : simple_faces(faces[f], values))
      mended.add(simple.face, simple.values, traced.origin[f], traced.is_new[f], traced.is_turned[f]);
  }
  surface.replace_faces(std::move(mended));
  return true;
}

bool remove_duplicate_faces(RepairSurface& surface) {
  Flags repeated(surface.faces().size(), 0);
  const auto groups = same_faces(surface.faces(), surface.mesh().vertex_count());
  for (const auto& group : groups)
    for (std::size_t k = 1; k < group.size(); ++k) repeated[group[k]] = 1;
  if (groups.empty()) return false;
  surface.report_faces(RepairChangeKind::removed_duplicate_face, repeated);
  surface.remove_faces(repeated);
  return true;
}

// A needle has a side without length. Its ends are merged into one vertex, so that its two long sides meet.
// In a cap one vertex lies on the opposite side. The cap is removed, and the step for T-junctions splits the
// face beyond that side at the vertex.
bool remove_zero_area(RepairSurface& surface, bool may_split_edges) {
  constexpr double needle = 1e-6;  // shortest side over longest
  const Mesh& mesh = surface.mesh();
  DisjointSets sets(mesh.vertex_count());
  Flags needles(mesh.face_count(), 0), caps(mesh.face_count(), 0);
  bool any_needle = false, any_cap = false;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    if (!in_range(mesh, f) || is_degenerate(face) || !has_no_area(face, mesh.positions)) continue;
    double longest = 0, shortest = std::numeric_limits<double>::infinity();
    std::array<Index, 2> ends{};
    for (std::size_t c = 0; c < face.size(); ++c) {
      const Index a = face[c], b = face[(c + 1) % face.size()];
      const double length = (mesh.positions.row(a) - mesh.positions.row(b)).norm();
      longest = std::max(longest, length);
      if (length < shortest) {
        shortest = length;
        ends = {a, b};
      }
    }
    if (shortest <= needle * longest) {
      sets.unite(ends[0], ends[1]);
      needles[f] = any_needle = true;
    } else if (may_split_edges) {
      caps[f] = any_cap = true;
    }
  }
  if (!any_needle && !any_cap) return false;
  Flags both(needles.size());
  for (std::size_t f = 0; f < both.size(); ++f) both[f] = needles[f] || caps[f];
  surface.report_faces(RepairChangeKind::removed_zero_area_face, both);
  if (any_needle) surface.unite_vertices(sets);
  if (any_cap) surface.remove_faces(caps);
  return true;
}

}  // namespace meshgraft
