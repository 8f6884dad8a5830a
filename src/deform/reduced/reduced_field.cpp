#include "reduced_field.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/QR>

#include "core/parallel.h"
#include "deform/solve/anderson_mixing.h"
#include "deform/solve/rotations.h"
#include "deform/solve/vertex_solver.h"
#include "linalg/sparse.h"
#include "short_numbers.h"
#include "surface_samples.h"
#include "winding.h"

namespace meshgraft {

namespace {

/// Calls `body(first, count)` for blocks of rows, in parallel and with checks between them.
template <class Body>
void for_rows(Eigen::Index rows, const Context& context, const Body& body) {
  parallel_blocks(
      static_cast<std::size_t>(rows),
      [&](std::size_t begin, std::size_t end) {
        body(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin));
      },
      context, 4096);
}

/// Returns weight · [I | 0] (3 or 4 columns) in rows 3v … 3v+2 for each vertex v.
Columns scaled_identities(const Columns& weights, std::size_t column) {
  Columns field = Columns::Zero(3 * weights.rows(), 4);
  for (Eigen::Index v = 0; v < weights.rows(); ++v)
    for (Eigen::Index j = 0; j < 3; ++j) field(3 * v + j, j) = weights(v, static_cast<Eigen::Index>(column));
  return field;
}

}  // namespace

ReducedField::ReducedField(const ConstrainedSystem& system, const RotationField& rotations,
                           std::span<const Handle> handles, const DeformerOptions& options, Index centres,
                           Index samples, const Context& context)
    : system_(&system),
      rotations_(&rotations),
      handles_(handles),
      handle_count_(handles.size()),
      iterations_(rotations.iterations()) {
  context.step("reduce", 0);
  spread_logs(context);
  choose_samples(centres, samples, context);
  choose_winding();
  spread_samples(options.backend, context);
  context.throw_if_stopped();
  if (iterations_ > 0) reduce_smoothing(context);
  context.throw_if_stopped();
  fit_loose_components();
  context.throw_if_stopped();
  if (!rotations.limbs().empty()) reduce_twists(context);
  context.throw_if_stopped();
  maps_.setZero(4, static_cast<Eigen::Index>(samples_.size() * width()));
  base_maps_ = Columns::Zero(3 * static_cast<Eigen::Index>(samples_.size()), 3);
}

void ReducedField::choose_samples(Index centres, Index samples, const Context& context) {
  const Patch& patch = system_->patch();
  const IndexLists& rings = system_->rings();
  const Flags& given = system_->mask().transform;
  Flags open(given.size());
  for (Index v = 0; v < patch.size(); ++v) open[v] = !given[v] && !rings[v].empty();
  // Components without a given map come first. Each needs a centre.
  const Flags& constrained = rotations_->fields().constrained_components();
  const auto loose = static_cast<Index>(std::count(constrained.begin(), constrained.end(), 0));
  centres = std::max(centres, loose);
  samples_ = farthest_vertices(patch.points, rings, given, open, std::max(samples, loose), context);
  centres_.assign(samples_.begin(),
                  samples_.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(
                                         samples_.size(), static_cast<std::size_t>(centres))));
  cell_ = nearest_sample(patch.points, rings, samples_, context);
  areas_.assign(samples_.size(), 0.0);
  normals_ = Points::Zero(static_cast<Eigen::Index>(samples_.size()), 3);
  const std::vector<double>& areas = rotations_->fields().areas();
  for (Index v = 0; v < patch.size(); ++v) {
    if (!open[v]) cell_[v] = -1;
    if (cell_[v] < 0) continue;
    areas_[cell_[v]] += areas[v];
    if (system_->operators()->nodes().apex[v] < 0)
      normals_.row(cell_[v]) += areas[v] * rotations_->normals().row(v);
  }
  for (auto normal : normals_.rowwise())
    if (!normal.isZero(0)) normal.normalize();
}

/// Computes the weights χ, by which the handles' logarithms are blended.
void ReducedField::spread_logs(const Context& context) {
  const Patch& patch = system_->patch();
  const ConstraintMask& mask = system_->mask();
  const IndexLists& rings = system_->rings();
  const SurfaceFields& fields = rotations_->fields();
  given_ = Columns::Zero(patch.size(), static_cast<Eigen::Index>(handle_count_));
  given_areas_.assign(handle_count_, 0.0);
  gives_maps_.assign(handle_count_, 0);
  for (std::size_t h = 0; h < handle_count_; ++h)
    for (const Index vertex : handles_[h].vertices) {
      const Index v = patch.local(vertex);
      if (v < 0 || rings[v].empty() || !handles_[h].constrain_transform) continue;
      gives_maps_[h] = 1;
      given_areas_[h] += fields.areas()[v];
      given_(v, static_cast<Eigen::Index>(h)) = 1;
    }
  for (Index v = 0; v < patch.size(); ++v)
    from_rest_ = from_rest_ || (mask.transform[v] && given_.row(v).isZero(0) && !rings[v].empty());
  blend_weights_ = fields.spread(given_, context);
}

/// Chooses the handles with winding functions, and how many each has. The weights χ of all handles add up to 1
/// where no map is given without a handle; one of them then says nothing that the others do not.
void ReducedField::choose_winding() {
  if (samples_.size() == centres_.size())
    return;  // no samples beside the centres would tell their coefficients
  for (std::size_t h = 0; h < handle_count_; ++h)
    if (gives_maps_[h]) winding_handles_.push_back(static_cast<Index>(h));
  if (!from_rest_ && !winding_handles_.empty()) winding_handles_.pop_back();
  // 14 are within 0.001 up to two full turns. All handles together have at most half as many as there are
  // centres.
  constexpr int most = 14, fewest = 2;
  const auto handles = std::max<std::size_t>(1, winding_handles_.size());
  winding_degree_ = std::clamp(static_cast<int>(centres_.size() / (2 * handles)), fewest, most);
  winding_count_ = winding_handles_.size() * static_cast<std::size_t>(winding_degree_);
}

/// Computes the weights φ, and the means and values of χ and φ that frames need.
void ReducedField::spread_samples(SolverBackend backend, const Context& context) {
  const Patch& patch = system_->patch();
  const auto centre_count = static_cast<Eigen::Index>(centres_.size());
  Flags known = system_->mask().transform;
  Columns values(patch.size(), centre_count + given_.cols());
  for_rows(values.rows(), context, [&](Eigen::Index first, Eigen::Index count) {
    values.block(first, 0, count, centre_count).setZero();
    values.block(first, centre_count, count, given_.cols()) = given_.middleRows(first, count);
  });
  for (Eigen::Index k = 0; k < centre_count; ++k) {
    values(centres_[k], k) = 1;
    known[centres_[k]] = 1;
  }
  const FieldSurface surface = field_surface(*system_);
  const SurfaceFields around_centres(surface, known, rotations_->fields().bending(),
                                     {.bending_length_rel = {}, .backend = backend, .corrects = false},
                                     context);
  const Columns spread = around_centres.spread(std::move(values), context);
  context.throw_if_stopped();
  given_weights_.resize(spread.rows(), given_.cols());
  for_rows(spread.rows(), context, [&](Eigen::Index first, Eigen::Index count) {
    given_weights_.middleRows(first, count) = spread.block(first, centre_count, count, given_.cols());
  });
  cell_influence_ = multiply(cell_mean_rows(1), blend_weights_, context);
  sample_influence_ = blend_weights_(samples_, Eigen::all);
  sample_given_ = given_weights_(samples_, Eigen::all);
  join_winding(spread.leftCols(centre_count), context);
}

/// Returns the winding functions of χ, patch × functions.
Columns ReducedField::winding_weights() const {
  return winding_functions(blend_weights_(Eigen::all, winding_handles_), winding_degree_);
}

/// Makes the functions of centres and the winding functions beside them. Those are functions of χ, less what
/// centres and given maps already represent, so that they are 0 there.
void ReducedField::join_winding(const Eigen::Ref<const Columns>& of_centres, const Context& context) {
  const Eigen::Index centre_count = of_centres.cols();
  const Columns winding = winding_weights();
  const Columns at_centres = winding(centres_, Eigen::all);
  // 1 where the handle gives the map, 0 where others do.
  const Columns own = Columns::Identity(given_.cols(), given_.cols());
  const Columns at_handles = winding_functions(own(Eigen::all, winding_handles_), winding_degree_);
  weights_.resize(of_centres.rows(), centre_count + winding.cols());
  for_rows(weights_.rows(), context, [&](Eigen::Index first, Eigen::Index count) {
    const auto centres = of_centres.middleRows(first, count);
    weights_.block(first, 0, count, centre_count) = centres;
    weights_.block(first, centre_count, count, winding.cols()) =
        winding.middleRows(first, count) - centres * at_centres -
        given_weights_.middleRows(first, count) * at_handles;
  });
  fit_ = fit_functions(weights_(samples_, Eigen::all), fit_weights(), winding_penalty());
}

/// Returns the weights of samples in fits: the areas of their cells, but no less than a small share of the
/// mean. Collapsed faces have no area, and still have to be where their neighbours are.
std::vector<double> ReducedField::fit_weights() const {
  constexpr double least = 1e-4;
  const double mean = std::accumulate(areas_.begin(), areas_.end(), 0.0) / static_cast<double>(areas_.size());
  std::vector<double> weights = areas_;
  for (double& weight : weights) weight = std::max(weight, least * mean);
  return weights;
}

/// Returns a penalty of the winding functions: between samples they could be anything.
Eigen::MatrixXd ReducedField::winding_penalty() const {
  constexpr double share = 0.1;  // chosen: 0.01 does as well
  const std::vector<double>& areas = rotations_->fields().areas();
  const Eigen::Map<const Eigen::VectorXd> weights(areas.data(), weights_.rows());
  return square_integrals(weights_.rightCols(static_cast<Eigen::Index>(winding_count_)), share * weights);
}

/// Reduces smoothing to the functions: a field is fitted to means over cells, and the smoothed functions are
/// known at the samples. The smoothing length is often shorter than a cell, so that a field that is constant on
/// each cell would be too rough: frames of a bumpy sheet would be off by seven times as much.
void ReducedField::reduce_smoothing(const Context& context) {
  constexpr Eigen::Index at_once = 32;
  const Columns means = multiply(cell_mean_rows(1), weights_, context);
  Columns functions;
  smoothed_functions_.resize(means.rows(), means.cols());
  for (Eigen::Index first = 0; first < weights_.cols(); first += at_once) {
    const Eigen::Index width = std::min(at_once, weights_.cols() - first);
    functions.resize(weights_.rows(), width);
    for_rows(functions.rows(), context, [&](Eigen::Index row, Eigen::Index rows) {
      functions.middleRows(row, rows) = weights_.block(row, first, rows, width);
    });
    smoothed_functions_.middleCols(first, width) =
        rotations_->fields().smooth(functions, functions, context)(samples_, Eigen::all);
    context.throw_if_stopped();
  }
  cell_fit_ = fit_functions(means, fit_weights(), winding_penalty());
}

/// Fits affine maps to components with given positions only. The field of such a component starts from its
/// fit.
void ReducedField::fit_loose_components() {
  const SurfaceFields& fields = rotations_->fields();
  const Patch& patch = system_->patch();
  std::vector<Index> number(fields.constrained_components().size(), -1);
  for (std::size_t c = 0; c < number.size(); ++c) {
    if (fields.constrained_components()[c]) continue;
    number[c] = static_cast<Index>(fits_.size());
    fits_.push_back(Columns::Zero(3, static_cast<Eigen::Index>(4 * handle_count_)));
    std::vector<std::pair<Index, std::size_t>> handle_vertices;  // vertex, handle
    for (std::size_t h = 0; h < handle_count_; ++h)
      for (const Index vertex : handles_[h].vertices)
        if (const Index v = patch.local(vertex);
            v >= 0 && handles_[h].constrain_position && fields.component()[v] == static_cast<Index>(c))
          handle_vertices.emplace_back(v, h);
    if (handle_vertices.size() < 4) continue;
    Eigen::MatrixXd handle_points(handle_vertices.size(), 3),
        moves = Eigen::MatrixXd::Zero(handle_vertices.size(), 4 * handle_count_);
    for (std::size_t k = 0; k < handle_vertices.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      handle_points.row(row) = patch.points.row(handle_vertices[k].first);
      moves.row(row).segment<4>(static_cast<Eigen::Index>(4 * handle_vertices[k].second))
          << handle_points.row(row),
          1.0;
    }
    handle_points.rowwise() -= handle_points.colwise().mean().eval();
    moves.rowwise() -= moves.colwise().mean().eval();
    fits_.back() = handle_points.completeOrthogonalDecomposition().solve(moves);
  }
  const auto loose = [&](Index v) { return number[fields.component()[v]]; };
  std::transform(samples_.begin(), samples_.end(), std::back_inserter(sample_component_), loose);
}

/// Returns the functions of the first centres alone: 1 at their own one and 0 at the others of them. Such a
/// function is known when its values at the other centres are, and those of least ∫ |Δφ|² leave no force there.
Columns ReducedField::functions_of_first_centres(std::size_t count, const Context& context) const {
  const auto all = static_cast<Eigen::Index>(centres_.size()), first = static_cast<Eigen::Index>(count);
  if (all == first) return weights_.leftCols(all);
  const std::vector<Index> others(centres_.begin() + first, centres_.end());
  const SparseRows energy = select_rows(rotations_->fields().bending()->matrix, others, context);
  Columns forces(energy.rows(), all);
  multiply_columns(energy, weights_, 0, all, forces, 0, context);
  const Columns values =
      -forces.rightCols(all - first).completeOrthogonalDecomposition().solve(forces.leftCols(first));
  Columns functions(weights_.rows(), first);
  for_rows(functions.rows(), context, [&](Eigen::Index row, Eigen::Index rows) {
    const auto of_all = weights_.middleRows(row, rows);
    functions.middleRows(row, rows) = of_all.leftCols(first) + of_all.middleCols(first, all - first) * values;
  });
  return functions;
}

/// Prepares the strain of twists. Its smooth functions are those of the first centres, which vanish where maps
/// are given. So does the change of the strain by the iterations, which they serve.
void ReducedField::reduce_twists(const Context& context) {
  const std::size_t count =
      winding_count_ == 0 ? centres_.size() : std::max<std::size_t>(1, centres_.size() / 2);
  // Chosen: 30 are no better than 20.
  constexpr std::size_t most_components = 20, fewest_components = 3;
  const std::size_t components =
      winding_count_ == 0 ? 0 : std::max(fewest_components, most_components / winding_handles_.size());
  const SurfaceFields& fields = rotations_->fields();
  twists_ = ReducedTwists(
      rotations_->limbs(),
      {samples_, cell_, fields.areas(), fields.component(), areas_, blend_weights_, cell_influence_},
      functions_of_first_centres(count, context), winding_handles_, static_cast<Eigen::Index>(components),
      context);
}

/// Returns the matrix of means over the cells, with `rows_per_vertex` rows per cell.
SparseRows ReducedField::cell_mean_rows(int rows_per_vertex) const {
  const std::vector<double>& areas = rotations_->fields().areas();
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t v = 0; v < cell_.size(); ++v)
    for (int k = 0; cell_[v] >= 0 && k < rows_per_vertex; ++k)
      entries.emplace_back(rows_per_vertex * cell_[v] + k, rows_per_vertex * static_cast<int>(v) + k,
                           areas[v] / areas_[cell_[v]]);
  SparseRows rows(rows_per_vertex * static_cast<Eigen::Index>(samples_.size()),
                  rows_per_vertex * static_cast<Eigen::Index>(cell_.size()));
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

ReducedField::Columnwise ReducedField::handle_sides(std::size_t number) const {
  const std::size_t handle = number % handle_count_;
  Columnwise sides;
  sides.values = unit_frame_values(*system_, handles_.subspan(handle, 1));
  if (number < handle_count_) {
    sides.field.maps = scaled_identities(given_weights_, handle);
    return sides;
  }
  // In a linear blend, edges with stiffness use the blended transforms, and E_R alone determines the maps.
  sides.field = {scaled_identities(blend_weights_, handle), false};
  const SurfaceFields& fields = rotations_->fields();
  Index loose = 0;
  for (std::size_t c = 0; c < fields.constrained_components().size(); ++c) {
    if (fields.constrained_components()[c]) continue;
    const Columns fit = fits_[loose++].middleCols<4>(static_cast<Eigen::Index>(4 * handle));
    for (Index v = 0; v < system_->patch().size(); ++v)
      if (fields.component()[v] == static_cast<Index>(c)) sides.field.maps.middleRows<3>(3 * v) = fit;
  }
  return sides;
}

void ReducedField::set_maps(std::span<const std::size_t> rows, const Columns& means) {
  for (std::size_t s = 0; s < samples_.size(); ++s)
    for (std::size_t c = 0; c < rows.size(); ++c)
      maps_.topRows<3>().col(static_cast<Eigen::Index>(s * width() + rows[c])) =
          means.col(static_cast<Eigen::Index>(c))
              .segment<3>(static_cast<Eigen::Index>(3 * s))
              .unaryExpr(&short_number);
}

void ReducedField::finish() {
  system_ = nullptr;
  rotations_ = nullptr;
  handles_ = {};
  cell_ = {};
  given_ = weights_ = given_weights_ = blend_weights_ = {};
  twists_.finish();
}

/// Computes the logarithms; returns false if a transform has none. `RotationField::blend` does the same per
/// vertex.
bool ReducedField::handle_logs(std::span<const HandlePose> poses, const Columns& frames,
                               BlendedLogs& logs) const {
  std::vector<PolarParts> parts(poses.size());
  bool from_rest = from_rest_;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t h = 0; h < poses.size(); ++h) {
    if (!gives_maps_[h]) continue;
    if (!polar_decompose(poses[h].transform.linear(), parts[h])) return false;
    from_rest = from_rest || poses[h].rotation.has_value();
    sum += given_areas_[h] * parts[h].rotation;
  }
  if (!from_rest) logs.reference = nearest_rotation(sum);
  logs.handles = Columns::Zero(static_cast<Eigen::Index>(poses.size()), 9);
  for (std::size_t h = 0; h < poses.size(); ++h) {
    if (!gives_maps_[h]) continue;
    Eigen::Vector3d turn = rotation_log(parts[h].rotation * logs.reference.transpose());
    if (poses[h].rotation) turn = nearest_turn(turn, poses[h].rotation->angle() * poses[h].rotation->axis());
    logs.handles.row(static_cast<Eigen::Index>(h)) << turn.transpose(),
        stretch_log(parts[h].stretch).transpose();
  }
  logs.fits = Columns::Zero(static_cast<Eigen::Index>(fits_.size()), 9);
  for (std::size_t c = 0; c < fits_.size(); ++c) {
    const Eigen::Matrix3d change = fits_[c] * frames;
    PolarParts fit;
    if (!polar_decompose(Eigen::Matrix3d::Identity() + change.transpose(), fit)) return false;
    logs.fits.row(static_cast<Eigen::Index>(c))
        << rotation_log(fit.rotation * logs.reference.transpose()).transpose(),
        stretch_log(fit.stretch).transpose();
  }
  return true;
}

ReducedField::Result ReducedField::find(std::span<const HandlePose> poses, const PoseMatrix* frames,
                                        const Context& context) const {
  const auto handle_rows = static_cast<Eigen::Index>(4 * handle_count_);
  Columns pose_matrices(handle_rows, 3);
  for (std::size_t h = 0; h < handle_count_; ++h)
    pose_matrices.middleRows<4>(static_cast<Eigen::Index>(4 * h)) = frames[h];
  Result result;
  result.coefficients = Columns::Zero(static_cast<Eigen::Index>(width()), 3);
  BlendedLogs logs;
  if (!handle_logs(poses, pose_matrices, logs)) {
    result.linear = true;
    result.coefficients.middleRows(handle_rows, handle_rows) = pose_matrices;
    return result;
  }
  result.coefficients.topRows(handle_rows) = pose_matrices;
  const Blend blend = blend_of(logs, context);
  set_field(blend, Columns::Zero(static_cast<Eigen::Index>(samples_.size()), 3), result.coefficients);
  if (iterations_ > 0) local_steps(blend, result, context);
  return result;
}

ReducedField::Blend ReducedField::blend_of(const BlendedLogs& logs, const Context& context) const {
  Blend blend;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    SampleMap at_sample{logs.map_at(sample_influence_, row, sample_component_[k])};
    if (has_limbs()) at_sample.shear = twists_.shear_at_sample(logs, row, at_sample.blended.stretch);
    blend.at_samples.push_back(at_sample);
    if (iterations_ == 0) continue;
    BlendedMap at_cell = logs.map_at(cell_influence_, row, sample_component_[k]);
    if (has_limbs()) at_cell.stretch += twists_.strain_of_cell(logs, row, at_cell.stretch);
    blend.at_cells.push_back(at_cell);
  }
  if (has_limbs()) blend.twists = twists_.of_handles(logs, context);
  return blend;
}

/// Returns (M − I)ᵀ of a cell without the part that anchors' targets cause.
Eigen::Matrix3d ReducedField::cell_map(std::size_t cell, const ShortCoefficients& coefficients) const {
  const auto sums =
      sums_of_products<4>(maps_.data() + 4 * cell * width(), coefficients.data(), coefficients.rows());
  Eigen::Matrix3d map;
  map << sums[0].head<3>(), sums[1].head<3>(), sums[2].head<3>();
  return map;
}

/// Performs the steps of `RotationField::local_steps` on the samples.
void ReducedField::local_steps(const Blend& blend, Result& result, const Context& context) const {
  const auto count = static_cast<Eigen::Index>(samples_.size());
  const Eigen::Map<const Eigen::VectorXd> areas(areas_.data(), count);
  const auto sum_of_products = [&areas](const Columns& a, const Columns& b) {
    return a.cwiseProduct(b).rowwise().sum().dot(areas);
  };
  AndersonMixing mixing(sum_of_products);
  Columns deviation = Columns::Zero(count, 3), raw(count, 3);
  while (result.iterations < iterations_) {
    const ShortCoefficients coefficients = result.coefficients.unaryExpr(&short_number);
    const auto turn = [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const auto row = static_cast<Eigen::Index>(s);
        const Eigen::Matrix3d change = cell_map(s, coefficients) + base_maps_.middleRows<3>(3 * row);
        raw.row(row) = surface_turn(change.transpose() + Eigen::Matrix3d::Identity(), blend.at_cells[s],
                                    normals_.row(row).transpose(), deviation.row(row).transpose())
                           .transpose();
      }
    };
    parallel_blocks(samples_.size(), turn, context, 32);
    const Columns step = smoothed_functions_ * (cell_fit_ * raw) - deviation;
    deviation = mixing.next(deviation, step);
    set_field(blend, deviation, result.coefficients);
    ++result.iterations;
    const double area = areas.sum();
    result.change = area > 0 ? std::sqrt(sum_of_products(step, step) / area) : 0;
    if (result.change < settled_change) break;
  }
}

/// Fits the functions to the field at the samples.
void ReducedField::set_field(const Blend& blend, const Columns& deviation, Columns& coefficients) const {
  // (F − I)ᵀ, and the change of (R W)ᵀ by the deviation, at the samples
  const auto count = static_cast<Eigen::Index>(samples_.size());
  Maps maps(count, 9), changes(has_limbs() ? count : 0, 9);
  for (Eigen::Index row = 0; row < count; ++row) {
    const SampleMap& map = blend.at_samples[static_cast<std::size_t>(row)];
    const Eigen::Matrix3d rotation = rotation_exp(deviation.row(row).transpose()) * map.blended.rotation;
    Eigen::Map<Eigen::Matrix3d>(maps.row(row).data()) =
        rotation * map.blended.stretch - Eigen::Matrix3d::Identity();
    if (has_limbs())
      Eigen::Map<Eigen::Matrix3d>(changes.row(row).data()) = (rotation - map.blended.rotation) * map.shear;
  }
  Maps given(static_cast<Eigen::Index>(handle_count_), 9);
  for (Eigen::Index h = 0; h < given.rows(); ++h)
    Eigen::Map<Eigen::Matrix3d>(given.row(h).data()) = coefficients.middleRows<3>(4 * h).transpose();
  maps -= sample_given_ * given;
  const auto set_rows = [&](std::size_t first, const Maps& values) {
    for (Eigen::Index k = 0; k < values.rows(); ++k)
      coefficients.middleRows<3>(static_cast<Eigen::Index>(first) + 3 * k) =
          Eigen::Map<const Eigen::Matrix3d>(values.row(k).data()).transpose();
  };
  const std::size_t first = 8 * handle_count_;
  set_rows(first, fit_ * maps);
  if (has_limbs()) set_rows(first + 3 * function_count(), blend.twists + twists_.of_change(changes));
}

}  // namespace meshgraft
