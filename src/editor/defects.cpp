#include "defects.h"

#include <algorithm>
#include <optional>
#include <string>

#include <meshgraft/io/mesh_io.h>

#include "editor/facts.h"

namespace meshgraft::editor {

namespace {

bool matters(const Finding& finding) {
  return finding.kind != FindingKind::duplicate_vertex && finding.kind != FindingKind::polygon;
}

// Range that a GPU can show: beyond it, squares of single-precision numbers overflow or vanish.
constexpr double largest_shown = 1e15, smallest_shown = 1e-15;

std::optional<Note> range_note(const Points& positions, const std::string& file) {
  if (positions.rows() == 0) return std::nullopt;
  constexpr int numbers = Eigen::PropagateNumbers;  // non-finite values are reported as a defect of their own
  const double reach = positions.cwiseAbs().maxCoeff<numbers>();
  double extent = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    extent =
        std::max(extent, positions.col(axis).maxCoeff<numbers>() - positions.col(axis).minCoeff<numbers>());
  if (reach <= largest_shown && !(extent > 0 && extent < smallest_shown)) return std::nullopt;
  return facts::editor::SizeNotShown{
      .file = file, .reach = reach, .size = extent, .low = smallest_shown, .high = largest_shown};
}

}  // namespace

std::vector<Note> defect_notes(const MeshState& state, const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  if (state.mesh.face_count() == 0) return {facts::editor::NoSurface{.file = name}};
  if (const auto note = range_note(state.mesh.positions, name)) return {*note};
  std::vector<Note> notes = notes_on_files(state.mesh);
  const std::size_t before_findings = notes.size();
  for (const Finding& finding : state.diagnostics.findings)
    if (matters(finding)) notes.push_back(finding.note);
  if (notes.size() > before_findings)
    notes.insert(
        notes.begin() + static_cast<std::ptrdiff_t>(before_findings),
        facts::editor::Defects{.file = name,
                               .path = file,
                               .repaired = file.stem().string() + "_repaired" + file.extension().string()});
  return notes;
}

}  // namespace meshgraft::editor
