#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::test {

/// A generated mesh of triangles, with its name for reports of failures.
struct TestMesh {
  std::string name;
  Points positions;     ///< n×3
  Triangles triangles;  ///< m×3
  Index size() const { return static_cast<Index>(positions.rows()); }
  double box_diagonal() const;  ///< over the vertices of faces
};

// Closed meshes.
TestMesh icosphere(int level);     ///< 10·4^level + 2 vertices, radius 1
TestMesh bumpy_sphere(int level);  ///< the same, displaced along its normals
/// Returns a closed box with flat sides, 1 × 1 × along/across.
TestMesh bar(int across, int along);

// Meshes with boundary.
TestMesh grid(int cells_u, int cells_v);            ///< bumpy, even; two corner vertices have two neighbours
TestMesh irregular_grid(int cells_u, int cells_v);  ///< bumpy, jittered, diagonals at random
TestMesh flat_sheet(int cells_u, int cells_v);      ///< the same without bumps: exactly in the plane z = 0
TestMesh tube(int around, int along);               ///< round, open at both ends

// Meshes of positive genus.
TestMesh torus(int around, int along);                   ///< genus 1
TestMesh plate_with_holes(int holes, int subdivisions);  ///< closed, flat faces, genus = `holes`

// Meshes as modelling programs make them.
/// Returns a pole with a flat fan as its foot, sides of triangles 1:1000, and a conical fan on top.
TestMesh fan_pole(int around, int segments);
TestMesh needle_sheet(int cells_u, int cells_v);  ///< `grid` with triangles stretched to 1:1000

// Tiny meshes.
TestMesh tetrahedron();
TestMesh octahedron();
TestMesh pyramid_without_base();  ///< five vertices, one boundary loop
TestMesh two_triangles();         ///< a bent quad: every fit without an apex is singular

// Meshes made of other meshes.
TestMesh with_isolated_vertices(TestMesh mesh);  ///< one first, one in the middle, one last
TestMesh transformed(TestMesh mesh, const Eigen::Affine3d& map, const std::string& suffix);
TestMesh far_away(TestMesh mesh);  ///< moved to coordinates near 1e9, and rounded there
TestMesh minute(TestMesh mesh);    ///< scaled by 1e-6

/// The offset of `far_away`.
Eigen::Vector3d far_offset();

/// Returns all families, with at most about 700 vertices.
std::vector<TestMesh> mesh_families();

/// Returns meshes with at most 200 vertices, at scales where a dense reference is accurate.
std::vector<TestMesh> small_families();

/// Returns meshes with about `vertices` vertices, up to 100,000 and more: closed, bordered, genus 1, flat, bar.
std::vector<TestMesh> large_families(Index vertices);

/// A mesh with two ends to constrain. `foot` and `head` lie at the two ends of the longest side of the box.
/// They are non-empty, disjoint, ascending, and contain no isolated vertex.
struct Scene {
  TestMesh mesh;
  std::vector<Index> foot;
  std::vector<Index> head;
};

Scene make_scene(TestMesh mesh, double foot_fraction = 0.2, double head_fraction = 0.12);

/// A row of vertices across a strip or around a pipe.
struct Row {
  double u = 0;        ///< position along the length
  int cells = 0;       ///< number of cells around or across
  Index first = 0;     ///< index of its first vertex
  Index vertices = 0;  ///< number of its vertices
};

/// A mesh made of rows, whose cross sections can be followed through a deformation.
struct RowMesh {
  TestMesh mesh;
  std::vector<Row> rows;
  double length = 0;
};

enum class RowShape { bar, tube, plane };

/// Returns a bar (square pipe), tube or plane of length 3. Cells of the first half are 1/`cells_along` of the
/// length long. The second half is `ratio` (1, 2 or 4) times finer in both directions, after conforming strips
/// that double the cells. A row always lies at a tenth of the length from either end.
RowMesh graded_rows(RowShape shape, int cells_along, int ratio);

const char* to_string(RowShape shape);

}  // namespace meshgraft::test
