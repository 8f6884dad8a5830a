#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/deform/constraints.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

enum class HandleShape { vertex, curve, region };

/// A named vertex set that is moved as one (FT05 section 4).
struct Handle {
  std::string name{};
  HandleShape shape = HandleShape::region;
  std::vector<Index> vertices{};  ///< distinct; in order along the curve for `curve`
  bool closed = false;            ///< of a curve: the last vertex is followed by the first
  bool constrain_position = true;
  bool constrain_transform = true;
};

/// Nine degrees of freedom: x' = c + t + R·S·(x − c).
struct HandleMotion {
  Eigen::Vector3d translate = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< of the rotation; need not have unit length
  double angle_deg = 0;                             ///< any number of turns
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< per axis
  std::optional<Eigen::Vector3d> pivot{};           ///< c; the centre of the handle's rim if absent
};

/// Where a handle is: one affine map for all of its vertices, or a redrawn curve.
struct HandlePose {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  /// The rotation inside `transform` as it was asked for, so that 270° and 720° are not reduced.
  std::optional<Eigen::AngleAxisd> rotation{};
  /// For a redrawn curve: the new place of each vertex (k×3, used instead of `transform`). Local transforms
  /// turn the old frame (tangent, normal) into the new one and scale by the ratio of the arc lengths.
  std::optional<Points> curve{};
};

/// Centre of the handle's rim: the mean of its vertices that have a neighbour outside, or of all of them.
/// Throws Error(input) if the handle is empty or names a vertex that does not exist.
Eigen::Vector3d handle_pivot(const Handle& handle, const Points& rest, const IndexLists& vertex_rings);

/// The affine map of a motion about `default_pivot` (used when the motion names none). Multiples of 90° are
/// turned without rounding; `HandlePose::rotation` keeps the angle (radians) with all its turns.
/// Throws Error(input) for a number that is not finite and for an axis without length where there is an angle.
HandlePose make_pose(const HandleMotion& motion, const Eigen::Vector3d& default_pivot);

/// What is seen of a pose in a mirror: S ∘ pose ∘ S for the reflection S, with all its turns (the axis
/// mirrored, the other way round); each point of a redrawn curve mirrored. `reflection` has to be one.
HandlePose reflected(const HandlePose& pose, const Eigen::Affine3d& reflection);

/// A polyline (k×3) sampled at the relative arc lengths of the curve handle's rest vertices: one row per
/// vertex, the first at the polyline's start and, for an open curve, the last at its end. The polyline of a
/// closed curve is closed from its last point to its first. Throws Error(input) for a handle that is no curve,
/// too few points, a curve or polyline without length, and a coordinate that is not finite.
Points redraw_curve(const Handle& handle, const Points& rest, const Points& polyline);

/// The constraints of a curve handle whose vertices move to `redrawn` (one row per vertex), in its order
/// (Fu & Tai 2005, section 4). At each vertex the rest frame is the unit tangent t (central difference;
/// one-sided at the ends of an open curve, cyclic on a closed one), the vertex normal made orthogonal to t, and
/// their cross product. The new frame has the redrawn curve's tangent t' and the old normal carried along by
/// the smallest rotation that takes t to t'. Then R = new · oldᵀ is that rotation, S the ratio of the arc
/// lengths around the vertex (half of each adjoining segment), and W = S·R. A curve that is not redrawn gives
/// exactly W = I. Where the tangent turns right round (t' = −t), it turns about the normal. `rest` and
/// `rest_normals` are n×3, over the mesh. Throws Error(input) for a handle that is no curve, and where
/// neighbouring points coincide so that there is no tangent.
std::vector<VertexConstraint> curve_constraints(const Handle& handle, const Points& rest,
                                                const Points& rest_normals, const Points& redrawn);

/// What a pose asks of a handle's vertices, in their order, as far as the handle constrains it: u = pose · p,
/// and for W the pose's linear part with its rotation and all its turns; for a redrawn curve, its
/// `curve_constraints`. `rest` is n×3, `rest_normals` too; the latter are used for redrawn curves alone. Throws
/// what `curve_constraints` throws.
std::vector<VertexConstraint> handle_constraints(const Handle& handle, const HandlePose& pose,
                                                 const Points& rest, const Points& rest_normals);

}  // namespace meshgraft
