#include <meshgraft/merge/merge_options.h>

namespace meshgraft {

std::string_view to_string(MergePose value) {
  switch (value) {
    case MergePose::find: return "find";
    case MergePose::keep: return "keep";
  }
  return "";
}

std::string_view to_string(MergeShape value) {
  switch (value) {
    case MergeShape::ft05: return "ft05";
    case MergeShape::similar: return "similar";
  }
  return "";
}

}  // namespace meshgraft
