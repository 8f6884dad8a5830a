#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>

namespace meshgraft {

/// Settings that replace those of every step.
struct SettingsOverrides {
  std::optional<Preset> preset;  ///< replaces all settings but `backend`, `refine_boundary` and `weld`
  std::optional<Method> method;
  std::optional<double> stiffness;
  std::optional<int> iterations;
  std::optional<WeightScheme> weights;
  std::optional<Density> density;
  std::optional<DegenerateTreatment> degenerate;
  std::optional<SolverBackend> backend;
  std::optional<Index> proxy;
  std::optional<MergeShape> shape;
};

struct RunOptions {
  SettingsOverrides overrides;
  bool estimate_condition = false;  ///< costs up to ten solves
  /// Memory that a solve may take, bytes. A region that needs more is solved on a decimated proxy, and a note
  /// reports that. Absent: the memory that the machine and the limits of the process allow.
  std::optional<std::uint64_t> memory{};
  /// If set, a merge whose result intersects itself where it did not before fails with Error(unsolvable),
  /// instead of adding a note.
  bool strict = false;
  /// Names of meshes to return in addition to the result.
  std::vector<std::string> keep{};
};

struct EditResult {
  Mesh mesh;    ///< the edit's output; without cuts and merges it has the topology and order of its input
  Points rest;  ///< n×3, positions before the edit, or after the last cut or merge
  EditReport report;
  std::map<std::string, Mesh> kept{};  ///< the meshes of `RunOptions::keep` after the last step
};

/// Reads one of an edit's inputs. Throws Error(io) and Error(input), naming the input.
Mesh load_input(const EditInput& input, const EditFile& edit, const Context& context = {});

/// Runs an edit: reads its inputs, checks them, runs the steps in order. Writes nothing. The result depends
/// on the edit and its inputs alone, to the bit, not on `context`. Throws Error(io) and Error(input) for
/// files and fields (naming them), Error(usage) for names in `keep` that the edit does not have,
/// Error(unsolvable) where a step has no unique solution, Error(cancelled).
EditResult run_edit(const EditFile& edit, const RunOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
