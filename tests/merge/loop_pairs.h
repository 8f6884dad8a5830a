#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "merge/pair_geometry.h"

#include "merge/closed_curves.h"

/// Pairs of loops whose correspondence is known.
namespace meshgraft::test {

/// Returns a closed curve with one bump and unevenly spaced vertices, a circle if `bump` is 0. Its normals
/// point outward and somewhat up. `phase` moves the first vertex, in turns.
inline LoopGeometry bumpy_loop(int count, double phase, bool backwards, double bump = 0.4) {
  LoopGeometry loop{Points(count, 3), Points(count, 3)};
  for (int i = 0; i < count; ++i) {
    const double s = static_cast<double>(backwards ? count - i : i) / count + phase;
    const double turn = 2 * std::numbers::pi * s + 0.1 * std::sin(2 * std::numbers::pi * s);
    const double radius = 1 + bump * std::exp(-8 * (1 - std::cos(turn - 1)));
    loop.points.row(i) << radius * std::cos(turn), radius * std::sin(turn), 0.2 * bump * std::sin(2 * turn);
    loop.normals.row(i) = Eigen::RowVector3d(std::cos(turn), std::sin(turn), 0.5).normalized();
  }
  return loop;
}

/// Returns a curve as a loop, with normals that point outward and up and down by turns.
inline LoopGeometry loop_of_curve(const Points& curve) {
  LoopGeometry loop{curve, Points(curve.rows(), 3)};
  for (Eigen::Index k = 0; k < curve.rows(); ++k)
    loop.normals.row(k) =
        Eigen::RowVector3d(curve(k, 0), curve(k, 1), 0.2 * std::sin(static_cast<double>(k))).normalized();
  return loop;
}

inline LoopGeometry mapped_loop(const LoopGeometry& loop, const Eigen::Affine3d& map) {
  return {mapped(loop.points, map), (loop.normals * map.linear().transpose()).rowwise().normalized()};
}

/// Returns the loop that begins with vertex `shift`, cyclically.
inline LoopGeometry shifted_loop(const LoopGeometry& loop, Eigen::Index shift) {
  return {rotated_rows(loop.points, shift), rotated_rows(loop.normals, shift)};
}

inline LoopGeometry reversed_loop(const LoopGeometry& loop) {
  return {loop.points.colwise().reverse(), loop.normals.colwise().reverse()};
}

/// Returns loops of these sizes. Source vertices are numbered from 100 on, target vertices from 500 on.
inline LoopPair numbered(int source, int target) {
  LoopPair pair;
  for (int i = 0; i < source; ++i) pair.source.push_back(100 + i);
  for (int i = 0; i < target; ++i) pair.target.push_back(500 + i);
  return pair;
}

inline PairGeometry numbered_pair(LoopGeometry source, LoopGeometry target, Location location = {}) {
  LoopPair loops = numbered(static_cast<int>(source.points.rows()), static_cast<int>(target.points.rows()));
  return {std::move(loops), std::move(source), std::move(target), std::move(location)};
}

/// Returns the distance between two parameters of a loop of `count` vertices, the shorter way round.
inline double parameter_distance(double a, double b, Eigen::Index count) {
  return std::abs(std::remainder(a - b, static_cast<double>(count)));
}

}  // namespace meshgraft::test
