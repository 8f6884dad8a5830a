#include <meshgraft/merge/merge_options.h>

namespace meshgraft {

std::string_view to_string(MergePose value) {
  switch (value) {
    case MergePose::find: return "find";
    case MergePose::keep: return "keep";
  }
  return "";
}

std::string_view to_string(FairingMethod value) {
  return value == FairingMethod::umbrella ? "umbrella" : "curvature";
}

// All values that matter are named, so that a changed default changes nothing here.
MergeOptions MergeOptions::as_published() {
  return {.shape = MergeShape::ft05,
          .deformer = DeformerOptions::as_published(),
          .seam = {.strip = StripMethod::greedy,
                   .edge_ratio = 2,
                   .refine_radius = false,
                   .fairing_method = FairingMethod::umbrella,
                   .fairings = 3,
                   .target_rings = 3,
                   .source_rings = 3,
                   .sharp_angle_deg = 180}};
}

std::string_view to_string(MergeShape value) {
  switch (value) {
    case MergeShape::ft05: return "ft05";
    case MergeShape::similar: return "similar";
  }
  return "";
}

}  // namespace meshgraft
