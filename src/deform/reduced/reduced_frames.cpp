#include <meshgraft/deform/quick_frames.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

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

/// Turns the right-hand sides of a number per vertex in each column of the maps into those of a number in each
/// column of the strain of twists: b (R W m)ᵀ = Σ_k m_k b (row k of (R W)ᵀ).
void to_twists(const LimbTwist& limbs, AlikeRows& sides, const Context& context) {
  parallel_blocks(
      static_cast<std::size_t>(sides[0].nonZeros()),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) {
          const LimbPoint at = limbs.at(sides[0].innerIndexPtr()[e]);
          double along = 0;
          for (int axis = 0; axis < 3; ++axis) along += at.direction[axis] * sides[axis].valuePtr()[e];
          for (int m = 0; m < 3; ++m) sides[m].valuePtr()[e] = at.moment[m] * along;
        }
      },
      context, 4096);
}

/// Solves for the responses to functions, as many at a time as one substitution takes together.
class FunctionResponses {
 public:
  /// `cell_means` is that of maps.
  FunctionResponses(const ConstrainedSystem& system, const SparseRows& cell_means, ReducedField& field,
                    ResponseColumns& responses, const Context& context)
      : system_(system),
        field_(field),
        responses_(responses),
        displacements_(system.displacement_rows()),
        maps_(multiply(cell_means, system.map_rows(), context)),
        y_(displacements_.cols(), at_once) {}

  /// Takes the right-hand sides that `sides` makes of each function. The responses are first, first + 3, ….
  void add(const SparseRows& sides, const Columns& functions, std::size_t first, const Context& context) {
    for (Eigen::Index next = 0; next < functions.cols();) {
      const auto pending = static_cast<Eigen::Index>(rows_.size());
      const Eigen::Index count = std::min(at_once - pending, functions.cols() - next);
      multiply_columns(sides, functions, next, count, y_, pending, context);
      for (const Eigen::Index end = next + count; next < end; ++next)
        rows_.push_back(first + 3 * static_cast<std::size_t>(next));
      if (pending + count == at_once) solve(context);
    }
  }

  /// Solves for all that was added.
  void solve(const Context& context) {
    if (rows_.empty()) return;
    const std::size_t all = 3 * (field_.function_count() + field_.twist_function_count());
    context.step("reduce", static_cast<double>(solved_) / static_cast<double>(all));
    y_.rightCols(at_once - static_cast<Eigen::Index>(rows_.size())).setZero();
    system_.back_substitute(y_, context);
    multiply(displacements_, y_, moves_, context);
    responses_.set(rows_, moves_, context);
    field_.set_maps(rows_, multiply(maps_, y_, context));
    solved_ += rows_.size();
    rows_.clear();
  }

 private:
  static constexpr Eigen::Index at_once = 32;

  const ConstrainedSystem& system_;
  ReducedField& field_;
  ResponseColumns& responses_;
  const SparseRows displacements_, maps_;
  Columns y_, moves_;              ///< shared by all solves, because the first use of fresh pages takes time
  std::vector<std::size_t> rows_;  ///< the responses to the columns of y
  std::size_t solved_ = 0;
};

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

/// Solves for the vertices' responses to handles and functions.
void ReducedFrames::Impl::solve_responses(const ConstrainedSystem& system, const Context& context) {
  responses = ResponseColumns(system.free_vertices(), field->width(), context);
  const SparseRows cell_means = field->cell_mean_rows(3);
  for (std::size_t handle = 0; handle < 2 * handles.size(); ++handle) {  // blended by logarithms, then linearly
    const ReducedField::Columnwise sides = field->handle_sides(handle);
    const Columns y = system.respond(sides.values, sides.field, 0, context);
    const std::array<std::size_t, 4> rows{4 * handle, 4 * handle + 1, 4 * handle + 2, 4 * handle + 3};
    responses.set(rows, free_rows(system, system.displacements(y, sides.values, context)), context);
    field->set_maps(rows, multiply(cell_means, system.maps(y, sides.values, context), context));
  }
  FunctionResponses of_functions(system, cell_means, *field, responses, context);
  AlikeRows sides = system.field_rows(context);
  const std::size_t first = 8 * handles.size();
  for (std::size_t axis = 0; axis < 3; ++axis)
    of_functions.add(sides[axis], field->weights(), first + axis, context);
  if (field->has_limbs()) {
    to_twists(field->limbs(), sides, context);
    for (std::size_t m = 0; m < 3; ++m)
      of_functions.add(sides[m], field->twist_weights(), first + 3 * field->function_count() + m, context);
  }
  of_functions.solve(context);
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
