#include <meshgraft/deform/deformer.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "../core/stopwatch.h"
#include "constrained_system.h"
#include "rotation_field.h"

namespace meshgraft {

namespace {

void validate(const DeformerOptions& options) {
  const auto require = [](bool good, const std::string& what, const char* field) {
    if (!good) throw Error(ErrorCode::input, what, field);
  };
  require(options.stiffness >= 0 && options.stiffness <= 1e6,
          fmt::format("{} is not between 0 and 1e6", options.stiffness), "stiffness");
  require(options.iterations >= 0 && options.iterations <= 1000,
          fmt::format("{} is not between 0 and 1000", options.iterations), "iterations");
  require(options.smoothing_length_rel >= 0 && options.smoothing_length_rel <= 10,
          fmt::format("{} is not between 0 and 10", options.smoothing_length_rel), "smoothing_length_rel");
}

}  // namespace

std::string_view to_string(DeformMethod value) {
  switch (value) {
    case DeformMethod::ft05: return "ft05";
    case DeformMethod::rotation_aware: return "rotation-aware";
    case DeformMethod::corotational: return "corotational";
  }
  return "";
}

/// Handles and checks of the caller's input; the problem itself is the system's.
struct Deformer::Impl {
  std::vector<Handle> handles;
  Points normals;                  ///< of the rest mesh, n×3; only where a handle is a curve
  std::vector<Index> constrained;  ///< vertex of each constraint, in their order
  std::vector<std::uint8_t> gives_position, gives_transform;
  DeformerSummary summary;
  std::unique_ptr<ConstrainedSystem> system;
  std::unique_ptr<RotationField> rotations;  ///< null for `ft05` and where nothing is free

  void build(const Points& rest, const Triangles& triangles, const VertexStates& states,
             std::span<const Anchor> anchors, std::span<const Feature> features, const DeformerOptions& options,
             const Context& context);
  void constrain(Index vertex, bool position, bool transform, VertexStates& states);
  void require_matching(std::span<const VertexConstraint> constraints) const;
  void evaluate(std::span<const VertexConstraint> constraints, Points& out, EvaluationReport* report,
                const Context& context) const;
};

void Deformer::Impl::build(const Points& rest, const Triangles& triangles, const VertexStates& states,
                           std::span<const Anchor> anchors, std::span<const Feature> features,
                           const DeformerOptions& options, const Context& context) {
  validate(options);
  system = std::make_unique<ConstrainedSystem>(rest, triangles, states, anchors, features, options, summary,
                                               context);
  if (options.method == DeformMethod::ft05 || system->operators() == nullptr) return;
  const Stopwatch watch;
  rotations = std::make_unique<RotationField>(*system, options, context);
  summary.factorise_seconds += watch.seconds();
}

void Deformer::Impl::constrain(Index vertex, bool position, bool transform, VertexStates& states) {
  // Outside the region both are known already, and the part that is not given stays at rest.
  states.position[vertex] |= static_cast<std::uint8_t>(position);
  states.transform[vertex] |= static_cast<std::uint8_t>(transform);
  constrained.push_back(vertex);
  gives_position.push_back(position);
  gives_transform.push_back(transform);
}

void Deformer::Impl::require_matching(std::span<const VertexConstraint> constraints) const {
  if (constraints.size() != constrained.size())
    throw Error(ErrorCode::usage, fmt::format("{} constraints were given where the set-up has {}",
                                              constraints.size(), constrained.size()));
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    const VertexConstraint& constraint = constraints[c];
    if (constraint.vertex != constrained[c] || constraint.position.has_value() != (gives_position[c] != 0) ||
        constraint.transform.has_value() != (gives_transform[c] != 0))
      throw Error(ErrorCode::usage,
                  fmt::format("constraint {} does not constrain what it did in the set-up", c));
    if (constraint.rotation &&
        !(std::isfinite(constraint.rotation->angle()) && constraint.rotation->axis().allFinite()))
      throw Error(ErrorCode::input, "its rotation is not finite",
                  fmt::format("the constraint of vertex {}", constraint.vertex));
    constexpr double largest = 1e100;  // squares and volumes stay finite
    if ((constraint.position && !(constraint.position->cwiseAbs().maxCoeff() < largest)) ||
        (constraint.transform && !(constraint.transform->cwiseAbs().maxCoeff() < largest)))
      throw Error(ErrorCode::input, "its position or transform is not finite, or larger than 1e100",
                  fmt::format("the constraint of vertex {}", constraint.vertex));
  }
}

/// The method: the field of maps first, then the solve with it.
void Deformer::Impl::evaluate(std::span<const VertexConstraint> constraints, Points& out,
                              EvaluationReport* report, const Context& context) const {
  RotationField::Result found;
  if (rotations) found = rotations->find(constraints, context);
  system->evaluate(constraints, found.problem, out, report, context);
  if (report == nullptr) return;
  report->iterations = found.iterations;
  report->last_rotation_change = found.change;
  report->fell_back_to_linear = found.linear;
}

Deformer::Deformer() : impl_(std::make_unique<Impl>()) {}
Deformer::Deformer(Deformer&&) noexcept = default;
Deformer& Deformer::operator=(Deformer&&) noexcept = default;
Deformer::~Deformer() = default;

namespace {

void require_triangles(const Points& rest, const Triangles& triangles) {
  const auto n = static_cast<Index>(rest.rows());
  for (Index t = 0; t < triangles.rows(); ++t)
    for (int corner = 0; corner < 3; ++corner)
      require_vertex(triangles(t, corner), n, fmt::format("triangle {}", t));
}

/// Vertices outside the region are known; those inside are not, until a constraint says otherwise.
VertexStates states_of_region(Index count, bool whole, std::span<const Index> region,
                              std::span<const Index> fixed) {
  VertexStates states(count, !whole);
  for (Index v : region) {
    require_vertex(v, count, "region");
    states.position[v] = states.transform[v] = 0;
  }
  for (Index v : fixed) {
    require_vertex(v, count, "fixed");
    states.position[v] = states.transform[v] = 1;
  }
  return states;
}

void add_features(std::span<const Feature> features, VertexStates& states) {
  const auto count = static_cast<Index>(states.feature.size());
  for (std::size_t f = 0; f < features.size(); ++f) {
    if (features[f].vertices.empty())
      throw Error(ErrorCode::input, "it has no vertices", fmt::format("feature {}", f),
                  "Select some, or drop it");
    if (features[f].scale && !(*features[f].scale > 0 && *features[f].scale < 1e100))
      throw Error(ErrorCode::input, fmt::format("its scale {} is not a positive number", *features[f].scale),
                  fmt::format("feature {}", f));
    for (Index v : features[f].vertices) {
      require_vertex(v, count, fmt::format("feature {}", f));
      if (states.feature[v] >= 0)
        throw Error(ErrorCode::input, fmt::format("vertex {} is in two features", v),
                    fmt::format("feature {}", f));
      if (states.position[v] || states.transform[v])
        throw Error(ErrorCode::input, fmt::format("vertex {} is fixed or constrained too", v),
                    fmt::format("feature {}", f), "Choose its vertices from the free part of the region");
      states.feature[v] = static_cast<Index>(f);
    }
  }
}

/// Names every handle's vertices once; throws where two meet, or one meets the fixed part.
void require_disjoint(const Region& region, Index count) {
  constexpr int nobody = -2, fixed = -1;
  std::vector<int> owner(static_cast<std::size_t>(count), nobody);
  for (Index v : region.fixed) {
    require_vertex(v, count, "fixed");
    owner[v] = fixed;
  }
  for (std::size_t h = 0; h < region.handles.size(); ++h) {
    const Handle& handle = region.handles[h];
    const std::string place = fmt::format("handle '{}'", handle.name);
    if (handle.vertices.empty())
      throw Error(ErrorCode::input, "it has no vertices", place, "Select some, or drop the handle");
    if (!handle.constrain_position && !handle.constrain_transform)
      throw Error(ErrorCode::input, "it constrains neither position nor transform", place,
                  "Let it constrain one of them, or drop the handle");
    for (Index v : handle.vertices) {
      require_vertex(v, count, place);
      if (owner[v] == static_cast<int>(h))
        throw Error(ErrorCode::input, fmt::format("vertex {} is named twice", v), place);
      if (owner[v] != nobody)
        throw Error(ErrorCode::input,
                    owner[v] == fixed ? fmt::format("vertex {} is also fixed", v)
                                      : fmt::format("vertex {} also belongs to handle '{}'", v,
                                                    region.handles[owner[v]].name),
                    place, "Take it out of one of the two");
      owner[v] = static_cast<int>(h);
    }
  }
}

}  // namespace

Deformer::Deformer(const Points& rest, const Triangles& triangles, const Region& region,
                   const DeformerOptions& options, const Context& context)
    : Deformer() {
  const auto n = static_cast<Index>(rest.rows());
  require_triangles(rest, triangles);
  require_disjoint(region, n);
  VertexStates states = states_of_region(n, region.whole, region.vertices, region.fixed);
  Impl& d = *impl_;
  d.handles = region.handles;
  for (const Handle& handle : region.handles) {
    for (Index v : handle.vertices)
      d.constrain(v, handle.constrain_position, handle.constrain_transform, states);
  }
  const bool has_curve = std::any_of(region.handles.begin(), region.handles.end(),
                                     [](const Handle& handle) { return handle.shape == HandleShape::curve; });
  if (has_curve) d.normals = vertex_normals(rest, triangles, vertex_triangles(n, triangles, context), context);
  add_features(region.features, states);
  d.summary.fixed_vertices = static_cast<Index>(region.fixed.size());
  d.summary.handle_vertices = static_cast<Index>(d.constrained.size());
  d.build(rest, triangles, states, region.anchors, region.features, options, context);
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
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(n), 0);
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    const VertexConstraint& constraint = constraints[c];
    const std::string place = fmt::format("constraint {}", c);
    require_vertex(constraint.vertex, n, place);
    if (seen[constraint.vertex]++)
      throw Error(ErrorCode::input, fmt::format("vertex {} is constrained twice", constraint.vertex), place);
    if (!constraint.position && !constraint.transform)
      throw Error(ErrorCode::input,
                  fmt::format("vertex {} gets neither position nor transform", constraint.vertex), place);
    d.constrain(constraint.vertex, constraint.position.has_value(), constraint.transform.has_value(), states);
  }
  add_features(features, states);
  d.summary.handle_vertices = static_cast<Index>(d.constrained.size());
  d.build(rest, triangles, states, anchors, features, options, context);
  return deformer;
}

std::vector<VertexConstraint> Deformer::constraints(std::span<const HandlePose> poses) const {
  const Impl& d = *impl_;
  const Points& rest = d.system->rest();
  if (poses.size() != d.handles.size())
    throw Error(ErrorCode::usage,
                fmt::format("{} poses were given for {} handles", poses.size(), d.handles.size()));
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
    throw Error(ErrorCode::usage,
                fmt::format("the output has {} rows for {} vertices", positions_out.rows(), vertices));
  const std::vector<VertexConstraint> posed = constraints(poses);
  impl_->require_matching(posed);
  impl_->evaluate(posed, positions_out, report, context);
}

Points Deformer::evaluate(std::span<const HandlePose> poses, const Context& context,
                          EvaluationReport* report) const {
  Points positions(impl_->system->rest().rows(), 3);
  evaluate(poses, positions, context, report);
  return positions;
}

Points Deformer::evaluate(std::span<const VertexConstraint> constraints, const Context& context,
                          EvaluationReport* report) const {
  impl_->require_matching(constraints);
  Points positions;
  impl_->evaluate(constraints, positions, report, context);
  return positions;
}

Points Deformer::evaluate_with_field(std::span<const VertexConstraint> constraints,
                                     std::span<const Eigen::Matrix3d> field, const Context& context,
                                     EvaluationReport* report) const {
  impl_->require_matching(constraints);
  const ConstrainedSystem& system = *impl_->system;
  if (static_cast<Eigen::Index>(field.size()) != system.rest().rows())
    throw Error(ErrorCode::usage,
                fmt::format("the field has {} maps for {} vertices", field.size(), system.rest().rows()));
  for (std::size_t v = 0; v < field.size(); ++v)
    if (!field[v].allFinite())
      throw Error(ErrorCode::input, "the map is not finite", fmt::format("field, vertex {}", v));
  ConstrainedSystem::Problem local;
  for (const Index v : system.patch().vertices) local.field.smoothness.push_back(field[v]);
  local.field.stretch = local.field.smoothness;
  Points positions;
  system.evaluate(constraints, local, positions, report, context);
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
  if (operators == nullptr)
    throw Error(ErrorCode::usage, "nothing is free, so there is no operator", "",
                "Choose a region with free vertices");
  return *operators;
}

const DeformerSummary& Deformer::summary() const { return impl_->summary; }
std::span<const Index> Deformer::free_vertices() const { return impl_->system->free_vertices(); }
std::span<const Index> Deformer::patch_vertices() const { return impl_->system->patch().vertices; }

}  // namespace meshgraft
