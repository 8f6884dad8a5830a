#pragma once

#include <array>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Corners of a triangle in a hole, as indices into its loop, ascending (which is along the loop).
using HoleTriangle = std::array<Index, 3>;

/// Two vertices of a loop, the smaller index first, that are not neighbours on it.
using HoleChord = std::array<Index, 2>;

/// A closed polyline that is to be covered by triangles.
struct HoleLoop {
  Points points;  ///< n×3
  /// n×3, or 0×3: of the face on the other side of the edge from point k to the next its third corner.
  Points beyond{0, 3};

  Index size() const { return static_cast<Index>(points.rows()); }
};

/// What a triangulation is to have.
enum class HoleAim {
  /// The smallest largest angle between the normals of neighbours, the faces beyond the loop included; then the
  /// smallest area. Angles that differ by less than 5e-10 rad are equal.
  angle,
  /// The smallest area, whatever the angles.
  area,
  /// The smallest sum over the edges of 4 sin²(φ/2) × length for the angle φ: little bending everywhere.
  smooth,
};

/// The best triangulation of a loop of n > 3 points among those that use only the given chords (each once).
/// What is equal is settled by short chords. Triangles without area are used only where nothing else is
/// possible. n − 2 triangles, empty where the chords allow none.
///
/// Barequet & Sharir 1995 and Liepa 2003 keep one triangulation per chord. Which is best there depends on what
/// lies on the chord's other side, so this keeps one per triangle on the chord, and finds the angle first and
/// then the area: what comes out is the optimum. The result does not depend on the number of threads. Throws
/// Error(cancelled).
std::vector<HoleTriangle> search_triangulation(const HoleLoop& loop, std::span<const HoleChord> chords,
                                               HoleAim aim = HoleAim::angle, const Context& context = {});

/// 4 sin²(φ/2) for the angle φ between the normals of the triangles on the two sides of an edge from `from` to
/// `to`, with these third corners: it orders angles, and is precise for small ones. 0 where one has no area.
double bend_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& inner,
                    const Eigen::Vector3d& outer);

}  // namespace meshgraft
