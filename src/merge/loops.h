#pragma once

#include <span>
#include <string>
#include <vector>

#include <meshgraft/merge/correspondence.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The pairs' loops, checked and listed in the direction of their meshes' half-edges, from the vertex with
/// which the caller's list begins.
std::vector<LoopPair> checked_loops(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs);

/// A boundary loop in the direction of its mesh's half-edges, from the vertex with which the list begins.
/// `role` is what messages call the mesh. Throws Error(input) where it is not one whole simple loop.
std::vector<Index> checked_loop(const Mesh& mesh, const char* role, const std::vector<Index>& listed);

/// Throws Error(input) naming the first component of the source that no pair holds.
void require_held_components(const Mesh& source, std::span<const LoopPair> pairs);

/// Points of a loop, and the surface's unit normals along it: those of the uncut surface where the mesh carries
/// them (`cut_normal_name`), else `vertex_normals`.
LoopGeometry loop_geometry(const Mesh& mesh, const Points& vertex_normals, const std::vector<Index>& loop);

/// Whether one of the meshes clearly faces inward and the other outward (`enclosed_volume`).
bool windings_disagree(const Mesh& target, const Mesh& source);

/// How much more a loop turns per vertex than it would if it were smooth, degrees.
double raggedness_deg(const Points& loop);

/// A loop smoothed along itself.
Points smoothed_loop(const Points& loop);

double mean_edge_length(const Points& loop);

/// Names a pair in messages; empty where there is only one.
std::string pair_location(std::size_t pair, std::size_t count);

}  // namespace meshgraft
