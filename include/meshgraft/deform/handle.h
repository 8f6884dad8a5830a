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
  double angle_deg = 0;                                 ///< any number of turns
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();      ///< per axis
  std::optional<Eigen::Vector3d> pivot{};               ///< c, model units; absent: `handle_pivot`
};

/// The pose of a handle: one affine map for all its vertices, or a redrawn curve.
struct HandlePose {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  /// The requested rotation inside `transform`, kept so that 270° and 720° are not reduced.
  std::optional<Eigen::AngleAxisd> rotation{};
  /// For a redrawn curve: the new position of each vertex (k×3, model units), used instead of `transform`.
  /// Local transforms turn the old frame (tangent, normal) into the new one and scale by the ratio of the arc
  /// lengths.
  std::optional<Points> curve{};
};

/// Returns the centre of the handle's boundary: the mean of its vertices that have a neighbour outside the
/// handle. If there are none, it is the mean of all its vertices. Throws Error(input) if the handle is empty
/// or has a vertex index out of range.
Eigen::Vector3d handle_pivot(const Handle& handle, const Points& rest, const IndexLists& vertex_rings);

/// Returns the affine map of a motion about `motion.pivot`, or about `default_pivot` if that is absent.
/// Multiples of 90° are applied without rounding; `HandlePose::rotation` keeps the angle (radians) with all
/// its turns. Throws Error(input) for a non-finite number, and for an axis of zero length with a non-zero
/// angle.
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
/// handle's order (Fu & Tai 2005, section 4).
///
/// The rest frame at each vertex has three axes: the unit tangent t, the vertex normal made orthogonal to t,
/// and their cross product. The tangent is a central difference, one-sided at the ends of an open curve and
/// cyclic on a closed one. The new frame has the redrawn curve's tangent t' and the old normal, turned by the
/// smallest rotation that takes t to t'. Then R = new · oldᵀ is that rotation, S is the ratio of the arc
/// lengths around the vertex (half of each adjoining segment), and W = S·R. A curve that is not redrawn gives
/// exactly W = I. Where the tangent is reversed (t' = −t), it turns about the normal.
///
/// Throws Error(input) for a handle that is no curve, and with the id deform.curve_without_tangent where
/// neighbouring points coincide so that the tangent is undefined.
std::vector<VertexConstraint> curve_constraints(const Handle& handle, const RestSurface& rest,
                                                const Points& redrawn);

/// Returns the constraints of a handle's vertices under a pose, in their order, as far as the handle
/// constrains them. The position is u = pose · p; W is the pose's linear part with its rotation and all its
/// turns. A redrawn curve has its `curve_constraints` instead. Throws what `curve_constraints` throws.
std::vector<VertexConstraint> handle_constraints(const Handle& handle, const HandlePose& pose,
                                                 const RestSurface& rest);

}  // namespace meshgraft
