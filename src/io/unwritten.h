#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// Names what a format without a place for them leaves out, a sentence each: the attributes with a value that
/// are none of `written` (nulls are passed over), and material libraries.
void note_unwritten(const Mesh& mesh, std::string_view format, std::initializer_list<const Attribute*> written,
                    std::vector<std::string>& notes);

}  // namespace meshgraft::io
