#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/orientation.h>

namespace meshgraft {

/// A source loop and the target loop it meets (FT05 section 5). Each lists all vertices of a boundary loop,
/// from any vertex on. Their order is the direction of their own mesh's half-edges (surface on the left, seen
/// from outside), so that the two loops run opposite ways.
struct LoopPair {
  std::vector<Index> source, target;
};

/// A source loop vertex and the target loop vertex it meets.
struct Match {
  Index source = -1, target = -1;
};

/// A start that a person may have meant, and how probable it is.
struct StartCandidate {
  Match start;
  double probability = 0;
  /// Turn of the source about its loop's axis from the most probable start, −180 … 180 degrees, right hand
  /// about the direction into the source.
  double turn_deg = 0;
};

/// The origin of the source's position, orientation and scale.
enum class MergePose {
  find,  ///< from the boundary alone (FT05 5.1, pose-independent)
  keep,  ///< the source is in its pose; only the neighbourhood of its loops deforms (FT05 5.2)
};

/// The deformation of the source.
enum class MergeShape {
  ft05,     ///< one linear solve of the whole source; shears it where the loops differ
  similar,  ///< one similarity beyond the influence radius; co-rotational bending within it
};

std::string_view to_string(MergePose value);
std::string_view to_string(MergeShape value);

/// Influence radius: the distance from its loops within which the source may deform. It is a number of rings
/// of edges, or a length along edges (units of the source as given). With neither, it is each loop's own
/// radius. Where the source would be squeezed, it is two, four or eight of these radii.
struct Reach {
  std::optional<int> rings;
  std::optional<double> length;
};

/// A feature: vertices of the source that keep their shape up to one unknown map (FT05 section 7).
struct MergeFeature {
  std::vector<Index> vertices;
  bool similarity = true;  ///< a similarity; else any affine map
};

/// Methods to fill the gap between two loops with triangles.
enum class StripMethod {
  greedy,   ///< from the closest pair on, always the better one of the next two triangles (FT05 section 5)
  optimal,  ///< the strip of least total cost (dynamic programming)
};

/// Methods to fair the band around a seam.
enum class FairingMethod {
  umbrella,   ///< each vertex moves to the mean of its ring, all at once (FT05 section 5)
  curvature,  ///< a linear solve continues the curvature of both surfaces across the strip
};

std::string_view to_string(FairingMethod value);

struct SeamOptions {
  StripMethod strip = StripMethod::optimal;
  /// Largest mean edge length of the target's loop / that of the source's. The target's ring at the seam is
  /// halved until this holds.
  double edge_ratio = 2;
  /// Halves edges of the source within its loops' radii that are too long for it to bend there.
  bool refine_radius = true;
  FairingMethod fairing_method = FairingMethod::curvature;
  int fairings = 2;             ///< fairings of the band; 0 leaves it unchanged
  int target_rings = 3;         ///< rings of the target that they may move; 0 leaves it unchanged bit for bit
  int source_rings = 3;         ///< rings of the source that they may move
  double sharp_angle_deg = 45;  ///< edges of the target sharper than this do not move
  double blend_colours = 0;     ///< length along edges within which both sides' vertex colours mix, model units
};

struct MergePair {
  LoopPair loops;
  std::vector<Match> matches;  ///< none: found automatically; one: the start; more: arc length between them
};

struct MergeOptions {
  MergePose pose = MergePose::find;
  MergeShape shape = MergeShape::similar;
  Reach reach{};               ///< influence radius
  std::vector<Index> fixed{};  ///< fixed source vertices (pose `keep`)
  std::vector<MergeFeature> features{};
  std::optional<double> size{};  ///< scale beyond the influence radius (pose `keep`: at the loops)
  double normal_angle_deg = 0;   ///< turn of the target's normals about the tangents of its loops
  bool smooth_boundary = false;  ///< smooth ragged loops along themselves first
  bool fix_winding = false;      ///< flip the source where the direction of its loops requires it
  /// Tries other values of the settings that are left open, where the graft has inverted maps, folds or
  /// intersections at its seams: the reach, the normal angle (open at 0), the size (of a source in one piece),
  /// and the start (of one pair). Only with the shape `similar` and the pose found. The graft with the fewest
  /// faults is kept. It is refused where several loops of one piece lie so differently from the target's that
  /// the source turns inside out all the same (merge.pairs_invert_source).
  bool retry = true;
  /// Orientations that the models may have, in their own coordinates. A start that is not given brings up to up
  /// and front to front where the loops allow. One: it is known. None: guessed from the mesh
  /// (`guess_orientations`); a whole model's guesses are better than a piece's.
  std::vector<OrientationGuess> target_orientations{}, source_orientations{};
  /// Options of the solve. A source that follows a similarity takes more co-rotational iterations to settle
  /// than a bend does.
  DeformerOptions deformer{.iterations = 60};
  SeamOptions seam{};

  /// Returns the options of FT05 as written: one linear solve of the whole source, the greedy strip, umbrella
  /// smoothing of the band. They never change.
  static MergeOptions as_published();
};

/// The plane that opens a closed source before it is dropped. Its normal, up, points from the base into the
/// source. Without values the library finds the base: a flat side of the source, the lowest one first, else
/// a low plane that cuts clean round loops.
struct DropBase {
  /// Height of the plane above the source's lowest point along up, in units of the source. Absent: the
  /// lowest height that gives clean loops.
  std::optional<double> height{};
  /// Turn of the plane about the centre of its section, right hand, degrees, between -90 and 90.
  double tilt_deg = 0;
  /// Axis of the turn, in the source's coordinates. Absent: x, or y where up is nearest to x.
  std::optional<Eigen::Vector3d> tilt_axis{};

  bool is_automatic() const { return !height && tilt_deg == 0; }
};

/// Location, size and rotation of a source that is put onto a surface without a hole.
struct Drop {
  /// A vertex of the target, or a point that stands for the nearest point of the surface.
  std::variant<Index, Eigen::Vector3d> surface_point;
  /// Approximate scale of the source. Absent: 1 if its loop has room there and the source does not
  /// intersect the target. Otherwise it is the largest of 0.7, 0.5, 0.35, … with which both hold.
  std::optional<double> size{};
  /// Rotation about the target's normal, right hand, degrees. At 0 the source is rotated as little as possible
  /// from its orientation in its own coordinates.
  double spin_deg = 0;
  /// The boundary loop of the source that meets the surface, listed whole and in order. Empty: the source is
  /// opened at its base.
  std::vector<Index> source_loop{};
  DropBase base{};  ///< without `source_loop`: the plane that opens the source
};

}  // namespace meshgraft
