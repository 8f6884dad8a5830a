#include "mtl.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "io/number_text.h"

namespace meshgraft::io {

namespace {

constexpr std::string_view blanks = " \t\v\f";

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::string_view first_word(std::string_view text) { return text.substr(0, text.find_first_of(blanks)); }

std::string lower_case(std::string_view word) {
  std::string lower(word);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

bool names_a_texture(std::string_view keyword) {
  const std::string word = lower_case(keyword);
  constexpr std::array<std::string_view, 5> others = {"bump", "disp", "decal", "refl", "norm"};
  return (word.starts_with("map_") && word != "map_aat") || std::ranges::find(others, word) != others.end();
}

bool is_number(std::string_view word) {
  return parse_number(word, ScalarType::float64).fault == NumberFault::none;
}

// Returns the least and the largest number of words that follow an option of a texture.
std::pair<int, int> arguments_of(std::string_view option) {
  if (option == "-o" || option == "-s" || option == "-t") return {1, 3};
  if (option == "-mm") return {2, 2};
  return {1, 1};
}

}  // namespace

std::vector<MtlMaterial> parse_mtl(std::string_view content) {
  std::vector<MtlMaterial> materials;
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);  // byte order mark
  while (!content.empty()) {
    const std::size_t end = std::min(content.find_first_of("\r\n"), content.size());
    const std::string_view line = without_blanks(content.substr(0, end));
    content.remove_prefix(std::min(end + 1, content.size()));
    if (line.empty() || line[0] == '#') continue;
    const std::string_view keyword = first_word(line);
    if (keyword == "newmtl")
      materials.push_back({std::string(without_blanks(line.substr(keyword.size()))), {}});
    else if (!materials.empty())
      materials.back().lines.emplace_back(line);
  }
  return materials;
}

std::string_view texture_in(std::string_view line) {
  line = without_blanks(line);
  const std::string_view keyword = first_word(line);
  if (!names_a_texture(keyword)) return {};
  std::string_view rest = without_blanks(line.substr(keyword.size()));
  const auto skip_word = [&] { rest = without_blanks(rest.substr(first_word(rest).size())); };
  while (rest.starts_with('-')) {
    const auto [least, most] = arguments_of(first_word(rest));
    skip_word();
    for (int k = 0; k < most && (k < least || is_number(first_word(rest))); ++k) skip_word();
  }
  return rest;
}

std::string texture_from(const std::filesystem::path& folder, const std::filesystem::path& library_folder,
                         std::string_view texture) {
  std::string unix_like(texture);
  std::ranges::replace(unix_like, '\\', '/');
  const bool has_drive = unix_like.size() > 1 && unix_like[1] == ':';
  if (unix_like.starts_with('/') || has_drive) return std::string(texture);
  namespace fs = std::filesystem;
  // An empty path is the current folder.
  const auto whole = [](const fs::path& of) {
    return fs::weakly_canonical(fs::absolute(of.empty() ? "." : of) / "");
  };
  const fs::path file = (whole(library_folder) / unix_like).lexically_normal();
  const fs::path relative = file.lexically_relative(whole(folder));
  return relative.empty() ? file.generic_string() : relative.generic_string();
}

}  // namespace meshgraft::io
