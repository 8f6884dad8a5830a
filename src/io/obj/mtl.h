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

/// The file that a line names, after its options; a part of `line`, empty where it names none.
std::string_view texture_in(std::string_view line);

/// The path of a texture from `folder`, where a library in `library_folder` calls it `texture`. Absolute paths
/// stay.
std::string texture_from(const std::filesystem::path& folder, const std::filesystem::path& library_folder,
                         std::string_view texture);

}  // namespace meshgraft::io
