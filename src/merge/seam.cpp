#include "seam.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "core/facts.h"
#include "gap_fill.h"
#include "loops.h"
#include "merge/facts.h"
#include "mesh/area_vector.h"
#include "mesh/edge_table.h"
#include "mesh/join.h"
#include "ring_removal.h"
#include "seam_attributes.h"
#include "seam_colours.h"
#include "seam_fairing.h"
#include "seam_patch.h"
#include "seam_report.h"
#include "seam_texture.h"

namespace meshgraft {

namespace {

using Loop = std::vector<Index>;

void check_options(const SeamOptions& options) {
  const auto require = [](bool good, const auto& fact, const char* option) {
    if (!good) throw Error(fact, option);
  };
  require(options.edge_ratio >= 1, facts::merge::EdgeRatioBelowOne{.edge_ratio = options.edge_ratio},
          "edge_ratio");
  require(options.fairings >= 0, facts::core::Negative{.value = options.fairings}, "fairings");
  require(options.target_rings >= 0, facts::core::Negative{.value = options.target_rings}, "target_rings");
  require(options.source_rings >= 0, facts::core::Negative{.value = options.source_rings}, "source_rings");
  require(options.blend_colours >= 0, facts::core::Negative{.value = options.blend_colours}, "blend_colours");
  require(options.sharp_angle_deg >= 0 && options.sharp_angle_deg <= 180,
          facts::core::OutOfRange{.value = options.sharp_angle_deg, .low = 0, .high = 180}, "sharp_angle_deg");
}

// Returns the half-edges without a partner, from vertex to vertex.
std::unordered_map<Index, std::vector<Index>> border_steps(const Mesh& mesh) {
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  std::unordered_map<Index, std::vector<Index>> steps;
  for (Index c = 0; c < mesh.faces.corner_count(); ++c) {
    if (table.next[c] < 0 || !table.is_boundary(c)) continue;
    steps[mesh.faces.corners()[c]].push_back(mesh.faces.corners()[table.next[c]]);
  }
  return steps;
}

// Throws unless each loop is a simple boundary loop in the direction of its mesh's half-edges and shares no
// vertex with another.
void check_loops(const Mesh& mesh, facts::merge::Side side, const std::vector<const Loop*>& loops) {
  const char* which = side == facts::merge::Side::source ? "source loop" : "target loop";
  const auto steps = border_steps(mesh);
  std::unordered_map<Index, std::size_t> owner;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const Loop& loop = *loops[k];
    const Location location = Location::pair(k) / Location::place(which);
    if (loop.size() < 3) throw Error(facts::merge::LoopTooShort{.count = loop.size()}, location);
    for (const Index v : loop) {
      if (v >= 0 && v < mesh.vertex_count()) continue;
      throw Error(facts::merge::NoSuchVertex{.side = side, .vertex = v, .count = mesh.vertex_count()},
                  location);
    }
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Index a = loop[i], b = loop[(i + 1) % loop.size()];
      const auto [entry, is_new] = owner.emplace(a, k);
      if (!is_new && entry->second == k) throw Error(facts::merge::LoopPassesTwice{.vertex = a}, location);
      if (!is_new) throw Error(facts::merge::LoopsMeet{.pair = entry->second, .vertex = a}, location);
      if (!mesh.positions.row(a).allFinite())
        throw Error(facts::merge::VertexNotFinite{.side = side, .vertex = a}, location);
      const auto runs = [&](Index from, Index to) {
        const auto found = steps.find(from);
        return found != steps.end() && std::count(found->second.begin(), found->second.end(), to) > 0;
      };
      if (runs(a, b)) continue;
      if (runs(b, a)) throw Error(facts::merge::LoopRunsBackwards{.vertex = a}, location);
      throw Error(facts::merge::NoBoundaryEdge{.vertex = a, .next_vertex = b}, location);
    }
  }
}

// Returns the pairs in a canonical order, so that the given order does not matter.
std::vector<std::size_t> canonical_order(std::span<const LoopPair> pairs) {
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return *std::min_element(pairs[a].target.begin(), pairs[a].target.end()) <
           *std::min_element(pairs[b].target.begin(), pairs[b].target.end());
  });
  return order;
}

Loop beginning_with_smallest(Loop loop) {
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  return loop;
}

// The faces at the boundaries, by the two vertices in the order of the face's half-edge.
class BorderFaces {
 public:
  explicit BorderFaces(const Mesh& mesh) : mesh_(mesh) {
    const EdgeTable table(mesh.vertex_count(), mesh.faces);
    for (Index f = 0; f < mesh.face_count(); ++f) {
      for (Index c = mesh.faces.first_corner(f); c < mesh.faces.first_corner(f + 1); ++c) {
        if (table.next[c] < 0 || !table.is_boundary(c)) continue;
        face_[key(mesh.faces.corners()[c], mesh.faces.corners()[table.next[c]])] = f;
      }
    }
  }

  Index face(Index from, Index to) const { return face_.at(key(from, to)); }

  Eigen::RowVector3d normal(Index from, Index to) const {
    return area_vector(mesh_.faces[face(from, to)], mesh_.positions).transpose().normalized();
  }

 private:
  static std::uint64_t key(Index from, Index to) {
    return (static_cast<std::uint64_t>(from) << 32) | static_cast<std::uint32_t>(to);
  }

  const Mesh& mesh_;
  std::unordered_map<std::uint64_t, Index> face_;
};

// Returns a loop as a side of the gap. `with_half_edges`: in its listed order, else reversed.
GapSide gap_side(const Mesh& mesh, const BorderFaces& faces, Loop loop, bool with_half_edges) {
  if (!with_half_edges) std::reverse(loop.begin(), loop.end());
  const auto n = static_cast<Eigen::Index>(loop.size());
  GapSide side{std::move(loop), Points(n, 3), Points(n, 3)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const Index a = side.loop[k], b = side.loop[(k + 1) % n];
    side.points.row(k) = mesh.positions.row(a);
    side.face_normals.row(k) = with_half_edges ? faces.normal(a, b) : faces.normal(b, a);
  }
  return side;
}

// Returns, per triangle of a strip, the adjacent face of the target: the face at the triangle's edge, else
// the face at the edge from its vertex.
std::vector<Index> neighbours(const std::vector<std::array<Index, 3>>& triangles, const Loop& target_loop,
                              const BorderFaces& faces, Index target_vertices) {
  std::unordered_map<Index, Index> face_from;
  for (std::size_t k = 0; k < target_loop.size(); ++k) {
    face_from[target_loop[k]] = faces.face(target_loop[k], target_loop[(k + 1) % target_loop.size()]);
  }
  std::vector<Index> result;
  for (const auto& [a, b, c] : triangles) {
    // A triangle with a target edge is (i + 1, i, j); otherwise its last vertex is the target's.
    result.push_back(face_from.at(b < target_vertices ? b : c));
  }
  return result;
}

}  // namespace

SeamResult make_seam(const Mesh& target, const Mesh& source, std::span<const LoopPair> pairs,
                     const SeamOptions& options, const Context& context) {
  context.step("seam", 0);
  check_options(options);
  std::vector<const Loop*> target_loops, source_loops;
  for (const LoopPair& pair : pairs) {
    target_loops.push_back(&pair.target);
    source_loops.push_back(&pair.source);
  }
  check_loops(target, facts::merge::Side::target, target_loops);
  check_loops(source, facts::merge::Side::source, source_loops);
  const std::vector<std::size_t> order = canonical_order(pairs);

  // Remove the rings.
  context.step("seam", 0.1);
  std::vector<RingRequest> requests;
  for (const std::size_t k : order) {
    requests.push_back({beginning_with_smallest(pairs[k].target),
                        options.edge_ratio * mean_edge_length(source.positions(pairs[k].source, Eigen::all)),
                        Location::pair(k)});
  }
  const RingRemoval opened = remove_rings(target, requests, context);

  context.step("seam", 0.3);
  JoinResult joined = join(opened.mesh, source);
  SeamResult result;
  result.notes = std::move(joined.notes);
  result.mesh = std::move(joined.mesh);
  Mesh& mesh = result.mesh;
  for (const Index v : opened.vertex.new_index) {
    result.target.new_index.push_back(v < 0 ? -1 : joined.first.new_index[v]);
  }
  result.source = std::move(joined.second);
  const SeamLayout layout{opened.mesh.vertex_count(), opened.mesh.face_count(), source.face_count()};

  // Fill the gaps with strips.
  context.step("seam", 0.4);
  label_sides(mesh, layout);
  std::vector<std::array<Index, 3>> strips;
  std::vector<Index> beside;
  std::vector<StripLoops> loops;
  {
    const BorderFaces faces(mesh);
    for (std::size_t k = 0; k < order.size(); ++k) {
      Loop source_loop = beginning_with_smallest(pairs[order[k]].source);
      for (Index& v : source_loop) v += layout.target_vertices;
      const auto strip = fill_gap(gap_side(mesh, faces, opened.loops[k], true),
                                  gap_side(mesh, faces, source_loop, false), options.strip, context);
      const auto strip_beside = neighbours(strip, opened.loops[k], faces, layout.target_vertices);
      loops.push_back({opened.loops[k], source_loop});
      strips.insert(strips.end(), strip.begin(), strip.end());
      beside.insert(beside.end(), strip_beside.begin(), strip_beside.end());
    }
  }
  add_strip(mesh, strips, beside);
  continue_texture(mesh, layout.target_faces + layout.source_faces, beside);
  for (Index f = layout.target_faces + layout.source_faces; f < mesh.face_count(); ++f)
    result.new_faces.push_back(f);

  context.step("seam", 0.5);
  if (source.find_attribute(Domain::vertex, "colour") == nullptr)
    colour_source_like_target(mesh, layout, loops, context);
  blend_colours(mesh, layout, loops, options.blend_colours, context);
  if (options.blend_colours > 0 && mesh.find_attribute(Domain::vertex, "colour") == nullptr)
    result.notes.push_back(facts::merge::NoColoursToBlend{});

  context.step("seam", 0.6);
  const Points unfaired = mesh.positions;
  const std::vector<Attribute> attributes = mesh.attributes;
  result.band = fair_seam(mesh, layout, options, context);
  renew_normals(mesh, layout, unfaired);

  context.step("seam", 0.8);
  result.report = measure_seam(mesh, layout, unfaired);
  constexpr double folded_deg = 120;  // chosen: edges bent more look folded over
  if (options.fairing_method == FairingMethod::curvature &&
      result.report.dihedral_p99_deg > folded_deg) {  // fairing does not help faces of extreme shape
    Mesh without_fairing = mesh;
    without_fairing.positions = unfaired;
    without_fairing.attributes = attributes;
    const SeamReport before = measure_seam(without_fairing, layout, unfaired);
    if (before.dihedral_p99_deg < result.report.dihedral_p99_deg) {
      mesh = std::move(without_fairing);
      result.band.clear();
      result.report = before;
      result.notes.push_back(facts::merge::SeamNotFaired{});
    }
  }
  result.report.expected_euler_characteristic =
      summarise_topology(target).euler_characteristic + summarise_topology(source).euler_characteristic;
  double source_length = 0, target_length = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    source_length += mean_edge_length(source.positions(pairs[order[k]].source, Eigen::all));
    target_length += mean_edge_length(opened.mesh.positions(opened.loops[k], Eigen::all));
  }
  result.report.source_edge_ratio = pairs.empty() ? 1 : source_length / target_length;
  context.step("seam", 1);
  return result;
}

}  // namespace meshgraft
