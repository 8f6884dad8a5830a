#include <meshgraft/deform/quick_frames.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/parallel.h"
#include "deform/deformer_impl.h"
#include "deform/facts.h"
#include "deform/solve/pose_matrix.h"
#include "linalg/sparse.h"

namespace meshgraft {

namespace {

void require_linear(const ConstrainedSystem& system, const DeformerOptions& options) {
  if (options.method != DeformMethod::ft05)
    throw Error(facts::deform::FramesNotLinear{.method = to_string(options.method)});
  if (!system.is_linear()) throw Error(facts::deform::FeatureNotLinear{});
}

void require_rows(Eigen::Index rows, Eigen::Index vertices, facts::core::Rows what) {
  if (rows != vertices) throw Error(facts::core::SizeMismatch{.what = what, .given = rows, .needed = vertices});
}

/// Reads the solution at each vertex. Vertices of the patch have their own row. Vertices outside it, inside a
/// feature that extends beyond the patch, use the feature's shared rows.
class SolutionRows {
 public:
  SolutionRows(const ConstrainedSystem& system, const Columns& y, const ConstrainedSystem::Known& values,
               bool with_maps, const Context& context)
      : system_(system),
        y_(y),
        x_(system.displacements(y, values, context)),
        m_(with_maps ? system.maps(y, values, context) : Columns()) {}

  Eigen::RowVectorXd displacement(Index vertex, Index feature) const {
    if (const Index v = system_.patch().local(vertex); v >= 0) return x_.row(v);
    const Columns rows = system_.feature_rows(feature, y_);
    const Patch& patch = system_.patch();
    return (system_.rest().row(vertex) - patch.centre) / patch.scale * rows.topRows<3>() + rows.row(3);
  }
  Columns map(Index vertex, Index feature) const {
    if (const Index v = system_.patch().local(vertex); v >= 0) return m_.middleRows<3>(3 * v);
    return system_.feature_rows(feature, y_).topRows<3>();
  }

 private:
  const ConstrainedSystem& system_;
  const Columns& y_;
  Columns x_, m_;
};

/// Returns the feature of each given vertex, or -1 for a vertex of no feature.
std::vector<Index> features_outside(const ConstrainedSystem& system, std::span<const Index> vertices) {
  std::vector<Index> result(vertices.size(), -1);
  const std::vector<Feature>& features = system.features();
  for (std::size_t f = 0; f < features.size(); ++f)
    for (const Index vertex : features[f].vertices) {
      const auto at = std::lower_bound(vertices.begin(), vertices.end(), vertex);
      if (at != vertices.end() && *at == vertex) result[at - vertices.begin()] = static_cast<Index>(f);
    }
  return result;
}

/// Returns cof(M) n, normalised: the normal of the surface after the map M.
Eigen::RowVector3d turned_normal(const Eigen::Matrix3d& map, const Eigen::RowVector3d& normal) {
  const Eigen::Matrix3d m = map / std::max(1.0, map.cwiseAbs().maxCoeff());  // squares stay in range
  const Eigen::Vector3d n = normal[0] * m.col(1).cross(m.col(2)) + normal[1] * m.col(2).cross(m.col(0)) +
                            normal[2] * m.col(0).cross(m.col(1));
  return n.stableNormalized().transpose();
}

}  // namespace

HandleBasis::HandleBasis(const Deformer& deformer, const Points& normals, const Context& context)
    : normals_(normals.cast<float>()) {
  const Deformer::Impl& set_up = deformer.impl();
  const ConstrainedSystem& system = *set_up.system;
  if (set_up.per_vertex) throw Error(facts::deform::NoHandles{});
  require_linear(system, set_up.options);
  if (normals.rows() > 0) require_rows(normals.rows(), system.rest().rows(), facts::core::Rows::rest_normals);
  handles_ = set_up.handles;
  base_ = system.rest();
  centre_ = system.patch().centre;
  scale_ = system.patch().scale;
  find_movers(system);
  if (system.row_count() == 0) return;
  solve_columns(system, context);
  solve_targets(system, context);
}

void HandleBasis::find_movers(const ConstrainedSystem& system) {
  const Patch& patch = system.patch();
  std::vector<Index> fitted;  // position known, transform unknown
  for (Index v = 0; v < patch.size(); ++v)
    if (system.mask().position[v] && !system.mask().transform[v]) fitted.push_back(patch.vertices[v]);
  std::set_union(system.free_vertices().begin(), system.free_vertices().end(), fitted.begin(), fitted.end(),
                 std::back_inserter(movers_));
  for (const Handle& handle : handles_) {
    turned_.emplace_back();
    if (!handle.constrain_position) continue;  // its vertices are among the movers, or stay at rest
    std::copy_if(handle.vertices.begin(), handle.vertices.end(), std::back_inserter(turned_.back()),
                 [&](Index v) { return !std::binary_search(movers_.begin(), movers_.end(), v); });
  }
}

/// Solves for a few handles at a time, which bounds the memory of the right-hand sides.
void HandleBasis::solve_columns(const ConstrainedSystem& system, const Context& context) {
  const std::size_t handle_count = handles_.size();
  constexpr std::size_t most_numbers = std::size_t{1} << 26, most_handles = 8;
  const std::size_t at_once = std::clamp(most_numbers / (4 * static_cast<std::size_t>(system.row_count())),
                                         std::size_t{1}, most_handles);
  const std::vector<Index> feature = features_outside(system, movers_);
  weights_.assign(block_count() * handle_count * 4 * lanes, 0.0);
  if (has_normals()) maps_.assign(block_count() * handle_count * 12 * lanes, 0.0F);
  for (std::size_t first = 0; first < handle_count; first += at_once) {
    context.step("basis", static_cast<double>(first) / static_cast<double>(handle_count));
    const std::size_t count = std::min(at_once, handle_count - first);
    const auto values = unit_frame_values(system, std::span(handles_).subspan(first, count));
    const Columns y = system.respond(values, {}, system.residual_corrections(), context);
    const SolutionRows solution(system, y, values, has_normals(), context);
    const auto write = [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t block = k / lanes, lane = k % lanes;
        const Eigen::RowVectorXd b = solution.displacement(movers_[k], feature[k]);
        for (std::size_t c = 0; c < 4 * count; ++c)
          weights_[((block * handle_count + first) * 4 + c) * lanes + lane] = b[static_cast<Eigen::Index>(c)];
        if (!has_normals()) continue;
        const Columns map = solution.map(movers_[k], feature[k]);
        for (std::size_t h = 0; h < count; ++h)
          for (std::size_t e = 0; e < 12; ++e)
            maps_[((block * handle_count + first + h) * 12 + e) * lanes + lane] = static_cast<float>(
                map(static_cast<Eigen::Index>(e / 4), static_cast<Eigen::Index>(4 * h + e % 4)));
      }
    };
    parallel_blocks(movers_.size(), write, context, 1024);
  }
}

/// Adds the displacements that anchors with targets cause while all handles rest.
void HandleBasis::solve_targets(const ConstrainedSystem& system, const Context& context) {
  const std::vector<Anchor>& anchors = system.anchors();
  if (std::none_of(anchors.begin(), anchors.end(), [](const Anchor& a) { return a.target.has_value(); }))
    return;
  const auto values = system.no_values(3);
  const Columns y = system.solve(values, {}, {.corrections = system.residual_corrections()}, context);
  const SolutionRows solution(system, y, values, has_normals(), context);
  const std::vector<Index> feature = features_outside(system, movers_);
  if (has_normals()) base_maps_.assign(block_count() * 9 * lanes, 0.0F);
  for (std::size_t k = 0; k < movers_.size(); ++k) {
    base_.row(movers_[k]) += scale_ * solution.displacement(movers_[k], feature[k]);
    if (!has_normals()) continue;
    const Columns map = solution.map(movers_[k], feature[k]);
    for (std::size_t e = 0; e < 9; ++e)
      base_maps_[(k / lanes * 9 + e) * lanes + k % lanes] =
          static_cast<float>(map(static_cast<Eigen::Index>(e / 3), static_cast<Eigen::Index>(e % 3)));
  }
}

void HandleBasis::frame(std::span<const HandlePose> poses, PointsRef positions, Directions* normals,
                        const Context& context) const {
  require_affine_poses(handles_, poses);
  require_rows(positions.rows(), base_.rows(), facts::core::Rows::positions);
  if (normals != nullptr && !has_normals()) throw Error(facts::deform::BasisWithoutNormals{});
  if (normals != nullptr) require_rows(normals->rows(), base_.rows(), facts::core::Rows::normals);

  // Maps are divided by the largest entry, so that single precision suffices at any scale.
  std::vector<double> frames;
  double largest = 1;
  for (const HandlePose& pose : poses) {
    const auto frame = pose_matrix(pose, centre_, scale_);
    largest = std::max(largest, frame.cwiseAbs().maxCoeff());
    for (const double number : frame.reshaped<Eigen::RowMajor>()) frames.push_back(number);
  }
  const bool at_rest = std::all_of(frames.begin(), frames.end(), [](double number) { return number == 0; });
  MapFrames map_frames{{}, static_cast<float>(1 / largest)};
  for (double& number : frames) {
    map_frames.entries.push_back(static_cast<float>(number / largest));
    number *= scale_;
  }
  const std::size_t blocks = block_count();
  const auto run = [&](std::size_t begin, std::size_t end) {
    // The range holds the block's vertices and all others up to the next block's first vertex.
    const Eigen::Index from = begin == 0 ? 0 : movers_[begin * lanes];
    const Eigen::Index to = end == blocks ? base_.rows() : movers_[end * lanes];
    positions.middleRows(from, to - from) = base_.middleRows(from, to - from);
    if (normals != nullptr) normals->middleRows(from, to - from) = normals_.middleRows(from, to - from);
    for (std::size_t block = begin; block < end && !(at_rest && base_maps_.empty()); ++block) {
      place_block(block, frames, positions);
      if (normals != nullptr) turn_block(block, map_frames, *normals);
    }
  };
  if (blocks > 0) {
    parallel_blocks(blocks, run, context, 1024);
  } else {
    positions = base_;
    if (normals != nullptr) *normals = normals_;
  }
  place_handles(poses, positions, normals, context);
}

Points HandleBasis::frame(std::span<const HandlePose> poses, const Context& context) const {
  Points positions(base_.rows(), 3);
  frame(poses, positions, nullptr, context);
  return positions;
}

/// Adds the displacements Σ_h b_h · pose_h to the block's positions.
void HandleBasis::place_block(std::size_t block, std::span<const double> frames, PointsRef positions) const {
  using Lanes = Eigen::Array<double, lanes, 1>;
  Lanes moves[3] = {Lanes::Zero(), Lanes::Zero(), Lanes::Zero()};
  const double* weight = weights_.data() + block * handles_.size() * 4 * lanes;
  for (std::size_t row = 0; row < 4 * handles_.size(); ++row, weight += lanes) {
    const Eigen::Map<const Lanes> b(weight);
    for (std::size_t c = 0; c < 3; ++c) moves[c] += b * frames[3 * row + c];
  }
  const std::size_t count = std::min(lanes, movers_.size() - block * lanes);
  for (std::size_t lane = 0; lane < count; ++lane) {
    const auto at = static_cast<Eigen::Index>(lane);
    positions.row(movers_[block * lanes + lane]) +=
        Eigen::RowVector3d(moves[0][at], moves[1][at], moves[2][at]);
  }
}

/// Computes the normals cof(M) n with Mᵀ = I + Σ_h C_h · pose_h, divided by one common factor.
void HandleBasis::turn_block(std::size_t block, const MapFrames& frames, Directions& normals) const {
  const float unit = frames.unit;
  using Lanes = Eigen::Array<float, lanes, 1>;
  Lanes m[3][3];  // rows of Mᵀ, the images of the axes
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t c = 0; c < 3; ++c) {
      m[j][c] = Lanes::Constant(j == c ? unit : 0.0F);
      if (!base_maps_.empty())
        m[j][c] += unit * Eigen::Map<const Lanes>(base_maps_.data() + (block * 9 + 3 * j + c) * lanes);
    }
  const float* const entries = frames.entries.data();
  const float* map = maps_.data() + block * handles_.size() * 12 * lanes;
  for (std::size_t h = 0; h < handles_.size(); ++h)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 4; ++k, map += lanes) {
        const Eigen::Map<const Lanes> entry(map);
        for (std::size_t c = 0; c < 3; ++c) m[j][c] += entry * entries[12 * h + 3 * k + c];
      }
  Lanes n[3], turned[3];
  const std::size_t count = std::min(lanes, movers_.size() - block * lanes);
  for (std::size_t c = 0; c < 3; ++c) {
    n[c].setZero();
    for (std::size_t lane = 0; lane < count; ++lane)
      n[c][static_cast<Eigen::Index>(lane)] =
          normals(movers_[block * lanes + lane], static_cast<Eigen::Index>(c));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
    turned[c] = n[0] * (m[1][d] * m[2][e] - m[1][e] * m[2][d]) +
                n[1] * (m[2][d] * m[0][e] - m[2][e] * m[0][d]) + n[2] * (m[0][d] * m[1][e] - m[0][e] * m[1][d]);
  }
  const Lanes length = (turned[0].square() + turned[1].square() + turned[2].square()).sqrt();
  const Lanes inverse = (length > 0.0F).select(1.0F / length, 0.0F);
  for (std::size_t lane = 0; lane < count; ++lane) {
    const auto at = static_cast<Eigen::Index>(lane);
    normals.row(movers_[block * lanes + lane]) << turned[0][at] * inverse[at], turned[1][at] * inverse[at],
        turned[2][at] * inverse[at];
  }
}

void HandleBasis::place_handles(std::span<const HandlePose> poses, PointsRef positions, Directions* normals,
                                const Context& context) const {
  for (std::size_t h = 0; h < handles_.size(); ++h) {
    const std::vector<Index>& vertices = handles_[h].vertices;
    const auto move_vertices = [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        positions.row(vertices[k]) = (poses[h].transform * base_.row(vertices[k]).transpose()).transpose();
    };
    if (handles_[h].constrain_position) parallel_blocks(vertices.size(), move_vertices, context, 4096);
    const Eigen::Matrix3d linear = poses[h].transform.linear();
    if (normals == nullptr || linear.isIdentity(0)) continue;
    const auto turn = [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        normals->row(turned_[h][k]) =
            turned_normal(linear, normals_.row(turned_[h][k]).cast<double>()).cast<float>();
    };
    parallel_blocks(turned_[h].size(), turn, context, 4096);
  }
}

HandleBuffers HandleBasis::buffers() const {
  HandleBuffers buffers;
  buffers.centre = centre_;
  buffers.scale = scale_;
  std::vector<Index> row_of(base_.rows(), -1);
  buffers.vertices = movers_;
  for (const Handle& handle : handles_)
    if (handle.constrain_position)
      buffers.vertices.insert(buffers.vertices.end(), handle.vertices.begin(), handle.vertices.end());
  std::sort(buffers.vertices.begin(), buffers.vertices.end());
  buffers.vertices.erase(std::unique(buffers.vertices.begin(), buffers.vertices.end()), buffers.vertices.end());
  const auto count = static_cast<Eigen::Index>(buffers.vertices.size());
  const Eigen::Index width = has_normals() ? 16 : 4;
  buffers.positions.resize(count, 3);
  if (has_normals()) buffers.normals.resize(count, 3);
  if (!base_maps_.empty()) buffers.maps.setZero(count, 9);
  buffers.blocks.setZero(count, width * static_cast<Eigen::Index>(handles_.size()));
  for (Eigen::Index k = 0; k < count; ++k) {
    const Index v = buffers.vertices[k];
    row_of[v] = static_cast<Index>(k);
    buffers.positions.row(k) = ((base_.row(v) - centre_) / scale_).cast<float>();
    if (has_normals()) buffers.normals.row(k) = normals_.row(v);
  }
  copy_columns(row_of, buffers);
  // A handle's own vertices follow only their handle.
  for (std::size_t h = 0; h < handles_.size(); ++h) {
    if (!handles_[h].constrain_position) continue;
    const Eigen::Index first = width * static_cast<Eigen::Index>(h);
    for (const Index v : handles_[h].vertices)
      buffers.blocks.row(row_of[v]).segment<4>(first) << buffers.positions.row(row_of[v]), 1.0F;
    for (const Index v : turned_[h])
      for (Eigen::Index j = 0; has_normals() && j < 3; ++j) buffers.blocks(row_of[v], first + 4 + 5 * j) = 1.0F;
  }
  return buffers;
}

/// Copies the stored columns from lanes to rows, one row per vertex with columns.
void HandleBasis::copy_columns(const std::vector<Index>& row_of, HandleBuffers& buffers) const {
  const std::size_t handle_count = handles_.size();
  const std::size_t width = has_normals() ? 16 : 4;
  for (std::size_t k = 0; k < movers_.size(); ++k) {
    const std::size_t block = k / lanes, lane = k % lanes;
    const Index row = row_of[movers_[k]];
    float* numbers = &buffers.blocks.coeffRef(row, 0);
    for (std::size_t h = 0; h < handle_count; ++h) {
      for (std::size_t e = 0; e < 4; ++e)
        numbers[width * h + e] =
            static_cast<float>(weights_[((block * handle_count + h) * 4 + e) * lanes + lane]);
      for (std::size_t e = 0; has_normals() && e < 12; ++e)
        numbers[width * h + 4 + e] = maps_[((block * handle_count + h) * 12 + e) * lanes + lane];
    }
    for (std::size_t e = 0; !base_maps_.empty() && e < 9; ++e)
      buffers.maps(row, static_cast<Eigen::Index>(e)) = base_maps_[(block * 9 + e) * lanes + lane];
  }
}

std::vector<Eigen::Matrix<float, 4, 3, Eigen::RowMajor>> HandleBasis::pose_matrices(
    std::span<const HandlePose> poses) const {
  require_affine_poses(handles_, poses);
  std::vector<Eigen::Matrix<float, 4, 3, Eigen::RowMajor>> frames;
  for (const HandlePose& pose : poses) frames.emplace_back(pose_matrix(pose, centre_, scale_).cast<float>());
  return frames;
}

std::int64_t HandleBasis::memory_bytes() const {
  return static_cast<std::int64_t>(weights_.size() * sizeof(double) +
                                   (maps_.size() + base_maps_.size()) * sizeof(float) +
                                   movers_.size() * sizeof(Index)) +
         static_cast<std::int64_t>(sizeof(double)) * base_.size() +
         static_cast<std::int64_t>(sizeof(float)) * normals_.size();
}

}  // namespace meshgraft
