#pragma once

#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

#include "merge/facts.h"
#include "pair_geometry.h"

namespace meshgraft {

/// Returns the pairs' loops, validated, each in the direction of its mesh's half-edges and starting at the
/// first vertex of the caller's list.
std::vector<LoopPair> checked_loops(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs);

/// Returns a boundary loop in the direction of its mesh's half-edges, starting at the first vertex of the
/// list. `side` says in errors which mesh it is. Throws Error(input) where the list is not one whole
/// simple loop.
std::vector<Index> checked_loop(const Mesh& mesh, facts::merge::Side side, const std::vector<Index>& listed);

/// Returns the numbers of the `boundary_loops` that are simple, finite and of a usable length. Others are
/// refused.
std::vector<std::size_t> usable_loops(const Mesh& mesh);

/// Throws Error(input) with the id merge.component_without_pair for the first component of the source that no
/// pair constrains. `component` has the component of each vertex (`connected_components`).
void require_held_components(std::span<const Index> component, std::span<const LoopPair> pairs);

/// Returns the points of a loop and the surface's unit normals along it. The normals are those of the uncut
/// surface where the mesh stores them (`cut_normal_name`), else `vertex_normals`.
LoopGeometry loop_geometry(const Mesh& mesh, const Points& vertex_normals, const std::vector<Index>& loop);

/// Returns whether one of the meshes clearly faces inward and the other outward (`enclosed_volume`).
bool windings_disagree(const Mesh& target, const Mesh& source);

/// Returns how much more a loop turns per vertex than it would if it were smooth, in degrees.
double raggedness_deg(const Points& loop);

/// Returns a smoothed copy of a loop.
Points smoothed_loop(const Points& loop);

/// Returns the mean length of the edges of a loop.
double mean_edge_length(const Points& loop);

/// Returns the name of a pair for messages; empty where there is only one.
Location pair_location(std::size_t pair, std::size_t count);

}  // namespace meshgraft
