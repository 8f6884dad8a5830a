#include <meshgraft/mesh/diagnostics.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/core/parallel.h>

#include "closed_components.h"
#include "coincident.h"
#include "edge_table.h"
#include "face_defects.h"
#include "face_keys.h"
#include "fans.h"

namespace meshgraft {

namespace {

// Tests blocks in parallel; the order of the result does not depend on them.
template <class Predicate>
std::vector<Index> indices_where(Index count, const Predicate& predicate, const Context& context) {
  constexpr std::size_t grain = 16384;
  const auto size = static_cast<std::size_t>(count);
  std::vector<std::vector<Index>> found((size + grain - 1) / grain);
  parallel_blocks(
      found.size(),
      [&](std::size_t first, std::size_t last) {
        for (std::size_t block = first; block < last; ++block)
          for (std::size_t i = block * grain; i < std::min(size, (block + 1) * grain); ++i)
            if (predicate(static_cast<Index>(i))) found[block].push_back(static_cast<Index>(i));
      },
      context, 1);
  std::vector<Index> indices;
  for (const auto& some : found) indices.insert(indices.end(), some.begin(), some.end());
  return indices;
}

bool is_finite(const Mesh& mesh, Index vertex) {
  const double* p = mesh.positions.data() + 3 * std::ptrdiff_t{vertex};
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

std::vector<Index> ends_of(const EdgeTable& table, std::span<const Index> edges) {
  std::vector<Index> ends;
  for (const Index e : edges) ends.insert(ends.end(), table.ends[e].begin(), table.ends[e].end());
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

// Returns whether two faces at a common edge have the same next corner, as all duplicate faces do.
bool may_repeat_faces(const Mesh& mesh, const EdgeTable& table) {
  constexpr std::size_t crowd = 16;  // above this, comparing all faces costs less than those of an edge
  const std::vector<Index>& corners = mesh.faces.corners();
  for (Index e = 0; e < table.edge_count(); ++e) {
    const auto along = table.half_edges[e];
    if (along.size() > crowd) return true;
    const auto beyond = [&](Index c, bool ahead) {
      return ahead ? corners[table.next[table.next[c]]] : corners[table.previous[c]];
    };
    for (std::size_t k = 1; k < along.size(); ++k)
      for (std::size_t i = 0; i < k; ++i)
        if (beyond(along[i], true) == beyond(along[k], corners[along[i]] == corners[along[k]])) return true;
  }
  return false;
}

std::vector<Index> repeated_faces(const Mesh& mesh, const EdgeTable& table) {
  std::vector<Index> repeated;
  if (!may_repeat_faces(mesh, table)) return repeated;
  for (const auto& group : same_faces(mesh.faces, mesh.vertex_count()))
    repeated.insert(repeated.end(), group.begin() + 1, group.end());
  std::sort(repeated.begin(), repeated.end());
  return repeated;
}

std::string counted(Index count, const std::string& one, const std::string& many) {
  return count == 1 ? "1 " + one : std::to_string(count) + " " + many;
}

std::string list_first(std::span<const Index> indices) {
  constexpr std::size_t shown = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(shown, indices.size()); ++k) {
    text += (k ? ", " : "") + std::to_string(indices[k]);
  }
  return indices.size() > shown ? text + ", …" : text;
}

}  // namespace

const Finding* Diagnostics::find(std::string_view name) const {
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [&](const Finding& finding) { return finding.name == name; });
  return found == findings.end() ? nullptr : &*found;
}

Diagnostics check_mesh(const Mesh& mesh, const Context& context) {
  Diagnostics report;
  const auto add = [&](Finding finding, const std::string& one, const std::string& many) {
    if (finding.count == 0) finding.count = static_cast<Index>(finding.indices.size());
    finding.description = counted(finding.count, one, many);
    if (finding.count > 0) report.findings.push_back(std::move(finding));
  };
  const auto count_of = [](const std::vector<Index>& list) { return static_cast<Index>(list.size()); };

  context.step("check", 0);
  const Index vertices = mesh.vertex_count();
  const Index faces = mesh.face_count();
  const auto where = [&](Index count, const auto& predicate) {
    return indices_where(count, predicate, context);
  };
  add({.name = "non-finite",
       .severity = Severity::refused,
       .domain = Domain::vertex,
       .indices = where(vertices, [&](Index v) { return !is_finite(mesh, v); }),
       .remedy = "Remove these vertices or give them finite coordinates; 'meshgraft repair' removes them with "
                 "their faces."},
      "vertex has a coordinate that is not a finite number",
      "vertices have a coordinate that is not a finite number");
  add({.name = "index-out-of-range",
       .severity = Severity::refused,
       .domain = Domain::face,
       .indices = where(faces, [&](Index f) { return !in_range(mesh, f); }),
       .remedy = "Export the mesh again, or remove these faces: 'meshgraft repair' does."},
      "face names a vertex that does not exist", "faces name a vertex that does not exist");

  const auto degenerate = [&](Index f) { return is_degenerate(mesh.faces[f]); };
  const auto without_area = [&](Index f) {
    if (!in_range(mesh, f) || degenerate(f)) return false;
    for (const Index v : mesh.faces[f]) {
      if (!is_finite(mesh, v)) return false;
    }
    return has_no_area(mesh.faces[f], mesh.positions);
  };
  add({.name = "degenerate-face",
       .severity = Severity::repaired,
       .domain = Domain::face,
       .indices = where(faces, degenerate),
       .remedy = "Repeated corners are skipped; the file keeps them."},
      "face has fewer than three corners or a vertex twice",
      "faces have fewer than three corners or a vertex twice");
  add({.name = "zero-area-face",
       .severity = Severity::repaired,
       .domain = Domain::face,
       .indices = where(faces, without_area),
       .remedy = "Weights and normals leave them out; the file keeps them."},
      "face has no area", "faces have no area");

  context.step("check", 0.2);
  const EdgeTable table(vertices, mesh.faces);
  context.step("check", 0.6);
  const std::vector<Index> fans = fan_counts(mesh, table);
  const auto crowded = where(table.edge_count(), [&](Index e) { return table.half_edges[e].size() > 2; });
  const auto against =
      where(table.edge_count(), [&](Index e) { return consistently_oriented(mesh, table, e) == false; });
  add({.name = "isolated-vertex",
       .severity = Severity::repaired,
       .domain = Domain::vertex,
       .indices = where(vertices, [&](Index v) { return fans[v] == 0; }),
       .remedy = "They keep their place and their line in the file."},
      "vertex belongs to no face", "vertices belong to no face");
  add({.name = "duplicate-vertex",
       .severity = Severity::repaired,
       .domain = Domain::vertex,
       .indices = torn_vertices(mesh, table),
       .remedy = "The surface is open between them: as a soup of faces, or along a seam. 'meshgraft repair' "
                 "welds them "
                 "for good."},
      "boundary vertex lies where another does", "boundary vertices lie where others do");
  add({.name = "non-manifold-edge",
       .severity = Severity::note,
       .count = count_of(crowded),
       .domain = Domain::vertex,
       .indices = ends_of(table, crowded),
       .remedy = "A loop there cannot be merged: take faces away until each edge has two at most."},
      "edge has more than two faces", "edges have more than two faces");
  add({.name = "non-manifold-vertex",
       .severity = Severity::note,
       .domain = Domain::vertex,
       .indices = where(vertices, [&](Index v) { return fans[v] > 1; }),
       .remedy = "A loop there cannot be merged: give each fan a vertex of its own, or take one away."},
      "vertex joins separate fans of faces", "vertices join separate fans of faces");
  add({.name = "duplicate-face",
       .severity = Severity::note,
       .domain = Domain::face,
       .indices = repeated_faces(mesh, table),
       .remedy = "Their edges have faces too many: take all but one of them away."},
      "face has the corners of an earlier one", "faces have the corners of an earlier one");
  add({.name = "inconsistent-winding",
       .severity = Severity::note,
       .count = count_of(against),
       .domain = Domain::vertex,
       .indices = ends_of(table, against),
       .remedy = "Normals there are unreliable, and a loop there cannot be merged: make the faces' orientation "
                 "consistent (a Möbius strip has none: cut it open)."},
      "edge has two faces that are wound against each other",
      "edges have two faces that are wound against each other");
  context.step("check", 0.9);
  add({.name = "inward-facing-component",
       .severity = Severity::note,
       .domain = Domain::vertex,
       .indices = inward_components(mesh, table, context).components,
       .remedy = "Its normals point into it: turn its faces over."},
      "closed part faces inward (its first vertex is named)",
      "closed parts face inward (their first vertices are named)");
  add({.name = "polygon",
       .severity = Severity::note,
       .domain = Domain::face,
       .indices = where(faces, [&](Index f) { return mesh.faces[f].size() > 3; }),
       .remedy = "They are solved on their triangles and written as they were."},
      "face has more than three corners", "faces have more than three corners");
  context.step("check", 1);
  return report;
}

bool Diagnostics::has_defects() const {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.name != "polygon"; });
}

void require_usable(const Diagnostics& report, const Mesh& mesh, std::span<const Index> reach,
                    const std::string& name) {
  Flags within(mesh.vertex_count(), reach.empty());
  for (const Index v : reach) {
    if (is_vertex_of(mesh, v)) within[v] = true;
  }
  const auto touches = [&](const Finding& finding, Index i) {
    if (finding.domain == Domain::vertex) return is_vertex_of(mesh, i) && within[i];
    if (i < 0 || i >= mesh.face_count()) return false;
    const auto corners = mesh.faces[i];
    return reach.empty() || std::any_of(corners.begin(), corners.end(),
                                        [&](Index v) { return is_vertex_of(mesh, v) && within[v]; });
  };
  for (const Finding& finding : report.findings) {
    if (finding.severity != Severity::refused) continue;
    std::vector<Index> here;
    for (const Index i : finding.indices) {
      if (touches(finding, i)) here.push_back(i);
    }
    if (here.empty()) continue;
    const std::string kind = finding.domain == Domain::vertex ? "vertex " : "face ";
    const std::string first = (reach.empty() ? "" : "within reach: ") + kind + list_first(here);
    throw Error(ErrorCode::input, finding.description + " (" + first + ")", name, finding.remedy);
  }
}

}  // namespace meshgraft
