#pragma once

#include <meshgraft/merge/merge_report.h>

#include "seam_patch.h"

namespace meshgraft {

/// Measures a finished seam. `unfaired`: the mesh's positions before its band was faired. Leaves the
/// fields about the inputs unset.
SeamReport measure_seam(const Mesh& mesh, const SeamLayout& layout, const Points& unfaired);

}  // namespace meshgraft
