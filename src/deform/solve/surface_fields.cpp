#include "surface_fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/sparse_checks.h"
#include "linalg/backends.h"
#include "linalg/sparse.h"
#include "operators/laplacian.h"
#include "strip_width.h"
#include "vertex_solver.h"

namespace meshgraft {

namespace {

/// The tolerance of an iterative backend. Errors of the fields carry over to positions.
constexpr double solver_tolerance = 1e-7;

SparseRows diagonal(const std::vector<double>& values) {
  const auto n = static_cast<Eigen::Index>(values.size());
  SparseRows matrix(n, n);
  matrix.reserve(std::vector<int>(values.size(), 1));
  for (Eigen::Index i = 0; i < n; ++i) matrix.insertBackUncompressed(i, i) = values[i];
  matrix.makeCompressed();
  return matrix;
}

// Rows that are copied between two checks: with a hundred columns a few megabytes.
constexpr std::size_t rows_at_once = 4096;

/// Calls `body(row)` for all rows.
template <class Body>
void for_rows(Eigen::Index rows, const Context& context, const Body& body) {
  parallel_blocks(
      static_cast<std::size_t>(rows),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) body(static_cast<Eigen::Index>(row));
      },
      context, rows_at_once);
}

/// Calls `body(vertex, k)` for the k-th vertex of a list.
template <class Body>
void for_vertices(const std::vector<Index>& vertices, const Context& context, const Body& body) {
  for_rows(static_cast<Eigen::Index>(vertices.size()), context, [&](Eigen::Index k) { body(vertices[k], k); });
}

/// Returns a millionth of the mean area of the vertices with a ring.
double smallest_area_of(const std::vector<double>& areas, const IndexLists& rings) {
  double total = 0;
  Index count = 0;
  for (Index v = 0; v < rings.size(); ++v) {
    total += areas[v];
    count += !rings[v].empty();
  }
  return total > 0 ? 1e-6 * total / static_cast<double>(count) : 1.0;
}

/// Raises the areas of vertices with a ring to at least `smallest`.
void bound_areas(double smallest, const IndexLists& rings, std::vector<double>& areas) {
  for (Index v = 0; v < rings.size(); ++v)
    if (!rings[v].empty()) areas[v] = std::max(areas[v], smallest);
}

}  // namespace

BendingMatrix::BendingMatrix(const FieldSurface& surface, const Context& context)
    : areas(vertex_areas(surface.points, surface.triangles)),
      smallest_area(smallest_area_of(areas, surface.rings)) {
  bound_areas(smallest_area, surface.rings, areas);
  std::vector<double> inverse_areas;
  for (const double area : areas) inverse_areas.push_back(area > 0 ? 1 / area : 0);
  context.throw_if_stopped();
  SparseRows K = dirichlet_matrix(surface.rings.size(), surface.edges);
  take_over(matrix, multiply(multiply(K, diagonal(inverse_areas), context), K, context));
  take_over(tension, K);
}

SurfaceFields::SurfaceFields(const FieldSurface& surface, std::span<const std::uint8_t> given,
                             std::shared_ptr<const BendingMatrix> bending_matrix,
                             const SurfaceFieldOptions& options, const Context& context)
    : bending_(std::move(bending_matrix)),
      areas_(vertex_areas(surface.points, surface.triangles)),
      passes_(options.corrects ? 2 : 1) {
  const auto& [points, triangles, rings, edges, bisection] = surface;
  context.throw_if_stopped();
  find_components(rings, given);
  if (free_.empty()) return;
  context.throw_if_stopped();

  const double smallest = smallest_area_of(areas_, rings);
  const std::shared_ptr<const BendingMatrix> used =
      bounds_alike(rings, smallest) ? bending_ : std::make_shared<const BendingMatrix>(surface, context);
  bound_areas(smallest, rings, areas_);
  const std::optional<double> bending_length_rel = options.bending_length_rel;
  if (!spread_to_.empty()) {
    take_over(spread_rows_, energy_rows(*used, spread_to_, bending_length_rel, context));
    context.throw_if_stopped();
    spread_solver_ =
        factorise_vertices(spread_rows_, {spread_to_, &rings, bisection, points(spread_to_, Eigen::all)},
                           options.backend, context);
  }
  if (!options.smoothing_length_rel) return;
  std::vector<double> weights = free_widths(bending_length_rel, context);
  for (double& width : weights) width = std::pow(*options.smoothing_length_rel * width, 2);
  // Components do not share a row, so scaling rows by component keeps the matrix symmetric.
  context.throw_if_stopped();
  SparseRows smoothing = energy_rows(*used, free_, smoothing_bending_length_rel, context);
  for_vertices(free_, context, [&](Index v, Eigen::Index k) {
    for (SparseRows::InnerIterator it(smoothing, k); it; ++it) {
      it.valueRef() *= weights[component_[v]];
      if (it.col() == v) it.valueRef() += areas_[v];
    }
  });
  context.throw_if_stopped();
  if (spread_solver_ && spread_to_ == free_) smooth_solver_ = copy_analysis(*spread_solver_);
  if (smooth_solver_)
    factorise_vertices(smoothing, free_, *smooth_solver_, context);
  else
    smooth_solver_ = factorise_vertices(smoothing, {free_, &rings, bisection, points(free_, Eigen::all)},
                                        options.backend, context);
}

/// Returns whether areas raised to `smallest` are those of the bending matrix.
bool SurfaceFields::bounds_alike(const IndexLists& rings, double smallest) const {
  if (smallest == bending_->smallest_area) return true;
  const double larger = std::max(smallest, bending_->smallest_area);
  for (Index v = 0; v < rings.size(); ++v)
    if (!rings[v].empty() && areas_[v] < larger) return false;
  return true;
}

void SurfaceFields::find_components(const IndexLists& rings, std::span<const std::uint8_t> given) {
  component_.assign(rings.size(), -1);
  std::vector<Index> queue;
  for (Index start = 0; start < rings.size(); ++start) {
    if (rings[start].empty() || component_[start] >= 0) continue;
    const Index number = static_cast<Index>(constrained_.size());
    constrained_.push_back(0);
    component_[start] = number;
    queue.assign(1, start);
    while (!queue.empty()) {
      const Index v = queue.back();
      queue.pop_back();
      constrained_[number] |= given[v];
      for (const Index w : rings[v]) {
        if (component_[w] >= 0) continue;
        component_[w] = number;
        queue.push_back(w);
      }
    }
  }
  for (Index v = 0; v < rings.size(); ++v) {
    if (component_[v] < 0) continue;
    if (given[v]) {
      given_.push_back(v);
    } else {
      free_.push_back(v);
      if (constrained_[component_[v]]) spread_to_.push_back(v);
    }
  }
}

/// Returns the area of the vertices without a given value per component.
std::vector<double> SurfaceFields::free_areas() const {
  std::vector<double> areas(constrained_.size(), 0.0);
  for (const Index v : free_) areas[component_[v]] += areas_[v];
  return areas;
}

/// Returns rows `vertices` of the energy's matrix: K + t² K M⁻¹ K, or K M⁻¹ K.
SparseRows SurfaceFields::energy_rows(const BendingMatrix& bending, const std::vector<Index>& vertices,
                                      std::optional<double> bending_length_rel, const Context& context) const {
  SparseRows rows = select_rows(bending.matrix, vertices, context);
  if (!bending_length_rel) return rows;
  std::vector<double> squares = free_areas();
  for (double& square : squares) square *= *bending_length_rel * *bending_length_rel;
  for_vertices(vertices, context, [&](Index v, Eigen::Index k) {
    SparseRows::InnerIterator tension(bending.tension, v);
    for (SparseRows::InnerIterator it(rows, k); it; ++it) {
      it.valueRef() *= squares[component_[v]];
      if (!tension || tension.col() != it.col()) continue;
      it.valueRef() += tension.value();
      ++tension;
    }
  });
  return rows;
}

/// Returns per component the width of the surface between vertices with given values, from the mean sag under
/// a uniform load. The width is √(area) if nothing is given.
std::vector<double> SurfaceFields::free_widths(std::optional<double> bending_length_rel,
                                               const Context& context) const {
  const std::vector<double> areas = free_areas();
  std::vector<double> sags(constrained_.size(), 0.0), widths;
  if (!spread_to_.empty()) {
    Eigen::MatrixXd load(static_cast<Eigen::Index>(spread_to_.size()), 1);
    for (std::size_t k = 0; k < spread_to_.size(); ++k)
      load(static_cast<Eigen::Index>(k), 0) = areas_[spread_to_[k]];
    const Eigen::MatrixXd sag = spread_solver_->solve(load, context);
    for (std::size_t k = 0; k < spread_to_.size(); ++k)
      sags[component_[spread_to_[k]]] += areas_[spread_to_[k]] * sag(static_cast<Eigen::Index>(k), 0);
  }
  for (std::size_t c = 0; c < constrained_.size(); ++c)
    widths.push_back(constrained_[c] && areas[c] > 0
                         ? strip_width(std::max(sags[c] / areas[c], 0.0),
                                       bending_length_rel
                                           ? std::optional(*bending_length_rel * std::sqrt(areas[c]))
                                           : std::nullopt)
                         : std::sqrt(areas[c]));
  return widths;
}

Columns SurfaceFields::spread(Columns values, const Context& context) const {
  if (spread_to_.empty()) return values;
  // Solves for differences from a given value of each component, so that a constant stays exactly constant.
  const Columns origins = one_given_value(values);
  for_vertices(spread_to_, context, [&](Index v, Eigen::Index) { values.row(v) = origins.row(component_[v]); });
  const std::vector<Eigen::Index> varying = columns_that_vary(values, origins, context);
  constexpr std::size_t at_once = 32;  // bounds the memory beside the values
  Columns differences, sides;
  for (std::size_t first = 0; first < varying.size(); first += at_once) {
    const std::span columns = std::span(varying).subspan(first, std::min(at_once, varying.size() - first));
    const auto width = static_cast<Eigen::Index>(columns.size());
    differences.resize(values.rows(), width);
    for_rows(differences.rows(), context, [&](Eigen::Index v) { differences.row(v).setZero(); });
    for_vertices(given_, context, [&](Index v, Eigen::Index) {
      for (Eigen::Index c = 0; c < width; ++c)
        differences(v, c) = values(v, columns[c]) - origins(component_[v], columns[c]);
    });
    for (int pass = 0; pass < passes_; ++pass) {  // the second pass corrects with the residual of the first
      multiply(spread_rows_, differences, sides, context);
      spread_solver_->solve_in_place(sides, {.tolerance = std::pow(solver_tolerance, 1.0 / passes_)}, context);
      for_vertices(spread_to_, context, [&](Index v, Eigen::Index k) { differences.row(v) -= sides.row(k); });
    }
    for_vertices(spread_to_, context, [&](Index v, Eigen::Index) {
      for (Eigen::Index c = 0; c < width; ++c) values(v, columns[c]) += differences(v, c);
    });
  }
  return values;
}

/// Returns a given value of each component, by rows.
Columns SurfaceFields::one_given_value(const Columns& values) const {
  Columns given = Columns::Zero(static_cast<Eigen::Index>(constrained_.size()), values.cols());
  Flags is_known(constrained_.size(), 0);
  for (const Index v : given_)
    if (std::exchange(is_known[component_[v]], std::uint8_t{1}) == 0) given.row(component_[v]) = values.row(v);
  return given;
}

/// Returns the columns whose given values differ from the `origins` of their component.
std::vector<Eigen::Index> SurfaceFields::columns_that_vary(const Columns& values, const Columns& origins,
                                                           const Context& context) const {
  Flags varies(values.cols(), 0);
  SparseChecks check(context, rows_at_once);
  for (const Index v : given_) {
    check();
    for (Eigen::Index c = 0; c < values.cols(); ++c) varies[c] |= values(v, c) != origins(component_[v], c);
  }
  std::vector<Eigen::Index> varying;
  for (Eigen::Index c = 0; c < values.cols(); ++c)
    if (varies[c]) varying.push_back(c);
  return varying;
}

Columns SurfaceFields::smooth(const Columns& values, const Columns& guess, const Context& context,
                              double tolerance) const {
  Columns fields = Columns::Zero(values.rows(), values.cols());
  if (free_.empty()) return fields;
  Columns weighted(static_cast<Eigen::Index>(free_.size()), values.cols());
  for_vertices(free_, context, [&](Index v, Eigen::Index k) { weighted.row(k) = areas_[v] * values.row(v); });
  SolveOptions options{.tolerance = std::max(tolerance, solver_tolerance)};
  Eigen::MatrixXd start;
  if (smooth_solver_->statistics().backend == SolverBackend::iterative) {
    start = guess(free_, Eigen::all);
    options.guess = &start;
  }
  smooth_solver_->solve_in_place(weighted, options, context);
  for_vertices(free_, context, [&](Index v, Eigen::Index k) { fields.row(v) = weighted.row(k); });
  return fields;
}

}  // namespace meshgraft
