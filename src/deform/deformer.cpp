#include <meshgraft/deform/deformer.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/core/memory.h>
#include <meshgraft/deform/memory_estimate.h>
#include <meshgraft/mesh/normals.h>

#include "../core/stopwatch.h"
#include "core/facts.h"
#include "deform/facts.h"
#include "deform/setup/region_states.h"
#include "deform/solve/constrained_system.h"
#include "deform/solve/rotation_field.h"

namespace meshgraft {

std::string_view to_string(DeformMethod value) {
  switch (value) {
    case DeformMethod::ft05: return "ft05";
    case DeformMethod::rotation_aware: return "rotation-aware";
    case DeformMethod::corotational: return "corotational";
  }
  return "";
}

/// Holds the handles and checks the caller's input. The `ConstrainedSystem` holds the problem itself.
struct Deformer::Impl {
  DeformerOptions options;
  SolverBackend wanted_backend = SolverBackend::automatic;  ///< as given, before one is chosen
  std::vector<Handle> handles;
  bool per_vertex = false;  ///< constraints per vertex instead of handles
  Points normals;           ///< of the rest mesh, n×3; only if a handle is a curve
  ConstraintList constrained;
  DeformerSummary summary;
  std::unique_ptr<ConstrainedSystem> system;
  std::unique_ptr<RotationField> rotations;  ///< null for `ft05`, and if nothing is free

  void choose_backend(const VertexStates& states);
  void build(std::shared_ptr<const RestMesh> mesh, const VertexStates& states, std::span<const Anchor> anchors,
             std::span<const Feature> features, const DeformerOptions& chosen, const Impl* other,
             const Context& context);
  void evaluate(std::span<const VertexConstraint> constraints, Points& out, EvaluationReport* report,
                Columns* solved_maps, const Context& context) const;
};

/// Chooses the iterative backend for very large regions. Throws Error(memory) if the memory does not suffice.
void Deformer::Impl::choose_backend(const VertexStates& states) {
  const auto free = static_cast<Index>(std::count(states.position.begin(), states.position.end(), 0));
  const std::uint64_t memory = available_memory();
  const SolvePath path = choose_path(free, options, memory);
  if (path == SolvePath::proxy)
    throw Error(facts::deform::SolveExceedsMemory{.free = free, .megabytes = memory / 1'000'000});
  if (path == SolvePath::iterative) options.backend = SolverBackend::iterative;
}

void Deformer::Impl::build(std::shared_ptr<const RestMesh> mesh, const VertexStates& states,
                           std::span<const Anchor> anchors, std::span<const Feature> features,
                           const DeformerOptions& chosen, const Impl* other, const Context& context) {
  options = chosen;
  require_usable(options);
  wanted_backend = chosen.backend;
  choose_backend(states);
  system = std::make_unique<ConstrainedSystem>(std::move(mesh), states, anchors, features, options, summary,
                                               other != nullptr ? other->system.get() : nullptr, context);
  if (options.method == DeformMethod::ft05 || system->operators() == nullptr) return;
  const Stopwatch watch;
  rotations = std::make_unique<RotationField>(*system, options,
                                              summary.reused ? other->rotations.get() : nullptr, context);
  summary.factorise_seconds += watch.seconds();
}

/// Finds the field of maps, then solves with it.
void Deformer::Impl::evaluate(std::span<const VertexConstraint> constraints, Points& out,
                              EvaluationReport* report, Columns* solved_maps, const Context& context) const {
  RotationField::Result found;
  if (rotations) found = rotations->find(constraints, context);
  system->evaluate(constraints, found.problem, out, report, solved_maps, context);
  if (report == nullptr) return;
  report->iterations = found.iterations;
  report->last_rotation_change = found.change;
  report->fell_back_to_linear = found.linear;
}

Deformer::Deformer() : impl_(std::make_unique<Impl>()) {}
Deformer::Deformer(Deformer&&) noexcept = default;
Deformer& Deformer::operator=(Deformer&&) noexcept = default;
Deformer::~Deformer() = default;

Deformer::Deformer(const Points& rest, const Triangles& triangles, const Region& region,
                   const DeformerOptions& options, const Context& context)
    : Deformer() {
  *this = of_region(std::make_shared<const RestMesh>(rest, triangles), region, options, nullptr, context);
}

Deformer Deformer::with_region(const Region& region, const Context& context) const {
  DeformerOptions options = impl_->options;
  options.backend = impl_->wanted_backend;
  return of_region(impl_->system->mesh(), region, options, this, context);
}

Deformer Deformer::of_region(std::shared_ptr<const RestMesh> mesh, const Region& region,
                             const DeformerOptions& options, const Deformer* other, const Context& context) {
  const auto n = static_cast<Index>(mesh->points.rows());
  Deformer deformer;
  Impl& d = *deformer.impl_;
  d.handles = region.handles;
  const VertexStates states = states_of_handles(mesh->points, mesh->triangles, region, d.constrained);
  const bool has_curve = std::any_of(region.handles.begin(), region.handles.end(),
                                     [](const Handle& handle) { return handle.shape == HandleShape::curve; });
  if (has_curve)
    d.normals =
        vertex_normals(mesh->points, mesh->triangles, vertex_triangles(n, mesh->triangles, context), context);
  d.summary.fixed_vertices = static_cast<Index>(region.fixed.size());
  d.summary.handle_vertices = static_cast<Index>(d.constrained.size());
  d.build(std::move(mesh), states, region.anchors, region.features, options,
          other != nullptr ? other->impl_.get() : nullptr, context);
  return deformer;
}

Deformer Deformer::with_constraints(const Points& rest, const Triangles& triangles,
                                    std::span<const Index> region,
                                    std::span<const VertexConstraint> constraints,
                                    std::span<const Anchor> anchors, std::span<const Feature> features,
                                    const DeformerOptions& options, const Context& context) {
  const auto n = static_cast<Index>(rest.rows());
  require_triangles(rest, triangles);
  VertexStates states = states_of_region(n, region.empty(), region, {});
  Deformer deformer;
  Impl& d = *deformer.impl_;
  d.per_vertex = true;
  d.constrained.add(constraints, states);
  add_features(features, states);
  d.summary.handle_vertices = static_cast<Index>(d.constrained.size());
  d.build(std::make_shared<const RestMesh>(rest, triangles), states, anchors, features, options, nullptr,
          context);
  return deformer;
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
    const auto held = handle_constraints(d.handles[h], poses[h], rest, d.normals);
    constraints.insert(constraints.end(), held.begin(), held.end());
  }
  return constraints;
}

void Deformer::evaluate(std::span<const HandlePose> poses, Points& positions_out, const Context& context,
                        EvaluationReport* report) const {
  const Eigen::Index vertices = impl_->system->rest().rows();
  if (positions_out.rows() != vertices)
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::positions, .given = positions_out.rows(), .needed = vertices});
  const std::vector<VertexConstraint> posed = constraints(poses);
  impl_->constrained.require_matching(posed);
  impl_->evaluate(posed, positions_out, report, nullptr, context);
}

Points Deformer::evaluate(std::span<const HandlePose> poses, const Context& context,
                          EvaluationReport* report) const {
  Points positions(impl_->system->rest().rows(), 3);
  evaluate(poses, positions, context, report);
  return positions;
}

Points Deformer::evaluate(std::span<const VertexConstraint> constraints, const Context& context,
                          EvaluationReport* report) const {
  impl_->constrained.require_matching(constraints);
  Points positions;
  impl_->evaluate(constraints, positions, report, nullptr, context);
  return positions;
}

Points Deformer::evaluate_with_maps(std::span<const VertexConstraint> constraints,
                                    std::vector<Eigen::Matrix3d>& map_changes, const Context& context,
                                    EvaluationReport* report) const {
  impl_->constrained.require_matching(constraints);
  Points positions;
  Columns solved;
  impl_->evaluate(constraints, positions, report, &solved, context);
  map_changes.assign(static_cast<std::size_t>(positions.rows()), Eigen::Matrix3d::Zero());
  for (const VertexConstraint& constraint : constraints)
    if (constraint.transform)
      map_changes[constraint.vertex] = *constraint.transform - Eigen::Matrix3d::Identity();
  const std::vector<Index>& patch = impl_->system->patch().vertices;
  for (Eigen::Index v = 0; 3 * v < solved.rows(); ++v)
    map_changes[patch[static_cast<std::size_t>(v)]] = solved.middleRows<3>(3 * v).transpose();
  return positions;
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
      throw Error(facts::core::NotFinite{.what = facts::core::Quantity::map},
                  fmt::format("field, vertex {}", v));
  ConstrainedSystem::Problem local;
  local.field.smoothness.resize(3 * system.patch().size(), 3);
  for (Index v = 0; v < system.patch().size(); ++v)
    local.field.smoothness.middleRows<3>(3 * v) =
        (field[system.patch().vertices[v]] - Eigen::Matrix3d::Identity()).transpose();
  local.field.stretch = local.field.smoothness;
  Points positions;
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
const ConstrainedSystem& Deformer::system() const { return *impl_->system; }
std::span<const Handle> Deformer::handles() const { return impl_->handles; }
const DeformerOptions& Deformer::options() const { return impl_->options; }
bool Deformer::is_of_handles() const { return !impl_->per_vertex; }
const RotationField* Deformer::rotation_field() const { return impl_->rotations.get(); }
std::span<const Index> Deformer::patch_vertices() const { return impl_->system->patch().vertices; }

}  // namespace meshgraft
