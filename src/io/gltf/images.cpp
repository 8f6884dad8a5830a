#include "images.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
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

/// The images of a file. The bytes of each are held once.
class Images {
 public:
  Images(const JsonView& root, const GltfDocument& document) : root_(root), document_(document) {}

  /// Fills `texture` with the image of a material. Returns whether it has one.
  bool find(const JsonView& material, MaterialTexture& texture) {
    const std::optional<std::size_t> number = number_of(material);
    if (!number) return false;
    const JsonView image = root_.at("images").at(*number);
    const auto view = image.find("bufferView");
    const std::string uri = view ? std::string() : image.at("uri").text();
    if (view || is_data_uri(uri)) {
      const auto [known, is_new] = bytes_.try_emplace(*number);
      if (is_new) known->second = embedded(view ? bytes_of_view(root_, document_, *view) : decoded(uri));
      texture.bytes = known->second;
      return texture.bytes != nullptr;
    }
    if (has_scheme(uri)) return false;
    texture.file = document_.path.parent_path() / path_of_uri(uri, image);
    std::error_code ignored;
    return std::filesystem::is_regular_file(texture.file, ignored);
  }

 private:
  std::optional<std::size_t> number_of(const JsonView& material) const {
    const auto surface = material.find("pbrMetallicRoughness");
    const auto colour = surface ? surface->find("baseColorTexture") : std::nullopt;
    if (!colour) return std::nullopt;
    const std::size_t number = colour->at("index").index(root_.count("textures"), "textures");
    return root_.at("textures").at(number).at("source").index(root_.count("images"), "images");
  }

  static std::string decoded(const std::string& uri) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == std::string::npos) return {};
    return decode_base64(std::string_view(uri).substr(comma + 8)).value_or("");
  }

  static std::shared_ptr<const std::string> embedded(std::string bytes) {
    return bytes.empty() ? nullptr : std::make_shared<const std::string>(std::move(bytes));
  }

  const JsonView& root_;
  const GltfDocument& document_;
  std::map<std::size_t, std::shared_ptr<const std::string>> bytes_;  // by the number of the image
};

}  // namespace

std::vector<MaterialTexture> textures_of(const GltfDocument& document) {
  std::vector<MaterialTexture> textures;
  const std::string name = document.name();
  const JsonView root(document.json, "", name);
  const std::vector<std::string> labels = gltf_labels(root, "materials", "material");
  Images images(root, document);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    MaterialTexture texture{labels[i], {}, {}};
    try {
      if (images.find(root.at("materials").at(i), texture)) textures.push_back(std::move(texture));
    } catch (const Error&) {
      continue;  // the mesh is shown without a malformed texture
    }
  }
  return textures;
}

}  // namespace meshgraft::io
