#include "hole_triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "core/parallel.h"

namespace meshgraft {

namespace {

constexpr Index corridor_width = 3;  // how many vertices the ends of a chord may move between levels
constexpr Index coarsest = 80;       // loops of at most this many edges are searched in full

// Removes the forbidden chords; `forbidden` is sorted.
std::vector<HoleChord> allowed(std::vector<HoleChord> chords, const std::vector<HoleChord>& forbidden) {
  std::erase_if(chords, [&](const HoleChord& chord) {
    return std::binary_search(forbidden.begin(), forbidden.end(), chord);
  });
  return chords;
}

std::vector<HoleChord> all_chords(Index n) {
  std::vector<HoleChord> chords;
  for (Index i = 0; i + 2 < n; ++i)
    for (Index k = i + 2; k < n; ++k)
      if (k - i < n - 1) chords.push_back({i, k});
  return chords;
}

// Returns all chords whose two ends are near those of an edge of the triangles.
std::vector<HoleChord> corridor(Index n, const std::vector<HoleTriangle>& triangles, Index width) {
  std::vector<HoleChord> chords;
  const auto add_around = [&](Index a, Index b) {
    for (Index i = a - width; i <= a + width; ++i) {
      for (Index k = b - width; k <= b + width; ++k) {
        const Index first = (i + n) % n, second = (k + n) % n;
        const auto [low, high] = std::minmax(first, second);
        if (high - low > 1 && high - low < n - 1) chords.push_back({low, high});
      }
    }
  };
  for (const auto& [a, b, c] : triangles) {
    add_around(a, b);
    add_around(b, c);
    add_around(a, c);
  }
  std::sort(chords.begin(), chords.end());
  chords.erase(std::unique(chords.begin(), chords.end()), chords.end());
  return chords;
}

// A coarsened loop, and for each of its vertices the index in the finer loop.
struct CoarseLoop {
  HoleLoop loop;
  std::vector<Index> kept;
};

// Returns the vertices to keep. Drops up to half of them, those that matter least to the shape, and never two
// neighbours.
std::vector<Index> choose_kept(const Points& points) {
  const auto n = static_cast<Index>(points.rows());
  std::vector<double> weight(n);
  for (Index k = 0; k < n; ++k) {
    const Eigen::RowVector3d before = points.row((k + n - 1) % n) - points.row(k);
    const Eigen::RowVector3d after = points.row((k + 1) % n) - points.row(k);
    weight[k] = before.cross(after).norm();
  }
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return weight[a] < weight[b]; });
  Flags goes(n, 0);
  for (const Index k : order)
    if (!goes[(k + n - 1) % n] && !goes[(k + 1) % n]) goes[k] = 1;
  std::vector<Index> kept;
  for (Index k = 0; k < n; ++k)
    if (!goes[k]) kept.push_back(k);
  return kept;
}

CoarseLoop coarsen(const HoleLoop& fine) {
  CoarseLoop coarse;
  coarse.kept = choose_kept(fine.points);
  const auto n = static_cast<Index>(coarse.kept.size());
  coarse.loop.points.resize(n, 3);
  for (Index k = 0; k < n; ++k) coarse.loop.points.row(k) = fine.points.row(coarse.kept[k]);
  if (fine.beyond.rows() == 0) return coarse;
  coarse.loop.beyond.resize(n, 3);
  for (Index k = 0; k < n; ++k) {
    // The offset sums the vectors from the fine edges' midpoints to their outer corners, and is applied at
    // the coarse edge's midpoint.
    Eigen::RowVector3d offset = Eigen::RowVector3d::Zero();
    const Index end = coarse.kept[(k + 1) % n];
    for (Index j = coarse.kept[k]; j != end; j = (j + 1) % fine.size())
      offset += fine.beyond.row(j) - (fine.points.row(j) + fine.points.row((j + 1) % fine.size())) / 2;
    coarse.loop.beyond.row(k) = (coarse.loop.points.row(k) + coarse.loop.points.row((k + 1) % n)) / 2 + offset;
  }
  return coarse;
}

// Returns the same triangles between vertices of the finer loop, plus one triangle at each vertex dropped in
// the coarser one.
std::vector<HoleTriangle> refine_triangles(const CoarseLoop& coarse, Index fine_size,
                                           std::vector<HoleTriangle> triangles) {
  for (HoleTriangle& triangle : triangles)
    for (Index& corner : triangle) corner = coarse.kept[corner];
  Flags is_kept(fine_size, 0);
  for (const Index k : coarse.kept) is_kept[k] = 1;
  for (Index k = 0; k < fine_size; ++k) {
    if (is_kept[k]) continue;
    HoleTriangle ear{(k + fine_size - 1) % fine_size, k, (k + 1) % fine_size};
    std::sort(ear.begin(), ear.end());
    triangles.push_back(ear);
  }
  return triangles;
}

// Finds the neighbours of triangles across their edges. Triangles of a hole have their corners in ascending
// order, so they have no half-edges for an EdgeTable.
class Neighbours {
 public:
  explicit Neighbours(const std::vector<HoleTriangle>& triangles) {
    edges_.reserve(3 * triangles.size());
    for (Index t = 0; t < static_cast<Index>(triangles.size()); ++t)
      for (int k = 0; k < 3; ++k) edges_.push_back({edge_of(triangles[t], k), t});
    std::sort(edges_.begin(), edges_.end());
  }

  // Returns the edge after the k-th corner of a triangle, smaller vertex first.
  static HoleChord edge_of(const HoleTriangle& triangle, int k) {
    const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
    return {low, high};
  }

  // Returns the triangle on the other side of an edge, or -1.
  Index across(const HoleChord& edge, Index triangle) const {
    const auto first = std::lower_bound(edges_.begin(), edges_.end(), std::pair{edge, Index{-1}});
    const auto second = first + 1;
    if (first->second != triangle) return first->second;
    return second != edges_.end() && second->first == edge ? second->second : -1;
  }

 private:
  std::vector<std::pair<HoleChord, Index>> edges_;
};

Index third_corner(const HoleTriangle& triangle, const HoleChord& edge) {
  return triangle[0] + triangle[1] + triangle[2] - edge[0] - edge[1];
}

// A connected set of triangles, with its border as a loop and the triangles beyond that loop.
struct Window {
  std::vector<Index> triangles;
  std::vector<Index> vertices;  // ascending, which is along the loop
  HoleLoop loop;
};

class Folds {
 public:
  Folds(const HoleLoop& loop, const std::vector<HoleChord>& forbidden, std::vector<HoleTriangle>& triangles)
      : loop_(loop), forbidden_(forbidden), triangles_(triangles), neighbours_(triangles) {}

  // Returns the triangle with the largest bend against a neighbour or the faces beyond the loop, and that
  // bend.
  std::pair<Index, double> worst() const {
    std::pair<Index, double> worst{0, 0};
    for (Index t = 0; t < static_cast<Index>(triangles_.size()); ++t)
      for (int k = 0; k < 3; ++k) {
        const HoleChord edge = Neighbours::edge_of(triangles_[t], k);
        const double here = bend_between(point(edge[0]), point(edge[1]),
                                         point(third_corner(triangles_[t], edge)), beyond(edge, t));
        if (here > worst.second) worst = {t, here};
      }
    return worst;
  }

  // Triangulates the neighbourhood of a triangle again, with the smallest possible largest angle.
  void improve(Index start, Index size, const Context& context) {
    const Window window = window_around(start, size);
    const auto n = static_cast<Index>(window.vertices.size());
    std::vector<HoleChord> chords = all_chords(n);
    std::erase_if(chords, [&](const HoleChord& chord) {
      return std::binary_search(forbidden_.begin(), forbidden_.end(),
                                HoleChord{window.vertices[chord[0]], window.vertices[chord[1]]});
    });
    const std::vector<HoleTriangle> found = search_triangulation(window.loop, chords, HoleAim::angle, context);
    if (found.size() != window.triangles.size()) return;
    for (std::size_t t = 0; t < found.size(); ++t)
      for (int k = 0; k < 3; ++k) triangles_[window.triangles[t]][k] = window.vertices[found[t][k]];
    neighbours_ = Neighbours(triangles_);
  }

 private:
  Eigen::Vector3d point(Index k) const { return loop_.points.row(k).transpose(); }

  Eigen::Vector3d beyond(const HoleChord& edge, Index triangle) const {
    const Index other = neighbours_.across(edge, triangle);
    if (other >= 0) return point(third_corner(triangles_[other], edge));
    if (loop_.beyond.rows() == 0) return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    return loop_.beyond.row(edge[1] - edge[0] == 1 ? edge[0] : edge[1]).transpose();
  }

  Window window_around(Index start, Index size) const {
    Window window;
    std::set<Index> reached{start};
    window.triangles = {start};
    for (std::size_t next = 0; next < window.triangles.size(); ++next)
      for (int k = 0; k < 3 && static_cast<Index>(window.triangles.size()) < size; ++k) {
        const Index t = window.triangles[next];
        const Index other = neighbours_.across(Neighbours::edge_of(triangles_[t], k), t);
        if (other >= 0 && reached.insert(other).second) window.triangles.push_back(other);
      }
    std::map<HoleChord, Index> border;  // edges with one triangle in the window, and that triangle
    for (const Index t : window.triangles)
      for (int k = 0; k < 3; ++k) {
        const HoleChord edge = Neighbours::edge_of(triangles_[t], k);
        if (!border.try_emplace(edge, t).second) border.erase(edge);
        window.vertices.push_back(triangles_[t][k]);
      }
    std::sort(window.vertices.begin(), window.vertices.end());
    window.vertices.erase(std::unique(window.vertices.begin(), window.vertices.end()), window.vertices.end());
    const auto n = static_cast<Index>(window.vertices.size());
    window.loop.points.resize(n, 3);
    window.loop.beyond.resize(n, 3);
    for (Index k = 0; k < n; ++k) {
      const auto [low, high] = std::minmax(window.vertices[k], window.vertices[(k + 1) % n]);
      window.loop.points.row(k) = loop_.points.row(window.vertices[k]);
      window.loop.beyond.row(k) = beyond({low, high}, border.at({low, high})).transpose();
    }
    return window;
  }

  const HoleLoop& loop_;
  const std::vector<HoleChord>& forbidden_;
  std::vector<HoleTriangle>& triangles_;
  Neighbours neighbours_;
};

// Triangulates the neighbourhood of the largest angle again, as long as that reduces the angle.
void improve_folds(const HoleLoop& loop, const std::vector<HoleChord>& forbidden,
                   std::vector<HoleTriangle>& triangles, const Context& context) {
  constexpr Index smallest = 24, largest = 96;
  constexpr int most = 300;
  if (triangles.empty()) return;
  Folds folds(loop, forbidden, triangles);
  auto [triangle, bend] = folds.worst();
  Index size = smallest;
  for (int k = 0; k < most && size <= largest; ++k) {
    context.throw_if_stopped();
    folds.improve(triangle, size, context);
    const auto [next, next_bend] = folds.worst();
    size = next_bend < bend * (1 - 1e-9) ? smallest : 2 * size;
    triangle = next;
    bend = next_bend;
  }
  std::sort(triangles.begin(), triangles.end());
}

// Returns triangles near which good ones lie: those of a coarser loop, plus one at each dropped vertex.
std::vector<HoleTriangle> guide(const HoleLoop& loop, HoleAim aim, const Context& context) {
  const CoarseLoop coarse = coarsen(loop);
  const Index n = coarse.loop.size();
  const std::vector<HoleChord> chords =
      n <= coarsest ? all_chords(n) : corridor(n, guide(coarse.loop, aim, context), corridor_width);
  std::vector<HoleTriangle> triangles = search_triangulation(coarse.loop, chords, aim, context);
  // A fold would mislead the finer levels, but the smallest area may need its folds.
  if (aim == HoleAim::smooth) improve_folds(coarse.loop, {}, triangles, context);
  return refine_triangles(coarse, loop.size(), std::move(triangles));
}

// Returns the best triangulation near a guide.
std::vector<HoleTriangle> search_near(const HoleLoop& loop, const std::vector<HoleTriangle>& guide,
                                      const std::vector<HoleChord>& forbidden, const Context& context) {
  const Index n = loop.size();
  for (Index width = corridor_width; width < n; width *= 2) {
    std::vector<HoleTriangle> triangles =
        search_triangulation(loop, allowed(corridor(n, guide, width), forbidden), HoleAim::angle, context);
    if (!triangles.empty()) return triangles;
  }
  return {};
}

// Scales the loop by a power of two, so that no product of lengths overflows or underflows.
HoleLoop near_unit_size(const HoleLoop& loop) {
  const double extent = (loop.points.rowwise() - loop.points.row(0)).cwiseAbs().maxCoeff();
  if (!(extent > 0) || !std::isfinite(extent)) return loop;
  const double scale = std::ldexp(1, std::clamp(-std::ilogb(extent), -1000, 1000));
  return {scale * loop.points, scale * loop.beyond};
}

double largest_bend(const HoleLoop& loop, std::vector<HoleTriangle>& triangles) {
  return Folds(loop, {}, triangles).worst().second;
}

double area_of(const HoleLoop& loop, const std::vector<HoleTriangle>& triangles) {
  double area = 0;
  for (const auto& [a, b, c] : triangles) {
    const Eigen::RowVector3d ab = loop.points.row(b) - loop.points.row(a);
    const Eigen::RowVector3d ac = loop.points.row(c) - loop.points.row(a);
    area += ab.cross(ac).norm() / 2;
  }
  return area;
}

// Returns the triangulation with the smaller largest angle, or for equal angles the one with the smaller
// area.
std::vector<HoleTriangle> better(const HoleLoop& loop, std::vector<HoleTriangle> first,
                                 std::vector<HoleTriangle> second) {
  constexpr double bend_rel = 1e-9;  // relative tolerance for equal bends
  if (first.empty() || second.empty()) return first.empty() ? second : first;
  const double first_bend = largest_bend(loop, first), second_bend = largest_bend(loop, second);
  if (first_bend < second_bend * (1 - bend_rel)) return first;
  if (second_bend < first_bend * (1 - bend_rel)) return second;
  return area_of(loop, first) <= area_of(loop, second) ? first : second;
}

}  // namespace

std::vector<HoleTriangle> triangulate_hole(const HoleLoop& given, const HoleTriangulationOptions& options,
                                           const Context& context) {
  const Index n = given.size();
  if (n < 3 || !given.points.allFinite()) return {};
  if (n == 3) return {{0, 1, 2}};
  const HoleLoop loop = near_unit_size(given);
  std::vector<HoleChord> forbidden = options.forbidden;
  std::sort(forbidden.begin(), forbidden.end());
  if (n <= options.full_search)
    return search_triangulation(loop, allowed(all_chords(n), forbidden), HoleAim::angle, context);

  std::array<std::vector<HoleTriangle>, 2> found;
  constexpr std::array aims{HoleAim::smooth, HoleAim::area};
  parallel_blocks(
      aims.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          found[k] = search_near(loop, guide(loop, aims[k], context), forbidden, context);
          if (aims[k] == HoleAim::smooth) improve_folds(loop, forbidden, found[k], context);
        }
      },
      context, 1);
  std::vector<HoleTriangle> best = better(loop, std::move(found[0]), std::move(found[1]));
  improve_folds(loop, forbidden, best, context);
  return search_near(loop, best, forbidden, context);
}

}  // namespace meshgraft
