#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A source loop and the target loop it meets (FT05 section 5). Each lists all vertices of a boundary loop in
/// the direction of its own mesh's half-edges (surface at the left hand, seen from outside), from any vertex
/// on; so the two run opposite ways.
struct LoopPair {
  std::vector<Index> source, target;
};

/// A source loop vertex and the target loop vertex it meets.
struct Match {
  Index source = -1, target = -1;
};

/// Where each vertex of a source loop comes to lie on the target loop.
struct Correspondence {
  /// Per vertex of `LoopPair::source`, in its order: the parameter k + t on the target loop is (1 −
  /// t)·target[k] + t·target[k + 1], cyclically. Goes once round the target loop, backwards.
  std::vector<double> loop_parameter;
  /// 0 … 1: how much better the best start is than the best one elsewhere; 1 where it was given.
  double confidence = 1;
};

/// A loop with what is known of the surface along it; row i belongs to the loop's vertex i.
struct LoopGeometry {
  Points points;   ///< k×3
  Points normals;  ///< k×3, unit, of the surface
};

/// FT05 5.1 (1) and (2): from one matched pair of vertices (the start) or more, by arc length between them.
/// Throws Error(input), naming `location`, for vertices that are not on the loops and for matches that cross.
Correspondence match_by_arc_length(const LoopPair& pair, std::span<const Match> matches,
                                   const LoopGeometry& source, const LoopGeometry& target,
                                   const std::string& location);

/// A similarity x ↦ scale · rotation · x + translation.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// A pair whose loops fit as well from several starts.
struct OpenStart {
  std::size_t pair = 0;   ///< its number
  Match least_turned;     ///< vertices of the meshes: from this start the source turns least from how it stands
  double confidence = 0;  ///< 0 … 1, of the start that fits best
};

/// Error(input) for want of a start: it is open which vertices begin to meet.
class OpenStartError : public Error {
 public:
  OpenStartError(const Error& error, std::vector<OpenStart> starts)
      : Error(error), starts_(std::make_shared<const std::vector<OpenStart>>(std::move(starts))) {}

  /// Those that were found to be open, at least one, in the order of pairs.
  const std::vector<OpenStart>& starts() const noexcept { return *starts_; }

 private:
  std::shared_ptr<const std::vector<OpenStart>> starts_;  // copying must not throw
};

/// The best cyclic alignment of each pair: the arc-length start whose loops, normals included, a similarity
/// maps onto one another best. The pairs are those of one connected source and share the similarity, so that
/// loops without any feature of their own (circles) are placed by the others. With `posed`, the source is where
/// it should be and nearness decides. `locations` name the pairs in messages.
/// Throws OpenStartError, naming the first pair and what to add, where the best start is not distinguished from
/// others.
std::vector<Correspondence> match_automatically(std::span<const LoopPair> pairs,
                                                std::span<const LoopGeometry> sources,
                                                std::span<const LoopGeometry> targets, bool posed,
                                                std::span<const std::string> locations);

}  // namespace meshgraft
