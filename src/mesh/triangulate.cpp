#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

namespace {

using Polygon = std::vector<Eigen::Vector2d>;
using Corners = std::array<Index, 3>;  // positions within one face

constexpr double flat_rel = 1e-12;  // twice an area below this × longest edge² counts as none

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return cross(b - a, c - a);
}

double longest_edge_squared(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
}

// Twice the area over the longest edge squared: 0.87 for an equilateral triangle, negative for a reflex corner.
double shape(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double size = longest_edge_squared(a, b, c);
  return size > 0 ? turn(a, b, c) / size : 0;
}

// Whether q lies in the closed triangle. A point on one of its corners does not (polygons may touch
// themselves).
bool covers(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
            const Eigen::Vector2d& q) {
  if (q == a || q == b || q == c) return false;
  const double slack = -flat_rel * longest_edge_squared(a, b, c);
  return turn(a, b, q) >= slack && turn(b, c, q) >= slack && turn(c, a, q) >= slack;
}

// The polygon in the plane of Newell's normal, counter-clockwise, about its first corner; empty where it has no
// area and so no plane.
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
  // Rounding must not decide between equal diagonals, or a turned scene would be split differently.
  constexpr double tie = 1 - 1e-9;
  if (second < tie * first) {
    out.insert(out.end(), {Corners{0, 1, 3}, Corners{1, 2, 3}});
  } else {
    out.insert(out.end(), {Corners{0, 1, 2}, Corners{0, 2, 3}});
  }
}

class EarClip {
 public:
  explicit EarClip(const Polygon& polygon)
      : polygon_(polygon), left_(polygon.size()), quality_(polygon.size()) {
    for (std::size_t c = 0; c < left_.size(); ++c) left_[c] = static_cast<Index>(c);
    for (std::size_t c = 0; c < left_.size(); ++c) rate(c);
  }

  void clip(std::vector<Corners>& out) {
    while (left_.size() > 3) {
      const auto best =
          static_cast<std::size_t>(std::max_element(quality_.begin(), quality_.end()) - quality_.begin());
      out.push_back({left_[before(best)], left_[best], left_[after(best)]});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(best));
      quality_.erase(quality_.begin() + static_cast<std::ptrdiff_t>(best));
      const std::size_t following = best % left_.size();
      rate(following);
      rate(before(following));
    }
    out.push_back({left_[0], left_[1], left_[2]});
  }

 private:
  std::size_t before(std::size_t c) const { return (c + left_.size() - 1) % left_.size(); }
  std::size_t after(std::size_t c) const { return (c + 1) % left_.size(); }

  // How good an ear corner c is. Ears come first, the best-shaped leading; then corners on a straight line, for
  // a triangle without area is better than one outside; then whatever a tangled polygon leaves, so that the
  // loop always ends.
  void rate(std::size_t c) {
    const auto& [a, b, d] = std::tie(polygon_[left_[before(c)]], polygon_[left_[c]], polygon_[left_[after(c)]]);
    const double s = shape(a, b, d);
    if (s > flat_rel && !blocked(c)) {
      quality_[c] = s;
    } else {
      quality_[c] = -1 - (s > flat_rel ? 1 : std::abs(s));
    }
  }

  bool blocked(std::size_t c) const {
    const auto& [a, b, d] = std::tie(polygon_[left_[before(c)]], polygon_[left_[c]], polygon_[left_[after(c)]]);
    for (const Index q : left_) {
      if (covers(a, b, d, polygon_[q])) return true;
    }
    return false;
  }

  const Polygon& polygon_;
  std::vector<Index> left_;      // corners not yet clipped, in order
  std::vector<double> quality_;  // of each as an ear
};

std::vector<Corners> split(const std::vector<Index>& face, const Points& positions) {
  if (face.size() == 3) return {{0, 1, 2}};
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

bool in_range(const Mesh& mesh, Index face, const TriangulateOptions& options) {
  for (const Index v : mesh.faces[face]) {
    if (v >= 0 && v < mesh.vertex_count()) continue;
    if (options.skip_out_of_range) return false;
    throw Error(ErrorCode::input,
                "index " + std::to_string(v) + " is not one of the " + std::to_string(mesh.vertex_count()) +
                    " vertices",
                "face " + std::to_string(face), "Repair or remove the face.");
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
  std::vector<Corners> triangles;
  Triangulation result;
  std::vector<Index> face;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!in_range(mesh, f, options)) continue;
    drop_repeats(mesh.faces[f], face);
    if (face.size() < 3) continue;
    for (const Corners& corners : split(face, mesh.positions)) {
      triangles.push_back({face[corners[0]], face[corners[1]], face[corners[2]]});
      result.face.push_back(f);
    }
  }
  result.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) result.triangles(static_cast<Eigen::Index>(t), c) = triangles[t][c];
  }
  return result;
}

}  // namespace meshgraft
