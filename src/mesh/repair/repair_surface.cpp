#include "repair_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/mesh/cut.h>

#include "mesh/area_vector.h"
#include "mesh/face_defects.h"
#include "mesh/facts.h"
#include "mesh/fill_attributes.h"
#include "mesh/join.h"
#include "mesh/outlying.h"
#include "mesh/traced_faces.h"

namespace meshgraft {

void RepairFaces::add(std::span<const Index> face, std::span<const EdgePoint> corners, Index from,
                      bool is_fresh, bool turned) {
  faces.push_back(face);
  origin.push_back(from);
  corner.insert(corner.end(), corners.begin(), corners.end());
  is_new.push_back(is_fresh);
  is_turned.push_back(turned);
}

void RepairFaces::keep(const RepairFaces& from, Index face) {
  const auto first = static_cast<std::size_t>(from.faces.first_corner(face));
  add(from.faces[face], std::span(from.corner).subspan(first, from.faces[face].size()), from.origin[face],
      from.is_new[face], from.is_turned[face]);
}

RepairSurface::RepairSurface(const Mesh& given, const Context& context) : given_(given), context_(context) {
  mesh_.positions = given.positions;
  mesh_.faces = given.faces;
  traced_.faces = given.faces;
  traced_.origin.resize(given.face_count());
  for (Index f = 0; f < given.face_count(); ++f) traced_.origin[f] = f;
  traced_.corner.resize(given.faces.corner_count());
  for (Index c = 0; c < given.faces.corner_count(); ++c) traced_.corner[c] = same(c);
  traced_.is_new.assign(given.face_count(), 0);
  traced_.is_turned.assign(given.face_count(), 0);
  vertex_origin_.resize(given.vertex_count());
  vertex_value_.resize(given.vertex_count());
  for (Index v = 0; v < given.vertex_count(); ++v) {
    vertex_origin_[v] = v;
    vertex_value_[v] = same(v);
  }
  stands_for_ = vertex_origin_;
}

const EdgeTable& RepairSurface::edges() const {
  if (!edges_) edges_.emplace(mesh_.vertex_count(), mesh_.faces, context_);
  return *edges_;
}

Index RepairSurface::face_of(Index corner) const {
  if (face_of_.empty()) {
    face_of_.resize(mesh_.faces.corner_count());
    for (Index f = 0; f < mesh_.face_count(); ++f)
      for (Index c = mesh_.faces.first_corner(f); c < mesh_.faces.first_corner(f + 1); ++c) face_of_[c] = f;
  }
  return face_of_[corner];
}

Eigen::RowVector3d RepairSurface::face_normal(Index face) const {
  const Eigen::RowVector3d area = area_vector(mesh_.faces[face], mesh_.positions).transpose();
  const double length = area.stableNorm();
  return length > 0 ? Eigen::RowVector3d(area / length) : Eigen::RowVector3d::Zero();
}

double RepairSurface::face_area(Index face) const {
  return area_vector(mesh_.faces[face], mesh_.positions).norm() / 2;
}

void RepairSurface::replace_faces(RepairFaces faces) {
  traced_ = std::move(faces);
  mesh_.faces = traced_.faces;
  edges_.reset();
  face_of_.clear();
}

void RepairSurface::remove_faces(const Flags& doomed) {
  RepairFaces kept;
  for (Index f = 0; f < mesh_.face_count(); ++f)
    if (!doomed[f]) kept.keep(traced_, f);
  replace_faces(std::move(kept));
}

void RepairSurface::unite_vertices(DisjointSets& sets) {
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    const Index root = sets.root(v);
    if (root != v && stands_for_[v] == v) stands_for_[v] = root;
  }
  RepairFaces renamed = traced_;
  renamed.faces = {};
  renamed.faces.reserve(mesh_.face_count(), mesh_.faces.corner_count());
  std::vector<Index> face;
  for (Index f = 0; f < mesh_.face_count(); ++f) {
    face.assign(mesh_.faces[f].begin(), mesh_.faces[f].end());
    for (Index& v : face)
      if (is_vertex_of(mesh_, v)) v = sets.root(v);
    renamed.faces.push_back(face);
  }
  replace_faces(std::move(renamed));
}

Index RepairSurface::add_vertices(std::span<const NewVertex> vertices) {
  const Index first = mesh_.vertex_count();
  mesh_.positions.conservativeResize(first + static_cast<Index>(vertices.size()), 3);
  for (const NewVertex& vertex : vertices) {
    const auto v = static_cast<Index>(stands_for_.size());
    mesh_.positions.row(v) = vertex.position;
    vertex_origin_.push_back(vertex.origin);
    const EdgePoint a = vertex_value_[vertex.from], b = vertex_value_[vertex.to];
    vertex_value_.push_back(vertex.from == vertex.to ? a : EdgePoint{a.from, b.from, vertex.t});
    stands_for_.push_back(v);
  }
  edges_.reset();
  return first;
}

void RepairSurface::report(RepairChangeKind kind, Domain domain, std::vector<Index> given_indices,
                           Index count) {
  auto change = std::ranges::find(changes_, kind, &RepairChange::kind);
  if (change == changes_.end()) change = changes_.insert(change, {kind, 0, domain, {}, note_of(kind, 0)});
  change->count += count;
  change->note = note_of(kind, change->count);
  auto& indices = change->indices;
  indices.insert(indices.end(), given_indices.begin(), given_indices.end());
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

void RepairSurface::report_faces(RepairChangeKind kind, const Flags& chosen) {
  std::vector<Index> given;
  Index count = 0;
  for (Index f = 0; f < mesh_.face_count(); ++f) {
    if (!chosen[f]) continue;
    ++count;
    if (!traced_.is_new[f]) given.push_back(traced_.origin[f]);
  }
  report(kind, Domain::face, std::move(given), count);
}

void RepairSurface::report_vertices(RepairChangeKind kind, const Flags& chosen) {
  std::vector<Index> given;
  Index count = 0;
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (!chosen[v]) continue;
    ++count;
    if (vertex_origin_[v] >= 0) given.push_back(vertex_origin_[v]);
  }
  report(kind, Domain::vertex, std::move(given), count);
}

void RepairSurface::note(const Note& note) {
  if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) notes_.push_back(note);
}

std::vector<Index> RepairSurface::place_vertices(bool remove_isolated, RepairResult& result) {
  Flags used(mesh_.vertex_count(), 0), had_face(given_.vertex_count(), 0);
  for (const Index v : mesh_.faces.corners())
    if (is_vertex_of(mesh_, v)) used[v] = 1;
  for (const Index v : given_.faces.corners())
    if (is_vertex_of(given_, v)) had_face[v] = 1;
  std::vector<Index> isolated, non_finite, outlying;
  const std::vector<Index> far = remove_isolated ? std::vector<Index>() : find_outlying(given_).far;
  for (Index v = 0; v < given_.vertex_count(); ++v) {
    if (had_face[v]) continue;
    if (remove_isolated)
      isolated.push_back(v);
    else if (!given_.positions.row(v).allFinite())
      non_finite.push_back(v);
    else if (std::ranges::binary_search(far, v))
      outlying.push_back(v);
    else
      used[v] = 1;
  }
  if (const auto count = static_cast<Index>(non_finite.size()); count > 0)
    report(RepairChangeKind::removed_non_finite_vertex, Domain::vertex, std::move(non_finite), count);
  if (const auto count = static_cast<Index>(outlying.size()); count > 0)
    report(RepairChangeKind::removed_outlying_vertex, Domain::vertex, std::move(outlying), count);
  if (const auto count = static_cast<Index>(isolated.size()); count > 0)
    report(RepairChangeKind::removed_isolated_vertex, Domain::vertex, std::move(isolated), count);

  std::vector<Index> new_index(mesh_.vertex_count(), -1);
  Index count = 0;
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (!used[v]) continue;
    new_index[v] = count++;
    result.vertex_origin.push_back(vertex_origin_[v]);
  }
  result.mesh.positions.resize(count, 3);
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (new_index[v] >= 0) result.mesh.positions.row(new_index[v]) = mesh_.positions.row(v);
  // If the vertex that one was united with is gone, a copy that a fan received may remain.
  const auto became = [&](Index v) {
    while (stands_for_[v] != v) v = stands_for_[v];
    return v;
  };
  std::vector<Index> first_copy(given_.vertex_count(), -1);
  for (Index v = mesh_.vertex_count() - 1; v >= 0; --v)
    if (const Index now = new_index[became(v)]; now >= 0 && vertex_origin_[v] >= 0)
      first_copy[vertex_origin_[v]] = now;
  result.vertex.new_index.resize(given_.vertex_count());
  for (Index v = 0; v < given_.vertex_count(); ++v) {
    const Index last = became(v), origin = vertex_origin_[last];
    result.vertex.new_index[v] = new_index[last] < 0 && origin >= 0 ? first_copy[origin] : new_index[last];
  }
  return new_index;
}

namespace {

bool same_values(const Attribute& attribute, Index a, Index b) {
  for (int k = 0; k < attribute.components; ++k) {
    const double x = attribute.values[static_cast<std::size_t>(a) * attribute.components + k];
    const double y = attribute.values[static_cast<std::size_t>(b) * attribute.components + k];
    if (x != y && !(std::isnan(x) && std::isnan(y))) return false;
  }
  return true;
}

// Converts the origins of corners in the given mesh to origins of vertices.
std::vector<EdgePoint> vertices_of(const std::vector<EdgePoint>& corners, const Faces& given) {
  std::vector<EdgePoint> vertices;
  vertices.reserve(corners.size());
  for (const EdgePoint& corner : corners)
    vertices.push_back(corner.from < 0
                           ? corner
                           : EdgePoint{given.corners()[corner.from], given.corners()[corner.to], corner.t});
  return vertices;
}

bool is_normal_or_cut_normal(const Attribute& attribute) {
  return (attribute.name == "normal" || attribute.name == cut_normal_name) && attribute.components == 3;
}

}  // namespace

// Flips the normals of turned faces that now point to the wrong side.
void RepairSurface::turn_normals(Attribute& attribute, const RepairResult& result) const {
  const Faces& faces = result.mesh.faces;
  Points side = Points::Zero(attribute.domain == Domain::vertex ? result.mesh.vertex_count() : 0, 3);
  const auto turn = [&](Index element, const Eigen::RowVector3d& outward) {
    Eigen::Map<Eigen::RowVector3d> normal(attribute.values.data() + 3 * std::ptrdiff_t{element});
    if (normal.dot(outward) < 0) normal = -normal;
  };
  Flags touched(result.mesh.vertex_count(), 0);
  for (Index f = 0; f < faces.size(); ++f) {
    const Eigen::RowVector3d area = area_vector(result.mesh.faces[f], result.mesh.positions).transpose();
    if (attribute.domain == Domain::vertex) {
      for (const Index v : faces[f]) {
        side.row(v) += area;
        touched[v] |= traced_.is_turned[f];
      }
    } else if (traced_.is_turned[f] && attribute.domain == Domain::face) {
      turn(f, area);
    } else if (traced_.is_turned[f]) {
      for (Index c = faces.first_corner(f); c < faces.first_corner(f + 1); ++c) turn(c, area);
    }
  }
  for (Index v = 0; v < side.rows(); ++v)
    if (touched[v]) turn(v, side.row(v));
}

void RepairSurface::carry_attributes(std::span<const Index> new_index, RepairResult& result) {
  std::vector<EdgePoint> vertex_value, face_value;
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (new_index[v] >= 0) vertex_value.push_back(vertex_value_[v]);
  for (const Index origin : traced_.origin) face_value.push_back(same(origin));
  const std::vector<EdgePoint> corner_vertex = vertices_of(traced_.corner, given_.faces);
  const bool turned =
      std::any_of(traced_.is_turned.begin(), traced_.is_turned.end(), [](char is) { return is != 0; });

  for (const Attribute& attribute : given_.attributes) {
    bool parted = false;  // whether united vertices have different values
    if (attribute.domain == Domain::vertex) {
      for (Index c = 0; c < mesh_.faces.corner_count() && !parted; ++c) {
        const EdgePoint& own = corner_vertex[c];
        const EdgePoint& common = vertex_value_[mesh_.faces.corners()[c]];
        parted = own.from == own.to && common.from == common.to && own.from != common.from && own.from >= 0 &&
                 !same_values(attribute, own.from, common.from);
      }
    }
    const bool may_separate =
        attribute.name != "colour" && !given_.find_attribute(Domain::corner, attribute.name);
    if (parted && !may_separate) note(facts::mesh::WeldedValuesDropped{.attribute = attribute.name});
    if (parted && may_separate) {
      result.mesh.attributes.push_back(interpolate_attribute(attribute, corner_vertex));
      result.mesh.attributes.back().domain = Domain::corner;
      note(facts::mesh::WeldedValuesPerCorner{.attribute = attribute.name});
    } else {
      result.mesh.attributes.push_back(
          interpolate_attribute(attribute, attribute.domain == Domain::vertex ? vertex_value
                                           : attribute.domain == Domain::face ? face_value
                                                                              : traced_.corner));
    }
    if (turned && is_normal_or_cut_normal(attribute)) turn_normals(result.mesh.attributes.back(), result);
  }
  interpolate_in_fills(result.mesh, traced_.is_new, context_);
}

RepairResult RepairSurface::finish(bool remove_isolated) {
  RepairResult result;
  const std::vector<Index> new_index = place_vertices(remove_isolated, result);
  result.changes = std::move(changes_);
  result.face.new_index.assign(given_.face_count(), -1);
  std::vector<Index> face;
  for (Index f = 0; f < mesh_.face_count(); ++f) {
    result.face_origin.push_back(traced_.is_new[f] ? -1 : traced_.origin[f]);
    if (Index& first = result.face.new_index[traced_.origin[f]]; first < 0 && !traced_.is_new[f]) first = f;
    face.assign(mesh_.faces[f].begin(), mesh_.faces[f].end());
    for (Index& v : face) v = is_vertex_of(mesh_, v) ? new_index[v] : v;
    result.mesh.faces.push_back(face);
  }
  if (result.changes.empty()) {
    result.mesh = given_;
  } else {
    carry_attributes(new_index, result);
    result.mesh.source = sources_of(given_);
  }
  result.notes = std::move(notes_);
  return result;
}

std::vector<double> shortest_edges(const RepairSurface& surface) {
  std::vector<double> shortest(surface.mesh().vertex_count(), std::numeric_limits<double>::infinity());
  for (const auto& [a, b] : surface.edges().ends) {
    const double length = (surface.positions().row(a) - surface.positions().row(b)).norm();
    if (!(length > 0)) continue;
    shortest[a] = std::min(shortest[a], length);
    shortest[b] = std::min(shortest[b], length);
  }
  return shortest;
}

}  // namespace meshgraft
