#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/deform/deformer.h>

#include "constrained_system.h"
#include "corotation.h"
#include "handle_frame.h"
#include "rotation_field.h"

namespace meshgraft {

/// The field of maps of a `RotationField`, kept at some centres, and its steps made on samples of the surface
/// (cells of vertices, by their means).
///
/// What a solution is linear in stands in `width()` rows of coefficients, three columns each:
///   4 a handle    its frame, where the field is blended along the surface's rotations
///   4 a handle    its frame, where transforms are blended linearly
///   3 a centre    (F − I)ᵀ there
/// `field` and `values` give the right-hand sides of such rows; `add_responses` takes the maps they cause.
class ReducedField {
 public:
  ReducedField(const ConstrainedSystem& system, const RotationField& rotations, std::span<const Handle> handles,
               const DeformerOptions& options, Index centres, Index samples, const Context& context);

  std::size_t width() const { return 8 * handle_count_ + 3 * centre_count(); }
  std::size_t centre_count() const { return centres_.size(); }

  /// Known values and field of the right-hand sides of some rows.
  struct Columnwise {
    ConstrainedSystem::Known values;
    MapField field;
  };
  /// Of a handle's four rows; beyond the handles, of those that are blended linearly.
  Columnwise handle_sides(std::size_t number) const;
  const Columns& centre_weights() const { return centre_weights_; }  ///< φ, patch × centres
  /// Means over cells, of values with so many rows a vertex, and as a matrix.
  Columns cell_means(const Columns& values, int rows_per_vertex) const;
  SparseRows cell_mean_rows(int rows_per_vertex) const;
  /// Means of the local maps that rows first, first + stride, … cause.
  void set_maps(std::size_t first, std::size_t stride, const Columns& means);
  /// The local maps with all handles at rest, where anchors have targets.
  void set_base_maps(const Columns& maps) { base_maps_ = cell_means(maps, 3); }
  /// Lets go of what only the set-up needs.
  void finish();

  struct Result {
    Columns coefficients;  ///< width() × 3
    int iterations = 0;
    double change = 0;
    bool linear = false;
  };
  Result find(std::span<const HandlePose> poses, const HandleFrame* frames, const Context& context) const;

 private:
  void spread_logs(const Context& context);
  void choose_samples(Index centres, Index samples);
  void spread_samples(SolverBackend backend, const Context& context);
  void reduce_smoothing(const Context& context);
  void fit_loose_components();
  struct Logs;
  bool handle_logs(std::span<const HandlePose> poses, const Columns& frames, Logs& logs) const;
  BlendedMap blend(const Logs& logs, Eigen::Index row, const Columns& influence, Index component) const;
  Eigen::Matrix3d cell_map(std::size_t cell, const Columns& coefficients) const;
  void local_steps(const std::vector<BlendedMap>& at_centres, const std::vector<BlendedMap>& at_cells,
                   Result& result, const Context& context) const;
  void set_field(const std::vector<BlendedMap>& at_centres, const Columns& deviation,
                 Columns& coefficients) const;

  // For the set-up; null and empty afterwards.
  const ConstrainedSystem* system_;
  const RotationField* rotations_;
  std::span<const Handle> handles_;
  std::vector<Index> cell_;  ///< of each vertex of the patch; -1 where the map is given
  Columns given_;            ///< patch × handles: 1 where the handle gives the map
  Columns
      centre_weights_;     ///< φ: patch × centres, 1 at its centre and 0 at the others and where maps are given
  Columns given_weights_;  ///< φ: patch × handles, 1 where the handle gives the map and 0 at the centres
  Columns blend_weights_;  ///< χ: patch × handles, the same without centres: how logarithms are blended

  // What frames need.
  std::size_t handle_count_ = 0;
  int iterations_ = 0;
  Flags gives_maps_;                      ///< per handle: it constrains transforms of the patch
  std::vector<double> given_areas_;       ///< per handle, of the vertices where it does
  bool from_rest_ = false;                ///< something stays at rest, from which turns count
  std::vector<Index> centres_, samples_;  ///< vertices of the patch; the centres are the first samples
  std::vector<Index> centre_component_, cell_component_;  ///< of components without a given map, else -1
  std::vector<Columns> fits_;                             ///< of those: (M − I)ᵀ = fit (3 × 4H) · frames
  Columns centre_influence_, cell_influence_;             ///< χ at centres, and its means over cells
  Columns interpolation_;                                 ///< cells × centres: means of φ
  Columns smoothing_;          ///< centres × cells: what the smoothed field takes from where
  std::vector<double> areas_;  ///< of cells
  Points normals_;             ///< of cells, where the maps do not know what happens to them; else 0
  /// Of each cell the columns of (M − I)ᵀ that `width()` rows cause: three numbers and a zero, to be added at
  /// once.
  Eigen::Matrix<double, 4, Eigen::Dynamic> maps_;
  Columns base_maps_;  ///< 3 rows a cell: with all handles at rest
};

}  // namespace meshgraft
