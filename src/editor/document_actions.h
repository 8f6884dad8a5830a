#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "document.h"

namespace meshgraft::editor {

// Changes of a document as JSON that act on the current step. A step is added where the last one is neither
// a deformation nor a graft.
// They throw Error(usage) where the current step is a graft. `make_document` then validates the result.

Json& step_of(Json& document);

/// Returns a deform step of a mesh that does nothing yet.
Json empty_step(const std::string& mesh);

struct NewHandle {
  std::string name;   ///< empty: a free name is chosen
  std::string shape;  ///< in the form of an edit file
  Json select;        ///< a selection in the form of an edit file
  std::optional<bool> closed{};
  std::optional<double> reach{};  ///< grows the region by the vertices within it, model units along edges
  std::string constrain{};        ///< in the form of an edit file; empty: both
  Json pose = Json::object();     ///< in the form of an edit file; empty: the handle stays at rest
};

/// Adds a handle and returns its name.
std::string add_handle(Json& document, const NewHandle& handle);

/// These functions throw Error(input) for a handle that does not exist.
void remove_handle(Json& document, const std::string& name);
void rename_handle(Json& document, const std::string& name, const std::string& to);
void set_reach(Json& document, const std::string& name, double reach);
void set_pose(Json& document, const std::string& name, const Json& pose);

/// Sets the symmetry, in the form of a deform step; null removes it.
void set_symmetry(Json& document, const Json& symmetry);

/// Returns the reach of a handle in a step given as JSON, if the handle has one.
std::optional<double> reach_of(const Json& step, const Json& handle);

/// Sets fields of a JSON object; null removes a field.
void replace_fields(Json& into, const Json& changes);

/// Sets settings of any step; null removes one. Another preset, or none, stands for all settings that are not
/// named, except `backend`, `seed` and `weld`.
void replace_settings(Json& settings, const Json& changes);

/// Does the same to the settings of the step.
void change_settings(Json& document, const Json& changes);

/// Appends a deform step that works on the result of the last one. Throws Error(usage) where the last one
/// does nothing yet.
void accept_step(Json& document, const EditFile& edit);

/// Sets a named selection and the colour in which it is drawn; an empty colour keeps the previous one.
void set_group(Json& document, const std::string& name, const Json& selection, const std::string& colour);
/// Sets the colour of a named selection; empty removes it. Throws Error(input) where the selection does not
/// exist.
void set_colour(Json& document, const std::string& name, const std::string& colour);
/// Removes a named selection. Throws Error(input) where it is in use.
void remove_group(Json& document, const std::string& name);

}  // namespace meshgraft::editor
