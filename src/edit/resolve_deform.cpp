#include <meshgraft/edit/resolve_deform.h>

#include <algorithm>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "selection_resolver.h"

namespace meshgraft {

namespace {

// Who holds each vertex of the region, so that no vertex gets two roles.
class Roles {
 public:
  Roles(Index vertex_count, const std::vector<Index>& region)
      : owner_(static_cast<std::size_t>(vertex_count), outside) {
    for (const Index v : region) owner_[v] = nobody;
  }

  bool is_free(Index v) const { return owner_[v] == nobody; }
  bool is_inside(Index v) const { return owner_[v] != outside; }

  void take(Index vertex, int owner) { owner_[vertex] = owner; }

  /// Makes `vertices` the handle's, or says what is in the way.
  void take_all(const std::vector<Index>& vertices, int handle, const std::vector<HandleSpec>& handles,
                const std::string& place) {
    const auto beyond = std::count_if(vertices.begin(), vertices.end(), [&](Index v) { return !is_inside(v); });
    if (beyond > 0)
      throw Error(ErrorCode::input,
                  fmt::format("{} of the handle's {} vertices lie outside the region", beyond, vertices.size()),
                  place, "Enlarge the region, or 'intersect' the handle with it.");
    for (const Index v : vertices) {
      if (owner_[v] == handle) throw Error(ErrorCode::input, fmt::format("vertex {} is given twice", v), place);
      if (owner_[v] != nobody)
        throw Error(ErrorCode::input, fmt::format("vertex {} is already {}", v, holder(owner_[v], handles)),
                    place, "Take it out of one of the two with 'minus'.");
      owner_[v] = handle;
    }
  }

  std::string holder_of(Index vertex, const std::vector<HandleSpec>& handles) const {
    return holder(owner_[vertex], handles);
  }

  static constexpr int outside = -4, nobody = -3, fixed = -2, constrained = -1;

 private:
  static std::string holder(int owner, const std::vector<HandleSpec>& handles) {
    if (owner == fixed) return "fixed";
    if (owner == constrained) return "constrained by itself";
    return fmt::format("part of the handle '{}'", handles[static_cast<std::size_t>(owner)].name);
  }

  std::vector<int> owner_;
};

std::vector<Index> every_vertex(Index count) {
  std::vector<Index> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

bool ends_share_edge(const std::vector<Index>& curve, const IndexLists& rings) {
  if (curve.size() < 3) return false;
  const auto ring = rings[curve.front()];
  return std::binary_search(ring.begin(), ring.end(), curve.back());
}

Handle resolve_handle(const HandleSpec& spec, SelectionResolver& selections, const SelectionContext& context,
                      const std::string& place) {
  Handle handle;
  handle.name = spec.name;
  handle.shape = spec.shape;
  handle.constrain_position = spec.constrain_position;
  handle.constrain_transform = spec.constrain_transform;
  const std::string select = place + ".select";
  const bool is_curve = spec.shape == HandleShape::curve;
  handle.vertices =
      is_curve ? selections.ordered(spec.select, select) : selections.vertices(spec.select, select);
  if (handle.vertices.empty())
    throw Error(ErrorCode::input, fmt::format("the handle '{}' has no vertices", spec.name), select,
                "Look at the mesh's bounding box with 'meshgraft info' and make the selection larger.");
  for (const Index v : handle.vertices)
    if (!context.mesh.positions.row(v).allFinite())
      throw Error(ErrorCode::input,
                  fmt::format("the handle '{}' has vertex {}, a coordinate of which is not a finite number",
                              spec.name, v),
                  select, "Leave it out, or remove it first: 'meshgraft repair' does.");
  if (spec.shape == HandleShape::vertex && handle.vertices.size() != 1)
    throw Error(ErrorCode::input,
                fmt::format("a handle of shape 'vertex' has one vertex, not {}", handle.vertices.size()),
                select, "Use the shape 'region', or select with 'nearest'.");
  if (is_curve) handle.closed = spec.closed.value_or(ends_share_edge(handle.vertices, context.rings));
  return handle;
}

HandlePose pose_of_matrix(const Eigen::Matrix4d& matrix) {
  HandlePose pose;
  pose.transform.matrix() = matrix;
  return pose;
}

HandlePose resolve_pose(const PoseSpec& spec, const Handle& handle, const SelectionResolver& selections,
                        const EditFile& edit, const SelectionContext& context, const std::string& place) {
  const Points& rest = context.mesh.positions;
  if (const auto* motion = std::get_if<HandleMotion>(&spec.kind))
    return make_pose(*motion, motion->pivot ? *motion->pivot : handle_pivot(handle, rest, context.rings));
  if (const auto* matrix = std::get_if<Eigen::Matrix4d>(&spec.kind)) return pose_of_matrix(*matrix);
  if (const auto* def = std::get_if<PoseSpec::DefFile>(&spec.kind)) {
    const std::string where = fmt::format("{}.def: {}", place, (edit.base_folder / def->file).string());
    return pose_of_matrix(parse_def(selections.read(def->file, place + ".def"), where));
  }
  HandlePose pose;
  try {
    pose.curve = redraw_curve(handle, rest, std::get<PoseSpec::Redrawn>(spec.kind).polyline);
  } catch (const Error& error) {
    throw error.within(place + ".curve");
  }
  return pose;
}

// Targets and transforms joined per vertex, ascending.
std::vector<VertexConstraint> resolve_constraints(const DeformStep& step, const SelectionContext& context,
                                                  Roles& roles, const std::string& place) {
  const Index vertex_count = context.mesh.vertex_count();
  std::map<Index, VertexConstraint> constraints;
  const auto constraint_of = [&](Index vertex, const std::string& where) -> VertexConstraint& {
    if (vertex >= vertex_count)
      throw Error(ErrorCode::input,
                  fmt::format("vertex {} does not exist; the mesh has {}", vertex, vertex_count), where);
    vertex = context.weld.of(vertex);
    auto [entry, is_new] = constraints.try_emplace(vertex);
    if (is_new) {
      if (!roles.is_inside(vertex))
        throw Error(ErrorCode::input, fmt::format("vertex {} lies outside the region", vertex), where);
      if (!roles.is_free(vertex))
        throw Error(ErrorCode::input,
                    fmt::format("vertex {} is already {}", vertex, roles.holder_of(vertex, step.handles)),
                    where, "Take it out of that selection with 'minus'.");
      roles.take(vertex, Roles::constrained);
      entry->second.vertex = vertex;
    }
    return entry->second;
  };
  for (std::size_t i = 0; i < step.targets.size(); ++i) {
    const std::string where = fmt::format("{}.targets[{}]", place, i);
    VertexConstraint& constraint = constraint_of(step.targets[i].vertex, where);
    if (constraint.position && (context.weld.empty() || *constraint.position != step.targets[i].position))
      throw Error(ErrorCode::input, fmt::format("vertex {} has two targets", constraint.vertex), where);
    constraint.position = step.targets[i].position;
  }
  for (std::size_t i = 0; i < step.transforms.size(); ++i) {
    const std::string where = fmt::format("{}.transforms[{}]", place, i);
    VertexConstraint& constraint = constraint_of(step.transforms[i].vertex, where);
    if (constraint.transform && (context.weld.empty() || *constraint.transform != step.transforms[i].matrix))
      throw Error(ErrorCode::input, fmt::format("vertex {} has two transforms", constraint.vertex), where);
    constraint.transform = step.transforms[i].matrix;
  }
  std::vector<VertexConstraint> list;
  for (const auto& [vertex, constraint] : constraints) list.push_back(constraint);
  return list;
}

void require_counts(const ExpectedCounts& expected, const ExpectedCounts& found, const std::string& place) {
  const auto require = [&](const std::optional<Index>& count, const std::optional<Index>& actual,
                           std::string_view name) {
    if (count && *count != *actual)
      throw Error(ErrorCode::input, fmt::format("{} expected, {} found", *count, *actual),
                  fmt::format("{}.counts.{}", place, name), "Is it the right mesh?");
  };
  require(expected.vertices, found.vertices, "vertices");
  require(expected.faces, found.faces, "faces");
  require(expected.region, found.region, "region");
  require(expected.fixed, found.fixed, "fixed");
  require(expected.handle, found.handle, "handle");
  require(expected.free, found.free, "free");
}

std::vector<Anchor> resolve_anchors(const DeformStep& step, SelectionResolver& selections, const Roles& roles,
                                    const std::string& place) {
  std::map<Index, Anchor> anchors;
  for (std::size_t i = 0; i < step.anchors.size(); ++i) {
    const std::string where = fmt::format("{}.anchors[{}].select", place, i);
    for (const Index v : selections.vertices(step.anchors[i].select, where)) {
      if (!roles.is_free(v)) continue;  // what is held or never moves needs no anchor
      if (!anchors.try_emplace(v, Anchor{v, step.anchors[i].weight, {}}).second)
        throw Error(ErrorCode::input, fmt::format("vertex {} is anchored twice", v), where);
    }
  }
  std::vector<Anchor> list;
  for (const auto& [vertex, anchor] : anchors) list.push_back(anchor);
  return list;
}

}  // namespace

ResolvedDeform resolve_deform(const EditFile& edit, const DeformStep& step, const SelectionContext& context,
                              const std::string& place, const ProducedSets& produced) {
  const Mesh& mesh = context.mesh;
  ExpectedCounts found;
  found.vertices = mesh.vertex_count();
  found.faces = mesh.face_count();
  ExpectedCounts of_the_mesh;
  of_the_mesh.vertices = step.counts.vertices;
  of_the_mesh.faces = step.counts.faces;
  require_counts(of_the_mesh, found, place);

  SelectionResolver selections(edit, context, produced);
  ResolvedDeform resolved;
  Region& region = resolved.region;
  const bool all = std::holds_alternative<Selection::All>(step.region.kind);
  std::vector<Index> inside =
      all ? every_vertex(mesh.vertex_count()) : selections.vertices(step.region, place + ".region");
  if (inside.empty()) throw Error(ErrorCode::input, "the region has no vertices", place + ".region");
  Roles roles(mesh.vertex_count(), inside);

  std::vector<Index> rim;
  if (step.fixed) {
    for (const Index v : selections.vertices(*step.fixed, place + ".fixed"))
      if (roles.is_inside(v)) region.fixed.push_back(v);
    for (const Index v : region.fixed) roles.take(v, Roles::fixed);
  } else if (!all) {
    const auto whole_region = std::make_shared<const Selection>(Selection::Indices{inside});
    rim = resolve(Selection(Selection::Rim{whole_region, 2}), context, place + ".region");
  }

  Index handle_count = 0;
  for (std::size_t i = 0; i < step.handles.size(); ++i) {
    const std::string handle_place = fmt::format("{}.handles[{}]", place, i);
    Handle handle = resolve_handle(step.handles[i], selections, context, handle_place);
    roles.take_all(handle.vertices, static_cast<int>(i), step.handles, handle_place + ".select");
    handle_count += static_cast<Index>(handle.vertices.size());
    resolved.poses.push_back(
        resolve_pose(step.handles[i].pose, handle, selections, edit, context, handle_place + ".pose"));
    region.handles.push_back(std::move(handle));
  }
  resolved.constraints = resolve_constraints(step, context, roles, place);

  // A rim that nobody asked for gives way to handles and targets.
  for (const Index v : rim) {
    if (!roles.is_free(v)) continue;
    region.fixed.push_back(v);
    roles.take(v, Roles::fixed);
  }
  region.anchors = resolve_anchors(step, selections, roles, place);

  found.region = static_cast<Index>(inside.size());
  found.fixed = static_cast<Index>(region.fixed.size());
  found.handle = handle_count;
  found.free = *found.region - *found.fixed - handle_count - static_cast<Index>(resolved.constraints.size());
  require_counts(step.counts, found, place);

  region.whole = all || *found.region == mesh.vertex_count();
  if (!region.whole) region.vertices = std::move(inside);
  return resolved;
}

}  // namespace meshgraft
