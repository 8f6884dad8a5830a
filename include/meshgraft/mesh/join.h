#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The files behind a mesh whose faces are none of theirs, for it was cut, or joined from several: a writer
/// takes from each what does not depend on the topology (an OBJ the definitions of its materials).
struct JoinedSources : SourceDocument {
  struct Part {
    std::shared_ptr<const SourceDocument> source;
    /// The materials that the mesh has from it: their names in the file, and now.
    std::vector<std::pair<std::string, std::string>> materials;
  };
  std::vector<Part> parts;
  std::vector<std::string> notes;  ///< what of them has another name now, a line each
};

/// The files behind a mesh, for one with other faces; null where it has none.
std::shared_ptr<const JoinedSources> sources_of(const Mesh& mesh);

struct JoinResult {
  Mesh mesh;
  IndexMap first, second;          ///< vertices, old → new
  std::vector<std::string> notes;  ///< sentences for people: what was renamed
};

/// Two meshes as one: all vertices and faces of `first`, then those of `second`, with the attributes of both.
/// What one of them lacks is missing there (NaN; colours are white). Attributes of one name and domain become
/// one if they have as many components, else the second's gets a suffix:
/// - what one has per vertex and the other per corner (UVs, normals) becomes one per corner;
/// - colours of different types become fractions, and get an alpha where the other's have one;
/// - labels are joined: groups of one name are one group. Materials of one name may look different in the two
///   files; unless both meshes come from one, the second's gets a suffix ("skin_2").
JoinResult join(const Mesh& first, const Mesh& second);

}  // namespace meshgraft
