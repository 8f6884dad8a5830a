#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/core/fact.h>
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
  similar,  ///< one similarity beyond the reach from its loops; co-rotational bending near them
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
  Reach reach{};
  std::vector<Index> fixed{};  ///< fixed source vertices (pose `keep`)
  std::vector<MergeFeature> features{};
  std::optional<double> size{};  ///< scale of the source beyond reach; absent: found
  double normal_angle_deg = 0;   ///< turn of the target's normals about the tangents of its loops
  bool smooth_boundary = false;  ///< smooth ragged loops along themselves first
  bool fix_winding = false;      ///< flip the source where the direction of its loops requires it
  /// Options of the solve. A source that follows a similarity takes more co-rotational steps to settle than a
  /// bend does.
  DeformerOptions deformer{.iterations = 60};
  SeamOptions seam{};
};

/// Report on one pair of loops.
struct PairReport {
  Index source_vertices = 0, target_vertices = 0;
  /// First vertex of the source's loop, and the target vertex nearest to its location on the target's loop.
  Match start;
  double confidence = 1;  ///< confidence of an automatic correspondence, 0 … 1
  /// Mean turn per vertex beyond a smooth curve's, of the worse loop, degrees.
  double raggedness_deg = 0;
  /// RMS distance of the source's loop vertices from their locations on the target's loop, × the radius of
  /// these locations. It is measured with the source posed as well as the boundary allows (or kept). 0 for
  /// loops of one shape.
  double misfit_rel = 0;
  double edge_ratio = 1;  ///< mean edge length of the target's loop / that of the source's, as matched
  /// Vertices of the source's loop, in its order, without those that refinement added; k of them.
  std::vector<Index> met;
  /// Locations of these vertices on the target's loop, k×3, model units.
  Points target_points;
};

/// Measures of the map source → result over the source's faces, relative to its similarity.
struct ShapeReport {
  Similarity similarity;    ///< the best similarity of the vertices beyond reach, or of all vertices
  double distance_rel = 0;  ///< RMS distance of the vertices beyond reach from it, × their size
  /// 5th percentile of smallest singular values within reach, relative to the similarity's scale.
  double smallest_singular_p5 = 1;
  Index inverted = 0;  ///< vertices whose local map is inverted
};

struct MergeReport {
  std::vector<PairReport> pairs;
  ShapeReport shape;
  SeamReport seam;
  EvaluationReport evaluation;
  Index source_vertices_added = 0, target_vertices_added = 0;  ///< added by refinement
  std::vector<Note> notes;
  double match_seconds = 0, assemble_seconds = 0, factorise_seconds = 0, solve_seconds = 0, seam_seconds = 0,
         measure_seconds = 0, total_seconds = 0;
};

struct MergeResult {
  Mesh mesh;
  IndexMap target, source;       ///< vertices of the inputs → `mesh`, or -1 where one was removed
  Points grafted;                ///< the source's positions after the solve, before the seam (n×3)
  std::vector<Index> new_faces;  ///< faces of the seams
  std::vector<Index> band;       ///< vertices of `mesh` around the seams that fairing could move
  MergeReport report;
};

/// Grafts `source` onto `target` across pairs of boundary loops (Fu & Tai 2005, section 5). The target is not
/// moved; outside the bands around the seams it keeps its coordinates bit for bit.
///
/// Throws Error(input), naming the pair and the remedy, in these cases:
/// - a loop is not a simple boundary loop;
/// - loops meet;
/// - a connected component of the source has no loop (merge.component_without_pair);
/// - correspondences cross (merge.matches_cross) or are ambiguous (merge.open_start, see `open_starts`);
/// - the orientations disagree (merge.orientations_disagree).
/// Throws Error(unsolvable) and Error(cancelled).
MergeResult merge_meshes(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs,
                         const MergeOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
