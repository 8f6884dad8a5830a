#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Directions in single precision, n×3: what is drawn needs no more, and half the memory is half the time.
using Directions = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// What a vertex shader needs to move a mesh by its handles, in single precision. Everything is in units of the
/// scene: place = centre + scale · position, so that meshes far from the origin keep their digits; put centre
/// and scale into the model matrix, in double precision.
///
/// With K_h the h-th 4×4 block (row-major, 16 floats) of a vertex's row of `blocks`, and f_h the 4×3 matrix of
/// `HandleBasis::frame_matrices` (row-major, 12 floats), the 4×3 sum S = Σ_h K_h f_h holds
///   the position:    positions.row + S.row(0)
///   the local map:   Mᵀ = I + S.bottomRows(3)  (+ maps.row as a 3×3 where there are maps)
///   the normal:      n_x (m_1 × m_2) + n_y (m_2 × m_0) + n_z (m_0 × m_1), m_j the rows of Mᵀ, not normalised.
struct HandleBuffers {
  template <int width>
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, width, Eigen::RowMajor>;

  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  double scale = 1;
  std::vector<Index> vertices;  ///< that can move, ascending: free ones and those of handles; k of them
  Rows<3> positions;            ///< k×3, with all handles at rest
  Rows<3> normals;              ///< k×3 at rest; no rows where the basis has no normals
  Rows<9> maps;  ///< k×9, what anchors with targets add to (M − I)ᵀ; no rows without such anchors
  Rows<Eigen::Dynamic> blocks;  ///< k×16H; k×4H where the basis has no normals: the first rows of K_h alone
};

/// Linear frames in real time, at any size: with region and handles chosen, the solutions of method `ft05` are
/// linear in the handles' affine maps (after linear subspace design, Wang et al. 2015). The constructor finds
/// how every vertex follows each handle, four columns a handle; a frame is one product,
///   x = p + Σ_h b_h · frame_h,   (M − I)ᵀ = Σ_h C_h · frame_h.
/// Keeps nothing of the deformer. 32 bytes a vertex and handle, with normals 80.
class HandleBasis {
 public:
  /// `normals` (n×3) are the mesh's unit normals at rest, turned with the surface in each frame; empty: frames
  /// have no normals. Throws Error(usage) for a deformer of another method or with constraints per vertex, and
  /// for normals of another shape; Error(input) where features are similarities, which are not linear.
  explicit HandleBasis(const Deformer& deformer, const Points& normals = {}, const Context& context = {});

  /// New positions for one affine pose per handle: those of `Deformer::evaluate`, to rounding. Handle vertices
  /// are exactly at `pose · p`, vertices outside the region keep their bits. `positions` and `normals` are n×3
  /// and the caller's; every row is written. Normals are unit, of the local maps: cof(M) n. Throws Error(usage)
  /// for another shape or number of poses, and for normals that the basis was not made for; Error(input) for a
  /// redrawn curve.
  void frame(std::span<const HandlePose> poses, Points& positions, Directions* normals = nullptr,
             const Context& context = {}) const;
  Points frame(std::span<const HandlePose> poses, const Context& context = {}) const;

  /// The same for a vertex shader: what stays, and the handles' 4×3 matrices of a frame. See `HandleBuffers`.
  HandleBuffers buffers() const;
  std::vector<Eigen::Matrix<float, 4, 3, Eigen::RowMajor>> frame_matrices(
      std::span<const HandlePose> poses) const;

  bool has_normals() const { return normals_.rows() > 0; }
  std::int64_t memory_bytes() const;

 private:
  // Vertices in blocks of a few, each number of a block's vertices side by side:
  // [block][handle][number][vertex].
  static constexpr std::size_t lanes = 4;
  std::size_t block_count() const { return (movers_.size() + lanes - 1) / lanes; }
  void find_movers(const ConstrainedSystem& system);
  void solve_columns(const ConstrainedSystem& system, const Context& context);
  void solve_targets(const ConstrainedSystem& system, const Context& context);
  void place_block(std::size_t block, std::span<const double> frames, Points& positions) const;
  void turn_block(std::size_t block, std::span<const float> frames, float unit, Directions& normals) const;
  void copy_columns(const std::vector<Index>& row_of, HandleBuffers& buffers) const;
  void place_handles(std::span<const HandlePose> poses, Points& positions, Directions* normals,
                     const Context& context) const;

  std::vector<Handle> handles_;
  Eigen::RowVector3d centre_;
  double scale_ = 1;
  Points base_;                ///< n×3: where the vertices are with all handles at rest
  Directions normals_;         ///< n×3 at rest, or none
  std::vector<Index> movers_;  ///< vertices with columns, ascending: with an unknown position or map
  std::vector<std::vector<Index>> turned_;  ///< of each handle, vertices whose map is the handle's
  std::vector<double> weights_;             ///< b: 4 numbers a handle
  std::vector<float> maps_;                 ///< C: 3×4 numbers a handle, by rows
  std::vector<float> base_maps_;  ///< (M − I)ᵀ with all handles at rest: 3×3 numbers; none without targets
};

}  // namespace meshgraft
