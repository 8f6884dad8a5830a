#pragma once

#include <optional>
#include <string>

#include <meshgraft/core/context.h>
#include <meshgraft/edit/edit_file.h>
#include <meshgraft/edit/method.h>
#include <meshgraft/edit/report.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Settings that replace those of every step.
struct SettingsOverrides {
  std::optional<Method> method;
  std::optional<double> stiffness;
  std::optional<int> iterations;
  std::optional<WeightScheme> weights;
  std::optional<Density> density;
  std::optional<DegenerateTreatment> degenerate;
  std::optional<SolverBackend> backend;
};

struct RunOptions {
  SettingsOverrides overrides;
  bool estimate_condition = true;  ///< costs a few solves
};

struct EditResult {
  Mesh mesh;    ///< the edit's output, with the topology, order and attributes of its input
  Points rest;  ///< n×3, its positions before the edit
  EditReport report;
};

/// Runs an edit: reads its inputs, checks them, runs the steps in order. Writes nothing. The result depends on
/// the edit and its inputs alone, to the bit, not on `context`.
/// Throws Error(io) and Error(input) for files and fields (naming them), Error(unsolvable) where a step has no
/// unique solution, Error(cancelled).
EditResult run_edit(const EditFile& edit, const RunOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
