#include "local_mesh.h"

#include <algorithm>
#include <utility>

namespace meshgraft::distributed {

Halo::Halo(const Communicator& comm, std::vector<Number> starts, std::vector<Number> copies)
    : comm_(&comm), starts_(std::move(starts)), copies_(std::move(copies)) {
  ByRank<Number> wanted(comm.size());
  for (std::size_t k = 0; k < copies_.size(); ++k) {
    const int rank = owner(copies_[k]);
    if (copies_from_.empty() || copies_from_.back().rank != rank) copies_from_.push_back({rank, k, k});
    ++copies_from_.back().end;
    wanted[rank].push_back(copies_[k]);
  }
  const ByRank<Number> asked = comm.exchange(wanted);
  for (int rank = 0; rank < comm.size(); ++rank) {
    if (asked[rank].empty()) continue;
    send_from_.push_back({rank, sent_.size(), sent_.size() + asked[rank].size()});
    for (const Number number : asked[rank]) sent_.push_back(static_cast<Index>(number - first()));
  }
}

int Halo::owner(Number number) const {
  return static_cast<int>(std::upper_bound(starts_.begin(), starts_.end(), number) - starts_.begin()) - 1;
}

Index Halo::local(Number number) const {
  if (number >= first() && number < first() + own()) return static_cast<Index>(number - first());
  const auto found = std::lower_bound(copies_.begin(), copies_.end(), number);
  return found != copies_.end() && *found == number ? own() + static_cast<Index>(found - copies_.begin()) : -1;
}

std::vector<Communicator::Message> Halo::messages(const std::vector<Range>& ranges, void* items,
                                                  std::size_t item_size) {
  std::vector<Communicator::Message> list;
  for (const Range& range : ranges)
    list.push_back({range.rank, static_cast<char*>(items) + range.begin * item_size,
                    static_cast<Number>(range.end - range.begin)});
  return list;
}

bool LocalMesh::owns_triangle(Index triangle) const {
  const auto corners = triangles.row(triangle);
  const Index smallest = *std::min_element(corners.begin(), corners.end(), [&](Index a, Index b) {
    return vertices.number(a) < vertices.number(b);
  });
  return smallest < vertices.own();
}

namespace {

/// Collects the triangles around a rank's vertices, and around those of other ranks that it asks for.
class TriangleCollector {
 public:
  TriangleCollector(const Communicator& comm, const std::vector<Number>& starts,
                    const std::vector<NumberedTriangle>& triangles)
      : comm_(comm), starts_(starts), first_(starts[comm.rank()]), end_(starts[comm.rank() + 1]) {
    std::vector<int> without_own;
    for (int rank = 0; rank < comm.size(); ++rank)
      if (starts[rank] == starts[rank + 1]) without_own.push_back(rank);
    ByRank<NumberedTriangle> to(comm.size());
    for (const NumberedTriangle& triangle : triangles) {
      if (std::ranges::find(triangle.corners, 0) != triangle.corners.end())
        for (const int rank : without_own) to[rank].push_back(triangle);
      std::array<int, 3> owners{};
      for (std::size_t c = 0; c < 3; ++c) owners[c] = owner(triangle.corners[c]);
      for (std::size_t c = 0; c < 3; ++c)
        if (std::find(owners.begin(), owners.begin() + static_cast<std::ptrdiff_t>(c), owners[c]) ==
            owners.begin() + static_cast<std::ptrdiff_t>(c))
          to[owners[c]].push_back(triangle);
    }
    for (const auto& list : comm.exchange(to)) triangles_.insert(triangles_.end(), list.begin(), list.end());
    sort_triangles();
    index_own();
  }

  /// Adds the triangles around the halo's vertices that are not complete yet.
  void grow() {
    std::vector<Number> front = halo();
    std::erase_if(front, [&](Number v) { return std::binary_search(complete_.begin(), complete_.end(), v); });
    ByRank<Number> wanted(comm_.size());
    for (const Number v : front) wanted[owner(v)].push_back(v);
    const ByRank<Number> asked = comm_.exchange(wanted);
    ByRank<NumberedTriangle> answers(comm_.size());
    std::vector<int> sent_to(own_triangles_.size(), -1);
    for (int rank = 0; rank < comm_.size(); ++rank)
      for (const Number v : asked[rank])
        for (std::size_t k = offsets_[v - first_]; k < offsets_[v - first_ + 1]; ++k) {
          const std::size_t triangle = at_vertex_[k];
          if (std::exchange(sent_to[triangle], rank) != rank) answers[rank].push_back(own_triangles_[triangle]);
        }
    for (const auto& list : comm_.exchange(answers))
      triangles_.insert(triangles_.end(), list.begin(), list.end());
    sort_triangles();
    complete_.insert(complete_.end(), front.begin(), front.end());
    std::sort(complete_.begin(), complete_.end());
  }

  /// Returns the vertices of the triangles that other ranks own, ascending.
  std::vector<Number> halo() const {
    std::vector<Number> numbers;
    for (const NumberedTriangle& triangle : triangles_)
      for (const Number v : triangle.corners)
        if (!is_own(v)) numbers.push_back(v);
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
  }

  const std::vector<NumberedTriangle>& triangles() const { return triangles_; }

 private:
  bool is_own(Number v) const { return v >= first_ && v < end_; }
  int owner(Number v) const {
    return static_cast<int>(std::upper_bound(starts_.begin(), starts_.end(), v) - starts_.begin()) - 1;
  }

  void sort_triangles() {
    std::sort(triangles_.begin(), triangles_.end(),
              [](const auto& a, const auto& b) { return a.number < b.number; });
    triangles_.erase(std::unique(triangles_.begin(), triangles_.end(),
                                 [](const auto& a, const auto& b) { return a.number == b.number; }),
                     triangles_.end());
  }

  void index_own() {
    own_triangles_ = triangles_;
    offsets_.assign(end_ - first_ + 1, 0);
    const auto for_each_corner = [&](const auto& body) {
      for (std::size_t t = 0; t < own_triangles_.size(); ++t)
        for (const Number v : own_triangles_[t].corners)
          if (is_own(v)) body(static_cast<std::size_t>(v - first_), t);
    };
    for_each_corner([&](std::size_t v, std::size_t) { ++offsets_[v + 1]; });
    for (std::size_t v = 0; v + 1 < offsets_.size(); ++v) offsets_[v + 1] += offsets_[v];
    at_vertex_.resize(offsets_.back());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for_each_corner([&](std::size_t v, std::size_t t) { at_vertex_[next[v]++] = t; });
  }

  const Communicator& comm_;
  const std::vector<Number>& starts_;
  Number first_, end_;
  std::vector<NumberedTriangle> triangles_, own_triangles_;  ///< all so far; those around own vertices
  std::vector<std::size_t> offsets_, at_vertex_;             ///< the triangles around each own vertex
  std::vector<Number> complete_;                             ///< halo vertices with all their triangles
};

}  // namespace

LocalMesh make_local_mesh(const Communicator& comm, const std::vector<Number>& starts,
                          const std::vector<NumberedTriangle>& triangles, int layers) {
  TriangleCollector collector(comm, starts, triangles);
  for (int layer = 0; layer < layers; ++layer) collector.grow();
  LocalMesh mesh;
  mesh.vertices = Halo(comm, starts, collector.halo());
  mesh.triangles.resize(static_cast<Eigen::Index>(collector.triangles().size()), 3);
  for (std::size_t t = 0; t < collector.triangles().size(); ++t) {
    const NumberedTriangle& triangle = collector.triangles()[t];
    mesh.triangle_numbers.push_back(triangle.number);
    for (int c = 0; c < 3; ++c)
      mesh.triangles(static_cast<Eigen::Index>(t), c) = mesh.vertices.local(triangle.corners[c]);
  }
  mesh.faces_at = vertex_triangles(mesh.vertices.size(), mesh.triangles, {.threads = 1});
  mesh.rings = vertex_rings(mesh.triangles, mesh.faces_at, {.threads = 1});
  return mesh;
}

}  // namespace meshgraft::distributed
