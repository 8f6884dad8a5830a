#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/deform/constraints.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/deform/selection.h>
#include <meshgraft/script/edit_file.h>

namespace meshgraft {

/// What the steps of an edit produced on one mesh, by step and by what: vertices, loops in their order.
using ProducedSets = std::map<std::string, std::map<std::string, std::vector<Index>>>;

/// What the symmetry of a step came to.
struct SymmetryFacts {
  Eigen::Affine3d reflection = Eigen::Affine3d::Identity();
  std::vector<std::size_t> twin_of;  ///< of each twin, its handle; twins come behind all handles of the step
  std::vector<std::size_t> own;      ///< handles that are their own mirror image
  Index without_partner = 0;         ///< vertices of the region
};

/// A deform step with every selection and file replaced by what it stands for on one mesh.
struct ResolvedDeform {
  Region region;                              ///< `whole` if the region is the mesh; lists ascending
  std::vector<HandlePose> poses;              ///< one per handle of `region`
  std::vector<VertexConstraint> constraints;  ///< of `targets` and `transforms`, ascending by vertex
  std::optional<SymmetryFacts> symmetry;
  std::vector<std::string> notes;  ///< sentences for people about what is another way than asked
};

/// What `step` means on `context.mesh`; `location` names the step in messages ("edit.json: steps[0]").
/// Throws Error(input), naming the field, for a selection that does not fit the mesh, an empty handle, vertices
/// with two roles, a handle outside the region, counts that differ, and what is asked of a
/// symmetry that the mesh does not have; Error(io) for a file that cannot be
/// read.
ResolvedDeform resolve_deform(const EditFile& edit, const DeformStep& step, const SelectionContext& context,
                              const std::string& location, const ProducedSets& produced = {});

/// Sentences about handles that are their own mirror image and whose poses are not; `poses` are one per handle.
std::vector<std::string> pose_notes(const SymmetryFacts& symmetry, std::span<const Handle> handles,
                                    std::span<const HandlePose> poses, const Points& rest);

}  // namespace meshgraft
