#pragma once

#include <array>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Corners of a triangle in a hole, as loop indices in ascending order, which is the order along the loop.
using HoleTriangle = std::array<Index, 3>;

/// Two vertices of a loop, the smaller index first, that are not neighbours on it.
using HoleChord = std::array<Index, 2>;

/// A closed polyline to be filled with triangles.
struct HoleLoop {
  Points points;  ///< n×3
  /// n×3, or 0×3: the third corner of the face across the edge from point k to the next point.
  Points beyond{0, 3};

  Index size() const { return static_cast<Index>(points.rows()); }
};

/// The quantity that a triangulation minimises.
enum class HoleAim {
  /// The largest angle between the normals of neighbours, including the faces beyond the loop; then the area.
  /// Angles that differ by less than 5e-10 rad are equal.
  angle,
  /// The area, whatever the angles.
  area,
  /// The sum over the edges of 4 sin²(φ/2) × length for the angle φ, which keeps bending small everywhere.
  smooth,
};

/// Returns the best triangulation of a loop of n > 3 points that uses only the given chords (each listed
/// once). Short chords break ties. Triangles without area are used only if nothing else is possible. Returns
/// n − 2 triangles, or none if the chords allow no triangulation.
///
/// Barequet & Sharir 1995 and Liepa 2003 keep one triangulation per chord. The best one depends on the other
/// side of the chord, so this search keeps one per triangle on the chord. It finds the smallest angle first
/// and then the smallest area, so the result is optimal. The result does not depend on the number of threads.
/// Throws Error(cancelled).
std::vector<HoleTriangle> search_triangulation(const HoleLoop& loop, std::span<const HoleChord> chords,
                                               HoleAim aim = HoleAim::angle, const Context& context = {});

/// Returns 4 sin²(φ/2) for the angle φ between the normals of the two triangles at the edge from `from` to
/// `to`. `inner` and `outer` are their third corners. The value orders angles, and is precise for small ones.
/// Returns 0 if a triangle has no area.
double bend_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& inner,
                    const Eigen::Vector3d& outer);

}  // namespace meshgraft
