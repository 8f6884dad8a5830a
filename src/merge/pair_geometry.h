#pragma once

#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The location on the target loop of each vertex of a source loop.
struct Correspondence {
  /// Per vertex of `LoopPair::source`, in its order: a parameter k + t on the target loop, cyclic. It stands
  /// for the point (1 − t)·target[k] + t·target[k + 1]. The parameters go once round the target loop,
  /// backwards.
  std::vector<double> loop_parameter;
  /// 0 … 1. A start that was ranked: its probability. One found by a pose: the margin by which it is better
  /// than the best one elsewhere. One that was given: 1.
  double confidence = 1;
  Match start;                         ///< the vertices it was found from; unset where matches were given
  std::vector<StartCandidate> starts;  ///< of a start that was ranked, the most probable first
};

/// A loop and the surface normals along it; row i belongs to the loop's vertex i.
struct LoopGeometry {
  Points points;   ///< k×3, model units
  Points normals;  ///< k×3, unit normals of the surface
};

/// The loops of a pair, to be matched.
struct PairGeometry {
  LoopPair loops;
  LoopGeometry source, target;
  Location location;  ///< name of the pair in messages
};

}  // namespace meshgraft
