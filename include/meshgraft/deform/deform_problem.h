#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/affine_operator.h>

namespace meshgraft {

/// Positions in the caller's memory, n×3, row after row: a `Points`, or an `Eigen::Map` of one.
using PointsRef = Eigen::Ref<Points, 0, Eigen::Stride<3, 1>>;

/// The boundary condition of one vertex. Position and transform may each be given without the other.
struct VertexConstraint {
  Index vertex = -1;
  std::optional<Eigen::Vector3d> position{};   ///< edited position u, model units
  std::optional<Eigen::Matrix3d> transform{};  ///< local transform W (rest → edited)
  /// The rotation inside `transform` with all its turns (radians), where it is known: 270° or 720° are then
  /// spread as such. Absent: the rotation of less than 180°.
  std::optional<Eigen::AngleAxisd> rotation{};
};

/// A stationary anchor (FT05 section 6): a soft row draws the vertex to a target position. Under
/// `Density::ft05` the row is weight · (x_i − target) beside the vertex's row of E_L. Under `aware` it is
/// scaled by the compliance of the surface at the anchors, so that weight 1 halves what the edit would move
/// them by (36 to 50 % were left in six edits by all methods) and weight 10 leaves a few per cent, at any
/// resolution.
struct Anchor {
  Index vertex = -1;
  double weight = 10;
  std::optional<Eigen::Vector3d> target{};  ///< model units; absent: the rest position
};

/// Vertices that share one unknown map x_i = T p_i + t (FT05 section 7). T is any affine map, or scale ·
/// rotation for a similarity.
struct Feature {
  std::vector<Index> vertices{};
  bool similarity = false;
  std::optional<double> scale{};  ///< scale of a similarity; absent: it is solved for
};

enum class HandleShape { vertex, curve, region };

/// A named vertex set that moves as one (FT05 section 4).
struct Handle {
  std::string name{};
  HandleShape shape = HandleShape::region;
  std::vector<Index> vertices{};  ///< distinct; in order along the curve for `curve`
  bool closed = false;            ///< for `curve`: the first vertex follows the last one
  bool constrain_position = true;
  bool constrain_transform = true;
};

/// A motion with nine degrees of freedom: x' = c + t + R·S·(x − c).
struct HandleMotion {
  Eigen::Vector3d translate = Eigen::Vector3d::Zero();  ///< t, model units
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();      ///< rotation axis; need not have unit length
  double angle_deg = 0;                                 ///< any number of turns, up to 1e6 degrees
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();      ///< per axis
  std::optional<Eigen::Vector3d> pivot{};               ///< c, model units; absent: `handle_pivot`
};

/// The pose of a handle: one affine map for all its vertices, or a redrawn curve.
struct HandlePose {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  /// The requested rotation inside `transform`, kept so that 270° and 720° are not reduced.
  std::optional<Eigen::AngleAxisd> rotation{};
  /// For a redrawn curve: the new position of each vertex (k×3, model units), used instead of `transform`.
  /// Local transforms turn with the curve (`curve_constraints`) and scale by the ratio of the arc lengths.
  std::optional<Points> curve{};
};

/// Returns the centre of the handle's boundary: the mean of its vertices that have a neighbour outside the
/// handle. If there are none, it is the mean of all its vertices. Throws Error(input) if the handle is empty
/// or has a vertex index out of range.
Eigen::Vector3d handle_pivot(const Handle& handle, const Points& rest, const IndexLists& vertex_rings);

/// Returns the affine map of a motion about `motion.pivot`, or about `default_pivot` if that is absent.
/// Multiples of 90° are applied without rounding; `HandlePose::rotation` keeps the angle (radians) with all
/// its turns. Throws Error(input) for a number that is not finite or too large (translation: 1e100, angle:
/// 1e6 degrees), and for an axis of zero length with a non-zero angle.
HandlePose make_pose(const HandleMotion& motion, const Eigen::Vector3d& default_pivot);

/// Returns the mirror image S ∘ pose ∘ S of a pose under the reflection S. The rotation keeps all its turns:
/// its axis is mirrored and its sense reversed. Each point of a redrawn curve is mirrored. `reflection` must
/// be a reflection.
HandlePose reflected(const HandlePose& pose, const Eigen::Affine3d& reflection);

/// Samples a polyline (k×3) at the relative arc lengths of the curve handle's rest vertices. Returns one row
/// per vertex: the first at the polyline's start and, for an open curve, the last at its end. The polyline of
/// a closed curve is closed from its last point to its first. Throws Error(input) for a handle that is no
/// curve, too few points, a curve or polyline of zero length, and a non-finite coordinate.
Points redraw_curve(const Handle& handle, const Points& rest, const Points& polyline);

/// A surface at rest, by reference: its vertices' positions and unit normals, both n×3. Only redrawn curves use
/// the normals, which may otherwise be empty.
struct RestSurface {
  const Points& points;
  const Points& normals;
};

/// Returns the constraints of a curve handle whose vertices move to `redrawn` (one row per vertex), in the
/// handle's order (Fu & Tai 2005, sections 3.3 and 4).
///
/// The curve as a whole turns by the rotation Q that fits the redrawn vertices best to those at rest (Kabsch
/// 1976, weighted by arc length). Each vertex then turns by the smallest rotation that takes Q t to t', the
/// unit tangents at rest and redrawn: central differences, one-sided at the ends of an open curve. With both
/// together R, and S the ratio of the arc lengths around the vertex (half of each adjoining segment), W = S·R.
///
/// So a curve that is redrawn as a similar copy of itself, T(curve), has W = the linear part of T, and acts as
/// a handle with the pose T. A curve in a plane that is redrawn as its mirror image in that plane is turned by
/// 180° (`is_mirror_image`), unless the plane is the tangent plane of the surface: there a bowed curve that is
/// redrawn within the plane turns within it, too (docs/method.md). Where the new course of a narrow curve is no
/// copy, its misfit draws Q towards the mean of the smallest rotations of the tangents; so does straightness,
/// where the second singular value of the curve is below 1e-3 of the first. A curve that is not redrawn gives
/// exactly W = I. Where the tangent is reversed (t' = −Q t), it turns about the normal.
///
/// Throws Error(input) for a handle that is no curve, and with the id deform.curve_without_tangent where
/// neighbouring points coincide so that the tangent is undefined.
std::vector<VertexConstraint> curve_constraints(const Handle& handle, const RestSurface& rest,
                                                const Points& redrawn);

/// Returns whether a curve in a plane is redrawn as its mirror image in that plane, which `curve_constraints`
/// take for half a turn. Throws Error(input) for a handle that is no curve.
bool is_mirror_image(const Handle& handle, const RestSurface& rest, const Points& redrawn);

/// Returns the constraints of a handle's vertices under a pose, in their order, as far as the handle
/// constrains them. The position is u = pose · p; W is the pose's linear part with its rotation and all its
/// turns. A redrawn curve has its `curve_constraints` instead. Throws what `curve_constraints` throws.
std::vector<VertexConstraint> handle_constraints(const Handle& handle, const HandlePose& pose,
                                                 const RestSurface& rest);

/// The vertices of a mesh that are free, fixed or constrained, by their roles.
struct Region {
  std::vector<Index> vertices{};  ///< the region of interest; unused if `whole` is set
  bool whole = false;             ///< the region is the whole mesh
  std::vector<Index> fixed{};     ///< vertices of the region that are fixed (rest position, transform I)
  std::vector<Handle> handles{};  ///< disjoint from each other and from `fixed`
  std::vector<Anchor> anchors{};
  std::vector<Feature> features{};
  bool symmetric = false;  ///< results are to be as symmetric as poses, so that no proxy is solved first
};

/// A deformation to solve: a mesh at rest, the region that may move, and what constrains it. The region has
/// handles, or the problem has constraints per vertex, but not both.
struct DeformProblem {
  Points rest{};          ///< n×3, model units
  Triangles triangles{};  ///< m×3
  /// Vertices outside the region keep their positions and the transform I, unless `constraints` gives others.
  Region region{};
  /// Constraints per vertex in place of handles; at most one for each vertex. Their values are those of the
  /// first evaluation. Later evaluations may change the values, but not which positions and transforms are
  /// given.
  std::vector<VertexConstraint> constraints{};
};

/// The rule by which rotations spread from the constraints (docs/methods.md). The methods share one matrix,
/// apart from `stiffness`. They differ in the field of maps F_i on the right-hand side of E_R:
/// ‖(M_i − M_j) d − (F_i − F_j) d‖².
enum class DeformMethod {
  ft05,            ///< F = I: maps are blended linearly (Fu & Tai 2005)
  rotation_aware,  ///< F blends the logarithms of the constraints' rotations and stretches
  corotational,    ///< starts from `rotation_aware`, then F follows the rotations of the surface itself
  shell,           ///< starts from `corotational`, then bends evenly as a thin shell does
};

/// Returns whether the field follows the rotations of the surface, by co-rotational iterations.
constexpr bool is_corotational(DeformMethod method) {
  return method == DeformMethod::corotational || method == DeformMethod::shell;
}

std::string_view to_string(DeformMethod value);

struct DeformerOptions {
  // The method.
  DeformMethod method = DeformMethod::corotational;
  /// The weight μ ≥ 0 of extra rows on edges that preserve lengths (not used by `ft05`). 0 bends most evenly;
  /// larger values are more rigid. Under `Density::aware` μ is relative to bending over the region's size,
  /// otherwise the rows have the plain weight μ.
  double stiffness = 60;
  /// Reduces the stiffness in regions with few edges across, where it would kink single edges at the border
  /// (docs/methods.md). Merging does not use it.
  bool soften_coarse = true;
  /// The number of vertices that each free vertex stands for, where edges across are counted. A proxy sets it,
  /// so that it is as stiff as the region in whose place it is solved.
  double vertices_represented = 1;
  int iterations = 20;  ///< largest number of co-rotational iterations
  /// Begins the iterations of 30,000 free vertices or more with rotations of a proxy, which saves steps. The
  /// proxy of a symmetric problem is not symmetric, and leaves differences of 1e-4 of the motion or less
  /// (`Region::symmetric` leaves it out).
  bool coarse_start = true;
  /// Length over which the co-rotational field is smoothed, × the width of the surface between constraints.
  double smoothing_length_rel = 0.04;
  // The operator.
  OperatorOptions operators{};
  // The solve.
  SolverBackend backend = SolverBackend::automatic;
  int residual_corrections = 1;  ///< corrections per solve by the residual of the rectangular system

  /// Returns the options of FT05 as written: its operator, by the method `ft05`. They never change.
  static DeformerOptions as_published();
};

/// Seconds per stage and figures of the set-up.
struct DeformerSummary {
  Index free_vertices = 0;   ///< vertices whose position is solved for
  Index fixed_vertices = 0;  ///< fixed vertices of the region
  Index handle_vertices = 0;
  Index degenerate_vertices = 0;  ///< free vertices with a flat or near-flat neighbourhood
  /// Set if the patch, the operator and more are shared with another Deformer (`Deformer::with_region`).
  bool reused = false;
  double assemble_seconds = 0;
  double analyse_seconds = 0;
  double factorise_seconds = 0;  ///< includes the scalar systems that spread rotations
  SolverStatistics solver{};
};

/// Figures of one evaluation.
struct EvaluationReport {
  double residual = 0;                 ///< ‖Aᵀ(b − A x)‖ / ‖Aᵀ b‖, 0 for a zero right-hand side
  double max_transform_deviation = 0;  ///< max ‖M_c(x) − W_c‖_F over constrained transforms
  int iterations = 0;                  ///< co-rotational iterations made
  int shell_steps = 0;                 ///< steps that the method `shell` made
  bool shell_settled = true;           ///< whether its last step changed the energy by less than 0.01 %
  int solver_iterations = 0;           ///< iterations of the backend `iterative` in the last solve
  double last_rotation_change = 0;     ///< RMS change of F asked for by the last iteration, radians
  Index inverted_maps = 0;             ///< free vertices whose local map has a determinant of 0 or less
  /// Set if transforms were blended linearly because a constraint reflects or flattens, so that its transform
  /// has no logarithm.
  bool fell_back_to_linear = false;
  /// The largest ratio of two stretches of the affine map that a component follows because its constraints give
  /// positions alone; 1 if there is none. Not computed by the method `ft05` and by quick frames.
  double position_stretch = 1;
};

/// Returns an estimate of the bytes that the solver of a `Deformer` with that many free vertices needs,
/// before anything is computed. It agrees with `SolverStatistics::peak_memory_bytes` within a factor of two
/// on regions of 1,000 to 160,000 vertices (measured on sheets, tubes, bars, spheres and tori). The whole
/// set-up takes up to twice as much. Throws Error(input) for a negative number.
std::int64_t estimated_memory(Index free_vertices, const DeformerOptions& options = {});

}  // namespace meshgraft
