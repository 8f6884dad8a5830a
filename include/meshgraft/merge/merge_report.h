#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A similarity x ↦ scale · rotation · x + translation.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// Faults of strips and bands that the inputs did not have. Pairs of faces with a common vertex or edge count
/// where they have other points in common.
struct SeamFaults {
  Index folded_edges = 0;   ///< edges bent by more than 160°
  Index crossings = 0;      ///< pairs of faces of strips and bands that intersect
  Index far_crossings = 0;  ///< pairs that intersect, of a face of a strip or band and a face elsewhere

  Index total() const { return folded_edges + crossings + far_crossings; }
};

/// Measures of a finished seam.
struct SeamReport {
  bool manifold = false, oriented = false;
  bool closed = false;  ///< the result has no boundary
  Index euler_characteristic = 0, expected_euler_characteristic = 0;
  Index new_faces = 0;          ///< faces of the strip
  double angle_p1_deg = 0;      ///< 1st percentile of the smallest angles of the strip's triangles
  double dihedral_p99_deg = 0;  ///< 99th percentile over edges of the strip; 0° is flat
  /// The same for the neighbourhoods on both sides.
  double target_dihedral_p99_deg = 0, source_dihedral_p99_deg = 0;
  /// Largest displacement of a target vertex, × the diagonal of the result.
  double band_displacement_rel = 0;
  double source_edge_ratio = 1;  ///< mean edge length of the source's loops / that of the target's
  SeamFaults faults;             ///< that the inputs did not have
};

/// Grafts with other values of settings that the options leave open (`MergeOptions::retry`).
struct RetryReport {
  int tries = 0;  ///< further grafts; 0: the first one had no faults, or none may follow
  Index faults_before = 0,
        faults = 0;  ///< inverted maps, folded edges and crossings of the first and the result
  // The values of the result. All are as below where the first graft is the best.
  int reach_doublings = 0;      ///< of the influence radius, at least
  double normal_angle_deg = 0;  ///< 0: as in the options
  double size = 0;              ///< 0: as in the options
  int start = 0;                ///< of `PairReport::starts`
  double start_shift = 0;       ///< of the start along the target's loop, × the loop's length
};

/// Report on one pair of loops.
struct PairReport {
  Index source_vertices = 0, target_vertices = 0;
  /// First vertex of the source's loop, and the target vertex nearest to its location on the target's loop.
  Match start;
  /// 0 … 1. A start that was ranked: its probability. One found by the pose: the margin by which it is better
  /// than the best one elsewhere. One that was given: 1.
  double confidence = 1;
  /// Starts that a person may have meant, at most five, the most probable first; the first one was taken,
  /// unless `RetryReport::start` is another. Empty where the start was given or found by the pose.
  std::vector<StartCandidate> starts;
  /// Mean turn per vertex beyond a smooth curve's, of the worse loop, degrees.
  double raggedness_deg = 0;
  /// RMS distance of the source's loop vertices from their locations on the target's loop, × the radius of
  /// these locations. It is measured with the source posed as well as the boundary allows (or kept). 0 for
  /// loops of one shape.
  double misfit_rel = 0;
  /// Size of the target's loop, × the source's: the ratio of the RMS distances of the locations on it and of
  /// the source's loop vertices from their means.
  double size_ratio = 1;
  double edge_ratio = 1;  ///< mean edge length of the target's loop / that of the source's, as matched
  /// Vertices of the source's loop, in its order, without those that refinement added; k of them.
  std::vector<Index> met;
  /// Locations of these vertices on the target's loop, k×3, model units.
  Points target_points;
};

/// Measures of the map source → result over the source's faces, relative to its similarity.
struct ShapeReport {
  /// Best similarity of the vertices beyond the influence radius, or of all, of the largest component.
  Similarity similarity;
  std::vector<double> scales;  ///< of each connected component of the source, by their first vertices
  double distance_rel = 0;     ///< RMS distance of these vertices from it, × their size
  /// 5th percentile of smallest singular values within the radius, relative to the similarity's scale.
  double smallest_singular_p5 = 1;
  Index inverted = 0;  ///< vertices whose local map is inverted
};

/// The plane that opened a closed source before it was dropped, in the source's coordinates.
struct BaseReport {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< centre of the section
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit length, from the base into the source
  double height = 0;   ///< of `point` above the lowest point along up, before the tilt; units of the source
  bool flat = false;   ///< the source has a flat side below the plane
  Index loops = 0;     ///< loops that meet the surface
  Index cut_away = 0;  ///< vertices of the source that were removed with its base
};

struct MergeReport {
  std::vector<PairReport> pairs;
  ShapeReport shape;
  SeamReport seam;
  EvaluationReport evaluation;
  RetryReport retry;
  Index source_vertices_added = 0, target_vertices_added = 0;  ///< added by refinement
  std::vector<Note> notes;
  // Those of the first graft, and `retry_seconds` of all further ones.
  double match_seconds = 0, assemble_seconds = 0, factorise_seconds = 0, solve_seconds = 0, seam_seconds = 0,
         retry_seconds = 0;
  double total_seconds = 0;
};

}  // namespace meshgraft
