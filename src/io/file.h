#pragma once

#include <filesystem>
#include <string_view>

namespace meshgraft::io {

/// What `write_file` does where `path` exists already.
enum class Existing { replace, refuse };

/// Writes `content` to `path` so that a reader sees either the old file or the whole new one: a temporary
/// file beside it, flushed to the disk, then renamed (or linked, for `refuse`). A replaced file keeps its
/// permissions, a symbolic link keeps pointing where it did. Throws Error(io) and leaves nothing behind.
void write_file(const std::filesystem::path& path, std::string_view content, Existing existing);

}  // namespace meshgraft::io
