#include <cmath>
#include <utility>

#include <meshgraft/core/error.h>

#include "document.h"
#include "gltf/facts.h"

namespace meshgraft::io {

namespace {

Eigen::VectorXd numbers(const JsonView& array, std::size_t count) {
  if (array.size() != count)
    array.fail(
        facts::gltf::WrongSize{.what = facts::gltf::Quantity::numbers, .given = array.size(), .needed = count});
  Eigen::VectorXd values(static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < count; ++k) values[static_cast<Eigen::Index>(k)] = array.at(k).number();
  return values;
}

Eigen::Affine3d local_transform(const JsonView& node) {
  Eigen::Affine3d local = Eigen::Affine3d::Identity();
  if (const auto matrix = node.find("matrix")) {
    const Eigen::VectorXd values = numbers(*matrix, 16);
    local.matrix() = Eigen::Map<const Eigen::Matrix4d>(values.data());  // column-major, as in the file
    local.makeAffine();
    return local;
  }
  if (const auto translation = node.find("translation")) local.translate(numbers(*translation, 3).head<3>());
  if (const auto rotation = node.find("rotation")) {
    const Eigen::VectorXd q = numbers(*rotation, 4);
    const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
    if (turn.norm() > 0) local.rotate(turn.normalized());
  }
  if (const auto scale = node.find("scale")) local.scale(numbers(*scale, 3).head<3>());
  return local;
}

bool is_skinned(const JsonView& root, const JsonView& node, std::size_t mesh) {
  if (!node.find("skin")) return false;
  const JsonView primitives = root.at("meshes").at(mesh).at("primitives");
  for (std::size_t p = 0; p < primitives.size(); ++p)
    if (primitives.at(p).at("attributes").find("JOINTS_0")) return true;
  return false;
}

std::vector<std::size_t> children_of(const JsonView& owner, const char* key, std::size_t node_count) {
  std::vector<std::size_t> children;
  const auto list = owner.find(key);
  if (!list) return children;
  for (std::size_t i = 0; i < list->size(); ++i) children.push_back(list->at(i).index(node_count, "nodes"));
  return children;
}

std::vector<std::size_t> nodes_without_parent(const JsonView& root, std::size_t node_count) {
  Flags has_parent(node_count, false);
  for (std::size_t n = 0; n < node_count; ++n)
    for (const std::size_t child : children_of(root.at("nodes").at(n), "children", node_count))
      has_parent[child] = true;
  std::vector<std::size_t> roots;
  for (std::size_t n = 0; n < node_count; ++n)
    if (!has_parent[n]) roots.push_back(n);
  return roots;
}

std::vector<std::size_t> root_nodes(const JsonView& root, std::size_t node_count) {
  const std::size_t scenes = root.count("scenes");
  if (scenes == 0) return nodes_without_parent(root, node_count);
  const auto chosen = root.find("scene");
  const std::size_t scene = chosen ? chosen->index(scenes, "scenes") : 0;
  return children_of(root.at("scenes").at(scene), "nodes", node_count);
}

Eigen::Vector3d unit(const Eigen::Vector3d& vector) {
  const double length = vector.stableNorm();
  return length > 0 && std::isfinite(length) ? Eigen::Vector3d(vector / length) : vector;
}

}  // namespace

std::vector<GltfInstance> instances_of(const JsonView& root) {
  std::vector<GltfInstance> instances;
  const std::size_t mesh_count = root.count("meshes");
  const std::size_t node_count = root.count("nodes");
  if (node_count == 0) {
    for (std::size_t m = 0; m < mesh_count; ++m) instances.push_back({std::nullopt, m, {}, {}, {}});
    return instances;
  }
  struct Visit {
    std::size_t node;
    Eigen::Affine3d parent;
  };
  std::vector<Visit> open;  // explicit stack: nodes may be nested deeper than recursion allows
  Flags seen(node_count, false);
  const auto push = [&](const std::vector<std::size_t>& nodes, const Eigen::Affine3d& parent) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) open.push_back({*node, parent});
  };
  push(root_nodes(root, node_count), Eigen::Affine3d::Identity());
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const JsonView node = root.at("nodes").at(visit.node);
    if (seen[visit.node]) node.fail(facts::gltf::NodeReachedTwice{});
    seen[visit.node] = true;
    const Eigen::Affine3d world = visit.parent * local_transform(node);
    if (const auto reference = node.find("mesh")) {
      const std::size_t mesh = reference->index(mesh_count, "meshes");
      // The joints of a skin place the mesh. glTF ignores the transform of its node.
      const GltfPlacement placement = is_skinned(root, node, mesh) ? GltfPlacement() : GltfPlacement(world);
      instances.push_back({visit.node, mesh, placement, {}, {}});
    }
    push(children_of(node, "children", node_count), world);
  }
  return instances;
}

bool has_triangles(const Json& primitive) {
  const auto mode = primitive.find("mode");
  return mode == primitive.end() || *mode == 4 || *mode == 5 || *mode == 6;
}

GltfPlacement::GltfPlacement(const Eigen::Affine3d& world) : world_(world) {
  is_identity_ = world.matrix() == Eigen::Matrix4d::Identity();
  const Eigen::Matrix3d& linear = world_.linear();
  const double determinant = linear.determinant();
  mirrors_ = determinant < 0;
  flattens_ = !(std::abs(determinant) > 1e-14 * std::pow(linear.norm(), 3));
  if (!flattens_) inverse_ = world_.inverse();
}

GltfValue GltfPlacement::to_mesh(GltfChannel::Kind kind, const GltfValue& value) const {
  if (kind == GltfChannel::Kind::uv) return {value[0], 1 - value[1], 0, 0};
  if (is_identity_ || kind == GltfChannel::Kind::plain) return value;
  const Eigen::Vector3d local(value[0], value[1], value[2]);
  if (kind == GltfChannel::Kind::position) {
    const Eigen::Vector3d p = world_ * local;
    return {p[0], p[1], p[2], 0};
  }
  if (kind == GltfChannel::Kind::normal) {
    const Eigen::Vector3d n = flattens_ ? local : unit(inverse_.linear().transpose() * local);
    return {n[0], n[1], n[2], 0};
  }
  const Eigen::Vector3d t = unit(world_.linear() * local);
  return {t[0], t[1], t[2], mirrors_ ? -value[3] : value[3]};
}

GltfValue GltfPlacement::to_file(GltfChannel::Kind kind, const GltfValue& value) const {
  if (kind == GltfChannel::Kind::uv) return {value[0], 1 - value[1], 0, 0};
  if (is_identity_ || kind == GltfChannel::Kind::plain) return value;
  const Eigen::Vector3d shown(value[0], value[1], value[2]);
  if (kind == GltfChannel::Kind::position) {
    const Eigen::Vector3d p = inverse_ * shown;
    return {p[0], p[1], p[2], 0};
  }
  if (kind == GltfChannel::Kind::normal) {
    const Eigen::Vector3d n = unit(world_.linear().transpose() * shown);
    return {n[0], n[1], n[2], 0};
  }
  const Eigen::Vector3d t = unit(inverse_.linear() * shown);
  return {t[0], t[1], t[2], mirrors_ ? -value[3] : value[3]};
}

}  // namespace meshgraft::io
