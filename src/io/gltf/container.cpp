#include "container.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <limits>
#include <map>
#include <system_error>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "core/hex_digit.h"
#include "gltf/facts.h"
#include "io/facts.h"
#include "io/file.h"

namespace meshgraft::io {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view glb_magic = "glTF";
constexpr std::uint32_t json_chunk = 0x4E4F534A;
constexpr std::uint32_t binary_chunk = 0x004E4942;
constexpr std::size_t header_size = 12;
constexpr std::size_t chunk_header_size = 8;

std::uint32_t load_u32(std::string_view content, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(content[at + k]);
  return value;
}

void append_u32(std::string& out, std::size_t value) {
  for (int k = 0; k < 4; ++k) out += static_cast<char>(value >> (8 * k) & 0xFF);
}

[[noreturn]] void fail_at(const Fact& fact, const std::string& file, std::size_t byte) {
  throw Error(fact, Location::file(file) / Location::place(fmt::format("byte {}", byte)));
}

std::size_t padding(std::size_t size) { return (4 - size % 4) % 4; }

void append_chunk(std::string& out, std::string_view bytes, std::uint32_t type, char pad) {
  append_u32(out, bytes.size() + padding(bytes.size()));
  append_u32(out, type);
  out += bytes;
  out.append(padding(bytes.size()), pad);
}

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

int base64_digit(char c) {
  const std::size_t digit = c == '-' ? 62 : c == '_' ? 63 : alphabet.find(c);
  return digit == std::string_view::npos ? -1 : static_cast<int>(digit);
}

std::string decode_data_uri(const std::string& uri, const JsonView& location) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64"))
    location.fail(facts::gltf::DataUriNotBase64{});
  std::optional<std::string> bytes = decode_base64(std::string_view(uri).substr(comma + 1));
  if (!bytes) location.fail(facts::gltf::DataUriNotBase64{});
  return std::move(*bytes);
}

using SharedBytes = std::shared_ptr<const std::string>;

/// Loads the buffers of a file.
class BufferLoader {
 public:
  BufferLoader(const GlbLayout& layout, MemoryBudget& budget) : layout_(layout), budget_(budget) {}

  GltfBuffer load(const JsonView& buffer, bool is_first) {
    GltfBuffer loaded;
    const std::uint64_t size = buffer.at("byteLength").whole();
    std::size_t available = 0;
    if (const auto uri = buffer.find("uri")) {
      if (uri->json().is_string() && is_data_uri(uri->json().get_ref<const std::string&>())) {
        loaded.storage = GltfBuffer::Storage::data_uri;
        loaded.own = decode(uri->json().get_ref<const std::string&>(), *uri);
      } else {
        const std::string text = uri->text();
        loaded.storage = GltfBuffer::Storage::file;
        loaded.path = fs::path(buffer.file()).parent_path() / path_of_uri(text, *uri);
        loaded.own = read_beside(loaded.path, *uri);
      }
      available = loaded.own->size();
    } else if (is_first && layout_.has_binary) {
      loaded.storage = GltfBuffer::Storage::chunk;
      loaded.begin = layout_.binary_begin;
      available = layout_.binary_size;
    } else {
      return loaded;  // an error only if an accessor needs this buffer
    }
    if (size > available)
      buffer.fail(facts::gltf::WrongLength{
          .what = facts::gltf::Block::buffer, .declared = size, .available = available});
    loaded.size = static_cast<std::size_t>(size);
    return loaded;
  }

 private:
  SharedBytes decode(const std::string& uri, const JsonView& location) {
    at(location, [&] { budget_.charge(uri.size() / 4 * 3); });
    return std::make_shared<const std::string>(decode_data_uri(uri, location));
  }

  SharedBytes read_beside(const fs::path& path, const JsonView& location) {
    SharedBytes& bytes = files_[path.lexically_normal()];
    if (!bytes) at(location, [&] { bytes = std::make_shared<const std::string>(read_file(path, budget_)); });
    return bytes;
  }

  template <class Work>
  static void at(const JsonView& location, const Work& work) {
    try {
      work();
    } catch (const Error& error) {
      throw error.within(Location::file(location.file()) / Location::field(location.path()));
    }
  }

  const GlbLayout& layout_;
  MemoryBudget& budget_;
  std::map<fs::path, SharedBytes> files_;
};

}  // namespace

bool has_glb_signature(std::string_view content) { return content.starts_with(glb_magic); }

GlbLayout parse_glb(std::string_view content, const std::string& file) {
  const auto wrong_length = [&](facts::gltf::Block what, std::size_t declared, std::size_t found,
                                std::size_t byte) {
    fail_at(facts::gltf::WrongLength{.what = what, .declared = declared, .available = found}, file, byte);
  };
  if (constexpr std::size_t least = header_size + chunk_header_size; content.size() < least)
    fail_at(facts::io::TruncatedHeader{.format = "GLB", .needed = least, .size = content.size()}, file,
            content.size());
  if (const std::uint32_t version = load_u32(content, 4); version != 2)
    throw Error(facts::gltf::UnknownVersion{.version = std::to_string(version)}, Location::file(file));
  if (const std::uint32_t length = load_u32(content, 8); length != content.size())
    wrong_length(facts::gltf::Block::file, length, content.size(), 8);
  GlbLayout layout;
  layout.rest_begin = content.size();
  std::size_t at = header_size;
  for (int chunk = 0; at < content.size() && chunk < 2; ++chunk) {
    const std::size_t left = content.size() - at;
    if (left < chunk_header_size) wrong_length(facts::gltf::Block::chunk_header, chunk_header_size, left, at);
    const std::size_t size = load_u32(content, at);
    const std::uint32_t type = load_u32(content, at + 4);
    if (size > left - chunk_header_size)
      wrong_length(facts::gltf::Block::chunk, size, left - chunk_header_size, at);
    const std::size_t begin = at + chunk_header_size;
    if (chunk == 0) {
      if (type != json_chunk) fail_at(facts::gltf::FirstChunkNotJson{}, file, at + 4);
      layout.json_begin = begin;
      layout.json_size = size;
    } else if (type == binary_chunk) {
      layout.has_binary = true;
      layout.binary_begin = begin;
      layout.binary_size = size;
    } else {
      break;
    }
    at = begin + size;
    layout.rest_begin = at;
  }
  return layout;
}

std::string compose_glb(std::string_view json, std::optional<std::string_view> binary, std::string_view rest) {
  std::size_t size = header_size + chunk_header_size + json.size() + padding(json.size()) + rest.size();
  if (binary) size += chunk_header_size + binary->size() + padding(binary->size());
  if (size > std::numeric_limits<std::uint32_t>::max()) throw Error(facts::gltf::GlbTooLarge{.bytes = size});
  std::string out(glb_magic);
  out.reserve(size);
  append_u32(out, 2);
  append_u32(out, size);
  append_chunk(out, json, json_chunk, ' ');
  if (binary) append_chunk(out, *binary, binary_chunk, '\0');
  out += rest;
  return out;
}

std::vector<GltfBuffer> load_buffers(const JsonView& root, const GlbLayout& layout, MemoryBudget& budget) {
  BufferLoader loader(layout, budget);
  std::vector<GltfBuffer> buffers;
  for (std::size_t i = 0; i < root.count("buffers"); ++i)
    buffers.push_back(loader.load(root.at("buffers").at(i), i == 0));
  return buffers;
}

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon < 2) return false;
  return std::ranges::all_of(uri.substr(0, colon), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '.';
  });
}

fs::path path_of_uri(const std::string& uri, const JsonView& location) {
  const auto not_local = facts::gltf::UriNotLocal{.uri = uri.substr(0, 80)};
  if (has_scheme(uri) || uri.starts_with("//")) location.fail(not_local);
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0) {
      path += static_cast<char>(16 * hex_digit(uri[i + 1]) + hex_digit(uri[i + 2]));
      i += 2;
    } else {
      path += uri[i];
    }
  }
  if (path.empty() || path.find('\0') != std::string::npos) location.fail(not_local);
  return path;
}

std::string uri_of_path(const fs::path& path) {
  std::string uri;
  for (const char c : path.generic_string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte >= 0x80 || std::isalnum(byte) != 0 ||
                       std::string_view("-._~/!$&'()*+,;=@").find(c) != std::string_view::npos;
    if (plain)
      uri += c;
    else
      uri += fmt::format("%{:02X}", byte);
  }
  return uri;
}

std::string encode_base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? alphabet[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::optional<std::string> decode_base64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    const int digit = base64_digit(c);
    if (digit < 0) return std::nullopt;
    group = (group << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFF;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(group >> bits & 0xFF);
  }
  if (bits == 6) return std::nullopt;
  return bytes;
}

bool is_glb_path(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".glb";
}

fs::path free_buffer_path(const fs::path& path, const std::vector<fs::path>& inputs,
                          const std::vector<fs::path>& taken) {
  const auto is_one_of = [](const fs::path& file, const std::vector<fs::path>& list) {
    std::error_code missing;
    return std::ranges::any_of(list, [&](const fs::path& other) {
      return file == other || (fs::equivalent(file, other, missing) && !missing);
    });
  };
  std::vector<fs::path> replaceable;
  try {
    replaceable = files_of_gltf(path);
  } catch (const Error&) {
    replaceable.clear();  // the malformed file at `path` refers to no known file
  }
  for (int k = 1;; ++k) {
    fs::path candidate = path;
    candidate.replace_filename(path.stem().string() + (k == 1 ? "" : fmt::format("_{}", k)) + ".bin");
    if (is_one_of(candidate, taken) || is_one_of(candidate, inputs)) continue;
    if (!fs::exists(fs::symlink_status(candidate)) || is_one_of(candidate, replaceable)) return candidate;
  }
}

std::vector<fs::path> files_of_gltf(const fs::path& path) {
  std::vector<fs::path> files;
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return files;
  const std::string content = read_file(path);
  const std::string name = path.string();
  GlbLayout layout;
  if (has_glb_signature(content)) layout = parse_glb(content, name);
  const std::string_view text = has_glb_signature(content)
                                    ? std::string_view(content).substr(layout.json_begin, layout.json_size)
                                    : std::string_view(content);
  const Json json = parse_gltf_json(text, name);
  const JsonView root(json, "", name);
  for (const char* array : {"buffers", "images"}) {
    for (std::size_t i = 0; i < root.count(array); ++i) {
      const auto uri = root.at(array).at(i).find("uri");
      if (!uri || has_scheme(uri->text())) continue;
      const fs::path file = path.parent_path() / path_of_uri(uri->text(), *uri);
      if (fs::exists(file, ignored)) files.push_back(file);
    }
  }
  return files;
}

}  // namespace meshgraft::io
