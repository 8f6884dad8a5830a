#include "start_candidates.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace meshgraft {

namespace {

// Weights of the evidence, in nats, fitted with those in mesh/orientation.cpp.
constexpr double loop_faces_up = 1.1, loop_faces_front = 0.7;
constexpr double loop_faces_side = 4.5;  // a loop hardly ever faces sideways
constexpr double same_coordinates = 4;   // times as probable: both models have one up and front in their files
constexpr double concentration = 7.5;    // of rotations around the one that aligns the orientations
constexpr double fit_weight = 1.2;       // per factor e of the distance of points; normals tell nothing more
constexpr double noise = 1e-5;           // cost that tessellations of one curve may cause
constexpr double same_vertices = 1e6;    // times as probable: loops that coincide are the sides of one cut
constexpr double surprise = 1e-4;        // likelihood of rotations that align nothing, by what is guessed

// Returns the guesses with the evidence of the loop: which way it faces.
std::vector<OrientationGuess> weighed(const LoopOrientations& loop) {
  std::vector<OrientationGuess> guesses = loop.guesses;
  double sum = 0;
  for (OrientationGuess& guess : guesses) {
    const auto& [up, front] = guess.orientation;
    const Eigen::Vector3d& axis = loop.into_source;
    guess.probability *= std::exp(loop_faces_up * up.dot(axis) + loop_faces_front * front.dot(axis) -
                                  loop_faces_side * std::abs(up.cross(front).dot(axis)));
    sum += guess.probability;
  }
  for (OrientationGuess& guess : guesses) guess.probability /= sum;
  return guesses;
}

Eigen::Matrix3d frame_of(const Orientation& orientation) {
  Eigen::Matrix3d frame;
  frame << orientation.up, orientation.front, orientation.up.cross(orientation.front);
  return frame;
}

// A rotation that would align the models.
struct Alignment {
  Eigen::Matrix3d rotation;
  double probability = 0;
};

std::vector<Alignment> alignments(const LoopOrientations& source, const LoopOrientations& target) {
  std::vector<Alignment> found;
  double sum = 0;
  for (const OrientationGuess& there : weighed(target))
    for (const OrientationGuess& here : weighed(source)) {
      const Eigen::Matrix3d rotation = frame_of(there.orientation) * frame_of(here.orientation).transpose();
      const bool same = rotation.isIdentity(1e-6);
      const double probability = there.probability * here.probability * (same ? same_coordinates : 1);
      sum += probability;
      const auto known = std::ranges::find_if(
          found, [&](const Alignment& other) { return other.rotation.isApprox(rotation, 1e-6); });
      if (known == found.end())
        found.push_back({rotation, probability});
      else
        known->probability += probability;
    }
  for (Alignment& alignment : found) alignment.probability /= sum;
  return found;
}

std::vector<double> probabilities(std::span<const LoopFit> fits, const LoopOrientations& source,
                                  const LoopOrientations& target) {
  const std::vector<Alignment> aligned = alignments(source, target);
  const bool known = source.guesses.size() == 1 && target.guesses.size() == 1;
  std::vector<double> probability;
  double sum = 0;
  for (const LoopFit& fit : fits) {
    double likelihood = known ? 0 : surprise;
    for (const Alignment& alignment : aligned)
      likelihood += alignment.probability *
                    std::exp(concentration * (fit.rotation.cwiseProduct(alignment.rotation).sum() - 3));
    if (fit.coincides && !known) likelihood *= same_vertices;
    probability.push_back(likelihood * std::pow(std::max(fit.point_cost, 0.0) + noise, -fit_weight));
    sum += probability.back();
  }
  for (double& value : probability) value /= sum;
  return probability;
}

}  // namespace

std::vector<RankedShift> rank_starts(std::span<const LoopFit> fits, const LoopOrientations& source,
                                     const LoopOrientations& target) {
  constexpr std::size_t most_starts = 5;
  constexpr double negligible = 0.01;
  const std::vector<double> probability = probabilities(fits, source, target);
  const int count = static_cast<int>(fits.size()), reach = count / 10;
  const auto cyclic = [&](int k) { return (k % count + count) % count; };

  // The probability of the starts around each.
  std::vector<double> around(count, 0.0);
  for (int k = 0; k < count; ++k)
    for (int i = -reach; i <= reach; ++i) around[k] += probability[cyclic(k + i)];

  std::vector<bool> taken(count, false);
  std::vector<RankedShift> starts;
  while (starts.size() < most_starts) {
    int centre = -1;
    for (int k = 0; k < count; ++k)
      if (!taken[k] && (centre < 0 || around[k] > around[centre])) centre = k;
    if (centre < 0 || (!starts.empty() && around[centre] < negligible)) break;
    int best = centre;
    for (int i = -reach; i <= reach; ++i)
      if (const int k = cyclic(centre + i); !taken[k] && probability[k] > probability[best]) best = k;
    starts.push_back({best, around[centre]});
    for (int i = -2 * reach; i <= 2 * reach; ++i) taken[cyclic(centre + i)] = taken[cyclic(best + i)] = true;
  }
  return starts;
}

bool is_unsure(std::span<const StartCandidate> starts) {
  constexpr double unsure = 0.6;  // chosen: hardly more probable than all others together
  return !starts.empty() && starts.front().probability < unsure;
}

}  // namespace meshgraft
