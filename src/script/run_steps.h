#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/open_hole.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/weld.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>
#include <meshgraft/script/resolve_deform.h>
#include <meshgraft/script/run_edit.h>

#include "refine_boundary.h"

namespace meshgraft {

/// A mesh in the course of an edit.
struct Scene {
  Mesh mesh;
  Points rest;        ///< before the first deform step since the faces are what they are
  std::string label;  ///< the file or sample it came from
  Diagnostics diagnostics;
  Flags was_free;       ///< per vertex, in any deform step
  bool is_cut = false;  ///< by the edit: what lies at one place there was taken apart on purpose
  ProducedSets produced;
};

/// An edit's inputs, read and checked; can be run from more than once.
struct LoadedInputs {
  std::map<std::string, Scene> scenes;  ///< by name
  std::vector<EditReport::Input> reports;
  double read_seconds = 0, check_seconds = 0;
};

/// Throws Error(io) and Error(input), naming the input.
LoadedInputs load_inputs(const EditFile& edit, const Context& context);

/// A mesh on its way into an edit: checked, with nothing done to it.
Scene make_scene(Mesh mesh, std::string label, const Context& context);

/// What `map` leaves of the vertices in `from`, into `to`.
void carry_produced(const ProducedSets& from, const IndexMap& map, ProducedSets& to);

/// A deform step on its scene, ready to be solved.
struct DeformSetup {
  Weld weld;              ///< empty: the problem is on the scene's mesh
  Mesh welded;            ///< else the mesh that it is on
  DeformProblem problem;  ///< before its boundary is refined
};

/// `settings` are those in force. Throws what `resolve_deform` throws, and Error(input) for defects within
/// reach.
DeformSetup set_up_deform(const EditFile& edit, const DeformStep& step, const std::string& location,
                          const Scene& scene, const DeformSettings& settings);

/// A step's options with those of the command line in their place.
DeformerOptions effective_options(DeformerOptions options, const SettingsOverrides& overrides);

/// Run one step on its meshes among `scenes` and put the outcome there; throw what `run_edit` throws.
StepReport run_step(const EditFile& edit, const EditStep& step, const std::string& location,
                    std::map<std::string, Scene>& scenes, const RunOptions& options, const Context& context);
StepReport run_deform(const EditFile& edit, const DeformStep& step, const std::string& location, Scene& scene,
                      const RunOptions& options, const Context& context);
StepReport run_merge(const EditFile& edit, const EditStep& step, const std::string& location,
                     std::map<std::string, Scene>& scenes, const RunOptions& options, const Context& context);

/// Where the source of a merge step with `at` stands before it bends.
class DropPlacement {
 public:
  /// Throws Error(input) as the step does for a loop that is none.
  DropPlacement(const EditFile& edit, const MergeStep& step, const std::string& location, const Scene& target,
                const Scene& source);

  /// A map of the source's own coordinates, with `at` and `size` of a step that is else the same. Where no size
  /// is given the part has its own, though the merge may make it smaller. Throws Error(input) for a place that
  /// is none.
  Eigen::Affine3d map(const MergeStep& step) const;

 private:
  std::string location_;
  Eigen::Affine3d posing_;
  std::optional<DropGuide> guide_;
};

StepReport run_cut(const EditStep& step, const std::string& location, std::map<std::string, Scene>& scenes,
                   const Context& context);

/// Leaves among `scenes` what `run_step` leaves of a deform step whose solution is known: `solution` is what
/// `Deformer::evaluate` gave on the problem that `set_up_deform` makes of it (n×3). Throws what that throws.
void apply_solution(const EditFile& edit, const EditStep& step, const std::string& location,
                    std::map<std::string, Scene>& scenes, const Points& solution, const Context& context);

/// The mesh that a step works on, among `scenes` by the name of its outcome.
Scene& scene_for_outcome(const EditStep& step, std::map<std::string, Scene>& scenes);

/// The farthest that a vertex moved, model units; n×3 both.
double largest_displacement(const Points& rest, const Points& edited);

/// The edit from there on, as `run_edit`.
EditResult run_steps(const EditFile& edit, LoadedInputs inputs, const RunOptions& options,
                     const Context& context);

}  // namespace meshgraft
