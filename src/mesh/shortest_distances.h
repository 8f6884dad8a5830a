#pragma once

#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

constexpr double unreached = std::numeric_limits<double>::infinity();

/// Distances of few nodes out of many; `unreached` until they are set.
class SparseDistances {
 public:
  double& operator[](Index node) { return distance_.try_emplace(node, unreached).first->second; }

 private:
  std::unordered_map<Index, double> distance_;
};

/// Computes shortest distances from the seeds (Dijkstra 1959) over numbered nodes, such as vertices or faces.
///
/// `distance[node]` is a double&: `unreached`, or the distance from earlier seeds, of which only the longer
/// ones change. Seeds get 0. `visit(node, distance, offer)` is called for the nodes whose distance decreased,
/// nearest first, and ends the walk if it returns false. It offers each neighbour a distance,
/// `offer(neighbour, distance)`, which returns whether that is the shortest so far. Distances must not
/// decrease along a path.
template <class Distances, class Visit>
void shortest_distances(std::span<const Index> seeds, Distances& distance, const Visit& visit) {
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  const auto offer = [&](Index node, double candidate) {
    double& shortest = distance[node];
    if (!(candidate < shortest)) return false;
    shortest = candidate;
    front.emplace(candidate, node);
    return true;
  };
  for (const Index seed : seeds) offer(seed, 0.0);
  while (!front.empty()) {
    const auto [reached, node] = front.top();
    front.pop();
    if (reached > distance[node]) continue;  // a shorter path was found since
    if (!visit(node, reached, offer)) return;
  }
}

}  // namespace meshgraft
