#include "defects.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshgraft::editor {

namespace {

bool matters(const Finding& finding) {
  constexpr std::array<std::string_view, 2> harmless = {"duplicate-vertex", "polygon"};
  return std::find(harmless.begin(), harmless.end(), finding.name) == harmless.end();
}

// Quotes `text` where a shell would not read it as one word.
std::string word(const std::string& text) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:@%";
  if (text.find_first_not_of(plain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// Range that a GPU can show: beyond it, squares of single-precision numbers overflow or vanish.
constexpr double largest_shown = 1e15, smallest_shown = 1e-15;

std::optional<std::string> range_note(const Points& positions) {
  if (positions.rows() == 0) return std::nullopt;
  constexpr int numbers = Eigen::PropagateNumbers;  // non-finite values are reported as a defect of their own
  const double reach = positions.cwiseAbs().maxCoeff<numbers>();
  double extent = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    extent =
        std::max(extent, positions.col(axis).maxCoeff<numbers>() - positions.col(axis).minCoeff<numbers>());
  if (reach <= largest_shown && !(extent > 0 && extent < smallest_shown)) return std::nullopt;
  return fmt::format(
      "its coordinates reach {:.3g} and its size is {:.3g}, which cannot be shown; scale it to "
      "sizes between {:g} and {:g}",
      reach, extent, smallest_shown, largest_shown);
}

}  // namespace

std::optional<std::string> defect_note(const Scene& scene, const std::string& file) {
  const Diagnostics& diagnostics = scene.diagnostics;
  const std::filesystem::path path(file);
  if (scene.mesh.face_count() == 0)
    return fmt::format("{}: it has points and no faces, so there is no surface to edit",
                       path.filename().string());
  if (const auto note = range_note(scene.mesh.positions))
    return fmt::format("{}: {}", path.filename().string(), *note);
  constexpr std::size_t most_told = 4;
  std::vector<std::string> told;
  std::size_t kinds = 0;
  for (const Finding& finding : diagnostics.findings) {
    if (!matters(finding)) continue;
    if (++kinds <= most_told) told.push_back(finding.description);
  }
  if (kinds == 0) return std::nullopt;
  if (kinds > most_told) told.push_back(fmt::format("and more of {} other kinds", kinds - most_told));
  const std::string mended = path.stem().string() + "_repaired" + path.extension().string();
  return fmt::format("{}: {}. To mend that: meshgraft repair {} -o {}", path.filename().string(),
                     fmt::join(told, "; "), word(file), word(mended));
}

}  // namespace meshgraft::editor
