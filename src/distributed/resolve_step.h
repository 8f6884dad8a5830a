#pragma once

#include <string>
#include <vector>

#include <meshgraft/distributed.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>

#include "local_mesh.h"

namespace meshgraft::distributed {

/// A deform step whose selections and files are replaced by the own vertices and the values they stand for.
struct ResolvedStep {
  LocalProblem problem;              ///< without positions and triangles
  std::vector<std::string> handles;  ///< names
  std::int64_t fixed = 0, held = 0;  ///< counts over all ranks
};

/// Resolves a step as `resolve_deform` does. `positions` has those of all local vertices. Throws Error(input)
/// on all ranks for errors in the step, and for what is not distributed: redrawn curves, features, symmetry,
/// proxies, refinement around handles, and welding.
ResolvedStep resolve_step(const Communicator& comm, const EditFile& edit, const DeformStep& step,
                          const LocalMesh& mesh, const Points& positions, Number face_count,
                          const Location& location);

}  // namespace meshgraft::distributed
