#include "prolongation.h"

#include <algorithm>
#include <utility>

#include <Eigen/QR>

#include "linalg/iterative/affine_bases.h"
#include "linalg/iterative/aggregation.h"

namespace meshgraft::distributed {

namespace {

/// The radius of an aggregate in edges, as in `CoarseSpace`.
constexpr int aggregate_radius = 2;

/// Returns the rings of the first `count` local vertices, restricted to those among them that have unknowns.
IndexLists rings_of_unknowns(const UnknownNodes& nodes, Index count) {
  IndexLists lists;
  for (Index v = 0; v < count; ++v) {
    if (nodes.has_unknowns[v])
      for (const Index w : nodes.mesh->rings[v])
        if (w < count && nodes.has_unknowns[w]) lists.values.push_back(w);
    lists.offsets.push_back(static_cast<Index>(lists.values.size()));
  }
  return lists;
}

/// The aggregates that local vertices belong to, numbered over all ranks, and their bases.
struct LocalAggregates {
  Aggregates aggregates;               ///< by local numbers: own aggregates first
  std::vector<Number> number;          ///< per local aggregate
  std::vector<Eigen::Matrix4d> basis;  ///< likewise
};

/// Adds the aggregates of the halo's vertices, which other ranks made.
void add_halo(const Communicator& comm, const Halo& vertices, LocalAggregates& local) {
  const Index own_count = local.aggregates.count;
  const std::vector<Number> starts = comm.starts(own_count);
  for (Index a = 0; a < own_count; ++a) local.number.push_back(starts[comm.rank()] + a);
  std::vector<Number> number(vertices.size(), -1);
  Columns bases = Columns::Zero(vertices.size(), 16);
  for (Index v = 0; v < vertices.own(); ++v)
    if (const Index a = local.aggregates.of_node[v]; a >= 0) {
      number[v] = local.number[a];
      bases.row(v) = local.basis[a].reshaped().transpose();
    }
  vertices.update(number);
  vertices.update(bases);
  std::vector<std::pair<Number, Index>> others;  // aggregate, a vertex of it
  for (Index v = vertices.own(); v < vertices.size(); ++v)
    if (number[v] >= 0) others.emplace_back(number[v], v);
  std::sort(others.begin(), others.end());
  local.aggregates.of_node.resize(vertices.size(), -1);
  for (const auto& [aggregate, v] : others) {
    if (local.number.size() == static_cast<std::size_t>(own_count) || local.number.back() != aggregate) {
      local.number.push_back(aggregate);
      local.basis.emplace_back(bases.row(v).reshaped(4, 4));
    }
    local.aggregates.of_node[v] = static_cast<Index>(local.number.size()) - 1;
  }
  local.aggregates.count = static_cast<Index>(local.number.size());
}

/// Returns the coefficients of x, y, z and 1 in the bases of the own aggregates.
Eigen::MatrixXd affine_coefficients(const std::vector<Eigen::Matrix4d>& basis, Index own_count) {
  Eigen::MatrixXd affine(4 * Eigen::Index{own_count}, 4);
  for (Index a = 0; a < own_count; ++a)
    affine.middleRows<4>(4 * Eigen::Index{a}) =
        basis[a].completeOrthogonalDecomposition().solve(Eigen::Matrix4d::Identity());
  return affine;
}

}  // namespace

Prolongation make_prolongation(const Communicator& comm, const UnknownNodes& nodes) {
  const Halo& vertices = nodes.mesh->vertices;
  LocalAggregates local;
  Blending blending;
  Prolongation result;
  comm.together([&] {
    Flags left_out(vertices.own());
    for (Index v = 0; v < vertices.own(); ++v) left_out[v] = !nodes.has_unknowns[v];
    local.aggregates =
        aggregate(rings_of_unknowns(nodes, vertices.own()), left_out, aggregate_radius, {.threads = 1});
    local.basis = affine_bases(local.aggregates.count, [&](const auto& body) {
      for (std::size_t u = 0; u < nodes.vertex.size(); ++u)
        body(static_cast<std::size_t>(local.aggregates.of_node[nodes.vertex[u]]),
             Eigen::Vector3d(nodes.positions.row(static_cast<Eigen::Index>(u)).transpose()));
    });
    result.affine = affine_coefficients(local.basis, local.aggregates.count);
  });
  result.starts = comm.starts(4 * Number{local.aggregates.count});
  add_halo(comm, vertices, local);
  comm.together([&] {
    blending = blend(rings_of_unknowns(nodes, vertices.size()), local.aggregates, 2 * aggregate_radius,
                     {.threads = 1});
    std::vector<std::pair<Number, double>> row;
    for (std::size_t u = 0; u < nodes.vertex.size(); ++u) {
      row.clear();
      Eigen::RowVector4d function;
      function << nodes.positions.row(static_cast<Eigen::Index>(u)), 1.0;
      const Index v = nodes.vertex[u];
      for (Index k = blending.aggregates.offsets[v]; k < blending.aggregates.offsets[v + 1]; ++k) {
        const Index a = blending.aggregates.values[k];
        const Eigen::RowVector4d values = blending.weight[k] * (function * local.basis[a]);
        for (int c = 0; c < 4; ++c) row.emplace_back(4 * local.number[a] + c, values[c]);
      }
      std::sort(row.begin(), row.end());
      for (const auto& [column, value] : row) {
        result.rows.columns.push_back(column);
        result.rows.values.push_back(value);
      }
      result.rows.offsets.push_back(static_cast<std::int64_t>(result.rows.columns.size()));
    }
  });
  return result;
}

}  // namespace meshgraft::distributed
