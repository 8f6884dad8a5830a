#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/memory_budget.h"
#include "json.h"

namespace meshgraft::io {

bool has_glb_signature(std::string_view content);

/// The locations of the chunks in the bytes of a .glb.
struct GlbLayout {
  std::size_t json_begin = 0, json_size = 0;
  bool has_binary = false;
  std::size_t binary_begin = 0, binary_size = 0;  ///< BIN chunk, padding included
  std::size_t rest_begin = 0;                     ///< first byte of the chunks that glTF does not define
};

/// Locates the chunks. Throws Error(input) naming the byte if the file is too short or too long for its
/// header, or if a chunk's length does not fit (gltf.wrong_length). Throws it also for another version than 2
/// and for a first chunk that is not JSON.
GlbLayout parse_glb(std::string_view content, const std::string& file);

/// Composes a .glb of these chunks, padded to 4 bytes. `rest` is copied behind them. Throws Error(input)
/// beyond 4 GiB.
std::string compose_glb(std::string_view json, std::optional<std::string_view> binary, std::string_view rest);

/// The bytes of one of a glTF file's buffers, and their source.
struct GltfBuffer {
  enum class Storage {
    chunk,     ///< in the .glb itself
    data_uri,  ///< in the JSON
    file,      ///< in a file beside it
    absent,    ///< nowhere: a fallback that compressed data replaces
  };
  Storage storage = Storage::absent;
  std::shared_ptr<const std::string>
      own;                          ///< the bytes, unless they lie in the .glb; shared by buffers of one file
  std::size_t begin = 0, size = 0;  ///< first byte in the .glb (for `chunk`), and byte count
  std::filesystem::path path;       ///< of the file (for `file`)
};

/// Reads all buffers of a file, and a file that several buffers name once. `layout` is default-constructed for
/// a .gltf. Throws Error(io) for files that cannot be read, Error(memory) for more bytes than the budget has
/// left, and Error(input) for buffers shorter than their byteLength.
std::vector<GltfBuffer> load_buffers(const JsonView& root, const GlbLayout& layout, MemoryBudget& budget);

/// Converts a relative URI to a path by decoding percent signs. Throws Error(input) for network addresses.
std::filesystem::path path_of_uri(const std::string& uri, const JsonView& location);
std::string uri_of_path(const std::filesystem::path& path);
bool is_data_uri(std::string_view uri);
bool has_scheme(std::string_view uri);

std::string encode_base64(std::string_view bytes);

/// Returns nothing if `text` is not base64.
std::optional<std::string> decode_base64(std::string_view text);

/// Returns a free file name beside `path` for a buffer. An existing file is replaced only if the glTF file at
/// `path`, which will be replaced itself, refers to it. Files in `inputs` and `taken` are never replaced.
std::filesystem::path free_buffer_path(const std::filesystem::path& path,
                                       const std::vector<std::filesystem::path>& inputs,
                                       const std::vector<std::filesystem::path>& taken);

bool is_glb_path(const std::filesystem::path& path);

/// Returns the existing buffer and image files that a glTF file refers to.
std::vector<std::filesystem::path> files_of_gltf(const std::filesystem::path& path);

}  // namespace meshgraft::io
