#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/edit/edit_file.h>
#include <meshgraft/edit/report.h>
#include <meshgraft/edit/run_edit.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/triage.h>

namespace meshgraft {

/// A mesh in the course of an edit.
struct Scene {
  Mesh mesh;
  Points rest;        ///< before the first step
  std::string label;  ///< the file or sample it came from
  TriageReport triage;
  std::vector<std::uint8_t> was_free;  ///< per vertex, in any step
};

/// An edit's inputs, read and checked; can be run from more than once.
struct LoadedInputs {
  std::map<std::string, Scene> scenes;  ///< by name
  std::vector<EditReport::Input> reports;
  double read_seconds = 0, triage_seconds = 0;
};

/// Throws Error(io) and Error(input), naming the input.
LoadedInputs load_inputs(const EditFile& edit, const Context& context);

/// The edit from there on, as `run_edit`.
EditResult run_steps(const EditFile& edit, LoadedInputs inputs, const RunOptions& options,
                     const Context& context);

}  // namespace meshgraft
