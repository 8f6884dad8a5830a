#include "part_fields.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "components.h"
#include "deform/solve/strip_width.h"
#include "deform/solve/surface_fields.h"
#include "operators/intrinsic_delaunay.h"
#include "operators/laplacian.h"

namespace meshgraft::distributed {

namespace {

SparseRows diagonal(const std::vector<double>& values) {
  SparseRows matrix =
      rows_of_lengths(std::vector<int>(values.size(), 1), static_cast<Eigen::Index>(values.size()));
  std::iota(matrix.innerIndexPtr(), matrix.innerIndexPtr() + values.size(), 0);
  std::copy(values.begin(), values.end(), matrix.valuePtr());
  return matrix;
}

Halo number_unknowns(const Communicator& comm, const Part& part, const Flags& unknown) {
  const Halo& vertices = part.mesh.vertices;
  const std::vector<Number> starts =
      comm.starts(std::count(unknown.begin(), unknown.begin() + vertices.own(), std::uint8_t{1}));
  std::vector<Number> number(vertices.size(), -1), copies;
  for (Index v = 0, next = 0; v < vertices.own(); ++v)
    if (unknown[v]) number[v] = starts[comm.rank()] + next++;
  vertices.update(number);
  for (Index v = vertices.own(); v < vertices.size(); ++v)
    if (unknown[v]) copies.push_back(number[v]);
  return Halo(comm, starts, std::move(copies));
}

}  // namespace

VertexSystem::VertexSystem(const Communicator& comm, const Part& part, SparseRows rows, const Flags& unknown,
                           const ParallelSolverOptions& options)
    : part_(part), rows_(std::move(rows)), unknown_(unknown), unknowns_(number_unknowns(comm, part, unknown)) {
  if (empty()) return;
  const Index own = part.mesh.vertices.own();
  std::vector<Index> local(unknown.size(), -1);
  for (std::size_t v = 0, next = 0; v < unknown.size(); ++v)
    if (unknown[v]) local[v] = static_cast<Index>(next++);
  MatrixRows matrix;
  UnknownNodes nodes{&part.mesh, {}, Points(unknowns_.own(), 3), unknown};
  std::vector<std::pair<Number, double>> entries;
  for (Index v = 0; v < own; ++v) {
    if (!unknown[v]) continue;
    entries.clear();
    for (SparseRows::InnerIterator it(rows_, v); it; ++it)
      if (unknown[it.col()]) entries.emplace_back(unknowns_.number(local[it.col()]), it.value());
    std::sort(entries.begin(), entries.end());
    for (const auto& [column, value] : entries) {
      matrix.columns.push_back(column);
      matrix.values.push_back(value);
    }
    matrix.offsets.push_back(static_cast<std::int64_t>(matrix.columns.size()));
    nodes.positions.row(static_cast<Eigen::Index>(nodes.vertex.size())) = part.points.row(v);
    nodes.vertex.push_back(v);
  }
  solver_.emplace(comm, std::move(matrix), nodes, options);
}

Columns VertexSystem::multiply(const Columns& fields) const {
  return meshgraft::multiply(rows_, fields, {.threads = 1});
}

Columns VertexSystem::solve(const Columns& rhs, double tolerance) const {
  Columns values = Columns::Zero(part_.mesh.vertices.size(), rhs.cols());
  if (empty()) return values;
  Columns of_unknowns(unknowns_.own(), rhs.cols());
  Eigen::Index row = 0;
  for (Index v = 0; v < part_.mesh.vertices.own(); ++v)
    if (unknown_[v]) of_unknowns.row(row++) = rhs.row(v);
  const Columns solution = solver_->solve(of_unknowns, tolerance, nullptr);
  row = 0;
  for (Index v = 0; v < part_.mesh.vertices.own(); ++v)
    if (unknown_[v]) values.row(v) = solution.row(row++);
  part_.mesh.vertices.update(values);
  return values;
}

PartFields::PartFields(const Communicator& comm, const Part& part, const Flags& given, double tolerance,
                       std::optional<double> smoothing_length_rel)
    : comm_(comm),
      part_(part),
      given_(given),
      tolerance_(tolerance),
      areas_(vertex_areas(part.points, part.mesh.triangles)) {
  const Index count = part.mesh.vertices.size(), own = part.mesh.vertices.own();
  Flags in_faces(count);
  for (Index v = 0; v < count; ++v) in_faces[v] = !part.mesh.rings[v].empty();
  component_ = find_components(comm, part.mesh, in_faces,
                               std::vector<Number>(part.original.begin(), part.original.end()));
  Eigen::VectorXd total = Eigen::VectorXd::Zero(2);
  for (Index v = 0; v < own; ++v)
    if (in_faces[v]) total += Eigen::Vector2d(areas_[v], 1);
  total = comm.sum(total);
  const double smallest = total[0] > 0 ? 1e-6 * total[0] / total[1] : 1.0;
  LabelValues sums;
  for (Index v = 0; v < count; ++v) {
    if (!in_faces[v]) continue;
    areas_[v] = std::max(areas_[v], smallest);
    Eigen::VectorXd& sum = sums.try_emplace(component_[v], Eigen::VectorXd::Zero(3)).first->second;
    if (v < own) sum[given[v] ? 1 : 0] += areas_[v], sum[2] += given[v];
  }
  sums_ = sum_by_label(comm, sums);

  comm.together([&] {
    std::vector<double> inverse(areas_.size());
    std::transform(areas_.begin(), areas_.end(), inverse.begin(),
                   [](double area) { return area > 0 ? 1 / area : 0; });
    const SparseRows K =
        dirichlet_matrix(count, intrinsic_delaunay_edges(part.points, part.mesh.triangles, {.threads = 1}));
    tension_ = K.topRows(own);
    bending_ = meshgraft::multiply(meshgraft::multiply(tension_, diagonal(inverse), {.threads = 1}), K,
                                   {.threads = 1});
  });
  Flags unknown(count);
  for (Index v = 0; v < count; ++v) unknown[v] = in_faces[v] && !given[v] && is_constrained(component_[v]);
  spreading_.emplace(comm, part, energy_rows(spreading_length_rel), unknown,
                     ParallelSolverOptions{.prefix = "field_"});
  if (smoothing_length_rel) set_up_smoothing(*smoothing_length_rel);
}

/// Returns own rows of K + t² K M⁻¹ K, with t relative to the size of each component.
SparseRows PartFields::energy_rows(double bending_length_rel) const {
  SparseRows rows = bending_;
  for (Eigen::Index v = 0; v < rows.rows(); ++v) {
    if (component_[v] < 0) continue;
    const double square = bending_length_rel * bending_length_rel * free_area(component_[v]);
    SparseRows::InnerIterator tension(tension_, v);
    for (SparseRows::InnerIterator it(rows, v); it; ++it) {
      it.valueRef() *= square;
      if (!tension || tension.col() != it.col()) continue;
      it.valueRef() += tension.value();
      ++tension;
    }
  }
  return rows;
}

/// Returns the width of each component between vertices with given values, from the mean sag under a load.
LabelValues PartFields::widths(double bending_length_rel) const {
  const Index own = part_.mesh.vertices.own();
  Columns load = Columns::Zero(own, 1);
  for (Index v = 0; v < own; ++v) load(v, 0) = areas_[v];
  const Columns sag = spreading_->solve(load, tolerance_);
  LabelValues sags;
  for (Index v = 0; v < part_.mesh.vertices.size(); ++v) {
    if (component_[v] < 0) continue;
    Eigen::VectorXd& sum = sags.try_emplace(component_[v], Eigen::VectorXd::Zero(1)).first->second;
    if (v < own && !given_[v]) sum[0] += areas_[v] * sag(v, 0);
  }
  LabelValues widths = sum_by_label(comm_, sags);
  for (auto& [label, width] : widths) {
    const double area = free_area(label);
    width[0] = is_constrained(label) && area > 0
                   ? strip_width(std::max(width[0] / area, 0.0), bending_length_rel * std::sqrt(area))
                   : std::sqrt(area);
  }
  return widths;
}

void PartFields::set_up_smoothing(double length_rel) {
  const LabelValues width = widths(spreading_length_rel);
  SparseRows rows = energy_rows(smoothing_bending_length_rel);
  for (Eigen::Index v = 0; v < rows.rows(); ++v) {
    if (component_[v] < 0) continue;
    const double weight = std::pow(length_rel * width.at(component_[v])[0], 2);
    for (SparseRows::InnerIterator it(rows, v); it; ++it) {
      it.valueRef() *= weight;
      if (it.col() == v) it.valueRef() += areas_[v];
    }
  }
  Flags unknown(given_.size());
  for (std::size_t v = 0; v < unknown.size(); ++v) unknown[v] = component_[v] >= 0 && !given_[v];
  smoothing_.emplace(comm_, part_, std::move(rows), unknown, ParallelSolverOptions{.prefix = "field_"});
}

/// Solves for differences from the mean of each component's given values, twice, as `SurfaceFields::spread`
/// does.
Columns PartFields::spread(const Columns& values) const {
  if (spreading_->empty()) return values;
  const Index count = part_.mesh.vertices.size(), own = part_.mesh.vertices.own();
  LabelValues means;
  for (Index v = 0; v < count; ++v) {
    if (component_[v] < 0) continue;
    Eigen::VectorXd& mean =
        means.try_emplace(component_[v], Eigen::VectorXd::Zero(values.cols())).first->second;
    if (v < own && given_[v]) mean += areas_[v] * values.row(v).transpose();
  }
  means = sum_by_label(comm_, means);
  for (auto& [label, mean] : means)
    if (is_constrained(label)) mean /= sums_.at(label)[1];
  Columns differences = Columns::Zero(count, values.cols());
  for (Index v = 0; v < count; ++v)
    if (component_[v] >= 0 && given_[v])
      differences.row(v) = values.row(v) - means.at(component_[v]).transpose();
  for (int pass = 0; pass < 2; ++pass)
    differences += spreading_->solve(-spreading_->multiply(differences), std::sqrt(tolerance_));
  Columns fields = values;
  for (Index v = 0; v < count; ++v)
    if (component_[v] >= 0 && !given_[v] && is_constrained(component_[v]))
      fields.row(v) = differences.row(v) + means.at(component_[v]).transpose();
  return fields;
}

Columns PartFields::smooth(const Columns& values) const {
  Columns weighted = values.topRows(part_.mesh.vertices.own());
  for (Eigen::Index v = 0; v < weighted.rows(); ++v) weighted.row(v) *= areas_[v];
  return smoothing_->solve(weighted, tolerance_);
}

}  // namespace meshgraft::distributed
