#include "twist_modes.h"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "core/parallel.h"

namespace meshgraft {

namespace {

constexpr int turn_count = 24;
using Turns = std::array<double, turn_count>;

/// Returns turns of a handle, in radians: from 15° to 720°, each by the same factor larger than the one before.
Turns turns_of_handle() {
  constexpr double smallest = std::numbers::pi / 12, largest = 4 * std::numbers::pi;
  Turns turns;
  for (int k = 0; k < turn_count; ++k)
    turns[k] = smallest * std::pow(largest / smallest, static_cast<double>(k) / (turn_count - 1));
  return turns;
}

/// Writes the strains that turns of a handle cause at a vertex: the rate of twisting ω, and ω times cosine and
/// sine of the angle by which the vertex turns. A limb's axis may point either way, and the slope changes its
/// sign with it; ω does not.
void strains_at(const LimbPoint& at, double influence, double slope, const Turns& turns,
                Eigen::Ref<Eigen::RowVectorXd> strains) {
  for (int k = 0; k < turn_count; ++k) {
    const double rate = twist_rate(at, turns[k] * std::abs(slope)), angle = turns[k] * influence;
    strains.segment<3>(3 * k) << rate, rate * std::cos(angle), rate * std::sin(angle);
  }
}

}  // namespace

Columns twist_modes(const LimbTwist& limbs, const Columns& influence, const Columns& slopes,
                    std::span<const Index> points, std::span<const Index> handles, Eigen::Index count,
                    const Context& context) {
  Columns modes = Columns::Zero(influence.rows(), count * std::ssize(handles));
  const Turns turns = turns_of_handle();
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const auto strains = [&](Eigen::Index v, Eigen::Ref<Eigen::RowVectorXd> row) {
      strains_at(limbs.at(v), influence(v, handles[h]), slopes(v, handles[h]), turns, row);
    };
    Columns at_points(std::ssize(points), 3 * turn_count);
    for (Eigen::Index p = 0; p < at_points.rows(); ++p) strains(points[p], at_points.row(p));
    const Eigen::MatrixXd products = at_points.transpose() * at_points / static_cast<double>(points.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(products);
    const double largest = eigen.eigenvalues().tail<1>()[0];
    if (!(largest > 0)) continue;
    const Eigen::MatrixXd directions =
        eigen.eigenvectors().rightCols(count).rowwise().reverse() / std::sqrt(largest);
    const Eigen::Index first = static_cast<Eigen::Index>(h) * count;
    parallel_blocks(
        static_cast<std::size_t>(modes.rows()),
        [&](std::size_t begin, std::size_t end) {
          Eigen::RowVectorXd row(3 * turn_count);
          for (auto v = static_cast<Eigen::Index>(begin); v < static_cast<Eigen::Index>(end); ++v) {
            if (limbs.at(v).moment.isZero(0)) continue;
            strains(v, row);
            modes.row(v).segment(first, count) = row * directions;
          }
        },
        context, 1024);
  }
  return modes;
}

}  // namespace meshgraft
