#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Linear blend skinning: each vertex follows a few bones, which are vertices of the same surface. Bone k
/// moves a position p by D_k(p) = x_k − p_k + (M_k − I)(p − p_k). Vertex v moves to p_v + Σ_k w_k D_k(p_v),
/// where w_k ≥ 0 and Σ_k w_k = 1. An affine map that all bones follow is reproduced exactly.
struct Skin {
  std::vector<std::int64_t> offsets{0};  ///< rows + 1
  std::vector<Index> bones;
  /// Single precision suffices, because the first weight of each row is taken as 1 minus the others.
  std::vector<float> weights;

  Index rows() const { return static_cast<Index>(offsets.size()) - 1; }
};

/// D_k as a matrix: the columns of M_k − I, then the displacement of the origin.
using Bone = Eigen::Matrix<double, 3, 4>;

/// Returns Σ_k w_k D_k of a row.
Bone blend(const Skin& skin, Index row, std::span<const Bone> bones);

/// The input of `make_skin`. Vertices are indices into `points`.
struct SkinProblem {
  const Points& points;
  const IndexLists& rings;
  std::span<const Index> proxies;  ///< proxy vertices; the k-th is bone k
  /// Per proxy vertex: its influence radius; 0 if it moves only itself, since no vertex beside it was removed.
  std::vector<double> radius;
  struct BoundaryVertex {
    Index vertex, bone;
  };
  /// The handle boundaries: vertices of given position beside vertices of unknown position. Fixed vertices and
  /// features have boundaries, too.
  std::vector<BoundaryVertex> boundary;
  double boundary_radius = 0;  ///< influence radius of the boundaries
  std::span<const Index>
      rows;  ///< vertices that follow the proxy vertices, and near a boundary also the boundary
  std::span<const Index> inner;  ///< further rows: vertices that follow only the proxy vertices
};

struct SkinResult {
  Skin skin;                   ///< for `rows`, then for `inner`
  std::vector<Index> outside;  ///< vertices of rows that no proxy vertex can influence; the skin is then empty
};

/// Makes a skin with weights that fall off smoothly with the distance along the surface, relative to each
/// proxy's influence radius (`BallWalk`). The blend is therefore continuous. Near a handle boundary the
/// boundary's own vertices take over, completely and with zero slope at the boundary, so that there is neither
/// step nor kink.
SkinResult make_skin(SkinProblem problem, const Context& context = {});

}  // namespace meshgraft
