#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/operators/affine_operator.h>

#include "linalg/sparse.h"

#include "local_mesh.h"

namespace meshgraft::distributed {

/// A rank's part of the patch: the vertices that can influence the unknowns, divided among the ranks. The whole
/// patch has one centre and one scale. Local vertices are the own ones, then the halo.
struct Part {
  LocalMesh mesh;
  std::vector<Index> original;  ///< per local vertex: its index in the whole mesh
  Points points;                ///< (p − centre) / scale
  ConstraintMask mask;
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  double scale = 1;
};

/// The way from the ranks' shares of the whole mesh to the parts of the patch and back.
class Redistribution {
 public:
  /// `rank_of` has the new rank of each own vertex of `mesh`, or -1. `layers` as in `make_local_mesh`.
  Redistribution(const Communicator& comm, const LocalMesh& mesh, const std::vector<int>& rank_of, int layers);

  const LocalMesh& part() const { return part_; }
  /// Returns the rank of a vertex's part, or -1 outside the patch. `vertex` is an own one of the whole mesh.
  int rank_of(Index vertex) const { return rank_of_[vertex]; }

  /// Brings `width` numbers of each own vertex to its part. Returns those of all local vertices of the part.
  Columns bring(const Columns& values) const;
  /// Brings values of own vertices of the part back to the ranks of the whole mesh. Vertices outside the patch
  /// keep the rows of `values`.
  void bring_back(const Columns& of_part, Columns& values) const;

 private:
  const Communicator& comm_;
  std::vector<int> rank_of_;
  ByRank<Index> sent_;  ///< own vertices of the whole mesh by the rank of their part
  ByRank<Index>
      received_;  ///< own vertices of the part by the rank that they come from, in the order of `sent_`
  LocalMesh part_;
};

/// Returns the patch of the active vertices: those within `rings` + 1 edges, as flags of all local vertices.
/// `active` has a flag per own vertex.
Flags flag_patch(const LocalMesh& mesh, std::span<const std::uint8_t> active, int rings);

}  // namespace meshgraft::distributed
