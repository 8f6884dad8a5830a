#pragma once

#include <optional>
#include <string>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/edit/edit_file.h>
#include <meshgraft/edit/method.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/triage.h>

namespace meshgraft {

/// Wall-clock seconds per stage.
struct StageSeconds {
  double read = 0;
  double triage = 0;    ///< with triangulation
  double select = 0;    ///< resolving selections and poses, boundary refinement
  double assemble = 0;  ///< all of the set-up but the next two
  double analyse = 0;
  double factorise = 0;
  double basis = 0;  ///< columns that make later evaluations cheap
  double solve = 0;
  double measure = 0;  ///< residual, conditioning, quality
  double write = 0;
  double total = 0;
};

struct DeformCounts {
  Index vertices = 0, faces = 0;  ///< of the mesh
  Index free = 0, fixed = 0, handle = 0, degenerate = 0;
};

/// What one deform step did.
struct StepReport {
  std::string name;
  std::string mesh;
  Method method;
  DeformSettings settings;  ///< of which a published method takes the backend and `refine_boundary`
  DeformCounts counts;
  StageSeconds seconds;
  SolverStatistics solver;
  std::optional<EvaluationReport> evaluation;  ///< absent, as what tells of the solver, for a published method
  std::optional<double> condition_estimate;    ///< of AᵀA; absent if it was not asked for
  double max_displacement = 0;                 ///< model units
  Quality quality;
  std::vector<std::string> notes;  ///< sentences for people about what went another way than asked
};

/// What a whole edit did. Fields beside `steps` sum them up as docs/report.md says.
struct EditReport {
  std::string edit;                  ///< the edit file
  std::vector<std::string> outputs;  ///< files that were written
  struct Input {
    std::string name, source;  ///< `source`: file or sample
    Index vertices = 0, faces = 0;
    TriageReport triage;
  };
  std::vector<Input> inputs;
  std::vector<StepReport> steps;
  DeformCounts counts;                         ///< of the step with the most free vertices
  StageSeconds seconds;                        ///< sums
  SolverStatistics solver;                     ///< of the step with the most free vertices
  std::optional<EvaluationReport> evaluation;  ///< the largest residual and deviation
  std::optional<double> condition_estimate;    ///< the largest
  double max_displacement = 0;                 ///< from the result mesh's input, model units
  Quality quality;                             ///< the result against its input
};

/// The report as JSON (docs/report.md). Non-finite numbers are written as null.
std::string write_report(const EditReport& report);

/// The findings as a JSON list; up to `index_limit` indices each.
std::string write_triage(const TriageReport& triage, std::size_t index_limit = 10);

}  // namespace meshgraft
