#include "resolve_deform.h"

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "core/facts.h"
#include "deform/facts.h"
#include "io/selection_files.h"
#include "script/facts.h"
#include "selection_resolver.h"
#include "symmetry.h"

namespace meshgraft {

namespace {

// The role of each vertex of the region. A vertex cannot get two roles.
class Roles {
 public:
  Roles(Index vertex_count, const std::vector<Index>& region) : owner_(vertex_count, outside) {
    for (const Index v : region) owner_[v] = nobody;
  }

  bool is_free(Index v) const { return owner_[v] == nobody; }
  bool is_movable(Index v) const { return is_free(v) || owner_[v] == of_feature; }
  bool is_inside(Index v) const { return owner_[v] != outside; }

  void take(Index vertex, int owner) { owner_[vertex] = owner; }

  /// Assigns `vertices` to a feature. Throws where one of them has a role already.
  void take_feature(const std::vector<Index>& vertices, const Location& location) {
    for (const Index v : vertices) {
      if (!is_inside(v)) throw Error(facts::script::VertexOutsideRegion{.vertex = v}, location);
      if (owner_[v] == of_feature) throw Error(facts::deform::VertexInTwoFeatures{.vertex = v}, location);
      if (!is_free(v)) throw Error(facts::deform::FeatureVertexHeld{.vertex = v}, location);
      owner_[v] = of_feature;
    }
  }

  /// Assigns `vertices` to the handle of that name. Throws where one of them has a role already.
  void take_all(const std::vector<Index>& vertices, const std::string& name, const Location& location) {
    const int handle = static_cast<int>(handles_.size());
    handles_.push_back(name);
    const auto beyond = std::count_if(vertices.begin(), vertices.end(), [&](Index v) { return !is_inside(v); });
    if (beyond > 0)
      throw Error(facts::script::HandleOutsideRegion{.handle = name, .outside = beyond, .all = vertices.size()},
                  location);
    for (const Index v : vertices) {
      if (owner_[v] == handle) throw Error(facts::deform::VertexNamedTwice{.vertex = v}, location);
      require_free(v, location);
      owner_[v] = handle;
    }
  }

  /// Throws where the vertex, which is inside, has a role.
  void require_free(Index v, const Location& location) const {
    if (is_free(v)) return;
    if (const std::string* holder = holder_of(v))
      throw Error(facts::deform::VertexOfTwoHandles{.vertex = v, .handle = *holder}, location);
    throw Error(facts::deform::VertexAlsoFixed{.vertex = v}, location);
  }

  /// Returns the name of the handle that a vertex is part of, or null.
  const std::string* holder_of(Index v) const { return owner_[v] < 0 ? nullptr : &handles_[owner_[v]]; }

  static constexpr int outside = -5, nobody = -4, of_feature = -3, fixed = -2, constrained = -1;

 private:
  std::vector<std::string> handles_;
  std::vector<int> owner_;
};

std::vector<Index> every_vertex(Index count) {
  std::vector<Index> all(count);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

bool ends_share_edge(const std::vector<Index>& curve, const IndexLists& rings) {
  if (curve.size() < 3) return false;
  const auto ring = rings[curve.front()];
  return std::binary_search(ring.begin(), ring.end(), curve.back());
}

Handle resolve_handle(const HandleSpec& spec, SelectionResolver& selections, const SelectionMesh& context,
                      const Location& location) {
  Handle handle;
  handle.name = spec.name;
  handle.shape = spec.shape;
  handle.constrain_position = spec.constrain_position;
  handle.constrain_transform = spec.constrain_transform;
  const Location select = location / "select";
  const bool is_curve = spec.shape == HandleShape::curve;
  handle.vertices =
      is_curve ? selections.ordered(spec.select, select) : selections.vertices(spec.select, select);
  if (handle.vertices.empty()) throw Error(facts::script::HandleEmpty{.handle = spec.name}, select);
  for (const Index v : handle.vertices)
    if (!context.mesh.positions.row(v).allFinite())
      throw Error(facts::script::HandleNotFinite{.handle = spec.name, .vertex = v}, select);
  if (spec.shape == HandleShape::vertex && handle.vertices.size() != 1)
    throw Error(facts::script::NotOneVertex{.handle = spec.name, .count = handle.vertices.size()}, select);
  if (is_curve) handle.closed = spec.closed.value_or(ends_share_edge(handle.vertices, context.rings));
  return handle;
}

HandlePose pose_of_matrix(const Eigen::Matrix4d& matrix) {
  HandlePose pose;
  pose.transform.matrix() = matrix;
  return pose;
}

HandlePose resolve_pose(const PoseSpec& spec, const Handle& handle, const SelectionResolver& selections,
                        const EditFile& edit, const SelectionMesh& context, const Location& location) {
  const Points& rest = context.mesh.positions;
  if (const auto* motion = std::get_if<HandleMotion>(&spec.kind)) {
    const Eigen::Vector3d pivot = motion->pivot ? *motion->pivot : handle_pivot(handle, rest, context.rings);
    try {
      return make_pose(*motion, pivot);
    } catch (const Error& error) {
      throw error.within(location);
    }
  }
  if (const auto* matrix = std::get_if<Eigen::Matrix4d>(&spec.kind)) return pose_of_matrix(*matrix);
  if (const auto* def = std::get_if<PoseSpec::DefFile>(&spec.kind)) {
    const Location where = location / "def" / (edit.base_folder / def->file);
    return pose_of_matrix(parse_def(selections.read(def->file, location / "def"), where));
  }
  HandlePose pose;
  try {
    pose.curve = redraw_curve(handle, rest, std::get<PoseSpec::Redrawn>(spec.kind).polyline);
  } catch (const Error& error) {
    throw error.within(location / "curve");
  }
  return pose;
}

// Per-vertex constraints that join targets and transforms.
class OwnConstraints {
 public:
  OwnConstraints(const SelectionMesh& context, Roles& roles) : context_(context), roles_(roles) {}

  void add(const TargetSpec& target, const Location& where) {
    VertexConstraint& constraint = constraint_of(target.vertex, where);
    if (constraint.position && (context_.weld.empty() || *constraint.position != target.position))
      throw Error(facts::script::TwoTargets{.vertex = constraint.vertex}, where);
    constraint.position = target.position;
  }

  void add(const TransformSpec& transform, const Location& where) {
    VertexConstraint& constraint = constraint_of(transform.vertex, where);
    if (constraint.transform && (context_.weld.empty() || *constraint.transform != transform.matrix))
      throw Error(facts::script::TwoTransforms{.vertex = constraint.vertex}, where);
    constraint.transform = transform.matrix;
  }

  /// Adds the mirror images of the constraints. A vertex that is its own partner keeps its constraint.
  void add_images(const MirrorMatch& symmetry, const Location& location) {
    const Eigen::Affine3d& reflection = symmetry.reflection();
    const Eigen::Matrix3d& s = reflection.linear();
    const std::map<Index, VertexConstraint> given = constraints_;
    for (const auto& [vertex, constraint] : given) {
      const Location where = location / Location::place(fmt::format("the mirror image of vertex {}", vertex));
      const Index partner = symmetry.required_partner(vertex, where);
      if (partner == vertex) continue;
      if (constraint.position) add(TargetSpec{partner, reflection * *constraint.position}, where);
      if (constraint.transform) add(TransformSpec{partner, s * *constraint.transform * s}, where);
    }
  }

  /// Returns the constraints ascending by vertex.
  std::vector<VertexConstraint> list() const {
    std::vector<VertexConstraint> list;
    for (const auto& [vertex, constraint] : constraints_) list.push_back(constraint);
    return list;
  }

 private:
  VertexConstraint& constraint_of(Index vertex, const Location& where) {
    const Index vertex_count = context_.mesh.vertex_count();
    if (vertex >= vertex_count)
      throw Error(facts::core::NoSuchVertex{.vertex = vertex, .count = vertex_count}, where);
    vertex = context_.weld.of(vertex);
    auto [entry, is_new] = constraints_.try_emplace(vertex);
    if (!is_new) return entry->second;
    if (!roles_.is_inside(vertex)) throw Error(facts::script::VertexOutsideRegion{.vertex = vertex}, where);
    roles_.require_free(vertex, where);
    roles_.take(vertex, Roles::constrained);
    entry->second.vertex = vertex;
    return entry->second;
  }

  const SelectionMesh& context_;
  Roles& roles_;
  std::map<Index, VertexConstraint> constraints_;
};

void require_counts(const ExpectedCounts& expected, const ExpectedCounts& found, const Location& location) {
  const auto require = [&](const std::optional<Index>& count, const std::optional<Index>& actual,
                           const char* name) {
    if (count && *count != *actual)
      throw Error(facts::script::WrongCount{.expected = *count, .found = *actual}, location / "counts" / name);
  };
  require(expected.vertices, found.vertices, "vertices");
  require(expected.faces, found.faces, "faces");
  require(expected.region, found.region, "region");
  require(expected.fixed, found.fixed, "fixed");
  require(expected.handle, found.handle, "handle");
  require(expected.free, found.free, "free");
}

// Resolves a deform step to vertices and numbers.
class DeformResolver {
 public:
  DeformResolver(const EditFile& edit, const DeformStep& step, const SelectionMesh& context,
                 const Location& location, const ProducedSets& produced)
      : edit_(edit), step_(step), context_(context), location_(location), selections_(edit, context, produced) {
    if (!step.symmetry) return;
    symmetry_.emplace(*step.symmetry, context, location / "symmetry");
    resolved_.symmetry.emplace().reflection = symmetry_->reflection();
  }

  ResolvedDeform resolve() {
    require_counts(ExpectedCounts{.vertices = step_.counts.vertices, .faces = step_.counts.faces}, found(),
                   location_);
    const std::vector<Index> inside = find_region();
    Roles roles(context_.mesh.vertex_count(), inside);
    const std::vector<Index> rim = find_fixed(inside, roles);
    hold_handles(roles);
    if (symmetry_) hold_twins(roles);
    resolved_.constraints = find_constraints(roles);
    find_features(roles);
    // Vertices of a default rim that handles, targets or features do not use are fixed.
    for (const Index v : rim) {
      if (!roles.is_free(v)) continue;
      resolved_.region.fixed.push_back(v);
      roles.take(v, Roles::fixed);
    }
    resolved_.region.anchors = find_anchors(roles);
    require_counts(step_.counts, found(inside), location_);
    resolved_.region.symmetric = step_.symmetry.has_value();
    resolved_.region.whole = is_whole() || static_cast<Index>(inside.size()) == context_.mesh.vertex_count();
    if (!resolved_.region.whole) resolved_.region.vertices = inside;
    return std::move(resolved_);
  }

 private:
  bool is_whole() const { return std::holds_alternative<Selection::All>(step_.region.kind); }

  // Returns the selected vertices and their mirror images. Only an empty list of indices may select none.
  std::vector<Index> vertices_of(const EditSelection& selection, const Location& where) {
    std::vector<Index> vertices = selections_.vertices(selection, where);
    const auto* list = std::get_if<Selection::Indices>(&selection.kind);
    if (vertices.empty() && list == nullptr) throw Error(facts::script::SelectionEmpty{}, where);
    return symmetry_ ? symmetry_->with_images(vertices) : vertices;
  }

  std::vector<Index> find_region() {
    std::vector<Index> inside = is_whole() ? every_vertex(context_.mesh.vertex_count())
                                           : selections_.vertices(step_.region, location_ / "region");
    if (inside.empty()) throw Error(facts::script::RegionEmpty{}, location_ / "region");
    if (!symmetry_) return inside;
    inside = symmetry_->with_images(inside);
    const std::vector<Index> lost = symmetry_->without_partner(inside);
    resolved_.symmetry->without_partner = static_cast<Index>(lost.size());
    if (!lost.empty()) resolved_.notes.push_back(symmetry_->note_about(lost, inside.size()));
    return inside;
  }

  // Returns the rim that is fixed by default where the step names no fixed vertices.
  std::vector<Index> find_fixed(const std::vector<Index>& inside, Roles& roles) {
    if (step_.fixed) {
      for (const Index v : vertices_of(*step_.fixed, location_ / "fixed"))
        if (roles.is_inside(v)) resolved_.region.fixed.push_back(v);
      for (const Index v : resolved_.region.fixed) roles.take(v, Roles::fixed);
      return {};
    }
    if (is_whole()) return {};
    const auto whole_region = std::make_shared<const Selection>(Selection::Indices{inside});
    return meshgraft::resolve(Selection(Selection::Rim{whole_region, 2}), context_, location_ / "region");
  }

  Location handle_location(std::size_t handle) const { return (location_ / "handles")[handle]; }

  void hold(Handle handle, HandlePose pose, Roles& roles, const Location& where) {
    roles.take_all(handle.vertices, handle.name, where / "select");
    resolved_.poses.push_back(std::move(pose));
    resolved_.region.handles.push_back(std::move(handle));
  }

  void hold_handles(Roles& roles) {
    for (std::size_t i = 0; i < step_.handles.size(); ++i) {
      const HandleSpec& spec = step_.handles[i];
      const Location where = handle_location(i);
      Handle handle = resolve_handle(spec, selections_, context_, where);
      HandlePose pose = resolve_pose(spec.pose, handle, selections_, edit_, context_, where / "pose");
      if (symmetry_) {
        twins_.push_back(symmetry_->twin_of(handle, where / "select"));
        if (!twins_.back()) resolved_.symmetry->own.push_back(i);
      }
      hold(std::move(handle), std::move(pose), roles, where);
    }
  }

  void hold_twins(Roles& roles) {
    for (std::size_t i = 0; i < twins_.size(); ++i) {
      if (!twins_[i]) continue;
      Handle twin = *std::move(twins_[i]);
      require_free(twin, roles, i);
      HandlePose pose = twin_pose(step_.handles[i].pose, resolved_.poses[i], twin, context_.mesh.positions,
                                  symmetry_->reflection());
      resolved_.symmetry->twin_of.push_back(i);
      hold(std::move(twin), std::move(pose), roles, handle_location(i));
    }
  }

  // Throws where a twin meets another role, with a message about the symmetry: the selections themselves are
  // correct.
  void require_free(const Handle& twin, const Roles& roles, std::size_t i) const {
    for (const HandleSpec& other : step_.handles)
      if (other.name == twin.name)
        throw Error(facts::script::NameOfTwin{.name = twin.name}, handle_location(i) / "name");
    const auto taken = std::find_if(twin.vertices.begin(), twin.vertices.end(),
                                    [&](Index v) { return roles.is_inside(v) && !roles.is_free(v); });
    if (taken == twin.vertices.end()) return;
    const std::string& name = step_.handles[i].name;
    const Location where = handle_location(i) / "select";
    if (const std::string* holder = roles.holder_of(*taken))
      throw Error(facts::script::MirrorImageHeld{.vertex = *taken, .handle = name, .other = *holder}, where);
    throw Error(facts::script::MirrorImageFixed{.vertex = *taken, .handle = name}, where);
  }

  std::vector<VertexConstraint> find_constraints(Roles& roles) const {
    OwnConstraints constraints(context_, roles);
    for (std::size_t i = 0; i < step_.targets.size(); ++i)
      constraints.add(step_.targets[i], (location_ / "targets")[i]);
    for (std::size_t i = 0; i < step_.transforms.size(); ++i)
      constraints.add(step_.transforms[i], (location_ / "transforms")[i]);
    if (symmetry_) constraints.add_images(*symmetry_, location_ / "symmetry");
    return constraints.list();
  }

  // A feature that overlaps its mirror image is one with it. Otherwise the image is a feature of its own.
  void find_features(Roles& roles) {
    for (std::size_t i = 0; i < step_.features.size(); ++i) {
      const Location where = (location_ / "features")[i] / "select";
      const std::vector<Index> vertices = selections_.vertices(step_.features[i].select, where);
      if (vertices.empty()) throw Error(facts::script::SelectionEmpty{}, where);
      std::vector<std::vector<Index>> parts{vertices};
      if (symmetry_) {
        const std::vector<Index> both = symmetry_->with_images(vertices);
        const bool overlaps = std::any_of(vertices.begin(), vertices.end(), [&](Index v) {
          return std::binary_search(vertices.begin(), vertices.end(), symmetry_->partner(v));
        });
        if (overlaps) {
          parts = {both};
        } else {
          parts.emplace_back();
          std::set_difference(both.begin(), both.end(), vertices.begin(), vertices.end(),
                              std::back_inserter(parts.back()));
        }
      }
      for (std::vector<Index>& part : parts) {
        roles.take_feature(part, where);
        if (!part.empty())
          resolved_.region.features.push_back({std::move(part), step_.features[i].similarity, {}});
      }
    }
  }

  std::vector<Anchor> find_anchors(const Roles& roles) {
    std::map<Index, Anchor> anchors;
    for (std::size_t i = 0; i < step_.anchors.size(); ++i) {
      const Location where = (location_ / "anchors")[i] / "select";
      for (const Index v : vertices_of(step_.anchors[i].select, where)) {
        if (!roles.is_movable(v)) continue;  // held and immovable vertices need no anchor
        if (!anchors.try_emplace(v, Anchor{v, step_.anchors[i].weight, {}}).second)
          throw Error(facts::script::AnchoredTwice{.vertex = v}, where);
      }
    }
    std::vector<Anchor> list;
    for (const auto& [vertex, anchor] : anchors) list.push_back(anchor);
    return list;
  }

  ExpectedCounts found(const std::vector<Index>& inside = {}) const {
    const Region& region = resolved_.region;
    Index handle_count = 0;
    for (const Handle& handle : region.handles) handle_count += static_cast<Index>(handle.vertices.size());
    ExpectedCounts found;
    found.vertices = context_.mesh.vertex_count();
    found.faces = context_.mesh.face_count();
    found.region = static_cast<Index>(inside.size());
    found.fixed = static_cast<Index>(region.fixed.size());
    found.handle = handle_count;
    found.free = *found.region - *found.fixed - handle_count - static_cast<Index>(resolved_.constraints.size());
    return found;
  }

  const EditFile& edit_;
  const DeformStep& step_;
  const SelectionMesh& context_;
  const Location& location_;
  SelectionResolver selections_;
  std::optional<MirrorMatch> symmetry_;
  std::vector<std::optional<Handle>> twins_;  ///< one per handle of the step
  ResolvedDeform resolved_;
};

}  // namespace

ResolvedDeform resolve_deform(const EditFile& edit, const DeformStep& step, const SelectionMesh& context,
                              const Location& location, const ProducedSets& produced) {
  return DeformResolver(edit, step, context, location, produced).resolve();
}

std::vector<Note> pose_notes(const SymmetryReport& symmetry, std::span<const Handle> handles,
                             std::span<const HandlePose> poses, const Points& rest) {
  std::vector<Note> notes;
  for (const std::size_t h : symmetry.own)
    if (!is_symmetric(poses[h], handles[h], rest, symmetry.reflection))
      notes.push_back(facts::script::AsymmetricPose{.handle = handles[h].name});
  return notes;
}

}  // namespace meshgraft
