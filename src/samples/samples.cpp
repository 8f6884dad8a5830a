#include <meshgraft/samples/samples.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <ranges>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/parallel.h"
#include "isosurface.h"
#include "mesh/up_axis.h"
#include "models.h"
#include "samples/facts.h"

namespace meshgraft {

namespace {

using namespace samples;

constexpr int smallest_resolution = 4, largest_resolution = 4096;

struct Entry {
  SampleInfo info;
  SculptedModel (*sculpt)();
  Mesh (*build)(int resolution);
};

constexpr std::array<Entry, 12> entries{{
    {{"octopus", "an octopus with eight curling arms and their suckers", 160}, octopus, nullptr},
    {{"head", "a human head on a neck that ends in a boundary loop", 170}, head, nullptr},
    {{"bust", "shoulders and a neck that ends in a boundary loop, for the head", 100}, bust, nullptr},
    {{"dinosaur", "a four-legged animal with a long neck and tail", 150}, dinosaur, nullptr},
    {{"cactus", "a ribbed cactus with three arms and flowers", 130}, cactus, nullptr},
    {{"bracket", "a flange on four pipes that end in boundary loops, for the posts", 130}, bracket, nullptr},
    {{"posts", "four posts of different widths that end in boundary loops, for the bracket", 100},
     posts,
     nullptr},
    {{"bumpy_plane", "a square sheet with noise bumps", 100}, nullptr, bumpy_plane},
    {{"bar", "a closed 1 × 1 × 4 bar of square section", 100}, nullptr, bar},
    {{"cylinder", "an open tube, 1 across and 4 high", 100}, nullptr, cylinder},
    {{"torus", "a ring, 2.8 across", 100}, nullptr, torus},
    {{"knot", "a trefoil knot of a round tube", 100}, nullptr, knot},
}};

constexpr auto infos = [] {
  std::array<SampleInfo, entries.size()> list{};
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = entries[i].info;
  return list;
}();

Location location_of(std::string_view name) { return Location::place("sample \"" + std::string(name) + '"'); }

const Entry& find_entry(std::string_view name) {
  for (const Entry& entry : entries)
    if (entry.info.name == name) return entry;
  throw Error(
      facts::samples::NoSuchSample{.name = name, .known = infos | std::views::transform(&SampleInfo::name)},
      location_of(name));
}

// Flags the triangles to keep: those on the right side of the cut, in the largest connected components.
Flags kept_triangles(const Surface& surface, const SculptedModel& model) {
  const auto& triangles = surface.triangles;
  Flags keep(triangles.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (triangles[t][0] < 0) continue;
    keep[t] = !model.cut;
    for (const int v : triangles[t]) {
      const auto i = static_cast<std::size_t>(v);
      if (model.cut && !surface.on_cut[i])
        keep[t] = (surface.points[i].z() > model.cut_height) == model.keep_above;
    }
  }
  std::vector<int> part(triangles.size(), -1), stack;
  std::vector<int> sizes;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (!keep[seed] || part[seed] >= 0) continue;
    const int number = static_cast<int>(sizes.size());
    sizes.push_back(0);
    part[seed] = number;
    stack.push_back(static_cast<int>(seed));
    while (!stack.empty()) {
      const int t = stack.back();
      stack.pop_back();
      ++sizes.back();
      for (int c = 0; c < 3; ++c) {
        const auto u = static_cast<std::size_t>(
            surface.twin[3 * static_cast<std::size_t>(t) + static_cast<std::size_t>(c)] / 3);
        if (!keep[u] || part[u] >= 0) continue;
        part[u] = number;
        stack.push_back(static_cast<int>(u));
      }
    }
  }
  std::vector<int> by_size(sizes.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  std::stable_sort(by_size.begin(), by_size.end(), [&](int a, int b) { return sizes[a] > sizes[b]; });
  by_size.resize(std::min(by_size.size(), static_cast<std::size_t>(model.parts)));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    keep[t] = keep[t] && std::find(by_size.begin(), by_size.end(), part[t]) != by_size.end();
  return keep;
}

Mesh to_mesh(const Surface& surface, const Flags& keep) {
  std::vector<Index> number(surface.points.size(), -1);
  Index vertices = 0, faces = 0;
  for (std::size_t t = 0; t < keep.size(); ++t) {
    if (!keep[t]) continue;
    ++faces;
    for (const int v : surface.triangles[t])
      if (number[v] < 0) number[v] = vertices++;
  }
  Mesh mesh;
  mesh.positions.resize(vertices, 3);
  for (std::size_t v = 0; v < number.size(); ++v)
    if (number[v] >= 0) mesh.positions.row(number[v]) = surface.points[v].transpose();
  mesh.faces.reserve(faces, 3 * faces);
  for (std::size_t t = 0; t < keep.size(); ++t) {
    if (!keep[t]) continue;
    Index face[3];
    for (std::size_t c = 0; c < 3; ++c) face[c] = number[surface.triangles[t][c]];
    mesh.faces.push_back(face);
  }
  return mesh;
}

void add_colours(Mesh& mesh, const SparseField& field, const Context& context) {
  Attribute colour;
  colour.name = "colour";
  colour.type = ScalarType::uint8;
  colour.components = 3;
  colour.source_names = {"red", "green", "blue"};
  colour.values.resize(3 * static_cast<std::size_t>(mesh.vertex_count()));
  parallel_blocks(
      mesh.vertex_count(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          const Vec3 c = field.colour(mesh.positions.row(static_cast<Eigen::Index>(v)).transpose());
          for (std::size_t k = 0; k < 3; ++k)
            colour.values[3 * v + k] =
                std::round(255.0 * std::clamp(c[static_cast<Eigen::Index>(k)], 0.0, 1.0));
        }
      },
      context);
  mesh.attributes.push_back(std::move(colour));
}

// At a lower resolution the edges would be longer than the thinnest details.
constexpr int smallest_sculpture = 24;

Mesh mesh_sculpture(const SculptedModel& model, int resolution, const Context& context) {
  resolution = std::max(resolution, smallest_sculpture);
  const double edge = std::sqrt(model.area / (std::sqrt(0.75) * resolution * resolution));
  const double cell = std::min(1.7 * edge, model.finest_cell);
  context.step("find_surface", 0.0);
  const SparseField field(model.sculpture, cell, context);
  context.step("find_surface", 0.3);
  Surface surface = polygonise(field, context);
  RemeshOptions options{.edge_length = edge, .iterations = model.cut ? 4 : 6};
  remesh(surface, field, options, context);
  if (model.cut) {
    mark_cut(surface, model.cut_height, options);
    remesh(surface, field, options, context);
  }
  Mesh mesh = to_mesh(surface, kept_triangles(surface, model));
  add_colours(mesh, field, context);
  context.step("shape_triangles", 1.0);
  return mesh;
}

}  // namespace

std::span<const SampleInfo> sample_list() { return infos; }

Mesh make_sample(std::string_view name, int resolution, const Context& context) {
  const Entry& entry = find_entry(name);
  if (resolution == 0) resolution = entry.info.default_resolution;
  if (resolution < smallest_resolution || resolution > largest_resolution)
    throw Error(
        facts::core::OutOfRange{.value = resolution, .low = smallest_resolution, .high = largest_resolution},
        location_of(name) / "resolution");
  context.throw_if_stopped();
  Mesh mesh = entry.build ? entry.build(resolution) : mesh_sculpture(entry.sculpt(), resolution, context);
  mesh.source = std::make_shared<const FilelessSource>(UpAxis::z);
  return mesh;
}

}  // namespace meshgraft
