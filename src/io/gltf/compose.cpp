#include "compose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>
#include <meshgraft/mesh/normals.h>

#include "accessor.h"
#include "edit.h"
#include "gltf/facts.h"
#include "io/binary_value.h"
#include "io/facts.h"
#include "io/file_document.h"
#include "io/number_text.h"
#include "io/obj/materials.h"
#include "io/unwritten.h"
#include "mesh/join.h"
#include "morph.h"
#include "split.h"

namespace meshgraft::io {

namespace {

/// A glTF attribute to be written, and the mesh attribute that it comes from.
struct NewChannel {
  GltfChannel channel;
  const Attribute* attribute = nullptr;
  std::size_t components = 3;
  double scale = 1;  ///< factor from the mesh's values to the file's
};

GltfDocument blank_document(const std::filesystem::path& path) {
  GltfDocument document;
  document.path = path;
  document.is_glb = true;
  document.buffers.push_back({GltfBuffer::Storage::chunk, {}, 0, 0, {}});
  document.json = {{"asset", {{"version", "2.0"}, {"generator", "meshgraft " MESHGRAFT_VERSION}}},
                   {"scene", 0},
                   {"scenes", Json::array({Json::object()})},
                   {"buffers", Json::array({{{"byteLength", 0}}})}};
  return document;
}

const Attribute* of_vertices_or_corners(const Mesh& mesh, const std::string& name) {
  for (const Domain domain : {Domain::corner, Domain::vertex}) {
    const Attribute* attribute = mesh.find_attribute(domain, name);
    const auto count =
        static_cast<std::size_t>(domain == Domain::corner ? mesh.faces.corner_count() : mesh.vertex_count());
    if (attribute != nullptr &&
        attribute->values.size() == count * static_cast<std::size_t>(attribute->components))
      return attribute;
  }
  return nullptr;
}

/// Returns the channels to be written. glTF numbers TEXCOORD_0, TEXCOORD_1, … without gaps, whatever numbers
/// uv, uv_1, … have.
std::vector<NewChannel> channels_of(const Mesh& mesh) {
  using Kind = GltfChannel::Kind;
  std::vector<NewChannel> channels;
  const auto numbered = [&](const std::string& name, const std::string& semantic, Kind kind, int least,
                            int most) {
    int made = 0;
    for (int k = 0; k < 10; ++k) {
      const std::string attribute_name = k == 0 ? name : fmt::format("{}_{}", name, k);
      const Attribute* attribute = of_vertices_or_corners(mesh, attribute_name);
      if (attribute == nullptr || attribute->components < least || attribute->components > most) continue;
      NewChannel channel{{kind, fmt::format("{}_{}", semantic, made++), attribute_name},
                         attribute,
                         static_cast<std::size_t>(attribute->components),
                         1.0};
      if (kind == Kind::plain && attribute->type == ScalarType::uint8) channel.scale = 1.0 / 255;
      if (kind == Kind::plain && attribute->type == ScalarType::uint16) channel.scale = 1.0 / 65535;
      channels.push_back(std::move(channel));
    }
  };
  const auto add = [&](Kind kind, const char* semantic, const char* name, int components) {
    const Attribute* attribute = of_vertices_or_corners(mesh, name);
    if (attribute == nullptr || attribute->components != components) return;
    channels.push_back({{kind, semantic, name}, attribute, static_cast<std::size_t>(components), 1.0});
  };
  add(Kind::normal, "NORMAL", "normal", 3);
  if (!channels.empty()) add(Kind::tangent, "TANGENT", "tangent", 4);
  numbered("uv", "TEXCOORD", Kind::uv, 2, 2);
  numbered("colour", "COLOR", Kind::plain, 3, 4);
  return channels;
}

class GltfComposer {
 public:
  GltfComposer(const Mesh& mesh, const std::filesystem::path& path, const Mesh* moved, std::string target_name,
               const Context& context)
      : mesh_(mesh),
        path_(path),
        moved_(moved),
        target_name_(std::move(target_name)),
        context_(context),
        document_(blank_document(path)),
        edit_(document_),
        channels_(channels_of(mesh)) {
    for (const FileDocument* document : documents_of(mesh))
      if (const auto* gltf = dynamic_cast<const GltfDocument*>(document))
        for (const GltfBuffer& buffer : gltf->buffers)
          if (!buffer.path.empty()) edit_.inputs.push_back(buffer.path);
  }

  Written compose() {
    const SplitMesh split = split_mesh(mesh_);
    write_materials();
    for (const SplitObject& object : split.objects) write_object(object);
    if (split.objects.empty()) edit_.json.erase("buffers");
    note_losses(split);
    return edit_.finish(path_);
  }

 private:
  void write_materials() {
    const Attribute* material = mesh_.find_attribute(Domain::face, "material");
    if (material == nullptr) return;
    for (const std::string& label : material->labels) edit_.append("materials", {{"name", label}});
  }

  void write_object(const SplitObject& object) {
    const bool is_moved = moved_ != nullptr && moves(object);
    Json mesh = Json::object();
    const std::string name = object_name(object.object);
    if (!name.empty()) mesh["name"] = name;
    mesh["primitives"] = Json::array();
    for (const SplitPrimitive& primitive : object.primitives)
      mesh["primitives"].push_back(write_primitive(primitive, is_moved));
    if (is_moved) {
      mesh["weights"] = Json::array({0.0});
      name_target(edit_, mesh, 0, target_name_);
    }
    Json node = Json::object();
    if (!name.empty()) node["name"] = name;
    node["mesh"] = edit_.append("meshes", std::move(mesh));
    const std::size_t index = edit_.append("nodes", std::move(node));
    edit_.json["scenes"][0]["nodes"].push_back(index);
  }

  std::string object_name(double value) const {
    const Attribute* object = mesh_.find_attribute(Domain::face, "object");
    if (object == nullptr || !(value >= 0)) return {};
    const auto k = static_cast<std::size_t>(value);
    return k < object->labels.size() ? object->labels[k] : fmt::format("object_{}", k);
  }

  bool moves(const SplitObject& object) const {
    return std::ranges::any_of(object.primitives, [&](const SplitPrimitive& primitive) {
      return std::ranges::any_of(primitive.vertex, [&](Index v) {
        return (mesh_.positions.row(v).array() != moved_->positions.row(v).array()).any();
      });
    });
  }

  Json write_primitive(const SplitPrimitive& primitive, bool is_moved) {
    context_.throw_if_stopped();
    Json attributes = Json::object();
    Json target = Json::object();
    attributes["POSITION"] = write_positions(primitive);
    if (is_moved) target["POSITION"] = write_position_deltas(primitive);
    for (const NewChannel& channel : channels_) {
      if (!has_values(channel, primitive)) continue;
      attributes[channel.channel.semantic] = write_channel(channel, primitive);
      const bool is_direction = channel.channel.kind == GltfChannel::Kind::normal ||
                                channel.channel.kind == GltfChannel::Kind::tangent;
      if (is_moved && is_direction)
        target[channel.channel.semantic] = write_direction_deltas(channel, primitive);
    }
    Json json = {{"attributes", std::move(attributes)}, {"indices", write_indices(primitive)}};
    if (primitive.material >= 0 && primitive.material < static_cast<double>(edit_.view().count("materials")))
      json["material"] = static_cast<std::size_t>(primitive.material);
    if (is_moved) json["targets"] = Json::array({std::move(target)});
    return json;
  }

  std::size_t add_accessor(const std::string& bytes, std::size_t count, std::size_t components) {
    constexpr int array_buffer = 34962;
    const std::size_t view = edit_.append_view(bytes, 0, array_buffer);
    return edit_.append("accessors", {{"bufferView", view},
                                      {"componentType", component_type_float},
                                      {"count", count},
                                      {"type", fmt::format("VEC{}", components)}});
  }

  std::size_t write_positions(const SplitPrimitive& primitive) {
    std::string bytes;
    for (const Index v : primitive.vertex) {
      for (int axis = 0; axis < 3; ++axis) {
        const double x = mesh_.positions(v, axis);
        if (!std::isfinite(static_cast<float>(x)))
          throw Error(facts::gltf::CoordinateBeyondFloats{}, Location::place(fmt::format("vertex {}", v)));
        append_float(bytes, x);
      }
    }
    const std::size_t index = add_accessor(bytes, primitive.vertex.size(), 3);
    Json& accessor = edit_.json["accessors"][index];
    set_bounds(accessor, edit_.accessor(index), edit_.bytes());
    return index;
  }

  std::size_t write_position_deltas(const SplitPrimitive& primitive) {
    GltfChanges deltas;
    for (std::size_t i = 0; i < primitive.vertex.size(); ++i) {
      const Index v = primitive.vertex[i];
      GltfValue delta{};
      for (int axis = 0; axis < 3; ++axis)
        delta[axis] = static_cast<float>(moved_->positions(v, axis) -
                                         static_cast<double>(static_cast<float>(mesh_.positions(v, axis))));
      const bool stays = mesh_.positions.row(v) == moved_->positions.row(v);
      if (!stays && delta != GltfValue{}) deltas.emplace(i, delta);
    }
    return append_deltas(edit_, primitive.vertex.size(), deltas, true);
  }

  static const double* values_at(const Attribute& attribute, const SplitPrimitive& primitive, std::size_t i) {
    const Index row = attribute.domain == Domain::corner ? primitive.corner[i] : primitive.vertex[i];
    return attribute.values.data() +
           static_cast<std::size_t>(row) * static_cast<std::size_t>(attribute.components);
  }

  static bool has_values(const NewChannel& channel, const SplitPrimitive& primitive) {
    bool any = false;
    for (std::size_t i = 0; i < primitive.vertex.size(); ++i) {
      const bool has = !std::isnan(*values_at(*channel.attribute, primitive, i));
      if (!has && channel.channel.kind == GltfChannel::Kind::tangent) return false;
      any = any || has;
    }
    return any;
  }

  std::size_t write_channel(const NewChannel& channel, const SplitPrimitive& primitive) {
    std::string bytes;
    for (std::size_t i = 0; i < primitive.vertex.size(); ++i) {
      const GltfValue value = file_value(channel, *channel.attribute, primitive, i);
      for (std::size_t k = 0; k < channel.components; ++k) append_float(bytes, value[k]);
    }
    return add_accessor(bytes, primitive.vertex.size(), channel.components);
  }

  /// Returns the value of a vertex in the file. If others have a value, it needs one, too: missing colours
  /// become white. Directions get unit length.
  GltfValue file_value(const NewChannel& channel, const Attribute& attribute, const SplitPrimitive& primitive,
                       std::size_t i) {
    const double* at = values_at(attribute, primitive, i);
    GltfValue value{};
    std::copy_n(at, channel.components, value.begin());
    const bool is_missing = std::isnan(value[0]);
    switch (channel.channel.kind) {
      case GltfChannel::Kind::normal: return unit(is_missing ? vertex_normal(primitive.vertex[i]) : value);
      case GltfChannel::Kind::tangent: {
        const double w = value[3];
        value = unit(value);
        value[3] = w < 0 ? -1 : 1;
        return value;
      }
      case GltfChannel::Kind::uv:
        return is_missing ? GltfValue{} : GltfPlacement().to_file(GltfChannel::Kind::uv, value);
      default: break;
    }
    for (std::size_t k = 0; k < channel.components; ++k)
      value[k] = std::isnan(value[k]) ? 1 : std::clamp(value[k] * channel.scale, 0.0, 1.0);
    return value;
  }

  GltfValue vertex_normal(Index vertex) {
    if (vertex_normals_.rows() == 0) vertex_normals_ = vertex_normals(mesh_);
    return {vertex_normals_(vertex, 0), vertex_normals_(vertex, 1), vertex_normals_(vertex, 2), 0};
  }

  static GltfValue unit(const GltfValue& value) {
    const double length = std::hypot(value[0], value[1], value[2]);
    if (!(length > 0) || !std::isfinite(length)) return {0, 0, 1, 0};
    return {value[0] / length, value[1] / length, value[2] / length, 0};
  }

  std::size_t write_direction_deltas(const NewChannel& channel, const SplitPrimitive& primitive) {
    const Attribute* moved = moved_->find_attribute(channel.attribute->domain, channel.attribute->name);
    GltfChanges deltas;
    for (std::size_t i = 0; i < primitive.vertex.size(); ++i) {
      const GltfValue before = file_value(channel, *channel.attribute, primitive, i);
      const GltfValue after = file_value(channel, *moved, primitive, i);
      GltfValue delta{};
      for (std::size_t k = 0; k < 3; ++k)
        delta[k] = static_cast<float>(after[k] - static_cast<double>(static_cast<float>(before[k])));
      if (before != after && delta != GltfValue{}) deltas.emplace(i, delta);
    }
    return append_deltas(edit_, primitive.vertex.size(), deltas, false);
  }

  /// Writes the indices with 16 bits if possible. 65535 is not a valid index of 16 bits, because it restarts
  /// strips.
  std::size_t write_indices(const SplitPrimitive& primitive) {
    const bool is_short = primitive.vertex.size() < 65536;
    const ScalarType type = is_short ? ScalarType::uint16 : ScalarType::uint32;
    std::string bytes(primitive.indices.size() * size_of(type), '\0');
    for (std::size_t i = 0; i < primitive.indices.size(); ++i)
      store_binary(bytes.data() + i * size_of(type), primitive.indices[i], type, swap_little_endian);
    constexpr int element_array_buffer = 34963;
    const std::size_t view = edit_.append_view(bytes, 0, element_array_buffer);
    return edit_.append("accessors", {{"bufferView", view},
                                      {"componentType", is_short ? 5123 : 5125},
                                      {"count", primitive.indices.size()},
                                      {"type", "SCALAR"}});
  }

  void note_losses(const SplitMesh& split) {
    if (split.polygons > 0)
      edit_.notes.push_back(facts::io::PolygonsSplit{.format = "glTF", .count = split.polygons});
    if (split.lonely_vertices > 0)
      edit_.notes.push_back(facts::io::VerticesLeftOut{.format = "glTF", .count = split.lonely_vertices});
    note_coarse_coordinates(mesh_, "glTF", edit_.notes);
    for (Note& note : left_out_notes(mesh_)) edit_.notes.push_back(std::move(note));
    for (const std::string& library : material_libraries_of(mesh_))
      edit_.notes.push_back(facts::io::MaterialsNamedOnly{.format = "glTF", .library = library});
    note_attributes();
  }

  void note_attributes() {
    std::vector<std::string> names;
    for (const Attribute& attribute : mesh_.attributes) {
      const bool is_label =
          attribute.domain == Domain::face && (attribute.name == "object" || attribute.name == "material");
      const bool is_channel = std::ranges::any_of(
          channels_, [&](const NewChannel& channel) { return channel.attribute == &attribute; });
      const bool is_empty =
          std::ranges::all_of(attribute.values, [](double value) { return std::isnan(value); });
      if (!is_label && !is_channel && !is_empty) names.push_back(attribute.name);
    }
    if (!names.empty())
      edit_.notes.push_back(facts::io::AttributesLeftOut{.format = "glTF", .attributes = names});
  }

  const Mesh& mesh_;
  const std::filesystem::path& path_;
  const Mesh* moved_;  // the edited mesh, with the same faces; null without a morph target
  std::string target_name_;
  const Context& context_;
  GltfDocument document_;
  GltfEdit edit_;
  std::vector<NewChannel> channels_;
  Points vertex_normals_{0, 3};
};

}  // namespace

Written compose_gltf(const Mesh& mesh, const std::filesystem::path& path,
                     const std::optional<MorphTarget>& morph_target, const Context& context) {
  if (!morph_target) return GltfComposer(mesh, path, nullptr, {}, context).compose();
  Mesh rest = mesh;
  rest.positions = morph_target->rest;
  update_normals(rest, mesh.positions);
  return GltfComposer(rest, path, &mesh, morph_target->name, context).compose();
}

}  // namespace meshgraft::io
