#include "demands.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "core/sparse_checks.h"
#include "gltf/facts.h"

namespace meshgraft::io {

namespace {

constexpr Index corners_per_check = 1 << 18;

/// Returns whether two values are equal. 0 equals -0, and NaN equals NaN.
bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool agree(const GltfChanges& a, const GltfChanges& b) {
  return std::ranges::equal(a, b, [](const auto& x, const auto& y) {
    return x.first == y.first && nearly_equal(x.second, y.second);
  });
}

bool agree(const GltfDemands& a, const GltfDemands& b) {
  return std::ranges::equal(a, b, [](const GltfDemand& x, const GltfDemand& y) {
    return x.accessor == y.accessor && x.channel.semantic == y.channel.semantic && agree(x.changes, y.changes);
  });
}

bool all_met(const GltfDemands& demands) { return std::ranges::all_of(demands, &GltfDemand::is_met); }

class DemandCollector {
 public:
  DemandCollector(const GltfDocument& document, const Mesh& mesh, const Context& context)
      : document_(document),
        mesh_(mesh),
        context_(context),
        name_(document.name()),
        root_(document.json, "", name_),
        bytes_(document.bytes()) {}

  GltfDemands collect(const GltfInstance& instance) {
    instance_ = &instance;
    GltfDemands demands;
    for (const GltfElementMap& map : instance.maps) demands.push_back(of_positions(map));
    for (const GltfPart& part : instance.parts) {
      const Json& attributes =
          document_.json["meshes"][instance.mesh]["primitives"][part.primitive]["attributes"];
      for (const auto& member : attributes.items()) {
        const auto channel = channel_of(member.key());
        if (channel && !channel->attribute.empty())
          add_corners(demands, *channel, member.value().get<std::size_t>(), part);
      }
    }
    if (instance.placement.flattens() && !all_met(demands)) {
      const Location file = Location::file(name_);
      const Location location = instance.node ? (file / "nodes")[*instance.node] : file;
      throw Error(facts::gltf::NodeFlattens{}, location);
    }
    return demands;
  }

  std::size_t disagreeing_corners() const { return disagreeing_corners_; }

 private:
  GltfDemand of_positions(const GltfElementMap& map) const {
    GltfDemand demand{*channel_of("POSITION"), map.accessor, Flags(map.vertex.size(), false), {}};
    const GltfAccessor accessor = resolve_accessor(root_, map.accessor, bytes_);
    SparseChecks check(context_);
    for (std::size_t e = 0; e < map.vertex.size(); ++e) {
      check();
      if (map.vertex[e] < 0) continue;
      demand.is_used[e] = true;
      require(demand, e, accessor, mesh_.positions.data() + 3 * std::ptrdiff_t{map.vertex[e]}, 3);
    }
    return demand;
  }

  /// Records the wanted value if it differs from the value that the reader derived from this element.
  void require(GltfDemand& demand, std::size_t element, const GltfAccessor& accessor, const double* wanted,
               std::size_t components) const {
    const GltfValue local = load_value(accessor, element, bytes_);
    const GltfValue shown = instance_->placement.to_mesh(demand.channel.kind, local);
    bool differs = false;
    GltfValue value = shown;
    for (std::size_t k = 0; k < std::min(components, accessor.components); ++k) {
      if (demand.channel.kind != GltfChannel::Kind::position && std::isnan(wanted[k])) return;
      differs = differs || !is_same(wanted[k], shown[k]);
      value[k] = wanted[k];
    }
    if (differs) demand.changes.emplace(element, instance_->placement.to_file(demand.channel.kind, value));
  }

  void add_corners(GltfDemands& demands, const GltfChannel& channel, std::size_t accessor_index,
                   const GltfPart& part) {
    const Attribute* attribute = mesh_.find_attribute(Domain::corner, channel.attribute);
    const bool of_corners = attribute != nullptr;
    if (!of_corners) attribute = mesh_.find_attribute(Domain::vertex, channel.attribute);
    if (attribute == nullptr) return;
    const auto components = static_cast<std::size_t>(attribute->components);
    const auto count = static_cast<std::size_t>(of_corners ? mesh_.faces.corner_count() : mesh_.vertex_count());
    const GltfAccessor accessor = resolve_accessor(root_, accessor_index, bytes_);
    if (attribute->values.size() != count * components || components < accessor.components) return;
    GltfDemand& demand = demand_of(demands, channel, accessor_index, accessor.count);
    for (Index c = part.first_corner; c < part.first_corner + part.corner_count; ++c) {
      if (c % corners_per_check == 0) context_.throw_if_stopped();
      const std::uint32_t element = document_.corner_elements[c];
      if (element == no_element || element >= accessor.count) continue;
      const Index row = of_corners ? c : mesh_.faces.corners()[c];
      const double* wanted = attribute->values.data() + static_cast<std::size_t>(row) * components;
      if (demand.is_used[element]) {
        if (of_corners) count_disagreement(demand, element, accessor, wanted);
        continue;
      }
      demand.is_used[element] = true;
      require(demand, element, accessor, wanted, components);
    }
  }

  /// Counts corners that want another value than the first corner of their element. The file has one value
  /// per element.
  void count_disagreement(const GltfDemand& demand, std::size_t element, const GltfAccessor& accessor,
                          const double* wanted) {
    GltfDemand other{demand.channel, demand.accessor, {}, {}};
    require(other, element, accessor, wanted, accessor.components);
    const auto first = demand.changes.find(element);
    const bool same =
        first == demand.changes.end()
            ? other.changes.empty()
            : !other.changes.empty() && nearly_equal(first->second, other.changes.begin()->second);
    if (!same) ++disagreeing_corners_;
  }

  static GltfDemand& demand_of(GltfDemands& demands, const GltfChannel& channel, std::size_t accessor,
                               std::size_t count) {
    const auto known = std::ranges::find_if(demands, [&](const GltfDemand& demand) {
      return demand.accessor == accessor && demand.channel.semantic == channel.semantic;
    });
    if (known != demands.end()) return *known;
    demands.push_back({channel, accessor, Flags(count, false), {}});
    return demands.back();
  }

  const GltfDocument& document_;
  const Mesh& mesh_;
  const Context& context_;
  const std::string name_;
  JsonView root_;
  GltfBytes bytes_;
  const GltfInstance* instance_ = nullptr;
  std::size_t disagreeing_corners_ = 0;
};

/// Counts the nodes that refer to each mesh, whether they are shown or not.
std::vector<std::size_t> count_users(const Json& json) {
  std::vector<std::size_t> users(json.contains("meshes") ? json["meshes"].size() : 0, 0);
  if (!json.contains("nodes")) return users;
  for (const Json& node : json["nodes"]) {
    const auto mesh = node.find("mesh");
    if (mesh == node.end() || !mesh->is_number_unsigned()) continue;
    if (const auto m = mesh->get<std::size_t>(); m < users.size()) ++users[m];
  }
  return users;
}

}  // namespace

bool nearly_equal(const GltfValue& a, const GltfValue& b) {
  double largest = 0;
  for (const double x : a) largest = std::max(largest, std::abs(x));
  const double tolerance = 4 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (!is_same(a[k], b[k]) && !(std::abs(a[k] - b[k]) <= tolerance)) return false;
  return true;
}

std::vector<GltfDemands> demands_of(const GltfDocument& document, const Mesh& mesh, std::vector<Note>& notes,
                                    const Context& context) {
  DemandCollector collector(document, mesh, context);
  std::vector<GltfDemands> demands;
  for (const GltfInstance& instance : document.instances) demands.push_back(collector.collect(instance));
  if (const std::size_t count = collector.disagreeing_corners(); count > 0)
    notes.push_back(facts::gltf::CornersDisagree{.count = count});
  return demands;
}

std::vector<GltfTarget> part_instances(GltfEdit& edit, const GltfDocument& document,
                                       const std::vector<GltfDemands>& demands) {
  std::vector<GltfTarget> targets;
  const std::vector<std::size_t> user_count = count_users(document.json);
  std::vector<std::vector<std::size_t>> shown(user_count.size());
  for (std::size_t i = 0; i < document.instances.size(); ++i) shown[document.instances[i].mesh].push_back(i);
  for (std::size_t mesh = 0; mesh < shown.size(); ++mesh) {
    const std::vector<std::size_t>& users = shown[mesh];
    // Nodes that are not edited or not shown keep the mesh.
    bool is_taken = user_count[mesh] > users.size() ||
                    std::ranges::any_of(users, [&](std::size_t i) { return all_met(demands[i]); });
    std::vector<GltfTarget> of_mesh;  // one per distinct set of demands
    for (const std::size_t i : users) {
      if (all_met(demands[i])) continue;
      auto like = std::ranges::find_if(
          of_mesh, [&](const GltfTarget& target) { return agree(demands[target.instance], demands[i]); });
      if (like == of_mesh.end()) {
        const std::size_t own = is_taken ? edit.append("meshes", Json(edit.json["meshes"][mesh])) : mesh;
        is_taken = true;
        of_mesh.push_back({own, i});
        like = std::prev(of_mesh.end());
      }
      if (like->mesh != mesh) edit.json["nodes"][document.instances[i].node.value()]["mesh"] = like->mesh;
    }
    targets.insert(targets.end(), of_mesh.begin(), of_mesh.end());
  }
  return targets;
}

}  // namespace meshgraft::io
