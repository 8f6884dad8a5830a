#include <meshgraft/deform/proxy.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/core/parallel.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/operators/laplacian.h>

#include "core/facts.h"
#include "core/stopwatch.h"
#include "deform/facts.h"
#include "deform/setup/region_states.h"
#include "proxy_domain.h"
#include "skin.h"
#include "tangential_relaxation.h"

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
  explicit Holders(const VertexStates& states_of_region)
      : of_vertex(states_of_region.position.size(), -1), stays_(states_of_region.position) {
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

  // A constraint that the proxy or the rim needs, in the order of the constraints.
  struct Needed {
    std::size_t constraint;
    Index proxy = -1;      ///< index of the vertex in the proxy, or -1
    Index bone = -1;       ///< bone of a rim vertex, or -1
    Index inner_row = -1;  ///< its row of the skin if its map is not given, or -1
  };
  std::vector<Needed> needed;
  std::vector<Handle> needed_handles;  ///< the handles with only their needed vertices

  ProxySummary summary;
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  std::vector<Index> proxy_vertices;
  Triangles proxy_triangles{0, 3};
  std::optional<Deformer> deformer;  ///< empty if nothing is free
  // The bones are the proxy's vertices, one bone that rests, and the vertices at rims.
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
  void build(const Triangles& triangles, const VertexStates& states, const Holders& holders,
             std::span<const Anchor> anchors, std::span<const Feature> features, const ProxyOptions& options,
             const Context& context);
  bool try_build(const ProxyDomain& domain, const VertexStates& states, const Holders& holders,
                 std::span<const Anchor> anchors, std::span<const Feature> features,
                 const ProxyOptions& options, bool keep_all, const Context& context);
  bool make_weights(const ProxyDomain& domain, const Decimated& proxy, const VertexStates& states,
                    const Context& context);
  std::vector<Anchor> proxy_anchors(std::span<const Anchor> anchors, const ProxyDomain& domain,
                                    const Decimated& proxy, Density density, const Context& context) const;
  void make_deformer(const VertexStates& states, const Holders& holders, std::vector<Anchor> anchors,
                     std::span<const Feature> features, const DeformerOptions& options, const Context& context);

  // The steps of each frame.
  std::vector<VertexConstraint> place_handles(std::span<const HandlePose> poses, Points& out) const;
  void move(std::span<const VertexConstraint> given, Points& out, const Context& context,
            EvaluationReport* report) const;
  std::vector<Bone> bones(std::span<const VertexConstraint> given, const Context& context,
                          EvaluationReport* report) const;
  Bone bone_at(const Eigen::RowVector3d& position, const Eigen::RowVector3d& displacement,
               const Eigen::Matrix3d& map_change) const;
};

/// Keeps the rim vertices that an even spacing requires. If the proxy cannot be solved with them, keeps all
/// rim vertices.
void ProxyDeformer::Impl::build(const Triangles& triangles, const VertexStates& states, const Holders& holders,
                                std::span<const Anchor> anchors, std::span<const Feature> features,
                                const ProxyOptions& options, const Context& context) {
  const Index wanted = wanted_vertices(options);
  for (std::size_t a = 0; a < anchors.size(); ++a)
    require_usable(anchors[a], a, static_cast<Index>(rest.rows()));
  Stopwatch watch;
  context.step("decimate", 0);
  const ProxyDomain domain = make_proxy_domain(rest, triangles, states, holders.of_vertex,
                                               options.deformer.operators.laplacian_order, wanted, context);
  summary.spacing = domain.spacing;
  summary.decimate_seconds = watch.seconds();
  if (domain.unknown_vertices == 0) return;
  for (Index v = 0; v < domain.size(); ++v)
    if (!states.position[domain.vertices[v]]) free.push_back(domain.vertices[v]);
  summary.free_vertices = static_cast<Index>(free.size());
  if (try_build(domain, states, holders, anchors, features, options, false, context)) return;
  require_solvable(rest, triangles, states, anchors, context);
  if (try_build(domain, states, holders, anchors, features, options, true, context)) return;
  throw Error(facts::deform::NoProxy{.vertices = options.vertices});
}

/// Returns false if the proxy is under-constrained, or if part of the surface is not connected to it.
bool ProxyDeformer::Impl::try_build(const ProxyDomain& domain, const VertexStates& states,
                                    const Holders& holders, std::span<const Anchor> anchors,
                                    std::span<const Feature> features, const ProxyOptions& options,
                                    bool keep_all, const Context& context) {
  Stopwatch watch;
  const double around = static_cast<double>(domain.size()) / domain.unknown_vertices;
  const auto target = static_cast<Index>(std::min<double>(wanted_vertices(options) * around, domain.size()));
  const Flags keep = vertices_to_keep(domain, keep_all);
  Decimated proxy = target < domain.size()
                        ? decimate(domain.points, domain.triangles, domain.normals, keep, target)
                        : whole_surface(domain);
  constexpr int rounds = 4;  // more rounds change little
  if (target < domain.size())
    relax_tangentially({domain.points, domain.rings, domain.holder, keep}, proxy, rounds, context);
  summary.decimate_seconds += watch.lap();
  context.step("skin", 0);
  centre = domain.centre;
  proxy_triangles = proxy.triangles;
  proxy_vertices.clear();
  for (const Index v : proxy.vertices) proxy_vertices.push_back(domain.vertices[v]);
  summary.vertices = static_cast<Index>(proxy_vertices.size());
  if (!make_weights(domain, proxy, states, context)) return false;
  summary.skin_entries = skin.bones.size();
  summary.skin_seconds = watch.lap();
  try {
    make_deformer(states, holders,
                  proxy_anchors(anchors, domain, proxy, options.deformer.operators.density, context), features,
                  options.deformer, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::unsolvable) return false;
    throw;
  }
  return deformer.has_value();
}

/// Makes the skin and finds the constraints that the proxy and the rims need. Returns false if a vertex
/// cannot be reached from the proxy.
bool ProxyDeformer::Impl::make_weights(const ProxyDomain& domain, const Decimated& proxy,
                                       const VertexStates& states, const Context& context) {
  const auto position_known = [&](Index v) { return states.position[domain.vertices[v]] != 0; };
  const auto feature = [&](Index v) { return states.feature[domain.vertices[v]]; };
  SkinProblem problem{domain.points, domain.rings, proxy.vertices, proxy_reaches(domain, proxy)};
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
  Flags is_constrained(static_cast<std::size_t>(rest.rows()), 0);
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
      if (beside_others()) problem.rim.push_back({v, bone});
    } else if (!position_known(v)) {
      rows.push_back(v);
      skinned.push_back(global);
    } else if (beside_others()) {
      Index& bone = bone_of[v];
      if (!is_constrained[global]) {
        bone = resting_bone();
      } else if (bone < 0) {
        bone = bone_count++;
        if (!states.transform[global]) inner.push_back(v);
      }
      problem.rim.push_back({v, bone});
    }
  }
  problem.rows = rows;
  problem.inner = inner;
  // The rim's influence reaches two proxy edges, since over one edge the proxy's error beside a rim shows as
  // a bend. The reach is limited so that rim vertices reach some tens of others each on average.
  constexpr double rim_reach_rel = 2, most_visits = 30;
  const double area = 0.866 * domain.spacing * domain.spacing * summary.vertices;
  const double edge = std::sqrt(area / (0.866 * domain.size()));
  problem.rim_reach =
      std::min(rim_reach_rel * domain.spacing,
               edge * std::sqrt(most_visits / 3 * static_cast<double>(rows.size()) /
                                static_cast<double>(std::max<std::size_t>(1, problem.rim.size()))));
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
std::vector<Anchor> ProxyDeformer::Impl::proxy_anchors(std::span<const Anchor> anchors,
                                                       const ProxyDomain& domain, const Decimated& proxy,
                                                       Density density, const Context& context) const {
  if (anchors.empty()) return {};
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

void ProxyDeformer::Impl::make_deformer(const VertexStates& states, const Holders& holders,
                                        std::vector<Anchor> anchors, std::span<const Feature> features,
                                        const DeformerOptions& options, const Context& context) {
  const auto count = static_cast<Eigen::Index>(proxy_vertices.size());
  Points proxy_points(count, 3);
  std::vector<Index> region;
  std::vector<Feature> proxy_features(features.begin(), features.end());
  for (Feature& feature : proxy_features) feature.vertices.clear();
  for (Index k = 0; k < count; ++k) {
    const Index v = proxy_vertices[k];
    proxy_points.row(k) = rest.row(v);
    if (!holders.stays(v)) region.push_back(k);
    if (states.feature[v] >= 0) proxy_features[states.feature[v]].vertices.push_back(k);
  }
  std::erase_if(proxy_features, [](const Feature& feature) { return feature.vertices.empty(); });
  if (region.empty()) return;
  std::vector<VertexConstraint> constraints;
  for (const Needed& need : needed) {
    if (need.proxy < 0) continue;
    VertexConstraint& constraint = constraints.emplace_back();
    constraint.vertex = need.proxy;
    if (constrained.gives_position[need.constraint])
      constraint.position = rest.row(constrained.vertex[need.constraint]).transpose();
    if (constrained.gives_transform[need.constraint]) constraint.transform = Eigen::Matrix3d::Identity();
  }
  deformer = Deformer::with_constraints(proxy_points, proxy_triangles, region, constraints, anchors,
                                        proxy_features, options, context);
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
  const Points moved = deformer->evaluate_with_maps(of_proxy, map_changes, context, report);
  std::vector<Bone> result(static_cast<std::size_t>(bone_count), Bone::Zero());
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

/// Moves the free vertices. `given` corresponds to `needed`. `out` is at rest except for vertices of given
/// positions.
void ProxyDeformer::Impl::move(std::span<const VertexConstraint> given, Points& out, const Context& context,
                               EvaluationReport* report) const {
  if (report != nullptr) *report = {};
  if (!deformer) return;
  for (const VertexConstraint& constraint : given) require_usable(constraint);
  std::vector<Bone> posed;
  try {
    posed = bones(given, context, report);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unsolvable) throw;  // the fact names a vertex of the proxy
    throw Error(facts::deform::ProxySolutionNotFinite{});
  }
  const auto follow = [&](Index v, const Bone& bone) {
    const Eigen::Vector3d position = (rest.row(v) - centre).transpose();
    out.row(v) += (bone.leftCols<3>() * position + bone.col(3)).transpose();
  };
  for (const Follower& follower : followers) follow(follower.vertex, posed[follower.bone]);
  parallel_blocks(
      skinned.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) follow(skinned[r], blend(skin, static_cast<Index>(r), posed));
      },
      context, 2048);
}

/// Places all vertices of the handles and returns the needed constraints.
std::vector<VertexConstraint> ProxyDeformer::Impl::place_handles(std::span<const HandlePose> poses,
                                                                 Points& out) const {
  if (poses.size() != handles.size())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::poses, .given = poses.size(), .needed = handles.size()});
  std::vector<VertexConstraint> given;
  std::size_t first = 0, next = 0;  // constraint of the handle's first vertex; index in `needed`
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const Handle& handle = handles[h];
    const std::size_t end = first + handle.vertices.size();
    if (poses[h].curve) {  // the curve's tangent frames depend on all its vertices
      const auto all = handle_constraints(handle, poses[h], rest, normals);
      for (; next < needed.size() && needed[next].constraint < end; ++next)
        given.push_back(all[needed[next].constraint - first]);
      for (const VertexConstraint& constraint : all)
        if (constraint.position) out.row(constraint.vertex) = constraint.position->transpose();
    } else {
      const auto held = handle_constraints(needed_handles[h], poses[h], rest, normals);
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

ProxyDeformer::ProxyDeformer() : impl_(std::make_unique<Impl>()) {}
ProxyDeformer::ProxyDeformer(ProxyDeformer&&) noexcept = default;
ProxyDeformer& ProxyDeformer::operator=(ProxyDeformer&&) noexcept = default;
ProxyDeformer::~ProxyDeformer() = default;

ProxyDeformer::ProxyDeformer(const Points& rest, const Triangles& triangles, const Region& region,
                             const ProxyOptions& options, const Context& context)
    : ProxyDeformer() {
  const auto n = static_cast<Index>(rest.rows());
  require_triangles(rest, triangles);
  require_disjoint(region, n);
  VertexStates states = states_of_region(n, region.whole, region.vertices, region.fixed);
  Impl& d = *impl_;
  d.rest = rest;
  d.handles = region.handles;
  Holders holders(states);
  for (const Handle& handle : region.handles) {
    for (const Index v : handle.vertices)
      d.constrained.add(v, handle.constrain_position, handle.constrain_transform, states);
    holders.hold_together(handle.vertices);
  }
  const bool has_curve = std::any_of(region.handles.begin(), region.handles.end(),
                                     [](const Handle& handle) { return handle.shape == HandleShape::curve; });
  if (has_curve) d.normals = vertex_normals(rest, triangles, vertex_triangles(n, triangles, context), context);
  add_features(region.features, states);
  for (const Feature& feature : region.features) holders.hold_together(feature.vertices);
  d.build(triangles, states, holders, region.anchors, region.features, options, context);

  std::size_t first = 0, next = 0;
  for (Handle handle : d.handles) {
    const std::size_t end = first + handle.vertices.size();
    handle.vertices.clear();
    for (; next < d.needed.size() && d.needed[next].constraint < end; ++next)
      handle.vertices.push_back(d.constrained.vertex[d.needed[next].constraint]);
    d.needed_handles.push_back(std::move(handle));
    first = end;
  }
}

ProxyDeformer ProxyDeformer::with_constraints(const Points& rest, const Triangles& triangles,
                                              std::span<const Index> region,
                                              std::span<const VertexConstraint> constraints,
                                              std::span<const Anchor> anchors,
                                              std::span<const Feature> features, const ProxyOptions& options,
                                              const Context& context) {
  const auto n = static_cast<Index>(rest.rows());
  require_triangles(rest, triangles);
  VertexStates states = states_of_region(n, region.empty(), region, {});
  ProxyDeformer deformer;
  Impl& d = *deformer.impl_;
  d.rest = rest;
  Holders holders(states);
  d.constrained.add(constraints, states);
  const Index first_kind = holders.next_number();  // one number per combination of position and transform
  holders.next_number();
  holders.next_number();
  for (std::size_t c = 0; c < constraints.size(); ++c)
    holders.hold(
        constraints[c].vertex,
        first_kind + (d.constrained.gives_position[c] ? (d.constrained.gives_transform[c] ? 0 : 1) : 2));
  add_features(features, states);
  for (const Feature& feature : features) holders.hold_together(feature.vertices);
  d.build(triangles, states, holders, anchors, features, options, context);
  return deformer;
}

void ProxyDeformer::evaluate(std::span<const HandlePose> poses, Points& positions_out, const Context& context,
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
  const Impl& d = *impl_;
  d.constrained.require_matching(constraints);
  Points positions = d.rest;
  for (const VertexConstraint& constraint : constraints)
    if (constraint.position) positions.row(constraint.vertex) = constraint.position->transpose();
  std::vector<VertexConstraint> given;
  for (const Impl::Needed& need : d.needed) given.push_back(constraints[need.constraint]);
  d.move(given, positions, context, report);
  return positions;
}

const ProxySummary& ProxyDeformer::summary() const { return impl_->summary; }
std::span<const Index> ProxyDeformer::free_vertices() const { return impl_->free; }
std::span<const Index> ProxyDeformer::proxy_vertices() const { return impl_->proxy_vertices; }
const Triangles& ProxyDeformer::proxy_triangles() const { return impl_->proxy_triangles; }

double ProxyDeformer::condition_estimate(const Context& context) const {
  return impl_->deformer ? impl_->deformer->condition_estimate(context) : 1.0;
}

}  // namespace meshgraft
