#include "images.h"

#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <meshgraft/core/error.h>

#include "gltf/facts.h"

namespace meshgraft::io {

namespace {

std::string bytes_of_view(const JsonView& root, const GltfDocument& document, const JsonView& reference) {
  const JsonView view = root.at("bufferViews").at(reference.index(root.count("bufferViews"), "bufferViews"));
  const GltfBytes buffers = document.bytes();
  const std::string_view buffer = buffers.at(view.at("buffer").index(buffers.size(), "buffers"));
  const std::uint64_t begin = view.whole("byteOffset", 0), length = view.at("byteLength").whole();
  if (begin > buffer.size() || length > buffer.size() - begin)
    view.fail(facts::gltf::BeyondBytes{.bytes = buffer.size(), .whole = facts::gltf::Whole::buffer});
  return std::string(buffer.substr(begin, length));
}

// Fills `texture`. Returns whether there is an image.
bool find_image(const JsonView& root, const GltfDocument& document, const JsonView& image,
                MaterialTexture& texture) {
  if (const auto view = image.find("bufferView")) {
    texture.bytes = bytes_of_view(root, document, *view);
    return !texture.bytes.empty();
  }
  const std::string uri = image.at("uri").text();
  if (is_data_uri(uri)) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == std::string::npos) return false;
    texture.bytes = decode_base64(std::string_view(uri).substr(comma + 8)).value_or("");
    return !texture.bytes.empty();
  }
  if (has_scheme(uri)) return false;
  texture.file = document.path.parent_path() / path_of_uri(uri, image);
  std::error_code ignored;
  return std::filesystem::is_regular_file(texture.file, ignored);
}

std::optional<JsonView> image_of(const JsonView& root, const JsonView& material) {
  const auto surface = material.find("pbrMetallicRoughness");
  const auto colour = surface ? surface->find("baseColorTexture") : std::nullopt;
  if (!colour) return std::nullopt;
  const std::size_t number = colour->at("index").index(root.count("textures"), "textures");
  const JsonView texture = root.at("textures").at(number);
  return root.at("images").at(texture.at("source").index(root.count("images"), "images"));
}

}  // namespace

std::vector<MaterialTexture> textures_of(const GltfDocument& document) {
  std::vector<MaterialTexture> textures;
  const std::string name = document.name();
  const JsonView root(document.json, "", name);
  const std::vector<std::string> labels = gltf_labels(root, "materials", "material");
  for (std::size_t i = 0; i < labels.size(); ++i) {
    MaterialTexture texture{labels[i], {}, {}};
    try {
      const auto image = image_of(root, root.at("materials").at(i));
      if (image && find_image(root, document, *image, texture)) textures.push_back(std::move(texture));
    } catch (const Error&) {
      continue;  // the mesh is shown without a malformed texture
    }
  }
  return textures;
}

}  // namespace meshgraft::io
