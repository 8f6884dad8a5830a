#include <meshgraft/mesh/triage.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "edge_table.h"
#include "fans.h"

namespace meshgraft {

namespace {

std::vector<Index> indices_where(Index count, const std::function<bool(Index)>& predicate) {
  std::vector<Index> indices;
  for (Index i = 0; i < count; ++i) {
    if (predicate(i)) indices.push_back(i);
  }
  return indices;
}

bool finite(const Mesh& mesh, Index vertex) { return mesh.positions.row(vertex).allFinite(); }

bool valid_index(const Mesh& mesh, Index vertex) { return vertex >= 0 && vertex < mesh.vertex_count(); }

bool in_range(const Mesh& mesh, Index face) {
  const auto corners = mesh.faces[face];
  return std::all_of(corners.begin(), corners.end(), [&](Index v) { return valid_index(mesh, v); });
}

bool is_degenerate(std::span<const Index> face) {
  if (face.size() < 3) return true;
  if (face.size() == 3) return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
  std::vector<Index> sorted(face.begin(), face.end());
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

bool has_no_area(std::span<const Index> face, const Points& positions) {
  constexpr double area_rel = 1e-12;
  constexpr double ulps = 4;
  const std::size_t n = face.size();
  Eigen::Vector3d area = Eigen::Vector3d::Zero();  // Newell's normal: twice the area
  double longest = 0;
  double largest = 0;
  for (std::size_t c = 0; c < n; ++c) {
    const Eigen::Vector3d a = positions.row(face[c]) - positions.row(face[0]);
    const Eigen::Vector3d b = positions.row(face[(c + 1) % n]) - positions.row(face[0]);
    area += a.cross(b);
    longest = std::max(longest, (b - a).norm());
    largest = std::max(largest, positions.row(face[c]).cwiseAbs().maxCoeff());
  }
  const double precision = ulps * std::numeric_limits<double>::epsilon() * largest;
  return area.norm() <= std::max(area_rel * longest, precision) * longest;
}

std::vector<Index> ends_of(const EdgeTable& table, std::span<const Index> edges) {
  std::vector<Index> ends;
  for (const Index e : edges) ends.insert(ends.end(), table.ends[e].begin(), table.ends[e].end());
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
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

const Finding* TriageReport::find(std::string_view name) const {
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [&](const Finding& finding) { return finding.name == name; });
  return found == findings.end() ? nullptr : &*found;
}

TriageReport triage(const Mesh& mesh, const Context& context) {
  TriageReport report;
  const auto add = [&](Finding finding, const std::string& one, const std::string& many) {
    if (finding.count == 0) finding.count = static_cast<Index>(finding.indices.size());
    finding.description = counted(finding.count, one, many);
    if (finding.count > 0) report.findings.push_back(std::move(finding));
  };
  const auto count_of = [](const std::vector<Index>& list) { return static_cast<Index>(list.size()); };

  context.step("triage", 0);
  const Index vertices = mesh.vertex_count();
  const Index faces = mesh.face_count();
  add({.name = "non-finite",
       .severity = Severity::refused,
       .domain = Domain::vertex,
       .indices = indices_where(vertices, [&](Index v) { return !finite(mesh, v); }),
       .remedy = "Remove these vertices or give them finite coordinates."},
      "vertex has a coordinate that is not a finite number",
      "vertices have a coordinate that is not a finite number");
  add({.name = "index-out-of-range",
       .severity = Severity::refused,
       .domain = Domain::face,
       .indices = indices_where(faces, [&](Index f) { return !in_range(mesh, f); }),
       .remedy = "Remove these faces or export the mesh again."},
      "face names a vertex that does not exist", "faces name a vertex that does not exist");

  const auto degenerate = [&](Index f) { return is_degenerate(mesh.faces[f]); };
  const auto without_area = [&](Index f) {
    if (!in_range(mesh, f) || degenerate(f)) return false;
    for (const Index v : mesh.faces[f]) {
      if (!finite(mesh, v)) return false;
    }
    return has_no_area(mesh.faces[f], mesh.positions);
  };
  add({.name = "degenerate-face",
       .severity = Severity::repaired,
       .domain = Domain::face,
       .indices = indices_where(faces, degenerate),
       .remedy = "Repeated corners are skipped; the file keeps them."},
      "face has fewer than three corners or a vertex twice",
      "faces have fewer than three corners or a vertex twice");
  add({.name = "zero-area-face",
       .severity = Severity::repaired,
       .domain = Domain::face,
       .indices = indices_where(faces, without_area),
       .remedy = "Weights and normals leave them out; the file keeps them."},
      "face has no area", "faces have no area");

  context.step("triage", 0.5);
  const EdgeTable table(vertices, mesh.faces);
  const std::vector<Index> fans = fan_counts(mesh, table);
  const auto crowded =
      indices_where(table.edge_count(), [&](Index e) { return table.half_edges[e].size() > 2; });
  const auto against =
      indices_where(table.edge_count(), [&](Index e) { return wound_alike(mesh, table, e) == false; });
  add({.name = "isolated-vertex",
       .severity = Severity::repaired,
       .domain = Domain::vertex,
       .indices = indices_where(vertices, [&](Index v) { return fans[v] == 0; }),
       .remedy = "They keep their place and their line in the file."},
      "vertex belongs to no face", "vertices belong to no face");
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
       .indices = indices_where(vertices, [&](Index v) { return fans[v] > 1; }),
       .remedy = "A loop there cannot be merged: give each fan a vertex of its own, or take one away."},
      "vertex joins separate fans of faces", "vertices join separate fans of faces");
  add({.name = "inconsistent-winding",
       .severity = Severity::note,
       .count = count_of(against),
       .domain = Domain::vertex,
       .indices = ends_of(table, against),
       .remedy = "Normals there are unreliable, and a loop there cannot be merged: make the faces' orientation "
                 "consistent (a Möbius strip has none: cut it open)."},
      "edge has two faces that are wound against each other",
      "edges have two faces that are wound against each other");
  add({.name = "polygon",
       .severity = Severity::note,
       .domain = Domain::face,
       .indices = indices_where(faces, [&](Index f) { return mesh.faces[f].size() > 3; }),
       .remedy = "They are solved on their triangles and written as they were."},
      "face has more than three corners", "faces have more than three corners");
  context.step("triage", 1);
  return report;
}

void require_usable(const TriageReport& report, const Mesh& mesh, std::span<const Index> reach,
                    const std::string& name) {
  std::vector<bool> within(mesh.vertex_count(), reach.empty());
  for (const Index v : reach) {
    if (valid_index(mesh, v)) within[v] = true;
  }
  const auto touches = [&](const Finding& finding, Index i) {
    if (finding.domain == Domain::vertex) return valid_index(mesh, i) && within[i];
    if (i < 0 || i >= mesh.face_count()) return false;
    const auto corners = mesh.faces[i];
    return reach.empty() || std::any_of(corners.begin(), corners.end(),
                                        [&](Index v) { return valid_index(mesh, v) && within[v]; });
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
