#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// The vertices of a mesh in a 3MF model part, and where they are written.
struct ThreemfVertices {
  Points positions{0, 3};               ///< in the object's frame
  std::vector<std::size_t> tag_begin;   ///< first byte of each <vertex …> in the part
  std::vector<std::size_t> tag_length;  ///< up to and with its '>'
};

/// An object that another one, or the build, is made of.
struct ThreemfReference {
  std::string path;  ///< of the part that it is in; empty = the same
  std::string id;
};

/// What a model part holds.
struct ThreemfPart {
  std::vector<ThreemfVertices> meshes;                              ///< in its order
  std::map<std::string, std::vector<ThreemfReference>> components;  ///< of each object that has them, by its id
  std::vector<ThreemfReference> items;                              ///< of the build
};

/// `location` names the part in messages. Throws Error(input) with the line for text that is no well-formed
/// XML, has a document type (which 3MF forbids) or a malformed coordinate.
ThreemfPart scan_part(std::string_view xml, const std::string& location);

/// True where bytes and characters of the part are the same thing, so that its tags can be rewritten.
bool is_utf8(std::string_view xml);

/// Appends the `<vertex …>` tag with the coordinates that differ between `from` and `to` replaced by the
/// shortest text that reads back as the same number.
void append_tag(std::string& out, std::string_view tag, const Eigen::RowVector3d& from,
                const Eigen::RowVector3d& to);

}  // namespace meshgraft::io
