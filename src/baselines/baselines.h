#pragma once

#include <string_view>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/operators/affine_operator.h>

namespace meshgraft {

/// Published deformation methods, for comparison with this library's methods on the same edit
/// (docs/architecture.md).
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
  arap_2007,
  /// Levi and Gotsman, Smooth rotation enhanced as-rigid-as-possible mesh animation, TVCG 2015.
  sr_arap_2015,
  /// Oehri, Herholz, Sorkine-Hornung, Higher order continuity for smooth as-rigid-as-possible shape modeling,
  /// arXiv 2501.10335, 2025.
  smooth_arap_2025,
};

inline constexpr Baseline all_baselines[] = {
    Baseline::botsch_kobbelt_2004, Baseline::lipman_2004,  Baseline::sorkine_2004,    Baseline::yu_2004,
    Baseline::arap_2007,           Baseline::sr_arap_2015, Baseline::smooth_arap_2025};

/// Returns "botsch-kobbelt-2004", "lipman-2004", "sorkine-2004", "yu-2004", "arap-2007", "sr-arap-2015" or
/// "smooth-arap-2025".
std::string_view to_string(Baseline value);

/// The rule by which yu-2004 spreads the constrained local transforms over the free surface.
enum class Propagation {
  distance,  ///< in inverse proportion to the distance along edges from each constrained group (the paper)
  harmonic,  ///< as harmonic functions (Zayer, Rössl, Karni, Seidel, Harmonic guidance, Eurographics 2005)
};

/// Selects the terms to which the local step of smooth-arap-2025 fits rotations.
enum class RotationFit {
  edges,   ///< the edges alone, which converges better (the paper)
  energy,  ///< all terms of the energy, which then never rises
};

/// Options of the published methods. Each default was chosen for the best edge lengths and dihedral angles on
/// the four tests of Botsch and Sorkine (2008), except the weights of sr-arap-2015 (CGAL's) and
/// smooth-arap-2025 (its paper's).
struct BaselineOptions {
  /// botsch-kobbelt-2004: the order k of the k-harmonic surface, 1 … 3. Order 3 needs handles that span many
  /// smooth rings.
  int harmonic_order = 2;
  /// botsch-kobbelt-2004: wavelength below which shape counts as detail, × mean edge length. With 0 all shape
  /// counts as detail, as in the paper, and the base surface is itself k-harmonic. On a limb such a base
  /// surface collapses to a thread, which gives no frames for the detail. Only with 0 is a rigid motion of
  /// all constraints reproduced exactly.
  double detail_size_rel = 30;
  int normal_rings = 16;                                  ///< lipman-2004: rings to average normals over
  WeightScheme lipman_weights = WeightScheme::cotangent;  ///< lipman-2004: Laplacian weights
  WeightScheme sorkine_weights = WeightScheme::uniform;   ///< sorkine-2004: Laplacian weights
  Propagation propagation = Propagation::distance;        ///< yu-2004: rule for the transforms
  int arap_iterations = 100;                              ///< methods with "arap": largest number of iterations
  double arap_tolerance = 1e-6;  ///< methods with "arap": relative change of energy at which to stop
  double sr_alpha = 0.01;        ///< sr-arap-2015: weight α of bending
  WeightScheme sr_weights = WeightScheme::uniform;   ///< sr-arap-2015: weights between neighbouring rotations
  double smoothness = 0.95;                          ///< smooth-arap-2025: share λ of the smooth term, 0 … 1
  RotationFit smooth_arap_fit = RotationFit::edges;  ///< smooth-arap-2025: rule of the local step
  SolverBackend backend = SolverBackend::automatic;
};

/// Throws Error(input), at the field, if a value is out of its range.
void validate(const BaselineOptions& options);

/// Returns new positions (n×3, model units) under constraints per vertex. Vertices outside the region and fixed
/// ones keep their coordinates bit for bit and have the local transform I. Constrained positions are met
/// exactly, and isolated vertices pass through. Only yu-2004 uses local transforms; for the other methods a
/// vertex without a constrained position is free. The result scales with the model and does not depend on the
/// number of threads.
///
/// Throws Error(usage) for a problem with handles, anchors or features (baselines.only_constraints).
/// Throws Error(input) for bad indices, constraints and options, and for a non-finite coordinate that the
/// edit reaches. Throws Error(unsolvable) where a free connected component meets no known position
/// (baselines.free_component_not_held). With sorkine-2004 it also does so where the known positions are too
/// few to fix a similarity, all on one line (baselines.known_positions_on_a_line).
Points deform_by(Baseline method, const DeformProblem& problem, const BaselineOptions& options = {},
                 const Context& context = {});

}  // namespace meshgraft
