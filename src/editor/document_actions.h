#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "document.h"

namespace meshgraft::editor {

// Changes of a document as JSON, on the step that is worked on; one is added where the last step is a cut. They
// throw Error(usage) where it is a graft. `make_document` then says whether what came out is an edit.

Json& step_of(Json& document);

struct NewHandle {
  std::string name;   ///< empty: one that is free
  std::string shape;  ///< as an edit file has it
  Json select;        ///< a selection of an edit file
  std::optional<bool> closed{};
  std::optional<double> reach{};  ///< the region grows by what lies within it, model units along edges
  std::string constrain{};        ///< as an edit file has it; empty: both
  Json pose = Json::object();     ///< as an edit file has it; empty: it stays where it is at rest
};

/// Returns its name.
std::string add_handle(Json& document, const NewHandle& handle);

/// These throw Error(input) for a handle that is not there.
void remove_handle(Json& document, const std::string& name);
void rename_handle(Json& document, const std::string& name, const std::string& to);
void set_reach(Json& document, const std::string& name, double reach);
void set_pose(Json& document, const std::string& name, const Json& pose);

/// As a deform step has it; null: none.
void set_symmetry(Json& document, const Json& symmetry);

/// Of a handle that has one, in the step as JSON.
std::optional<double> reach_of(const Json& step, const Json& handle);

/// Puts the named values of `changes` in the place of the step's.
void change_settings(Json& document, const Json& changes);

/// A next deform step on what the last one left. Throws Error(usage) where that does nothing yet.
void accept_step(Json& document, const EditFile& edit);

/// A named selection, and the colour that it is drawn in; empty: as before.
void set_group(Json& document, const std::string& name, const Json& selection, const std::string& colour);
/// Another colour for it; empty: none of its own. Throws Error(input) where it does not exist.
void set_colour(Json& document, const std::string& name, const std::string& colour);
/// Throws Error(input) where it is in use.
void remove_group(Json& document, const std::string& name);

}  // namespace meshgraft::editor
