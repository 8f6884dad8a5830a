#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include <meshgraft/mesh/topology.h>

#include "linalg/iterative/block_rows.h"
#include "matrix_families.h"
#include "support/mesh_families.h"

namespace meshgraft {

/// The relative error of matrices in single precision.
inline constexpr double single_precision = 2e-6;

/// A system of equations as the iterative solver gets it.
struct NodeSystem {
  std::string name;
  NormalMatrix lower;
  std::vector<Index> group;
  IndexLists neighbours;
  Points positions;
  bool has_graph = false;

  OrderingGraph graph() const {
    return has_graph ? OrderingGraph{group, &neighbours, {}, positions} : OrderingGraph{};
  }
};

/// Scales the entries beside the diagonal so that no two are alike. A diagonally dominant matrix stays so.
inline NormalMatrix with_uneven_entries(NormalMatrix lower) {
  for (Eigen::Index column = 0; column < lower.cols(); ++column)
    for (NormalMatrix::InnerIterator it(lower, column); it; ++it)
      if (it.row() != column)
        it.valueRef() *= 0.2 + 0.8 * static_cast<double>((31 * it.row() + 17 * column) % 97) / 97;
  return lower;
}

/// Returns the system of a mesh. Every `second`-th vertex has two unknowns, every `third`-th three (0: none).
/// Those of one vertex and of neighbours are all coupled, and the first ones of vertices two edges apart. The
/// `shared` unknowns have no group and are coupled with all others.
inline NodeSystem mesh_system(const test::TestMesh& mesh, Index second, Index third, Index shared) {
  NodeSystem system{mesh.name, {}, {}, vertex_rings(mesh.size(), mesh.triangles), {}, true};
  system.name += ", " + std::to_string(second) + ", " + std::to_string(third) + ", " + std::to_string(shared);
  std::vector<Index> first;
  for (Index v = 0; v < mesh.size(); ++v) {
    first.push_back(static_cast<Index>(system.group.size()));
    const int count = third > 0 && v % third == 0 ? 3 : second > 0 && v % second == 0 ? 2 : 1;
    system.group.insert(system.group.end(), count, v);
  }
  first.push_back(static_cast<Index>(system.group.size()));
  const Index unshared = first.back(), unknowns = unshared + shared;
  system.group.resize(unknowns, -1);

  std::vector<std::pair<Index, Index>> edges;
  for (Index v = 0; v < mesh.size(); ++v)
    for (Index a = first[v]; a < first[v + 1]; ++a) {
      for (Index b = first[v]; b < a; ++b) edges.emplace_back(a, b);
      for (const Index w : system.neighbours[v]) {
        for (Index b = first[w]; b < first[w + 1]; ++b) edges.emplace_back(a, b);
        for (const Index x : system.neighbours[w]) edges.emplace_back(first[v], first[x]);
      }
    }
  for (Index u = unshared; u < unknowns; ++u)
    for (Index other = 0; other < u; ++other) edges.emplace_back(u, other);
  system.lower = with_uneven_entries(matrix_of_edges(unknowns, edges));

  system.positions = Points::Zero(unknowns, 3);
  for (Index u = 0; u < unshared; ++u) {
    const Index v = system.group[u];
    system.positions.row(u) = mesh.positions.row(v) + 0.1 * (u - first[v]) * Eigen::RowVector3d(0.2, -0.3, 1);
  }
  return system;
}

/// Returns systems of meshes and of matrices alone: nodes of one and of two rows, groups of several nodes,
/// unknowns without a group, hubs, several strips.
inline std::vector<NodeSystem> node_systems() {
  std::vector<NodeSystem> systems{mesh_system(test::icosphere(2), 0, 0, 0),
                                  mesh_system(test::bumpy_sphere(2), 1, 0, 0),
                                  mesh_system(test::irregular_grid(14, 11), 3, 0, 1),
                                  mesh_system(test::with_isolated_vertices(test::torus(16, 10)), 2, 5, 6),
                                  mesh_system(test::flat_sheet(12, 9), 0, 0, 3),
                                  mesh_system(test::two_triangles(), 0, 0, 0),
                                  mesh_system(test::tube(8, 180), 0, 0, 0),
                                  mesh_system(test::grid(6, 200), 3, 0, 2)};
  for (const NamedMatrix& family : matrix_families())
    systems.push_back({family.name, with_uneven_entries(family.lower), {}, {}, {}, false});
  std::vector<std::pair<Index, Index>> wheel;
  for (Index v = 0; v < 700; ++v) wheel.insert(wheel.end(), {{v, (v + 1) % 700}, {v, 700}});
  systems.push_back({"wheel", matrix_of_edges(701, wheel), {}, {}, {}, false});
  systems.push_back({"long lattice", with_uneven_entries(lattice_matrix(8, 200, 2)), {}, {}, {}, false});
  return systems;
}

/// Returns per node its place in a forward sweep: even strips come first.
inline std::vector<Index> sweep_sequence(const NodeOrder& order) {
  std::vector<Index> sequence(order.nodes.count, -1);
  Index next = 0;
  for (const Index parity : {0, 1})
    for (Index strip = parity; strip < order.strips.size(); strip += 2)
      for (Index node = order.strips.begin[strip]; node < order.strips.begin[strip + 1]; ++node)
        sequence[node] = next++;
  return sequence;
}

/// Returns the whole matrix with one row per row of the nodes, which is that of the identity where it is
/// padding.
inline Eigen::SparseMatrix<double> matrix_by_rows(const NormalMatrix& lower, const BlockRows& nodes) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index column = 0; column < lower.cols(); ++column)
    for (NormalMatrix::InnerIterator it(lower, column); it; ++it) {
      entries.emplace_back(nodes.row[it.row()], nodes.row[column], it.value());
      if (it.row() != column) entries.emplace_back(nodes.row[column], nodes.row[it.row()], it.value());
    }
  const auto rows = static_cast<int>(nodes.unknown.size());
  for (int row = 0; row < rows; ++row)
    if (nodes.unknown[row] < 0) entries.emplace_back(row, row, 1.0);
  Eigen::SparseMatrix<double> matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace meshgraft
