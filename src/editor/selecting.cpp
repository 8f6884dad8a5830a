#include "selecting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>

#include "core/facts.h"
#include "editor/facts.h"
#include "script/selection_resolver.h"

namespace meshgraft::editor {

namespace {

Index vertex_in(const json::Value& value, const Object& base) {
  const Index vertex = value.vertex();
  if (vertex >= base.mesh().vertex_count())
    value.fail(facts::core::NoSuchVertex{.vertex = vertex, .count = base.mesh().vertex_count()});
  return base.weld.of(vertex);
}

std::vector<Index> component_of(Index vertex, const SelectionMesh& context) {
  const std::vector<Index>& components = context.components;
  std::vector<Index> found;
  for (std::size_t v = 0; v < components.size(); ++v)
    if (components[v] == components[vertex]) found.push_back(static_cast<Index>(v));
  return components[vertex] < 0 ? std::vector<Index>{vertex} : found;
}

std::vector<Index> loop_of(const json::Value& value, Index vertex, const SelectionMesh& context) {
  for (std::vector<Index> loop : context.loops) {
    if (std::find(loop.begin(), loop.end(), vertex) == loop.end()) continue;
    std::sort(loop.begin(), loop.end());
    return loop;
  }
  value.fail(facts::editor::VertexOffLoops{.vertex = vertex});
}

using Edge = std::array<Index, 3>;  // the two ends, and a triangle

// Returns each edge of each triangle, sorted so that equal edges are adjacent.
std::vector<Edge> edges_of(const Object& base) {
  std::vector<Edge> edges;
  edges.reserve(3 * base.triangles.rows());
  for (Index t = 0; t < base.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = base.weld.of(base.triangles(t, k)), b = base.weld.of(base.triangles(t, (k + 1) % 3));
      edges.push_back({std::min(a, b), std::max(a, b), t});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Resolves a selection as a named one of the document, so that it may use others and is checked like them.
std::vector<Index> resolve_asked(const json::Value& value, const Document& document, const Object& base,
                                 const Folders& folders) {
  const std::string name = "what is asked for";
  Json with = document.json;
  with["selections"][name] = value.raw();
  const Document asked = make_document(with, document.edit.base_folder);
  for (const auto& file : referenced_files(asked.edit)) folders.inside(file);
  SelectionResolver resolver(asked.edit, *base.selections, base.state().produced);
  return resolver.vertices({EditSelection::Named{name}}, value.location());
}

}  // namespace

std::vector<Index> flood(const Object& base, Index vertex, double angle_deg) {
  const Triangles& triangles = base.triangles;
  const Points& points = base.mesh().positions;
  const auto normal_of = [&](Index t) {
    const Eigen::RowVector3d a = points.row(triangles(t, 0)), b = points.row(triangles(t, 1)),
                             c = points.row(triangles(t, 2));
    return (b - a).cross(c - a).eval();
  };
  const auto bends_more = [&](Index t, Index u) {
    const Eigen::RowVector3d a = normal_of(t), b = normal_of(u);
    return std::atan2(a.cross(b).norm(), a.dot(b)) > angle_deg * std::numbers::pi / 180;
  };
  std::vector<std::vector<Index>> next(triangles.rows());
  const std::vector<Edge> edges = edges_of(base);
  for (std::size_t e = 0; e + 1 < edges.size(); ++e)
    for (std::size_t f = e + 1; f < edges.size() && edges[f][0] == edges[e][0] && edges[f][1] == edges[e][1];
         ++f) {
      if (bends_more(edges[e][2], edges[f][2])) continue;
      next[edges[e][2]].push_back(edges[f][2]);
      next[edges[f][2]].push_back(edges[e][2]);
    }
  std::vector<Index> reached, waiting;
  Flags seen(next.size(), 0);
  for (Index t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      if (base.weld.of(triangles(t, k)) == vertex && std::exchange(seen[t], 1) == 0) waiting.push_back(t);
  while (!waiting.empty()) {
    const Index t = waiting.back();
    waiting.pop_back();
    for (int k = 0; k < 3; ++k) reached.push_back(base.weld.of(triangles(t, k)));
    for (const Index u : next[t])
      if (std::exchange(seen[u], 1) == 0) waiting.push_back(u);
  }
  std::sort(reached.begin(), reached.end());
  reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
  return reached;
}

std::vector<Index> select_vertices(const json::Value& value, const Document& document, const Object& base,
                                   const Folders& folders) {
  if (value.is_object() && value.raw().contains("flood")) {
    json::Object(value, {"flood"});
    const json::Value asked = value.member("flood");
    const json::Object fields(asked, {"vertex", "angle_deg"});
    return flood(base, vertex_in(fields.required("vertex"), base),
                 fields.required("angle_deg").number_in(0, 180));
  }
  if (value.is_object() && value.raw().contains("component_of"))
    return component_of(vertex_in(json::Object(value, {"component_of"}).required("component_of"), base),
                        *base.selections);
  if (value.is_object() && value.raw().contains("loop_of")) {
    const json::Value asked = json::Object(value, {"loop_of"}).required("loop_of");
    return loop_of(asked, vertex_in(asked, base), *base.selections);
  }
  return resolve_asked(value, document, base, folders);
}

}  // namespace meshgraft::editor
