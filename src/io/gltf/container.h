#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "json.h"

namespace meshgraft::io {

bool has_glb_signature(std::string_view content);

/// Where the parts of a .glb lie in its bytes.
struct GlbLayout {
  std::size_t json_begin = 0, json_size = 0;
  bool has_binary = false;
  std::size_t binary_begin = 0, binary_size = 0;  ///< of the BIN chunk, padding included
  std::size_t rest_begin = 0;                     ///< chunks that glTF does not define
};

/// Throws Error(input) naming the byte: a file that is cut off or goes on, lengths that do not fit, another
/// version, a first chunk that is no JSON.
GlbLayout parse_glb(std::string_view content, const std::string& file);

/// A .glb of these chunks, padded to 4 bytes; `rest` is copied behind them. Throws Error(input) beyond 4 GiB.
std::string compose_glb(std::string_view json, std::optional<std::string_view> binary, std::string_view rest);

/// The bytes of one of a glTF file's buffers, and where they came from.
struct GltfBuffer {
  enum class Storage {
    chunk,     ///< of the .glb itself
    data_uri,  ///< in the JSON
    file,      ///< beside it
    absent,    ///< nowhere: it is a fallback that compressed data makes dispensable
  };
  Storage storage = Storage::absent;
  std::string own;                  ///< bytes, unless they lie in the .glb
  std::size_t begin = 0, size = 0;  ///< of those that do
  std::filesystem::path path;       ///< of a file
};

/// Reads all of a file's buffers; `layout` is the default one for a .gltf. Throws Error(io) for files that
/// cannot be read and Error(input) for buffers shorter than they say.
std::vector<GltfBuffer> load_buffers(const JsonView& root, const GlbLayout& layout);

/// A relative URI as a path: percent signs decoded. Throws Error(input) for addresses in a network.
std::filesystem::path path_of_uri(const std::string& uri, const JsonView& location);
std::string uri_of_path(const std::filesystem::path& path);
bool is_data_uri(std::string_view uri);
bool has_scheme(std::string_view uri);

std::string encode_base64(std::string_view bytes);

/// Empty where `text` is no base64.
std::optional<std::string> decode_base64(std::string_view text);

/// A name beside `path` for a buffer: a file that is in the way is replaced only where the glTF file at `path`,
/// which will be replaced, refers to it, and none of `inputs` and `taken` is it.
std::filesystem::path free_buffer_path(const std::filesystem::path& path,
                                       const std::vector<std::filesystem::path>& inputs,
                                       const std::vector<std::filesystem::path>& taken);

bool is_glb_path(const std::filesystem::path& path);

/// The buffers and images of a glTF file that lie beside it and exist.
std::vector<std::filesystem::path> files_of_gltf(const std::filesystem::path& path);

}  // namespace meshgraft::io
