#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

class ConstrainedSystem;

/// Directions, n×3, in single precision. Drawing needs no more digits, and half the memory takes half the
/// time.
using Directions = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Data for a vertex shader that moves a mesh by its handles, in single precision. All lengths are in units
/// of the scene: model position = centre + scale · scene position. Meshes far from the origin thus keep their
/// digits; put centre and scale into the model matrix, in double precision.
///
/// Let K_h be the h-th 4×4 block (row-major, 16 floats) of a vertex's row of `blocks`. Let f_h be the 4×3
/// matrix of `HandleBasis::pose_matrices` (row-major, 12 floats). The 4×3 sum S = Σ_h K_h f_h holds
///   the position:    positions.row + S.row(0)
///   the local map:   Mᵀ = I + S.bottomRows(3)  (+ maps.row as a 3×3 where there are maps)
///   the normal:      n_x (m_1 × m_2) + n_y (m_2 × m_0) + n_z (m_0 × m_1), m_j rows of Mᵀ, not normalised.
struct HandleBuffers {
  template <int width>
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, width, Eigen::RowMajor>;

  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  double scale = 1;
  std::vector<Index> vertices;  ///< k vertices that can move, ascending: free ones and those of handles
  Rows<3> positions;            ///< k×3, with all handles at rest
  Rows<3> normals;              ///< k×3 at rest; no rows where the basis has no normals
  /// k×9, the part of (M − I)ᵀ that anchors with targets cause; no rows without such anchors.
  Rows<9> maps;
  /// k×16H for H handles. Where the basis has no normals, k×4H: only the first rows of K_h.
  Rows<Eigen::Dynamic> blocks;
};

/// Computes linear frames in real time, at any size. With region and handles fixed, the solutions of method
/// `ft05` are linear in the handles' affine maps (after linear subspace design, Wang et al. 2015). The
/// constructor solves for the response of every vertex to each handle, four columns a handle. A frame is one
/// product,
///   x = p + Σ_h b_h · pose_h,   (M − I)ᵀ = Σ_h C_h · pose_h.
/// The basis keeps no reference to the deformer. It takes 32 bytes per vertex and handle, with normals 80.
class HandleBasis {
 public:
  /// `normals` (n×3) are the mesh's unit normals at rest; each frame turns them with the surface. If it is
  /// empty, frames have no normals. Throws Error(usage) for a deformer of another method or with constraints
  /// per vertex, and for normals of another shape. Throws Error(input) for features that are similarities,
  /// because those are not linear.
  explicit HandleBasis(const Deformer& deformer, const Points& normals = {}, const Context& context = {});

  /// Computes new positions for one affine pose per handle; they equal those of `Deformer::evaluate` to
  /// rounding. Handle vertices are exactly at `pose · p`; vertices outside the region keep their coordinates
  /// bit for bit. `positions` and `normals` are n×3, owned by the caller; every row is written. Normals have
  /// unit length and follow the local maps: cof(M) n. Throws Error(usage) for another shape or number of
  /// poses, and for normals if the basis was made without them. Throws Error(input) for a redrawn curve.
  void frame(std::span<const HandlePose> poses, PointsRef positions, Directions* normals = nullptr,
             const Context& context = {}) const;
  Points frame(std::span<const HandlePose> poses, const Context& context = {}) const;

  /// Return the data of a vertex shader: the constant buffers, and the handles' 4×3 matrices of one frame.
  /// See `HandleBuffers`.
  HandleBuffers buffers() const;
  std::vector<Eigen::Matrix<float, 4, 3, Eigen::RowMajor>> pose_matrices(
      std::span<const HandlePose> poses) const;

  bool has_normals() const { return normals_.rows() > 0; }
  std::int64_t memory_bytes() const;

 private:
  // Vertices are stored in blocks of `lanes`; within a block, each coefficient of its vertices is contiguous:
  // [block][handle][coefficient][vertex].
  static constexpr std::size_t lanes = 4;
  std::size_t block_count() const { return (movers_.size() + lanes - 1) / lanes; }
  void find_movers(const ConstrainedSystem& system);
  void solve_columns(const ConstrainedSystem& system, const Context& context);
  void solve_targets(const ConstrainedSystem& system, const Context& context);
  void place_block(std::size_t block, std::span<const double> frames, PointsRef positions) const;
  /// The handles' matrices in single precision, divided by one common factor; `unit` is 1 over that factor.
  struct MapFrames {
    std::vector<float> entries;
    float unit;
  };
  void turn_block(std::size_t block, const MapFrames& frames, Directions& normals) const;
  void copy_columns(const std::vector<Index>& row_of, HandleBuffers& buffers) const;
  void place_handles(std::span<const HandlePose> poses, PointsRef positions, Directions* normals,
                     const Context& context) const;

  std::vector<Handle> handles_;
  Eigen::RowVector3d centre_;
  double scale_ = 1;
  Points base_;                             ///< n×3: positions with all handles at rest
  Directions normals_;                      ///< n×3 at rest, or none
  std::vector<Index> movers_;               ///< vertices with an unknown position or map, ascending
  std::vector<std::vector<Index>> turned_;  ///< per handle: vertices whose map is the handle's
  std::vector<double> weights_;             ///< b: 4 coefficients per handle
  std::vector<float> maps_;                 ///< C: 3×4 coefficients per handle, row-major
  /// (M − I)ᵀ with all handles at rest, 3×3 coefficients per vertex; empty without anchors with targets.
  std::vector<float> base_maps_;
};

struct ReducedFramesOptions {
  /// Number of points (centres), each with a function of which the field of maps is a sum. Memory (12 bytes per
  /// vertex and centre) and the time of set-up and frames grow with it, and errors fall.
  Index centres = 128;
  /// Number of samples per centre. The field is fitted to its values at the samples, and the surface's own
  /// rotations are means over their cells. There are at most 8,192 samples. The time of a frame's iterations
  /// grows with them.
  Index samples_per_centre = 6;
};

/// Throws Error(input), naming the field, for a value out of range.
void validate(const ReducedFramesOptions& options);

/// Computes approximate frames of the methods `corotational` and `rotation_aware` in real time
/// (docs/methods.md has the errors); for `shell` they are those of `corotational`. They serve dragging; let the
/// exact `Deformer::evaluate` follow when the drag ends.
///
/// The field of maps F on the right-hand side is smooth. A sum of few functions that are as smooth as possible
/// over the surface therefore represents the whole field. The solution is linear in their coefficients and in
/// the handles' affine maps, and the constructor solves for the vertices' response to each of them. A frame
/// repeats the method's iterations on samples of the surface, which takes a few milliseconds at any size with
/// the default options, and ends with one product. The object keeps no reference to the deformer.
class ReducedFrames {
 public:
  /// Throws Error(usage) for a deformer of method `ft05` (`HandleBasis` computes its frames exactly), or with
  /// constraints per vertex. Throws Error(input) for features and for options out of range.
  explicit ReducedFrames(const Deformer& deformer, const ReducedFramesOptions& options = {},
                         const Context& context = {});
  ReducedFrames(ReducedFrames&&) noexcept;
  ReducedFrames& operator=(ReducedFrames&&) noexcept;
  ~ReducedFrames();

  /// Computes new positions, near those of `Deformer::evaluate` for the same poses, in the caller's n×3
  /// `positions`. Handle vertices are exactly at `pose · p`; vertices outside the region keep their
  /// coordinates bit for bit. One affine map of all handles is reproduced to 1e-6. `report` gets the
  /// iterations, and whether transforms were blended linearly. Throws Error(usage) for another shape or number
  /// of poses. Throws Error(input) for a redrawn curve and for non-finite values.
  void frame(std::span<const HandlePose> poses, PointsRef positions, const Context& context = {},
             EvaluationReport* report = nullptr) const;
  Points frame(std::span<const HandlePose> poses, const Context& context = {},
               EvaluationReport* report = nullptr) const;

  Index centres() const;
  std::int64_t memory_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct ProxyOptions {
  DeformerOptions deformer{};  ///< options of the solve on the proxy
  /// Approximate number of vertices that the proxy has in the region, handles included; at least 50, at most
  /// all. It has more where handles and the region's boundary need them, and where the topology allows no
  /// fewer.
  Index vertices = 4000;
};

/// Seconds per stage and figures of the set-up.
struct ProxySummary {
  Index vertices = 0;       ///< vertices of the proxy, including those around the region
  Index free_vertices = 0;  ///< vertices of the mesh whose positions follow from the proxy's
  double spacing = 0;       ///< edge length for which the proxy was made, model units
  double decimate_seconds = 0;
  double skin_seconds = 0;       ///< time for the weights by which the mesh follows the proxy
  std::size_t skin_entries = 0;  ///< number of these weights
  DeformerSummary deformer{};    ///< set-up of the proxy's Deformer
};

/// Deforms a region by way of a decimated proxy. A `Deformer` deforms a coarse triangulation of some of its
/// vertices. The other vertices follow the proxy's positions and local maps,
/// x_v = Σ_k w_k (x_k + M_k (p_v − p_k)).
/// The weights w_k are smooth, and non-zero only for proxy vertices that are near along the surface.
///
/// The set-up takes a fraction of the time and memory of the whole region's. The result approaches the
/// `Deformer`'s as the proxy grows (docs/performance.md has figures), and equals it with a proxy of all
/// vertices.
///
/// As with the `Deformer`, positions of handles and of fixed vertices are exact, and so are affine maps that
/// all constraints follow.
class ProxyDeformer {
 public:
  /// Takes the same problem as `Deformer` and throws the same errors, with the mesh's own vertex indices.
  /// It reads a larger neighbourhood of the region, so that non-finite coordinates there are errors, too.
  /// Throws Error(unsolvable) with the id deform.no_proxy where the region could be solved but no proxy of that
  /// size.
  explicit ProxyDeformer(DeformProblem problem, const ProxyOptions& options = {}, const Context& context = {});
  /// Does the same for a region with handles. `rest` is n×3, `triangles` m×3.
  ProxyDeformer(const Points& rest, const Triangles& triangles, const Region& region,
                const ProxyOptions& options = {}, const Context& context = {});

  ProxyDeformer(ProxyDeformer&&) noexcept;
  ProxyDeformer& operator=(ProxyDeformer&&) noexcept;
  ~ProxyDeformer();

  /// Returns new positions, n×3, for one pose per handle. Vertices outside the region and fixed ones keep
  /// their coordinates bit for bit; handle vertices are exactly at `pose · p`. `report` describes the solve
  /// on the proxy.
  Points evaluate(std::span<const HandlePose> poses, const Context& context = {},
                  EvaluationReport* report = nullptr) const;
  /// Writes the same positions to `positions_out` (n×3). Throws Error(usage) for another shape.
  void evaluate(std::span<const HandlePose> poses, PointsRef positions_out, const Context& context = {},
                EvaluationReport* report = nullptr) const;

  /// Returns new positions, n×3, for constraints per vertex, in the order of the problem. Those of handles
  /// come in the order of the handles and of their vertices.
  Points evaluate(std::span<const VertexConstraint> constraints, const Context& context = {},
                  EvaluationReport* report = nullptr) const;

  /// Returns the change M − I of the local map of each vertex for the same constraints. It is zero outside the
  /// region, where vertices are fixed, and where only a position is given. `report` describes the solve on the
  /// proxy.
  std::vector<Eigen::Matrix3d> map_changes(std::span<const VertexConstraint> constraints,
                                           const Context& context = {},
                                           EvaluationReport* report = nullptr) const;

  const ProxySummary& summary() const;

  /// Returns the vertices of the mesh whose position follows from the proxy's, ascending.
  std::span<const Index> free_vertices() const;

  /// Return the proxy: its vertices as indices into the mesh, ascending, and its triangles as indices into
  /// these vertices.
  std::span<const Index> proxy_vertices() const;
  const Triangles& proxy_triangles() const;

  /// Returns a lower bound of the condition number of the proxy's AᵀA, at the cost of a few solves.
  double condition_estimate(const Context& context = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
