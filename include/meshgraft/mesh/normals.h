#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Area-weighted unit vertex normals, n×3. Rows without a face of positive area are zero.
Points vertex_normals(const Points& positions, const Triangles& triangles, const IndexLists& vertex_triangles,
                      const Context& context = {});

/// The same for a mesh of polygons (Newell's normals). Faces with an index out of range are left out.
Points vertex_normals(const Mesh& mesh);

/// Writes new values into the attributes called "normal" (vertex and corner domain, three components) after a
/// move of the vertices from `rest` to `mesh.positions`, so that hard and smooth edges stay what they were:
/// - vertex normals are turned as the faces around them turn, area-weighted, so that they keep their file's
///   weighting and side;
/// - face normals are recomputed, on the side of the surface where they were;
/// - corner normals are turned by the rotation nearest to what happened to their face. Corners of one vertex
///   that share a normal keep sharing one: the area-weighted mean of theirs.
/// The attribute "tangent" (vertex and corner domain, four components: a unit vector along the surface and the
/// side of the bitangent) then follows: a tangent is carried along by the linear maps of the faces around, and
/// made perpendicular to the new normal. Corners that share a tangent keep sharing one; the side stays.
/// Elements whose surroundings did not move, and missing ones (NaN), keep their bytes. Throws Error(usage) if
/// `rest` has another number of rows than `mesh.positions`.
void update_normals(Mesh& mesh, const Points& rest);

}  // namespace meshgraft
