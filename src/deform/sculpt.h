#pragma once

#include <optional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A surface whose part is shaped without handles, by reference: its vertices (n×3, model units), its triangles
/// (m×3), and the vertices that may move. Those at an open boundary of the surface stay.
struct SculptedSurface {
  const Points& points;
  const Triangles& triangles;
  std::span<const Index> region;
};

/// Smooths the region and keeps the positions and tangent planes around it. Minimises the sum of squared
/// Laplacians (Botsch & Kobbelt 2004, Eq. 4) and μ times the squared distances from the given positions, with
/// μ = (2π/(s ℓ))⁴ − (2π/ℓ)⁴ for the strength s and the square root ℓ of the region's area. So detail shorter
/// than about s ℓ goes, at any density of the triangles; with s = 1 the given shape acts on the weights alone.
/// Returns the new positions (n×3). Throws Error(input) for a strength outside 0 … 1 or where a whole connected
/// component would move with s = 1, because nothing would give it a shape; Error(cancelled).
Points smooth_region(const SculptedSurface& surface, double strength, const Context& context = {});

/// Returns the vertices of the region, and those within the reach of it along edges (model units), ascending.
std::vector<Index> vertices_within(const SculptedSurface& surface, std::optional<double> reach);

/// Returns the vertices and those of the two rings of triangles around them, ascending. Moving the former reads
/// the positions of all of these.
std::vector<Index> with_rings_read(const SculptedSurface& surface, std::span<const Index> vertices);

/// Returns how much of the movement of a region each vertex makes, 0 to 1 (n): 1 in the region, and less with
/// the distance from it along edges (model units), down to 0 at the reach and beyond. It falls to 0 towards an
/// open boundary, too. A reach of 0 gives the region a hard edge. Throws Error(input) for a reach below 0 or
/// not finite.
std::vector<double> reach_weights(const SculptedSurface& surface, double reach);

/// Moves the region along its normals, without those of its detail: by `height` (model units, negative: inward)
/// where it is farthest from its boundary, and less towards it, so that the tangent planes around it are kept.
/// With a reach, the whole region moves by `height`, and the surface around it by its `reach_weights`.
/// Returns the new positions (n×3).
Points inflate_region(const SculptedSurface& surface, double height, std::optional<double> reach = {},
                      const Context& context = {});

/// Moves the region towards the plane that fits it best, by the fraction `strength` of the distance, and less
/// near its boundary. With a reach, the whole region moves by that fraction, and the surface around it by its
/// `reach_weights`. Returns the new positions (n×3). Throws Error(input) for a strength outside 0 … 1.
Points flatten_region(const SculptedSurface& surface, double strength, std::optional<double> reach = {},
                      const Context& context = {});

}  // namespace meshgraft
