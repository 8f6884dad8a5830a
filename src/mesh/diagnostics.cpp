#include <meshgraft/mesh/diagnostics.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "checked_surface.h"
#include "closed_components.h"
#include "coincident.h"
#include "core/parallel.h"
#include "edge_table.h"
#include "face_defects.h"
#include "face_keys.h"
#include "fans.h"
#include "mesh/facts.h"
#include "outlying.h"

namespace meshgraft {

namespace {

// A function that returns a note about a number of elements.
using CountedNote = Note (*)(Index count);

// Returns the note of a class that has the field `count` alone.
template <class Class>
Note counted(Index count) {
  return Class{.count = count};
}

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

// Returns how many radii of the others a vertex is away from their centre.
double radii_away(const OutlyingVertices& outlying, const Mesh& mesh, Index v) {
  return outlying.distance(mesh.positions.row(v)) / outlying.radius;
}

void add_outlying(const Mesh& mesh, const OutlyingVertices& outlying, std::vector<Finding>& findings) {
  if (const auto count = static_cast<Index>(outlying.far.size()); count > 0) {
    const Index v = outlying.far.front();
    findings.push_back({FindingKind::outlying_vertex, Severity::refused, count, Domain::vertex, outlying.far,
                        facts::mesh::OutlyingVertex{.count = count,
                                                    .vertex = v,
                                                    .x = mesh.positions(v, 0),
                                                    .y = mesh.positions(v, 1),
                                                    .z = mesh.positions(v, 2),
                                                    .times = radii_away(outlying, mesh, v)}});
  }
  if (const auto count = static_cast<Index>(outlying.too_large.size()); count > 0) {
    double size = 0;
    for (const Index v : outlying.too_large) size = std::max(size, mesh.positions.row(v).cwiseAbs().maxCoeff());
    findings.push_back({FindingKind::coordinate_too_large, Severity::refused, count, Domain::vertex,
                        outlying.too_large, facts::mesh::TooLarge{.count = count, .size = size}});
  }
}

// Returns the inward-facing components. The volume of one with an outlying vertex is that vertex's alone, and
// tells nothing.
template <class Surface>
std::vector<Index> inward(const Mesh& mesh, const Surface& surface, const OutlyingVertices& outlying,
                          const Context& context) {
  auto [component, components] = inward_components(mesh, surface, context);
  for (const Index v : outlying.far) std::erase(components, component[v]);
  return std::move(components);
}

// Returns the error for a refused finding. `here` are the first of its elements that an edit reaches.
Error refusal(const Finding& finding, const Mesh& mesh, std::span<const Index> here, const std::string& name) {
  const Location location = Location::file(name);
  const auto at = [&](int axis) { return mesh.positions(here.front(), axis); };
  switch (finding.kind) {
    case FindingKind::non_finite:
      return {facts::mesh::NonFiniteWithinReach{.count = finding.count, .first = here}, location};
    case FindingKind::outlying_vertex:
      return {
          facts::mesh::OutlyingVertexWithinReach{.count = finding.count,
                                                 .first = here,
                                                 .x = at(0),
                                                 .y = at(1),
                                                 .z = at(2),
                                                 .times = radii_away(find_outlying(mesh), mesh, here.front())},
          location};
    case FindingKind::coordinate_too_large:
      return {facts::mesh::CoordinateTooLarge{.vertex = here.front(),
                                              .size = mesh.positions.row(here.front()).cwiseAbs().maxCoeff()},
              location / Location::place(fmt::format("vertex {}", here.front()))};
    default: return {facts::mesh::IndexOutOfRangeWithinReach{.count = finding.count, .first = here}, location};
  }
}

}  // namespace

std::string_view name_of(FindingKind kind) {
  switch (kind) {
    case FindingKind::non_finite: return "non-finite";
    case FindingKind::outlying_vertex: return "outlying-vertex";
    case FindingKind::coordinate_too_large: return "coordinate-too-large";
    case FindingKind::index_out_of_range: return "index-out-of-range";
    case FindingKind::degenerate_face: return "degenerate-face";
    case FindingKind::zero_area_face: return "zero-area-face";
    case FindingKind::isolated_vertex: return "isolated-vertex";
    case FindingKind::duplicate_vertex: return "duplicate-vertex";
    case FindingKind::non_manifold_edge: return "non-manifold-edge";
    case FindingKind::non_manifold_vertex: return "non-manifold-vertex";
    case FindingKind::duplicate_face: return "duplicate-face";
    case FindingKind::inconsistent_winding: return "inconsistent-winding";
    case FindingKind::inward_facing_component: return "inward-facing-component";
    case FindingKind::polygon: return "polygon";
  }
  return "";
}

const Finding* Diagnostics::find(FindingKind kind) const {
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [&](const Finding& finding) { return finding.kind == kind; });
  return found == findings.end() ? nullptr : &*found;
}

namespace {

// Collects findings, worst first. A kind without elements is no finding.
class Findings {
 public:
  explicit Findings(Diagnostics& report) : report_(report) {}
  void add(FindingKind kind, Severity severity, Domain domain, CountedNote note, std::vector<Index> indices,
           std::size_t edges = 0) {
    const auto count = static_cast<Index>(edges > 0 ? edges : indices.size());
    if (count > 0) report_.findings.push_back({kind, severity, count, domain, std::move(indices), note(count)});
  }

 private:
  Diagnostics& report_;
};

// Adds the findings about vertices and faces one by one.
void add_elements(const Mesh& mesh, const OutlyingVertices& outlying, Findings& findings,
                  const Context& context) {
  const auto degenerate = [&](Index f) { return is_degenerate(mesh.faces[f]); };
  const auto without_area = [&](Index f) {
    if (!in_range(mesh, f) || degenerate(f)) return false;
    for (const Index v : mesh.faces[f]) {
      if (!is_finite(mesh, v) || std::ranges::binary_search(outlying.far, v)) return false;
    }
    return has_no_area(mesh.faces[f], mesh.positions);
  };
  findings.add(FindingKind::degenerate_face, Severity::worked_around, Domain::face,
               counted<facts::mesh::DegenerateFace>, indices_where(mesh.face_count(), degenerate, context));
  findings.add(FindingKind::zero_area_face, Severity::worked_around, Domain::face,
               counted<facts::mesh::ZeroAreaFace>, indices_where(mesh.face_count(), without_area, context));
}

void add_isolated(std::vector<Index> vertices, Findings& findings) {
  findings.add(FindingKind::isolated_vertex, Severity::worked_around, Domain::vertex,
               counted<facts::mesh::IsolatedVertex>, std::move(vertices));
}

void add_duplicates(std::vector<Index> vertices, Findings& findings) {
  findings.add(FindingKind::duplicate_vertex, Severity::worked_around, Domain::vertex,
               counted<facts::mesh::DuplicateVertex>, std::move(vertices));
}

void add_inward(std::vector<Index> vertices, Findings& findings) {
  findings.add(FindingKind::inward_facing_component, Severity::info, Domain::vertex,
               counted<facts::mesh::InwardFacingComponent>, std::move(vertices));
}

// Adds the findings about how faces are connected. A simple surface can have only three kinds of them.
void add_connections(const Mesh& mesh, const SimpleSurface& surface, const OutlyingVertices& outlying,
                     Findings& findings, const Context& context) {
  add_isolated(indices_where(
                   mesh.vertex_count(), [&](Index v) { return surface.faces_around[v].empty(); }, context),
               findings);
  add_duplicates(open_seam_vertices(mesh, surface), findings);
  context.step("check", 0.9);
  add_inward(inward(mesh, surface, outlying, context), findings);
}

void add_connections(const Mesh& mesh, const EdgeTable& table, const OutlyingVertices& outlying,
                     Findings& findings, const Context& context) {
  const auto where = [&](Index count, const auto& predicate) {
    return indices_where(count, predicate, context);
  };
  const std::vector<Index> fans = fan_counts(mesh, table);
  const auto non_manifold = where(table.edge_count(), [&](Index e) { return table.half_edges[e].size() > 2; });
  const auto against =
      where(table.edge_count(), [&](Index e) { return consistently_oriented(mesh, table, e) == false; });
  add_isolated(where(mesh.vertex_count(), [&](Index v) { return fans[v] == 0; }), findings);
  add_duplicates(open_seam_vertices(mesh, table), findings);
  findings.add(FindingKind::non_manifold_edge, Severity::info, Domain::vertex,
               counted<facts::mesh::NonManifoldEdge>, ends_of(table, non_manifold), non_manifold.size());
  findings.add(FindingKind::non_manifold_vertex, Severity::info, Domain::vertex,
               counted<facts::mesh::NonManifoldVertex>,
               where(mesh.vertex_count(), [&](Index v) { return fans[v] > 1; }));
  findings.add(FindingKind::duplicate_face, Severity::info, Domain::face, counted<facts::mesh::DuplicateFace>,
               repeated_faces(mesh, table));
  findings.add(FindingKind::inconsistent_winding, Severity::info, Domain::vertex,
               counted<facts::mesh::InconsistentWinding>, ends_of(table, against), against.size());
  context.step("check", 0.9);
  add_inward(inward(mesh, table, outlying, context), findings);
}

}  // namespace

CheckedSurface check_surface(const Mesh& mesh, const Context& context) {
  CheckedSurface checked;
  Diagnostics& report = checked.diagnostics;
  Findings findings(report);
  context.step("check", 0);
  findings.add(FindingKind::non_finite, Severity::refused, Domain::vertex, counted<facts::mesh::NonFinite>,
               indices_where(mesh.vertex_count(), [&](Index v) { return !is_finite(mesh, v); }, context));
  const OutlyingVertices outlying = find_outlying(mesh, context);
  context.throw_if_stopped();
  add_outlying(mesh, outlying, report.findings);
  findings.add(FindingKind::index_out_of_range, Severity::refused, Domain::face,
               counted<facts::mesh::IndexOutOfRange>,
               indices_where(mesh.face_count(), [&](Index f) { return !in_range(mesh, f); }, context));
  add_elements(mesh, outlying, findings, context);

  context.step("check", 0.2);
  checked.surface = find_simple_surface(mesh, context);
  context.step("check", 0.4);
  if (checked.surface) {
    add_connections(mesh, *checked.surface, outlying, findings, context);
  } else {
    const EdgeTable table(mesh.vertex_count(), mesh.faces, context);
    context.step("check", 0.6);
    add_connections(mesh, table, outlying, findings, context);
  }
  findings.add(FindingKind::polygon, Severity::info, Domain::face, counted<facts::mesh::Polygon>,
               indices_where(mesh.face_count(), [&](Index f) { return mesh.faces[f].size() > 3; }, context));
  context.step("check", 1);
  return checked;
}

Diagnostics check_mesh(const Mesh& mesh, const Context& context) {
  return check_surface(mesh, context).diagnostics;
}

bool Diagnostics::has_defects() const {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.kind != FindingKind::polygon; });
}

void require_sound(const Diagnostics& report, const Mesh& mesh, const RequireSoundOptions& options) {
  const bool whole_mesh = options.vertices.empty();
  Flags within(mesh.vertex_count(), whole_mesh);
  for (const Index v : options.vertices) {
    if (is_vertex_of(mesh, v)) within[v] = true;
  }
  const auto touches = [&](const Finding& finding, Index i) {
    if (finding.domain == Domain::vertex) return is_vertex_of(mesh, i) && within[i];
    if (i < 0 || i >= mesh.face_count()) return false;
    const auto corners = mesh.faces[i];
    return whole_mesh || std::any_of(corners.begin(), corners.end(),
                                     [&](Index v) { return is_vertex_of(mesh, v) && within[v]; });
  };
  for (const Finding& finding : report.findings) {
    if (finding.severity != Severity::refused) continue;
    std::vector<Index> here;
    for (const Index i : finding.indices) {
      if (touches(finding, i)) here.push_back(i);
    }
    if (here.empty()) continue;
    const auto first = std::span(here).first(std::min<std::size_t>(here.size(), 5));
    throw refusal(finding, mesh, first, options.name);
  }
}

}  // namespace meshgraft
