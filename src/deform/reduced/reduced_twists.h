#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "blended_logs.h"
#include "deform/solve/limb_twist.h"
#include "linalg/sparse.h"

namespace meshgraft {

/// Points, and all that determines the strain of twists there.
struct TwistPoints {
  std::vector<LimbPoint> limbs;
  Columns influence;  ///< points × handles: the weights by which the handles' logarithms are blended
  Columns slopes;     ///< their rates along `LimbPoint::direction`
};

/// The samples and cells of a surface.
struct SampledSurface {
  std::span<const Index> samples;     ///< vertices
  std::span<const Index> cells;       ///< per vertex: the number of its cell, or -1
  std::span<const double> areas;      ///< per vertex
  std::span<const Index> components;  ///< per vertex: the connected component
  std::span<const double> cell_areas;
  const Columns& influence;       ///< vertices × handles: the weights by which logarithms are blended
  const Columns& cell_influence;  ///< cells × handles: their means
};

/// The strain of twists (`LimbTwist`) as a sum of few functions. The coefficient of each is a 3×3 matrix, so
/// that their sum is R W (`twist_shear`).
///
/// The functions are smooth ones, such as those of centres, and the components of the strains that turns of the
/// handles cause (`twist_modes`). Around discs strain begins and ends abruptly. The samples are
/// too few to tell where, so that the strain that the handles alone cause is fitted at many more points.
class ReducedTwists {
 public:
  /// The coefficients, one row of a 3×3 matrix in the order of columns for each function.
  using Maps = Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor>;

  ReducedTwists() = default;
  /// Takes over the smooth functions (vertices × functions). `handles` are those whose turns have components.
  ReducedTwists(const LimbTwist& limbs, const SampledSurface& surface, Columns smooth_functions,
                std::span<const Index> handles, Eigen::Index components, const Context& context);

  /// Returns whether nothing is on a limb or disc. Others must then not be called.
  bool empty() const { return samples_.limbs.empty(); }
  std::size_t function_count() const { return static_cast<std::size_t>(sample_fit_.rows()); }
  const Columns& functions() const { return functions_; }  ///< vertices × functions, until `finish`
  void finish() { functions_ = {}; }
  std::int64_t memory_bytes() const {
    return static_cast<std::int64_t>(sizeof(double)) * (sample_fit_.size() + point_fit_.size());
  }

  /// Returns W at a sample where the handles alone stretch the surface by `stretch`.
  Eigen::Matrix3d shear_at_sample(const BlendedLogs& logs, Eigen::Index sample,
                                  const Eigen::Matrix3d& stretch) const;
  /// Returns the mean strain W m bᵀ of a cell.
  Eigen::Matrix3d strain_of_cell(const BlendedLogs& logs, Eigen::Index cell,
                                 const Eigen::Matrix3d& stretch) const;
  /// Returns the coefficients of the strain that the handles alone cause.
  Maps of_handles(const BlendedLogs& logs, const Context& context) const;
  /// Returns the coefficients of a change of R W, given at the samples.
  Maps of_change(const Maps& at_samples) const { return sample_fit_ * at_samples; }

 private:
  void fit(const SampledSurface& surface, const Eigen::VectorXd& weights, Eigen::Index smooth_count,
           std::span<const Index> points);

  Columns functions_;
  TwistPoints samples_, cells_;  ///< those of cells have the samples' limbs and slopes, but means of influence
  TwistPoints points_;
  std::vector<Eigen::Matrix3d> cell_strains_;  ///< per cell: mean of m bᵀ = s (a × r) bᵀ
  Eigen::MatrixXd sample_fit_, point_fit_;     ///< functions × samples or points
};

}  // namespace meshgraft
