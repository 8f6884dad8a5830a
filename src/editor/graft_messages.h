#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/script/report.h>

#include "objects.h"

namespace meshgraft::editor {

/// The result of a graft and the meshes that it joined.
struct ShownGraft {
  const Object& target;
  const Object& source;
  const Mesh& mesh;  ///< the joined mesh
  const StepReport& report;
  std::int64_t number = 0;
  bool dragged = false;
};

/// Returns a message with the joined mesh, its shape before the deformation, the origin of its triangles, and
/// lines from the source's loops to their positions in the result. Its textures are those of the two meshes.
std::vector<std::byte> graft_frame(const ShownGraft& graft);

/// Returns the fields of the event `graft`.
Json graft_fields(const ShownGraft& graft);

/// Returns an element of `StepInputs::found`.
Json found_json(const MergeOutcome& merge);
/// The largest displacement of a sculpt step, in model units.
Json found_json(const SculptOutcome& sculpt, std::span<const Note> notes);
/// Contains the notes on caps and pins.
Json found_json(const CutOutcome& cut, std::span<const Note> notes);
Json found_json(const RepairOutcome& repair, std::span<const Note> notes);

/// Returns the rows of a 4×4 matrix.
Json matrix_json(const Eigen::Affine3d& map);

}  // namespace meshgraft::editor
