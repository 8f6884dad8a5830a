#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshgraft::test {

using Json = nlohmann::ordered_json;

inline void append_bytes(std::string& out, const void* data, std::size_t size) {
  out.append(static_cast<const char*>(data), size);
}

template <class Scalar>
constexpr int gltf_type() {
  if constexpr (std::is_same_v<Scalar, std::int8_t>) return 5120;
  if constexpr (std::is_same_v<Scalar, std::uint8_t>) return 5121;
  if constexpr (std::is_same_v<Scalar, std::int16_t>) return 5122;
  if constexpr (std::is_same_v<Scalar, std::uint16_t>) return 5123;
  if constexpr (std::is_same_v<Scalar, std::uint32_t>) return 5125;
  return 5126;
}

inline std::size_t components_of(const std::string& type) {
  if (type == "MAT4") return 16;
  return type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
}

/// Puts a glTF file together from accessors and JSON.
struct GltfBuilder {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
  std::string buffer;

  int view(std::string_view bytes, int stride = 0) {
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    Json view = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) view["byteStride"] = stride;
    buffer += bytes;
    json["bufferViews"].push_back(view);
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  template <class Scalar>
  int accessor(const std::vector<Scalar>& values, const std::string& type) {
    std::string bytes;
    append_bytes(bytes, values.data(), values.size() * sizeof(Scalar));
    const int v = view(bytes);
    return accessor(v, gltf_type<Scalar>(), values.size() / components_of(type), type);
  }

  int accessor(int view, int component_type, std::size_t count, const std::string& type, int offset = 0) {
    Json accessor = {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}};
    if (offset > 0) accessor["byteOffset"] = offset;
    json["accessors"].push_back(accessor);
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  /// Adds an accessor of positions with their bounds.
  int positions(const std::vector<float>& values) {
    const int index = accessor(values, "VEC3");
    std::vector<float> low(values.begin(), values.begin() + 3), high = low;
    for (std::size_t i = 0; i < values.size(); ++i) {
      low[i % 3] = std::min(low[i % 3], values[i]);
      high[i % 3] = std::max(high[i % 3], values[i]);
    }
    json["accessors"][static_cast<std::size_t>(index)]["min"] = low;
    json["accessors"][static_cast<std::size_t>(index)]["max"] = high;
    return index;
  }

  Json& add(const char* array, Json value) {
    json[array].push_back(std::move(value));
    return json[array].back();
  }

  /// Adds a node with a mesh of one primitive.
  void show(Json primitive) {
    add("meshes", {{"primitives", Json::array({std::move(primitive)})}});
    add("nodes", {{"mesh", 0}});
  }

  std::string glb(int indent = -1) const {
    Json whole = json;
    whole["buffers"] = Json::array({{{"byteLength", buffer.size()}}});
    std::string text = whole.dump(indent);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string binary = buffer;
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    std::string out = "glTF";
    append_u32(out, 2);
    append_u32(out, 12 + 8 + text.size() + 8 + binary.size());
    append_u32(out, text.size());
    out += "JSON" + text;
    append_u32(out, binary.size());
    out += std::string("BIN\0", 4) + binary;
    return out;
  }

  std::string gltf(const std::string& uri) const {
    Json whole = json;
    whole["buffers"] = Json::array({{{"uri", uri}, {"byteLength", buffer.size()}}});
    return whole.dump(2) + "\n";
  }

  static void append_u32(std::string& out, std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    append_bytes(out, &word, 4);
  }
};

/// A square of four vertices and two triangles, in the plane z = 0.
inline std::vector<float> square_positions() { return {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}; }
inline std::vector<std::uint16_t> square_indices() { return {0, 1, 2, 0, 2, 3}; }

/// The parts of a .glb.
struct GlbParts {
  std::string text, binary;
  Json json;
};

inline std::uint32_t u32_at(const std::string& content, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, content.data() + at, 4);
  return value;
}

inline GlbParts parts_of(const std::string& glb) {
  GlbParts parts;
  const std::size_t json_size = u32_at(glb, 12);
  parts.text = glb.substr(20, json_size);
  parts.json = Json::parse(parts.text);
  if (glb.size() > 20 + json_size) parts.binary = glb.substr(28 + json_size, u32_at(glb, 20 + json_size));
  return parts;
}

/// Returns the bytes of an accessor's tightly packed elements (no sparse parts).
inline std::string accessor_bytes(const GlbParts& parts, std::size_t index) {
  const Json& accessor = parts.json["accessors"][index];
  if (!accessor.contains("bufferView")) return {};
  const Json& view = parts.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const int type = accessor["componentType"];
  const std::size_t scalar = type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4;
  const std::size_t size = scalar * components_of(accessor["type"]);
  const std::size_t stride = view.value("byteStride", size);
  const std::size_t begin =
      view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
  std::string bytes;
  for (std::size_t e = 0; e < accessor["count"].get<std::size_t>(); ++e)
    bytes += parts.binary.substr(begin + e * stride, size);
  return bytes;
}

inline std::vector<float> accessor_floats(const GlbParts& parts, std::size_t index) {
  const std::string bytes = accessor_bytes(parts, index);
  std::vector<float> values(bytes.size() / 4);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace meshgraft::test
