#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

#include "area_vector.h"
#include "mesh/facts.h"

namespace meshgraft {

namespace {

using Polygon = std::vector<Eigen::Vector2d>;
using Corners = std::array<Index, 3>;  // indices within one face

constexpr double flat_rel = 1e-12;  // twice the area below this × longest edge² counts as none

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return cross(b - a, c - a);
}

double longest_edge_squared(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
}

// Returns twice the area over the longest edge squared: 0.87 for an equilateral triangle, negative for a
// reflex corner.
double shape(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double size = longest_edge_squared(a, b, c);
  return size > 0 ? turn(a, b, c) / size : 0;
}

// Returns whether q lies in the closed triangle. A point at a corner does not count, because polygons may
// touch themselves.
bool covers(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
            const Eigen::Vector2d& q) {
  if (q == a || q == b || q == c) return false;
  const double slack = -flat_rel * longest_edge_squared(a, b, c);
  return turn(a, b, q) >= slack && turn(b, c, q) >= slack && turn(c, a, q) >= slack;
}

// Projects the polygon into the plane of Newell's normal, counter-clockwise, relative to its first corner.
// Returns an empty polygon if it has no area and so no plane.
Polygon project(const std::vector<Index>& face, const Points& positions) {
  std::vector<Eigen::Vector3d> centred;
  for (const Index v : face) centred.emplace_back(positions.row(v) - positions.row(face[0]));
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t c = 2; c < centred.size(); ++c) normal += centred[c - 1].cross(centred[c]);
  const double length = normal.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) return {};
  normal /= length;
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  Polygon polygon;
  for (const auto& p : centred) polygon.emplace_back(u.dot(p), v.dot(p));
  return polygon;
}

bool strictly_convex(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t c = 0; c < n; ++c) {
    if (shape(polygon[c], polygon[(c + 1) % n], polygon[(c + 2) % n]) <= flat_rel) return false;
  }
  return true;
}

void split_quad(const std::vector<Index>& face, const Points& positions, std::vector<Corners>& out) {
  const double first = (positions.row(face[2]) - positions.row(face[0])).norm();
  const double second = (positions.row(face[3]) - positions.row(face[1])).norm();
  // Rounding must not decide between equal diagonals, otherwise a rotated scene would be split differently.
  constexpr double tie = 1 - 1e-9;
  if (second < tie * first) {
    out.insert(out.end(), {Corners{0, 1, 3}, Corners{1, 2, 3}});
  } else {
    out.insert(out.end(), {Corners{0, 1, 2}, Corners{0, 2, 3}});
  }
}

// The remaining corners of a polygon, found by position in a grid of about as many cells as corners.
class CornerGrid {
 public:
  void build(const Polygon& polygon, std::vector<Index> corners) {
    low_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector2d high = -low_;
    for (const Index c : corners) {
      low_ = low_.cwiseMin(polygon[c]);
      high = high.cwiseMax(polygon[c]);
    }
    cells_ = std::max<Index>(1, static_cast<Index>(std::sqrt(static_cast<double>(corners.size()))));
    scale_ = cells_ / (high - low_).array().max(1e-300);
    std::vector<Index> cell;
    first_.assign(cells_ * cells_ + 1, 0);
    for (const Index c : corners) {
      cell.push_back(column(0, polygon[c].x()) + cells_ * column(1, polygon[c].y()));
      ++first_[cell.back() + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    corners_.resize(corners.size());
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    for (std::size_t k = 0; k < corners.size(); ++k) corners_[next[cell[k]]++] = corners[k];
  }

  /// Returns whether `that` holds for any corner in the box.
  template <class Predicate>
  bool any_in(const Eigen::Vector2d& low, const Eigen::Vector2d& high, const Predicate& that) const {
    for (Index y = column(1, low.y()); y <= column(1, high.y()); ++y) {
      const auto begin = corners_.begin() + first_[cells_ * y + column(0, low.x())];
      const auto end = corners_.begin() + first_[cells_ * y + column(0, high.x()) + 1];
      if (std::any_of(begin, end, that)) return true;
    }
    return false;
  }

 private:
  Index column(int axis, double x) const {
    const double cell = (x - low_[axis]) * scale_[axis];
    return static_cast<Index>(std::clamp(cell, 0.0, static_cast<double>(cells_ - 1)));
  }

  Eigen::Vector2d low_;
  Eigen::Array2d scale_;
  Index cells_ = 1;  // along each axis
  std::vector<Index> first_, corners_;
};

class EarClip {
 public:
  explicit EarClip(const Polygon& polygon)
      : polygon_(polygon),
        left_(static_cast<Index>(polygon.size())),
        before_(polygon.size()),
        after_(polygon.size()),
        quality_(polygon.size()) {
    for (Index c = 0; c < left_; ++c) {
      before_[c] = (c + left_ - 1) % left_;
      after_[c] = (c + 1) % left_;
    }
    rebuild_grid();
    for (Index c = 0; c < left_; ++c) rate(c);
  }

  void clip(std::vector<Corners>& out) {
    while (left_ > 3) {
      const Index ear = best();
      const Index a = before_[ear], b = after_[ear];
      out.push_back({a, ear, b});
      after_[a] = b;
      before_[b] = a;
      after_[ear] = gone;
      if (--left_ <= in_grid_ / 2) rebuild_grid();
      rate(b);
      rate(a);
    }
    const Index c = first_left();
    out.push_back({c, after_[c], after_[after_[c]]});
  }

 private:
  static constexpr Index gone = -1;

  struct Rated {
    double quality;
    Index corner;
    // Orders the best last; among equals, the first corner is the best.
    bool operator<(const Rated& other) const {
      return quality != other.quality ? quality < other.quality : corner > other.corner;
    }
  };

  Index first_left() const {
    return static_cast<Index>(
        std::find_if(after_.begin(), after_.end(), [](Index next) { return next != gone; }) - after_.begin());
  }

  Index best() {
    for (;;) {
      const Rated top = ears_.top();
      ears_.pop();
      if (after_[top.corner] != gone && quality_[top.corner] == top.quality) return top.corner;
    }
  }

  // Clipped corners stay in the grid until they make up half of it.
  void rebuild_grid() {
    std::vector<Index> corners;
    for (Index c = 0; c < static_cast<Index>(after_.size()); ++c)
      if (after_[c] != gone) corners.push_back(c);
    in_grid_ = left_;
    grid_.build(polygon_, std::move(corners));
  }

  // Rates corner c as an ear. Proper ears come first, led by the best-shaped. Corners on a straight line
  // follow, because a triangle without area is better than one outside. The remaining corners of a
  // self-intersecting polygon come last, so that the loop always ends.
  void rate(Index c) {
    const double s = shape(polygon_[before_[c]], polygon_[c], polygon_[after_[c]]);
    if (s > flat_rel && !blocked(c)) {
      quality_[c] = s;
    } else {
      quality_[c] = -1 - (s > flat_rel ? 1 : std::abs(s));
    }
    ears_.push({quality_[c], c});
  }

  bool blocked(Index c) const {
    const auto& [a, b, d] = std::tie(polygon_[before_[c]], polygon_[c], polygon_[after_[c]]);
    const Eigen::Vector2d low = a.cwiseMin(b).cwiseMin(d), high = a.cwiseMax(b).cwiseMax(d);
    const double slack = 1e-9 * (high - low).maxCoeff();  // `covers` has a tolerance
    return grid_.any_in(low.array() - slack, high.array() + slack, [&, a = a, b = b, d = d](Index q) {
      return after_[q] != gone && covers(a, b, d, polygon_[q]);
    });
  }

  const Polygon& polygon_;
  Index left_;                         // corners not yet clipped
  std::vector<Index> before_, after_;  // neighbours among them; `after_` marks clipped corners
  std::vector<double> quality_;        // per corner: quality as an ear
  std::priority_queue<Rated> ears_;    // an entry is stale if its quality has changed since
  CornerGrid grid_;
  Index in_grid_ = 0;
};

std::vector<Corners> split(const std::vector<Index>& face, const Points& positions) {
  std::vector<Corners> triangles;
  const Polygon polygon = project(face, positions);
  if (polygon.empty()) {
    for (Index c = 2; c < static_cast<Index>(face.size()); ++c) triangles.push_back({0, c - 1, c});
  } else if (face.size() == 4 && strictly_convex(polygon)) {
    split_quad(face, positions, triangles);
  } else {
    EarClip(polygon).clip(triangles);
  }
  return triangles;
}

bool refers_to_vertices(const Mesh& mesh, Index face, const TriangulateOptions& options) {
  for (const Index v : mesh.faces[face]) {
    if (v >= 0 && v < mesh.vertex_count()) continue;
    if (options.skip_out_of_range) return false;
    throw Error(facts::mesh::FaceIndexOutOfRange{.face = face, .vertex = v, .count = mesh.vertex_count()},
                Location::place("face " + std::to_string(face)));
  }
  return true;
}

void drop_repeats(std::span<const Index> face, std::vector<Index>& out) {
  out.clear();
  for (std::size_t c = 0; c < face.size(); ++c) {
    if (face[c] != face[c == 0 ? face.size() - 1 : c - 1]) out.push_back(face[c]);
  }
}

}  // namespace

Triangulation triangulate(const Mesh& mesh, const TriangulateOptions& options) {
  std::size_t most = 0;
  for (Index f = 0; f < mesh.face_count(); ++f) most += std::max<std::size_t>(mesh.faces[f].size(), 2) - 2;
  Triangulation result;
  result.triangles.resize(static_cast<Eigen::Index>(most), 3);
  result.face.reserve(most);
  std::vector<Index> face;
  const auto add = [&](Index f, const Corners& corners) {
    const auto row = static_cast<Eigen::Index>(result.face.size());
    for (int c = 0; c < 3; ++c) result.triangles(row, c) = face[corners[static_cast<std::size_t>(c)]];
    result.face.push_back(f);
  };
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!refers_to_vertices(mesh, f, options)) continue;
    drop_repeats(mesh.faces[f], face);
    if (face.size() == 3) add(f, {0, 1, 2});
    if (face.size() <= 3) continue;
    for (const Corners& corners : split(face, mesh.positions)) add(f, corners);
  }
  result.triangles.conservativeResize(static_cast<Eigen::Index>(result.face.size()), Eigen::NoChange);
  return result;
}

}  // namespace meshgraft
