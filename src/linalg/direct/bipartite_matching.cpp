#include "bipartite_matching.h"

#include <algorithm>

namespace meshgraft {

namespace {

/// Finds the matching in phases. Each phase finds disjoint shortest paths between unmatched vertices, along
/// which edges outside and inside the matching alternate. Exchanging these edges adds one edge per path to
/// the matching.
class HopcroftKarp {
 public:
  explicit HopcroftKarp(const BipartiteGraph& graph) : graph_(graph), layer_(graph.left_count()) {
    matching_.of_left.assign(layer_.size(), -1);
    matching_.of_right.assign(graph.right_count, -1);
  }

  Matching run() {
    while (find_layers()) {
      next_edge_.assign(graph_.begin.begin(), graph_.begin.end() - 1);
      for (int left = 0; left < graph_.left_count(); ++left)
        if (matching_.of_left[left] < 0) augment_from(left);
    }
    return std::move(matching_);
  }

 private:
  /// Sets the layer of each left vertex: the number of matching edges on a shortest path from an unmatched
  /// left vertex. Returns whether any path ends at an unmatched right vertex. Layers beyond the first such
  /// layer are not set.
  bool find_layers() {
    std::fill(layer_.begin(), layer_.end(), -1);
    queue_.clear();
    for (int left = 0; left < graph_.left_count(); ++left) {
      if (matching_.of_left[left] >= 0) continue;
      layer_[left] = 0;
      queue_.push_back(left);
    }
    int last_layer = graph_.left_count();
    for (std::size_t k = 0; k < queue_.size() && layer_[queue_[k]] <= last_layer; ++k) {
      const int left = queue_[k];
      for (int edge = graph_.begin[left]; edge < graph_.begin[left + 1]; ++edge) {
        const int partner = matching_.of_right[graph_.right_end[edge]];
        if (partner < 0) {
          last_layer = layer_[left];
        } else if (layer_[partner] < 0) {
          layer_[partner] = layer_[left] + 1;
          queue_.push_back(partner);
        }
      }
    }
    return last_layer < graph_.left_count();
  }

  /// Searches depth-first along the layers. Each edge is visited once per phase.
  void augment_from(int unmatched) {
    path_.assign(1, unmatched);
    while (!path_.empty()) {
      const int left = path_.back();
      if (next_edge_[left] == graph_.begin[left + 1]) {
        path_.pop_back();
        continue;
      }
      const int partner = matching_.of_right[graph_.right_end[next_edge_[left]++]];
      if (partner < 0) {
        exchange_path();
        return;
      }
      if (layer_[partner] == layer_[left] + 1) path_.push_back(partner);
    }
  }

  /// Matches each left vertex of the path by the edge visited last.
  void exchange_path() {
    for (const int left : path_) {
      const int right = graph_.right_end[next_edge_[left] - 1];
      matching_.of_left[left] = right;
      matching_.of_right[right] = left;
    }
  }

  const BipartiteGraph& graph_;
  Matching matching_;
  std::vector<int> layer_, queue_, next_edge_, path_;
};

}  // namespace

Matching maximum_matching(const BipartiteGraph& graph) { return HopcroftKarp(graph).run(); }

// By Kőnig's theorem, the cover consists of two sets. They are the left vertices that no alternating path
// from an unmatched left vertex reaches, and the right vertices that one reaches. Every maximum matching
// gives the same cover (Dulmage & Mendelsohn 1958).
VertexCover minimum_vertex_cover(const BipartiteGraph& graph, const Matching& matching) {
  VertexCover cover{Flags(matching.of_left.size(), 1), Flags(matching.of_right.size(), 0)};
  std::vector<int> reached;
  const auto reach = [&](int left) {
    if (cover.left[left] == 0) return;
    cover.left[left] = 0;
    reached.push_back(left);
  };
  for (int left = 0; left < graph.left_count(); ++left)
    if (matching.of_left[left] < 0) reach(left);
  for (std::size_t k = 0; k < reached.size(); ++k) {
    for (int edge = graph.begin[reached[k]]; edge < graph.begin[reached[k] + 1]; ++edge) {
      const int right = graph.right_end[edge];
      cover.right[right] = 1;
      reach(matching.of_right[right]);  // it has a partner, or the path could enlarge the matching
    }
  }
  return cover;
}

}  // namespace meshgraft
