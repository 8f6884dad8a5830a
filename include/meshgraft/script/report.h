#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/method.h>
#include <meshgraft/script/resolve_deform.h>

namespace meshgraft {

/// Wall-clock seconds per stage.
struct StageSeconds {
  double read = 0;
  double check = 0;     ///< with triangulation, of merges and cuts
  double select = 0;    ///< resolving selections and poses, triangulation, boundary refinement
  double match = 0;     ///< of loops
  double assemble = 0;  ///< all of the set-up but the next two
  double analyse = 0;
  double factorise = 0;
  double basis = 0;  ///< columns that make later evaluations cheap
  double solve = 0;
  double seam = 0;
  double measure = 0;  ///< residual, conditioning, quality
  double write = 0;
  double total = 0;
};

struct DeformCounts {
  Index vertices = 0, faces = 0;  ///< of the mesh
  Index free = 0, fixed = 0, handle = 0, degenerate = 0;
};

/// The decimated proxy that was solved in a region's place.
struct ProxyFacts {
  Index vertices = 0;       ///< with those around the region
  Index free_vertices = 0;  ///< of them, those that were solved for
  double spacing = 0;       ///< edge length that it was made for, model units
};

/// What a merge step did beside moving vertices.
struct MergeOutcome {
  std::string source;                                    ///< name of the mesh that was grafted
  Eigen::Affine3d posing = Eigen::Affine3d::Identity();  ///< of it, before it was merged, as the step says
  MergeOptions options;                                  ///< in force
  MergeReport report;
  IndexMap target_map, source_map;  ///< vertices of the two, old → new, -1 where one was removed
  std::vector<Index> new_faces;
  Points grafted;  ///< the source's vertices after the solve, before the seam (n×3)
  /// Pairs of faces of the result that intersect, a vertex of the source or of the seam among theirs.
  std::int64_t self_intersections = 0;
  std::int64_t source_self_intersections = 0;  ///< that the source had already; 0 if the result has none
};

/// What a cut step did.
struct CutOutcome {
  CutOptions options;
  std::vector<std::vector<Index>> loops;  ///< that the cut made
  IndexMap map;                           ///< vertices, old → new
  TopologySummary topology;               ///< of what was kept
};

/// What one step did. A cut or a merge has its own part; what is of deforming alone is then as it begins.
struct StepReport {
  std::string name;
  std::string mesh;    ///< that it worked on; a merge's target
  std::string result;  ///< that it left
  std::optional<MergeOutcome> merge;
  std::optional<CutOutcome> cut;
  Method method;
  DeformSettings settings;  ///< of which a published method takes the backend and `refine_boundary`
  DeformCounts counts;
  StageSeconds seconds;
  SolverStatistics solver;
  std::optional<EvaluationReport> evaluation;  ///< absent, as what tells of the solver, for a published method
  std::optional<double> condition_estimate;    ///< of AᵀA; absent if it was not asked for
  /// Absent where the region itself was solved; else what tells of the solver and the solve is the proxy's.
  std::optional<ProxyFacts> proxy;
  std::optional<SymmetryFacts> symmetry;  ///< absent where none was asked for
  std::vector<std::string> handles;       ///< names, those of twins behind the step's own
  double max_displacement = 0;            ///< model units
  Quality quality;
  std::vector<std::string> notes;  ///< sentences for people about what went another way than asked
};

/// What a whole edit did. Fields beside `steps` sum them up as docs/report.md says.
struct EditReport {
  std::string edit;                  ///< the edit file
  std::vector<std::string> outputs;  ///< files that were written
  std::vector<std::string>
      notes;  ///< on words of the edit file, and on what the result's file has no place for
  struct Input {
    std::string name, source;  ///< `source`: file or sample
    Index vertices = 0, faces = 0;
    Diagnostics diagnostics;
  };
  std::vector<Input> inputs;
  std::vector<StepReport> steps;
  DeformCounts counts;                         ///< of the step with the most free vertices
  StageSeconds seconds;                        ///< sums
  SolverStatistics solver;                     ///< of the step with the most free vertices
  std::optional<EvaluationReport> evaluation;  ///< the largest residual and deviation
  std::optional<double> condition_estimate;    ///< the largest
  bool deformed = false;                       ///< whether the next two tell anything: a deform step came last
  double max_displacement = 0;                 ///< from `EditResult::rest`, model units
  Quality quality;                             ///< the result against `EditResult::rest`
};

/// The report as JSON (docs/report.md). Non-finite numbers are written as null.
std::string write_report(const EditReport& report);

/// The findings as a JSON list; up to `index_limit` indices each.
std::string write_diagnostics(const Diagnostics& diagnostics, std::size_t index_limit = 10);

}  // namespace meshgraft
