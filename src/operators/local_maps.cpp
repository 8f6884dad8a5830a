#include "local_maps.h"

#include <algorithm>
#include <memory>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "core/parallel.h"
#include "core/scattered_bits.h"
#include "laplacian.h"
#include "linalg/sparse.h"

namespace meshgraft {

namespace {

/// n×3, with a dynamic width as required by a thin singular value decomposition.
using Centred = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, Eigen::Dynamic, 3>;

/// Smallest singular value, relative to the largest, of a stencil that determines a local map. The tolerance
/// is far below what thin but valid triangles reach (1:1000 gives 1e-3).
constexpr double rank_tolerance = 1e-8;
constexpr int most_widenings = 3;

/// Returns the output number `index` + 1 of SplitMix64, started with the seed.
std::uint64_t random_bits(std::uint64_t seed, std::uint64_t index) {
  return scattered_bits(seed + (index + 1) * splitmix_step);
}

/// Returns the length of the noise at a vertex, × the mean length of its edges; negative lengths are against
/// the normal. It depends only on the options and the vertex.
double noise_length(const OperatorOptions& options, Index vertex) {
  const std::uint64_t bits = random_bits(options.seed, static_cast<std::uint64_t>(vertex));
  if (options.noise_lengths == NoiseLengths::equal)
    return (bits & 1) != 0 ? options.noise_length_rel : -options.noise_length_rel;
  const double fraction = static_cast<double>(bits >> 11) * 0x1p-53;  // 0 … 1, without 1
  return options.noise_length_rel * (0.8 + 0.4 * fraction);
}

Eigen::RowVector3d mean_of(const Points& points, std::span<const Index> vertices) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (Index j : vertices) sum += points.row(j);
  return sum / static_cast<double>(vertices.size());
}

/// Returns the stencil rows relative to `centre`.
Centred centred_rows(const Points& points, std::span<const Index> stencil, const Eigen::RowVector3d& centre) {
  Centred rows(static_cast<Eigen::Index>(stencil.size()), 3);
  for (std::size_t s = 0; s < stencil.size(); ++s)
    rows.row(static_cast<Eigen::Index>(s)) = points.row(stencil[s]) - centre;
  return rows;
}

/// Returns {i} ∪ N(i).
std::vector<Index> bare_stencil(Index vertex, std::span<const Index> ring) {
  std::vector<Index> stencil{vertex};
  stencil.insert(stencil.end(), ring.begin(), ring.end());
  return stencil;
}

/// Returns P Pᵀ of the stencil of vertex i: the vertex, its ring, and the apex if there is one. It is centred
/// on the mean of the ring.
Eigen::Matrix3d moments(Index vertex, const Points& points, std::span<const Index> ring, Index apex = -1) {
  const Eigen::RowVector3d centre = mean_of(points, ring);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const auto add = [&](Index node) {
    const Eigen::RowVector3d d = points.row(node) - centre;
    sum += d.transpose() * d;
  };
  add(vertex);
  for (const Index node : ring) add(node);
  if (apex >= 0) add(apex);
  return sum;
}

/// Returns the eigenvalues (ascending) and eigenvectors of P Pᵀ over the bare stencil. They measure flatness,
/// and give a substitute for the normal at flat vertices whose faces give none.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(Index vertex, const Points& points,
                                                      std::span<const Index> ring) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments(vertex, points, ring));
  return solver;
}

/// Returns whether the normal has unit length. It is zero if the faces around the vertex cancel.
bool has_direction(const Points& normals, Index vertex) { return normals.row(vertex).squaredNorm() >= 0.5; }

/// The stencil of vertex i, widened by whole rings until it spans space.
struct Stencil {
  std::vector<Index> nodes;
  std::vector<Index> ring;  ///< the nodes whose mean is the centre
};

Stencil spanning_stencil(Index vertex, const StencilNodes& nodes, const IndexLists& rings,
                         Eigen::JacobiSVD<Centred>& svd) {
  Stencil stencil;
  stencil.ring.assign(rings[vertex].begin(), rings[vertex].end());
  for (int widening = 0;; ++widening) {
    stencil.nodes = bare_stencil(vertex, stencil.ring);
    if (nodes.apex[vertex] >= 0) stencil.nodes.push_back(nodes.apex[vertex]);
    svd.compute(centred_rows(nodes.positions, stencil.nodes, mean_of(nodes.positions, stencil.ring)),
                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const auto& sigma = svd.singularValues();
    const bool spans = stencil.nodes.size() >= 4 && sigma[2] > rank_tolerance * sigma[0];
    if (spans || widening == most_widenings) return stencil;
    std::vector<Index> wider = stencil.ring;
    for (Index j : stencil.ring) wider.insert(wider.end(), rings[j].begin(), rings[j].end());
    std::sort(wider.begin(), wider.end());
    wider.erase(std::unique(wider.begin(), wider.end()), wider.end());
    std::erase(wider, vertex);
    if (wider.size() == stencil.ring.size()) return stencil;  // it contains the whole component
    stencil.ring = std::move(wider);
  }
}

/// Returns the rows h_{i,s} of the fit: (Pᵀ)⁺ by singular values, minus the share that centring removes.
Centred fit_coefficients(const Stencil& stencil, const Eigen::JacobiSVD<Centred>& svd) {
  const auto& sigma = svd.singularValues();
  Eigen::Vector3d inverse = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < sigma.size(); ++k)
    if (sigma[k] > rank_tolerance * sigma[0]) inverse[k] = 1 / sigma[k];
  Centred h = svd.matrixU() * inverse.head(sigma.size()).asDiagonal() * svd.matrixV().transpose();
  // X is also centred on the mean of the ring, so each ring node passes on its share of Σ_s h_s.
  const Eigen::RowVector3d share = h.colwise().sum() / static_cast<double>(stencil.ring.size());
  for (std::size_t s = 0; s < stencil.ring.size(); ++s) h.row(static_cast<Eigen::Index>(s) + 1) -= share;
  return h;
}

/// The coefficients h_{i,s} of a node.
struct FitEntry {
  Index node;
  Eigen::RowVector3d coefficients;
};

std::size_t stencil_size(Index vertex, const StencilNodes& nodes, std::span<const Index> ring) {
  return 1 + ring.size() + (nodes.apex[vertex] >= 0 ? 1 : 0);
}

/// Computes (P Pᵀ)⁻¹ of the stencil that is not widened. Returns false where its condition number is above 10⁴,
/// or the stencil spans no space.
bool invert_moments(Index vertex, const StencilNodes& nodes, std::span<const Index> ring,
                    Eigen::Matrix3d& inverse) {
  constexpr double smallest_eigenvalue_rel = 1e-4;
  if (stencil_size(vertex, nodes, ring) < 4) return false;
  const Eigen::Matrix3d sum = moments(vertex, nodes.positions, ring, nodes.apex[vertex]);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  const Eigen::Vector3d& eigenvalues = solver.computeDirect(sum, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(eigenvalues[0] > smallest_eigenvalue_rel * eigenvalues[2])) return false;
  inverse = sum.llt().solve(Eigen::Matrix3d::Identity());
  return true;
}

/// Lists the fit (P Pᵀ)⁻¹ P of a stencil that is not widened, minus the share that centring removes, by
/// ascending nodes.
void list_fit(Index vertex, const StencilNodes& nodes, std::span<const Index> ring,
              const Eigen::Matrix3d& inverse, std::vector<FitEntry>& entries) {
  entries.clear();
  const Eigen::RowVector3d centre = mean_of(nodes.positions, ring);
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  const auto add = [&](Index node) {
    entries.push_back({node, (nodes.positions.row(node) - centre) * inverse});
    sum += entries.back().coefficients;
  };
  const auto after = std::lower_bound(ring.begin(), ring.end(), vertex);
  for (const Index node : std::span(ring.begin(), after)) add(node);
  add(vertex);
  for (const Index node : std::span(after, ring.end())) add(node);
  if (nodes.apex[vertex] >= 0) add(nodes.apex[vertex]);
  // X is also centred on the mean of the ring, so each ring node passes on its share of Σ_s h_s.
  const Eigen::RowVector3d share = sum / static_cast<double>(ring.size());
  for (std::size_t s = 0; s <= ring.size(); ++s)
    if (entries[s].node != vertex) entries[s].coefficients -= share;
}

/// A fit by singular values, to a stencil that may be widened.
struct WideFit {
  Stencil stencil;
  Centred coefficients;

  WideFit(Index vertex, const StencilNodes& nodes, const IndexLists& rings) {
    Eigen::JacobiSVD<Centred> svd;
    stencil = spanning_stencil(vertex, nodes, rings, svd);
    coefficients = fit_coefficients(stencil, svd);
  }

  /// Lists the coefficients by ascending nodes.
  void list(std::vector<FitEntry>& entries) const {
    entries.clear();
    for (std::size_t s = 0; s < stencil.nodes.size(); ++s)
      entries.push_back({stencil.nodes[s], coefficients.row(static_cast<Eigen::Index>(s))});
    std::sort(entries.begin(), entries.end(),
              [](const FitEntry& a, const FitEntry& b) { return a.node < b.node; });
  }
};

/// Returns the place of a vertex's map minus the vertex.
Eigen::Vector3d place_beside(const StencilSurface& surface, Index vertex) {
  const std::span<const Index> ring = surface.rings[vertex];
  const auto count = static_cast<double>(ring.size());
  const auto offset = [&](Index s) -> Eigen::Vector3d {
    return (surface.points.row(s) - surface.points.row(vertex)).transpose();
  };
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double length = 0;
  for (const Index s : ring) {
    mean += offset(s) / count;
    length += offset(s).norm() / count;
  }
  const Eigen::Vector3d apex = length * surface.normals.row(vertex).transpose() - mean;
  Eigen::Matrix3d covariance = mean * mean.transpose() + apex * apex.transpose();
  for (const Index s : ring) covariance += (offset(s) - mean) * (offset(s) - mean).transpose();
  const Eigen::LDLT<Eigen::Matrix3d> solver(covariance);
  if (!(solver.rcond() > 1e-9)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d of_mean = solver.solve(apex - mean) / count;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (const Index s : ring) {
    const Eigen::Vector3d d = offset(s), coefficients = solver.solve(d - mean) - of_mean;
    place += coefficients.dot(d) / 3 * d;
  }
  return place;
}

}  // namespace

StencilNodes make_stencil_nodes(const StencilSurface& surface, const ConstraintMask& mask,
                                const OperatorOptions& options, const Context& context) {
  const Points& points = surface.points;
  const Points& normals = surface.normals;
  const IndexLists& rings = surface.rings;
  const Index n = rings.size();
  StencilNodes nodes;
  nodes.apex.assign(n, -1);
  nodes.flat.assign(n, 0);
  Points directions = normals;
  parallel_blocks(
      n,
      [&](std::size_t begin, std::size_t end) {
        for (auto i = static_cast<Index>(begin); i < static_cast<Index>(end); ++i) {
          if (!mask.is_fitted(i) || rings[i].empty()) continue;
          const auto eigen = spread(i, points, rings[i]);
          nodes.flat[i] = eigen.eigenvalues()[0] < options.flatness * eigen.eigenvalues()[2];
          if (!has_direction(normals, i)) directions.row(i) = eigen.eigenvectors().col(0).transpose();
        }
      },
      context);

  for (Index i = 0; i < n; ++i)
    if (mask.is_fitted(i) && !rings[i].empty() && !has_direction(normals, i)) nodes.without_normal.push_back(i);
  const std::vector<double> edge_lengths = mean_edge_lengths(points, rings);
  const bool with_apexes = options.degenerate != DegenerateTreatment::ft05_noise;
  Index node_count = n;
  if (with_apexes)
    for (Index i = 0; i < n; ++i)
      if (mask.is_fitted(i) && !rings[i].empty()) nodes.apex[i] = node_count++;
  nodes.positions.resize(node_count, 3);
  nodes.positions.topRows(n) = points;
  for (Index i = 0; i < n; ++i) {
    if (nodes.apex[i] >= 0) {
      nodes.positions.row(nodes.apex[i]) =
          points.row(i) + options.apex_height_rel * edge_lengths[i] * directions.row(i);
    } else if (!with_apexes && nodes.flat[i] && mask.is_movable(i)) {
      const Index number = surface.numbers.empty() ? i : surface.numbers[i];
      // FT05 equation 7. Equal lengths have a random side, because noise on one side leaves a flat sheet rough.
      nodes.positions.row(i) += noise_length(options, number) * edge_lengths[i] * directions.row(i);
      nodes.moved.push_back(i);
    }
  }
  return nodes;
}

Points map_places(const StencilSurface& surface, const Context& context) {
  Points places = surface.points;
  parallel_blocks(
      static_cast<std::size_t>(surface.rings.size()),
      [&](std::size_t begin, std::size_t end) {
        for (auto i = static_cast<Index>(begin); i < static_cast<Index>(end); ++i)
          if (!surface.rings[i].empty()) places.row(i) += place_beside(surface, i).transpose();
      },
      context, 1024);
  return places;
}

SparseRows local_map_operator(const StencilNodes& nodes, const IndexLists& rings, const ConstraintMask& mask,
                              const Context& context) {
  const Index n = rings.size();
  std::vector<Eigen::Matrix3d> inverse(n);              // (P Pᵀ)⁻¹ where that is precise enough
  std::vector<std::unique_ptr<const WideFit>> wide(n);  // elsewhere
  std::vector<int> lengths(3 * static_cast<std::size_t>(n), 0);
  parallel_blocks(
      n,
      [&](std::size_t begin, std::size_t end) {
        for (auto i = static_cast<Index>(begin); i < static_cast<Index>(end); ++i) {
          if (!mask.is_fitted(i) || rings[i].empty()) continue;
          if (!invert_moments(i, nodes, rings[i], inverse[i]))
            wide[i] = std::make_unique<const WideFit>(i, nodes, rings);
          const std::size_t length = wide[i] ? wide[i]->stencil.nodes.size() : stencil_size(i, nodes, rings[i]);
          std::fill_n(lengths.begin() + 3 * std::ptrdiff_t{i}, 3, static_cast<int>(length));
        }
      },
      context);

  SparseRows H = rows_of_lengths(lengths, nodes.positions.rows());
  parallel_blocks(
      n,
      [&](std::size_t begin, std::size_t end) {
        std::vector<FitEntry> entries;
        for (auto i = static_cast<Index>(begin); i < static_cast<Index>(end); ++i) {
          if (lengths[3 * static_cast<std::size_t>(i)] == 0) continue;
          if (wide[i])
            wide[i]->list(entries);
          else
            list_fit(i, nodes, rings[i], inverse[i], entries);
          int entry = H.outerIndexPtr()[3 * i];
          for (int k = 0; k < 3; ++k)
            for (const FitEntry& fit : entries) {
              H.innerIndexPtr()[entry] = fit.node;
              H.valuePtr()[entry++] = fit.coefficients[k];
            }
        }
      },
      context);
  return H;
}

Eigen::Matrix3d local_map_deviation(const ConstrainedStencil& stencil, const Points& rest,
                                    const Points& edited) {
  if (stencil.ring.empty()) return Eigen::Matrix3d::Zero();
  const std::vector<Index> vertices = bare_stencil(stencil.vertex, stencil.ring);
  const Centred P = centred_rows(rest, vertices, mean_of(rest, stencil.ring));
  const Centred X = centred_rows(edited, vertices, mean_of(edited, stencil.ring));
  Eigen::JacobiSVD<Centred> svd(P, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(1e-2);
  const Centred excess = X - P * stencil.W.transpose();
  return svd.solve(excess).transpose();
}

}  // namespace meshgraft
