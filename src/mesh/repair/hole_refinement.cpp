#include "hole_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include "core/parallel.h"
#include "mesh/area_vector.h"

namespace meshgraft {

namespace {

using Eigen::RowVector3d;

constexpr int most_refinement_rounds = 60;  // of splitting and flipping
constexpr int most_sweeps = 100;            // of flips, which usually end far earlier
constexpr int fairings = 2;                 // the second pass uses the weights of the first pass's shape

double smallest_angle(const RowVector3d& a, const RowVector3d& b, const RowVector3d& c) {
  const auto angle = [](const RowVector3d& u, const RowVector3d& v) {
    return std::atan2(u.cross(v).norm(), u.dot(v));
  };
  return std::min({angle(b - a, c - a), angle(c - b, a - b), angle(a - c, b - c)});
}

class Refinement {
 public:
  Refinement(const Points& loop, const std::vector<HoleTriangle>& triangles,
             const HoleRefinementOptions& options)
      : loop_size_(static_cast<Index>(loop.rows())), faces_(triangles), forbidden_(options.forbidden) {
    for (const auto& row : loop.rowwise()) points_.push_back(row);
    scale_ = options.scale;
    for (Index k = 0; k < loop_size_; ++k) between_.push_back({k, k, 0});
  }

  HolePatch run(const Context& context) {
    flip_edges(context);
    for (int round = 0; round < most_refinement_rounds; ++round) {
      context.throw_if_stopped();
      if (!split_large()) break;
      flip_edges(context);
    }
    HolePatch patch{Points(static_cast<Eigen::Index>(points_.size()), 3),
                    std::move(faces_),
                    {between_.begin() + loop_size_, between_.end()}};
    for (std::size_t k = 0; k < points_.size(); ++k)
      patch.points.row(static_cast<Eigen::Index>(k)) = points_[k];
    return patch;
  }

 private:
  bool split_large() {
    constexpr double density = 1.4142135623730951;  // Liepa's α
    const std::size_t count = faces_.size();
    for (std::size_t f = 0; f < count; ++f) {
      const HoleTriangle face = faces_[f];
      const RowVector3d centre = (points_[face[0]] + points_[face[1]] + points_[face[2]]) / 3;
      const double scale = (scale_[face[0]] + scale_[face[1]] + scale_[face[2]]) / 3;
      const bool large = std::all_of(face.begin(), face.end(), [&](Index v) {
        const double distance = density * (points_[v] - centre).norm();
        return distance > scale && distance > scale_[v];
      });
      if (!large) continue;
      const auto v = static_cast<Index>(points_.size());
      points_.push_back(centre);
      scale_.push_back(scale);
      between_.push_back(nearest_of_loop(face));
      faces_[f] = {face[0], face[1], v};
      faces_.push_back({face[1], face[2], v});
      faces_.push_back({face[2], face[0], v});
    }
    return faces_.size() > count;
  }

  // Returns the two loop points with the largest weights at the triangle's corners.
  EdgePoint nearest_of_loop(const HoleTriangle& face) const {
    std::vector<std::pair<Index, double>> weights;
    const auto add = [&](Index k, double weight) {
      const auto found =
          std::find_if(weights.begin(), weights.end(), [&](const auto& w) { return w.first == k; });
      if (found != weights.end())
        found->second += weight;
      else if (weight > 0)
        weights.emplace_back(k, weight);
    };
    for (const Index v : face) {
      add(between_[v].from, 1 - between_[v].t);
      add(between_[v].to, between_[v].t);
    }
    std::stable_sort(weights.begin(), weights.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    if (weights.size() == 1) return {weights[0].first, weights[0].first, 0};
    return {weights[0].first, weights[1].first, weights[1].second / (weights[0].second + weights[1].second)};
  }

  // A half-edge. The sorted list is made anew in each sweep, and is looked up by ends of edges that may not
  // exist yet; an EdgeTable would need the faces in another form.
  struct Corner {
    HoleChord edge;
    Index face, corner;  // the edge from the corner to the next one
    bool operator<(const Corner& other) const {
      return std::pair(edge, face) < std::pair(other.edge, other.face);
    }
  };

  // Flips edges in sweeps over all edges, with each face in at most one flip per sweep. Each flip increases
  // the smallest angle of two triangles, so the sweeps end.
  void flip_edges(const Context& context) {
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      context.throw_if_stopped();
      std::vector<Corner> corners;
      for (Index f = 0; f < static_cast<Index>(faces_.size()); ++f)
        for (Index k = 0; k < 3; ++k) {
          const auto [low, high] = std::minmax(faces_[f][k], faces_[f][(k + 1) % 3]);
          corners.push_back({{low, high}, f, k});
        }
      std::sort(corners.begin(), corners.end());
      Flags touched(faces_.size(), 0);
      std::set<HoleChord> made;
      for (std::size_t k = 0; k + 1 < corners.size(); ++k)
        if (corners[k].edge == corners[k + 1].edge && !touched[corners[k].face] &&
            !touched[corners[k + 1].face])
          flip(corners[k], corners[k + 1], corners, touched, made);
      if (made.empty()) return;
    }
  }

  void flip(const Corner& one, const Corner& other, const std::vector<Corner>& corners, Flags& touched,
            std::set<HoleChord>& made) {
    const Index a = faces_[one.face][one.corner], b = faces_[one.face][(one.corner + 1) % 3];
    const Index c = faces_[one.face][(one.corner + 2) % 3], d = faces_[other.face][(other.corner + 2) % 3];
    const auto [low, high] = std::minmax(c, d);
    const HoleChord edge{low, high};
    if (c == d || is_there(edge, corners) || made.contains(edge)) return;
    const double before = std::min(smallest_angle(points_[a], points_[b], points_[c]),
                                   smallest_angle(points_[b], points_[a], points_[d]));
    const double after = std::min(smallest_angle(points_[a], points_[d], points_[c]),
                                  smallest_angle(points_[d], points_[b], points_[c]));
    if (!(after > before + 1e-9) || folds(a, b, c, d)) return;
    faces_[one.face] = {a, d, c};
    faces_[other.face] = {d, b, c};
    touched[one.face] = touched[other.face] = 1;
    made.insert(edge);
  }

  // Returns whether a new triangle would face away from the old ones.
  bool folds(Index a, Index b, Index c, Index d) const {
    const auto area = [&](Index i, Index j, Index k) {
      return RowVector3d((points_[j] - points_[i]).cross(points_[k] - points_[i]));
    };
    const RowVector3d old = area(a, b, c) + area(b, a, d);
    return area(a, d, c).dot(old) <= 0 || area(d, b, c).dot(old) <= 0;
  }

  bool is_there(const HoleChord& edge, const std::vector<Corner>& corners) const {
    const auto found = std::lower_bound(corners.begin(), corners.end(), Corner{edge, -1, 0});
    if (found != corners.end() && found->edge == edge) return true;
    return std::binary_search(forbidden_.begin(), forbidden_.end(), edge);
  }

  Index loop_size_;
  std::vector<RowVector3d> points_;
  std::vector<double> scale_;
  std::vector<EdgePoint> between_;
  std::vector<HoleTriangle> faces_;
  const std::vector<HoleChord>& forbidden_;
};

using Sparse = Eigen::SparseMatrix<double>;

// Returns M^{-1/2} K with rows for the new and the loop points and a column for every point.
Sparse laplacian(const Points& points, const std::vector<HoleTriangle>& faces, Index rows,
                 const Flags& is_row) {
  std::vector<double> area(rows, 0);
  std::vector<Eigen::Triplet<double>> entries;
  for (const HoleTriangle& face : faces) {
    const RowVector3d a = points.row(face[0]), b = points.row(face[1]), c = points.row(face[2]);
    const double third = (b - a).cross(c - a).norm() / 6;
    for (const Index v : face)
      if (v < rows) area[v] += third;
  }
  const double least = 1e-9 * *std::max_element(area.begin(), area.end());
  for (const HoleTriangle& face : faces)
    for (int k = 0; k < 3; ++k) {
      const Index i = face[k], j = face[(k + 1) % 3], apex = face[(k + 2) % 3];
      const double weight = clamped_cotangent(points.row(apex), points.row(i), points.row(j)) / 2;
      for (const auto& [v, other] : {std::pair{i, j}, std::pair{j, i}}) {
        if (v >= rows || !is_row[v]) continue;
        const double scaled = weight / std::sqrt(std::max(area[v], least));
        entries.emplace_back(v, v, scaled);
        entries.emplace_back(v, other, -scaled);
      }
    }
  Sparse matrix(rows, points.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Data that the uninterruptible factorisation owns, so that a cancelled caller can leave it behind.
struct FairingSystem {
  Sparse matrix;
  Eigen::MatrixXd right;
  Points solution{0, 3};
};

}  // namespace

HolePatch refine_hole(const Points& loop, const std::vector<HoleTriangle>& triangles,
                      const HoleRefinementOptions& options, const Context& context) {
  return Refinement(loop, triangles, options).run(context);
}

void fair_hole(HolePatch& patch, const Points& outside, std::span<const HoleTriangle> around,
               const Context& context) {
  const auto fresh = static_cast<Index>(patch.between.size());
  const auto inside = static_cast<Index>(patch.points.rows()), loop = inside - fresh;
  if (fresh == 0) return;
  Points points(inside + outside.rows(), 3);
  points << patch.points, outside;
  std::vector<HoleTriangle> faces = patch.faces;
  faces.insert(faces.end(), around.begin(), around.end());
  // A loop point has a Laplacian only if faces surround it.
  Flags is_row(inside, 1);
  std::vector<std::pair<HoleChord, Index>> open;
  for (const HoleTriangle& face : faces)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(face[k], face[(k + 1) % 3]);
      open.push_back({{low, high}, 0});
    }
  std::sort(open.begin(), open.end());
  for (std::size_t k = 0; k < open.size(); ++k) {
    const bool shared = (k > 0 && open[k - 1] == open[k]) || (k + 1 < open.size() && open[k + 1] == open[k]);
    for (const Index v : open[k].first)
      if (!shared && v < loop) is_row[v] = 0;
  }
  for (int pass = 0; pass < fairings; ++pass) {
    context.throw_if_stopped();
    const Sparse rows = laplacian(points, faces, inside, is_row);
    const Sparse free = rows.middleCols(loop, fresh);
    Points fixed = points;
    fixed.middleRows(loop, fresh).setZero();
    auto system = std::make_shared<FairingSystem>();
    system->matrix = free.transpose() * free;
    system->right = -(free.transpose() * (rows * fixed));
    run_abandonable(
        [system] {
          const Eigen::SimplicialLDLT<Sparse> solver(system->matrix);
          if (solver.info() == Eigen::Success) system->solution = solver.solve(system->right);
        },
        context);
    if (system->solution.rows() != fresh || !system->solution.allFinite()) return;
    points.middleRows(loop, fresh) = system->solution;
  }
  patch.points = points.topRows(inside);
}

}  // namespace meshgraft
