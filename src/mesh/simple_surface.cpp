#include "simple_surface.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "disjoint_sets.h"

namespace meshgraft {

namespace {

constexpr std::size_t elements_per_block = 16384;  // faces or vertices

// The corners of a mesh of triangles: 3t, 3t+1 and 3t+2 are those of triangle t.
class TriangleCorners {
 public:
  explicit TriangleCorners(const std::vector<Index>& vertices) : vertices_(vertices) {}
  Index triangle_count() const { return static_cast<Index>(vertices_.size() / 3); }
  Index vertex(Index corner) const { return vertices_[corner]; }
  static Index next(Index corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
  static Index previous(Index corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }
  Index corner_at(Index vertex, Index triangle) const {
    const Index first = 3 * triangle;
    return vertices_[first] == vertex ? first : vertices_[first + 1] == vertex ? first + 1 : first + 2;
  }

 private:
  const std::vector<Index>& vertices_;
};

// Returns whether `holds(block, begin, end)` for all blocks of [0, count). Blocks are left out once it does not
// hold for one.
template <class Holds>
bool holds_for_all(std::size_t count, const Holds& holds, const Context& context) {
  std::atomic<bool> all = true;
  parallel_blocks(
      (count + elements_per_block - 1) / elements_per_block,
      [&](std::size_t first, std::size_t last) {
        for (std::size_t block = first; block < last && all.load(std::memory_order_relaxed); ++block)
          if (!holds(block, block * elements_per_block, std::min(count, (block + 1) * elements_per_block)))
            all = false;
      },
      context, 1);
  return all;
}

bool has_proper_triangles_only(const Mesh& mesh, const Context& context) {
  const std::vector<Index>& offsets = mesh.faces.offsets();
  const std::vector<Index>& corners = mesh.faces.corners();
  const Index count = mesh.vertex_count();
  if (mesh.face_count() == 0 || corners.size() != 3 * static_cast<std::size_t>(mesh.face_count())) return false;
  return holds_for_all(
      static_cast<std::size_t>(mesh.face_count()),
      [&](std::size_t, std::size_t begin, std::size_t end) {
        bool proper = true;
        for (std::size_t f = begin; f < end; ++f) {
          const Index a = corners[3 * f], b = corners[3 * f + 1], c = corners[3 * f + 2];
          proper &= offsets[f] == static_cast<Index>(3 * f) && a >= 0 && b >= 0 && c >= 0 && a < count &&
                    b < count && c < count && a != b && b != c && c != a;
        }
        return proper;
      },
      context);
}

// The faces around a vertex, one after another.
struct FaceFan {
  bool is_single = false;  // they form one path or one cycle, consistently oriented
  Index leaving =
      -1;  // the corner whose half-edge leaves the vertex without an opposite one; -1: there is none
};

// Finds out how the faces around a vertex are connected. `next` and `previous` receive the vertices that follow
// and precede it in each of them.
FaceFan fan_around(Index vertex, std::span<const Index> triangles, const TriangleCorners& corners,
                   std::vector<Index>& next, std::vector<Index>& previous) {
  constexpr std::size_t crowd = 4096;  // comparing all pairs of faces takes too long above this
  const std::size_t count = triangles.size();
  if (count > crowd) return {};
  next.resize(count);
  previous.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Index corner = corners.corner_at(vertex, triangles[k]);
    next[k] = corners.vertex(TriangleCorners::next(corner));
    previous[k] = corners.vertex(TriangleCorners::previous(corner));
  }
  const auto found = [&](const std::vector<Index>& among, Index value) {
    return static_cast<std::size_t>(std::find(among.begin(), among.end(), value) - among.begin());
  };
  std::size_t first = count;  // the face that no other one precedes
  for (std::size_t k = 0; k < count; ++k) {
    if (found(next, next[k]) != k) return {};  // two faces run along an edge in the same direction
    if (found(previous, next[k]) < count) continue;
    if (first < count) return {};
    first = k;
  }
  const bool is_open = first < count;
  if (!is_open && count < 3) return {};  // two faces with the same vertices
  if (!is_open) first = 0;
  std::size_t visited = 1;
  for (std::size_t k = found(next, previous[first]); k < count && k != first && visited < count; ++visited)
    k = found(next, previous[k]);
  if (visited < count) return {};
  return {true, is_open ? corners.corner_at(vertex, triangles[first]) : -1};
}

// Returns the corners of `SimpleSurface::leaving`, or nothing if a vertex has not one fan.
std::optional<std::vector<Index>> leaving_corners(const IndexLists& faces_around,
                                                  const TriangleCorners& corners, const Context& context) {
  const auto count = static_cast<std::size_t>(faces_around.size());
  std::vector<std::vector<Index>> leaving(count / elements_per_block + 1);
  const bool all_single = holds_for_all(
      count,
      [&](std::size_t block, std::size_t begin, std::size_t end) {
        std::vector<Index> next, previous;
        for (std::size_t v = begin; v < end; ++v) {
          const auto triangles = faces_around[static_cast<Index>(v)];
          if (triangles.empty()) continue;
          const FaceFan fan = fan_around(static_cast<Index>(v), triangles, corners, next, previous);
          if (!fan.is_single) return false;
          if (fan.leaving >= 0) leaving[block].push_back(fan.leaving);
        }
        return true;
      },
      context);
  if (!all_single) return std::nullopt;
  std::vector<Index> all;
  for (const auto& some : leaving) all.insert(all.end(), some.begin(), some.end());
  return all;
}

// Returns for each vertex the smallest one of its component. Ranges of vertices are joined within themselves in
// parallel, and then by the edges between them.
std::vector<Index> smallest_connected(const IndexLists& faces_around, const std::vector<Index>& leaving,
                                      const TriangleCorners& corners, const Context& context) {
  const Index count = faces_around.size();
  DisjointSets sets(count);
  std::vector<std::vector<std::array<Index, 2>>> between(static_cast<std::size_t>(count) / elements_per_block +
                                                         1);
  parallel_blocks(
      between.size(),
      [&](std::size_t first, std::size_t last) {
        for (std::size_t range = first; range < last; ++range) {
          const auto begin = static_cast<Index>(range * elements_per_block);
          const auto end = static_cast<Index>(std::min<std::size_t>(count, (range + 1) * elements_per_block));
          for (Index v = begin; v < end; ++v)
            for (const Index t : faces_around[v]) {
              const Index next = corners.vertex(TriangleCorners::next(corners.corner_at(v, t)));
              if (next < v) continue;  // the opposite half-edge joins the two, or `leaving` does
              if (next < end)
                sets.unite(v, next);
              else
                between[range].push_back({v, next});
            }
        }
      },
      context, 1);
  for (const auto& some : between)
    for (const auto& [a, b] : some) sets.unite(a, b);
  for (const Index corner : leaving)
    sets.unite(corners.vertex(corner), corners.vertex(TriangleCorners::next(corner)));
  std::vector<Index> smallest(static_cast<std::size_t>(count));
  for (Index v = 0; v < count; ++v) smallest[v] = sets.root(v);
  return smallest;
}

// Returns the offsets of the rings: a vertex has as many neighbours as faces, and one more if its fan is open.
std::vector<Index> ring_offsets(const SimpleSurface& surface, const TriangleCorners& corners) {
  std::vector<Index> offsets = surface.faces_around.offsets;
  Index opened = 0;
  auto leaving = surface.leaving.begin();
  for (std::size_t v = 0; v + 1 < offsets.size(); ++v) {
    if (leaving != surface.leaving.end() && corners.vertex(*leaving) == static_cast<Index>(v)) {
      ++opened;
      ++leaving;
    }
    offsets[v + 1] += opened;
  }
  return offsets;
}

IndexLists rings_of(const SimpleSurface& surface, const TriangleCorners& corners, const Context& context) {
  IndexLists rings;
  rings.offsets = ring_offsets(surface, corners);
  rings.values.resize(static_cast<std::size_t>(rings.offsets.back()));
  const auto write_ring = [&](Index v) {
    const auto first = rings.values.begin() + rings.offsets[v],
               end = rings.values.begin() + rings.offsets[v + 1];
    auto last = first;
    for (const Index t : surface.faces_around[v])
      *last++ = corners.vertex(TriangleCorners::next(corners.corner_at(v, t)));
    if (last != end) {  // where an open fan ends, a neighbour follows the vertex in no face
      for (const Index t : surface.faces_around[v]) {
        const Index before = corners.vertex(TriangleCorners::previous(corners.corner_at(v, t)));
        if (std::find(first, last, before) == last) *last = before;
      }
    }
    std::sort(first, end);
  };
  parallel_blocks(
      static_cast<std::size_t>(rings.size()),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) write_ring(static_cast<Index>(v));
      },
      context, 4096);
  return rings;
}

// Numbers the components in the order of their smallest vertices; -1 for isolated vertices.
std::vector<Index> numbered_components(const SimpleSurface& surface) {
  std::vector<Index> number(surface.components.size(), -1);
  Index components = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (surface.faces_around[static_cast<Index>(v)].empty()) continue;
    const auto smallest = static_cast<std::size_t>(surface.components[v]);
    number[v] = smallest == v ? components++ : number[smallest];
  }
  return number;
}

std::vector<std::vector<Index>> loops_of(const SimpleSurface& surface, const TriangleCorners& corners) {
  std::vector<std::vector<Index>> loops;
  Flags used(surface.leaving.size(), 0);
  const auto leaving_at = [&](Index vertex) {
    return std::lower_bound(surface.leaving.begin(), surface.leaving.end(), vertex,
                            [&](Index corner, Index v) { return corners.vertex(corner) < v; }) -
           surface.leaving.begin();
  };
  for (std::size_t k = 0; k < used.size(); ++k) {  // so that every loop begins with its smallest vertex
    if (used[k]) continue;
    std::vector<Index>& loop = loops.emplace_back();
    for (auto at = static_cast<std::ptrdiff_t>(k); !used[static_cast<std::size_t>(at)];
         at =
             leaving_at(corners.vertex(TriangleCorners::next(surface.leaving[static_cast<std::size_t>(at)])))) {
      used[static_cast<std::size_t>(at)] = 1;
      loop.push_back(corners.vertex(surface.leaving[static_cast<std::size_t>(at)]));
    }
  }
  std::sort(loops.begin(), loops.end(),
            [](const auto& a, const auto& b) { return a.size() != b.size() ? a.size() > b.size() : a < b; });
  return loops;
}

}  // namespace

IndexLists triangles_around(Index vertex_count, std::span<const Index> corners, const Context& context) {
  // Each range of vertices is the work of one thread, which reads all corners.
  IndexLists lists;
  lists.offsets.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
  const auto for_each_corner = [&](int begin, int end, const auto& visit) {
    const auto size = static_cast<unsigned>(end - begin);
    for (std::size_t c = 0; c < corners.size(); c += 3) {
      const Index i = corners[c], j = corners[c + 1], k = corners[c + 2];
      const auto is_inside = [&](Index v) {
        return static_cast<unsigned>(v) - static_cast<unsigned>(begin) < size;
      };
      const auto triangle = static_cast<Index>(c / 3);
      if (is_inside(i)) visit(i, triangle);
      if (is_inside(j) && j != i) visit(j, triangle);
      if (is_inside(k) && k != i && k != j) visit(k, triangle);
    }
  };
  share_out(
      vertex_count,
      [&](int begin, int end) { for_each_corner(begin, end, [&](Index v, Index) { ++lists.offsets[v + 1]; }); },
      context);
  std::partial_sum(lists.offsets.begin(), lists.offsets.end(), lists.offsets.begin());
  lists.values.resize(static_cast<std::size_t>(lists.offsets.back()));
  std::vector<Index> cursor(lists.offsets.begin(), lists.offsets.end() - 1);
  share_out(
      vertex_count,
      [&](int begin, int end) {
        for_each_corner(begin, end, [&](Index v, Index triangle) { lists.values[cursor[v]++] = triangle; });
      },
      context);
  return lists;
}

std::shared_ptr<const SimpleSurface> find_simple_surface(const Mesh& mesh, const Context& context) {
  if (!has_proper_triangles_only(mesh, context)) return nullptr;
  const TriangleCorners corners(mesh.faces.corners());
  auto surface = std::make_shared<SimpleSurface>();
  surface->faces_around = triangles_around(mesh.vertex_count(), mesh.faces.corners(), context);
  auto leaving = leaving_corners(surface->faces_around, corners, context);
  if (!leaving) return nullptr;
  surface->leaving = *std::move(leaving);
  surface->components = smallest_connected(surface->faces_around, surface->leaving, corners, context);
  return surface;
}

Connectivity connectivity(const Mesh& mesh, const SimpleSurface& surface, const Context& context) {
  const TriangleCorners corners(mesh.faces.corners());
  return {rings_of(surface, corners, context), numbered_components(surface), loops_of(surface, corners)};
}

}  // namespace meshgraft
