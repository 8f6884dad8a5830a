#pragma once

#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/script/edit_file.h>

#include "mesh/sound_mesh.h"
#include "run_steps.h"
#include "script/facts.h"
#include "selection_resolver.h"

namespace meshgraft {

/// One of the two meshes of a merge step.
struct MergeSide {
  facts::script::Side name;  ///< of the two meshes
  const MeshState& state;
  SoundMesh sound;  ///< the mesh to merge; loops and selections are those of the given mesh
  SelectionMesh context;
  SelectionResolver selections;

  MergeSide(facts::script::Side name_, const EditFile& edit, const MeshState& state_);

  /// Refuses a vertex given by its number if it is not finite or belongs to a defective face.
  void require_sound(Index vertex, const Location& location) const;

  /// Returns the vertices that the merge removed or that belong to faces of the seam.
  std::vector<Index> reached(const IndexMap& map, const Mesh& result,
                             const std::vector<Index>& new_faces) const;

  /// Checks after the merge that no excluded element lies where the result is new. Then puts the excluded
  /// elements back.
  void finish(const IndexMap& map, MergeResult& result, std::vector<Note>& notes) const;
};

/// Returns the pairs of loops with their matches. Throws Error(input) naming the field of the step.
std::vector<MergePair> resolve_pairs(const MergeStep& step, MergeSide& source, MergeSide& target,
                                     const Location& location);

/// Returns the loop of the source that is dropped on the target; empty where the source is to be opened at its
/// base. Throws Error(input).
std::vector<Index> dropped_loop(const DropSpec& drop, MergeSide& source, const Location& location);

/// Returns the one of some vertices that is nearest to a point.
Index nearest(const Mesh& mesh, std::span<const Index> vertices, const Eigen::Vector3d& point);

}  // namespace meshgraft
