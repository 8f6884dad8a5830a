#include "match_automatically.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <Eigen/LU>

#include <meshgraft/merge/merge_report.h>

#include "deform/solve/rotations.h"
#include "loop_curve.h"
#include "match_by_arc_length.h"
#include "start_candidates.h"

namespace meshgraft {

namespace {

constexpr int sample_count = 256;

/// Points and normals at equal arc lengths, centred, of RMS radius 1.
struct Samples {
  Points points, normals;
  Eigen::RowVector3d centre;
  double radius = 1;
};

Samples sample(const LoopGeometry& loop, bool backwards) {
  const LoopCurve curve(loop.points);
  Samples samples{Points(sample_count, 3), Points(sample_count, 3), {}, 1};
  for (int i = 0; i < sample_count; ++i) {
    const double arc = curve.length() * i / sample_count;
    const double parameter = curve.parameter_at(backwards ? curve.length() - arc : arc);
    samples.points.row(i) = at(loop.points, parameter);
    samples.normals.row(i) = at(loop.normals, parameter).stableNormalized();
  }
  samples.centre = samples.points.colwise().mean();
  samples.points.rowwise() -= samples.centre;
  samples.radius = std::sqrt(samples.points.rowwise().squaredNorm().mean());
  samples.points /= samples.radius;
  return samples;
}

/// The cost of each start: 0 where a similarity maps the loops, with their normals, onto one another, at most
/// 2. At index k of the profile, source sample i meets target sample i + k.
using Profile = std::vector<double>;

constexpr double normal_weight = 0.5;

Eigen::Matrix3d covariance(const Points& source, const Points& target, int shift) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < sample_count; ++i)
    sum += target.row((i + shift) % sample_count).transpose() * source.row(i);
  return sum / sample_count;
}

/// Returns the largest trace of Rᵀ H over rotations R.
double best_trace(const Eigen::Matrix3d& H) { return (nearest_rotation(H).transpose() * H).trace(); }

/// Returns the fit of each start: the rotation that brings the loops nearest to one another, and its cost.
std::vector<LoopFit> similarity_fits(const Samples& source, const Samples& target) {
  std::vector<LoopFit> fits(sample_count);
  for (int k = 0; k < sample_count; ++k) {
    const Eigen::Matrix3d of_points = covariance(source.points, target.points, k);
    const Eigen::Matrix3d of_both = of_points + normal_weight * covariance(source.normals, target.normals, k);
    const Eigen::Matrix3d rotation = nearest_rotation(of_both);
    fits[k] = {1 - (rotation.transpose() * of_both).trace() / (1 + normal_weight),
               1 - (rotation.transpose() * of_points).trace(), rotation};
  }
  return fits;
}

Profile profile_of(const std::vector<LoopFit>& fits) {
  Profile profile;
  for (const LoopFit& fit : fits) profile.push_back(fit.cost);
  return profile;
}

/// Returns the profile for a given similarity: x ↦ scale · rotation · x + translation.
Profile posed_profile(const Samples& source, const Samples& target, const Similarity& pose) {
  const Points points = (pose.scale * source.radius * source.points * pose.rotation.transpose()).rowwise() +
                        (pose.scale * pose.rotation * source.centre.transpose() + pose.translation).transpose();
  const Points normals = source.normals * pose.rotation.transpose();
  Profile profile(sample_count, 0.0);
  for (int k = 0; k < sample_count; ++k) {
    for (int i = 0; i < sample_count; ++i) {
      const int j = (i + k) % sample_count;
      const Eigen::RowVector3d there = target.centre + target.radius * target.points.row(j);
      profile[k] += (points.row(i) - there).squaredNorm() / (2 * target.radius * target.radius) +
                    normal_weight * (1 - normals.row(i).dot(target.normals.row(j)));
    }
    profile[k] /= sample_count * (1 + normal_weight);
  }
  return profile;
}

struct Start {
  int shift = 0;
  double confidence = 0;  ///< 1: every other start is bad; 0: another one costs as much
};

/// Returns the best shift and its confidence. The confidence is the distance to the next best local minimum,
/// at least a twelfth of a turn away, relative to the profile's range. It is near 0 for a circle, whose
/// profile has no range, and for an ellipse, which fits equally well after half a turn.
Start best_start(const Profile& profile) {
  constexpr int apart = sample_count / 12;
  constexpr double noise = 1e-3;  // differences that tessellations of one curve may cause
  const auto value = [&](int k) { return profile[(k + sample_count) % sample_count]; };
  const auto best = std::min_element(profile.begin(), profile.end());
  const double most = *std::max_element(profile.begin(), profile.end());
  Start start;
  start.shift = static_cast<int>(best - profile.begin());
  double rival = most;
  for (int k = 0; k < sample_count; ++k) {
    const int distance = std::abs(k - start.shift);
    const bool least = value(k) <= value(k - 1) && value(k) <= value(k + 1);
    if (least && std::min(distance, sample_count - distance) >= apart) rival = std::min(rival, value(k));
  }
  start.confidence = (rival - *best) / (most - *best + noise);
  return start;
}

/// Confidence from which the shape of a loop takes part in the similarity that several pairs share.
constexpr double distinguished = 0.03;

/// Computes the similarity that several pairs share. It uses the centres and axes of all pairs, and the
/// shapes of those whose start is distinguished. Returns false where they do not determine it.
bool common_similarity(std::span<const Samples> sources, std::span<const Samples> targets,
                       std::span<const Start> starts, Similarity& common) {
  const auto rows = static_cast<Eigen::Index>(sources.size() * (sample_count + 2));
  Points from(rows, 3), to(rows, 3);
  Eigen::VectorXd weights(rows);
  Eigen::Index row = 0;
  for (std::size_t p = 0; p < sources.size(); ++p) {
    const auto add = [&](const Eigen::RowVector3d& source, const Eigen::RowVector3d& target, double weight) {
      from.row(row) = sources[p].centre + sources[p].radius * source;
      to.row(row) = targets[p].centre + targets[p].radius * target;
      weights[row++] = weight;
    };
    const double shape_weight = starts[p].confidence >= distinguished ? 1 : 0;
    for (int i = 0; i < sample_count; ++i)
      add(sources[p].points.row(i), targets[p].points.row((i + starts[p].shift) % sample_count), shape_weight);
    add(Eigen::RowVector3d::Zero(), Eigen::RowVector3d::Zero(), sample_count);
    add(loop_axis(sources[p].points), loop_axis(targets[p].points), sample_count);
  }
  return fit_similarity(from, to, weights, common);
}

/// The cost of a start: of the points alone, and with the normals.
struct StartCost {
  double points = 0, both = 0;
};
using CostOf = double StartCost::*;

/// Returns the cost of a start at a pair of vertices, evaluated at the source loop vertices and their target
/// points. It is the exact value that the profile samples. With a pose, that of the points alone is not
/// computed.
StartCost cost_of(const std::vector<double>& parameters, const LoopGeometry& source, const LoopGeometry& target,
                  const Similarity* pose) {
  const Eigen::Index count = source.points.rows();
  const LoopCurve curve(source.points);
  Points there(count, 3);
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  Eigen::VectorXd weights(count);
  double normal_cost = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto previous = static_cast<Index>((i + count - 1) % count),
               next = static_cast<Index>((i + 1) % count);
    weights[i] = curve.length_between(previous, next) / (2 * curve.length());
    there.row(i) = at(target.points, parameters[i]);
    const Eigen::RowVector3d normal = at(target.normals, parameters[i]).stableNormalized();
    normals += weights[i] * normal.transpose() * source.normals.row(i);
    if (pose) normal_cost += weights[i] * (1 - normal.dot(source.normals.row(i) * pose->rotation.transpose()));
  }
  const Eigen::RowVector3d source_centre = weights.transpose() * source.points,
                           target_centre = weights.transpose() * there;
  const double radius = std::sqrt(weights.dot((there.rowwise() - target_centre).rowwise().squaredNorm()));
  if (pose) {
    const Points posed =
        (pose->scale * source.points * pose->rotation.transpose()).rowwise() + pose->translation.transpose();
    const double points = weights.dot((posed - there).rowwise().squaredNorm()) / (2 * radius * radius);
    return {.both = (points + normal_weight * normal_cost) / (1 + normal_weight)};
  }
  const Points a = source.points.rowwise() - source_centre, b = there.rowwise() - target_centre;
  const double source_radius = std::sqrt(weights.dot(a.rowwise().squaredNorm()));
  const Eigen::Matrix3d H = b.transpose() * weights.asDiagonal() * a / (radius * source_radius);
  return {1 - best_trace(H), 1 - best_trace(H + normal_weight * normals) / (1 + normal_weight)};
}

/// A correspondence that begins at a pair of vertices.
struct VertexStart {
  Correspondence correspondence;
  StartCost cost;
};

/// Returns the start at a pair of vertices that fits best, by one of the costs, among those within one sample
/// of a shift. Where no vertices are that near, the nearest ones are taken.
VertexStart start_at_vertices(int shift, const PairGeometry& pair, const Similarity* pose,
                              CostOf compared = &StartCost::both) {
  constexpr Index candidates = 64;
  constexpr double near = 1.0 / sample_count;  // of a turn
  const LoopCurve source_curve(pair.source.points), target_curve(pair.target.points);
  const Index count = source_curve.size(), target_count = target_curve.size();
  VertexStart best;
  double least_distance = std::numeric_limits<double>::infinity();
  for (Index c = 0; c < std::min(count, candidates); ++c) {
    const auto i = static_cast<Index>(static_cast<std::int64_t>(c) * count / std::min(count, candidates));
    const double turn = source_curve.arc(i) / source_curve.length() + static_cast<double>(shift) / sample_count;
    const auto nearest =
        static_cast<Index>(std::lround(target_curve.parameter_at(-turn * target_curve.length())));
    for (Index k = nearest - 1; k <= nearest + 1; ++k) {
      const Knot start{i, ((k % target_count) + target_count) % target_count};
      const double distance = std::max(
          near, std::abs(std::remainder(turn + target_curve.arc(start.target) / target_curve.length(), 1)));
      if (distance > least_distance) continue;
      std::vector<double> parameters = parameters_between({&start, 1}, source_curve, target_curve);
      const StartCost cost = cost_of(parameters, pair.source, pair.target, pose);
      if (distance == least_distance && cost.*compared >= best.cost.*compared) continue;
      least_distance = distance;
      best.cost = cost;
      best.correspondence.loop_parameter = std::move(parameters);
      best.correspondence.start = {pair.loops.source[start.source], pair.loops.target[start.target]};
    }
  }
  return best;
}

/// Returns the largest distance of a source vertex, as given, from its location on the target, × the radius.
double distance_as_given(const Correspondence& correspondence, const PairGeometry& pair) {
  const Points& points = pair.source.points;
  double farthest = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    farthest = std::max(
        farthest, (at(pair.target.points, correspondence.loop_parameter[i]) - points.row(i)).squaredNorm());
  const double radius = (points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().mean();
  return std::sqrt(farthest / radius);
}

/// Marks the starts from which the loops' vertices coincide, as those of the two sides of one cut do. Where
/// they coincide as given, that start alone is marked.
void mark_coincidences(std::vector<LoopFit>& fits, const PairGeometry& pair) {
  constexpr double rounding = 1e-10, rounding_as_given = 1e-9;
  for (int k = 0; k < sample_count; ++k) {
    const double cost = fits[k].point_cost;
    if (cost <= fits[(k + 1) % sample_count].point_cost &&
        cost <= fits[(k + sample_count - 1) % sample_count].point_cost) {
      const VertexStart start = start_at_vertices(k, pair, nullptr, &StartCost::points);
      fits[k].coincides = start.cost.points < rounding;
      if (!fits[k].coincides || distance_as_given(start.correspondence, pair) > rounding_as_given) continue;
      for (int other = 0; other < sample_count; ++other) fits[other].coincides = other == k;
      return;
    }
  }
}

/// Returns the correspondence of the most probable start, which lists the others.
Correspondence most_probable(const PairGeometry& pair, std::vector<LoopFit> fits,
                             const LoopOrientations& source, const LoopOrientations& target) {
  mark_coincidences(fits, pair);
  Correspondence found;
  std::vector<StartCandidate> starts;
  int first = 0;
  for (const RankedShift& ranked : rank_starts(fits, source, target)) {
    Correspondence candidate = start_at_vertices(ranked.shift, pair, nullptr).correspondence;
    if (starts.empty()) first = ranked.shift;
    const double turn = std::remainder(static_cast<double>(ranked.shift - first) / sample_count, 1) * 360;
    starts.push_back({candidate.start, ranked.probability, turn});
    if (starts.size() == 1) found = std::move(candidate);
  }
  found.confidence = starts.front().probability;
  found.starts = std::move(starts);
  return found;
}

}  // namespace

std::vector<Correspondence> match_automatically(std::span<const PairGeometry> pairs, bool posed,
                                                const ModelOrientations& orientations) {
  std::vector<Samples> sources, targets;
  std::vector<std::vector<LoopFit>> fits;
  std::vector<Start> starts;
  for (const PairGeometry& pair : pairs) {
    sources.push_back(sample(pair.source, false));
    targets.push_back(sample(pair.target, true));
    fits.push_back(similarity_fits(sources.back(), targets.back()));
    starts.push_back(best_start(profile_of(fits.back())));
  }
  Similarity pose;
  const bool known = posed || (pairs.size() > 1 && common_similarity(sources, targets, starts, pose));
  std::vector<Correspondence> found;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    if (!known) {
      found.push_back(most_probable(pairs[p], fits[p],
                                    {orientations.source, loop_axis(sources[p].points).transpose()},
                                    {orientations.target, loop_axis(targets[p].points).transpose()}));
      continue;
    }
    const bool by_pose = posed || starts[p].confidence < distinguished;
    if (by_pose) starts[p] = best_start(posed_profile(sources[p], targets[p], pose));
    found.push_back(start_at_vertices(starts[p].shift, pairs[p], by_pose ? &pose : nullptr).correspondence);
    found.back().confidence = starts[p].confidence;
  }
  return found;
}

}  // namespace meshgraft
