#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <meshgraft/core/error.h>
#include <meshgraft/distributed.h>

#include "components.h"
#include "core/facts.h"
#include "core/stopwatch.h"
#include "deform/facts.h"
#include "deform/setup/checks.h"
#include "deform/setup/region_mask.h"
#include "distributed/facts.h"
#include "operators/local_maps.h"
#include "part.h"
#include "part_rotation.h"
#include "part_system.h"
#include "partition.h"
#include "petsc_objects.h"

namespace meshgraft {

using namespace distributed;

std::string_view to_string(Preconditioner value) {
  switch (value) {
    case Preconditioner::blended: return "blended";
    case Preconditioner::gamg: return "gamg";
    case Preconditioner::hypre: return "hypre";
    case Preconditioner::mumps: return "mumps";
  }
  return "";
}

namespace {

/// Edges from a row's vertex to the farthest vertex whose faces the row depends on: two to the other vertex of
/// a pair, one to its stencil, and three by which a stencil without enough directions is widened.
constexpr int row_reach = 6;

/// Returns the mask of the own vertices. Throws Error(input) for constraints and anchors that cannot be.
ConstraintMask mask_of(const LocalProblem& problem, ConstraintList& constrained) {
  const auto own = static_cast<Index>(problem.rest.rows());
  if (static_cast<Index>(problem.movable.size()) != own)
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::positions, .given = problem.movable.size(), .needed = own});
  Region region{.anchors = problem.anchors};
  for (Index v = 0; v < own; ++v)
    if (problem.movable[v]) region.vertices.push_back(v);
  return make_mask(own, region, problem.constraints, constrained);
}

std::vector<NumberedTriangle> numbered(const LocalProblem& problem, Number first, Number vertex_count) {
  std::vector<NumberedTriangle> triangles;
  triangles.reserve(problem.triangles.rows());
  for (Eigen::Index t = 0; t < problem.triangles.rows(); ++t) {
    NumberedTriangle triangle{first + t, {}};
    for (int c = 0; c < 3; ++c) {
      const Number v = problem.triangles(t, c);
      if (v < 0 || v >= vertex_count)
        throw Error(facts::core::NoSuchVertex{.vertex = v, .count = vertex_count});
      triangle.corners[static_cast<std::size_t>(c)] = v;
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

/// Throws Error(input) if two faces of the patch run along an edge at an own vertex in one direction.
void require_oriented(const LocalMesh& mesh, const Flags& in_patch) {
  std::vector<Index> ends;
  for (Index v = 0; v < mesh.vertices.own(); ++v) {
    if (!in_patch[v]) continue;
    ends.clear();
    for (const Index t : mesh.faces_at[v]) {
      const auto corners = mesh.triangles.row(t);
      if (std::any_of(corners.begin(), corners.end(), [&](Index w) { return !in_patch[w]; })) continue;
      for (int c = 0; c < 3; ++c)
        if (corners[c] == v) ends.push_back(corners[(c + 1) % 3]);
    }
    std::sort(ends.begin(), ends.end());
    if (std::adjacent_find(ends.begin(), ends.end()) != ends.end())
      throw Error(facts::distributed::InconsistentOrientation{.vertex = mesh.vertices.number(v)});
  }
}

}  // namespace

struct DistributedDeformer::Impl {
  Communicator comm;
  DistributedOptions options;
  Points rest;  ///< own vertices of the whole mesh
  Number first = 0;
  ConstraintMask mask;  ///< likewise
  ConstraintList constrained;
  std::optional<Redistribution> redistribution;
  Part part;
  std::optional<PartSystem> system;
  std::optional<PartRotation> rotation;  ///< absent for `ft05`
  DistributedSummary summary;

  Impl(MPI_Comm mpi, const LocalProblem& problem, const DistributedOptions& chosen)
      : comm(mpi), options(chosen), rest(problem.rest) {
    comm.together([&] {
      validate(options.deformer);
      validate(options.deformer.operators);
      mask = mask_of(problem, constrained);
      start_petsc();
    });
    Stopwatch watch;
    divide(problem);
    summary.partition_seconds = watch.lap();
    make_system(problem);
    summary.assemble_seconds = watch.lap() - summary.factorise_seconds;
  }

  void divide(const LocalProblem& problem);
  void place_patch(const LocalMesh& mesh, const Flags& in_patch);
  void fill_part(const LocalMesh& mesh);
  void make_system(const LocalProblem& problem);
  void measure_parts();
  PartValues values_of(std::span<const VertexConstraint> constraints) const;
  std::vector<GivenTransform> transforms_of(std::span<const VertexConstraint> constraints) const;
  Points place(const Columns& displacements, std::span<const VertexConstraint> constraints) const;
  void measure(const Columns& y, const PartValues& values, const PartRotation::Result& found,
               EvaluationReport& report) const;
  double transform_deviation(const Columns& y, const PartValues& values) const;
};

/// Cuts the patch out of the mesh and divides it among the ranks.
void DistributedDeformer::Impl::divide(const LocalProblem& problem) {
  const std::vector<Number> starts = comm.starts(static_cast<Number>(rest.rows()));
  const std::vector<Number> face_starts = comm.starts(static_cast<Number>(problem.triangles.rows()));
  first = starts[comm.rank()];
  summary.vertices = starts.back();
  summary.faces = face_starts.back();
  std::vector<NumberedTriangle> triangles;
  comm.together([&] { triangles = numbered(problem, face_starts[comm.rank()], starts.back()); });
  const LocalMesh mesh = make_local_mesh(comm, starts, triangles, 0);
  std::vector<NumberedTriangle>().swap(triangles);

  const int order = options.deformer.operators.laplacian_order;
  Flags active(rest.rows(), 0);
  for (Index v = 0; v < mesh.vertices.own(); ++v) {
    if (mesh.faces_at[v].empty()) mask.position[v] = mask.transform[v] = 1;
    active[v] = mask.is_unknown(v);
  }
  const Flags in_patch = flag_patch(mesh, active, order + 2);
  place_patch(mesh, in_patch);
  comm.together([&] { require_oriented(mesh, in_patch); });
  redistribution.emplace(comm, mesh, partition_vertices(comm, mesh, in_patch), row_reach + order - 1);
  fill_part(mesh);
}

/// Finds the centre and the scale of the patch. Throws Error(input) if a position is not finite.
void DistributedDeformer::Impl::place_patch(const LocalMesh& mesh, const Flags& in_patch) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(infinity), high = -low;
  comm.together([&] {
    for (Index v = 0; v < mesh.vertices.own(); ++v) {
      if (!in_patch[v]) continue;
      if (!rest.row(v).allFinite()) throw Error(facts::deform::VertexNotFinite{.vertex = first + v});
      low = low.cwiseMin(rest.row(v));
      high = high.cwiseMax(rest.row(v));
      ++summary.patch_vertices;
    }
  });
  summary.patch_vertices = comm.sum(summary.patch_vertices);
  for (int k = 0; k < 3; ++k) {
    low[k] = comm.smallest(low[k]);
    high[k] = comm.largest(high[k]);
  }
  if (summary.patch_vertices == 0) return;
  part.centre = low + (high - low) / 2;
  const double diagonal = (high - low).stableNorm();
  part.scale = diagonal > 0 ? std::exp2(std::round(std::log2(diagonal))) : 1.0;
}

/// Brings the vertices of the patch to their parts.
void DistributedDeformer::Impl::fill_part(const LocalMesh& mesh) {
  Columns vertex(rest.rows(), 7);
  for (Index v = 0; v < mesh.vertices.own(); ++v)
    vertex.row(v) << static_cast<double>(first + v), rest.row(v), static_cast<double>(mask.position[v]),
        static_cast<double>(mask.transform[v]), static_cast<double>(mask.anchored[v]);
  const Columns arrived = redistribution->bring(vertex);
  part.mesh = redistribution->part();
  const Index count = part.mesh.vertices.size();
  part.original.resize(count);
  part.points.resize(count, 3);
  part.mask = ConstraintMask(count, false);
  for (Index v = 0; v < count; ++v) {
    part.original[v] = static_cast<Index>(arrived(v, 0));
    part.points.row(v) = (arrived.row(v).segment<3>(1) - part.centre) / part.scale;
    part.mask.position[v] = static_cast<std::uint8_t>(arrived(v, 4));
    part.mask.transform[v] = static_cast<std::uint8_t>(arrived(v, 5));
    part.mask.anchored[v] = static_cast<std::uint8_t>(arrived(v, 6));
  }
}

void DistributedDeformer::Impl::make_system(const LocalProblem& problem) {
  Number free = 0;
  for (Index v = 0; v < mask.size(); ++v) free += !mask.position[v];
  summary.free_vertices = comm.sum(free);
  measure_parts();
  if (summary.patch_vertices == 0) return;
  fix_and_require_solvable(comm, part);

  // The anchors of the part's own vertices, by local indices. A known position needs no anchor.
  Columns anchor = Columns::Zero(rest.rows(), 6);  // is one, weight, has a target, target
  for (const Anchor& one : problem.anchors)
    anchor.row(one.vertex) << 1.0, one.weight, static_cast<double>(one.target.has_value()),
        one.target.value_or(Eigen::Vector3d::Zero()).transpose();
  const Columns arrived = redistribution->bring(anchor);
  std::vector<Anchor> anchors;
  for (Index v = 0; v < part.mesh.vertices.own(); ++v) {
    if (arrived(v, 0) == 0 || part.mask.position[v]) continue;
    anchors.push_back({.vertex = v, .weight = arrived(v, 1)});
    if (arrived(v, 2) != 0) anchors.back().target = arrived.row(v).tail<3>().transpose();
  }
  system.emplace(comm, part, anchors, options);
  summary.degenerate_vertices = system->degenerate_vertices();
  summary.unknowns = system->unknowns();
  if (system->solver() == nullptr) return;
  const ParallelStatistics figures = system->solver()->statistics();
  summary.coarse_unknowns = figures.coarse_unknowns;
  summary.matrix_nonzeros = figures.matrix_nonzeros;
  summary.factorise_seconds = system->factorise_seconds();
  if (options.deformer.method == DeformMethod::ft05) return;
  const Stopwatch watch;
  rotation.emplace(comm, part, *system, options);
  summary.factorise_seconds += watch.seconds();
}

void DistributedDeformer::Impl::measure_parts() {
  const Halo& vertices = part.mesh.vertices;
  summary.largest_part = comm.largest(Number{vertices.own()});
  summary.largest_halo = comm.largest(Number{vertices.size() - vertices.own()});
  summary.most_neighbours = static_cast<int>(comm.largest(Number{vertices.neighbour_count()}));
}

/// Brings the constraints' values to the parts.
PartValues DistributedDeformer::Impl::values_of(std::span<const VertexConstraint> constraints) const {
  Columns given = Columns::Zero(rest.rows(), 12);
  for (const VertexConstraint& constraint : constraints) {
    auto row = given.row(constraint.vertex);
    if (constraint.position)
      row.head<3>() = (constraint.position->transpose() - rest.row(constraint.vertex)) / part.scale;
    if (constraint.transform)  // (W − I)ᵀ row by row is W − I column by column
      row.tail<9>() = (*constraint.transform - Eigen::Matrix3d::Identity()).reshaped().transpose();
  }
  const Columns arrived = redistribution->bring(given);
  PartValues values{arrived.leftCols<3>(), Columns(3 * arrived.rows(), 3)};
  for (Eigen::Index v = 0; v < arrived.rows(); ++v)
    for (int k = 0; k < 3; ++k) values.maps.row(3 * v + k) = arrived.row(v).segment<3>(3 + 3 * k);
  return values;
}

/// Brings the given transforms, with their rotations and all their turns, to the parts.
std::vector<GivenTransform> DistributedDeformer::Impl::transforms_of(
    std::span<const VertexConstraint> constraints) const {
  Columns given = Columns::Zero(rest.rows(), 14);  // has a transform, it, has a rotation, its vector
  for (const VertexConstraint& constraint : constraints) {
    if (!constraint.transform) continue;
    auto row = given.row(constraint.vertex);
    row[0] = 1;
    row.segment<9>(1) = constraint.transform->reshaped().transpose();
    if (!constraint.rotation) continue;
    row[10] = 1;
    row.tail<3>() = (constraint.rotation->angle() * constraint.rotation->axis()).transpose();
  }
  const Columns arrived = redistribution->bring(given);
  std::vector<GivenTransform> transforms;
  for (Index v = 0; v < part.mesh.vertices.own(); ++v) {
    if (arrived(v, 0) == 0) continue;
    transforms.push_back({.vertex = v, .transform = arrived.row(v).segment<9>(1).transpose().reshaped(3, 3)});
    if (arrived(v, 10) != 0) transforms.back().rotation = arrived.row(v).tail<3>().transpose();
  }
  return transforms;
}

/// Returns positions of the own vertices. `displacements` are those of the part's own vertices, patch units.
Points DistributedDeformer::Impl::place(const Columns& displacements,
                                        std::span<const VertexConstraint> constraints) const {
  Columns moved = Columns::Zero(rest.rows(), 3);
  redistribution->bring_back(displacements, moved);
  Points positions = rest;
  comm.together([&] {
    for (Index v = 0; v < mask.size(); ++v) {
      if (mask.position[v]) continue;
      positions.row(v) += part.scale * moved.row(v);
      if (!positions.row(v).allFinite()) throw Error(facts::deform::SolutionNotFinite{.vertex = first + v});
    }
  });
  for (const VertexConstraint& constraint : constraints)
    if (constraint.position) positions.row(constraint.vertex) = constraint.position->transpose();
  return positions;
}

/// Returns max ‖M_c(x) − W_c‖ over the given transforms at vertices next to a free vertex.
double DistributedDeformer::Impl::transform_deviation(const Columns& y, const PartValues& values) const {
  const Index own = part.mesh.vertices.own();
  Points edited = part.points;
  edited.topRows(own) += system->displacements(y, values);
  part.mesh.vertices.update(edited);
  double largest = 0;
  for (Index v = 0; v < own; ++v) {
    const auto ring = part.mesh.rings[v];
    const bool beside_free =
        std::any_of(ring.begin(), ring.end(), [&](Index w) { return !part.mask.position[w]; });
    if (!part.mask.transform[v] || (!beside_free && part.mask.position[v])) continue;
    const Eigen::Matrix3d given =
        values.maps.middleRows<3>(3 * Eigen::Index{v}).transpose() + Eigen::Matrix3d::Identity();
    largest = std::max(largest, local_map_deviation({v, ring, given}, part.points, edited).norm());
  }
  return comm.largest(largest);
}

void DistributedDeformer::Impl::measure(const Columns& y, const PartValues& values,
                                        const PartRotation::Result& found, EvaluationReport& report) const {
  report.residual = system->residual(y, values, found.field);
  report.iterations = found.iterations;
  report.last_rotation_change = found.change;
  report.fell_back_to_linear = found.linear;
  report.solver_iterations = system->solver()->statistics().iterations;
  report.max_transform_deviation = transform_deviation(y, values);
  const Columns maps = system->maps(y, values);
  Number inverted = 0;
  for (Index v = 0; v < part.mesh.vertices.own(); ++v) {
    const Eigen::Matrix3d map = maps.middleRows<3>(3 * Eigen::Index{v}) + Eigen::Matrix3d::Identity();
    inverted += !part.mask.transform[v] && map.determinant() <= 0;
  }
  report.inverted_maps = static_cast<Index>(comm.sum(inverted));
}

DistributedDeformer::DistributedDeformer(MPI_Comm comm, const LocalProblem& problem,
                                         const DistributedOptions& options)
    : impl_(std::make_unique<Impl>(comm, problem, options)) {}
DistributedDeformer::DistributedDeformer(DistributedDeformer&&) noexcept = default;
DistributedDeformer& DistributedDeformer::operator=(DistributedDeformer&&) noexcept = default;
DistributedDeformer::~DistributedDeformer() = default;

Points DistributedDeformer::evaluate(std::span<const VertexConstraint> constraints,
                                     EvaluationReport* report) const {
  const Impl& d = *impl_;
  d.comm.together([&] { d.constrained.require_matching(constraints); });
  if (report != nullptr) *report = {};
  if (!d.system || d.system->solver() == nullptr)
    return d.place(Columns::Zero(d.part.mesh.vertices.own(), 3), constraints);
  const PartValues values = d.values_of(constraints);
  PartRotation::Result found;
  if (d.rotation) found = d.rotation->find(d.transforms_of(constraints), values);
  const Columns y = d.system->solve(values, found.field, d.options.deformer.residual_corrections,
                                    found.guess.rows() > 0 ? &found.guess : nullptr);
  if (report != nullptr) d.measure(y, values, found, *report);
  return d.place(d.system->displacements(y, values), constraints);
}

DistributedWork DistributedDeformer::work() const {
  const Impl& d = *impl_;
  if (!d.system || d.system->solver() == nullptr) return {};
  const ParallelStatistics figures = d.system->solver()->statistics();
  return {.iterations = figures.all_iterations,
          .coarse_iterations = figures.coarse_iterations,
          .messages = d.comm.largest(figures.traffic.messages),
          .bytes = d.comm.largest(figures.traffic.bytes),
          .reductions = d.comm.largest(figures.traffic.reductions)};
}

const DistributedSummary& DistributedDeformer::summary() const { return impl_->summary; }

}  // namespace meshgraft
