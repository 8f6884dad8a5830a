#include <meshgraft/script/edit_file.h>

#include "parse_parts.h"

namespace meshgraft {

using json::Object;
using json::Value;

EditStep parse_transform_step(const Value& value) {
  const Object fields(value, {"kind", "name", "about", "mesh", "result", "pose"});
  TransformStep step;
  step.mesh = fields.required("mesh").name();
  fields.optional("result", [&](const Value& v) { step.result = v.name(); });
  const Value pose = fields.required("pose");
  step.pose = parse_affine_pose(Object(pose, affine_fields), pose);
  return {{}, {}, std::move(step)};
}

}  // namespace meshgraft
