#include "merge/closed_drops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/deform/quality.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "mesh/area_vector.h"
#include "mesh/box_diagonal.h"
#include "mesh/edge_table.h"
#include "support/paths.h"

namespace meshgraft::test {

namespace {

/// A model: a sample, or a file of the public test data.
struct Source {
  const char* name;
  const char* file = nullptr;
};

constexpr std::array<Source, closed_models> sources{{{"octopus"},
                                                     {"head"},
                                                     {"bust"},
                                                     {"dinosaur"},
                                                     {"cactus"},
                                                     {"bracket"},
                                                     {"bar"},
                                                     {"torus"},
                                                     {"knot"},
                                                     {"cylinder"},
                                                     {"bunny", "models/bunny.ply"},
                                                     {"small cactus", "models/cactus.obj"},
                                                     {"dinosaur with ribs", "models/dinosaur.ply"},
                                                     {"feline", "models/feline.ply"},
                                                     {"horse", "models/horse_8k.ply"},
                                                     {"mannequin", "models/mannequin.ply"},
                                                     {"octopus with suckers", "models/octopus.ply"},
                                                     {"skull", "models/skull.ply"},
                                                     {"tentacle", "open/tentacle.ply"},
                                                     {"capped tube", "procedural/capped_tube.ply"}}};
constexpr std::array<Source, places_of_a_model> targets{
    {{"bust"}, {"bumpy_plane"}, {"head"}, {"bar"}, {"bunny", "models/bunny.ply"}}};

std::optional<Mesh> load(const Source& source, int resolution) {
  if (source.file == nullptr) return make_sample(source.name, resolution);
  const std::filesystem::path path = data_folder() / source.file;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return read_mesh(path);
}

/// Returns the vertices that are not on a boundary.
std::vector<Index> places_on(const Mesh& mesh) {
  Flags at_boundary(mesh.vertex_count(), 0);
  for (const auto& loop : boundary_loops(mesh))
    for (const Index v : loop) at_boundary[v] = 1;
  std::vector<Index> places;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (at_boundary[v] == 0) places.push_back(v);
  return places;
}

Flags marked(const Mesh& mesh, const DropResult& result) {
  Flags near(mesh.vertex_count(), 0);
  for (const Index v : result.merge.band) near[v] = 1;
  for (const Index face : result.merge.new_faces)
    for (const Index v : mesh.faces[face]) near[v] = 1;
  return near;
}

Index folded_edges(const Mesh& mesh, const Flags& near) {
  const double folded = std::cos(160 * std::numbers::pi / 180);
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  std::vector<Index> face_of;
  for (Index f = 0; f < mesh.face_count(); ++f) face_of.insert(face_of.end(), mesh.faces[f].size(), f);
  Index count = 0;
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (near[table.ends[e][0]] == 0 || near[table.ends[e][1]] == 0 || table.half_edges[e].size() != 2) continue;
    const Eigen::Vector3d a = area_vector(mesh.faces[face_of[table.half_edges[e][0]]], mesh.positions),
                          b = area_vector(mesh.faces[face_of[table.half_edges[e][1]]], mesh.positions);
    count += a.dot(b) < folded * a.norm() * b.norm() ? 1 : 0;
  }
  return count;
}

}  // namespace

std::optional<Mesh> closed_model(int number, int resolution, std::string& name) {
  const Source& source = sources.at(static_cast<std::size_t>(number));
  name = source.name;
  std::optional<Mesh> mesh = load(source, resolution);
  if (mesh && !boundary_loops(*mesh).empty()) {
    constexpr Index any_hole = 100000;
    mesh = repair(*mesh, {.hole_edges = any_hole, .hole_fill = HoleFill::refined}).mesh;
  }
  return mesh;
}

std::optional<ClosedDrop> closed_drop(int model, int place, int resolution) {
  constexpr double part_size = 0.4;
  const Source& on = targets.at(static_cast<std::size_t>((model + place) % places_of_a_model));
  ClosedDrop drop;
  std::optional<Mesh> source = closed_model(model, resolution, drop.name), target = load(on, resolution);
  if (!source || !target) return std::nullopt;
  drop.name += fmt::format(" on {}, place {}", on.name, place);
  drop.source = *std::move(source);
  drop.target = *std::move(target);
  drop.source.positions *=
      part_size * box_diagonal(drop.target.positions) / box_diagonal(drop.source.positions);
  const std::vector<Index> places = places_on(drop.target);
  std::mt19937 random(static_cast<std::mt19937::result_type>(1 + 100 * model + place));
  drop.vertex = places[random() % places.size()];
  return drop;
}

std::vector<std::string> faults_of(const ClosedDrop& drop, const DropResult& result) {
  std::vector<std::string> faults;
  const Mesh& mesh = result.merge.mesh;
  const TopologySummary before = summarise_topology(drop.target), after = summarise_topology(mesh);
  if (!mesh.positions.allFinite()) faults.emplace_back("coordinates that are not finite");
  if (!after.manifold || !after.oriented) faults.emplace_back("no oriented manifold");
  if (after.closed != before.closed) faults.emplace_back("not closed");
  if (after.components != before.components) faults.push_back(fmt::format("{} components", after.components));
  if (result.merge.report.shape.inverted > 0)
    faults.push_back(fmt::format("{} inverted maps", result.merge.report.shape.inverted));
  const Flags near = marked(mesh, result);
  if (const Index folds = folded_edges(mesh, near); folds > 0)
    faults.push_back(fmt::format("{} folded edges", folds));
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (near[v] != 0) vertices.push_back(v);
  const Triangles triangles = triangulate(mesh).triangles;
  const auto pairs = self_intersections(mesh.positions, triangles, vertices);
  const auto is_near = [&](Index t) {
    return near[triangles(t, 0)] != 0 && near[triangles(t, 1)] != 0 && near[triangles(t, 2)] != 0;
  };
  const auto crossing = std::count_if(pairs.begin(), pairs.end(), [&](const TrianglePair& pair) {
    return is_near(pair[0]) || is_near(pair[1]);
  });
  if (crossing > 0) faults.push_back(fmt::format("{} intersections of seam or band", crossing));
  return faults;
}

}  // namespace meshgraft::test
