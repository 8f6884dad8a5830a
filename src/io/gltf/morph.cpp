#include "morph.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "accessor.h"
#include "gltf/facts.h"
#include "io/binary_value.h"
#include "io/number_text.h"

namespace meshgraft::io {

namespace {

template <class Integer>
void append_index(std::string& out, std::size_t value) {
  for (std::size_t k = 0; k < sizeof(Integer); ++k) out += static_cast<char>(value >> (8 * k) & 0xFF);
}

Json sparse_part(GltfEdit& edit, std::size_t count, const GltfChanges& deltas) {
  const bool is_short = count <= 0xFFFF;
  std::string indices;
  std::string values;
  for (const auto& [element, delta] : deltas) {
    if (is_short)
      append_index<std::uint16_t>(indices, element);
    else
      append_index<std::uint32_t>(indices, element);
    for (std::size_t k = 0; k < 3; ++k) append_float(values, delta[k]);
  }
  const std::size_t index_view = edit.append_view(indices);
  const std::size_t value_view = edit.append_view(values);
  return {{"count", deltas.size()},
          {"indices", {{"bufferView", index_view}, {"componentType", is_short ? 5123 : 5125}}},
          {"values", {{"bufferView", value_view}}}};
}

std::size_t dense_part(GltfEdit& edit, std::size_t count, const GltfChanges& deltas) {
  std::string values;
  auto next = deltas.begin();
  for (std::size_t e = 0; e < count; ++e) {
    const bool is_zero = next == deltas.end() || next->first != e;
    for (std::size_t k = 0; k < 3; ++k) append_float(values, is_zero ? 0 : next->second[k]);
    if (!is_zero) ++next;
  }
  return edit.append_view(values, 0, 34962);
}

std::size_t target_count(const Json& mesh) {
  std::size_t count = 0;
  for (const Json& primitive : mesh["primitives"])
    if (const auto targets = primitive.find("targets"); targets != primitive.end() && targets->is_array())
      count = std::max(count, targets->size());
  return count;
}

/// Returns the attributes of a further target. All targets of one primitive must have the same attributes.
std::vector<std::string> semantics_of_targets(const Json& primitive) {
  std::vector<std::string> semantics;
  for (const char* semantic : {"POSITION", "NORMAL", "TANGENT"}) {
    if (!primitive["attributes"].contains(semantic)) continue;
    const auto targets = primitive.find("targets");
    const bool is_first = targets == primitive.end() || targets->empty();
    const bool others_have_it = !is_first && std::ranges::any_of(*targets, [&](const Json& target) {
      return target.contains(semantic);
    });
    if (is_first || others_have_it || semantic == std::string_view("POSITION"))
      semantics.emplace_back(semantic);
  }
  return semantics;
}

class MorphTargetWriter {
 public:
  MorphTargetWriter(GltfEdit& edit, const GltfTarget& target, const GltfDemands& demands)
      : edit_(edit), mesh_index_(target.mesh), demands_(demands) {}

  void write(const std::string& name) {
    const std::size_t earlier = target_count(mesh());
    for (std::size_t p = 0; p < mesh()["primitives"].size(); ++p) add_to_primitive(p);
    if (mesh().contains("weights"))
      mesh()["weights"].push_back(0.0);
    else if (earlier == 0)
      mesh()["weights"] = Json::array({0.0});
    name_target(edit_, mesh(), earlier, name);
    extend_nodes(earlier);
  }

 private:
  Json& mesh() { return edit_.json["meshes"][mesh_index_]; }

  void add_to_primitive(std::size_t p) {
    const Json primitive = mesh()["primitives"][p];
    if (!primitive.contains("attributes") || !primitive["attributes"].contains("POSITION")) return;
    Json target = Json::object();
    for (const std::string& semantic : semantics_of_targets(primitive))
      target[semantic] = deltas_of(semantic, primitive["attributes"][semantic].get<std::size_t>());
    Json& targets = mesh()["primitives"][p]["targets"];
    if (!targets.is_array()) targets = Json::array();
    targets.push_back(std::move(target));
  }

  /// Returns the accessor of the differences. Primitives that share an accessor share its differences.
  std::size_t deltas_of(const std::string& semantic, std::size_t accessor_index) {
    const auto [entry, is_new] = written_.try_emplace({semantic, accessor_index}, 0);
    if (!is_new) return entry->second;
    const GltfAccessor accessor = edit_.accessor(accessor_index);
    const GltfBytes bytes = edit_.bytes();
    GltfChanges deltas;
    for (const GltfDemand& demand : demands_) {
      if (demand.accessor != accessor_index || demand.channel.semantic != semantic) continue;
      for (const auto& [element, value] : demand.changes) {
        const GltfValue base = load_value(accessor, element, bytes);
        GltfValue delta{};
        for (std::size_t k = 0; k < 3; ++k) delta[k] = static_cast<float>(value[k] - base[k]);
        if (delta != GltfValue{}) deltas.emplace(element, delta);
      }
    }
    entry->second = append_deltas(edit_, accessor.count, deltas, semantic == "POSITION");
    return entry->second;
  }

  /// Appends a zero weight for the new target to the nodes and animations that give every target a weight.
  void extend_nodes(std::size_t earlier) {
    if (!edit_.json.contains("nodes")) return;
    std::set<std::size_t> nodes;
    for (std::size_t n = 0; n < edit_.json["nodes"].size(); ++n) {
      Json& node = edit_.json["nodes"][n];
      if (!node.contains("mesh") || node["mesh"] != mesh_index_) continue;
      nodes.insert(n);
      if (node.contains("weights")) node["weights"].push_back(0.0);
    }
    if (earlier == 0 || !edit_.json.contains("animations")) return;
    for (std::size_t a = 0; a < edit_.json["animations"].size(); ++a) {
      const Json channels = edit_.json["animations"][a].value("channels", Json::array());
      for (std::size_t c = 0; c < channels.size(); ++c) {
        const Json target = channels[c].value("target", Json::object());
        if (target.value("path", "") != "weights" || !target.contains("node")) continue;
        if (nodes.contains(target["node"].get<std::size_t>())) extend_channel(a, c, earlier);
      }
    }
  }

  /// Extends an animation channel whose values come in groups of `earlier`. If other channels use the same
  /// sampler, the channel gets its own.
  void extend_channel(std::size_t animation_index, std::size_t channel, std::size_t earlier) {
    // Adding a member to an object moves the other members, so no reference is held across an insertion.
    const Json old = edit_.json["animations"][animation_index];
    Json sampler = old.at("samplers").at(old.at("channels").at(channel).at("sampler").get<std::size_t>());
    const auto output = sampler.at("output").get<std::size_t>();
    const GltfAccessor accessor = edit_.accessor(output);
    Json copy = edit_.json["accessors"][output];
    for (const char* member : {"sparse", "byteOffset", "bufferView"}) copy.erase(member);
    const std::string values = with_zeros(accessor, earlier);
    copy["bufferView"] = edit_.append_view(values);
    copy["count"] = values.size() / accessor.element_size();
    const std::size_t index = edit_.append("accessors", std::move(copy));
    Json& accessor_json = edit_.json["accessors"][index];
    if (accessor_json.contains("min") || accessor_json.contains("max"))
      set_bounds(accessor_json, edit_.accessor(index), edit_.bytes());
    Json& animation = edit_.json["animations"][animation_index];
    const std::size_t number = old.at("channels").at(channel).at("sampler").get<std::size_t>();
    const auto users = std::ranges::count_if(animation["channels"], [&](const Json& other) {
      return other.contains("sampler") && other["sampler"] == number;
    });
    if (users == 1) {
      animation["samplers"][number]["output"] = index;
    } else {
      sampler["output"] = index;
      animation["samplers"].push_back(std::move(sampler));
      animation["channels"][channel]["sampler"] = animation["samplers"].size() - 1;
    }
  }

  /// Returns the values of an accessor, with a zero after each `group` of them.
  std::string with_zeros(const GltfAccessor& accessor, std::size_t group) const {
    const GltfBytes bytes = edit_.bytes();
    const std::size_t size = accessor.element_size();
    std::string values;
    for (std::size_t e = 0; e < accessor.count; ++e) {
      if (const auto at = accessor.address(e))
        values.append(bytes[at->buffer].substr(at->byte, size));
      else
        values.append(size, '\0');
      if ((e + 1) % group == 0) values.append(size, '\0');
    }
    return values;
  }

  GltfEdit& edit_;
  std::size_t mesh_index_;
  const GltfDemands& demands_;
  std::map<std::pair<std::string, std::size_t>, std::size_t> written_;
};

}  // namespace

void require_rest_of_file(const GltfDocument& document, const Mesh& mesh, const MorphTarget& target,
                          const Context& context) {
  Mesh rest;
  rest.positions = target.rest;
  rest.faces = mesh.faces;
  std::vector<Note> ignored;
  for (const GltfDemands& demands : demands_of(document, rest, ignored, context))
    if (!std::ranges::all_of(demands, &GltfDemand::is_met))
      throw Error(facts::gltf::RestNotOfFile{.file = document.name()}, "morph target");
}

void add_morph_target(GltfEdit& edit, const std::vector<GltfTarget>& targets,
                      const std::vector<GltfDemands>& demands, const std::string& name) {
  if (targets.empty()) edit.notes.push_back(facts::gltf::NoMorphTarget{});
  for (const GltfTarget& target : targets)
    MorphTargetWriter(edit, target, demands[target.instance]).write(name);
}

std::size_t append_deltas(GltfEdit& edit, std::size_t count, const GltfChanges& deltas, bool with_bounds) {
  Json accessor = {{"componentType", component_type_float}, {"count", count}, {"type", "VEC3"}};
  const bool is_sparse = deltas.size() < count / 2;
  if (is_sparse && !deltas.empty())
    accessor["sparse"] = sparse_part(edit, count, deltas);
  else if (!is_sparse)
    accessor["bufferView"] = dense_part(edit, count, deltas);
  if (with_bounds) {
    GltfValue low{};
    GltfValue high{};
    const bool all_differ = deltas.size() == count && count > 0;
    if (all_differ) low = high = deltas.begin()->second;
    for (const auto& [element, delta] : deltas) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], delta[k]);
        high[k] = std::max(high[k], delta[k]);
      }
    }
    accessor["min"] = {low[0], low[1], low[2]};
    accessor["max"] = {high[0], high[1], high[2]};
  }
  return edit.append("accessors", std::move(accessor));
}

void name_target(GltfEdit& edit, Json& mesh, std::size_t number, const std::string& name) {
  if (mesh.contains("extras") && !mesh["extras"].is_object()) {
    edit.notes.push_back(facts::gltf::TargetUnnamed{.number = number});
    return;
  }
  Json& names = mesh["extras"]["targetNames"];
  if (!names.is_array()) names = Json::array();
  while (names.size() < number) names.push_back(fmt::format("target_{}", names.size()));
  names.push_back(name);
}

}  // namespace meshgraft::io
