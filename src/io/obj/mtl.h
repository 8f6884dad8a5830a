#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace meshgraft::io {

/// A material of a material library (.mtl): the lines after `newmtl NAME`, without line ends.
struct MtlMaterial {
  std::string name;
  std::vector<std::string> lines;
};

std::vector<MtlMaterial> parse_mtl(std::string_view content);

/// Returns the file that a line names after its options, as a part of `line`. Returns an empty text if it
/// names none.
std::string_view texture_in(std::string_view line);

/// Returns the path, relative to `folder`, of the texture that a library in `library_folder` calls `texture`.
/// Absolute paths stay.
std::string texture_from(const std::filesystem::path& folder, const std::filesystem::path& library_folder,
                         std::string_view texture);

}  // namespace meshgraft::io
