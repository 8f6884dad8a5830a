#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

// The steps of `measure_quality`, apart, for a surface that is measured in parts.

/// A state of a surface, in units in which squares and cubes neither overflow nor underflow.
struct QualityPose {
  const Points& positions;
  Eigen::Vector3d centre;  ///< of the bounding box; volumes are measured from it
  double scale;            ///< a power of two, so that scaling does not round
  double resolution;       ///< scaled length below which rounding of the coordinates dominates

  Eigen::Vector3d between(Index from, Index to) const {
    return (positions.row(to) - positions.row(from)).transpose() * scale;
  }
  Eigen::Vector3d centred(Index vertex) const { return (positions.row(vertex).transpose() - centre) * scale; }
  /// Returns the pose of a part of the surface, in the units of the whole.
  QualityPose of_part(const Points& part) const { return {part, centre, scale, resolution}; }
};

/// The box of the vertices with faces. Vertices without faces must not affect the units.
struct QualityBox {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d max = -min;
  double extent() const { return (max - min).maxCoeff(); }
  void include(const QualityBox& other) {
    min = min.cwiseMin(other.min);
    max = max.cwiseMax(other.max);
  }
};

/// Returns the box of the vertices with faces and finite coordinates.
QualityBox quality_box(const Points& positions, const IndexLists& faces_around, const Context& context);

/// Returns the poses of both states in one common scale, because their sizes are compared.
std::pair<QualityPose, QualityPose> quality_poses(const Points& rest, const QualityBox& rest_box,
                                                  const Points& edited, const QualityBox& edited_box);

/// Sums over all faces with finite coordinates, scaled.
struct WholeSums {
  double rest_area = 0, edited_area = 0;
  double rest_cone = 0, edited_cone = 0;  ///< signed volumes of the cones from the box centres to the faces
  bool finite = true;                     ///< no face is left out

  void add(const WholeSums& other) {
    rest_area += other.rest_area;
    edited_area += other.edited_area;
    rest_cone += other.rest_cone;
    edited_cone += other.edited_cone;
    finite &= other.finite;
  }
};

WholeSums sum_over_faces(const QualityPose& rest, const QualityPose& edited, const Triangles& triangles,
                         const Context& context);

/// Returns whether as many faces run along each edge one way as the other, and there is an edge.
/// Looks at the edges from the first `vertex_count` vertices to larger ones. `faces_around` has all triangles
/// around these.
bool is_closed_and_oriented(const Triangles& triangles, const IndexLists& faces_around, Index vertex_count,
                            const Context& context);

/// A surface in which faces and edges are measured one by one.
struct QualitySurface {
  const Triangles& triangles;
  const IndexLists& faces_around;  ///< per vertex
  const Flags& is_free;            ///< per vertex
  /// Tell which faces, and which edges by their ends, are measured; all if they are empty. All faces with a
  /// common vertex with a measured one must be in the surface.
  std::function<bool(Index)> measures_face{};
  std::function<bool(Index, Index)> measures_edge{};
};

/// The measures of single faces and edges, listed or summed up.
struct QualityTerms {
  double rest_free_area = 0, edited_free_area = 0;
  std::vector<double> sigmas;  ///< two for each free face
  std::vector<double> turns;   ///< changes of angles at free edges, degrees
  double stretch_squares = 0;  ///< of the relative changes of length of free edges
  std::int64_t stretched = 0;  ///< the number of these
  double rim_jump_max_deg = 0;
  std::int64_t flipped_faces = 0;
};

QualityTerms measure_terms(const QualityPose& rest, const QualityPose& edited, const QualitySurface& surface,
                           const Context& context);

/// Returns percentiles, for ascending numbers of percent, of a list that may be in parts. The extremes are
/// those of 0 and 100.
using Percentiles = std::function<std::vector<double>(std::vector<double>&, std::span<const double>)>;

/// The lists of the terms of all parts.
struct QualityLists {
  bool has_sigmas, has_turns;  ///< some part has any
  Percentiles percentiles;
};

/// Returns all measures but widths and intersections. `rest_resolution` is that of the pose at rest. The sums,
/// the jump and the count of flipped faces in `terms` are those of all parts; the lists may be in parts.
Quality quality_of_terms(const WholeSums& whole, bool is_closed, double rest_resolution, QualityTerms& terms,
                         const QualityLists& lists);

}  // namespace meshgraft
