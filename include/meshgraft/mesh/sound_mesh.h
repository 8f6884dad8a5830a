#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A mesh with what the check refuses out of the way, so that a step that does not reach it can go on: faces
/// that name a vertex which does not exist or has a non-finite coordinate are left out. Vertices keep their
/// numbers; those without finite coordinates are in no face and stand, until they are put back, at the place of
/// another. Where the check refuses nothing it is the given mesh, and costs nothing.
class SoundMesh {
 public:
  /// Refers to both. Throws Error(input), as `require_usable` does, where no face would be left; `name` is the
  /// mesh's for messages.
  SoundMesh(const Mesh& mesh, const Diagnostics& diagnostics, const std::string& name);

  const Mesh& mesh() const { return usable_ ? *usable_ : given_; }
  bool any() const { return usable_.has_value(); }

  /// What was left out, for people; empty if nothing was.
  std::string note() const;

  /// Throws Error(input) if a face that was left out has one of the vertices in `reach`.
  void require_beyond(std::span<const Index> reach) const;

  /// The error of a step that worked on `mesh()`, which may be about a boundary that only this mesh has: with
  /// what was left out, if anything was.
  Error explained(const Error& error) const;

  /// Gives the copies in `result` of vertices without finite coordinates these coordinates again. `vertex` maps
  /// from the given mesh.
  void put_back(const IndexMap& vertex, Mesh& result) const;

 private:
  const Mesh& given_;
  const Diagnostics& diagnostics_;
  std::string name_;
  std::optional<Mesh> usable_;
  std::vector<Index> non_finite_, faces_;  // that were left out, of the given mesh
};

}  // namespace meshgraft
