#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "document.h"
#include "history.h"

namespace meshgraft::editor {

// Changes of a document as JSON that concern parts, cuts and grafts; `edit` is the document before the
// change. A current step that does nothing yet is removed; otherwise it is kept and thereby ended.

/// Throws Error(usage) with the id editor.graft_in_work where a graft is in work.
void require_no_graft(const EditFile& edit, const std::string& what);

/// Returns a file as an input of an edit in `folder`, with its hash. The path is relative where the file lies
/// below `folder`. Throws Error(io).
Json file_input(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Adds an input in the form of an edit file and returns its name. Where `name` is taken and `may_number` is
/// set, a number is appended. Throws Error(input) for a name that is taken.
std::string add_part(Json& document, const EditFile& edit, const Json& input, const std::string& name,
                     bool may_number);

/// Removes a part and the steps that make or change it. Throws Error(input) for the model, for a name that is
/// no part, and for a part that other steps use.
void remove_part(Json& document, const EditFile& edit, const std::string& name);

/// Makes a part the model, on which the following steps work.
void edit_part(Json& document, const EditFile& edit, const std::string& name);

/// Adds a step that changes the faces of one mesh, such as a cut. Its `mesh` is the model or a part. Returns
/// the index of the step.
std::size_t add_mesh_step(Json& document, const EditFile& edit, Json step);

struct Halves {
  std::size_t step = 0;   ///< index of the last cut
  std::string part = {};  ///< name of the new part
};

/// Adds two cuts that divide the mesh of `step`, a cut without `keep`: the half above stays that mesh, and the
/// half below becomes a part.
Halves add_halves(Json& document, const EditFile& edit, Json step);

/// Makes an accepted graft the one in work, by index; without one, the graft that was accepted last. The steps
/// after it are left out. Throws Error(usage) if there is no such graft, or if one is in work already.
void resume_graft(Json& document, const EditFile& edit, std::optional<std::size_t> index);

/// The document before a graft was taken up again, and after.
struct ResumedGraft {
  Document before, after;
  /// The steps after the graft, without a last one that does nothing yet. They are set aside until the graft
  /// is accepted or cancelled.
  std::vector<Json> set_aside() const;
};
/// Returns the graft that was taken up again last and is in work since then; nothing for any other graft.
std::optional<ResumedGraft> resumed_graft(const Document& document, const History& history);

/// Returns a document whose last step is a resumed graft with the later steps behind it again, and the named
/// selections that left with them.
Json with_later_steps(const Json& document, const ResumedGraft& resumed);

/// Returns a document whose last step is a resumed graft with that graft as it was before, and the later steps
/// behind it. Other changes since then stay.
Json cancelled_again(const Json& document, const ResumedGraft& resumed);

/// Starts a graft, or changes the one in work. `fields` are those of a merge step; null removes a field, and
/// only the named values of `settings` change. Throws Error(input) where the part is ambiguous or is the
/// model itself.
void set_graft(Json& document, const EditFile& edit, const Json& fields);
/// Removes the graft in work.
void cancel_graft(Json& document, const EditFile& edit);
/// Returns the part that the last change added beside the model; empty: the last change is another one.
std::string part_of_last_change(const History& history);
/// Returns the part that was added by the same change as the graft in work was started; empty: none.
std::string part_of_drop(const History& history);
/// Exchanges target and source, with the pairs. Removes the fields that apply to one of them only.
void swap_graft(Json& document, const EditFile& edit);

/// Returns whether a graft before the current step uses this mesh.
bool is_grafted(const EditFile& edit, const std::string& name);

}  // namespace meshgraft::editor
