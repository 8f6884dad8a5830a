#include <meshgraft/script/edit_file.h>

#include "parse_parts.h"
#include "script/facts.h"

namespace meshgraft {

using json::Object;
using json::Value;

EditStep parse_sculpt_step(const Value& value) {
  const Object fields(value, {"kind", "name", "about", "mesh", "result", "action", "region", "strength",
                              "height", "reach", "symmetry"});
  SculptStep step;
  step.mesh = fields.required("mesh").name();
  fields.optional("result", [&](const Value& v) { step.result = v.name(); });
  step.action = fields.required("action").choice<SculptAction>({{"smooth", SculptAction::smooth},
                                                                {"inflate", SculptAction::inflate},
                                                                {"flatten", SculptAction::flatten}});
  step.region = parse_selection(fields.required("region"));
  const bool inflates = step.action == SculptAction::inflate;
  for (const char* field : {"strength", "height"})
    if (fields.has(field) && inflates != (std::string_view(field) == "height"))
      fields.required(field).fail(facts::script::FieldNeedsField{
          .field = field, .needed = inflates ? "action: smooth or flatten" : "action: inflate"});
  fields.optional("strength", [&](const Value& v) { step.strength = v.number_in(0, 1); });
  if (inflates) step.height = fields.required("height").number();
  if (step.action == SculptAction::smooth && fields.has("reach"))
    fields.required("reach").fail(
        facts::script::FieldNeedsField{.field = "reach", .needed = "action: inflate or flatten"});
  fields.optional("reach", [&](const Value& v) { step.reach = v.non_negative_number(); });
  fields.optional("symmetry", [&](const Value& v) { step.symmetry = parse_symmetry(v); });
  return {{}, {}, std::move(step)};
}

}  // namespace meshgraft
