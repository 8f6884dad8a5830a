#pragma once

#include <map>
#include <string>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/select/selection.h>

#include "local_mesh.h"

namespace meshgraft::distributed {

/// Resolves selections of an edit file on a mesh that is divided among the ranks. All ranks call it together.
class Selections {
 public:
  /// `positions` has those of all local vertices, halo included. The arguments must outlive the object.
  Selections(const Communicator& comm, const LocalMesh& mesh, const Points& positions, const EditFile& edit);

  /// Returns a flag per local vertex. Throws what `resolve` throws, on all ranks, and Error(input) with the id
  /// distributed.selection_not_distributed for paths, mirrors and products of steps.
  Flags resolve(const EditSelection& selection, const Location& location);

  /// Returns the flagged vertices and those within `rings` edges of them.
  Flags grow(Flags flags, Number rings) const;
  /// Returns the vertices of `flags` within `rings` edges of a vertex that is not flagged.
  Flags rim(const Flags& flags, Number rings) const;
  /// Returns the number of flagged vertices on all ranks.
  Number count(const Flags& flags) const;
  /// Reads a file on the first rank, whose path is relative to the edit file, and returns its content.
  std::string read(const std::string& file, const Location& location) const;

 private:
  Flags found(const Selection::All&, const Location& location) const;
  Flags found(const Selection::Indices& indices, const Location& location) const;
  Flags found(const Selection::Box& box, const Location& location) const {
    return by_position(Selection(box), location);
  }
  Flags found(const Selection::Sphere& sphere, const Location& location) const {
    return by_position(Selection(sphere), location);
  }
  Flags found(const Selection::HalfSpace& half, const Location& location) const {
    return by_position(Selection(half), location);
  }
  Flags found(const Selection::Component& component, const Location& location) const;
  Flags found(const Selection::Loop& loop, const Location& location) const;
  Flags found(const Selection::NearestVertex& nearest, const Location& location) const;
  Flags found(const Selection::Path&, const Location& location) const;
  Flags found(const EditSelection::Named& named, const Location& location);
  Flags found(const EditSelection::IndexFile& file, const Location& location) const;
  Flags found(const EditSelection::SelFile& file, const Location& location) const;
  Flags found(const EditSelection::Produced&, const Location& location) const;
  Flags found(const EditSelection::Grow& grow, const Location& location);
  Flags found(const EditSelection::GrowLength& grow, const Location& location);
  Flags found(const EditSelection::Union& combined, const Location& location);
  Flags found(const EditSelection::Minus& combined, const Location& location);
  Flags found(const EditSelection::Intersect& combined, const Location& location);
  Flags found(const EditSelection::Mirror&, const Location& location) const;
  Flags found(const EditSelection::Rim& rim, const Location& location);

  Flags by_position(const Selection& selection, const Location& location) const;
  Flags flags_of(const std::vector<Index>& vertices) const;
  Flags boundary_vertices() const;

  const Communicator& comm_;
  const LocalMesh& mesh_;
  Mesh positions_;  ///< of the local vertices, without faces
  SelectionMesh geometry_;
  const EditFile& edit_;
  std::map<std::string, Flags> named_;
};

}  // namespace meshgraft::distributed
