#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "mesh/winding.h"
#include "support/defects.h"

namespace meshgraft::test {

namespace {

Mesh model(const char* name, int resolution) {
  Mesh mesh = make_sample(name, resolution);
  mesh.attributes.clear();
  return mesh;
}

Mesh plain(Mesh mesh) {
  mesh.attributes.clear();
  mesh.source.reset();
  return mesh;
}

// Returns the faces around a vertex, within some rings, with vertices of their own.
Mesh patch_of(const Mesh& mesh, Index seed, int rings) {
  const auto patch = grow_rings(std::array{seed}, rings, vertex_rings(mesh.vertex_count(), mesh.faces));
  Mesh part;
  part.positions.resize(static_cast<Eigen::Index>(patch.size()), 3);
  for (std::size_t k = 0; k < patch.size(); ++k)
    part.positions.row(static_cast<Eigen::Index>(k)) = mesh.positions.row(patch[k]);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    std::vector<Index> face;
    for (const Index v : mesh.faces[f]) {
      const auto at = std::lower_bound(patch.begin(), patch.end(), v);
      if (at != patch.end() && *at == v) face.push_back(static_cast<Index>(at - patch.begin()));
    }
    if (face.size() == mesh.faces[f].size()) part.faces.push_back(face);
  }
  return part;
}

}  // namespace

std::vector<DirtyScan> dirty_scans() {
  const Mesh octopus = model("octopus", 60), dinosaur = model("dinosaur", 60), cactus = model("cactus", 50);
  const Mesh head = model("head", 60), bust = model("bust", 50), knot = model("knot", 50);
  const Mesh torus = model("torus", 40), bracket = model("bracket", 50);
  const Mesh seamed = plain(cut_by_plane(torus, {{0.1, 0, 0}, {1, 0.2, 0.1}}).mesh);
  const Mesh twice_seamed = plain(cut_by_plane(cactus, {{0, 0, 1.1}, {0, 0.1, 1}}).mesh);

  std::vector<DirtyScan> scans;
  const auto add = [&](const char* name, const char* damage, Mesh mesh) {
    scans.push_back({name, damage, std::move(mesh)});
  };
  add("octopus-soup", "a soup: each face has vertices of its own", as_soup(octopus));
  add("dinosaur-noisy-soup", "a soup with noise of 1e-7 of the box at every corner",
      with_noise(as_soup(dinosaur), 1e-7, 1));
  add("head-ascii-soup", "a soup with coordinates of 5 digits, open at the neck", rounded(as_soup(head), 5));
  add("cactus-holes", "9 faces and 6 patches are missing",
      without_faces(without_faces(cactus, 9, 0, 2), 6, 1, 3));
  add("knot-turned-patches", "8 patches are oriented the other way", with_turned_patches(knot, 8, 3, 4));
  add("octopus-inside-out", "all faces point inward", plain(turned_over(octopus)));
  add("torus-needles", "20 pairs of vertices 1e-13 apart, needles between them", with_needles(torus, 20, 5));
  add("bust-caps", "20 triangles without area across the middle of an edge", with_caps(bust, 20, 6));
  add("bracket-t-junctions", "30 edges are split on one side alone", with_t_junctions(bracket, 30, 7));
  add("octopus-floating-bits", "25 loose tetrahedra around it", with_floating_bits(octopus, 25, 8));
  add("head-twice", "the whole surface comes twice, each with its vertices", both(head, head));
  add("dinosaur-repeated-faces", "40 faces come twice, half of them turned over",
      with_repeated_faces(dinosaur, 40, 9));
  add("cactus-fins", "20 triangles stand on edges", with_fins(cactus, 20, 10));
  add("knot-bow-ties", "10 pairs of vertices near each other are one", with_bow_ties(knot, 10, 11));
  add("bust-non-finite", "12 vertices have a coordinate that is no number", with_non_finite(bust, 12, 12));
  add("torus-bad-indices", "15 faces name vertices that do not exist, 30 vertices have no face",
      with_bad_indices(with_isolated(torus, 30, 14), 15, 13));
  add("torus-seam", "cut through twice, the halves in place", seamed);
  add("cactus-seam-and-patch", "cut through, and a patch of it lies on it once more",
      both(twice_seamed, patch_of(twice_seamed, 100, 4)));
  add("octopus-soup-and-more", "a soup with holes, turned patches, fins, T-junctions and loose bits",
      as_soup(with_floating_bits(
          with_fins(with_t_junctions(with_turned_patches(without_faces(octopus, 6, 0, 15), 5, 2, 16), 8, 17), 6,
                    18),
          6, 19)));
  add("dinosaur-everything",
      "holes, turned patches, needles, repeated faces, fins, loose bits, bad indices and vertices; a soup with "
      "noise "
      "of 1e-7",
      with_bad_indices(
          with_non_finite(
              with_noise(as_soup(with_floating_bits(
                             with_fins(with_repeated_faces(
                                           with_needles(
                                               with_turned_patches(without_faces(dinosaur, 6, 0, 20), 5, 2, 21),
                                               6, 22),
                                           8, 23),
                                       6, 24),
                             6, 25)),
                         1e-7, 26),
              5, 27),
          5, 28));
  return scans;
}

namespace {

// The vertices of faces in the first and the last tenth of the longest side of the box.
struct Ends {
  std::vector<Index> foot, head;
};

Ends ends_of(const Mesh& mesh, const std::vector<Index>& component) {
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(1e300), high = -low;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (component[v] < 0 || !mesh.positions.row(v).allFinite()) continue;
    low = low.cwiseMin(mesh.positions.row(v));
    high = high.cwiseMax(mesh.positions.row(v));
  }
  Eigen::Index axis = 0;
  const double length = (high - low).maxCoeff(&axis);
  Ends ends;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (component[v] < 0) continue;
    if (mesh.positions(v, axis) < low[axis] + 0.1 * length) ends.foot.push_back(v);
    if (mesh.positions(v, axis) > high[axis] - 0.1 * length) ends.head.push_back(v);
  }
  return ends;
}

std::string defects_of(const TopologySummary& topology) {
  const bool non_manifold = !topology.manifold;
  if (topology.components != 1) return fmt::format("{} parts", topology.components);
  if (non_manifold) return "not a manifold";
  return topology.oriented ? "" : "not consistently oriented";
}

}  // namespace

Trial try_deform(const Mesh& mesh) {
  try {
    require_sound(check_mesh(mesh), mesh, {.name = "the mesh"});
    const std::string defects = defects_of(summarise_topology(mesh));
    const Ends ends = ends_of(mesh, connected_components(mesh));
    const Triangles triangles = triangulate(mesh).triangles;
    const Region region{
        .whole = true,
        .handles = {{.name = "foot", .vertices = ends.foot}, {.name = "head", .vertices = ends.head}}};
    const Deformer deformer(mesh.positions, triangles, region);
    const IndexLists rings = vertex_rings(mesh.vertex_count(), triangles);
    const double size = (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).norm();
    const std::vector<HandlePose> poses{HandlePose{},
                                        make_pose({.translate = Eigen::Vector3d(0.05, 0.05, 0.05) * size,
                                                   .axis = Eigen::Vector3d(1, 1, 0.5),
                                                   .angle_deg = 25},
                                                  handle_pivot(region.handles[1], mesh.positions, rings))};
    EvaluationReport report;
    const Points moved = deformer.evaluate(poses, {}, &report);
    if (!moved.allFinite()) return {false, "the result is not finite"};
    for (const Index v : ends.head) {
      const Eigen::Vector3d wanted = poses[1].transform * Eigen::Vector3d(mesh.positions.row(v).transpose());
      if ((moved.row(v).transpose() - wanted).norm() > 1e-9 * size) return {false, "a handle is not met"};
    }
    const auto free = static_cast<double>(deformer.free_vertices().size());
    if (report.inverted_maps > 0.005 * free)
      return {false, fmt::format("{} maps are inverted", report.inverted_maps)};
    return {defects.empty(), defects};
  } catch (const Error& error) {
    return {false, error.what()};
  }
}

}  // namespace meshgraft::test
