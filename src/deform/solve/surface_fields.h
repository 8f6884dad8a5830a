#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "linalg/sparse.h"
#include "operators/intrinsic_delaunay.h"

namespace meshgraft {

/// A surface on which fields are sought, by reference. `bisection` of the rings is used, or filled if empty.
struct FieldSurface {
  const Points& points;
  const Triangles& triangles;
  const IndexLists& rings;
  const IntrinsicEdges& edges;
  const std::shared_ptr<BisectionTree>& bisection;
};

/// ∫ |∇f|² and ∫ |Δf|² over a surface as matrices K and K M⁻¹ K, where K is the Dirichlet matrix of the
/// intrinsic edges. They do not depend on where fields are given.
struct BendingMatrix {
  std::vector<double> areas;  ///< per vertex; at least `smallest_area` if it has faces
  double smallest_area = 0;
  SparseRows tension;  ///< K
  SparseRows matrix;   ///< K M⁻¹ K

  BendingMatrix(const FieldSurface& surface, const Context& context);
};

/// The bending lengths of spread and of smoothed fields, × √(area without given values) of each component.
inline constexpr double spreading_length_rel = 0.01, smoothing_bending_length_rel = 0.04;

struct SurfaceFieldOptions {
  /// The bending length t of `spread`, × √(area without given values) of each component. Absent: fields bend
  /// only, as if t were infinite.
  std::optional<double> bending_length_rel = spreading_length_rel;
  /// The smoothing length ℓ, × the width of the surface between vertices with given values. Absent: `smooth`
  /// must not be called.
  std::optional<double> smoothing_length_rel{};
  SolverBackend backend = SolverBackend::automatic;
  /// Whether spread values are corrected by their residual.
  bool corrects = true;
};

/// Scalar fields on a surface, given at some vertices. They are extended from there as smoothly as possible,
/// or smoothed elsewhere. Both minimise integrals over the surface (K the Dirichlet matrix, M the vertex
/// areas). The result therefore does not depend on how finely the surface is triangulated.
class SurfaceFields {
 public:
  /// `given` has a flag per vertex. `bending` belongs to this surface, or to a larger one that contains it. In
  /// the latter case rows within two edges of the rest of the larger surface are not used.
  SurfaceFields(const FieldSurface& surface, std::span<const std::uint8_t> given,
                std::shared_ptr<const BendingMatrix> bending, const SurfaceFieldOptions& options = {},
                const Context& context = {});

  /// Returns fields (n×k) that equal `values` where they are given and have least ∫ |∇f|² + t² |Δf|² elsewhere
  /// (∫ |Δf|² if t is infinite). They turn smoothly into the given values over t, and are nearly harmonic
  /// beyond. Components without given values keep all of `values`.
  Columns spread(Columns values, const Context& context = {}) const;

  /// Returns fields (n×k) that are 0 where values are given and minimise
  /// ∫ |f − values|² + ℓ² (|∇f|² + s² |Δf|²) elsewhere, with s = 0.04 √(area without given values). An
  /// iterative backend starts from `guess` (n×k), and ends at a relative error of max(`tolerance`,
  /// 1e-7).
  Columns smooth(const Columns& values, const Columns& guess, const Context& context = {},
                 double tolerance = 0) const;

  const std::vector<double>& areas() const { return areas_; }
  /// Return the connected component of each vertex (-1 for isolated ones), and whether it has given values.
  const std::vector<Index>& component() const { return component_; }
  const Flags& constrained_components() const { return constrained_; }
  const std::shared_ptr<const BendingMatrix>& bending() const { return bending_; }

 private:
  bool bounds_alike(const IndexLists& rings, double smallest) const;
  void find_components(const IndexLists& rings, std::span<const std::uint8_t> given);
  std::vector<double> free_areas() const;
  SparseRows energy_rows(const BendingMatrix& bending, const std::vector<Index>& vertices,
                         std::optional<double> bending_length_rel, const Context& context) const;
  std::vector<double> free_widths(std::optional<double> bending_length_rel, const Context& context) const;
  Columns one_given_value(const Columns& values) const;
  std::vector<Eigen::Index> columns_that_vary(const Columns& values, const Columns& origins,
                                              const Context& context) const;

  std::shared_ptr<const BendingMatrix> bending_;
  std::vector<double> areas_;
  std::vector<Index> component_;
  Flags constrained_;
  std::vector<Index> given_, free_;  ///< vertices with faces, with and without a given value
  std::vector<Index> spread_to_;     ///< vertices of `free_` in components with given values
  int passes_ = 2;                   ///< solves of `spread`
  SparseRows spread_rows_;           ///< k×n, the rows of the system that `spread` solves
  std::unique_ptr<LinearSolver> spread_solver_, smooth_solver_;
};

}  // namespace meshgraft
