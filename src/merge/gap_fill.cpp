#include "gap_fill.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace meshgraft {

namespace {

// Compares costs of 0 and more. Those that differ by rounding alone are equal, so that a symmetric seam does
// not depend on the pose of the source.
bool is_less(double a, double b) { return a < b * (1 - 1e-9); }

// One loop of a gap, opened at a start vertex.
struct Side {
  Points points;   // n+1×3, from the start vertex on, which is repeated at the end
  Points normals;  // n×3, unit normals of the faces beyond the edges
  std::vector<Index> vertices;
  Index edges() const { return static_cast<Index>(normals.rows()); }
};

Side opened_at(const GapSide& side, Index start) {
  const auto n = static_cast<Index>(side.loop.size());
  Side result{Points(n + 1, 3), Points(n, 3), {}};
  for (Index k = 0; k <= n; ++k) {
    const Index at = (start + k) % n;
    result.points.row(k) = side.points.row(at);
    result.vertices.push_back(side.loop[at]);
    if (k < n) result.normals.row(k) = side.face_normals.row(at);
  }
  return result;
}

enum Move : std::uint8_t { on_first, on_second };

struct Candidate {
  double cost = 0;
  Eigen::RowVector3d normal;
};

// Returns the cost of the fold between two unit normals: 0 where flat. The weight makes a right angle about
// as bad as a triangle of 12°, 12° and 156°.
double fold_cost(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
  constexpr double weight = 6;
  const double cosine = a.dot(b);
  return weight * (std::isfinite(cosine) ? 1 - cosine : 2);  // 2 where a normal is not finite
}

// Returns the cost of a triangle. It is the sum of its angles' cotangents (the harmonic index), which
// Delaunay triangulations minimise, plus the cost of the fold towards the surface beyond its edge.
Candidate candidate(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b, const Eigen::RowVector3d& c,
                    const Eigen::RowVector3d& beyond) {
  constexpr double worst = 1e6;                          // of a triangle without area
  const Eigen::RowVector3d area = (b - a).cross(c - a);  // twice the area
  const double length = area.norm();
  const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  if (!(2 * length * worst > squares)) return {worst, Eigen::RowVector3d::Zero()};
  const Eigen::RowVector3d normal = area / length;
  return {squares / (2 * length) + fold_cost(normal, beyond), normal};
}

// The strips between two opened loops are the monotone paths on a grid. At (i, j) the strip ends with the
// cross edge between vertex i of the first loop and vertex j of the second.
class Gap {
 public:
  Gap(Side first, Side second) : first_(std::move(first)), second_(std::move(second)) {}

  Candidate next(Move move, Index i, Index j) const {
    if (move == on_first) {
      return candidate(first_.points.row(i + 1), first_.points.row(i), second_.points.row(j),
                       first_.normals.row(i));
    }
    return candidate(second_.points.row(j), second_.points.row(j + 1), first_.points.row(i),
                     second_.normals.row(j));
  }

  /// Returns whether a strip may pass (i, j). A strip must not go round one whole loop at a single vertex of
  /// the other, because that would use a cross edge twice. Therefore no row and no column may be traversed
  /// completely.
  bool is_strip(Index i, Index j) const {
    const Index n = first_.edges(), m = second_.edges();
    if (i > n || j > m) return false;
    const bool late_in_first = 2 * i > n, late_in_second = 2 * j > m;
    return !(i == 0 && late_in_second) && !(i == n && !late_in_second) && !(j == 0 && late_in_first) &&
           !(j == m && !late_in_first);
  }

  std::vector<Move> greedy() const;
  std::vector<Move> optimal(const Eigen::RowVector3d& normal_before, const Context& context) const;
  std::vector<std::array<Index, 3>> triangles(const std::vector<Move>& moves) const;

 private:
  std::vector<std::array<Index, 2>> windows() const;

  Side first_, second_;
};

std::vector<Move> Gap::greedy() const {
  std::vector<Move> moves;
  for (Index i = 0, j = 0; i < first_.edges() || j < second_.edges();) {
    Move move = is_strip(i + 1, j) ? on_first : on_second;
    if (is_strip(i + 1, j) && is_strip(i, j + 1)) {
      const double over_first = (first_.points.row(i + 1) - second_.points.row(j)).squaredNorm();
      const double over_second = (first_.points.row(i) - second_.points.row(j + 1)).squaredNorm();
      if (is_less(over_second, over_first)) move = on_second;
    }
    moves.push_back(move);
    ++(move == on_first ? i : j);
  }
  return moves;
}

// Returns, per vertex of the first loop, the range of vertices of the second that it may meet. The range is
// the whole loop; for large loops, the vertices near the same fraction of the length.
std::vector<std::array<Index, 2>> Gap::windows() const {
  constexpr Index cells = 1 << 20;
  const Index n = first_.edges(), m = second_.edges();
  const Index half = std::max<Index>(32, cells / (2 * (n + 1)));
  const auto fractions = [](const Points& points) {
    std::vector<double> length{0};
    for (Eigen::Index k = 1; k < points.rows(); ++k) {
      length.push_back(length.back() + (points.row(k) - points.row(k - 1)).norm());
    }
    for (double& value : length) value /= std::max(length.back(), std::numeric_limits<double>::min());
    return length;
  };
  const std::vector<double> s = fractions(first_.points), t = fractions(second_.points);
  std::vector<std::array<Index, 2>> result;
  for (Index i = 0; i <= n; ++i) {
    const auto centre = static_cast<Index>(std::lower_bound(t.begin(), t.end(), s[i]) - t.begin());
    result.push_back({std::max<Index>(0, centre - half), std::min(m, centre + half)});
  }
  result.front()[0] = 0;
  result.back()[1] = m;
  for (Index i = 0; i < n; ++i) result[i][1] = std::max(result[i][1], result[i + 1][0]);
  return result;
}

std::vector<Move> Gap::optimal(const Eigen::RowVector3d& normal_before, const Context& context) const {
  struct State {
    double cost = std::numeric_limits<double>::infinity();
    Eigen::RowVector3d normal = Eigen::RowVector3d::Zero();
    Move before = on_first;  // the move before the last one
  };
  using Cell = std::array<State, 2>;  // indexed by the last move
  const Index n = first_.edges(), m = second_.edges();
  const std::vector<std::array<Index, 2>> window = windows();
  std::vector<std::size_t> row_begin{0};
  for (const auto& [low, high] : window) {
    row_begin.push_back(row_begin.back() + (high - low + 1));
  }
  std::vector<std::array<Move, 2>> before(row_begin.back());

  // Each cell holds, for each last move, the least cost of a strip that ends at the cell.
  std::vector<Cell> row(m + 1), next_row(row.size());
  row[0][on_first] = {0, normal_before, on_first};
  const auto relax = [&](Cell& to, Move move, const Cell& from, const Candidate& triangle) {
    for (const Move last : {on_first, on_second}) {
      const double cost = from[last].cost + triangle.cost + fold_cost(from[last].normal, triangle.normal);
      if (is_less(cost, to[move].cost)) to[move] = {cost, triangle.normal, last};
    }
  };
  for (Index i = 0; i <= n; ++i) {
    if (i % 64 == 0) context.throw_if_stopped();
    const auto [low, high] = window[i];
    if (i < n) {
      std::fill(next_row.begin() + window[i + 1][0], next_row.begin() + window[i + 1][1] + 1, Cell{});
    }
    for (Index j = low; j <= high; ++j) {
      const Cell& cell = row[j];
      before[row_begin[i] + (j - low)] = {cell[on_first].before, cell[on_second].before};
      if (j < high && is_strip(i, j + 1)) relax(row[j + 1], on_second, cell, next(on_second, i, j));
      if (i < n && j >= window[i + 1][0] && is_strip(i + 1, j)) {
        relax(next_row[j], on_first, cell, next(on_first, i, j));
      }
    }
    if (i < n) std::swap(row, next_row);
  }

  std::vector<Move> moves;
  Move last = is_less(row[m][on_second].cost, row[m][on_first].cost) ? on_second : on_first;
  for (Index i = n, j = m; i > 0 || j > 0;) {
    moves.push_back(last);
    const Move previous = before[row_begin[i] + (j - window[i][0])][last];
    --(last == on_first ? i : j);
    last = previous;
  }
  std::reverse(moves.begin(), moves.end());
  return moves;
}

std::vector<std::array<Index, 3>> Gap::triangles(const std::vector<Move>& moves) const {
  std::vector<std::array<Index, 3>> result;
  Index i = 0, j = 0;
  for (const Move move : moves) {
    if (move == on_first) {
      result.push_back({first_.vertices[i + 1], first_.vertices[i], second_.vertices[j]});
      ++i;
    } else {
      result.push_back({second_.vertices[j], second_.vertices[j + 1], first_.vertices[i]});
      ++j;
    }
  }
  return result;
}

std::array<Index, 2> closest_pair(const Points& first, const Points& second) {
  std::array<Index, 2> best{0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < static_cast<Index>(first.rows()); ++i) {
    for (Index j = 0; j < static_cast<Index>(second.rows()); ++j) {
      const double distance = (first.row(i) - second.row(j)).squaredNorm();
      if (is_less(distance, least)) {
        least = distance;
        best = {i, j};
      }
    }
  }
  return best;
}

}  // namespace

std::vector<std::array<Index, 3>> fill_gap(const GapSide& first, const GapSide& second, StripMethod method,
                                           const Context& context) {
  const auto [i, j] = closest_pair(first.points, second.points);
  const Gap gap(opened_at(first, i), opened_at(second, j));
  if (method == StripMethod::greedy) return gap.triangles(gap.greedy());

  // The first pass fixes the cross edge at the closest pair, which need not be optimal. The second pass starts
  // at the cross edge halfway round, which the first pass chose.
  const std::vector<Move> moves = gap.optimal(Eigen::RowVector3d::Zero(), context);
  Index di = 0, dj = 0;
  Eigen::RowVector3d normal = Eigen::RowVector3d::Zero();
  for (std::size_t k = 0; k < moves.size() / 2; ++k) {
    normal = gap.next(moves[k], di, dj).normal;
    ++(moves[k] == on_first ? di : dj);
  }
  const auto n = static_cast<Index>(first.loop.size()), m = static_cast<Index>(second.loop.size());
  const Gap turned(opened_at(first, (i + di) % n), opened_at(second, (j + dj) % m));
  return turned.triangles(turned.optimal(normal, context));
}

}  // namespace meshgraft
