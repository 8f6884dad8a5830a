#include <functional>
#include <utility>
#include <vector>

#include <meshgraft/script/edit_file.h>

#include "parse_parts.h"
#include "script/facts.h"
#include "select/facts.h"

namespace meshgraft {

namespace {

using json::Object;
using json::Value;

EditSelection::Child parse_child(const Value& value) {
  return std::make_shared<const EditSelection>(parse_selection(value));
}

std::vector<EditSelection> parse_operands(const Value& value) {
  std::vector<EditSelection> operands;
  for (std::size_t i = 0; i < value.size(); ++i) operands.push_back(parse_selection(value[i]));
  if (operands.empty()) value.fail(facts::script::EmptyList{.what = facts::script::Element::selection});
  return operands;
}

EditSelection::Kind parse_box(const Value& value) {
  const Object fields(value, {"min", "max"});
  Selection::Box box{fields.required("min").vector3(), fields.required("max").vector3()};
  if ((box.min.array() > box.max.array()).any()) value.fail(facts::select::BoxReversed{});
  return box;
}

EditSelection::Kind parse_sphere(const Value& value) {
  const Object fields(value, {"centre", "radius"});
  return Selection::Sphere{fields.required("centre").vector3(), fields.required("radius").positive_number()};
}

EditSelection::Kind parse_half_space(const Value& value) {
  const Object fields(value, {"point", "normal"});
  return Selection::HalfSpace{{fields.required("point").vector3(), fields.required("normal").direction()}};
}

EditSelection::Kind parse_path(const Value& value) {
  const Object fields(value, {"points", "closed"});
  Selection::Path path;
  const Points points = fields.required("points").points(2);
  for (Eigen::Index i = 0; i < points.rows(); ++i) path.points.emplace_back(points.row(i).transpose());
  fields.optional("closed", [&](const Value& closed) { path.closed = closed.boolean(); });
  return path;
}

EditSelection::Kind parse_grow(const Value& value) {
  const Object fields(value, {"of", "rings"});
  return EditSelection::Grow{parse_child(fields.required("of")),
                             static_cast<int>(fields.required("rings").integer_in(-max_rings, max_rings))};
}

EditSelection::Kind parse_grow_length(const Value& value) {
  const Object fields(value, {"of", "length"});
  return EditSelection::GrowLength{parse_child(fields.required("of")),
                                   fields.required("length").positive_number()};
}

EditSelection::Kind parse_mirror(const Value& value) {
  const Object fields(value, {"of", "point", "normal", "tolerance_rel"});
  EditSelection::Mirror mirror{parse_child(fields.required("of")),
                               {fields.required("point").vector3(), fields.required("normal").direction()}};
  fields.optional("tolerance_rel", [&](const Value& v) { mirror.tolerance_rel = v.positive_number(); });
  return mirror;
}

EditSelection::Kind parse_rim(const Value& value) {
  const Object fields(value, {"of", "rings"});
  EditSelection::Rim rim{parse_child(fields.required("of"))};
  fields.optional("rings", [&](const Value& v) { rim.rings = static_cast<int>(v.integer_in(1, max_rings)); });
  return rim;
}

EditSelection::SelRole parse_sel_role(const Value& value) {
  using enum EditSelection::SelRole;
  return value.choice<EditSelection::SelRole>({{"fixed", fixed}, {"free", free}, {"handle", handle}});
}

EditSelection::Kind parse_produced(const Value& value) {
  const Object fields(value, {"step", "what"});
  return EditSelection::Produced{fields.required("step").name(), fields.required("what").name()};
}

}  // namespace

// Parses a selection. One field names its kind; only `sel` needs a second field, `take`.
EditSelection parse_selection(const Value& value) {
  if (value.is_string()) {
    if (value.string() == "all") return {Selection::All{}};
    return {EditSelection::Named{value.name()}};
  }
  using Parser = std::function<EditSelection::Kind(const Value&)>;
  static const std::vector<std::pair<std::string_view, Parser>> parsers = {
      {"indices", [](const Value& v) { return Selection::Indices{v.vertices()}; }},
      {"box", parse_box},
      {"sphere", parse_sphere},
      {"half_space", parse_half_space},
      {"component", [](const Value& v) { return Selection::Component{v.vertex()}; }},
      {"loop", [](const Value& v) { return Selection::Loop{v.vertex()}; }},
      {"nearest", [](const Value& v) { return Selection::NearestVertex{v.vector3()}; }},
      {"path", parse_path},
      {"file", [](const Value& v) { return EditSelection::IndexFile{v.name()}; }},
      {"sel", [](const Value& v) { return EditSelection::SelFile{v.name()}; }},
      {"produced", parse_produced},
      {"grow", parse_grow},
      {"grow_length", parse_grow_length},
      {"union", [](const Value& v) { return EditSelection::Union{parse_operands(v)}; }},
      {"minus", [](const Value& v) { return EditSelection::Minus{parse_operands(v)}; }},
      {"intersect", [](const Value& v) { return EditSelection::Intersect{parse_operands(v)}; }},
      {"mirror", parse_mirror},
      {"rim", parse_rim},
  };
  const Object fields(
      value, {"indices", "box", "sphere", "half_space", "component", "loop", "nearest", "path", "file", "sel",
              "take", "produced", "grow", "grow_length", "union", "minus", "intersect", "mirror", "rim"});
  if (fields.has("sel") && value.raw().size() != 2) value.fail(facts::script::NotSelAndTake{});
  if (!fields.has("sel") && value.raw().size() != 1) value.fail(facts::script::NotOneSelection{});
  for (const auto& [key, parser] : parsers) {
    if (!fields.has(key)) continue;
    EditSelection selection{parser(value.member(key))};
    if (auto* sel = std::get_if<EditSelection::SelFile>(&selection.kind))
      sel->take = parse_sel_role(fields.required("take"));
    return selection;
  }
  value.fail(facts::script::FieldNeedsField{.field = "take", .needed = "sel"});
}

EditSelection parse_selection(std::string_view text, const std::string& location) {
  const json::Json document = json::parse(text, Location::file(location), edit_file_depth_limit);
  return parse_selection(Value(document, location));
}

}  // namespace meshgraft
