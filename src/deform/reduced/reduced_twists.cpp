#include "reduced_twists.h"

#include <map>
#include <utility>

#include "core/parallel.h"
#include "twist_modes.h"
#include "winding.h"

namespace meshgraft {

namespace {

/// Returns weights of the vertices on limbs and discs, whose sum is 1. On limbs they are the areas: a thin limb
/// must not be neglected beside a thick one. On the disc of a component, moments grow with the distance from
/// its centre, and the areas are multiplied by their squares, relative to the mean.
Eigen::VectorXd weights_of_twists(const LimbTwist& limbs, const SampledSurface& surface) {
  const auto squared_moment = [&](Eigen::Index v) { return limbs.at(v).moment.squaredNorm(); };
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(std::ssize(surface.areas));
  std::map<Index, std::pair<double, double>> discs;  // per component: area, and the integral of squared moments
  for (Eigen::Index v = 0; v < weights.size(); ++v) {
    if (limbs.at(v).moment.isZero(0)) continue;
    weights[v] = surface.areas[static_cast<std::size_t>(v)];
    if (!is_on_disc(limbs.at(v))) continue;
    auto& [area, squares] = discs[surface.components[static_cast<std::size_t>(v)]];
    area += weights[v];
    squares += weights[v] * squared_moment(v);
  }
  for (Eigen::Index v = 0; v < weights.size(); ++v) {
    if (weights[v] == 0 || !is_on_disc(limbs.at(v))) continue;
    const auto& [area, squares] = discs[surface.components[static_cast<std::size_t>(v)]];
    if (squares > 0) weights[v] *= squared_moment(v) * area / squares;
  }
  const double sum = weights.sum();
  return sum > 0 ? Eigen::VectorXd(weights / sum) : weights;
}

/// Returns vertices, ascending, that stand for equal shares of the weights. A vertex that has many shares is
/// repeated.
std::vector<Index> vertices_of_equal_weight(const Eigen::VectorXd& weights, int count) {
  std::vector<Index> chosen;
  double sum = 0;
  for (Eigen::Index v = 0; v < weights.size(); ++v) {
    sum += weights[v];
    while (std::ssize(chosen) < count && (static_cast<double>(chosen.size()) + 0.5) / count < sum)
      chosen.push_back(static_cast<Index>(v));
  }
  return chosen;
}

TwistPoints points_at(const LimbTwist& limbs, std::span<const Index> vertices, Columns influence,
                      const Columns& slopes) {
  TwistPoints points{{}, std::move(influence), slopes(vertices, Eigen::all)};
  for (const Index v : vertices) points.limbs.push_back(limbs.at(v));
  return points;
}

/// Returns W of `twist_shear` at a point.
Eigen::Matrix3d shear_at(const TwistPoints& points, const BlendedLogs& logs, Eigen::Index point,
                         const Eigen::Matrix3d& stretch) {
  const auto turns = logs.handles.leftCols<3>();
  const Eigen::RowVector3d turn = points.influence.row(point) * turns, slope = points.slopes.row(point) * turns;
  return twist_shear(points.limbs[static_cast<std::size_t>(point)], turn.transpose(), slope.transpose(),
                     logs.reference, stretch);
}

}  // namespace

ReducedTwists::ReducedTwists(const LimbTwist& limbs, const SampledSurface& surface, Columns smooth_functions,
                             std::span<const Index> handles, Eigen::Index components, const Context& context) {
  constexpr int point_count = 2048;
  const Eigen::VectorXd weights = weights_of_twists(limbs, surface);
  if (weights.isZero(0)) return;
  const std::vector<Index> points = components > 0
                                        ? vertices_of_equal_weight(weights, point_count)
                                        : std::vector<Index>(surface.samples.begin(), surface.samples.end());
  const Columns slopes = limbs.slopes(surface.influence, context);
  const Columns modes = twist_modes(limbs, surface.influence, slopes, points, handles, components, context);
  functions_.resize(smooth_functions.rows(), smooth_functions.cols() + modes.cols());
  parallel_blocks(
      static_cast<std::size_t>(functions_.rows()),
      [&](std::size_t begin, std::size_t end) {
        const auto first = static_cast<Eigen::Index>(begin), count = static_cast<Eigen::Index>(end - begin);
        functions_.middleRows(first, count) << smooth_functions.middleRows(first, count),
            modes.middleRows(first, count);
      },
      context, 4096);
  fit(surface, weights, smooth_functions.cols(), points);
  samples_ = points_at(limbs, surface.samples, surface.influence(surface.samples, Eigen::all), slopes);
  cells_ = points_at(limbs, surface.samples, surface.cell_influence, slopes);
  points_ = points_at(limbs, points, surface.influence(points, Eigen::all), slopes);
  cell_strains_.assign(surface.samples.size(), Eigen::Matrix3d::Zero());
  for (std::size_t v = 0; v < surface.cells.size(); ++v) {
    const Index cell = surface.cells[v];
    if (cell < 0) continue;
    const LimbPoint at = limbs.at(static_cast<Eigen::Index>(v));
    cell_strains_[cell] += surface.areas[v] / surface.cell_areas[cell] * at.moment * at.direction.transpose();
  }
}

/// Computes the fits at the samples and at points.
void ReducedTwists::fit(const SampledSurface& surface, const Eigen::VectorXd& weights,
                        Eigen::Index smooth_count, std::span<const Index> points) {
  const Eigen::Index count = functions_.cols();
  const Columns at_points = functions_(points, Eigen::all);
  const double share = 1 / static_cast<double>(points.size());
  Eigen::MatrixXd penalty;
  if (count > smooth_count) {
    // The smooth functions would swing between the samples where strain begins abruptly. Components are as
    // large as their shares in the strains, so that the smallest ones are hardly used. Of both penalties, ten
    // times as much or as little does as well.
    constexpr double of_smooth_functions = 1e-2, of_components = 1e-6;
    penalty.setZero(count, count);
    penalty.topLeftCorner(smooth_count, smooth_count) = of_smooth_functions * share *
                                                        at_points.leftCols(smooth_count).transpose() *
                                                        at_points.leftCols(smooth_count);
    penalty.diagonal().tail(count - smooth_count).setConstant(of_components);
  }
  point_fit_ = fit_functions(at_points, std::vector<double>(points.size(), share), penalty);
  std::vector<double> of_cells(surface.samples.size(), 0.0);
  for (std::size_t v = 0; v < surface.cells.size(); ++v)
    if (surface.cells[v] >= 0) of_cells[surface.cells[v]] += weights[static_cast<Eigen::Index>(v)];
  sample_fit_ = fit_functions(functions_(surface.samples, Eigen::all), of_cells, penalty);
}

Eigen::Matrix3d ReducedTwists::shear_at_sample(const BlendedLogs& logs, Eigen::Index sample,
                                               const Eigen::Matrix3d& stretch) const {
  return shear_at(samples_, logs, sample, stretch);
}

Eigen::Matrix3d ReducedTwists::strain_of_cell(const BlendedLogs& logs, Eigen::Index cell,
                                              const Eigen::Matrix3d& stretch) const {
  return shear_at(cells_, logs, cell, stretch) * cell_strains_[static_cast<std::size_t>(cell)];
}

ReducedTwists::Maps ReducedTwists::of_handles(const BlendedLogs& logs, const Context& context) const {
  Maps shears(std::ssize(points_.limbs), 9);
  const auto shear = [&](std::size_t begin, std::size_t end) {
    for (auto p = static_cast<Eigen::Index>(begin); p < static_cast<Eigen::Index>(end); ++p) {
      const BlendedMap map = logs.map_at(points_.influence, p);
      Eigen::Map<Eigen::Matrix3d>(shears.row(p).data()) =
          map.rotation * shear_at(points_, logs, p, map.stretch);
    }
  };
  parallel_blocks(points_.limbs.size(), shear, context, 256);
  return point_fit_ * shears;
}

}  // namespace meshgraft
