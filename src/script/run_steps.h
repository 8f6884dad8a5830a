#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/orientation.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>
#include <meshgraft/script/run_edit.h>

#include "merge/open_hole.h"
#include "mesh/simple_surface.h"
#include "mesh/weld.h"
#include "refine_boundary.h"
#include "resolve_deform.h"

namespace meshgraft {

/// A mesh during an edit.
struct MeshState {
  Mesh mesh;
  Points rest;        ///< before the first deform step since the faces last changed
  std::string label;  ///< the file or sample it came from
  Diagnostics diagnostics;
  std::shared_ptr<const SimpleSurface> surface;  ///< the mesh's connectivity; null if it is no simple surface
  Flags was_free;                                ///< per vertex: free in any deform step
  bool is_cut = false;                           ///< the edit cut it: vertices there coincide on purpose
  ProducedSets produced;
  /// Orientations that the model may have: one that its input tells, or guesses from before it was cut. Empty:
  /// nobody asked yet.
  std::vector<OrientationGuess> orientations;
};

/// An edit's inputs, read and checked. They can be run more than once.
struct LoadedInputs {
  std::map<std::string, MeshState> states;  ///< by name
  std::vector<EditReport::Input> reports;
  std::vector<Note> notes;  ///< on the files
  double read_seconds = 0, check_seconds = 0;
};

/// Reads and checks the inputs. Throws Error(io) and Error(input), naming the input.
LoadedInputs load_inputs(const EditFile& edit, const Context& context);

/// Checks the state's mesh, after its faces have changed.
void check_state(MeshState& state, const Context& context);

/// Makes a state of a mesh that no step has changed: checks it and leaves it unchanged.
MeshState make_mesh_state(Mesh mesh, std::string label, const Context& context);

/// Does the same for the mesh of an input.
MeshState make_input_state(const EditInput& input, Mesh mesh, std::string label, const Context& context);

/// Maps the vertices in `from` by `map` into `to`; removed vertices are dropped.
void carry_produced(const ProducedSets& from, const IndexMap& map, ProducedSets& to);

/// A deform step on its state, ready to be solved.
struct DeformSetup {
  Weld weld;                ///< empty: the problem is on the state's mesh
  Mesh welded;              ///< otherwise the mesh of the problem
  ResolvedProblem problem;  ///< before its boundary is refined
};

/// Resolves a deform step. `settings`: those in force. Throws what `resolve_deform` throws, and Error(input)
/// for defects within reach.
DeformSetup set_up_deform(const EditFile& edit, const DeformStep& step, const Location& location,
                          const MeshState& state, const DeformSettings& settings);

/// Returns a step's settings with the overrides in their place.
DeformSettings effective_settings(DeformSettings settings, const SettingsOverrides& overrides);
MergeSettings effective_settings(MergeSettings settings, const SettingsOverrides& overrides);

/// These run one step on its meshes in `states` and store the outcome there. They throw what `run_edit`
/// throws.
StepReport run_step(const EditFile& edit, const EditStep& step, const Location& location,
                    std::map<std::string, MeshState>& states, const RunOptions& options,
                    const Context& context);
StepReport run_deform(const EditFile& edit, const DeformStep& step, const Location& location, MeshState& state,
                      const RunOptions& options, const Context& context);
StepReport run_merge(const EditFile& edit, const EditStep& step, const Location& location,
                     std::map<std::string, MeshState>& states, const RunOptions& options,
                     const Context& context);

StepReport run_cut(const EditStep& step, const Location& location, std::map<std::string, MeshState>& states,
                   const Context& context);
StepReport run_repair(const EditStep& step, const Location& location, std::map<std::string, MeshState>& states,
                      const Context& context);
StepReport run_sculpt(const EditFile& edit, const EditStep& step, const Location& location,
                      std::map<std::string, MeshState>& states, const Context& context);
StepReport run_transform(const EditStep& step, const Location& location,
                         std::map<std::string, MeshState>& states, const Context& context);

/// Computes the placement of the source of a merge step with `at`, before it is deformed.
class DropPlacement {
 public:
  /// Throws Error(input), like the step, for an invalid loop.
  DropPlacement(const EditFile& edit, const MergeStep& step, const Location& location, const MeshState& target,
                const MeshState& source);

  /// Returns a map of the source's original coordinates, for `at` and `size` of a step that is otherwise the
  /// same. Without a size the source keeps its own, though the merge may make it smaller. Throws Error(input)
  /// for an invalid location.
  Eigen::Affine3d map(const MergeStep& step) const;

 private:
  Location location_;
  Eigen::Affine3d posing_;
  std::optional<DropGuide> guide_;
};

/// Stores in `states` the outcome of a deform step whose solution is known, as `run_step` would. `solution`
/// is the result of `Deformer::evaluate` on the problem that `set_up_deform` makes (n×3). Throws what
/// `set_up_deform` throws.
void apply_solution(const EditFile& edit, const EditStep& step, const Location& location,
                    std::map<std::string, MeshState>& states, const Points& solution, const Context& context);

/// Returns the mesh that a step works on, stored in `states` under the name of its outcome.
MeshState& state_for_outcome(const EditStep& step, std::map<std::string, MeshState>& states);

/// Returns the largest displacement of a vertex, model units; n×3 both.
double largest_displacement(const Points& rest, const Points& edited);

/// Throws Error(usage) for names in `options.keep` that the edit does not have.
void require_kept(const EditFile& edit, const RunOptions& options);

/// Runs all steps of an edit from loaded inputs, like `run_edit`. `require_kept` must hold.
EditResult run_steps(const EditFile& edit, LoadedInputs inputs, const RunOptions& options,
                     const Context& context);

}  // namespace meshgraft
