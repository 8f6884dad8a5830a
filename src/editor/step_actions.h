#pragma once

#include <cstddef>
#include <string>

#include <meshgraft/merge/correspondence.h>

#include "document.h"

namespace meshgraft::editor {

// Changes of any step, `index` counting from 0. Throw Error(input) where there is no such step.

struct StepChange {
  Json fields = Json::object();  ///< as an edit file has them; null removes; settings are changed one by one
  Json poses = Json::object();   ///< by the names of handles of a deform step
};

void change_step(Json& document, std::size_t index, const StepChange& change);
/// Where a pair of a merge step starts to meet from now on; its other matches, which say the same, go.
void set_start(Json& document, std::size_t index, std::size_t pair, const Match& start);
/// Throws Error(usage) for the only step.
void remove_step(Json& document, std::size_t index);
/// With what names the step for what it produced; an empty name is none.
void rename_step(Json& document, std::size_t index, const std::string& name);

}  // namespace meshgraft::editor
