#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

enum class Severity {
  note,      ///< worth knowing, changes nothing
  repaired,  ///< worked around for the solve; the file keeps it
  refused,   ///< the edit cannot go on where it reaches this
};

/// One kind of defect, with where it was found.
struct Finding {
  std::string name;  ///< stable identifier, e.g. "non-manifold-edge"
  Severity severity = Severity::note;
  Index count = 0;                 ///< of places; for edges more or fewer than `indices`
  Domain domain = Domain::vertex;  ///< what `indices` refer to
  std::vector<Index> indices{};    ///< all of them (of edges the ends), ascending; people see the first few
  std::string description{};       ///< one clause for people, e.g. "3 faces have no area"
  std::string remedy{};            ///< what to do about it; may be empty
};

/// Everything that was found, worst first.
struct Diagnostics {
  std::vector<Finding> findings;
  bool clean() const { return findings.empty(); }
  /// Whether there is any finding but "polygon", which is a form and no defect.
  bool has_defects() const;
  const Finding* find(std::string_view name) const;
};

/// Looks for what a mesh may carry that an edit has to know of. Never throws for what a mesh contains; throws
/// Error(cancelled) only.
///
/// Refused, for nothing sound can be computed there:
/// - "non-finite": vertices with a coordinate that is not a finite number;
/// - "index-out-of-range": faces that name a vertex which does not exist.
///
/// Repaired, that is worked around for the solve:
/// - "degenerate-face": faces with fewer than three corners or with a vertex twice. Repeated corners are
///   skipped; what has fewer than three left makes no triangle;
/// - "zero-area-face": faces without area. Their edges still join their vertices; normals leave them out;
/// - "isolated-vertex": vertices that no usable face has. No equation has them: they keep their place;
/// - "duplicate-vertex": boundary vertices at exactly the same place, at the ends of boundary edges that lie on
/// each
///   other: a soup of faces, or a seam that is open. Parts that touch in places without such edges are no
///   finding.
///
/// Notes, for the operator reads rings, which need neither fans nor winding:
/// - "non-manifold-edge": edges with more than two faces (`count` edges; `indices` their ends);
/// - "non-manifold-vertex": vertices with more than one fan;
/// - "duplicate-face": faces with the corners of an earlier one, from whichever on and in either direction;
/// - "inconsistent-winding": edges that two faces run along in one direction (`count` edges; `indices` their
///   ends). Normals are weak there;
/// - "inward-facing-component": closed parts, consistently oriented, whose volume is negative and that lie
/// inside no
///   other closed part, where they would be the wall of a cavity (`indices` their smallest vertices);
/// - "polygon": faces with more than three corners. Solved on their triangles and written as they were.
///
/// A face has no area where twice its area is at most 1e-12 × its longest edge squared, or its height is lost
/// in the precision of its coordinates (4 ulp of the largest one).
Diagnostics check_mesh(const Mesh& mesh, const Context& context = {});

/// Throws Error(input) for the first refused finding that touches a vertex in `reach` (empty = the whole
/// mesh): it names the mesh, how many vertices or faces there are and the first of them, and the remedy. A face
/// touches `reach` if one of its vertices does. `name` is the mesh's file name for the message.
void require_usable(const Diagnostics& report, const Mesh& mesh, std::span<const Index> reach,
                    const std::string& name);

}  // namespace meshgraft
