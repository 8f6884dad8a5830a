#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/edit_file.h>

namespace meshgraft {

/// A published method, for comparison; `method_named` knows their names.
enum class Baseline;

/// The method that solves an edit: one of this library's methods, or a published one for comparison.
using Method = std::variant<DeformMethod, Baseline>;

/// Returns the name, such as "corotational" or "arap-2007".
std::string_view to_string(const Method& value);

/// Returns this library's methods, then the published ones.
std::vector<Method> all_methods();

/// Returns the method of that name. Throws Error(usage), listing the known names and the nearest one, for any
/// other name.
Method method_named(std::string_view name);

/// Wall-clock seconds per stage.
struct StageSeconds {
  double read = 0;
  double check = 0;     ///< checks; in merges and cuts also triangulation
  double select = 0;    ///< resolving selections and poses, triangulation, boundary refinement
  double match = 0;     ///< matching of loops
  double assemble = 0;  ///< set-up other than `analyse` and `factorise`
  double analyse = 0;
  double factorise = 0;
  double solve = 0;
  double seam = 0;
  double retry = 0;    ///< further grafts, because the first one had faults at its seam
  double measure = 0;  ///< residual, conditioning, quality
  double write = 0;
  double total = 0;
};

struct DeformCounts {
  Index vertices = 0, faces = 0;  ///< counts of the mesh
  Index free = 0, fixed = 0, handle = 0, degenerate = 0;
};

/// The decimated proxy that was solved in place of a region.
struct ProxyReport {
  Index vertices = 0;       ///< vertices of the proxy, including those around the region
  Index free_vertices = 0;  ///< proxy vertices whose position was solved for
  double spacing = 0;       ///< edge length for which the proxy was made, model units
};

/// Handles and vertices that the symmetry of a step concerns.
struct SymmetryReport {
  Eigen::Affine3d reflection = Eigen::Affine3d::Identity();
  /// Per twin: index of its handle; twins come after all handles of the step.
  std::vector<std::size_t> twin_of;
  std::vector<std::size_t> own;  ///< indices of handles that are their own mirror image
  Index without_partner = 0;     ///< vertices of the region without a mirror partner
};

/// Results of a merge step other than the mesh.
struct MergeOutcome {
  std::string source;  ///< name of the mesh that was grafted
  /// Its pose before the merge, as the step defines it.
  Eigen::Affine3d posing = Eigen::Affine3d::Identity();
  std::optional<Preset> preset;  ///< preset that was used
  MergeOptions options;          ///< options that were used
  MergeReport report;
  IndexMap target_map, source_map;  ///< vertices, old → new, or -1 where one was removed
  std::vector<Index> new_faces;
  Points grafted;  ///< the source's positions after the solve, before the seam (n×3)
  MergeIntersections intersections;
  /// The plane that opened a closed source, in its coordinates after the pose; its height in units of before.
  std::optional<BaseReport> base;
};

/// Results of a cut step other than the mesh.
struct CutOutcome {
  CutOptions options;
  std::vector<std::vector<Index>> loops;  ///< boundary loops that the cut made
  IndexMap map;                           ///< vertices, old → new
  TopologySummary topology;               ///< topology of the mesh that was kept
  std::vector<CutPin> pins;
};

/// Results of a repair step other than the mesh.
struct RepairOutcome {
  RepairOptions options;
  std::vector<RepairChange>
      changes;   ///< changes in the order of the repair; empty: there was nothing to repair
  IndexMap map;  ///< vertices, old → new, or -1 where one was removed
};

/// Results of a sculpt step other than the mesh.
struct SculptOutcome {
  SculptAction action = SculptAction::smooth;
  Index region = 0;             ///< number of vertices of the region
  double max_displacement = 0;  ///< model units
  /// Pairs of faces that intersect now and did not before.
  std::int64_t new_self_intersections = 0;
};

/// Report on one step. A step of another kind than a deformation has its own record; fields that concern only
/// deforming then keep their defaults.
struct StepReport {
  std::string name;
  std::string mesh;    ///< mesh that the step worked on; for a merge, its target
  std::string result;  ///< mesh that the step produced
  std::optional<MergeOutcome> merge;
  std::optional<CutOutcome> cut;
  std::optional<RepairOutcome> repair;
  std::optional<SculptOutcome> sculpt;
  std::optional<Eigen::Affine3d> transform;  ///< the map of a transform step
  Method method;
  DeformSettings settings;  ///< a published method uses only the backend and `refine_boundary`
  DeformCounts counts;
  StageSeconds seconds;
  SolverStatistics solver;
  /// Absent for a published method, whose `solver` keeps its defaults.
  std::optional<EvaluationReport> evaluation;
  std::optional<double> condition_estimate;  ///< condition number of AᵀA; absent if not asked for
  /// Absent where the region itself was solved. If present, `solver` and `evaluation` describe the solve on
  /// the proxy.
  std::optional<ProxyReport> proxy;
  Index refined_vertices = 0;              ///< vertices that `refine_boundary` added for the solve
  std::optional<SymmetryReport> symmetry;  ///< of a deform or sculpt step; absent if not asked for
  std::vector<std::string> handles;        ///< names; twins follow the step's own handles
  double max_displacement = 0;             ///< model units
  Quality quality;
  std::vector<Note> notes;  ///< about deviations from the request

  bool is_deform() const { return !merge && !cut && !repair && !sculpt && !transform; }
  /// Returns whether the result has other vertices and faces than the mesh that the step worked on.
  bool replaces_mesh() const { return merge || cut || (repair && !repair->changes.empty()); }
};

/// Report on a whole edit. Fields other than `steps` summarise the steps as docs/report.md says.
struct EditReport {
  std::string edit;                  ///< the edit file
  std::vector<std::string> outputs;  ///< files written
  /// Notes on words of the edit file, and on data that the result's file cannot store.
  std::vector<Note> notes;
  struct Input {
    std::string name, source;  ///< `source`: the file or sample
    Index vertices = 0, faces = 0;
    Diagnostics diagnostics;
  };
  std::vector<Input> inputs;
  std::vector<StepReport> steps;
  DeformCounts counts;                         ///< counts of the step with the most free vertices
  StageSeconds seconds;                        ///< sums over the steps
  SolverStatistics solver;                     ///< statistics of the step with the most free vertices
  std::optional<EvaluationReport> evaluation;  ///< the largest residual and deviation of the steps
  std::optional<double> condition_estimate;    ///< the largest of the steps
  bool deformed = false;                       ///< whether the next two are defined: a deform step came last
  double max_displacement = 0;                 ///< relative to `EditResult::rest`, model units
  Quality quality;                             ///< quality of the result against `EditResult::rest`
};

/// Returns the report as JSON (docs/report.md). Non-finite numbers are written as null. Sentences are in the
/// words of an interface.
std::string write_report(const EditReport& report, const Wording& wording = library_text);

/// Returns the findings as a JSON list, with up to ten indices each.
std::string write_diagnostics(const Diagnostics& diagnostics, const Wording& wording = library_text);

}  // namespace meshgraft
