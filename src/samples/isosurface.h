#pragma once

#include <array>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "sculpture.h"

namespace meshgraft::samples {

/// A closed, oriented triangle surface. Half-edge 3·t + c runs from corner c of triangle t to the next one.
/// Half-edges are linked to their twins, and not listed by edges as in an EdgeTable, because remeshing flips,
/// splits and collapses edges.
class Surface {
 public:
  Surface(std::vector<Vec3> points, std::vector<std::array<int, 3>> triangles);

  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;  ///< removed ones begin with -1
  std::vector<int> twin;                      ///< per half-edge
  std::vector<int> outgoing;                  ///< per vertex, one half-edge; -1 for a removed vertex
  Flags on_cut;                               ///< per vertex: whether it lies on the loop of the cut

  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int from(int h) const { return triangles[h / 3][h % 3]; }
  int to(int h) const { return from(next(h)); }
  bool alive(int h) const { return triangles[h / 3][0] >= 0; }
  /// Returns the next half-edge that leaves the same vertex.
  int around(int h) const { return twin[previous(h)]; }

  template <typename Visit>
  void for_each_outgoing(int vertex, Visit visit) const {
    const int first = outgoing[vertex];
    int h = first;
    do {
      visit(h);
      h = around(h);
    } while (h != first);
  }

  int valence(int vertex) const;
  bool adjacent(int a, int b) const;
  /// Replaces an edge with the other diagonal of its two triangles.
  void flip(int h);
  /// Inserts a vertex into an edge and returns its index.
  int split(int h, const Vec3& point);
  /// Merges from(h) into to(h).
  void collapse(int h);
  /// Returns whether a collapse keeps the surface a manifold of the same topology (link condition).
  bool may_collapse(int h) const;

 private:
  void link(int g, int h);
};

/// Runs marching tetrahedra over a body-centred cubic lattice. The result is always a closed manifold, but
/// its triangles are uneven.
Surface polygonise(const SparseField& field, const Context& context);

struct RemeshOptions {
  double edge_length = 0.0;  ///< model units
  int iterations = 6;
};

/// Makes the triangles of a surface near-equilateral, with edges of about the given length (Botsch & Kobbelt,
/// "A remeshing approach to multiresolution modeling", 2004). Places its vertices on the field's zero set.
void remesh(Surface& surface, const SparseField& field, const RemeshOptions& options, const Context& context);

/// Inserts a line of edges where the surface meets the plane z = height; `remesh` keeps it.
void mark_cut(Surface& surface, double height, const RemeshOptions& options);

}  // namespace meshgraft::samples
