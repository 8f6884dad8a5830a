#include "constrained_system.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "core/require_between.h"
#include "linalg/backends.h"
#include "linalg/early_bisection.h"
#include "linalg/sparse.h"
#include "linalg/sparse_products.h"
#include "mesh/disjoint_sets.h"
#include "stiffness_edges.h"

namespace meshgraft {

ConstrainedSystem::ConstrainedSystem(const ConstrainedMesh& mesh, const DeformerOptions& options,
                                     DeformerSummary& summary, const ConstrainedSystem* other,
                                     const Context& context)
    : residual_corrections_(options.residual_corrections),
      features_(mesh.features.begin(), mesh.features.end()),
      feature_column_(mesh.features.size(), -1) {
  validate(options.operators);
  require_between(residual_corrections_, 0, 10, "residual_corrections");
  Stopwatch watch;
  summary.reused = other != nullptr && share(*other, mesh, context);
  if (!summary.reused) {
    cut_ = std::make_shared<CutPatch>(mesh.rest, mesh.mask, options.operators.laplacian_order, context);
    restrict_to_patch(mesh);
  }
  for (Index v = 0; v < static_cast<Index>(rest().rows()); ++v)
    if (cut_->in_faces[v] && !mesh.mask.position[v]) free_.push_back(v);
  if (patch().size() > 0) {
    if (!operators_) build_operator(options.operators, context);
    region_size_ = std::sqrt(free_area());
    if (!intrinsic_edges_ && options.method != DeformMethod::ft05)
      intrinsic_edges_ = std::make_shared<const IntrinsicEdges>(
          intrinsic_delaunay_edges(patch().points, triangles(), context));
    summary.degenerate_vertices = count_degenerate();
  }
  summary.free_vertices = static_cast<Index>(free_.size());
  if (patch().size() > 0)
    assemble_and_factorise(options, summary, watch, summary.reused ? other : nullptr, context);
}

/// Sets up the solver, if possible from that of a system with the same operator. The ordering graph is bisected
/// beside the assembly of the rows, which takes about as long.
void ConstrainedSystem::assemble_and_factorise(const DeformerOptions& options, DeformerSummary& summary,
                                               Stopwatch& watch, const ConstrainedSystem* other,
                                               const Context& context) {
  const SparseRows F = choose_unknowns(context);
  if (E_.cols() == 0) return;
  const OrderingGraph graph = ordering_graph();
  std::future<void> bisection = begin_bisection(graph, options.backend, context);
  build_rows(F, options, context);
  if (other == nullptr || !change_factor_of(*other, options.backend, summary, watch, context)) {
    NormalMatrix normal = normal_matrix(context);
    context.throw_if_stopped();
    summary.assemble_seconds += watch.lap();
    bisection.get();
    factorise(std::move(normal), graph, options, summary, watch, context);
  }
  prepare_similarities(context);
}

/// Returns for each unknown of `other` its number here, or -1.
std::vector<int> ConstrainedSystem::numbers_of(const ConstrainedSystem& other) const {
  std::vector<int> number(other.E_.cols(), -1);
  for (Eigen::Index node = 0; node < E_.rows(); ++node)
    for (SparseRows::InnerIterator before(other.E_, node), now(E_, node); before && now; ++before, ++now)
      number[before.col()] = static_cast<int>(now.col());
  return number;
}

/// Makes the solver from the factor of another system with the same operator and few other rows. Returns false
/// if it does not know how to. The free area scales stiffness and anchors, so that their rows differ
/// everywhere.
bool ConstrainedSystem::change_factor_of(const ConstrainedSystem& other, SolverBackend backend,
                                         DeformerSummary& summary, Stopwatch& watch, const Context& context) {
  if (other.solver_ == nullptr || other.A_L_.rows() != A_L_.rows() || !edge_rows_.empty() || !anchors_.empty())
    return false;
  if (backend == SolverBackend::iterative || other.solver_->statistics().backend != SolverBackend::multifrontal)
    return false;
  const std::optional<MatrixChange> change = change_of_normal(
      {other.A_L_, other.G_}, {A_L_, G_}, [&] { return coupling(context); }, numbers_of(other), context);
  if (!change) return false;
  summary.assemble_seconds += watch.lap();
  solver_ = change_factor(*other.solver_, *change, context);
  if (solver_ == nullptr) return false;
  summary.factorise_seconds = watch.lap();
  summary.solver = solver_->statistics();
  return true;
}

/// Takes over the other system's patch, rows and bisection tree. Returns false if they differ from those of
/// this mask, or if less than half of the patch would be used. The caller then sets them up itself.
bool ConstrainedSystem::share(const ConstrainedSystem& other, const ConstrainedMesh& mesh,
                              const Context& context) {
  const CutPatch& cut = *other.cut_;
  // If faces of the patch were reversed, a part of it set up alone might get the opposite orientation.
  if (other.operators_ == nullptr || cut.patch.reoriented || cut.feature != mesh.mask.feature) return false;
  const auto active = cut.active_among(mesh.mask);
  if (!active) return false;
  const PatchOperator& operators = *other.operators_;
  const IndexLists& all_rings = operators.rows().rings();
  std::optional<PatchPart> part = part_around(cut, *active, all_rings, context);
  if (part && 2 * part->size < cut.patch.size()) return false;
  if (!part) {
    intrinsic_edges_ = other.intrinsic_edges_;
  } else if (other.intrinsic_edges_) {
    intrinsic_edges_ = std::make_shared<const IntrinsicEdges>(
        intrinsic_delaunay_edges(cut.patch.points, part->triangles, context));
  }
  if (part && !operators.serves(*part, cut.patch)) return false;

  cut_ = other.cut_;
  restrict_to_patch(mesh);
  const IndexLists& rings = part ? part->rings : all_rings;
  fix_unconstrained_components(rings, mask_);
  if (!operators.serves(mask_, part ? intrinsic_edges_.get() : nullptr)) {
    anchors_.clear();
    return false;
  }
  require_solvable(patch(), rings, mask_);
  part_ = std::move(part);
  operators_ = other.operators_;
  fewer_maps_ = operators.fewer_maps(mask_, context);
  *bisection_ = *other.bisection_;
  return true;
}

/// Takes over what constrains the patch's vertices. A known position needs no anchor.
void ConstrainedSystem::restrict_to_patch(const ConstrainedMesh& mesh) {
  mask_ = cut_->patch_mask(mesh.mask);
  for (const Anchor& anchor : mesh.anchors)
    if (patch().local(anchor.vertex) >= 0 && !mesh.mask.position[anchor.vertex]) anchors_.push_back(anchor);
}

void ConstrainedSystem::build_operator(const OperatorOptions& options, const Context& context) {
  const IndexLists rings = vertex_rings(patch().size(), patch().triangles, context);
  fix_unconstrained_components(rings, mask_);
  require_solvable(patch(), rings, mask_);
  operators_ = std::make_shared<PatchOperator>(*cut_, mask_, options, context);
  intrinsic_edges_ = operators_->rows().intrinsic_edges();
}

Index ConstrainedSystem::count_degenerate() const {
  Index count = 0;
  for (Index v = 0; v < patch().size(); ++v)
    if (mask_.is_movable(v) && operators_->rows().nodes().flat[v]) ++count;
  return count;
}

/// Returns the area of a triangle, in patch units.
double ConstrainedSystem::area_of(const Eigen::RowVector3<Index>& corners) const {
  const Eigen::RowVector3d u = patch().points.row(corners[1]) - patch().points.row(corners[0]),
                           v = patch().points.row(corners[2]) - patch().points.row(corners[0]);
  return u.cross(v).norm() / 2;
}

/// Returns the area of the patch's faces with a free corner, without those of features, in patch units.
double ConstrainedSystem::free_area() const {
  double area = 0;
  for (const auto& t : patch().triangles.rowwise()) {
    if (std::none_of(t.begin(), t.end(), [&](Index v) { return !mask_.position[v] && mask_.feature[v] < 0; }))
      continue;
    area += area_of(t);
  }
  return area > 0 ? area : 1;
}

/// Returns the factor of the stiffness at each vertex whose position is unknown, and 0 elsewhere. With
/// `soften_coarse` each connected component of free vertices has its own, so that the parts of a region do not
/// depend on each other.
std::vector<double> ConstrainedSystem::stiffness_scales(const DeformerOptions& options) const {
  const bool is_aware = options.operators.density == Density::aware;
  const double edge_length = operators_->rows().mean_edge_length();
  std::vector<double> scales(patch().size(), 0);
  for (Index v = 0; v < patch().size(); ++v)
    if (!mask_.position[v]) scales[v] = is_aware ? edge_length / region_size_ : 1.0;
  if (!is_aware || !options.soften_coarse) return scales;

  const auto is_free = [&](Index v) { return !mask_.position[v] && mask_.feature[v] < 0; };
  DisjointSets components(patch().size());
  for (const auto& t : patch().triangles.rowwise())
    for (int c = 0; c < 3; ++c)
      if (is_free(t[c]) && is_free(t[(c + 1) % 3])) components.unite(t[c], t[(c + 1) % 3]);
  std::vector<FreeComponent> sizes(patch().size());
  for (Index v = 0; v < patch().size(); ++v)
    if (is_free(v)) sizes[components.root(v)].vertices += options.vertices_represented;
  for (const auto& t : patch().triangles.rowwise())
    if (const auto free = std::find_if(t.begin(), t.end(), is_free); free != t.end())
      sizes[components.root(*free)].area += area_of(t);
  for (Index v = 0; v < patch().size(); ++v)
    if (is_free(v)) scales[v] = stiffness_scale(edge_length, sizes[components.root(v)], options.stiffness);
  return scales;
}

/// Lists the rows w (x_i − x_j) of the edges with a free end; their right-hand side is w ½(F_i + F_j)(p_i −
/// p_j). With `aware` their sum of squares approximates 2 √3 μ² ℓ̄²/D² ∫ ‖∂x − F‖², where D is the size of the
/// region, or of the component with `soften_coarse`. E_R approximates 12 ℓ̄² ∫ ‖∂M − ∂F‖², so that neither size
/// nor tessellation affects the balance of the two, unless a component is coarse (`stiffness_scale`).
void ConstrainedSystem::list_edge_rows(const DeformerOptions& options) {
  if (options.method == DeformMethod::ft05 || options.stiffness <= 0) return;
  const AffineOperator& op = operators_->rows();
  const std::vector<double> scales = stiffness_scales(options);
  visit_stiffness_edges(op, options.stiffness, [&](Index i, Index j, double weight) {
    if ((!mask_.position[i] || !mask_.position[j]) &&
        (mask_.feature[i] < 0 || mask_.feature[i] != mask_.feature[j]))
      edge_rows_.push_back({{i, j}, weight * edge_scale(scales[i], scales[j])});
  });
}

SparseRows ConstrainedSystem::stiffness_rows() const {
  const AffineOperator& op = operators_->rows();
  SparseRows rows(static_cast<Eigen::Index>(edge_rows_.size()), op.nodes().positions.rows());
  if (edge_rows_.empty()) return rows;  // Eigen's makeCompressed fails on a matrix without rows
  rows.reserve(std::vector<int>(edge_rows_.size(), 2));
  for (std::size_t b = 0; b < edge_rows_.size(); ++b) {
    const auto row = static_cast<Eigen::Index>(b);
    rows.insertBackUncompressed(row, edge_rows_[b].ends[0]) = edge_rows_[b].weight;
    rows.insertBackUncompressed(row, edge_rows_[b].ends[1]) = -edge_rows_[b].weight;
  }
  rows.makeCompressed();
  return rows;
}

/// Returns soft rows weight · (x_i − target). For a vertex i that was moved off its plane, x_i is the
/// position recovered by FT05 equation 8. With `aware` the weights are first so small that the rows hardly
/// matter (they approximate an integral over the anchored area, which is set against bending the region over
/// its size); `weigh_anchors` then makes them what they are to be.
SparseRows ConstrainedSystem::anchor_rows(Density density) {
  const AffineOperator& op = operators_->rows();
  const double area = region_size_ * region_size_;
  SparseRows rows(static_cast<Eigen::Index>(anchors_.size()), E_.cols());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t a = 0; a < anchors_.size(); ++a) {
    const Index v = patch().local(anchors_[a].vertex);
    anchor_weights_.push_back(density == Density::aware ? op.edge_lengths()[v] * op.mean_edge_length() / area
                                                        : anchors_[a].weight);
    const auto add = [&](const SparseRows& matrix, Eigen::Index row, double factor) {
      for (SparseRows::InnerIterator it(matrix, row); it; ++it)
        entries.emplace_back(static_cast<int>(a), static_cast<int>(it.col()),
                             anchor_weights_.back() * factor * it.value());
    };
    add(E_, v, 1);
    const Eigen::RowVector3d back = patch().points.row(v) - op.nodes().positions.row(v);
    for (int k = 0; k < 3; ++k)
      if (back[k] != 0) add(G_, 3 * v + k, back[k]);
  }
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

/// Numbers the unknowns: each free vertex followed by its apex, then four for each feature, three of the map
/// and one of the translation. Returns F, by which features' unknowns give the maps of their vertices (3 rows
/// each).
SparseRows ConstrainedSystem::choose_unknowns(const Context& context) {
  const AffineOperator& op = operators_->rows();
  const Index n = patch().size();
  const Eigen::Index node_count = op.nodes().positions.rows();
  std::vector<int> column(node_count, -1);
  int columns = 0;
  std::map<Index, std::vector<Index>> features;
  for (Index v = 0; v < n; ++v) {
    if (mask_.feature[v] >= 0)
      features[mask_.feature[v]].push_back(v);
    else if (!mask_.position[v])
      column[v] = columns++;
    if (op.nodes().apex[v] >= 0 && mask_.is_fitted(v)) column[op.nodes().apex[v]] = columns++;
  }
  const int first_shared = columns;
  columns += 4 * static_cast<int>(features.size());

  std::vector<Eigen::Triplet<double>> E_entries, F_entries;
  for (Eigen::Index node = 0; node < node_count; ++node)
    if (column[node] >= 0) E_entries.emplace_back(static_cast<int>(node), column[node], 1.0);
  shared_begin_ = first_shared;
  int shared = first_shared;
  for (const auto& [feature, vertices] : features) {
    feature_column_[feature] = shared;
    if (features_[feature].similarity) similarities_.push_back(feature);
    for (Index v : vertices) {
      for (int k = 0; k < 3; ++k) {
        E_entries.emplace_back(v, shared + k, op.nodes().positions(v, k));
        F_entries.emplace_back(3 * v + k, shared + k, 1.0);
      }
      E_entries.emplace_back(v, shared + 3, 1.0);
    }
    shared += 4;
  }
  context.throw_if_stopped();
  E_.resize(node_count, columns);
  E_.setFromTriplets(E_entries.begin(), E_entries.end());
  context.throw_if_stopped();
  SparseRows F(3 * n, columns);
  F.setFromTriplets(F_entries.begin(), F_entries.end());
  return F;
}

/// Assembles the rows of the system.
void ConstrainedSystem::build_rows(const SparseRows& F, const DeformerOptions& options,
                                   const Context& context) {
  const AffineOperator& op = operators_->rows();
  take_over(G_, multiply(H(), E_, context));
  if (F.nonZeros() > 0) G_ = SparseRows(G_ + F);
  take_over(A_L_, difference_of_products({op.L(), E_}, {op.delta(), G_}, context));
  context.throw_if_stopped();

  list_edge_rows(options);
  take_over(stiffness_rows_, stiffness_rows());
  context.throw_if_stopped();
  take_over(A_L_, stack(A_L_, multiply(stiffness_rows_, E_, context), context));
  context.throw_if_stopped();
  if (!anchors_.empty()) take_over(A_L_, stack(A_L_, anchor_rows(options.operators.density), context));
  take_over(A_L_transposed_, transpose(A_L_, context));
  take_over(G_transposed_, transpose(G_, context));
  context.step("assemble", 0.7);
}

/// Scales each anchor's row so that weight 1 is as stiff as the rest of the energy is against moving the
/// anchors: where a unit force on all of them moves one by c, its row has the weight 0.95 w/√c. Motions like
/// that response are halved by weight 1, whatever the tessellation and the region. The system must be
/// factorised.
void ConstrainedSystem::weigh_anchors(const Context& context) {
  const auto count = static_cast<Eigen::Index>(anchors_.size());
  const Eigen::Map<const Eigen::VectorXd> small(anchor_weights_.data(), count);
  const SparseRows unit_rows = small.cwiseInverse().asDiagonal() * A_L_.bottomRows(count);
  const Eigen::MatrixXd force = unit_rows.transpose() * Eigen::VectorXd::Ones(count);
  Eigen::VectorXd compliance = unit_rows * solver_->solve(force, context);
  compliance = compliance.cwiseMax(1e-3 * compliance.maxCoeff());
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(A_L_.rows());
  for (Eigen::Index a = 0; a < count; ++a) {
    const double weight = anchor_share * anchors_[a].weight / std::sqrt(compliance[a]);
    factors[A_L_.rows() - count + a] = weight / anchor_weights_[a];
    anchor_weights_[a] = weight;
  }
  take_over(A_L_, SparseRows(factors.asDiagonal() * A_L_));
  take_over(A_L_transposed_, transpose(A_L_, context));
}

/// Computes AᵀA = A_LᵀA_L + Gᵀ(PᵀP)G. PᵀP couples only the maps of pairs and is small.
NormalMatrix ConstrainedSystem::normal_matrix(const Context& context) const {
  if (E_.cols() == 0) return NormalMatrix(0, 0);
  return normal_equations({.A = A_L_,
                           .A_transposed = A_L_transposed_,
                           .G = G_,
                           .G_transposed = G_transposed_,
                           .K = coupling(context)},
                          context);
}

/// Returns the graph for the elimination order. Each unknown belongs to its vertex, except those of features,
/// which vertices far apart share.
OrderingGraph ConstrainedSystem::ordering_graph() const {
  OrderingGraph graph{std::vector<Index>(E_.cols(), -1), &operators_->rows().rings(), bisection_,
                      Points::Zero(E_.cols(), 3)};
  const std::vector<Index>& apex = operators_->rows().nodes().apex;
  for (Index v = 0; v < patch().size(); ++v)
    for (const Index node : {v, apex[v]}) {
      if (node < 0) continue;
      for (SparseRows::InnerIterator entry(E_, node); entry; ++entry)
        if (entry.col() < shared_begin_) {
          graph.group[entry.col()] = v;
          graph.positions.row(entry.col()) = operators_->rows().nodes().positions.row(node);
        }
    }
  return graph;
}

void ConstrainedSystem::factorise(NormalMatrix normal, const OrderingGraph& graph,
                                  const DeformerOptions& options, DeformerSummary& summary, Stopwatch& watch,
                                  const Context& context) {
  solver_ = make_solver(options.backend);
  solver_->analyse(normal, graph, context);
  summary.analyse_seconds = watch.lap();
  solver_->factorise_and_free(normal, context);
  if (!anchors_.empty() && options.operators.density == Density::aware) {
    weigh_anchors(context);
    normal = normal_matrix(context);
    solver_->factorise_and_free(normal, context);
  }
  summary.factorise_seconds = watch.lap();
  summary.solver = solver_->statistics();
}

void ConstrainedSystem::prepare_similarities(const Context& context) {
  const auto count = static_cast<Eigen::Index>(4 * similarities_.size());
  if (count == 0) return;
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(E_.cols(), count);
  for (Eigen::Index s = 0; s < count; ++s) units(shared_row(s), s) = 1;
  similarity_response_ = solver_->solve(units, context);
  Eigen::MatrixXd among(count, count);
  for (Eigen::Index s = 0; s < count; ++s) among.row(s) = similarity_response_.row(shared_row(s));
  similarity_stiffness_ = among.inverse();
}

/// Returns the row of y of the s-th shared unknown of the similarities.
Eigen::Index ConstrainedSystem::shared_row(Eigen::Index s) const {
  return feature_column_[similarities_[s / 4]] + s % 4;
}

double ConstrainedSystem::condition_estimate(const Context& context) const {
  return solver_ ? estimate_condition(one_norm(normal_matrix(context)), *solver_, context) : 1.0;
}

}  // namespace meshgraft
