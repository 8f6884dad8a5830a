#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Name of the vertex attribute with the uncut surface's unit normals on the loops that a cut makes (3
/// components, NaN away from the cut). A graft can then continue the original surface.
inline constexpr const char* cut_normal_name = "cut_normal";

enum class CutKeep { above, below, both };

/// How the halves of a cut by a plane are closed.
enum class CutCap {
  open,  ///< not at all
  flat,  ///< by a flat cap
  pins,  ///< by flat caps, one with pins and the other with holes that take them, for gluing
};

/// The half that carries the pins.
enum class PinSide { above, below };

/// Options of a cut. Lengths are in model units; those of the pins follow from the size of each cap unless
/// given.
struct CutOptions {
  CutKeep keep = CutKeep::both;
  /// An edge that is cut within this fraction of its length from an end is cut at that end instead. The end
  /// is moved there, which avoids slivers. 0 keeps every vertex in place.
  double snap = 0.1;
  CutCap cap = CutCap::open;
  std::optional<Index> pin_count;      ///< pins on each cap, 1 to 32; two unless given
  std::optional<double> pin_diameter;  ///< 0.8 × the radius of equal circles that fit the cap, one for each pin
  std::optional<double> pin_length;    ///< 1.5 × the diameter
  std::optional<double>
      pin_clearance;  ///< by how much a hole is wider, all round, and deeper: 0.05 × the diameter
  PinSide pin_side = PinSide::below;
};

/// A pin that a cut made, and the hole that takes it.
struct CutPin {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< on the cap
  double diameter = 0, length = 0, clearance = 0;    ///< of the pin, model units
};

struct CutResult {
  /// The kept vertices in their order, then those on the cut; with `both`, those on the cut twice; then those
  /// of pins and holes.
  Mesh mesh;
  IndexMap vertex;  ///< uncut mesh → `mesh`; a vertex on the cut maps to its first copy
  /// Per vertex of `mesh`: its location on the uncut mesh; from = to = -1 in pins and holes.
  std::vector<EdgePoint> origin;
  std::vector<Index> face_parent;  ///< per face of `mesh`: the uncut face that it is a piece of; -1 in a cap
  /// Per face of `mesh`: 1 above, -1 below, 0 where the cut separates nothing.
  std::vector<std::int8_t> face_side;
  /// The boundary loops that the cut made, as `boundary_loops` lists them, before they were closed.
  std::vector<std::vector<Index>> loops;
  std::vector<CutPin> pins;
  std::vector<Note> notes;  ///< on pins that are other than asked for
};

/// Returns the vertices of the uncut mesh that a cut touches, ascending: ends of cut edges, and vertices on
/// the cut.
std::vector<Index> vertices_at_cut(const CutResult& result);

/// Cuts a mesh along the zero set of a function with one value per vertex, linear along edges. Vertices are
/// inserted on the edges that the zero set crosses, and faces are split there; "above" is where the function
/// is positive. Open meshes may be cut across their boundary. Attributes follow their interpolation rule;
/// corner values stay within their face. Throws Error(input) for a wrong number of values, for non-finite
/// values, where nothing is cut (mesh.nothing_cut), and for caps (mesh.cap_needs_plane).
CutResult cut_at_zero(const Mesh& mesh, std::span<const double> values, const CutOptions& options = {},
                      const Context& context = {});

/// Cuts by a plane, whose normal points above, and closes the halves if `cap` says so. The triangles of a cap
/// join the vertices on the cut; new faces and vertices take attributes from those around them. Each pin is a
/// prism of 32 sides with a chamfer at its end. It lies inside the cap as far from its outline and from other
/// pins as it can. A hole leaves at least a quarter of the diameter to the surface. Pins become
/// smaller or shorter where there is no room, and `notes` tells of it.
///
/// Throws Error(input): mesh.plane_misses_mesh where the mesh lies on one side; where a cap is asked for,
/// mesh.cap_outline_open, mesh.cap_outline_crosses and mesh.cap_inside_out for cuts that have no inside;
/// mesh.no_room_for_pins if no cap takes a pin, or mesh.pins_do_not_fit if a size was given, at the option that
/// gives it.
CutResult cut_by_plane(const Mesh& mesh, const Plane& plane, const CutOptions& options = {},
                       const Context& context = {});

/// Cuts along the closed curve that joins the listed vertices, in order, by shortest paths on the surface.
/// "Above" is on the left, seen from outside. Throws Error(input) for fewer than three vertices, repeated or
/// unconnected ones (mesh.no_path), for a curve that crosses itself (mesh.loop_crosses_itself), and for caps
/// (mesh.cap_needs_plane).
CutResult cut_along_loop(const Mesh& mesh, std::span<const Index> vertices, const CutOptions& options = {},
                         const Context& context = {});

}  // namespace meshgraft
