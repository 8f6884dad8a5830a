#include <meshgraft/deform/quick_frames.h>

#include <algorithm>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/parallel.h"
#include "core/require_between.h"
#include "deform/deformer_impl.h"
#include "deform/facts.h"
#include "deform/solve/pose_matrix.h"
#include "linalg/sparse.h"
#include "reduced_field.h"
#include "response_columns.h"

namespace meshgraft {

namespace {

/// Returns the rows of the free vertices.
Columns free_rows(const ConstrainedSystem& system, const Columns& displacements) {
  Columns rows(static_cast<Eigen::Index>(system.free_vertices().size()), displacements.cols());
  for (Eigen::Index k = 0; k < rows.rows(); ++k)
    rows.row(k) = displacements.row(system.patch().local(system.free_vertices()[k]));
  return rows;
}

}  // namespace

void validate(const ReducedFramesOptions& options) {
  require_between(options.centres, 1, 1024, "centres");
  require_between(options.samples_per_centre, 1, 64, "samples_per_centre");
}

struct ReducedFrames::Impl {
  std::vector<Handle> handles;
  Eigen::RowVector3d centre;
  double scale = 1;
  Points base;                          ///< n×3: positions with all handles at rest
  std::unique_ptr<ReducedField> field;  ///< null if nothing is free
  ResponseColumns responses;

  void solve_responses(const ConstrainedSystem& system, const Context& context);
  void solve_targets(const ConstrainedSystem& system, const Context& context);
  void place_handles(std::span<const HandlePose> poses, PointsRef positions, const Context& context) const;
};

ReducedFrames::ReducedFrames(const Deformer& deformer, const ReducedFramesOptions& options,
                             const Context& context)
    : impl_(std::make_unique<Impl>()) {
  validate(options);
  const Deformer::Impl& set_up = deformer.impl();
  const ConstrainedSystem& system = *set_up.system;
  if (set_up.per_vertex) throw Error(facts::deform::NoHandles{});
  if (set_up.options.method == DeformMethod::ft05) throw Error(facts::deform::ReducedFramesNeedless{});
  if (!system.features().empty()) throw Error(facts::deform::FeaturesNotReduced{});
  Impl& d = *impl_;
  d.handles = set_up.handles;
  d.base = system.rest();
  d.centre = system.patch().centre;
  d.scale = system.patch().scale;
  if (system.row_count() == 0) return;
  constexpr Index most_samples = 8192;
  const Index samples =
      std::max(options.centres, std::min(most_samples, options.centres * options.samples_per_centre));
  d.field = std::make_unique<ReducedField>(system, *set_up.rotations, d.handles, set_up.options,
                                           options.centres, samples, context);
  d.solve_responses(system, context);
  d.solve_targets(system, context);
  d.field->finish();
}

ReducedFrames::ReducedFrames(ReducedFrames&&) noexcept = default;
ReducedFrames& ReducedFrames::operator=(ReducedFrames&&) noexcept = default;
ReducedFrames::~ReducedFrames() = default;

/// Solves for the vertices' responses to handles and centres. A few columns are solved at a time, which
/// bounds the memory of the right-hand sides.
void ReducedFrames::Impl::solve_responses(const ConstrainedSystem& system, const Context& context) {
  responses = ResponseColumns(system.free_vertices(), field->width(), context);
  context.throw_if_stopped();
  const SparseRows coupling = system.coupling(context);
  for (std::size_t handle = 0; handle < 2 * handles.size(); ++handle) {  // blended by logarithms, then linearly
    const ReducedField::Columnwise sides = field->handle_sides(handle);
    const Columns y = system.respond(sides.values, sides.field, coupling, context);
    responses.set(4 * handle, 1, free_rows(system, system.displacements(y, sides.values, context)), context);
    field->set_maps(4 * handle, 1, field->cell_means(system.maps(y, sides.values, context), 3, context));
  }
  const SparseRows displacements = system.displacement_rows();
  const SparseRows maps = multiply(field->cell_mean_rows(3), system.map_rows(), context);
  const auto functions = static_cast<Eigen::Index>(field->function_count());
  const double all = 3 * static_cast<double>(field->function_count() + field->twist_function_count());
  constexpr Eigen::Index at_once = 32;
  Columns y, moves;  // All solves share their memory, because the first use of fresh pages takes time.
  // Solves for one column per function. `set_sides(begin, count, y)` writes the right-hand sides of some
  // functions. The responses are first, first + 3, ….
  const auto solve_functions = [&](Eigen::Index function_count, Eigen::Index first, const auto& set_sides) {
    for (Eigen::Index begin = 0; begin < function_count; begin += at_once) {
      context.step("reduce", static_cast<double>(first / 3 * 3 + first % 3 * function_count + begin) / all);
      const Eigen::Index count = std::min(at_once, function_count - begin);
      set_sides(begin, count, y);
      system.back_substitute(y, context);
      const auto column = 8 * handles.size() + static_cast<std::size_t>(first + 3 * begin);
      multiply(displacements, y, moves, context);
      responses.set(column, 3, moves, context);
      field->set_maps(column, 3, multiply(maps, y, context));
    }
  };
  SparseRows sides[3];  // caused by a number per vertex, for each column of the maps
  for (int axis = 0; axis < 3; ++axis) {
    take_over(sides[axis], system.field_rows(axis, coupling, context));
    solve_functions(functions, axis, [&](Eigen::Index begin, Eigen::Index count, Columns& of_functions) {
      multiply(sides[axis], field->weights(), begin, count, of_functions, context);
    });
  }
  if (!field->has_limbs()) return;
  // The strain of twists is b (R W m)ᵀ = Σ_k m_k b (row k of (R W)ᵀ).
  const LimbTwist& limbs = field->limbs();
  const Columns& weights = field->twist_weights();
  Columns strained;
  for (int m = 0; m < 3; ++m)
    solve_functions(
        weights.cols(), 3 * functions + m, [&](Eigen::Index begin, Eigen::Index count, Columns& sum) {
          sum.setZero(sides[0].rows(), count);
          strained.resize(weights.rows(), count);
          for (int axis = 0; axis < 3; ++axis) {
            const auto strain = [&](std::size_t from, std::size_t to) {
              for (auto v = static_cast<Eigen::Index>(from); v < static_cast<Eigen::Index>(to); ++v) {
                const LimbPoint at = limbs.at(v);
                strained.row(v) = at.moment[m] * at.direction[axis] * weights.row(v).segment(begin, count);
              }
            };
            parallel_blocks(static_cast<std::size_t>(weights.rows()), strain, context, 4096);
            add_product(sides[axis], strained, sum, context);
          }
        });
}

/// Adds the displacements that anchors with targets cause while all handles rest.
void ReducedFrames::Impl::solve_targets(const ConstrainedSystem& system, const Context& context) {
  const std::vector<Anchor>& anchors = system.anchors();
  if (std::none_of(anchors.begin(), anchors.end(), [](const Anchor& a) { return a.target.has_value(); }))
    return;
  const ConstrainedSystem::Known values = system.no_values(3);
  const Columns y = system.solve(values, {}, {.corrections = system.residual_corrections()}, context);
  const Columns x = free_rows(system, system.displacements(y, values, context));
  for (Eigen::Index k = 0; k < x.rows(); ++k) base.row(system.free_vertices()[k]) += scale * x.row(k);
  field->set_base_maps(system.maps(y, values, context));
}

void ReducedFrames::frame(std::span<const HandlePose> poses, PointsRef positions, const Context& context,
                          EvaluationReport* report) const {
  const Impl& d = *impl_;
  require_affine_poses(d.handles, poses);
  if (positions.rows() != d.base.rows())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::positions, .given = positions.rows(), .needed = d.base.rows()});
  ReducedField::Result found;
  if (d.field) {
    std::vector<PoseMatrix> frames;
    for (const HandlePose& pose : poses) frames.push_back(pose_matrix(pose, d.centre, d.scale));
    found = d.field->find(poses, frames.data(), context);
    d.responses.place(found.coefficients, d.scale, d.base, positions, context);
  } else {
    positions = d.base;
  }
  d.place_handles(poses, positions, context);
  if (report == nullptr) return;
  *report = {};
  report->iterations = found.iterations;
  report->last_rotation_change = found.change;
  report->fell_back_to_linear = found.linear;
}

Points ReducedFrames::frame(std::span<const HandlePose> poses, const Context& context,
                            EvaluationReport* report) const {
  Points positions(impl_->base.rows(), 3);
  frame(poses, positions, context, report);
  return positions;
}

void ReducedFrames::Impl::place_handles(std::span<const HandlePose> poses, PointsRef positions,
                                        const Context& context) const {
  for (std::size_t h = 0; h < handles.size(); ++h) {
    if (!handles[h].constrain_position) continue;
    const std::vector<Index>& vertices = handles[h].vertices;
    const auto pose_vertices = [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        positions.row(vertices[k]) = (poses[h].transform * base.row(vertices[k]).transpose()).transpose();
    };
    parallel_blocks(vertices.size(), pose_vertices, context, 4096);
  }
}

Index ReducedFrames::centres() const {
  return impl_->field ? static_cast<Index>(impl_->field->centre_count()) : 0;
}

std::int64_t ReducedFrames::memory_bytes() const {
  return impl_->responses.memory_bytes() + static_cast<std::int64_t>(sizeof(double)) * impl_->base.size() +
         (impl_->field ? impl_->field->memory_bytes() : 0);
}

}  // namespace meshgraft
