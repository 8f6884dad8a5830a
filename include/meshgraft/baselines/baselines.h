#pragma once

#include <span>
#include <string_view>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/constraints.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/operators/options.h>

namespace meshgraft {

/// Published deformation methods, to compare others with on the same edit (docs/architecture.md).
enum class Baseline {
  /// Botsch and Kobbelt, An intuitive framework for real-time freeform modeling, SIGGRAPH 2004.
  botsch_kobbelt_2004,
  /// Lipman, Sorkine, Cohen-Or, Levin, Rössl, Seidel, Differential coordinates for interactive mesh editing,
  /// SMI 2004.
  lipman_2004,
  /// Sorkine, Cohen-Or, Lipman, Alexa, Rössl, Seidel, Laplacian surface editing, SGP 2004.
  sorkine_2004,
  /// Yu, Zhou, Xu, Shi, Bao, Guo, Shum, Mesh editing with Poisson-based gradient field manipulation,
  /// SIGGRAPH 2004.
  yu_2004,
  /// Sorkine and Alexa, As-rigid-as-possible surface modeling, SGP 2007.
  sorkine_alexa_2007,
};

inline constexpr Baseline all_baselines[] = {Baseline::botsch_kobbelt_2004, Baseline::lipman_2004,
                                             Baseline::sorkine_2004, Baseline::yu_2004,
                                             Baseline::sorkine_alexa_2007};

/// "botsch-kobbelt-2004", "lipman-2004", "sorkine-2004", "yu-2004", "arap-2007".
std::string_view to_string(Baseline value);

/// How Yu et al.'s local transforms reach the free surface.
enum class Propagation {
  distance,  ///< in inverse proportion to the distance along edges from each constrained group (the paper)
  harmonic,  ///< as harmonic functions (Zayer, Rössl, Karni, Seidel, Harmonic guidance, Eurographics 2005)
};

/// The defaults show each method at its best on the four tests of Botsch and Sorkine (2008), by edge lengths
/// and dihedral angles.
struct BaselineOptions {
  /// botsch-kobbelt-2004: k of the k-harmonic surface, 1 … 3. k = 3 needs handles of many smooth rings.
  int harmonic_order = 2;
  /// botsch-kobbelt-2004: wavelength, × mean edge length, below which shape counts as detail. With 0 all does,
  /// as in the paper: the base is then k-harmonic itself, which on a limb collapses to a thread without frames.
  /// Only with 0 is a rigid motion of all constraints reproduced exactly.
  double detail_size_rel = 30;
  int normal_rings = 16;                                  ///< lipman-2004: over which normals are averaged
  WeightScheme lipman_weights = WeightScheme::cotangent;  ///< of the Laplacian
  WeightScheme sorkine_weights = WeightScheme::uniform;   ///< of the Laplacian
  Propagation propagation = Propagation::distance;        ///< yu-2004
  int arap_iterations = 100;                              ///< arap-2007: at most so many
  double arap_tolerance = 1e-6;  ///< arap-2007: stops at this relative change of energy
  SolverBackend backend = SolverBackend::automatic;
};

/// Throws Error(input) naming the field if a value is out of its range.
void validate(const BaselineOptions& options);

/// New positions (n×3, model units) of a mesh, `rest` n×3 and `triangles` m×3, under constraints per vertex.
/// Vertices outside `region` (all are inside if it is empty) stay, with local transform I, and keep their bits;
/// constrained positions are met exactly; isolated vertices pass through. Only yu-2004 uses local transforms;
/// for the others a vertex without a constrained position is free. The result scales with the model and does
/// not depend on the number of threads.
///
/// Throws Error(input) for bad indices, constraints and options, and a coordinate within reach that is not
/// finite; Error(unsolvable) where a free component meets no known position, or, with sorkine-2004, too few to
/// fix a similarity (all on one line).
Points deform_by(Baseline method, const Points& rest, const Triangles& triangles, std::span<const Index> region,
                 std::span<const VertexConstraint> constraints, const BaselineOptions& options = {},
                 const Context& context = {});

}  // namespace meshgraft
