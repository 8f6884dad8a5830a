#include <meshgraft/script/edit_file.h>

#include "parse_parts.h"

namespace meshgraft {

using json::Object;
using json::Value;

namespace {

// A hole of more edges is no hole that a repair could close in bearable time.
constexpr Index most_hole_edges = 100'000;

std::optional<Index> parse_hole_edges(const Value& value) {
  if (value.is_string() && value.string() == "auto") return std::nullopt;
  if (!value.is_number()) value.fail_type(facts::script::Type::integer_or_auto);
  return static_cast<Index>(value.integer_in(0, most_hole_edges));
}

HoleFill parse_hole_fill(const Value& value) {
  return value.choice<HoleFill>(
      {{"plain", HoleFill::plain}, {"refined", HoleFill::refined}, {"faired", HoleFill::faired}});
}

}  // namespace

EditStep parse_repair_step(const Value& value) {
  const Object fields(
      value, {"kind", "name", "about", "mesh", "result", "remove_invalid", "clean_faces",
              "remove_duplicate_shells", "weld", "weld_distance", "split_non_manifold", "remove_debris",
              "debris_rel", "unify_winding", "hole_edges", "hole_fill", "remove_isolated"});
  RepairStep step;
  RepairOptions& options = step.options;
  step.mesh = fields.required("mesh").name();
  fields.optional("result", [&](const Value& v) { step.result = v.name(); });
  fields.optional("remove_invalid", [&](const Value& v) { options.remove_invalid = v.boolean(); });
  fields.optional("clean_faces", [&](const Value& v) { options.clean_faces = v.boolean(); });
  fields.optional("remove_duplicate_shells",
                  [&](const Value& v) { options.remove_duplicate_shells = v.boolean(); });
  fields.optional("weld", [&](const Value& v) { options.weld = v.boolean(); });
  fields.optional("weld_distance", [&](const Value& v) { options.weld_distance = v.non_negative_number(); });
  fields.optional("split_non_manifold", [&](const Value& v) { options.split_non_manifold = v.boolean(); });
  fields.optional("remove_debris", [&](const Value& v) { options.remove_debris = v.boolean(); });
  fields.optional("debris_rel", [&](const Value& v) { options.debris_rel = v.number_in(0, 1); });
  fields.optional("unify_winding", [&](const Value& v) { options.unify_winding = v.boolean(); });
  fields.optional("hole_edges", [&](const Value& v) { options.hole_edges = parse_hole_edges(v); });
  fields.optional("hole_fill", [&](const Value& v) { options.hole_fill = parse_hole_fill(v); });
  fields.optional("remove_isolated", [&](const Value& v) { options.remove_isolated = v.boolean(); });
  return {{}, {}, std::move(step)};
}

}  // namespace meshgraft
