#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Computes area-weighted unit vertex normals, n×3. Rows without a face of positive area are zero.
Points vertex_normals(const Points& positions, const Triangles& triangles, const IndexLists& vertex_triangles,
                      const Context& context = {});

/// Computes the same for a mesh of polygons (Newell's normals). Faces with an index out of range are left
/// out.
Points vertex_normals(const Mesh& mesh);

/// Updates the attributes called "normal" (vertex and corner domain, three components) after the vertices
/// moved from `rest` to `mesh.positions`. Hard and smooth edges are preserved:
/// - vertex normals are turned as the faces around them turn, area-weighted, so that they keep their file's
///   weighting and side;
/// - face normals are recomputed, on the side of the surface where they were;
/// - corner normals are turned by the rotation nearest to the map of their face. Corners of one vertex that
///   share a normal keep sharing one: the area-weighted mean of theirs.
///
/// The attribute "tangent" is updated after that. It has the vertex or corner domain and four components: a
/// unit vector along the surface and the side of the bitangent. A tangent is mapped by the linear maps of the
/// faces around it, and made perpendicular to the new normal. Corners that share a tangent keep sharing one;
/// the side stays. Elements whose neighbourhood did not move, and missing ones (NaN), keep their values bit
/// for bit. Throws Error(usage) if `rest` has another number of rows than `mesh.positions`.
void update_normals(Mesh& mesh, const Points& rest);

}  // namespace meshgraft
