#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

/// Defects put into clean meshes, the same ones every time: for the tests of check_mesh and repair, and for
/// pictures.
namespace meshgraft::test {

/// A mesh with one kind of defect, and what the diagnostics name it.
struct Defective {
  Mesh mesh;
  std::string finding;
  Domain domain = Domain::vertex;
  Index count = 0;
  std::vector<Index> indices;  ///< ascending
};

/// The names of all kinds that `inject` knows, as the diagnostics have them (but "polygon").
const std::vector<std::string>& defect_kinds();

/// Puts one defect of a kind into a mesh of triangles, where the mesh has a place for it; else the mesh has no
/// finding to expect (`count` = 0).
Defective inject(const Mesh& clean, const std::string& kind);

// Damage of whole scans. `seed` decides where.
Mesh as_soup(const Mesh& mesh);                              ///< each face with vertices of its own
Mesh with_noise(Mesh mesh, double size_rel, unsigned seed);  ///< every vertex by up to that much of the box
Mesh rounded(Mesh mesh, int digits);  ///< coordinates as decimal text with so many digits
Mesh without_faces(const Mesh& mesh, int spots, int rings, unsigned seed);  ///< holes; rings 0: a face each
Mesh with_turned_patches(const Mesh& mesh, int patches, int rings, unsigned seed);
Mesh with_needles(const Mesh& mesh, int count, unsigned seed);  ///< an edge's end comes twice, 1e-13 apart
Mesh with_caps(const Mesh& mesh, int count, unsigned seed);  ///< a face without area over the middle of an edge
Mesh with_t_junctions(const Mesh& mesh, int count, unsigned seed);  ///< an edge split on one side alone
Mesh with_floating_bits(const Mesh& mesh, int count, unsigned seed);
Mesh with_repeated_faces(const Mesh& mesh, int count, unsigned seed);  ///< every second one turned over
Mesh with_fins(const Mesh& mesh, int count, unsigned seed);
Mesh with_bow_ties(const Mesh& mesh, int count, unsigned seed);  ///< vertices near each other become one
Mesh with_non_finite(Mesh mesh, int count, unsigned seed);
Mesh with_bad_indices(const Mesh& mesh, int count, unsigned seed);
Mesh with_isolated(const Mesh& mesh, int count, unsigned seed);
Mesh both(const Mesh& first, const Mesh& second);  ///< two meshes as one

struct DirtyScan {
  std::string name;
  std::string damage;  ///< for people
  Mesh mesh;
};

/// Twenty scans as people bring them, some 2,000 to 9,000 faces each.
std::vector<DirtyScan> dirty_scans();

/// What came of bending a whole mesh between two ends that are held.
struct Trial {
  bool works = false;
  std::string reason{};  ///< why not
};

/// Holds both ends of the longest side of the box, turns and moves one, and solves by the default method. It
/// works if there is no error, the handles are met, all positions are finite, at most 0.5 % of the maps are
/// inverted, and the surface is one edge-manifold consistently oriented part.
Trial try_deform(const Mesh& mesh);

}  // namespace meshgraft::test
