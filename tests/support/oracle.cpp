#include "support/oracle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>

namespace meshgraft::test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

}  // namespace

Oracle::Oracle(OracleProblem problem) : problem_(std::move(problem)) {
  count_ = static_cast<Index>(problem_.rest.rows());
  p_ = problem_.moved.value_or(problem_.rest);
  find_rings_and_pairs();

  known_position_.resize(count_);
  known_transform_.resize(count_);
  for (const VertexConstraint& constraint : problem_.constraints) {
    known_position_[constraint.vertex] = constraint.position;
    known_transform_[constraint.vertex] = constraint.transform;
  }
  has_apex_.assign(count_, false);
  for (Index i = 0; i < count_; ++i) {
    if (ring_[i].empty()) continue;
    if (!known_position_[i]) free_.push_back(i);
    if (problem_.apex && !known_transform_[i]) {
      has_apex_[i] = true;
      apex_owner_.push_back(i);
    }
  }

  measure_surface();
  if (problem_.noise_seed) add_noise(*problem_.noise_seed);
  set_weights();
  if (is_integral()) weigh_edges();
  widen_stencils();
  fit_at_rest();
  build_jacobian();
}

void Oracle::find_rings_and_pairs() {
  std::map<std::pair<Index, Index>, std::vector<Index>> opposite;  // edge → third corners of its faces
  for (const auto& triangle : problem_.triangles.rowwise())
    for (int c = 0; c < 3; ++c)
      opposite[std::minmax(triangle[c], triangle[(c + 1) % 3])].push_back(triangle[(c + 2) % 3]);

  ring_.resize(count_);
  std::set<std::pair<Index, Index>> pairs;
  for (const auto& [edge, corners] : opposite) {
    ring_[edge.first].push_back(edge.second);
    ring_[edge.second].push_back(edge.first);
    pairs.insert(edge);
    for (Index a : corners)
      for (Index b : corners)
        if (a < b) pairs.insert({a, b});
  }
  for (const auto& [i, j] : pairs) pairs_.push_back({i, j, 0});
}

void Oracle::measure_surface() {
  const Points& p = problem_.rest;
  normal_ = Points::Zero(count_, 3);
  for (const auto& t : problem_.triangles.rowwise()) {
    const Vector3d u = (p.row(t[1]) - p.row(t[0])).transpose(), v = (p.row(t[2]) - p.row(t[0])).transpose();
    for (int c = 0; c < 3; ++c) normal_.row(t[c]) += u.cross(v).transpose();
  }
  mean_edge_ = Eigen::VectorXd::Zero(count_);
  apex_rest_ = Points::Zero(count_, 3);
  for (Index i = 0; i < count_; ++i) {
    if (ring_[i].empty()) continue;
    normal_.row(i).normalize();
    for (Index j : ring_[i])
      mean_edge_[i] += (p.row(i) - p.row(j)).norm() / static_cast<double>(ring_[i].size());
    apex_rest_.row(i) = p.row(i) + problem_.apex_height_rel * mean_edge_[i] * normal_.row(i);
  }
}

void Oracle::set_weights() {
  std::map<std::pair<Index, Index>, double> cotangents;
  if (problem_.weights == WeightScheme::cotangent)
    for (const auto& t : problem_.triangles.rowwise())
      for (int c = 0; c < 3; ++c) {
        const Index a = t[c], b = t[(c + 1) % 3], o = t[(c + 2) % 3];
        const Vector3d u = (p_.row(a) - p_.row(o)).transpose(), v = (p_.row(b) - p_.row(o)).transpose();
        cotangents[std::minmax(a, b)] += u.dot(v) / u.cross(v).norm();
      }
  weight_.resize(count_);
  for (Index i = 0; i < count_; ++i) {
    double sum = 0;
    for (Index j : ring_[i]) {
      const double w =
          problem_.weights == WeightScheme::uniform ? 1.0 : std::max(0.0, cotangents[std::minmax(i, j)]);
      weight_[i].push_back(w);
      sum += w;
    }
    for (double& w : weight_[i]) w = sum > 0 ? w / sum : 1.0 / static_cast<double>(ring_[i].size());
  }
}

// The place of the map that is fitted to a vertex, its ring and a point above it.
Vector3d Oracle::place(Index i) const {
  const auto count = static_cast<Eigen::Index>(ring_[i].size());
  MatrixXd stencil(count + 2, 3);
  stencil.row(0) = p_.row(i);
  for (Eigen::Index k = 0; k < count; ++k) stencil.row(k + 1) = p_.row(ring_[i][static_cast<std::size_t>(k)]);
  stencil.row(count + 1) = p_.row(i) + mean_edge_[i] * normal_.row(i);
  const Eigen::RowVector3d mean = stencil.middleRows(1, count).colwise().mean();
  MatrixXd unit = MatrixXd::Identity(count + 2, count + 2);
  unit.middleCols(1, count).array() -= 1.0 / static_cast<double>(count);
  const MatrixXd h = Fit(stencil.rowwise() - mean).solve(unit);
  Vector3d at = p_.row(i).transpose();
  for (Eigen::Index k = 0; k < count; ++k) {
    const Vector3d d = (stencil.row(k + 1) - stencil.row(0)).transpose();
    at += h.col(k + 1).dot(d) / 3 * d;
  }
  return at;
}

// E_R = 12 ℓ̄² Σ w_ij ‖M_i − M_j‖², with the weights of cotangents × |p_i − p_j|² / the squared distance of the
// maps' places, within 1/16 … 4.
void Oracle::weigh_edges() {
  pairs_.clear();
  for (const auto& [i, j, cotangents] : problem_.edges) {
    const double length = (p_.row(i) - p_.row(j)).squaredNorm(), between = (place(i) - place(j)).squaredNorm();
    pairs_.push_back({i, j, cotangents * std::clamp(length / between, 1.0 / 16, 4.0)});
  }
}

// Moves a free vertex whose stencil is flat along its normal (FT05 equation 7): the smallest eigenvalue of P Pᵀ
// is below 5e-5 of the largest. Its length is (0.2 + 0.1 u) times the mean edge, where u is output number i + 1
// of SplitMix64, its upper 53 bits as a fraction of 1.
void Oracle::add_noise(std::uint64_t seed) {
  std::uint64_t state = seed;
  for (Index i = 0; i < count_; ++i) {
    state += 0x9e3779b97f4a7c15U;
    std::uint64_t z = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    const double u = std::ldexp(static_cast<double>((z ^ (z >> 31)) >> 11), -53);
    if (ring_[i].empty() || known_position_[i] || known_transform_[i]) continue;
    MatrixXd stencil(static_cast<Eigen::Index>(ring_[i].size()) + 1, 3);
    stencil.row(0) = problem_.rest.row(i);
    for (std::size_t k = 0; k < ring_[i].size(); ++k)
      stencil.row(static_cast<Eigen::Index>(k) + 1) = problem_.rest.row(ring_[i][k]);
    const Eigen::RowVector3d centre = stencil.bottomRows(stencil.rows() - 1).colwise().mean();
    stencil.rowwise() -= centre;
    const Vector3d spread =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stencil.transpose() * stencil).eigenvalues();
    if (spread[0] < 5e-5 * spread[2]) p_.row(i) += (0.2 + 0.1 * u) * mean_edge_[i] * normal_.row(i);
  }
}

// Adds the neighbours of its ring to a stencil that does not span space.
void Oracle::widen_stencils() {
  fit_ring_ = ring_;
  for (Index i = 0; i < count_; ++i) {
    if (ring_[i].empty() || known_transform_[i]) continue;
    for (int widening = 0; widening < 3; ++widening) {
      const MatrixXd stencil = centred_stencil(i, p_, apex_rest_);
      const Eigen::VectorXd spread = Eigen::JacobiSVD<MatrixXd>(stencil).singularValues();
      if (stencil.rows() >= 4 && spread[2] > 1e-8 * spread[0]) break;
      std::set<Index> wider(fit_ring_[i].begin(), fit_ring_[i].end());
      for (Index j : fit_ring_[i]) wider.insert(ring_[j].begin(), ring_[j].end());
      wider.erase(i);
      fit_ring_[i].assign(wider.begin(), wider.end());
    }
  }
}

std::vector<Index> Oracle::widened() const {
  std::vector<Index> vertices;
  for (Index i = 0; i < count_; ++i)
    if (fit_ring_[i].size() > ring_[i].size()) vertices.push_back(i);
  return vertices;
}

Eigen::RowVectorXd Oracle::umbrella(Index i, const MatrixXd& x) const {
  Eigen::RowVectorXd value = x.row(i);
  for (std::size_t k = 0; k < ring_[i].size(); ++k) value -= weight_[i][k] * x.row(ring_[i][k]);
  return value;
}

std::vector<Vector3d> Oracle::directions(const Pair& pair) const {
  const Vector3d d = (p_.row(pair.i) - p_.row(pair.j)).transpose();
  if (!problem_.apex) return {d};
  if (is_integral()) return {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  const Vector3d a = normal_.row(pair.i).transpose(), b = normal_.row(pair.j).transpose();
  // Nearly opposite normals have no mean direction, so one of them is reversed.
  const Vector3d n = a.dot(b) < -0.6 ? Vector3d(a - b) : Vector3d(a + b);
  return {d, d.norm() * n.normalized()};
}

// Implements the rule of `Density::aware`. With E_L and E_R as integrals over the surface, each row is weighted
// by the area that it represents. A factor common to all rows does not matter.
double Oracle::row_scale(Index i) const {
  return std::sqrt(problem_.laplacian_weight) * (problem_.density == Density::ft05 ? 1.0 : 1.0 / mean_edge_[i]);
}

double Oracle::row_scale(const Pair& pair) const {
  if (is_integral()) return std::sqrt(6 * pair.weight);  // and √2 for both orders of a pair
  return problem_.density == Density::ft05 ? 1.0 : 2.0 / (mean_edge_[pair.i] + mean_edge_[pair.j]);
}

MatrixXd Oracle::centred_stencil(Index i, const MatrixXd& x, const MatrixXd& a) const {
  const auto ring = static_cast<Eigen::Index>(fit_ring_[i].size());
  MatrixXd stencil(ring + (has_apex_[i] ? 2 : 1), x.cols());
  stencil.row(0) = x.row(i);
  for (Eigen::Index k = 0; k < ring; ++k) stencil.row(1 + k) = x.row(fit_ring_[i][static_cast<std::size_t>(k)]);
  const Eigen::RowVectorXd mean = stencil.middleRows(1, ring).colwise().mean();
  if (has_apex_[i]) stencil.row(ring + 1) = a.row(i);
  return stencil.rowwise() - mean;
}

void Oracle::fit_at_rest() {
  fit_.resize(count_);
  for (Index i = 0; i < count_; ++i)
    if (!ring_[i].empty() && !known_transform_[i]) fit_[i].compute(centred_stencil(i, p_, apex_rest_));
}

MatrixXd Oracle::local_map(Index i, const MatrixXd& x, const MatrixXd& a, bool homogeneous) const {
  if (!known_transform_[i]) return fit_[i].solve(centred_stencil(i, x, a));
  if (homogeneous) return MatrixXd::Zero(3, x.cols());
  return known_transform_[i]->transpose();
}

MatrixXd Oracle::rows(const MatrixXd& x, const MatrixXd& a, bool homogeneous) const {
  std::vector<MatrixXd> map(count_);
  for (Index i = 0; i < count_; ++i)
    if (!ring_[i].empty()) map[i] = local_map(i, x, a, homogeneous);

  const Eigen::Index per_pair = is_integral() ? 3 : problem_.apex ? 2 : 1;
  MatrixXd result(count_ + per_pair * static_cast<Eigen::Index>(pairs_.size()), x.cols());
  // Equation 9: E_L = Σ_i ‖ (x_i − Σ_j w_ij x_j) − M_i δ_i ‖².
  for (Index i = 0; i < count_; ++i) {
    if (ring_[i].empty())
      result.row(i).setZero();
    else
      result.row(i) = row_scale(i) * (umbrella(i, x) - umbrella(i, p_) * map[i]);
  }
  // Equation 11: E_R = Σ_i Σ_{j: (i,j) ∈ SF} ‖ (M_i − M_j)(p_i − p_j) ‖², every pair twice.
  Eigen::Index row = count_;
  for (const Pair& pair : pairs_)
    for (const Vector3d& d : directions(pair))
      result.row(row++) = std::sqrt(2.0) * row_scale(pair) * d.transpose() * (map[pair.i] - map[pair.j]);
  return result;
}

Points Oracle::with_known_positions(Points x) const {
  for (Index i = 0; i < count_; ++i)
    if (known_position_[i]) x.row(i) = known_position_[i]->transpose();
  return x;
}

MatrixXd Oracle::residuals(const Points& x, const Points& a) const {
  return rows(with_known_positions(x), a, false);
}

void Oracle::scatter(const MatrixXd& unknowns, MatrixXd& x, MatrixXd& a) const {
  x.setZero(count_, unknowns.cols());
  a.setZero(count_, unknowns.cols());
  Eigen::Index k = 0;
  for (Index i : free_) x.row(i) = unknowns.row(k++);
  for (Index i : apex_owner_) a.row(i) = unknowns.row(k++);
}

void Oracle::build_jacobian() {
  std::vector<Eigen::Index> column(count_, -1), apex_column(count_, -1);
  Eigen::Index unknowns = 0;
  for (Index i : free_) column[i] = unknowns++;
  for (Index i : apex_owner_) apex_column[i] = unknowns++;

  // Every fit is linear in its stencil, so its results for the unit vectors are its coefficients.
  struct Term {
    Eigen::Index column;
    Vector3d h;  // M dx = Σ (h·d) dx_s
  };
  std::vector<std::vector<Term>> fit_terms(count_);
  for (Index i = 0; i < count_; ++i) {
    if (ring_[i].empty() || known_transform_[i]) continue;
    const auto ring = static_cast<Eigen::Index>(fit_ring_[i].size());
    const Eigen::Index size = ring + (has_apex_[i] ? 2 : 1);
    MatrixXd unit = MatrixXd::Identity(size, size);
    unit.middleCols(1, ring).array() -= 1.0 / static_cast<double>(ring);
    const MatrixXd h = fit_[i].solve(unit);
    for (Eigen::Index s = 0; s < size; ++s) {
      const Eigen::Index c = s == 0      ? column[i]
                             : s <= ring ? column[fit_ring_[i][static_cast<std::size_t>(s - 1)]]
                                         : apex_column[i];
      if (c >= 0) fit_terms[i].push_back({c, h.col(s)});
    }
  }

  std::vector<Eigen::Triplet<double>> entries;
  const auto add_map = [&](Eigen::Index row, Index i, const Vector3d& d, double factor) {
    for (const Term& term : fit_terms[i]) entries.emplace_back(row, term.column, factor * term.h.dot(d));
  };
  for (Index i = 0; i < count_; ++i) {
    if (ring_[i].empty()) continue;
    const double scale = row_scale(i);
    if (column[i] >= 0) entries.emplace_back(i, column[i], scale);
    for (std::size_t k = 0; k < ring_[i].size(); ++k)
      if (column[ring_[i][k]] >= 0) entries.emplace_back(i, column[ring_[i][k]], -scale * weight_[i][k]);
    add_map(i, i, umbrella(i, p_).transpose(), -scale);
  }
  Eigen::Index row = count_;
  for (const Pair& pair : pairs_)
    for (const Vector3d& d : directions(pair)) {
      const double scale = std::sqrt(2.0) * row_scale(pair);
      add_map(row, pair.i, d, scale);
      add_map(row, pair.j, d, -scale);
      ++row;
    }
  jacobian_.resize(row, unknowns);
  jacobian_.setFromTriplets(entries.begin(), entries.end());
}

Points Oracle::best_apexes(const Points& x) const {
  Points apexes = apex_rest_;
  if (apex_owner_.empty()) return apexes;
  const auto count = static_cast<Eigen::Index>(apex_owner_.size());
  const Eigen::SparseMatrix<double> j = jacobian_.rightCols(count);
  const Eigen::SparseMatrix<double> normal = j.transpose() * j;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal);
  // The first pass solves. The others remove the rounding errors of the normal equations.
  for (int pass = 0; pass < 4; ++pass) {
    const MatrixXd step = factor.solve(j.transpose() * residuals(x, apexes));
    for (Eigen::Index k = 0; k < count; ++k)
      apexes.row(apex_owner_[static_cast<std::size_t>(k)]) -= step.row(k);
  }
  return apexes;
}

double Oracle::energy(const Points& x) const { return residuals(x, best_apexes(x)).squaredNorm(); }

double Oracle::relative_gradient(const Points& x) const {
  const MatrixXd r = residuals(x, best_apexes(x));
  const Eigen::SparseMatrix<double> j = jacobian_.leftCols(static_cast<Eigen::Index>(free_.size()));
  const double size = (j.cwiseAbs().transpose() * r.cwiseAbs()).norm();
  return size > 0 ? (j.transpose() * r).norm() / size : 0;
}

Points Oracle::dense_minimum() const {
  const Eigen::Index unknowns = jacobian_.cols();
  MatrixXd x, a;
  scatter(MatrixXd::Identity(unknowns, unknowns), x, a);
  const Eigen::ColPivHouseholderQR<MatrixXd> factor(rows(x, a, true));
  // Solves for displacements from rest, so that large coordinates do not cost digits.
  const Points start = with_known_positions(p_);
  const MatrixXd step = factor.solve(-residuals(start, apex_rest_));
  scatter(step, x, a);
  return start + x;
}

Points Oracle::moved_back(const Points& x_moved) const {
  Points x = x_moved;
  for (Index i : free_)
    x.row(i) +=
        (problem_.rest.row(i) - p_.row(i)) * local_map(i, with_known_positions(x_moved), apex_rest_, false);
  return x;
}

}  // namespace meshgraft::test
