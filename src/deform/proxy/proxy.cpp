#include <meshgraft/deform/quick_frames.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "core/facts.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "deform/deformer_impl.h"
#include "deform/facts.h"
#include "deform/setup/checks.h"
#include "deform/setup/region_mask.h"
#include "deform/setup/solvability.h"
#include "operators/laplacian.h"
#include "proxy_domain.h"
#include "proxy_relaxation.h"
#include "skin.h"

namespace meshgraft {

namespace {

constexpr Index fewest_vertices = 50;

Index wanted_vertices(const ProxyOptions& options) {
  if (options.vertices < 1)
    throw Error(facts::deform::ProxyWithoutVertices{.vertices = options.vertices}, "proxy");
  return std::max(options.vertices, fewest_vertices);
}

/// Assigns a number to the vertices of each holder. 0 is for vertices outside the region or fixed. Then
/// follow handles (or kinds of constraint) and features. Vertices without a holder have -1.
class Holders {
 public:
  explicit Holders(const ConstraintMask& mask_of_region)
      : of_vertex(mask_of_region.position.size(), -1), stays_(mask_of_region.position) {
    for (std::size_t v = 0; v < of_vertex.size(); ++v)
      if (stays_[v]) of_vertex[v] = 0;
  }
  void hold(Index vertex, Index number) { of_vertex[vertex] = number; }
  /// Assigns all these vertices to one new holder.
  template <class Vertices>
  void hold_together(const Vertices& vertices) {
    const Index number = next_number();
    for (const Index v : vertices) of_vertex[v] = number;
  }
  Index next_number() { return ++last_; }
  bool stays(Index v) const { return stays_[v] != 0; }

  std::vector<Index> of_vertex;

 private:
  Flags stays_;
  Index last_ = 0;
};

/// A checked problem whose proxy is to be made.
struct ProxyProblem {
  const Triangles& triangles;
  const Region& region;
  ConstraintMask mask;
  Holders holders;
  ProxyOptions options;
};

Decimated whole_surface(const ProxyDomain& domain) {
  Decimated all{{}, domain.triangles};
  for (Index v = 0; v < domain.size(); ++v) all.vertices.push_back(v);
  return all;
}

}  // namespace

struct ProxyDeformer::Impl {
  Points rest;
  std::vector<Handle> handles;
  Points normals;  ///< of the rest mesh; only if a handle is a curve
  ConstraintList constrained;

  // A constraint that the proxy or a handle boundary needs, in the order of the constraints.
  struct Needed {
    std::size_t constraint;
    Index proxy = -1;      ///< index of the vertex in the proxy, or -1
    Index bone = -1;       ///< bone of a boundary vertex, or -1
    Index inner_row = -1;  ///< its row of the skin if its map is not given, or -1
  };
  std::vector<Needed> needed;
  std::vector<Handle> needed_handles;  ///< the handles with only their needed vertices

  ProxySummary summary;
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  std::vector<Index> proxy_vertices;
  Triangles proxy_triangles{0, 3};
  std::optional<Deformer> deformer;  ///< empty if nothing is free
  // The bones are the proxy's vertices, one bone that rests, and the vertices at handle boundaries.
  Index bone_count = 0;
  Index resting_bone() const { return static_cast<Index>(proxy_vertices.size()); }
  std::vector<Index> free;  ///< global indices, including vertices of features
  std::vector<Index> skinned;
  Skin skin;  ///< rows of `skinned`, then inner rows
  struct Follower {
    Index vertex, bone;
  };
  std::vector<Follower> followers;  ///< vertices of features, each with its bone

  // The steps of the set-up.
  Impl(DeformProblem problem, const ProxyOptions& options, const Context& context);
  void build(const ProxyProblem& problem, const Context& context);
  bool try_build(const ProxyProblem& problem, const ProxyDomain& domain, bool keep_all, const Context& context);
  bool make_weights(const ProxyDomain& domain, const Decimated& proxy, const ConstraintMask& mask,
                    const Context& context);
  std::vector<Anchor> proxy_anchors(const ProxyProblem& problem, const ProxyDomain& domain,
                                    const Decimated& proxy, const Context& context) const;
  void make_deformer(const ProxyProblem& problem, std::vector<Anchor> anchors, const Context& context);
  void find_needed_handles();

  // The steps of each frame.
  std::vector<VertexConstraint> place_handles(std::span<const HandlePose> poses, PointsRef out) const;
  std::vector<VertexConstraint> needed_of(std::span<const VertexConstraint> constraints) const;
  void move(std::span<const VertexConstraint> given, PointsRef out, const Context& context,
            EvaluationReport* report) const;
  template <class Follow>
  void pose(std::span<const VertexConstraint> given, const Context& context, EvaluationReport* report,
            const Follow& follow) const;
  std::vector<Bone> bones(std::span<const VertexConstraint> given, const Context& context,
                          EvaluationReport* report) const;
  Bone bone_at(const Eigen::RowVector3d& position, const Eigen::RowVector3d& displacement,
               const Eigen::Matrix3d& map_change) const;
};

/// Keeps the boundary vertices that an even spacing requires. If the proxy cannot be solved with them, keeps
/// all boundary vertices.
void ProxyDeformer::Impl::build(const ProxyProblem& problem, const Context& context) {
  const Index wanted = wanted_vertices(problem.options);
  Stopwatch watch;
  context.step("decimate", 0);
  const ProxyDomain domain =
      make_proxy_domain(rest, problem.triangles, problem.mask, problem.holders.of_vertex,
                        problem.options.deformer.operators.laplacian_order, wanted, context);
  summary.spacing = domain.spacing;
  summary.decimate_seconds = watch.seconds();
  if (domain.unknown_vertices == 0) return;
  for (Index v = 0; v < domain.size(); ++v)
    if (!problem.mask.position[domain.vertices[v]]) free.push_back(domain.vertices[v]);
  summary.free_vertices = static_cast<Index>(free.size());
  if (try_build(problem, domain, false, context)) return;
  require_solvable(rest, problem.triangles, problem.mask, context);
  if (try_build(problem, domain, true, context)) return;
  throw Error(facts::deform::NoProxy{.vertices = problem.options.vertices});
}

/// Returns false if the proxy is under-constrained, or if part of the surface is not connected to it.
bool ProxyDeformer::Impl::try_build(const ProxyProblem& problem, const ProxyDomain& domain, bool keep_all,
                                    const Context& context) {
  Stopwatch watch;
  const double around = static_cast<double>(domain.size()) / domain.unknown_vertices;
  const auto target =
      static_cast<Index>(std::min<double>(wanted_vertices(problem.options) * around, domain.size()));
  const Flags keep = vertices_to_keep(domain, keep_all);
  Decimated proxy = target < domain.size()
                        ? decimate(domain.points, domain.triangles, domain.normals, keep, target, context)
                        : whole_surface(domain);
  constexpr int rounds = 4;  // more rounds change little
  if (target < domain.size())
    relax_proxy({domain.points, domain.rings, domain.holder, keep}, proxy, rounds, context);
  summary.decimate_seconds += watch.lap();
  context.step("skin", 0);
  centre = domain.centre;
  proxy_triangles = proxy.triangles;
  proxy_vertices.clear();
  for (const Index v : proxy.vertices) proxy_vertices.push_back(domain.vertices[v]);
  summary.vertices = static_cast<Index>(proxy_vertices.size());
  if (!make_weights(domain, proxy, problem.mask, context)) return false;
  summary.skin_entries = skin.bones.size();
  summary.skin_seconds = watch.lap();
  try {
    make_deformer(problem, proxy_anchors(problem, domain, proxy, context), context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::unsolvable) return false;
    throw;
  }
  return deformer.has_value();
}

/// Makes the skin and finds the constraints that the proxy and the handle boundaries need. Returns false if a
/// vertex is beyond all influence of the proxy.
bool ProxyDeformer::Impl::make_weights(const ProxyDomain& domain, const Decimated& proxy,
                                       const ConstraintMask& mask, const Context& context) {
  const auto position_known = [&](Index v) { return mask.position[domain.vertices[v]] != 0; };
  const auto feature = [&](Index v) { return mask.feature[domain.vertices[v]]; };
  SkinProblem problem{domain.points, domain.rings, proxy.vertices, influence_radii(domain, proxy)};
  std::vector<Index> proxy_of_feature;  // per feature: one of its proxy vertices
  for (std::size_t k = 0; k < proxy.vertices.size(); ++k)
    if (const Index f = feature(proxy.vertices[k]); f >= 0) {
      if (static_cast<std::size_t>(f) >= proxy_of_feature.size()) proxy_of_feature.resize(f + 1, -1);
      if (proxy_of_feature[f] < 0) proxy_of_feature[f] = static_cast<Index>(k);
    }
  const auto feature_bone = [&](Index v) {
    const auto f = static_cast<std::size_t>(feature(v));
    return f < proxy_of_feature.size() ? proxy_of_feature[f] : -1;
  };

  std::vector<Index> bone_of(domain.vertices.size(), -1);  // of constrained vertices
  Flags is_constrained(rest.rows(), 0);
  for (const Index v : constrained.vertex) is_constrained[v] = 1;
  for (std::size_t k = 0; k < proxy.vertices.size(); ++k) bone_of[proxy.vertices[k]] = static_cast<Index>(k);
  bone_count = resting_bone() + 1;
  std::vector<Index> rows, inner;
  followers.clear();
  skinned.clear();
  for (Index v = 0; v < domain.size(); ++v) {
    const Index global = domain.vertices[v];
    const auto ring = domain.rings[v];
    const auto beside_others = [&] {
      return std::any_of(ring.begin(), ring.end(), [&](Index w) {
        return !position_known(w) && (feature(w) < 0 || feature(w) != feature(v));
      });
    };
    if (feature(v) >= 0) {
      const Index bone = feature_bone(v);
      if (bone < 0) continue;
      followers.push_back({global, bone});
      if (beside_others()) problem.boundary.push_back({v, bone});
    } else if (!position_known(v)) {
      rows.push_back(v);
      skinned.push_back(global);
    } else if (beside_others()) {
      Index& bone = bone_of[v];
      if (!is_constrained[global]) {
        bone = resting_bone();
      } else if (bone < 0) {
        bone = bone_count++;
        if (!mask.transform[global]) inner.push_back(v);
      }
      problem.boundary.push_back({v, bone});
    }
  }
  problem.rows = rows;
  problem.inner = inner;
  // The influence radius of a boundary is two proxy edges, since over one edge the proxy's error beside a
  // boundary shows as a bend. It is limited so that each boundary vertex influences some tens of others on
  // average.
  constexpr double boundary_radius_rel = 2, most_visits = 30;
  const double area = 0.866 * domain.spacing * domain.spacing * summary.vertices;
  const double edge = std::sqrt(area / (0.866 * domain.size()));
  problem.boundary_radius =
      std::min(boundary_radius_rel * domain.spacing,
               edge * std::sqrt(most_visits / 3 * static_cast<double>(rows.size()) /
                                static_cast<double>(std::max<std::size_t>(1, problem.boundary.size()))));
  SkinResult result = make_skin(std::move(problem), context);
  if (!result.outside.empty()) return false;
  skin = std::move(result.skin);

  needed.clear();
  std::vector<Index> inner_row(domain.vertices.size(), -1);
  for (std::size_t i = 0; i < inner.size(); ++i) inner_row[inner[i]] = static_cast<Index>(rows.size() + i);
  for (std::size_t c = 0; c < constrained.size(); ++c) {
    const auto found = std::lower_bound(domain.vertices.begin(), domain.vertices.end(), constrained.vertex[c]);
    if (found == domain.vertices.end() || *found != constrained.vertex[c]) continue;
    const auto v = static_cast<Index>(found - domain.vertices.begin());
    Needed need{c};
    if (bone_of[v] < 0) continue;
    (bone_of[v] < resting_bone() ? need.proxy : need.bone) = bone_of[v];
    need.inner_row = inner_row[v];
    needed.push_back(need);
  }
  return true;
}

/// Returns anchors of the proxy that pull together like those of the mesh. Each anchor is assigned to the
/// proxy vertex that its vertex follows most. Under `Density::aware` a row's weight w ℓ stands for an
/// integral.
std::vector<Anchor> ProxyDeformer::Impl::proxy_anchors(const ProxyProblem& problem, const ProxyDomain& domain,
                                                       const Decimated& proxy, const Context& context) const {
  const std::vector<Anchor>& anchors = problem.region.anchors;
  if (anchors.empty()) return {};
  const Density density = problem.options.deformer.operators.density;
  const std::vector<double> lengths = mean_edge_lengths(domain.points, domain.rings);
  Points proxy_points(static_cast<Eigen::Index>(proxy.vertices.size()), 3);
  for (std::size_t k = 0; k < proxy.vertices.size(); ++k)
    proxy_points.row(static_cast<Eigen::Index>(k)) = domain.points.row(proxy.vertices[k]);
  const std::vector<double> proxy_lengths = mean_edge_lengths(
      proxy_points, vertex_rings(static_cast<Index>(proxy_points.rows()), proxy.triangles, context));
  struct Pull {
    double squared_weight = 0;
    Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  };
  std::vector<Pull> pulls(proxy.vertices.size());
  for (const Anchor& anchor : anchors) {
    const auto row = std::lower_bound(skinned.begin(), skinned.end(), anchor.vertex);
    if (row == skinned.end() || *row != anchor.vertex) continue;
    const auto r = static_cast<std::size_t>(row - skinned.begin());
    const auto heaviest =
        std::find_if(skin.bones.begin() + skin.offsets[r], skin.bones.begin() + skin.offsets[r + 1],
                     [&](Index bone) { return bone < resting_bone(); });
    if (heaviest == skin.bones.begin() + skin.offsets[r + 1]) continue;
    const Index k = *heaviest;
    const auto v = std::lower_bound(domain.vertices.begin(), domain.vertices.end(), anchor.vertex) -
                   domain.vertices.begin();
    const double ratio = lengths[v] / proxy_lengths[k];
    const double weight = anchor.weight * (density == Density::aware ? ratio : 1 / ratio);
    pulls[k].squared_weight += weight * weight;
    if (anchor.target)
      pulls[k].displacement += weight * weight * (*anchor.target - rest.row(anchor.vertex).transpose());
  }
  std::vector<Anchor> result;
  for (std::size_t k = 0; k < pulls.size(); ++k) {
    if (!(pulls[k].squared_weight > 0)) continue;
    const Eigen::Vector3d displacement = pulls[k].displacement / pulls[k].squared_weight;
    result.push_back({static_cast<Index>(k), std::sqrt(pulls[k].squared_weight),
                      Eigen::Vector3d(rest.row(proxy_vertices[k]).transpose() + displacement)});
  }
  return result;
}

void ProxyDeformer::Impl::make_deformer(const ProxyProblem& problem, std::vector<Anchor> anchors,
                                        const Context& context) {
  const auto count = static_cast<Eigen::Index>(proxy_vertices.size());
  DeformProblem of_proxy{Points(count, 3), proxy_triangles};
  Region& region = of_proxy.region;
  region.anchors = std::move(anchors);
  region.features = problem.region.features;
  for (Feature& feature : region.features) feature.vertices.clear();
  for (Index k = 0; k < count; ++k) {
    const Index v = proxy_vertices[k];
    of_proxy.rest.row(k) = rest.row(v);
    if (!problem.holders.stays(v)) region.vertices.push_back(k);
    if (const Index f = problem.mask.feature[v]; f >= 0) region.features[f].vertices.push_back(k);
  }
  std::erase_if(region.features, [](const Feature& feature) { return feature.vertices.empty(); });
  if (region.vertices.empty()) return;
  for (const Needed& need : needed) {
    if (need.proxy < 0) continue;
    VertexConstraint& constraint = of_proxy.constraints.emplace_back();
    constraint.vertex = need.proxy;
    if (constrained.gives_position[need.constraint])
      constraint.position = rest.row(constrained.vertex[need.constraint]).transpose();
    if (constrained.gives_transform[need.constraint]) constraint.transform = Eigen::Matrix3d::Identity();
  }
  const auto has_own_position = [&](Index v) { return problem.mask.feature[v] < 0; };
  const auto represented = std::count_if(free.begin(), free.end(), has_own_position),
             held = std::count_if(
                 of_proxy.constraints.begin(), of_proxy.constraints.end(),
                 [](const VertexConstraint& constraint) { return constraint.position.has_value(); }),
             unknown = std::count_if(region.vertices.begin(), region.vertices.end(),
                                     [&](Index k) { return has_own_position(proxy_vertices[k]); }) -
                       held;
  DeformerOptions options = problem.options.deformer;
  if (represented > 0 && unknown > 0)
    options.vertices_represented *= static_cast<double>(represented) / static_cast<double>(unknown);
  deformer.emplace(std::move(of_proxy), options, context);
  summary.deformer = deformer->summary();
}

/// Returns the bone with this change of the map that moves `position` by exactly `displacement`.
Bone ProxyDeformer::Impl::bone_at(const Eigen::RowVector3d& position, const Eigen::RowVector3d& displacement,
                                  const Eigen::Matrix3d& map_change) const {
  Bone bone;
  bone << map_change, displacement.transpose() - map_change * (position - centre).transpose();
  return bone;
}

std::vector<Bone> ProxyDeformer::Impl::bones(std::span<const VertexConstraint> given, const Context& context,
                                             EvaluationReport* report) const {
  std::vector<VertexConstraint> of_proxy;
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (needed[i].proxy < 0) continue;
    of_proxy.push_back(given[i]);
    of_proxy.back().vertex = needed[i].proxy;
  }
  std::vector<Eigen::Matrix3d> map_changes;
  const Points moved = deformer->impl().evaluate_with_maps(of_proxy, map_changes, context, report);
  std::vector<Bone> result(bone_count, Bone::Zero());
  for (std::size_t k = 0; k < proxy_vertices.size(); ++k) {
    const Eigen::RowVector3d position = rest.row(proxy_vertices[k]);
    result[k] = bone_at(position, moved.row(static_cast<Eigen::Index>(k)) - position, map_changes[k]);
  }
  for (std::size_t i = 0; i < needed.size(); ++i) {
    const auto& [constraint, proxy, bone, inner_row] = needed[i];
    if (bone <= resting_bone() || !given[i].position) continue;
    const Eigen::RowVector3d position = rest.row(constrained.vertex[constraint]);
    Eigen::Matrix3d map_change = Eigen::Matrix3d::Zero();
    if (given[i].transform)
      map_change = *given[i].transform - Eigen::Matrix3d::Identity();
    else if (inner_row >= 0)
      map_change = blend(skin, inner_row, result).leftCols<3>();
    result[bone] = bone_at(position, given[i].position->transpose() - position, map_change);
  }
  return result;
}

/// Poses the proxy, and calls `follow(vertex, bone)` for all free vertices, in parallel. `given` corresponds to
/// `needed`.
template <class Follow>
void ProxyDeformer::Impl::pose(std::span<const VertexConstraint> given, const Context& context,
                               EvaluationReport* report, const Follow& follow) const {
  if (report != nullptr) *report = {};
  if (!deformer) return;
  for (const VertexConstraint& constraint : given) validate(constraint);
  std::vector<Bone> posed;
  try {
    posed = bones(given, context, report);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unsolvable) throw;  // the fact names a vertex of the proxy
    throw Error(facts::deform::ProxySolutionNotFinite{});
  }
  for (const Follower& follower : followers) follow(follower.vertex, posed[follower.bone]);
  parallel_blocks(
      skinned.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) follow(skinned[r], blend(skin, static_cast<Index>(r), posed));
      },
      context, 2048);
}

/// Moves the free vertices. `out` is at rest except for vertices of given positions.
void ProxyDeformer::Impl::move(std::span<const VertexConstraint> given, PointsRef out, const Context& context,
                               EvaluationReport* report) const {
  pose(given, context, report, [&](Index v, const Bone& bone) {
    const Eigen::Vector3d position = (rest.row(v) - centre).transpose();
    out.row(v) += (bone.leftCols<3>() * position + bone.col(3)).transpose();
  });
}

std::vector<VertexConstraint> ProxyDeformer::Impl::needed_of(
    std::span<const VertexConstraint> constraints) const {
  constrained.require_matching(constraints);
  std::vector<VertexConstraint> given;
  for (const Needed& need : needed) given.push_back(constraints[need.constraint]);
  return given;
}

/// Places all vertices of the handles and returns the needed constraints.
std::vector<VertexConstraint> ProxyDeformer::Impl::place_handles(std::span<const HandlePose> poses,
                                                                 PointsRef out) const {
  if (poses.size() != handles.size())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::poses, .given = poses.size(), .needed = handles.size()});
  std::vector<VertexConstraint> given;
  std::size_t first = 0, next = 0;  // constraint of the handle's first vertex; index in `needed`
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const Handle& handle = handles[h];
    const std::size_t end = first + handle.vertices.size();
    if (poses[h].curve) {  // the curve's tangent frames depend on all its vertices
      const auto all = handle_constraints(handle, poses[h], {rest, normals});
      for (; next < needed.size() && needed[next].constraint < end; ++next)
        given.push_back(all[needed[next].constraint - first]);
      for (const VertexConstraint& constraint : all)
        if (constraint.position) out.row(constraint.vertex) = constraint.position->transpose();
    } else {
      const auto held = handle_constraints(needed_handles[h], poses[h], {rest, normals});
      given.insert(given.end(), held.begin(), held.end());
      next += held.size();
      if (handle.constrain_position)
        for (const Index v : handle.vertices)
          out.row(v) = (poses[h].transform * rest.row(v).transpose()).transpose();
    }
    first = end;
  }
  return given;
}

namespace {

/// Numbers the holders of a problem. Constraints per vertex have one number per combination of position and
/// transform.
Holders number_holders(const DeformProblem& problem) {
  Holders holders(mask_of_region(static_cast<Index>(problem.rest.rows()), problem.region));
  for (const Handle& handle : problem.region.handles) holders.hold_together(handle.vertices);
  if (!problem.constraints.empty()) {
    const Index first_kind = holders.next_number();
    holders.next_number();
    holders.next_number();
    for (const VertexConstraint& constraint : problem.constraints)
      holders.hold(constraint.vertex, first_kind + (constraint.position ? (constraint.transform ? 0 : 1) : 2));
  }
  for (const Feature& feature : problem.region.features) holders.hold_together(feature.vertices);
  return holders;
}

}  // namespace

ProxyDeformer::Impl::Impl(DeformProblem problem, const ProxyOptions& options, const Context& context)
    : handles(problem.region.handles) {
  const auto n = static_cast<Index>(problem.rest.rows());
  require_triangles(problem.rest, problem.triangles);
  ConstraintMask mask = make_mask(n, problem.region, problem.constraints, constrained);
  Holders holders = number_holders(problem);
  rest = std::move(problem.rest);
  const Triangles& triangles = problem.triangles;
  if (std::any_of(handles.begin(), handles.end(),
                  [](const Handle& handle) { return handle.shape == HandleShape::curve; }))
    normals = vertex_normals(rest, triangles, vertex_triangles(n, triangles, context), context);
  build({triangles, problem.region, std::move(mask), std::move(holders), options}, context);
  find_needed_handles();
}

void ProxyDeformer::Impl::find_needed_handles() {
  std::size_t first = 0, next = 0;
  for (Handle handle : handles) {
    const std::size_t end = first + handle.vertices.size();
    handle.vertices.clear();
    for (; next < needed.size() && needed[next].constraint < end; ++next)
      handle.vertices.push_back(constrained.vertex[needed[next].constraint]);
    needed_handles.push_back(std::move(handle));
    first = end;
  }
}

ProxyDeformer::ProxyDeformer(ProxyDeformer&&) noexcept = default;
ProxyDeformer& ProxyDeformer::operator=(ProxyDeformer&&) noexcept = default;
ProxyDeformer::~ProxyDeformer() = default;

ProxyDeformer::ProxyDeformer(DeformProblem problem, const ProxyOptions& options, const Context& context)
    : impl_(std::make_unique<Impl>(std::move(problem), options, context)) {}

ProxyDeformer::ProxyDeformer(const Points& rest, const Triangles& triangles, const Region& region,
                             const ProxyOptions& options, const Context& context)
    : ProxyDeformer(DeformProblem{rest, triangles, region}, options, context) {}

void ProxyDeformer::evaluate(std::span<const HandlePose> poses, PointsRef positions_out, const Context& context,
                             EvaluationReport* report) const {
  const Impl& d = *impl_;
  if (positions_out.rows() != d.rest.rows())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::positions, .given = positions_out.rows(), .needed = d.rest.rows()});
  positions_out = d.rest;
  const std::vector<VertexConstraint> given = d.place_handles(poses, positions_out);
  d.move(given, positions_out, context, report);
}

Points ProxyDeformer::evaluate(std::span<const HandlePose> poses, const Context& context,
                               EvaluationReport* report) const {
  Points positions(impl_->rest.rows(), 3);
  evaluate(poses, positions, context, report);
  return positions;
}

Points ProxyDeformer::evaluate(std::span<const VertexConstraint> constraints, const Context& context,
                               EvaluationReport* report) const {
  const std::vector<VertexConstraint> given = impl_->needed_of(constraints);
  Points positions = impl_->rest;
  for (const VertexConstraint& constraint : constraints)
    if (constraint.position) positions.row(constraint.vertex) = constraint.position->transpose();
  impl_->move(given, positions, context, report);
  return positions;
}

std::vector<Eigen::Matrix3d> ProxyDeformer::map_changes(std::span<const VertexConstraint> constraints,
                                                        const Context& context,
                                                        EvaluationReport* report) const {
  const std::vector<VertexConstraint> given = impl_->needed_of(constraints);
  std::vector<Eigen::Matrix3d> changes(impl_->rest.rows(), Eigen::Matrix3d::Zero());
  for (const VertexConstraint& constraint : constraints)
    if (constraint.transform) changes[constraint.vertex] = *constraint.transform - Eigen::Matrix3d::Identity();
  impl_->pose(given, context, report, [&](Index v, const Bone& bone) { changes[v] = bone.leftCols<3>(); });
  return changes;
}

const ProxySummary& ProxyDeformer::summary() const { return impl_->summary; }
std::span<const Index> ProxyDeformer::free_vertices() const { return impl_->free; }
std::span<const Index> ProxyDeformer::proxy_vertices() const { return impl_->proxy_vertices; }
const Triangles& ProxyDeformer::proxy_triangles() const { return impl_->proxy_triangles; }

double ProxyDeformer::condition_estimate(const Context& context) const {
  return impl_->deformer ? impl_->deformer->condition_estimate(context) : 1.0;
}

}  // namespace meshgraft
