#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// Adds a note each for the attributes and the material libraries that a format cannot hold. Attributes
/// without a value and those in `written` are left out; nulls in `written` are ignored.
void note_unwritten(const Mesh& mesh, std::string_view format, std::initializer_list<const Attribute*> written,
                    std::vector<Note>& notes);

/// Adds a note if single precision rounds a coordinate by more than 5e-6 of the mesh's size, as far from the
/// origin. Returns whether it does.
bool note_coarse_coordinates(const Mesh& mesh, std::string_view format, std::vector<Note>& notes);

}  // namespace meshgraft::io
