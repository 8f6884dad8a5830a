#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/deform/deform_problem.h>

#include "deform/solve/constrained_system.h"
#include "deform/solve/corotation.h"
#include "deform/solve/pose_matrix.h"
#include "deform/solve/rotation_field.h"
#include "linalg/sparse.h"
#include "reduced_twists.h"

namespace meshgraft {

/// The field of maps of a `RotationField`, as a sum of few functions. Its co-rotational iterations run on
/// samples of the surface: the field is known at them, and fitted by the functions. The surface's maps are
/// means over the samples' cells of vertices.
///
/// A solution is linear in `width()` rows of coefficients, three columns each:
///   4 per handle    its frame, if the field is blended by logarithms
///   4 per handle    its frame, if transforms are blended linearly
///   3 per function  (F − I)ᵀ, without the strain of twists
///   3 per function  (R W)ᵀ, for that strain (`twist_shear`), if the surface has limbs (`LimbTwist`)
/// The functions are one per centre, which is 1 there and 0 at all other centres, and the winding functions
/// (`winding_weights`), which are 0 at all centres. `handle_sides` and `weights` give the right-hand sides of
/// these rows. `set_maps` takes the maps that they cause.
class ReducedField {
 public:
  ReducedField(const ConstrainedSystem& system, const RotationField& rotations, std::span<const Handle> handles,
               const DeformerOptions& options, Index centres, Index samples, const Context& context);

  std::size_t width() const { return 8 * handle_count_ + 3 * (function_count() + twist_function_count()); }
  std::size_t centre_count() const { return centres_.size(); }
  std::size_t function_count() const { return centres_.size() + winding_count_; }
  std::size_t twist_function_count() const { return twists_.function_count(); }

  /// The known values and field that give the right-hand sides of some rows.
  struct Columnwise {
    ConstrainedSystem::Known values;
    MapField field;
  };
  /// Returns the known values and field for a handle's four rows. Numbers from the handle count on select the
  /// linearly blended rows.
  Columnwise handle_sides(std::size_t number) const;
  /// Returns whether the surface has limbs or discs.
  bool has_limbs() const { return !twists_.empty(); }
  const LimbTwist& limbs() const { return rotations_->limbs(); }  ///< must not be called after `finish`
  const Columns& weights() const { return weights_; }             ///< Returns the functions, patch × functions.
  /// Returns the functions of the strain of twists, which do not vanish where maps are given.
  const Columns& twist_weights() const { return twists_.functions(); }
  /// Returns the matrix that computes means over cells of values with `rows_per_vertex` rows per vertex.
  SparseRows cell_mean_rows(int rows_per_vertex) const;
  /// Sets the means of the local maps that some of the `width()` rows cause, one per column.
  void set_maps(std::span<const std::size_t> rows, const Columns& means);
  /// Sets the local maps with all handles at rest, needed if anchors have targets.
  void set_base_maps(const Columns& maps) { base_maps_ = multiply(cell_mean_rows(3), maps); }
  /// Releases all that only the set-up needs.
  void finish();
  /// Returns the size of the matrices that frames need.
  std::int64_t memory_bytes() const {
    return static_cast<std::int64_t>(sizeof(double)) *
               (smoothed_functions_.size() + cell_fit_.size() + fit_.size()) +
           static_cast<std::int64_t>(sizeof(float)) * maps_.size() + twists_.memory_bytes();
  }

  struct Result {
    Columns coefficients;  ///< width() × 3
    int iterations = 0;
    double change = 0;
    bool linear = false;
  };
  Result find(std::span<const HandlePose> poses, const PoseMatrix* frames, const Context& context) const;

 private:
  void spread_logs(const Context& context);
  void choose_winding();
  void choose_samples(Index centres, Index samples, const Context& context);
  void spread_samples(SolverBackend backend, const Context& context);
  Columns winding_weights() const;
  void join_winding(const Eigen::Ref<const Columns>& of_centres, const Context& context);
  void reduce_smoothing(const Context& context);
  std::vector<double> fit_weights() const;
  Eigen::MatrixXd winding_penalty() const;
  void fit_loose_components();
  Columns functions_of_first_centres(std::size_t count, const Context& context) const;
  void reduce_twists(const Context& context);
  bool handle_logs(std::span<const HandlePose> poses, const Columns& frames, BlendedLogs& logs) const;
  using ShortCoefficients = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< width() × 3
  Eigen::Matrix3d cell_map(std::size_t cell, const ShortCoefficients& coefficients) const;
  using Maps = ReducedTwists::Maps;
  /// The map that the handles alone give at a sample, without the strain of twists.
  struct SampleMap {
    BlendedMap blended;
    Eigen::Matrix3d shear = Eigen::Matrix3d::Zero();  ///< W of `twist_shear`
  };
  /// The maps that the handles alone give.
  struct Blend {
    std::vector<SampleMap> at_samples;
    std::vector<BlendedMap> at_cells;  ///< with the strain of twists; empty without iterations
    Maps twists;                       ///< the coefficients of (R W)ᵀ
  };
  Blend blend_of(const BlendedLogs& logs, const Context& context) const;
  void local_steps(const Blend& blend, Result& result, const Context& context) const;
  void set_field(const Blend& blend, const Columns& deviation, Columns& coefficients) const;

  // Used in the set-up only; null and empty afterwards.
  const ConstrainedSystem* system_;
  const RotationField* rotations_;
  std::span<const Handle> handles_;
  std::vector<Index> winding_handles_;  ///< handles with winding functions
  int winding_degree_ = 0;              ///< number of winding functions of each
  std::vector<Index> cell_;             ///< per vertex of the patch: its cell, or -1 if its map is given
  Columns given_;                       ///< patch × handles: 1 where the handle gives the map
  /// Patch × functions. φ of a centre is 1 there and 0 at the others and where maps are given.
  Columns weights_;
  Columns given_weights_;  ///< φ: patch × handles, 1 where the handle gives the map and 0 at the centres
  Columns blend_weights_;  ///< χ: patch × handles, the same without centres: the blend of logarithms

  // Used by frames.
  std::size_t handle_count_ = 0, winding_count_ = 0;
  int iterations_ = 0;
  Flags gives_maps_;                           ///< per handle: it constrains transforms of the patch
  std::vector<double> given_areas_;            ///< per handle: area of the vertices whose map it gives
  bool from_rest_ = false;                     ///< a map is known without a handle: rotations count from rest
  std::vector<Index> centres_, samples_;       ///< vertices of the patch; the centres are the first samples
  std::vector<Index> sample_component_;        ///< components without a given map, else -1
  std::vector<Columns> fits_;                  ///< per such one: (M − I)ᵀ = fit (3 × 4H) · frames
  Columns sample_influence_, cell_influence_;  ///< χ at samples, and its means over cells
  Columns sample_given_;                       ///< φ of handles at samples
  Eigen::MatrixXd fit_;                        ///< functions × samples: gives the coefficients of a field
  ReducedTwists twists_;                       ///< empty without limbs
  Eigen::MatrixXd cell_fit_;                   ///< functions × cells: the same from means over cells
  Columns smoothed_functions_;                 ///< samples × functions
  std::vector<double> areas_;                  ///< per cell
  Points normals_;                             ///< per cell: normal if maps are fitted to flat rings, else 0
  /// The columns of (M − I)ᵀ that `width()` rows cause, per cell. Each column is padded to four numbers, so
  /// that they are added at once.
  Eigen::Matrix<float, 4, Eigen::Dynamic> maps_;
  Columns base_maps_;  ///< 3 rows per cell: maps with all handles at rest
};

}  // namespace meshgraft
