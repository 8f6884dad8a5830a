#include <algorithm>
#include <system_error>
#include <utility>

#include "edit.h"
#include "gltf/facts.h"

namespace meshgraft::io {

namespace fs = std::filesystem;

namespace {

fs::path whole(const fs::path& path) {
  std::error_code ignored;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(path), ignored);
  return canonical.empty() ? fs::absolute(path) : canonical;
}

fs::path seen_from(const fs::path& folder, const fs::path& file) {
  const fs::path relative = whole(file).lexically_relative(whole(folder / "x").parent_path());
  return relative.empty() ? whole(file) : relative;
}

std::string_view without_padding(std::string_view json) {
  const std::size_t end = json.find_last_not_of(" \t\r\n");
  return end == std::string_view::npos ? json : json.substr(0, end + 1);
}

}  // namespace

/// Puts an edited file into the container that its new name requires.
class GltfPacker {
 public:
  GltfPacker(const GltfEdit& edit, const fs::path& path)
      : edit_(edit),
        document_(edit.document_),
        path_(path),
        json_(edit.json),
        bytes_(edit.bytes()),
        wants_glb_(is_glb_path(path)),
        moved_(whole(document_.path).parent_path() != whole(path).parent_path()),
        in_location_(whole(document_.path) == whole(path)),
        inputs_(edit.inputs) {
    for (const GltfBuffer& buffer : document_.buffers)
      if (buffer.storage == GltfBuffer::Storage::file) inputs_.push_back(buffer.path);
  }

  Written pack() {
    written_.notes = edit_.notes;
    if (wants_glb_ && !document_.is_glb && can_merge())
      merge_buffers();
    else
      for (std::size_t b = 0; b < bytes_.size(); ++b) place_buffer(b);
    if (moved_) follow_images();
    assemble();
    return std::move(written_);
  }

 private:
  bool is_changed(std::size_t b) const { return edit_.changed_[b].has_value(); }

  void place_buffer(std::size_t b) {
    const GltfBuffer& buffer = document_.buffers[b];
    Json& json = json_["buffers"][b];
    switch (buffer.storage) {
      case GltfBuffer::Storage::absent: break;
      case GltfBuffer::Storage::chunk:
        if (!wants_glb_)
          write_beside(b, json);
        else if (is_changed(b) || document_.layout.has_binary)
          binary_ = is_changed(b) ? chunk_bytes(b) : original_chunk();
        break;
      case GltfBuffer::Storage::data_uri:
        if (is_changed(b)) {
          const auto uri = json["uri"].get<std::string>();
          json["uri"] = uri.substr(0, uri.find(',') + 1) + encode_base64(bytes_[b]);
        }
        break;
      case GltfBuffer::Storage::file:
        if (in_location_ && is_changed(b) && is_own(buffer.path))
          written_.companions.push_back({buffer.path, std::string(bytes_[b])});
        else if (is_changed(b) || moved_)
          write_beside(b, json);
        break;
    }
  }

  /// Returns whether the buffer belongs to this file alone. A buffer with another name or in another folder may
  /// serve other files.
  bool is_own(const fs::path& buffer) const {
    fs::path own = path_;
    return buffer.lexically_normal() == own.replace_extension(".bin").lexically_normal();
  }

  std::string original_chunk() const {
    return document_.content.substr(document_.layout.binary_begin, document_.layout.binary_size);
  }

  /// Returns the new bytes of the chunk. A chunk may be longer than its buffer; its remaining bytes are kept.
  std::string chunk_bytes(std::size_t b) const {
    std::string chunk(bytes_[b]);
    const std::string original = original_chunk();
    if (chunk.size() == document_.buffers[b].size) chunk += original.substr(chunk.size());
    return chunk;
  }

  void write_beside(std::size_t b, Json& json) {
    const fs::path file = free_buffer_path(path_, inputs_, taken_);
    taken_.push_back(file);
    json["uri"] = uri_of_path(file.filename());
    written_.companions.push_back({file, std::string(bytes_[b])});
  }

  /// Returns whether all buffers can move into one chunk. Absent data cannot, nor can data that an extension
  /// may refer to.
  bool can_merge() const {
    const auto is_there = [](const GltfBuffer& buffer) {
      return buffer.storage != GltfBuffer::Storage::absent;
    };
    if (document_.buffers.empty() || !std::ranges::all_of(document_.buffers, is_there)) return false;
    const auto views = json_.find("bufferViews");
    return views == json_.end() ||
           std::ranges::none_of(*views, [](const Json& view) { return view.contains("extensions"); });
  }

  void merge_buffers() {
    std::string chunk;
    std::vector<std::size_t> begin;
    for (const std::string_view bytes : bytes_) {
      chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
      begin.push_back(chunk.size());
      chunk += bytes;
    }
    if (bytes_.size() > 1) {
      for (Json& view : json_["bufferViews"]) {
        const auto b = view["buffer"].get<std::size_t>();
        if (b == 0) continue;
        view["buffer"] = 0;
        view["byteOffset"] = view.value("byteOffset", std::size_t{0}) + begin[b];
      }
      const Json first = json_["buffers"][0];
      json_["buffers"] = Json::array({first});
    }
    json_["buffers"][0].erase("uri");
    json_["buffers"][0]["byteLength"] = chunk.size();
    binary_ = std::move(chunk);
  }

  /// Adapts the URIs of the images to the new folder. The images are not copied.
  void follow_images() {
    const auto images = json_.find("images");
    if (images == json_.end()) return;
    bool any = false;
    for (std::size_t i = 0; i < images->size(); ++i) {
      Json& image = (*images)[i];
      if (!image.is_object() || !image.contains("uri") || !image["uri"].is_string()) continue;
      const auto uri = image["uri"].get<std::string>();
      if (has_scheme(uri) || uri.starts_with("/")) continue;
      const fs::path file = document_.path.parent_path() / path_of_uri(uri, edit_.view());
      image["uri"] = uri_of_path(seen_from(path_.parent_path(), file));
      any = true;
    }
    if (any) written_.notes.push_back(facts::gltf::ImagesStay{.file = document_.path.filename()});
  }

  void assemble() {
    if (document_.content.empty()) {
      written_.content = wants_glb_ ? compose_glb(json_.dump(), binary_, {}) : json_.dump(2) + "\n";
      return;
    }
    std::string text = patch_json_text(document_.json_text(), document_.json, json_);
    if (!wants_glb_) {
      written_.content = document_.is_glb ? std::string(without_padding(text)) + "\n" : std::move(text);
      return;
    }
    const bool is_same = document_.is_glb && text == document_.json_text() && binary_is_unchanged();
    if (is_same)
      written_.content = document_.content;
    else
      written_.content = compose_glb(text == document_.json_text() ? text : without_padding(text), binary_,
                                     document_.binary_rest());
  }

  bool binary_is_unchanged() const {
    return std::ranges::none_of(edit_.changed_, [](const auto& changed) { return changed.has_value(); });
  }

  const GltfEdit& edit_;
  const GltfDocument& document_;
  fs::path path_;
  Json json_;
  GltfBytes bytes_;
  bool wants_glb_;
  bool moved_;
  bool in_location_;
  std::vector<fs::path> inputs_, taken_;
  std::optional<std::string> binary_;
  Written written_;
};

Written GltfEdit::finish(const fs::path& path) const { return GltfPacker(*this, path).pack(); }

}  // namespace meshgraft::io
