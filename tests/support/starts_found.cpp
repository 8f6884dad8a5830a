#include "support/starts_found.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <meshgraft/mesh/topology.h>

#include "merge/match_loops.h"

namespace meshgraft::test {

std::vector<StartCandidate> starts_of(const StartTask& task, bool whole) {
  const std::vector<PairGeometry> geometry = pair_geometry(task.target, task.source, {{task.loops}}, false);
  const std::vector<MergePair> pairs{{task.loops, {}}};
  const ModelOrientations orientations =
      whole ? ModelOrientations{task.target_guesses, task.source_guesses}
            : ModelOrientations{guess_orientations(task.target), guess_orientations(task.source)};
  return match_loops(geometry, pairs, connected_components(task.source), false, orientations).front().starts;
}

void StartsFound::add(const StartTask& task, const std::vector<StartCandidate>& starts) {
  constexpr double right_deg = 20;
  Found found;
  for (std::size_t k = 0; k < std::min<std::size_t>(starts.size(), 3); ++k) {
    const bool right = start_error_deg(task, starts[k].start) <= right_deg;
    found.first |= right && k == 0;
    found.among_three |= right;
  }
  found.probability = starts.front().probability;
  found_.push_back(found);
}

double StartsFound::right_first() const {
  return static_cast<double>(std::ranges::count_if(found_, &Found::first)) / static_cast<double>(found_.size());
}

double StartsFound::right_among_three() const {
  return static_cast<double>(std::ranges::count_if(found_, &Found::among_three)) /
         static_cast<double>(found_.size());
}

double StartsFound::calibration_error() const {
  struct Class {
    double probability = 0, right = 0;
  };
  std::array<Class, 5> classes;
  for (const Found& found : found_) {
    Class& one = classes[std::min<std::size_t>(4, static_cast<std::size_t>(5 * found.probability))];
    one.probability += found.probability;
    one.right += found.first ? 1 : 0;
  }
  double sum = 0;
  for (const Class& one : classes) sum += std::abs(one.probability - one.right);
  return sum / static_cast<double>(found_.size());
}

}  // namespace meshgraft::test
