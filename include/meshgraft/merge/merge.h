#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/merge/correspondence.h>
#include <meshgraft/merge/seam.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Where position, orientation and scale of the source come from.
enum class MergePose {
  find,  ///< from the boundary alone (FT05 5.1, pose-independent)
  keep,  ///< the source is where it should be; only the neighbourhood of its loops gives way (FT05 5.2)
};

/// What becomes of the source.
enum class MergeShape {
  ft05,     ///< one linear solve of the whole source; shears it where the loops differ
  similar,  ///< beyond a reach from its loops it follows one similarity; near them it bends co-rotationally
};

std::string_view to_string(MergePose value);
std::string_view to_string(MergeShape value);

/// How far from its loops the source may deform: by rings of edges or by a length along edges (units of the
/// source as given); neither: each loop's own radius, or two, four or eight of them where the part would be
/// squeezed.
struct Reach {
  std::optional<int> rings;
  std::optional<double> length;
};

/// A part of the source that keeps its shape up to one unknown map (FT05 section 7).
struct MergeFeature {
  std::vector<Index> vertices;
  bool similarity = true;  ///< else any affine map
};

struct MergePair {
  LoopPair loops;
  std::vector<Match> matches;  ///< none: found; one: the start; more: arc length between them
};

struct MergeOptions {
  MergePose pose = MergePose::find;
  MergeShape shape = MergeShape::similar;
  Reach reach{};
  std::vector<Index> fixed{};  ///< source vertices that stay in place (pose `keep`)
  std::vector<MergeFeature> features{};
  std::optional<double> size{};  ///< scale of the part beyond reach, where it is not to be found
  double normal_angle_deg = 0;   ///< turns the target's normals about its loops' tangents
  bool smooth_boundary = false;  ///< smooths ragged loops along themselves first
  bool fix_winding = false;      ///< flips the source where its loops' direction needs it
  /// The solve. A part that follows a similarity takes more co-rotational steps to settle than a bend does.
  DeformerOptions deformer{.iterations = 60};
  SeamOptions seam{};
};

/// What was done with one pair of loops.
struct PairReport {
  Index source_vertices = 0, target_vertices = 0;
  Match start;                ///< the source's first loop vertex and the target vertex nearest to its place
  double confidence = 1;      ///< of an automatic correspondence
  double raggedness_deg = 0;  ///< of the worse loop: mean turn per vertex beyond a smooth curve's
  /// RMS distance of the source's loop from its places on the target's, posed as well as the boundary allows
  /// (or kept), × the radius of the target's loop: 0 for loops of one shape.
  double misfit_rel = 0;
  double edge_ratio = 1;   ///< mean edge length of the target's loop over that of the source's, as matched
  std::vector<Index> met;  ///< vertices of the source's loop, in its order, without those that refinement added
  Points target_points;    ///< where on the target's loop each of them comes to lie (k×3)
};

/// Singular values and the like of the map source → result, over the source's faces, without its similarity.
struct ShapeReport {
  Similarity similarity;            ///< of the part beyond reach, or the best one of all of it
  double distance_rel = 0;          ///< RMS distance of the part beyond reach from it, × the part's size
  double smallest_singular_p5 = 1;  ///< within reach, relative to the similarity's scale
  Index inverted = 0;               ///< vertices whose local map turns inside out
};

struct MergeReport {
  std::vector<PairReport> pairs;
  ShapeReport shape;
  SeamReport seam;
  EvaluationReport evaluation;
  Index source_vertices_added = 0, target_vertices_added = 0;  ///< by refinement
  std::vector<std::string> notes;                              ///< sentences for people
  double match_seconds = 0, assemble_seconds = 0, factorise_seconds = 0, solve_seconds = 0, seam_seconds = 0,
         measure_seconds = 0, total_seconds = 0;
};

struct MergeResult {
  Mesh mesh;
  IndexMap target, source;       ///< vertices of the inputs → `mesh`, -1 where one was removed
  Points grafted;                ///< the source's vertices after the solve, before the seam (n×3)
  std::vector<Index> new_faces;  ///< of the seams
  std::vector<Index> band;       ///< vertices of `mesh` around the seams that fairing could move
  MergeReport report;
};

/// Grafts `source` onto `target` across pairs of boundary loops (Fu & Tai 2005, section 5). The target keeps
/// its place; outside the seams' bands it keeps its bits. Throws Error(input) where a loop is not a simple
/// boundary loop, loops meet, a component of the source has no loop, correspondences cross or are ambiguous, or
/// the windings disagree, each naming the pair and the remedy; Error(unsolvable); Error(cancelled).
MergeResult merge_meshes(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs,
                         const MergeOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
