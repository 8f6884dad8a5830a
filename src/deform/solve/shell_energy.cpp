#include "shell_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "core/parallel.h"

namespace meshgraft {

namespace {

// The constants were chosen on the eight tests of docs/methods.md.
constexpr double bending = 0.006, even_bending = 0.034;     // η₂, η₄
constexpr double area_weight = 1.0 / 3, least_area = 0.95;  // k, and the share of its area below which it acts

template <class Body>
void for_each(std::size_t count, const Context& context, const Body& body) {
  parallel_blocks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
      },
      context);
}

/// ¼ u⁴ for u ≥ 0, which goes on as a parabola from 1 on so that a kink does not outweigh the rest.
struct Power {
  double value, slope, slope_of_slope;
};
Power even_power(double u, CurvatureModel model) {
  if (u > 1) return {1.5 * u * u - 2 * u + 0.75, 3 * u - 2, model == CurvatureModel::secant ? 2.0 : 3.0};
  const double squared = u * u;
  return {0.25 * squared * squared, squared * u, (model == CurvatureModel::secant ? 2 : 3) * squared};
}

/// The logarithm of the ratio of least to present area of a face, 0 or more, and its gradient by the corners.
struct AreaLoss {
  double log = 0;
  std::array<Eigen::Vector3d, 3> slope;
};
AreaLoss area_loss(const Eigen::Vector3<Index>& face, double wanted, const Points& positions) {
  const std::array<Eigen::Vector3d, 3> p{positions.row(face[0]).transpose(), positions.row(face[1]).transpose(),
                                         positions.row(face[2]).transpose()};
  const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
  const double area = normal.norm() / 2, smallest = 1e-6 * wanted;
  AreaLoss loss;
  if (!(area < least_area * wanted)) return loss;  // also where no area is wanted
  loss.log = std::log(least_area * wanted / std::max(area, smallest));
  for (std::size_t c = 0; c < 3; ++c)
    loss.slope[c] = area > smallest
                        ? Eigen::Vector3d(normal.cross(p[(c + 1) % 3] - p[(c + 2) % 3]) / (4 * area * area))
                        : Eigen::Vector3d::Zero();
  return loss;
}

}  // namespace

ShellPattern::ShellPattern(const ShellSurface& surface, const Context& context) {
  const std::size_t count = surface.moving().size();
  std::vector<std::int64_t> pairs;  // column and row of coupled unknowns, in one number
  for (const Hinge& hinge : surface.hinges())
    for (const Index a : hinge.vertices)
      for (const Index b : hinge.vertices) {
        if (a < 0 || b < 0) continue;
        const std::int64_t row = surface.unknown(a), column = surface.unknown(b);
        if (column >= 0 && row > column) pairs.push_back(column << 32 | row);
      }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  context.throw_if_stopped();
  begin_.assign(count + 1, 0);
  rows_.reserve(pairs.size());
  for (const std::int64_t pair : pairs) {
    ++begin_[(pair >> 32) + 1];
    rows_.push_back(static_cast<Index>(pair & 0xffffffff));
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());

  const auto size = static_cast<Eigen::Index>(3 * count);
  zero_.resize(size, size);
  zero_.resizeNonZeros(static_cast<Eigen::Index>(6 * count + 9 * rows_.size()));
  std::int64_t next = 0;
  for (std::size_t u = 0; u < count; ++u)
    for (int d = 0; d < 3; ++d) {
      zero_.outerIndexPtr()[3 * u + d] = next;
      for (int e = d; e < 3; ++e) zero_.innerIndexPtr()[next++] = static_cast<std::int64_t>(3 * u) + e;
      for (std::int64_t k = begin_[u]; k < begin_[u + 1]; ++k)
        for (int e = 0; e < 3; ++e) zero_.innerIndexPtr()[next++] = std::int64_t{3} * rows_[k] + e;
    }
  zero_.outerIndexPtr()[size] = next;
  std::fill_n(zero_.valuePtr(), next, 0.0);
}

void ShellPattern::add(NormalMatrix& matrix, Index row, Index column, const Eigen::Matrix3d& block) const {
  const std::int64_t* const starts = matrix.outerIndexPtr() + 3 * static_cast<std::int64_t>(column);
  double* const values = matrix.valuePtr();
  if (row == column) {
    for (int d = 0; d < 3; ++d)
      for (int e = d; e < 3; ++e) values[starts[d] + e - d] += block(e, d);
    return;
  }
  const auto first = rows_.begin() + begin_[column], last = rows_.begin() + begin_[column + 1];
  const std::int64_t rank = std::lower_bound(first, last, row) - first;
  for (int d = 0; d < 3; ++d)
    for (int e = 0; e < 3; ++e) values[starts[d] + 3 - d + 3 * rank + e] += block(e, d);
}

ShellEnergy::ShellEnergy(const ShellSurface& surface, const ShellPattern& pattern, ShellSurface::Metric metric)
    : surface_(surface), pattern_(pattern), metric_(std::move(metric)) {
  for (const double sum : metric_.face_sums) sizes_.push_back(std::sqrt(sum));
  hinge_counts_.assign(surface.components(), 0);
  for (const Hinge& hinge : surface.hinges()) ++hinge_counts_[hinge.component];
}

ShellEnergy::Terms ShellEnergy::terms(std::size_t h, double length, double angle, CurvatureModel model) const {
  const Hinge& hinge = surface_.hinges()[h];
  const double share = metric_.areas[h] / metric_.hinge_sums[hinge.component], wanted = metric_.lengths[h];
  Terms terms;
  if (hinge.stretches) {
    const double unit = std::max(wanted, surface_.shortest(hinge.component)), strain = (length - wanted) / unit;
    terms.energy = 0.5 * share * strain * strain;
    terms.by_length = share * strain / unit;
    terms.by_length_twice = share / (unit * unit);
  }
  if (hinge.vertices[3] < 0) return terms;
  const double turn = std::remainder(angle - metric_.angles[h], 2 * std::numbers::pi);
  const double curvature = sizes_[hinge.component] * wanted / metric_.areas[h];  // D κ per radian
  const double weight = hinge.bending * share, second = weight * std::pow(bending * curvature, 2),
               scale = even_bending * curvature;
  const Power even = even_power(scale * std::abs(turn), model);
  terms.energy += 0.5 * second * turn * turn + weight * even.value;
  terms.by_angle = second * turn + weight * scale * std::copysign(even.slope, turn);
  terms.by_angle_twice = second + weight * scale * scale * even.slope_of_slope;
  return terms;
}

/// Returns the weight of the area of a face.
double ShellEnergy::area_share(std::size_t face) const {
  const double sum = metric_.face_sums[surface_.component_of_face(face)];
  return sum > 0 ? area_weight * metric_.face_areas[face] / sum : 0;
}

double ShellEnergy::value(const Points& positions, const Context& context) const {
  const std::vector<Hinge>& hinges = surface_.hinges();
  std::vector<double> energies(hinges.size() + surface_.faces().size());
  for_each(hinges.size(), context, [&](std::size_t h) {
    const HingeShape shape = hinge_shape(surface_.points(hinges[h], positions), hinges[h].vertices[3] >= 0);
    energies[h] = terms(h, shape.length, shape.angle, {}).energy;
  });
  for_each(surface_.faces().size(), context, [&](std::size_t f) {
    const double loss = area_loss(surface_.faces()[f], metric_.face_areas[f], positions).log;
    energies[hinges.size() + f] = 0.5 * area_share(f) * loss * loss;
  });
  return std::accumulate(energies.begin(), energies.end(), 0.0);
}

void ShellEnergy::differentiate(const Points& positions, CurvatureModel model, Eigen::VectorXd& descent,
                                NormalMatrix& curvature, const Context& context) const {
  descent.setZero(static_cast<Eigen::Index>(3 * surface_.moving().size()));
  curvature = pattern_.zero();
  const std::vector<Hinge>& hinges = surface_.hinges();
  std::vector<HingeShape> shapes(hinges.size());
  for_each(hinges.size(), context, [&](std::size_t h) {
    shapes[h] = hinge_shape(surface_.points(hinges[h], positions), hinges[h].vertices[3] >= 0);
  });
  for (std::size_t h = 0; h < hinges.size(); ++h) {
    const HingeShape& shape = shapes[h];
    const Terms of = terms(h, shape.length, shape.angle, model);
    for (std::size_t a = 0; a < 4; ++a) {
      const Index row = hinges[h].vertices[a] < 0 ? -1 : surface_.unknown(hinges[h].vertices[a]);
      if (row < 0) continue;
      descent.segment<3>(3 * row) -= of.by_length * shape.length_slope[a] + of.by_angle * shape.angle_slope[a];
      for (std::size_t b = 0; b < 4; ++b) {
        const Index column = hinges[h].vertices[b] < 0 ? -1 : surface_.unknown(hinges[h].vertices[b]);
        if (column < 0 || column > row) continue;
        pattern_.add(curvature, row, column,
                     of.by_length_twice * shape.length_slope[a] * shape.length_slope[b].transpose() +
                         of.by_angle_twice * shape.angle_slope[a] * shape.angle_slope[b].transpose());
      }
    }
  }
  context.throw_if_stopped();
  for (std::size_t f = 0; f < surface_.faces().size(); ++f) {
    const Eigen::Vector3<Index>& face = surface_.faces()[f];
    const AreaLoss loss = area_loss(face, metric_.face_areas[f], positions);
    if (!(loss.log > 0)) continue;
    const double weight = area_share(f);
    for (int a = 0; a < 3; ++a) {
      const Index row = surface_.unknown(face[a]);
      if (row < 0) continue;
      descent.segment<3>(3 * row) -= weight * loss.log * loss.slope[a];
      for (int b = 0; b < 3; ++b) {
        const Index column = surface_.unknown(face[b]);
        if (column < 0 || column > row) continue;
        pattern_.add(curvature, row, column, weight * loss.slope[a] * loss.slope[b].transpose());
      }
    }
  }
}

void ShellEnergy::add_damping(double factor, NormalMatrix& matrix) const {
  for (std::size_t h = 0; h < surface_.hinges().size(); ++h) {
    const Hinge& hinge = surface_.hinges()[h];
    const Index a = surface_.unknown(hinge.vertices[0]), b = surface_.unknown(hinge.vertices[1]);
    const double length = std::max(metric_.lengths[h], surface_.shortest(hinge.component));
    const Eigen::Matrix3d block =
        factor / (hinge_counts_[hinge.component] * length * length) * Eigen::Matrix3d::Identity();
    if (a >= 0) pattern_.add(matrix, a, a, block);
    if (b >= 0) pattern_.add(matrix, b, b, block);
    if (a >= 0 && b >= 0) pattern_.add(matrix, std::max(a, b), std::min(a, b), -block);
  }
}

std::vector<double> ShellEnergy::area_ratios(const Points& positions) const {
  std::vector<double> ratios;
  ratios.reserve(surface_.faces().size());
  for (std::size_t f = 0; f < surface_.faces().size(); ++f) {
    const Eigen::Vector3<Index>& t = surface_.faces()[f];
    const Eigen::RowVector3d u = positions.row(t[1]) - positions.row(t[0]),
                             v = positions.row(t[2]) - positions.row(t[0]);
    const double wanted = metric_.face_areas[f];
    ratios.push_back(wanted > 0 ? u.cross(v).norm() / 2 / wanted : 1);
  }
  return ratios;
}

}  // namespace meshgraft
