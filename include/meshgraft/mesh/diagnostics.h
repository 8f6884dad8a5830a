#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

enum class Severity {
  info,           ///< worth knowing, changes nothing
  worked_around,  ///< has no effect on the solve; the file is not changed
  refused,        ///< the edit fails where it reaches this
};

/// The kinds of findings, worst first; check_mesh explains each.
enum class FindingKind {
  non_finite,
  outlying_vertex,
  coordinate_too_large,
  index_out_of_range,
  degenerate_face,
  zero_area_face,
  isolated_vertex,
  duplicate_vertex,
  non_manifold_edge,
  non_manifold_vertex,
  duplicate_face,
  inconsistent_winding,
  inward_facing_component,
  polygon,
};

/// Returns the name of a kind in files and reports, e.g. "non-manifold-edge".
std::string_view name_of(FindingKind kind);

/// The elements where one kind of defect was found.
struct Finding {
  FindingKind kind = FindingKind::non_finite;
  Severity severity = Severity::info;
  Index count = 0;                 ///< number of defects; for edges not that of `indices`
  Domain domain = Domain::vertex;  ///< elements that `indices` refer to
  /// All affected elements (for edges their ends), ascending; people see the first few.
  std::vector<Index> indices{};
  Note note;  ///< the fact, e.g. "mesh.zero_area_face"; its field `count` is the one above

  /// Returns one clause for people, e.g. "3 faces have no area", and the remedy, which may be empty.
  std::string description() const { return note.text(); }
  std::string remedy() const { return note.remedy(); }
};

/// All findings, worst first.
struct Diagnostics {
  std::vector<Finding> findings;
  bool clean() const { return findings.empty(); }
  /// Returns whether there is any finding other than polygons, which are a form and no defect.
  bool has_defects() const;
  /// Returns the finding of that kind, or null.
  const Finding* find(FindingKind kind) const;
};

/// Checks a mesh for defects that affect an edit. It never throws for what a mesh contains; it throws
/// Error(cancelled) only.
///
/// Refused, because nothing sound can be computed there:
/// - non_finite: vertices with a coordinate that is not a finite number;
/// - outlying_vertex: vertices far beyond all others. Let the distance of a vertex be the largest absolute
///   difference of its coordinates from the vertices' medians, and R the radius of three quarters of the
///   vertices by it. The vertices meant are more than 1e6 R away and in a face with a vertex 1e6 times nearer,
///   or more than 1e6 R away and beyond 1e60;
/// - coordinate_too_large: other vertices with a coordinate beyond 1e60;
/// - index_out_of_range: faces with the index of a vertex that does not exist.
///
/// Worked around in the solve:
/// - degenerate_face: faces with fewer than three corners or with a repeated vertex. Repeated corners are
///   skipped; a face with fewer than three left gives no triangle;
/// - zero_area_face: faces without area. Their edges still join their vertices; normals leave them out;
/// - isolated_vertex: vertices of no usable face. No equation contains them, and they are not moved;
/// - duplicate_vertex: boundary vertices at exactly the same position, at the ends of boundary edges that
///   coincide. They come from a soup of faces or from an open seam. Components that touch in points without
///   such edges are no finding.
///
/// Infos, because the operator reads rings, which need neither fans nor consistent orientation:
/// - non_manifold_edge: edges with more than two faces (`count` edges; `indices` their ends);
/// - non_manifold_vertex: vertices with more than one fan;
/// - duplicate_face: faces with the corners of an earlier one, from any corner on and in either direction;
/// - inconsistent_winding: edges that two faces traverse in the same direction (`count` edges; `indices`
///   their ends). Normals are unreliable there;
/// - inward_facing_component: closed, consistently oriented components of negative volume that lie inside
///   no other closed component (there they would be the wall of a cavity). `indices` are their smallest
///   vertices;
/// - polygon: faces with more than three corners. They are solved on their triangles and written as they
///   were.
///
/// A face has no area if twice its area is at most 1e-12 × its longest edge squared. It also has none if its
/// height is lost in the precision of its coordinates (4 ulp of the largest one).
Diagnostics check_mesh(const Mesh& mesh, const Context& context = {});

struct RequireSoundOptions {
  std::span<const Index> vertices{};  ///< the vertices that an edit reaches; empty: the whole mesh
  std::string name{};                 ///< the mesh's file name, the location of the error
};

/// Throws Error(input) for the first refused finding that touches one of the options' vertices:
/// mesh.non_finite_within_reach, mesh.outlying_vertex_within_reach or mesh.index_out_of_range_within_reach,
/// with the finding's number of vertices or faces and the first five of those that touch, or
/// mesh.coordinate_too_large. A face touches if one of its vertices does.
void require_sound(const Diagnostics& report, const Mesh& mesh, const RequireSoundOptions& options = {});

}  // namespace meshgraft
