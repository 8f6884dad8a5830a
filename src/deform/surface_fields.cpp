#include "surface_fields.h"

#include <algorithm>
#include <cmath>

#include <meshgraft/operators/laplacian.h>

namespace meshgraft {

namespace {

SparseRows diagonal(const std::vector<double>& values, double factor = 1) {
  const auto n = static_cast<Eigen::Index>(values.size());
  SparseRows matrix(n, n);
  matrix.reserve(std::vector<int>(values.size(), 1));
  for (Eigen::Index i = 0; i < n; ++i) matrix.insertBackUncompressed(i, i) = factor * values[i];
  matrix.makeCompressed();
  return matrix;
}

/// Rows `rows` of a matrix.
SparseRows select_rows(const SparseRows& matrix, const std::vector<Index>& rows) {
  SparseRows selected(static_cast<Eigen::Index>(rows.size()), matrix.cols());
  std::vector<int> lengths;
  for (const Index row : rows) lengths.push_back(matrix.outerIndexPtr()[row + 1] - matrix.outerIndexPtr()[row]);
  selected.reserve(lengths);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (SparseRows::InnerIterator it(matrix, rows[k]); it; ++it)
      selected.insertBackUncompressed(static_cast<Eigen::Index>(k), it.col()) = it.value();
  selected.makeCompressed();
  return selected;
}

/// Lower triangle of the square part of `rows` (of the vertices `unknown`) whose columns are unknown too.
NormalMatrix square_part(const SparseRows& rows, const std::vector<Index>& unknown) {
  std::vector<Index> place(static_cast<std::size_t>(rows.cols()), -1);
  for (std::size_t k = 0; k < unknown.size(); ++k) place[unknown[k]] = static_cast<Index>(k);
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  for (Eigen::Index k = 0; k < rows.rows(); ++k)
    for (SparseRows::InnerIterator it(rows, k); it; ++it)
      if (place[it.col()] >= 0 && place[it.col()] <= k) entries.emplace_back(k, place[it.col()], it.value());
  NormalMatrix lower(rows.rows(), rows.rows());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

std::unique_ptr<LinearSolver> factorise(const NormalMatrix& matrix, SolverBackend backend,
                                        const Context& context) {
  auto solver = make_solver(backend);
  solver->analyse(matrix, context);
  solver->factorise(matrix, context);
  return solver;
}

}  // namespace

SurfaceFields::SurfaceFields(const Points& points, const Triangles& triangles, const IndexLists& rings,
                             std::span<const std::uint8_t> given, double smoothing_length_rel,
                             SolverBackend backend, const Context& context)
    : areas_(vertex_areas(points, triangles)) {
  for (Index v = 0; v < rings.size(); ++v)
    if (!rings[v].empty()) (given[v] ? given_ : unknown_).push_back(v);
  if (unknown_.empty()) return;

  double total = 0;
  for (const double area : areas_) total += area;
  const double smallest = 1e-6 * total / static_cast<double>(areas_.size());
  std::vector<double> inverse_areas;
  for (double& area : areas_) inverse_areas.push_back(1 / (area = std::max(area, smallest)));

  const SparseRows K = dirichlet_matrix(points, triangles, rings, context);
  const SparseRows bending = multiply(multiply(K, diagonal(inverse_areas), context), K, context);
  // The share of M makes components without a given value regular; it is too small to be felt elsewhere.
  const double regular = 1e-9 / (total * total);
  spread_rows_ = select_rows(bending + diagonal(areas_, regular), unknown_);
  spread_solver_ = factorise(square_part(spread_rows_, unknown_), backend, context);
  const double weight = std::pow(smoothing_length_rel * free_width(total, context), 4);
  const SparseRows smoothing = select_rows(diagonal(areas_) + weight * bending, unknown_);
  smooth_solver_ = factorise(square_part(smoothing, unknown_), backend, context);
}

/// How wide the surface is between the places where values are given: a plate of width w that is clamped there
/// sags by w⁴/720 in the mean under a uniform load (Euler and Bernoulli's beam).
double SurfaceFields::free_width(double total_area, const Context& context) const {
  Eigen::MatrixXd load(static_cast<Eigen::Index>(unknown_.size()), 1);
  for (std::size_t k = 0; k < unknown_.size(); ++k) load(static_cast<Eigen::Index>(k), 0) = areas_[unknown_[k]];
  const double mean_sag = load.col(0).dot(spread_solver_->solve(load, context).col(0)) / load.sum();
  const double widest = 4 * std::sqrt(total_area);  // where nothing is given, nothing holds the plate
  return std::min(std::pow(720 * std::max(mean_sag, 0.0), 0.25), widest);
}

Columns SurfaceFields::spread(const Columns& values, const Context& context) const {
  if (unknown_.empty()) return values;
  // As differences from the mean of what is given: a constant stays one to the last bit.
  Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(values.cols());
  double area = 0;
  for (const Index v : given_) {
    mean += areas_[v] * values.row(v);
    area += areas_[v];
  }
  if (area > 0) mean /= area;
  Columns fields = values.rowwise() - mean;
  for (const Index v : unknown_) fields.row(v).setZero();
  for (int pass = 0; pass < 2; ++pass)  // the second is a correction with the residual of the first
    add(spread_solver_->solve(-Eigen::MatrixXd(multiply(spread_rows_, fields, context)), context), fields);
  fields.rowwise() += mean;
  for (const Index v : given_) fields.row(v) = values.row(v);
  return fields;
}

Columns SurfaceFields::smooth(const Columns& values, const Context& context) const {
  Columns fields = Columns::Zero(values.rows(), values.cols());
  if (unknown_.empty()) return fields;
  Eigen::MatrixXd weighted(static_cast<Eigen::Index>(unknown_.size()), values.cols());
  for (std::size_t k = 0; k < unknown_.size(); ++k)
    weighted.row(static_cast<Eigen::Index>(k)) = areas_[unknown_[k]] * values.row(unknown_[k]);
  add(smooth_solver_->solve(weighted, context), fields);
  return fields;
}

void SurfaceFields::add(const Eigen::MatrixXd& unknown, Columns& fields) const {
  for (std::size_t k = 0; k < unknown_.size(); ++k)
    fields.row(unknown_[k]) += unknown.row(static_cast<Eigen::Index>(k));
}

}  // namespace meshgraft
