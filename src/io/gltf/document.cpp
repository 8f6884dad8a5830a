#include "document.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "gltf/facts.h"

namespace meshgraft::io {

namespace {

bool is_numbered(const std::string& semantic, std::string_view prefix) {
  if (!semantic.starts_with(prefix) || semantic.size() == prefix.size() || semantic.size() > prefix.size() + 3)
    return false;
  return semantic.find_first_not_of("0123456789", prefix.size()) == std::string::npos;
}

/// Returns "uv" for TEXCOORD_0, "uv_1" for TEXCOORD_1, and so on.
std::string numbered(const std::string& semantic, std::string_view prefix, const std::string& name) {
  const std::string number = semantic.substr(prefix.size());
  return number == "0" ? name : name + "_" + number;
}

}  // namespace

std::optional<GltfChannel> channel_of(const std::string& semantic) {
  using Kind = GltfChannel::Kind;
  if (semantic == "POSITION") return GltfChannel{Kind::position, semantic, ""};
  if (semantic == "NORMAL") return GltfChannel{Kind::normal, semantic, "normal"};
  if (semantic == "TANGENT") return GltfChannel{Kind::tangent, semantic, "tangent"};
  if (is_numbered(semantic, "TEXCOORD_"))
    return GltfChannel{Kind::uv, semantic, numbered(semantic, "TEXCOORD_", "uv")};
  if (is_numbered(semantic, "COLOR_"))
    return GltfChannel{Kind::plain, semantic, numbered(semantic, "COLOR_", "colour")};
  return std::nullopt;
}

std::vector<std::string> gltf_labels(const JsonView& root, const char* array, const std::string& kind) {
  std::vector<std::string> labels;
  std::set<std::string> taken;
  std::map<std::string, int> next_number;
  for (std::size_t i = 0; i < root.count(array); ++i) {
    const auto name = root.at(array).at(i).find("name");
    const std::string plain = name && name->json().is_string() && !name->text().empty()
                                  ? name->text()
                                  : fmt::format("{}_{}", kind, i);
    std::string label = plain;
    int& number = next_number.try_emplace(plain, 2).first->second;
    while (!taken.insert(label).second) label = fmt::format("{}_{}", plain, number++);
    labels.push_back(std::move(label));
  }
  return labels;
}

std::string_view GltfDocument::json_text() const {
  return is_glb ? std::string_view(content).substr(layout.json_begin, layout.json_size)
                : std::string_view(content);
}

std::string_view GltfDocument::binary_rest() const {
  return is_glb ? std::string_view(content).substr(layout.rest_begin) : std::string_view();
}

GltfBytes GltfDocument::bytes() const {
  GltfBytes bytes;
  for (const GltfBuffer& buffer : buffers) {
    if (buffer.storage == GltfBuffer::Storage::absent)
      bytes.emplace_back();
    else if (buffer.storage == GltfBuffer::Storage::chunk)
      bytes.push_back(std::string_view(content).substr(buffer.begin, buffer.size));
    else
      bytes.push_back(std::string_view(*buffer.own).substr(0, buffer.size));
  }
  return bytes;
}

std::vector<Note> GltfDocument::beside_the_mesh() const {
  std::vector<Note> notes;
  using facts::gltf::Content;
  const auto add = [&](Content content, std::size_t count) {
    if (count > 0)
      notes.push_back(facts::gltf::LeftOut{.file = path.filename(), .content = content, .count = count});
  };
  const auto count_of = [&](const char* key) {
    const auto array = json.find(key);
    return array != json.end() && array->is_array() ? array->size() : 0;
  };
  std::size_t morph_targets = 0;
  std::size_t other_primitives = 0;
  if (count_of("meshes") > 0) {
    for (const Json& mesh : json["meshes"]) {
      if (!mesh.contains("primitives")) continue;
      std::size_t targets = 0;
      for (const Json& primitive : mesh["primitives"]) {
        if (!has_triangles(primitive)) ++other_primitives;
        if (const auto found = primitive.find("targets"); found != primitive.end())
          targets = std::max(targets, found->size());
      }
      morph_targets += targets;
    }
  }
  add(Content::materials, count_of("materials"));
  add(Content::skins, count_of("skins"));
  add(Content::morph_targets, morph_targets);
  add(Content::animations, count_of("animations"));
  add(Content::cameras, count_of("cameras"));
  add(Content::points_and_lines, other_primitives);
  return notes;
}

}  // namespace meshgraft::io
