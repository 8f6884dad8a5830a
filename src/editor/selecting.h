#pragma once

#include <string>
#include <vector>

#include "folders.h"
#include "objects.h"
#include "script/json_value.h"

namespace meshgraft::editor {

/// Returns the vertices that `value` names, ascending. `value` is a selection as in an edit file, or
/// {"flood": {"vertex", "angle_deg"}}, {"component_of": vertex}, {"loop_of": vertex}. Throws Error(input) for
/// anything else, and for files outside `folders`.
std::vector<Index> select_vertices(const json::Value& value, const Document& document, const Object& base,
                                   const Folders& folders);

/// Returns the vertices of the faces that are reached from those around `vertex` across edges bent by at most
/// `angle_deg`.
std::vector<Index> flood(const Object& base, Index vertex, double angle_deg);

}  // namespace meshgraft::editor
