#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/mesh.h>

/// Puts defects into clean meshes, the same ones in every run, for the tests of check_mesh and repair and for
/// pictures.
namespace meshgraft::test {

/// A mesh with one kind of defect, and the numbers of the finding that check_mesh must list.
struct Defective {
  Mesh mesh;
  Domain domain = Domain::vertex;
  Index count = 0;
  std::vector<Index> indices;  ///< ascending
};

/// Returns all kinds of findings but polygons and coordinates that are too large, which no repair mends.
const std::vector<FindingKind>& defect_kinds();

/// Puts one defect of a kind into a mesh of triangles. If the mesh cannot have it, leaves the mesh clean, and
/// `count` is 0.
Defective inject(const Mesh& clean, FindingKind kind);

// The following damage whole scans. `seed` decides where.
Mesh as_soup(const Mesh& mesh);                              ///< each face with vertices of its own
Mesh with_noise(Mesh mesh, double size_rel, unsigned seed);  ///< moves coordinates by ≤ size_rel × box diagonal
Mesh rounded(Mesh mesh, int digits);  ///< rounds coordinates to so many significant digits
Mesh without_faces(const Mesh& mesh, int spots, int rings, unsigned seed);  ///< holes; rings 0: one face each
Mesh with_turned_patches(const Mesh& mesh, int patches, int rings, unsigned seed);
Mesh with_needles(const Mesh& mesh, int count, unsigned seed);      ///< repeats a vertex, 1e-13 away
Mesh with_caps(const Mesh& mesh, int count, unsigned seed);         ///< a face without area at an edge's middle
Mesh with_t_junctions(const Mesh& mesh, int count, unsigned seed);  ///< splits an edge on one side only
Mesh with_floating_bits(const Mesh& mesh, int count, unsigned seed);
Mesh with_repeated_faces(const Mesh& mesh, int count, unsigned seed);  ///< reverses every second copy
Mesh with_fins(const Mesh& mesh, int count, unsigned seed);
Mesh with_bow_ties(const Mesh& mesh, int count, unsigned seed);  ///< merges vertices near each other
/// Divides the faces into `patches` sectors around the z axis and tears the seams between them open: runs of up
/// to three vertices of a seam get another position in one of its two patches, `width` × the distance from its
/// faces there. The other vertices of seams stay joined, or with `apart` become vertices at one position.
Mesh with_cracks(const Mesh& mesh, int patches, double width, bool apart);
Mesh with_non_finite(Mesh mesh, int count, unsigned seed);
/// Moves vertices by a distance, every second one in the opposite direction.
Mesh with_outlying(Mesh mesh, const std::vector<Index>& vertices, double distance);
Mesh with_bad_indices(const Mesh& mesh, int count, unsigned seed);
Mesh with_isolated(const Mesh& mesh, int count, unsigned seed);
Mesh both(const Mesh& first, const Mesh& second);  ///< two meshes as one

struct DirtyScan {
  std::string name;
  std::string damage;  ///< description for reports
  Mesh mesh;
};

/// Returns twenty scans with typical damage, of about 2,000 to 9,000 faces each.
std::vector<DirtyScan> dirty_scans();

/// The outcome of bending a whole mesh between two held ends.
struct Trial {
  bool works = false;
  std::string reason{};  ///< why not
};

/// Holds both ends of the longest side of the box, turns and moves one, and solves by the default method. The
/// trial works if no error is thrown, the handles are met, all positions are finite, and at most 0.5 % of the
/// maps are inverted. The surface must also be one edge-manifold, consistently oriented component.
Trial try_deform(const Mesh& mesh);

}  // namespace meshgraft::test
