#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <meshgraft/merge/correspondence.h>
#include <meshgraft/script/report.h>

#include "objects.h"

namespace meshgraft::editor {

/// What a graft came to, with the meshes that it joined.
struct ShownGraft {
  const Object& target;
  const Object& source;
  const Mesh& mesh;  ///< that was made
  const StepReport& report;
  std::int64_t number = 0;
  bool dragged = false;
};

/// The mesh that was made, what of it is whose, and lines from the source's loops to where they come to lie.
std::vector<std::byte> graft_frame(const ShownGraft& graft);

/// The fields of the event `graft`.
Json graft_fields(const ShownGraft& graft);

/// The field `open_starts` of the event.
Json open_starts_json(const std::vector<OpenStart>& starts);

/// What `Stage::found` tells.
Json found_json(const MergeOutcome& merge);

/// Rows of a 4×4 matrix.
Json matrix_json(const Eigen::Affine3d& map);

}  // namespace meshgraft::editor
