#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/merge/correspondence.h>
#include <meshgraft/merge/seam.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

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
  std::optional<double> size{};  ///< scale of the source beyond the influence radius; absent: found
  double normal_angle_deg = 0;   ///< turn of the target's normals about the tangents of its loops
  bool smooth_boundary = false;  ///< smooth ragged loops along themselves first
  bool fix_winding = false;      ///< flip the source where the direction of its loops requires it
  /// Options of the solve. A source that follows a similarity takes more co-rotational steps to settle than a
  /// bend does.
  DeformerOptions deformer{.iterations = 60};
  SeamOptions seam{};
};

}  // namespace meshgraft
