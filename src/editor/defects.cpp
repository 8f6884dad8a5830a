#include "defects.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <meshgraft/io/mesh_io.h>

#include "editor/facts.h"
#include "io/file_document.h"
#include "mesh/repair/repair_kinds.h"
#include "script/fact_json.h"

namespace meshgraft::editor {

namespace {

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

// Returns a note with the name that the user knows. An upload has a longer one on the disk.
Note with_name(const Note& note, const Mesh& mesh, const std::string& name) {
  const io::FileDocument* document = io::origin_of(mesh);
  std::vector<FieldValue> values = note.values();
  for (FieldValue& value : values)
    if (auto* text = std::get_if<std::string>(&value))
      if (document != nullptr && *text == document->path.filename().string()) *text = name;
  return {note.type(), std::move(values)};
}

}  // namespace

bool matters(const Finding& finding) {
  return finding.kind != FindingKind::duplicate_vertex && finding.kind != FindingKind::polygon;
}

Json findings_json(const MeshState& state) {
  Json list = Json::array();
  for (const Finding& finding : state.diagnostics.findings)
    if (matters(finding))
      list.push_back({{"kind", name_of(finding.kind)},
                      {"note", to_json(finding.note)},
                      {"repairable", is_repairable(finding.kind)}});
  return list;
}

const Finding& finding_named(const Object& object, const std::string& name) {
  const std::vector<Finding>& findings = object.state().diagnostics.findings;
  const auto found =
      std::ranges::find_if(findings, [&](const Finding& finding) { return name_of(finding.kind) == name; });
  if (found == findings.end()) throw Error(facts::editor::NoSuchFinding{.name = name}, "finding");
  return *found;
}

std::vector<FileNote> notes_on_file(const MeshState& state, const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  std::vector<FileNote> notes;
  for (const Note& note : notes_on_files(state.mesh)) notes.push_back({with_name(note, state.mesh, name), {}});
  if (state.mesh.face_count() == 0) {
    notes.push_back({facts::editor::NoSurface{.file = name}, {}});
  } else if (const auto range = range_note(state.mesh.positions, name);
             range && !state.diagnostics.find(FindingKind::outlying_vertex)) {
    notes.push_back({*range, {}});
  } else {
    FileNote defects{
        facts::editor::Defects{.file = name,
                               .path = file,
                               .repaired = file.stem().string() + "_repaired" + file.extension().string()},
        {}};
    for (const Finding& finding : state.diagnostics.findings)
      if (matters(finding)) defects.details.push_back(finding.note);
    if (!defects.details.empty()) notes.push_back(std::move(defects));
  }
  return notes;
}

Json file_notes_json(std::span<const FileNote> notes) {
  Json list = Json::array();
  for (const auto& [note, details] : notes) {
    list.emplace_back(to_json(note));
    if (!details.empty()) list.back()["details"] = to_json(details);
  }
  return list;
}

}  // namespace meshgraft::editor
