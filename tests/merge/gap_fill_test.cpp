#include "merge/gap_fill.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "merge/closed_curves.h"

namespace meshgraft {
namespace {

using Triangle = std::array<Index, 3>;

constexpr StripMethod strip_methods[] = {StripMethod::greedy, StripMethod::optimal};

/// Two loops with a gap between them. The surfaces are walls below the first and above the second.
struct GapCase {
  std::string name;
  GapSide first, second;
};

/// Returns a loop whose surface goes away from it along `away`. `first` is the index of its first vertex.
GapSide gap_side(const Points& clockwise, Index first, double away) {
  GapSide side;
  const Eigen::Index n = clockwise.rows();
  side.points = clockwise;
  side.face_normals.resize(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    side.loop.push_back(first + static_cast<Index>(k));
    const Eigen::RowVector3d edge = clockwise.row((k + 1) % n) - clockwise.row(k);
    const Eigen::RowVector3d wall(0, 0, away);
    side.face_normals.row(k) = (away < 0 ? edge.cross(wall) : wall.cross(edge)).normalized();
    if (away > 0) side.face_normals.row(k) *= -1;
  }
  for (Eigen::Index k = 0; k < n; ++k) {  // outward, whatever the slope of the edge
    const Eigen::RowVector3d radial(clockwise(k, 0), clockwise(k, 1), 0);
    if (side.face_normals.row(k).dot(radial) < 0) side.face_normals.row(k) *= -1;
  }
  return side;
}

GapCase gap_between(const std::string& name, const Points& low, const Points& high) {
  const Points below = low.colwise().reverse(), above = high.colwise().reverse();
  return {name, gap_side(below, 0, -1), gap_side(above, static_cast<Index>(low.rows()), 1)};
}

/// Returns gaps between curves of equal and different numbers of points, near and far, level and tilted.
std::vector<GapCase> gap_cases() {
  std::vector<GapCase> cases;
  const auto curves = test::closed_curves();
  const auto at_height = [](Points points, double z, double tilt) {
    points.col(2) += (z + tilt * points.col(0).array()).matrix();
    return points;
  };
  for (std::size_t a = 0; a < curves.size(); ++a)
    for (const std::size_t b : {a, (a + 1) % curves.size(), (a + 5) % curves.size()})
      for (const double height : {0.3, 1.5}) {
        const double tilt = height > 1 ? 0.4 : 0.05;
        cases.push_back(gap_between(curves[a].name + " to " + curves[b].name, curves[a].points,
                                    at_height(test::rotated_rows(curves[b].points, 2), height + 0.6, tilt)));
      }
  return cases;
}

std::map<std::pair<Index, Index>, int> half_edges(const std::vector<Triangle>& triangles) {
  std::map<std::pair<Index, Index>, int> count;
  for (const Triangle& t : triangles)
    for (int c = 0; c < 3; ++c) ++count[{t[c], t[(c + 1) % 3]}];
  return count;
}

TEST(GapFill, IsAnAnnulusThatUsesEachEdgeOfBothLoopsOnce) {
  for (const GapCase& gap : gap_cases())
    for (const StripMethod method : strip_methods) {
      SCOPED_TRACE(gap.name);
      const std::vector<Triangle> strip = fill_gap(gap.first, gap.second, method, {});
      const std::size_t n = gap.first.loop.size(), m = gap.second.loop.size();
      ASSERT_EQ(strip.size(), n + m);
      auto edges = half_edges(strip);
      std::size_t border = 0;
      for (std::size_t k = 0; k < n; ++k)  // against the mesh's own half-edges
        border += edges.erase({gap.first.loop[(k + 1) % n], gap.first.loop[k]});
      for (std::size_t k = 0; k < m; ++k)
        border += edges.erase({gap.second.loop[k], gap.second.loop[(k + 1) % m]});
      EXPECT_EQ(border, n + m);
      // Every other half-edge has its opposite once: consistently oriented, and V − E + F = 0.
      EXPECT_EQ(edges.size(), 2 * (n + m));
      for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_TRUE(edges.contains({edge.second, edge.first}));
      }
    }
}

TEST(GapFill, TrianglesHaveAnEdgeOfOneLoopAndAVertexOfTheOther) {
  for (const GapCase& gap : gap_cases())
    for (const StripMethod method : strip_methods)
      for (const Triangle& t : fill_gap(gap.first, gap.second, method, {})) {
        const auto n = static_cast<Index>(gap.first.loop.size());
        const auto of_first = std::count_if(t.begin(), t.end(), [&](Index v) { return v < n; });
        EXPECT_TRUE(of_first == 1 || of_first == 2) << gap.name;
      }
}

std::set<Triangle> as_set(const std::vector<Triangle>& triangles, const std::function<Index(Index)>& renamed,
                          bool reversed = false) {
  std::set<Triangle> result;
  for (Triangle t : triangles) {
    for (Index& v : t) v = renamed(v);
    if (reversed) std::swap(t[0], t[1]);
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    result.insert(t);
  }
  return result;
}

Index same(Index v) { return v; }

GapSide rotated(const GapSide& side, Index shift) {
  GapSide result = side;
  std::rotate(result.loop.begin(), result.loop.begin() + shift, result.loop.end());
  result.points = test::rotated_rows(side.points, shift);
  result.face_normals = test::rotated_rows(side.face_normals, shift);
  return result;
}

TEST(GapFill, DoesNotDependOnTheStartsOfTheLoops) {
  for (const GapCase& gap : gap_cases())
    for (const StripMethod method : strip_methods) {
      const auto strip = fill_gap(gap.first, gap.second, method, {});
      const auto other = fill_gap(rotated(gap.first, 3), rotated(gap.second, 2), method, {});
      EXPECT_EQ(as_set(strip, same), as_set(other, same)) << gap.name;
    }
}

TEST(GapFill, FollowsSimilarities) {
  for (const GapCase& gap : gap_cases())
    for (const StripMethod method : strip_methods)
      for (const Eigen::Affine3d& map : test::similarities()) {
        const auto moved = [&](GapSide side) {
          side.points = test::mapped(side.points, map);
          side.face_normals = (side.face_normals * map.linear().transpose()).rowwise().normalized();
          return side;
        };
        EXPECT_EQ(as_set(fill_gap(moved(gap.first), moved(gap.second), method, {}), same),
                  as_set(fill_gap(gap.first, gap.second, method, {}), same))
            << gap.name;
      }
}

/// Returns the mirror image of a side, listed the other way round, so that its mesh has been turned over.
GapSide mirrored(const GapSide& side) {
  GapSide result = side;
  const auto n = static_cast<Eigen::Index>(side.loop.size());
  for (Eigen::Index k = 0; k < n; ++k) {
    result.loop[k] = side.loop[n - 1 - k];
    result.points.row(k) = side.points.row(n - 1 - k).cwiseProduct(Eigen::RowVector3d(-1, 1, 1));
    // Edge k of the reversed loop is edge n − 2 − k of the given one.
    result.face_normals.row(k) =
        side.face_normals.row((2 * n - 2 - k) % n).cwiseProduct(Eigen::RowVector3d(-1, 1, 1));
  }
  return result;
}

/// Computes the cost of a strip from its definition: harmonic indices, and folds at all its edges.
double strip_cost(const GapCase& gap, const std::vector<Triangle>& strip) {
  const auto n = static_cast<Index>(gap.first.loop.size()), m = static_cast<Index>(gap.second.loop.size());
  const auto point = [&](Index v) -> Eigen::RowVector3d {
    return v < n ? gap.first.points.row(v) : gap.second.points.row(v - n);
  };
  std::map<std::pair<Index, Index>, Eigen::RowVector3d> beside;
  for (Index k = 0; k < n; ++k) beside[{k, (k + 1) % n}] = gap.first.face_normals.row(k);
  for (Index k = 0; k < m; ++k) beside[{n + (k + 1) % m, n + k}] = gap.second.face_normals.row(k);
  double cost = 0;
  for (const Triangle& t : strip) {
    const Eigen::RowVector3d a = point(t[0]), b = point(t[1]), c = point(t[2]), area = (b - a).cross(c - a);
    cost += ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm()) / (2 * area.norm());
    for (int k = 0; k < 3; ++k) beside[{t[k], t[(k + 1) % 3]}] = area.normalized();
  }
  for (const auto& [edge, normal] : beside)
    if (edge.first < edge.second) cost += 6 * (1 - normal.dot(beside.at({edge.second, edge.first})));
  return cost;
}

// The cross edge at which the second pass begins is chosen by the first, so that the strip there is the best
// only nearly.
constexpr double nearly = 0.05;

TEST(GapFill, OfTheMirrorImageIsNearlyTheMirrorImage) {
  const auto gaps = gap_cases();
  std::size_t equal = 0;
  for (const GapCase& gap : gaps) {
    const GapCase image{gap.name, mirrored(gap.first), mirrored(gap.second)};
    const auto strip = fill_gap(gap.first, gap.second, StripMethod::optimal, {});
    const auto other = fill_gap(image.first, image.second, StripMethod::optimal, {});
    equal += as_set(other, same) == as_set(strip, same, true);
    std::vector<Triangle> back = other;  // the mirror image's strip, mirrored again
    for (Triangle& t : back) std::swap(t[0], t[1]);
    EXPECT_NEAR(strip_cost(gap, back) / strip_cost(gap, strip), 1, nearly) << gap.name;
  }
  EXPECT_GT(equal, gaps.size() * 4 / 5);
}

TEST(GapFill, OptimalCostsNoMoreThanGreedy) {
  int better = 0;
  for (const GapCase& gap : gap_cases()) {
    const double greedy = strip_cost(gap, fill_gap(gap.first, gap.second, StripMethod::greedy, {}));
    const double optimal = strip_cost(gap, fill_gap(gap.first, gap.second, StripMethod::optimal, {}));
    EXPECT_LE(optimal, greedy * (1 + 1e-12)) << gap.name;
    better += optimal < 0.999 * greedy;
  }
  EXPECT_GT(better, 10);
}

TEST(GapFill, OptimalCanHardlyBeImprovedByFlippingAnEdge) {
  for (const GapCase& gap : gap_cases()) {
    std::vector<Triangle> strip = fill_gap(gap.first, gap.second, StripMethod::optimal, {});
    const double cost = strip_cost(gap, strip);
    const auto n = static_cast<Index>(gap.first.loop.size());
    for (std::size_t k = 0; k < strip.size(); ++k) {
      // Two neighbours with edges of different loops form a quadrilateral; the other diagonal is the rival.
      const std::size_t l = (k + 1) % strip.size();
      std::vector<Triangle> rival = strip;
      const auto of_first = [&](const Triangle& t) { return t[1] < n && t[0] < n; };
      if (of_first(strip[k]) == of_first(strip[l])) continue;
      const Triangle &first = of_first(strip[k]) ? strip[k] : strip[l],
                     &second = of_first(strip[k]) ? strip[l] : strip[k];
      const bool first_comes_first = of_first(strip[k]);
      rival[k] = first_comes_first ? Triangle{second[0], second[1], first[1]}
                                   : Triangle{first[0], first[1], second[0]};
      rival[l] = first_comes_first ? Triangle{first[0], first[1], second[1]}
                                   : Triangle{second[0], second[1], first[0]};
      const auto edges = half_edges(rival);
      if (std::any_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second != 1; })) continue;
      EXPECT_GE(strip_cost(gap, rival), cost * (1 - nearly)) << gap.name;
    }
  }
}

}  // namespace
}  // namespace meshgraft
