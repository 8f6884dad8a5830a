#pragma once

#include <map>
#include <string>
#include <vector>

#include <meshgraft/deform/constraints.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/deform/selection.h>
#include <meshgraft/edit/edit_file.h>

namespace meshgraft {

/// What the steps of an edit produced on one mesh, by step and by what: vertices, loops in their order.
using ProducedSets = std::map<std::string, std::map<std::string, std::vector<Index>>>;

/// A deform step with every selection and file replaced by what it stands for on one mesh.
struct ResolvedDeform {
  Region region;                              ///< `whole` if the region is the mesh; lists ascending
  std::vector<HandlePose> poses;              ///< one per handle of `region`
  std::vector<VertexConstraint> constraints;  ///< of `targets` and `transforms`, ascending by vertex
};

/// What `step` means on `context.mesh`; `place` names the step in messages ("edit.json: steps[0]").
/// Throws Error(input), naming the field, for a selection that does not fit the mesh, an empty handle, vertices
/// with two roles, a handle outside the region, and counts that differ; Error(io) for a file that cannot be
/// read.
ResolvedDeform resolve_deform(const EditFile& edit, const DeformStep& step, const SelectionContext& context,
                              const std::string& place, const ProducedSets& produced = {});

}  // namespace meshgraft
