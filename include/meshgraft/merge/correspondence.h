#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/core/fact.h>
#include <meshgraft/mesh/mesh.h>

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

/// The location on the target loop of each vertex of a source loop.
struct Correspondence {
  /// Per vertex of `LoopPair::source`, in its order: a parameter k + t on the target loop, cyclic. It stands
  /// for the point
  /// (1 − t)·target[k] + t·target[k + 1].
  /// The parameters go once round the target loop, backwards.
  std::vector<double> loop_parameter;
  /// 0 … 1: the margin by which the best start is better than the best one elsewhere; 1 where the start was
  /// given.
  double confidence = 1;
};

/// A loop and the surface normals along it; row i belongs to the loop's vertex i.
struct LoopGeometry {
  Points points;   ///< k×3, model units
  Points normals;  ///< k×3, unit normals of the surface
};

/// Matches two loops from one pair of vertices (the start) or more, by arc length between them: FT05 5.1 (1)
/// and (2). Throws Error(input), naming `location`, for vertices that are not on the loops and for matches
/// that cross.
Correspondence match_by_arc_length(const LoopPair& pair, std::span<const Match> matches,
                                   const LoopGeometry& source, const LoopGeometry& target,
                                   const std::string& location);

/// A similarity x ↦ scale · rotation · x + translation.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// A pair whose loops fit about as well from several starts.
struct OpenStart {
  std::size_t pair = 0;  ///< index of the pair
  /// The start that turns the source least from its given pose, as vertices of the meshes.
  Match least_turned;
  double confidence = 0;  ///< 0 … 1, confidence of the start that fits best
};

/// Returns the ambiguous pairs that a fact merge.open_start lists, at least one, in the order of pairs. Throws
/// std::out_of_range for other facts.
std::vector<OpenStart> open_starts(const Fact& fact);

/// Finds the best cyclic alignment of each pair. It is the arc-length start from which a similarity maps the
/// loops, normals included, best onto one another. The pairs belong to one connected source and share the
/// similarity; loops without features of their own (circles) are thus placed by the others. With `posed` the
/// source is already in its pose, and nearness decides. `locations` name the pairs in messages. Throws
/// Error(input) with the id merge.open_start where the best start is not distinguished from others: the loops
/// alone do not determine which vertices meet. Its location is the first such pair's; `open_starts` returns
/// all of them.
std::vector<Correspondence> match_automatically(std::span<const LoopPair> pairs,
                                                std::span<const LoopGeometry> sources,
                                                std::span<const LoopGeometry> targets, bool posed,
                                                std::span<const std::string> locations);

}  // namespace meshgraft
