#pragma once

#include <cstddef>
#include <string>

#include <meshgraft/merge/merge_options.h>

#include "document.h"

namespace meshgraft::editor {

// Changes of any step; `index` counts from 0. They throw Error(input) where the step does not exist.

struct StepChange {
  Json fields = Json::object();  ///< as in an edit file; null removes; settings change one by one
  Json poses = Json::object();   ///< by the names of handles of a deform step
};

/// Changes fields of a step. If it is one of two cuts that divide an object, the other one follows.
void change_step(Json& document, std::size_t index, const StepChange& change);
/// Sets the start of a pair of a merge step. Removes its other matches, because they determine a start, too.
void set_start(Json& document, std::size_t index, std::size_t pair, const Match& start);
/// Removes a step. Throws Error(usage) for the only step.
void remove_step(Json& document, std::size_t index);
/// Removes the steps from `first` on, the named selections that come from them, and the name of the output.
void drop_steps_from(Json& document, std::size_t first);
/// Does the same. A step of `mesh` that does nothing takes their place.
void leave_out_steps(Json& document, std::size_t first, const std::string& mesh);
/// Renames a step and all references to what it produced; an empty name removes the name.
void rename_step(Json& document, std::size_t index, const std::string& name);

}  // namespace meshgraft::editor
