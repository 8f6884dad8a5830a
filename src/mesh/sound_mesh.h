#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A mesh without the faces that the check refuses, so that a step that does not reach them can run. It
/// leaves out faces with the index of a vertex that does not exist, or with a vertex that is refused (of
/// non-finite, outlying or too large coordinates). Vertices keep their indices. Refused vertices belong to no
/// face, and get the position of another vertex until `put_back` restores them. If the check refuses nothing,
/// it is the given mesh, at no cost.
class SoundMesh {
 public:
  /// Keeps references to `mesh` and `diagnostics`. Throws Error(input), as `require_sound` does, where no
  /// face would be left. `name` is the mesh's name for messages.
  SoundMesh(const Mesh& mesh, const Diagnostics& diagnostics, const std::string& name);

  const Mesh& mesh() const { return sound_ ? *sound_ : given_; }
  bool any() const { return sound_.has_value(); }

  /// Returns a note of the faces that were left out (mesh.faces_left_out); none if there are none.
  std::optional<Note> note() const;

  /// Throws Error(input) if one of the faces that were left out has a vertex in `reached`.
  void require_beyond(std::span<const Index> reached) const;

  /// Returns the error of a step that worked on `mesh()`, with the note of the faces that were left out, if
  /// any. The error may concern a boundary that only this mesh has.
  Error explained(const Error& error) const;

  /// Returns whether the check refuses a vertex, so that it has the position of another one.
  bool is_refused(Index vertex) const { return std::ranges::binary_search(refused_, vertex); }

  /// Restores the coordinates of the given mesh's refused vertices in `result`. `vertex` maps from the
  /// given mesh to `result`.
  void put_back(const IndexMap& vertex, Mesh& result) const;

 private:
  const Mesh& given_;
  const Diagnostics& diagnostics_;
  std::string name_;
  std::optional<Mesh> sound_;
  std::vector<Index> refused_, faces_;  // vertices and faces of the given mesh that were left out
};

}  // namespace meshgraft
