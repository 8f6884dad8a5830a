#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "core/memory_budget.h"

namespace meshgraft::io {

/// The vertices of a mesh in a 3MF model part, and the locations of their tags.
struct ThreemfVertices {
  Points positions{0, 3};               ///< in the object's frame
  std::vector<std::size_t> tag_begin;   ///< first byte of each <vertex …> in the part
  std::vector<std::size_t> tag_length;  ///< up to its '>', inclusive
};

/// A reference to an object from a component or from a build item.
struct ThreemfReference {
  std::string path;  ///< of the part that holds the object; empty = the same
  std::string id;
};

/// The contents of a model part.
struct ThreemfPart {
  std::vector<ThreemfVertices> meshes;                              ///< in the part's order
  std::map<std::string, std::vector<ThreemfReference>> components;  ///< per object with components, by its id
  std::vector<ThreemfReference> items;                              ///< of the build
  std::size_t triangles = 0;                                        ///< of all meshes
};

/// Parses a part. `location` names it in messages. Throws Error(input) with the line if the text is not
/// well-formed XML (threemf.not_xml), has a document type (threemf.has_document_type), or lacks a coordinate or
/// has a malformed one. Charges what it returns.
ThreemfPart scan_part(std::string_view xml, const std::string& location, MemoryBudget& budget,
                      const Context& context);

/// Returns whether the part begins with the mark of UTF-16. Its tags can then not be rewritten byte by byte.
bool has_utf16_mark(std::string_view xml);

/// Appends the `<vertex …>` tag with the coordinates that differ between `from` and `to` replaced by the
/// shortest text that reads back as the same number.
void append_tag(std::string& out, std::string_view tag, const Eigen::RowVector3d& from,
                const Eigen::RowVector3d& to);

}  // namespace meshgraft::io
