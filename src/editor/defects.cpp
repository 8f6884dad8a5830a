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

// As a shell takes it for one word.
std::string word(const std::string& text) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:@%";
  if (text.find_first_not_of(plain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::optional<std::string> defect_note(const Scene& scene, const std::string& file) {
  const TriageReport& triage = scene.triage;
  const std::filesystem::path path(file);
  if (scene.mesh.face_count() == 0)
    return fmt::format("{}: it has points and no faces, so there is no surface to edit",
                       path.filename().string());
  constexpr std::size_t most_told = 4;
  std::vector<std::string> told;
  std::size_t kinds = 0;
  for (const Finding& finding : triage.findings) {
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
