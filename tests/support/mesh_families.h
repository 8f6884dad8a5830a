#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::test {

/// A generated mesh of triangles with the name that failures are reported under.
struct TestMesh {
  std::string name;
  Points positions;     ///< n×3
  Triangles triangles;  ///< m×3
  Index size() const { return static_cast<Index>(positions.rows()); }
  double box_diagonal() const;  ///< over the vertices of faces
};

// Closed.
TestMesh icosphere(int level);     ///< 10·4^level + 2 vertices, radius 1
TestMesh bumpy_sphere(int level);  ///< the same, displaced along its normals
/// A box with flat sides, 1 × 1 × along/across, closed.
TestMesh bar(int across, int along);

// With borders.
TestMesh grid(int cells_u, int cells_v);            ///< bumpy, even, two corners with two neighbours
TestMesh irregular_grid(int cells_u, int cells_v);  ///< bumpy, jittered, diagonals at random
TestMesh flat_sheet(int cells_u, int cells_v);      ///< the same without bumps: exactly in the plane z = 0
TestMesh tube(int around, int along);               ///< round, open at both ends

// With handles in the topological sense.
TestMesh torus(int around, int along);                   ///< genus 1
TestMesh plate_with_holes(int holes, int subdivisions);  ///< closed, flat faces, genus = `holes`

// As drawing programs make them.
/// A pole with a flat fan as its foot, sides of triangles 1:1000, and a conical fan on top.
TestMesh fan_pole(int around, int segments);
TestMesh needle_sheet(int cells_u, int cells_v);  ///< `grid` with triangles stretched to 1:1000

// Tiny.
TestMesh tetrahedron();
TestMesh octahedron();
TestMesh pyramid_without_base();  ///< five vertices, one boundary loop
TestMesh two_triangles();         ///< a bent quad: every fit without an apex is singular

// Made of others.
TestMesh with_isolated_vertices(TestMesh mesh);  ///< one before, one in the middle, one after the others
TestMesh transformed(TestMesh mesh, const Eigen::Affine3d& map, const std::string& suffix);
TestMesh far_away(TestMesh mesh);  ///< moved to coordinates near 1e9, and rounded there
TestMesh minute(TestMesh mesh);    ///< 1e-6 of the size

/// The offset of `far_away`.
Eigen::Vector3d far_offset();

/// All families at sizes of up to some 700 vertices.
std::vector<TestMesh> mesh_families();

/// Members with at most 200 vertices, at scales where a dense reference is accurate.
std::vector<TestMesh> small_families();

/// Members with about `vertices` vertices (up to 100,000 and more): closed, bordered, genus 1, flat, bar.
std::vector<TestMesh> large_families(Index vertices);

/// A mesh with two ends to hold: `foot` and `head` lie at the two ends of the longest side of the box. Both
/// are non-empty, disjoint, ascending, and hold no isolated vertex.
struct Scene {
  TestMesh mesh;
  std::vector<Index> foot;
  std::vector<Index> head;
};

Scene make_scene(TestMesh mesh, double foot_fraction = 0.2, double head_fraction = 0.12);

/// Rows that run across a strip or around a pipe.
struct Row {
  double u = 0;        ///< place along the length
  int cells = 0;       ///< around (or across)
  Index first = 0;     ///< its first vertex
  Index vertices = 0;  ///< how many vertices it has
};

/// A mesh made row by row, whose cross sections can be followed through a deformation.
struct RowMesh {
  TestMesh mesh;
  std::vector<Row> rows;
  double length = 0;
};

enum class RowShape { bar, tube, plane };

/// A bar (square pipe), tube or plane of length 3, with `cells` cells along each unit of 1/20 of the length
/// refined so that the second half is `ratio` (1, 2 or 4) times finer in both directions, by conforming
/// strips that double the cells. The length divided by 10 always falls on a row at both ends.
RowMesh graded_rows(RowShape shape, int cells_along, int ratio);

const char* to_string(RowShape shape);

}  // namespace meshgraft::test
