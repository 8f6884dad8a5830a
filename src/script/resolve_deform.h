#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>
#include <meshgraft/select/selection.h>

namespace meshgraft {

/// Vertex sets that the steps of an edit produced on one mesh, by step and by name of the product. Loops are
/// in their order.
using ProducedSets = std::map<std::string, std::map<std::string, std::vector<Index>>>;

/// A deform step whose selections and files are replaced by the vertices and values they stand for on one
/// mesh.
struct ResolvedDeform {
  Region region;                  ///< `whole` if the region is the mesh; lists ascending
  std::vector<HandlePose> poses;  ///< one per handle of `region`
  /// Constraints of `targets` and `transforms`, ascending by vertex.
  std::vector<VertexConstraint> constraints;
  std::optional<SymmetryReport> symmetry;
  std::vector<Note> notes;  ///< about deviations from the request
};

/// Resolves `step` on `context.mesh`; `location` names the step in messages ("edit.json: steps[0]"). Throws
/// Error(input), naming the field, if
/// - a selection does not fit the mesh;
/// - a handle is empty or outside the region;
/// - a vertex has two roles;
/// - counts differ;
/// - or the mesh lacks a symmetry that the step requires (script.no_mirror_image, script.not_mirrored, …).
/// Throws Error(io) for a file that cannot be read.
ResolvedDeform resolve_deform(const EditFile& edit, const DeformStep& step, const SelectionMesh& context,
                              const Location& location, const ProducedSets& produced = {});

/// Returns notes about handles that are their own mirror image while their poses are not.
/// `poses` has one pose per handle.
std::vector<Note> pose_notes(const SymmetryReport& symmetry, std::span<const Handle> handles,
                             std::span<const HandlePose> poses, const Points& rest);

}  // namespace meshgraft
