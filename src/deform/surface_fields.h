#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// ∫ |Δf|² over a surface as a matrix K M⁻¹ K, wherever fields are given.
struct BendingMatrix {
  std::vector<double> areas;  ///< of the vertices, none of a face smaller than `smallest_area`
  double smallest_area = 0;
  SparseRows matrix;

  BendingMatrix(const Points& points, const Triangles& triangles, const IndexLists& rings,
                const Context& context);
};

/// Scalar fields on a surface, given at some vertices: spread from there as smoothly as can be, or made smooth
/// elsewhere. Both minimise integrals over the surface (K the Dirichlet matrix, M the vertex areas), so that
/// the answer does not depend on how finely the surface is triangulated.
class SurfaceFields {
 public:
  /// `given` flags per vertex; the smoothing length ℓ is relative to the width of the surface between the
  /// places where values are given. Negative: `smooth` will not be called. `cuts` of the rings are used, or
  /// filled. `bending` is of this surface, or of one that it is a part of: then rows within two edges of what
  /// lies outside are not used.
  SurfaceFields(const Points& points, const Triangles& triangles, const IndexLists& rings,
                const std::shared_ptr<BisectionTree>& cuts, std::span<const std::uint8_t> given,
                std::shared_ptr<const BendingMatrix> bending, double smoothing_length_rel,
                SolverBackend backend, const Context& context = {});

  /// Fields (n×k) with the rows of `values` where they are given and least ∫ |Δf|² elsewhere. On components
  /// where nothing is given, all of `values` as they are.
  Columns spread(const Columns& values, const Context& context = {}) const;

  /// Fields (n×k) that are 0 where values are given, and minimise ∫ |f − values|² + ℓ⁴ |Δf|² elsewhere. An
  /// iterative backend starts from `guess` (n×k).
  Columns smooth(const Columns& values, const Columns& guess, const Context& context = {}) const;

  const std::vector<double>& areas() const { return areas_; }
  /// Connected components: of each vertex (-1 for isolated ones), and whether a value is given in it.
  const std::vector<Index>& component() const { return component_; }
  const Flags& component_holds() const { return holds_; }
  const std::shared_ptr<const BendingMatrix>& bending() const { return bending_; }

 private:
  bool bounds_alike(const IndexLists& rings, double smallest) const;
  void find_components(const IndexLists& rings, std::span<const std::uint8_t> given);
  std::vector<double> free_widths(const Context& context) const;
  static void add(const Eigen::MatrixXd& solution, const std::vector<Index>& vertices, Columns& fields);

  std::shared_ptr<const BendingMatrix> bending_;
  std::vector<double> areas_;
  std::vector<Index> component_;
  Flags holds_;
  std::vector<Index> given_, free_;  ///< vertices of faces, by whether a value is given
  std::vector<Index> held_;          ///< of `free_`, those in components where something is given
  SparseRows spread_rows_;           ///< held × n, of the system that `spread` solves
  std::unique_ptr<LinearSolver> spread_solver_, smooth_solver_;
};

}  // namespace meshgraft
