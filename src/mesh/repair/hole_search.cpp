#include "hole_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "core/parallel.h"
#include "mesh/face_defects.h"

namespace meshgraft {

namespace {

using Direction = Eigen::Vector2d;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double no_cap = 5;             // above the largest bend, which is 4
constexpr double bend_floor = 2.5e-19;   // (5e-10 rad)²: smaller bends count as none
constexpr double bend_rel = 1e-10;       // relative tolerance for equal bends
constexpr double length_weight = 1e-13;  // of squared chord lengths, added to areas to break ties
constexpr double flat_penalty = 1e6;     // × the loop's size squared, for a triangle without area

// A candidate triangle on the inner side of a side, and the cost of the best triangulation below it.
struct Tip {
  Direction direction;  // to the apex, seen along the side; zero if the triangle has no area
  double cost;
  Index apex;
  Index left, right;  // the sides from the side's ends to the apex
};

// An edge of the loop or a chord, from the smaller index to the larger.
struct Side {
  Index from, to;
  Eigen::Vector3d across, up;  // a basis of the plane across the side
  std::vector<Tip> tips;
};

bool is_none(const Direction& direction) { return direction[0] == 0 && direction[1] == 0; }

// Returns 4 sin²(φ/2) for the angle φ between the normals of two triangles on the two sides of an edge. The
// value orders angles as φ does, and is precise for small angles.
double bend(const Direction& inner, const Direction& outer) {
  if (is_none(inner) || is_none(outer)) return 0;
  const double result = (inner + outer).squaredNorm();
  return result > bend_floor ? result : 0;
}

struct Link {
  Index vertex, side;
};

class Search {
 public:
  Search(const HoleLoop& loop, std::span<const HoleChord> chords, const Context& context)
      : loop_(loop), context_(context), n_(loop.size()) {
    sides_.reserve(static_cast<std::size_t>(n_) + chords.size());
    for (Index k = 0; k + 1 < n_; ++k) add_side(k, k + 1);
    add_side(0, n_ - 1);
    for (const HoleChord& chord : chords) add_side(chord[0], chord[1]);
    sort_by_length();
    measure_loop();
  }

  std::vector<HoleTriangle> run(HoleAim aim) {
    for (const bool flat_too : {false, true}) {
      may_be_flat_ = flat_too;
      std::vector<HoleTriangle> triangles = aim == HoleAim::smooth ? smooth()
                                            : aim == HoleAim::area ? least_area()
                                                                   : least_angle();
      if (!triangles.empty()) return triangles;
    }
    return {};
  }

 private:
  void add_side(Index from, Index to) {
    Side side{from, to, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), {}};
    const Eigen::Vector3d along = point(to) - point(from);
    if (const double length = along.norm(); length > 0) {
      side.across = (along / length).unitOrthogonal();
      side.up = (along / length).cross(side.across);
    }
    sides_.push_back(std::move(side));
  }

  void sort_by_length() {
    of_length_.resize(n_);
    for (Index s = 0; s < static_cast<Index>(sides_.size()); ++s)
      of_length_[sides_[s].to - sides_[s].from].push_back(s);
  }

  void measure_loop() {
    const Eigen::RowVector3d extent = loop_.points.colwise().maxCoeff() - loop_.points.colwise().minCoeff();
    size_squared_ = extent.squaredNorm();
    largest_ = loop_.points.cwiseAbs().maxCoeff();
    beyond_.assign(n_, Direction::Zero());
    if (loop_.beyond.rows() == 0) return;
    for (Index k = 0; k < n_; ++k) {
      const Eigen::Vector3d corner = loop_.beyond.row(k).transpose();
      const Eigen::Vector3d a = point(k), b = point((k + 1) % n_);
      if (corner.allFinite() && !is_flat(a, b, corner)) beyond_[k] = direction_to(sides_[k], corner);
    }
  }

  Eigen::Vector3d point(Index k) const { return loop_.points.row(k).transpose(); }
  bool is_loop_edge(Index side) const { return side < n_ - 1; }  // not the last: the hole is inside it

  // Flat triangles are avoided because a repair would remove them again.
  bool is_flat(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) const {
    return has_no_area(a, b, c, largest_);
  }

  Direction direction_to(const Side& side, const Eigen::Vector3d& corner) const {
    const Eigen::Vector3d offset = corner - point(side.from);
    Direction direction(offset.dot(side.across), offset.dot(side.up));
    const double length = direction.norm();
    return length > 0 ? Direction(direction / length) : Direction::Zero();
  }

  // Returns a lower bound on the largest bend of any triangulation, because every edge of the loop has a
  // triangle.
  double least_bend() const {
    std::vector<std::vector<Index>> neighbours(n_);
    for (const Side& side : sides_) {
      neighbours[side.from].push_back(side.to);
      neighbours[side.to].push_back(side.from);
    }
    for (auto& list : neighbours) std::sort(list.begin(), list.end());
    std::vector<double> least(n_, infinity);
    parallel_blocks(
        n_,
        [&](std::size_t begin, std::size_t end) {
          std::vector<Index> apexes;
          for (std::size_t k = begin; k < end; ++k) {
            const Side& side = sides_[k];
            apexes.clear();
            std::set_intersection(neighbours[side.from].begin(), neighbours[side.from].end(),
                                  neighbours[side.to].begin(), neighbours[side.to].end(),
                                  std::back_inserter(apexes));
            for (const Index apex : apexes) {
              const bool flat = is_flat(point(side.from), point(side.to), point(apex));
              if (flat && !may_be_flat_) continue;
              const double here = flat ? 0 : bend(direction_to(side, point(apex)), beyond_[k]);
              least[k] = std::min(least[k], here);
            }
          }
        },
        context_, 64);
    return std::max(bend_floor, *std::max_element(least.begin(), least.end()));
  }

  // A cap on the bends keeps the search small. The cap starts a little above the lower bound and grows until
  // a triangulation is found.
  std::vector<HoleTriangle> least_angle() {
    const double least = least_bend();
    if (least == infinity) return {};
    const double angle = 2 * std::asin(std::min(1.0, std::sqrt(least) / 2));
    for (double more = 0.05;; more *= 3) {
      const bool last = angle + more >= std::numbers::pi;
      const double cap = last ? no_cap : 4 * std::pow(std::sin((angle + more) / 2), 2);
      const double largest = smallest_bend(least, cap);
      if (largest < infinity) return smallest_area(largest);
      if (last) return {};
    }
  }

  std::vector<HoleTriangle> least_area() {
    return smallest_bend(no_cap, no_cap) < infinity ? smallest_area(no_cap) : std::vector<HoleTriangle>{};
  }

  std::vector<HoleTriangle> smooth() {
    gather_all([&](Side& side) {
      gather_tips(
          side, std::numeric_limits<double>::max(),
          [&](Index below, const Direction& outer) { return smoothest(below, outer).second; }, std::plus<>());
    });
    return trace([&](Index side, const Direction& outer) { return smoothest(side, outer).first; });
  }

  // Visits the sides from short to long. A side that gets no triangle is not available to longer ones.
  template <class Gather>
  void gather_all(const Gather& gather) {
    from_.assign(n_, {});
    to_.assign(n_, {});
    for (Index length = 1; length < n_; ++length) {
      const std::vector<Index>& level = of_length_[length];
      for_each_side(level, [&](Side& side) {
        side.tips.clear();
        if (length > 1) gather(side);
      });
      for (const Index s : level) {
        if (length > 1 && sides_[s].tips.empty()) continue;
        from_[sides_[s].from].push_back({sides_[s].to, s});
        to_[sides_[s].to].push_back({sides_[s].from, s});
      }
    }
  }

  // Returns the smallest possible largest bend of a triangulation, at least `least`, or infinity if it
  // exceeds the cap. Leaves at each side the triangles whose triangulation below them stays within the cap.
  double smallest_bend(double least, double cap) {
    const auto below = [&](Index side, const Direction& outer) {
      if (is_loop_edge(side)) return std::max(least, bend(beyond_[side], outer));
      double best = infinity;
      for (const Tip& tip : sides_[side].tips) {
        if (tip.cost >= best) break;
        best = std::min(best, std::max(tip.cost, bend(tip.direction, outer)));
      }
      return best;
    };
    gather_all([&](Side& side) {
      gather_tips(side, cap, below, [](double left, double right) { return std::max(left, right); });
    });
    double best = infinity;
    for (const Tip& tip : sides_[n_ - 1].tips)
      best = std::min(best, std::max(tip.cost, bend(tip.direction, beyond_[n_ - 1])));
    return best <= cap ? best : infinity;
  }

  // Returns the triangle on a side with the least bending, including the triangulation below it, and that
  // cost.
  std::pair<const Tip*, double> smoothest(Index s, const Direction& outer) const {
    const Side& side = sides_[s];
    const double length = (point(side.to) - point(side.from)).norm();
    std::pair<const Tip*, double> best{nullptr, infinity};
    if (is_loop_edge(s)) best.second = length * bend(beyond_[s], outer);
    for (const Tip& tip : side.tips) {
      if (tip.cost >= best.second) break;
      const double cost = tip.cost + length * bend(tip.direction, outer);
      if (cost < best.second) best = {&tip, cost};
    }
    return best;
  }

  // Gathers the triangles on a side from the shorter sides, sorted by cost.
  template <class Below, class Join>
  void gather_tips(Side& side, double cap, const Below& below, const Join& join) const {
    const std::vector<Link>& out = from_[side.from];
    const std::vector<Link>& in = to_[side.to];
    auto left = out.begin();
    auto right = in.rbegin();  // reversed, so ascending too
    while (left != out.end() && right != in.rend()) {
      if (left->vertex < right->vertex) {
        ++left;
      } else if (right->vertex < left->vertex) {
        ++right;
      } else {
        add_tip(side,
                {.direction = {}, .cost = 0, .apex = left->vertex, .left = left->side, .right = right->side},
                cap, below, join);
        ++left;
        ++right;
      }
    }
    sort_tips(side);
  }

  template <class Below, class Join>
  void add_tip(Side& side, Tip tip, double cap, const Below& below, const Join& join) const {
    const Eigen::Vector3d from = point(side.from), to = point(side.to), apex = point(tip.apex);
    const bool flat = is_flat(from, to, apex);
    if (flat && !may_be_flat_) return;
    const Direction none = Direction::Zero();
    const double left = below(tip.left, flat ? none : direction_to(sides_[tip.left], to));
    if (!(left <= cap)) return;
    const double right = below(tip.right, flat ? none : direction_to(sides_[tip.right], from));
    tip.cost = join(left, right);
    if (!(tip.cost <= cap)) return;
    tip.direction = flat ? none : direction_to(side, apex);
    side.tips.push_back(tip);
  }

  static void sort_tips(Side& side) {
    std::sort(side.tips.begin(), side.tips.end(),
              [](const Tip& a, const Tip& b) { return a.cost != b.cost ? a.cost < b.cost : a.apex < b.apex; });
  }

  template <class Visit>
  void for_each_side(const std::vector<Index>& level, const Visit& visit) {
    constexpr std::size_t grain = 64;  // with fewer sides, threads cost more than they save
    parallel_blocks(
        level.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) visit(sides_[level[k]]);
        },
        context_, grain);
  }

  // Returns the first triangle on a side whose bend against the outside is within the limit.
  const Tip* first_within(Index side, const Direction& outer) const {
    for (const Tip& tip : sides_[side].tips)
      if (bend(tip.direction, outer) <= limit_) return &tip;
    return nullptr;
  }

  // Returns the triangulation with the smallest area among those with the smallest largest bend.
  std::vector<HoleTriangle> smallest_area(double largest) {
    limit_ = std::max(bend_floor, largest * (1 + bend_rel));
    const auto below = [&](Index side, const Direction& outer) {
      if (is_loop_edge(side)) return bend(beyond_[side], outer) <= limit_ ? 0 : infinity;
      const Tip* tip = first_within(side, outer);
      return tip ? tip->cost : infinity;
    };
    for (Index length = 2; length < n_; ++length)
      for_each_side(of_length_[length], [&](Side& side) {
        const Eigen::Vector3d from = point(side.from), to = point(side.to);
        std::erase_if(side.tips, [&](const Tip& tip) { return tip.cost > limit_; });
        for (Tip& tip : side.tips) {
          const Eigen::Vector3d apex = point(tip.apex);
          const bool flat = is_none(tip.direction);
          const Direction none = Direction::Zero();
          tip.cost = below(tip.left, flat ? none : direction_to(sides_[tip.left], to)) +
                     below(tip.right, flat ? none : direction_to(sides_[tip.right], from)) +
                     (to - from).cross(apex - from).norm() / 2 + length_weight * (to - from).squaredNorm() +
                     (flat ? flat_penalty * size_squared_ : 0);
        }
        std::erase_if(side.tips, [&](const Tip& tip) { return tip.cost == infinity; });
        sort_tips(side);
      });
    return trace([&](Index side, const Direction& outer) { return first_within(side, outer); });
  }

  // Collects the triangles from the whole hole downwards, taking on each side the best one for the direction
  // outside.
  template <class Best>
  std::vector<HoleTriangle> trace(const Best& best) const {
    std::vector<HoleTriangle> triangles;
    std::vector<std::pair<Index, Direction>> open{{n_ - 1, beyond_[n_ - 1]}};
    while (!open.empty()) {
      const auto [s, outer] = open.back();
      open.pop_back();
      if (is_loop_edge(s)) continue;
      const Side& side = sides_[s];
      const Tip* tip = best(s, outer);
      if (!tip) return {};
      triangles.push_back({side.from, tip->apex, side.to});
      const bool flat = is_none(tip->direction);
      const Direction none = Direction::Zero();
      open.emplace_back(tip->right, flat ? none : direction_to(sides_[tip->right], point(side.from)));
      open.emplace_back(tip->left, flat ? none : direction_to(sides_[tip->left], point(side.to)));
    }
    return triangles;
  }

  const HoleLoop& loop_;
  const Context& context_;
  Index n_;
  double size_squared_ = 0, largest_ = 0;
  double limit_ = 0;
  bool may_be_flat_ = false;
  std::vector<Side> sides_;  // loop edges first; the last of them, from 0 to n − 1, has the whole hole inside
  std::vector<std::vector<Index>> of_length_;
  std::vector<Direction> beyond_;             // per edge of the loop, zero if unknown
  std::vector<std::vector<Link>> from_, to_;  // per vertex: sides with triangles, ascending and descending
};

}  // namespace

std::vector<HoleTriangle> search_triangulation(const HoleLoop& loop, std::span<const HoleChord> chords,
                                               HoleAim aim, const Context& context) {
  return Search(loop, chords, context).run(aim);
}

double bend_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& inner,
                    const Eigen::Vector3d& outer) {
  const Eigen::Vector3d along = (to - from).normalized();
  const auto direction_to = [&](const Eigen::Vector3d& corner) {
    const Eigen::Vector3d offset = corner - from;
    return Eigen::Vector3d((offset - offset.dot(along) * along).normalized());
  };
  const Eigen::Vector3d a = direction_to(inner), b = direction_to(outer);
  return a.isZero(0) || b.isZero(0) || !b.allFinite() ? 0 : (a + b).squaredNorm();
}

}  // namespace meshgraft
