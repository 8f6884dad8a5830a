#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The source files of a mesh whose faces differ from theirs, because it was cut, or joined from several
/// meshes. A writer takes from each file the data that does not depend on topology (from an OBJ the
/// definitions of its materials).
struct JoinedSources : SourceDocument {
  struct File {
    std::shared_ptr<const SourceDocument> document;
    /// Materials of the mesh from this file: the name in the file, and the name in the mesh.
    std::vector<std::pair<std::string, std::string>> materials;
  };
  /// The file of the mesh whose coordinates these are: for a graft, the target's. Null where it came from none.
  std::shared_ptr<const SourceDocument> origin;
  std::vector<File> files;
  std::vector<Note> notes;  ///< about names that were changed
};

/// Returns the source files of a mesh in the form for a mesh with other faces; null where there are none.
std::shared_ptr<const JoinedSources> sources_of(const Mesh& mesh);

struct JoinResult {
  Mesh mesh;
  IndexMap first, second;   ///< vertices, old → new
  std::vector<Note> notes;  ///< about names that were changed
};

/// Joins two meshes into one: all vertices and faces of `first`, then those of `second`, with the attributes
/// of both. Values that one mesh lacks are missing there (NaN; colours are white). Attributes of the same
/// name and domain become one if they have the same number of components. Otherwise the second's gets a
/// suffix. Further rules:
/// - an attribute that is per vertex in one mesh and per corner in the other (UVs, normals) becomes one per
///   corner;
/// - colours of different types become fractions, and get an alpha where the other's have one;
/// - labels are joined: groups of the same name become one group. Materials of the same name may look
///   different in the two files; unless both meshes come from one file, the second's gets a suffix
///   ("skin_2").
JoinResult join(const Mesh& first, const Mesh& second);

}  // namespace meshgraft
