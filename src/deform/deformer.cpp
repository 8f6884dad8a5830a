#include <meshgraft/deform/deformer.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "core/facts.h"
#include "core/memory.h"
#include "core/stopwatch.h"
#include "deform/facts.h"
#include "deform/setup/checks.h"
#include "deform/setup/memory_estimate.h"
#include "deformer_impl.h"

namespace meshgraft {

std::string_view to_string(DeformMethod value) {
  switch (value) {
    case DeformMethod::ft05: return "ft05";
    case DeformMethod::rotation_aware: return "rotation-aware";
    case DeformMethod::corotational: return "corotational";
    case DeformMethod::shell: return "shell";
  }
  return "";
}

// All values are named, so that a changed default changes nothing here.
DeformerOptions DeformerOptions::as_published() {
  return {.method = DeformMethod::ft05,
          .stiffness = 0,
          .soften_coarse = false,
          .vertices_represented = 1,
          .iterations = 20,
          .coarse_start = false,
          .smoothing_length_rel = 0.09,
          .operators = OperatorOptions::as_published(),
          .backend = SolverBackend::automatic,
          .residual_corrections = 1};
}

Deformer::Impl::Impl(const std::shared_ptr<const RestMesh>& mesh, const Region& region,
                     std::span<const VertexConstraint> constraints, const DeformerOptions& chosen,
                     const Impl* other, const Context& context)
    : options(chosen),
      wanted_backend(chosen.backend),
      handles(region.handles),
      per_vertex(!constraints.empty()) {
  const auto n = static_cast<Index>(mesh->points.rows());
  require_triangles(mesh->points, mesh->triangles);
  ConstrainedMesh problem{mesh, make_mask(n, region, constraints, constrained), region.anchors,
                          region.features};
  if (std::any_of(handles.begin(), handles.end(),
                  [](const Handle& handle) { return handle.shape == HandleShape::curve; }))
    normals =
        vertex_normals(mesh->points, mesh->triangles, vertex_triangles(n, mesh->triangles, context), context);
  summary.fixed_vertices = static_cast<Index>(region.fixed.size());
  summary.handle_vertices = static_cast<Index>(constrained.size());
  validate(options);
  const SolverBackend of_fields = choose_backends(problem.mask);
  system = std::make_unique<ConstrainedSystem>(problem, options, summary,
                                               other != nullptr ? other->system.get() : nullptr, context);
  if (options.method == DeformMethod::ft05 || system->operators() == nullptr) return;
  const Stopwatch watch;
  DeformerOptions field_options = options;
  field_options.backend = of_fields;
  rotations = std::make_unique<RotationField>(*system, field_options,
                                              summary.reused ? other->rotations.get() : nullptr, context);
  if (options.method == DeformMethod::shell)
    shell = std::make_unique<ShellRelaxation>(*system, rotations->limbs(), of_fields, context);
  if (options.coarse_start && rotations->iterations() > 0)
    start = CoarseStart::make(*mesh, region, constraints, summary.free_vertices, options, context);
  summary.factorise_seconds += watch.seconds();
}

/// Chooses the iterative backend for very large regions. Throws Error(memory) if the memory does not suffice.
/// Returns the backend for the scalar fields, whose factors may fit the memory beside the iterations.
SolverBackend Deformer::Impl::choose_backends(const ConstraintMask& mask) {
  const auto free = static_cast<Index>(std::count(mask.position.begin(), mask.position.end(), 0));
  const std::uint64_t memory = available_memory();
  const SolvePath path = choose_path(free, options, memory);
  if (path == SolvePath::proxy)
    throw Error(facts::deform::SolveExceedsMemory{.free = free, .megabytes = memory / 1'000'000});
  if (path != SolvePath::iterative) return options.backend;
  options.backend = SolverBackend::iterative;
  return factors_of_fields_fit(free, options, memory) ? wanted_backend : options.backend;
}

/// Finds the field of maps, then solves with it.
void Deformer::Impl::evaluate(std::span<const VertexConstraint> constraints, PointsRef out,
                              EvaluationReport* report, Columns* solved_maps, const Context& context) const {
  RotationField::Result found;
  if (rotations) {
    const Columns maps = start ? start->maps(constraints, system->patch(), context) : Columns();
    found = rotations->find(constraints, context, settled_change, maps);
  }
  const bool relaxes = shell && !found.linear;
  Columns maps;
  if (relaxes && report != nullptr && solved_maps == nullptr) solved_maps = &maps;
  system->evaluate(constraints, found.problem, out, report, solved_maps, context);
  ShellRelaxation::Result of_shell;
  if (relaxes) of_shell = relax(found.strain, out, solved_maps, context);
  if (report == nullptr) return;
  report->shell_steps = of_shell.steps;
  report->shell_settled = of_shell.settled;
  if (of_shell.steps > 0) {
    report->max_transform_deviation = system->max_transform_deviation(constraints, out);
    report->inverted_maps = system->count_inverted(*solved_maps);
  }
  report->iterations = found.iterations;
  report->last_rotation_change = found.change;
  report->fell_back_to_linear = found.linear;
  report->position_stretch = found.position_stretch;
}

/// Moves the positions as a shell, and turns the maps with the surface unless they are null.
ShellRelaxation::Result Deformer::Impl::relax(const RestStrain& strain, PointsRef positions, Columns* maps,
                                              const Context& context) const {
  const Patch& patch = system->patch();
  Points before(patch.size(), 3);
  for (Index v = 0; v < patch.size(); ++v)
    before.row(v) = (positions.row(patch.vertices[v]) - patch.centre) / patch.scale;
  ShellRelaxation::Result relaxed = shell->relax(strain, before, context);
  if (relaxed.steps == 0) return relaxed;
  for (const Index v : shell->surface().moving()) {
    positions.row(patch.vertices[v]) = patch.centre + patch.scale * relaxed.positions.row(v);
    if (!positions.row(patch.vertices[v]).allFinite())
      throw Error(facts::deform::SolutionNotFinite{.vertex = patch.vertices[v]});
  }
  if (maps != nullptr) shell->surface().follow(before, relaxed.positions, *maps);
  return relaxed;
}

Points Deformer::Impl::evaluate_with_maps(std::span<const VertexConstraint> constraints,
                                          std::vector<Eigen::Matrix3d>& map_changes, const Context& context,
                                          EvaluationReport* report) const {
  constrained.require_matching(constraints);
  Points positions(system->rest().rows(), 3);
  Columns solved;
  evaluate(constraints, positions, report, &solved, context);
  map_changes.assign(positions.rows(), Eigen::Matrix3d::Zero());
  for (const VertexConstraint& constraint : constraints)
    if (constraint.transform)
      map_changes[constraint.vertex] = *constraint.transform - Eigen::Matrix3d::Identity();
  const std::vector<Index>& patch = system->patch().vertices;
  for (Eigen::Index v = 0; 3 * v < solved.rows(); ++v)
    map_changes[patch[v]] = solved.middleRows<3>(3 * v).transpose();
  return positions;
}

Deformer::Deformer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Deformer::Deformer(Deformer&&) noexcept = default;
Deformer& Deformer::operator=(Deformer&&) noexcept = default;
Deformer::~Deformer() = default;

namespace {

std::shared_ptr<const RestMesh> take_mesh(DeformProblem& problem) {
  return std::make_shared<const RestMesh>(std::move(problem.rest), std::move(problem.triangles));
}

}  // namespace

Deformer::Deformer(DeformProblem problem, const DeformerOptions& options, const Context& context)
    : impl_(std::make_unique<Impl>(take_mesh(problem), problem.region, problem.constraints, options, nullptr,
                                   context)) {}

Deformer::Deformer(const Points& rest, const Triangles& triangles, const Region& region,
                   const DeformerOptions& options, const Context& context)
    : Deformer(DeformProblem{rest, triangles, region}, options, context) {}

Deformer Deformer::with_region(const Region& region, const Context& context) const {
  DeformerOptions options = impl_->options;
  options.backend = impl_->wanted_backend;
  return Deformer(std::make_unique<Impl>(impl_->system->mesh(), region, std::span<const VertexConstraint>(),
                                         options, impl_.get(), context));
}

std::vector<VertexConstraint> Deformer::constraints(std::span<const HandlePose> poses) const {
  const Impl& d = *impl_;
  const Points& rest = d.system->rest();
  if (poses.size() != d.handles.size())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::poses, .given = poses.size(), .needed = d.handles.size()});
  std::vector<VertexConstraint> constraints;
  constraints.reserve(d.constrained.size());
  for (std::size_t h = 0; h < poses.size(); ++h) {
    const auto held = handle_constraints(d.handles[h], poses[h], {rest, d.normals});
    constraints.insert(constraints.end(), held.begin(), held.end());
  }
  return constraints;
}

void Deformer::evaluate(std::span<const HandlePose> poses, PointsRef positions_out, const Context& context,
                        EvaluationReport* report) const {
  evaluate(constraints(poses), positions_out, context, report);
}

Points Deformer::evaluate(std::span<const HandlePose> poses, const Context& context,
                          EvaluationReport* report) const {
  Points positions(impl_->system->rest().rows(), 3);
  evaluate(poses, positions, context, report);
  return positions;
}

Points Deformer::evaluate(std::span<const VertexConstraint> constraints, const Context& context,
                          EvaluationReport* report) const {
  Points positions(impl_->system->rest().rows(), 3);
  evaluate(constraints, positions, context, report);
  return positions;
}

void Deformer::evaluate(std::span<const VertexConstraint> constraints, PointsRef positions_out,
                        const Context& context, EvaluationReport* report) const {
  const Eigen::Index vertices = impl_->system->rest().rows();
  if (positions_out.rows() != vertices)
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::positions, .given = positions_out.rows(), .needed = vertices});
  impl_->constrained.require_matching(constraints);
  impl_->evaluate(constraints, positions_out, report, nullptr, context);
}

Points Deformer::evaluate_with_field(std::span<const VertexConstraint> constraints,
                                     std::span<const Eigen::Matrix3d> field, const Context& context,
                                     EvaluationReport* report) const {
  impl_->constrained.require_matching(constraints);
  const ConstrainedSystem& system = *impl_->system;
  if (static_cast<Eigen::Index>(field.size()) != system.rest().rows())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::maps, .given = field.size(), .needed = system.rest().rows()});
  for (std::size_t v = 0; v < field.size(); ++v)
    if (!field[v].allFinite())
      throw Error(facts::core::NotFinite{.what = facts::core::Quantity::map}, Location("field")[v]);
  ConstrainedSystem::Problem local;
  local.field.maps.resize(3 * system.patch().size(), 3);
  for (Index v = 0; v < system.patch().size(); ++v)
    local.field.maps.middleRows<3>(3 * v) =
        (field[system.patch().vertices[v]] - Eigen::Matrix3d::Identity()).transpose();
  Points positions(system.rest().rows(), 3);
  system.evaluate(constraints, local, positions, report, nullptr, context);
  return positions;
}

NormalMatrix Deformer::normal_matrix(const Context& context) const {
  return impl_->system->normal_matrix(context);
}

double Deformer::condition_estimate(const Context& context) const {
  return impl_->system->condition_estimate(context);
}

const AffineOperator& Deformer::affine_operator() const {
  const AffineOperator* operators = impl_->system->operators();
  if (operators == nullptr) throw Error(facts::deform::NothingFree{});
  return *operators;
}

const DeformerSummary& Deformer::summary() const { return impl_->summary; }
std::span<const Index> Deformer::free_vertices() const { return impl_->system->free_vertices(); }
std::span<const Index> Deformer::patch_vertices() const { return impl_->system->patch().vertices; }

}  // namespace meshgraft
