#pragma once

#include <array>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "constrained_system.h"
#include "limb_twist.h"
#include "rotation_field.h"

namespace meshgraft {

/// An edge of a shell, and the corners of its faces across from it.
struct Hinge {
  std::array<Index, 4> vertices;  ///< v3 is -1 if the edge does not join two faces: nothing bends there
  bool stretches = false;         ///< whether an end moves
  double bending = 1;             ///< factor of the bending energy
  Index component = 0;            ///< of the moving vertices
};

/// The shape of a hinge.
struct HingeShape {
  double length = 0, angle = 0;  ///< of the edge, and between its faces (radians)
  std::array<Eigen::Vector3d, 4> length_slope{}, angle_slope{};  ///< gradients by the vertices
};

/// Returns the shape of the hinge of four points; of the first two if nothing bends.
HingeShape hinge_shape(const std::array<Eigen::Vector3d, 4>& points, bool bends);

/// The part of a surface that moves as a thin shell, in patch units. Vertices with a constraint, a feature or
/// an anchor are held. So is the ring of a vertex whose local map is given, where no face around it has three
/// such corners: points and curves then turn the surface.
class ShellSurface {
 public:
  /// `system` and `limbs` must outlive this.
  ShellSurface(const ConstrainedSystem& system, const LimbTwist& limbs, const Context& context);

  /// The shape that the shell wants to have.
  struct Metric {
    std::vector<double> lengths, angles;        ///< per hinge
    std::vector<double> areas;                  ///< per hinge: a third of its faces
    std::vector<double> face_areas;             ///< per face; 0 where it is too thin to have one
    std::vector<double> hinge_sums, face_sums;  ///< per component: of the areas
  };
  /// Returns the shape at rest under a strain. Faces beside an edge on a limb that twists turn against each
  /// other, as they do on the helix.
  Metric metric(const RestStrain& strain, const Context& context) const;

  /// Multiplies the local maps of the moving vertices (rows 3v … 3v+2 are (M_v − I)ᵀ) by those that take the
  /// surface before to the one after: the maps that fit the edges at a vertex and its normal best.
  void follow(const Points& before, const Points& after, Columns& maps) const;

  std::array<Eigen::Vector3d, 4> points(const Hinge& hinge, const Points& positions) const;

  const std::vector<Hinge>& hinges() const { return hinges_; }
  const std::vector<Eigen::Vector3<Index>>& faces() const { return faces_; }  ///< those with a moving corner
  Index component_of_face(std::size_t face) const { return component_of_face_[face]; }
  Index components() const { return components_; }
  /// Returns the length as which shorter edges of a component count, so that they do not outweigh the rest.
  double shortest(Index component) const { return shortest_[component]; }
  const std::vector<Index>& moving() const { return moving_; }    ///< vertices, ascending
  Index unknown(Index vertex) const { return unknown_[vertex]; }  ///< rank in `moving`, or -1

 private:
  Flags free_vertices() const;
  void choose_moving(const Context& context);
  void list_hinges(const Context& context);
  void measure_edges();
  void grade_bending();
  std::array<Eigen::Vector3d, 4> strained(const Hinge& hinge, const RestStrain& strain) const;
  double wanted_area(const Eigen::Vector3<Index>& face, const RestStrain& strain) const;
  double wanted_angle(const Hinge& hinge, const RestStrain& strain, double strained) const;

  const ConstrainedSystem& system_;
  const LimbTwist& limbs_;
  std::vector<Index> moving_, unknown_;
  std::vector<Eigen::Vector3<Index>> faces_;
  std::vector<Index> component_of_face_;
  Index components_ = 0;
  std::vector<double> shortest_;
  std::vector<Hinge> hinges_;
};

}  // namespace meshgraft
