#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Linear blend skinning: vertices follow a few bones each, bones that are vertices of the same surface. With
/// D_k(p) = x_k − p_k + (M_k − I)(p − p_k) what bone k does to a place, vertex v goes to p_v + Σ_k w_k
/// D_k(p_v), w_k ≥ 0, Σ_k w_k = 1: any affine map that all bones follow is reproduced.
struct Skin {
  std::vector<std::int64_t> offsets{0};  ///< rows + 1
  std::vector<Index> bones;
  /// The first weight of each row is what the others leave of 1, so that single precision does no harm.
  std::vector<float> weights;

  Index rows() const { return static_cast<Index>(offsets.size()) - 1; }
};

/// D_k as a matrix: the columns of M_k − I, then what it does to the origin.
using Bone = Eigen::Matrix<double, 3, 4>;

/// Σ_k w_k D_k of a row.
Bone blend(const Skin& skin, Index row, std::span<const Bone> bones);

/// What a skin is made of. Vertices are those of `points`.
struct SkinProblem {
  const Points& points;
  const IndexLists& rings;
  std::span<const Index> proxies;  ///< vertices; proxy k is bone k
  /// How far each proxy reaches; 0: it holds for itself alone, because nothing beside it was removed.
  std::vector<double> reach;
  struct Rim {
    Index vertex, bone;
  };
  std::vector<Rim> rim;          ///< vertices whose place is given, beside vertices whose place is not
  double rim_reach = 0;          ///< how far from them they are followed
  std::span<const Index> rows;   ///< vertices that follow the proxies, and close to a rim the rim
  std::span<const Index> inner;  ///< more rows: vertices that follow the proxies alone
};

struct SkinResult {
  Skin skin;                   ///< for `rows`, then for `inner`
  std::vector<Index> outside;  ///< vertices of rows that no proxy can be reached from; the skin is then empty
};

/// Weights fall off smoothly with the distance, along the surface and relative to each proxy's reach
/// (`BallWalk`), so that the blend has no steps. Towards a rim the rim's own vertices take over, wholly and
/// with horizontal slope at the rim, so that there is neither step nor kink.
SkinResult make_skin(SkinProblem problem, const Context& context = {});

}  // namespace meshgraft
