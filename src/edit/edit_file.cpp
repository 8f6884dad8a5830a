#include <meshgraft/edit/edit_file.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "json_value.h"
#include "parse_parts.h"

namespace meshgraft {

namespace {

using json::Object;
using json::Value;

constexpr int max_refinements = 4;

SelectionSpec::Child parse_child(const Value& value) {
  return std::make_shared<const SelectionSpec>(parse_selection(value));
}

std::vector<SelectionSpec> parse_operands(const Value& value) {
  std::vector<SelectionSpec> operands;
  for (std::size_t i = 0; i < value.size(); ++i) operands.push_back(parse_selection(value[i]));
  if (operands.empty()) value.fail("expected at least one selection");
  return operands;
}

SelectionSpec::Kind parse_box(const Value& value) {
  const Object fields(value, {"min", "max"});
  const Selection::Box box{fields.required("min").vector3(), fields.required("max").vector3()};
  if ((box.min.array() > box.max.array()).any()) value.fail("'min' is greater than 'max'");
  return box;
}

SelectionSpec::Kind parse_sphere(const Value& value) {
  const Object fields(value, {"centre", "radius"});
  return Selection::Sphere{fields.required("centre").vector3(), fields.required("radius").positive_number()};
}

SelectionSpec::Kind parse_half_space(const Value& value) {
  const Object fields(value, {"point", "normal"});
  return Selection::HalfSpace{fields.required("point").vector3(), fields.required("normal").direction()};
}

SelectionSpec::Kind parse_path(const Value& value) {
  const Object fields(value, {"points", "closed"});
  Selection::Path path;
  const Points points = fields.required("points").points(2);
  for (Eigen::Index i = 0; i < points.rows(); ++i) path.points.emplace_back(points.row(i).transpose());
  fields.optional("closed", [&](const Value& closed) { path.closed = closed.boolean(); });
  return path;
}

SelectionSpec::Kind parse_grow(const Value& value) {
  const Object fields(value, {"of", "rings"});
  return SelectionSpec::Grow{parse_child(fields.required("of")),
                             static_cast<int>(fields.required("rings").integer_in(-max_rings, max_rings))};
}

SelectionSpec::Kind parse_grow_length(const Value& value) {
  const Object fields(value, {"of", "length"});
  return SelectionSpec::GrowLength{parse_child(fields.required("of")),
                                   fields.required("length").positive_number()};
}

SelectionSpec::Kind parse_mirror(const Value& value) {
  const Object fields(value, {"of", "point", "normal", "tolerance_rel"});
  SelectionSpec::Mirror mirror{parse_child(fields.required("of")), fields.required("point").vector3(),
                               fields.required("normal").direction()};
  fields.optional("tolerance_rel", [&](const Value& v) { mirror.tolerance_rel = v.positive_number(); });
  return mirror;
}

SelectionSpec::Kind parse_rim(const Value& value) {
  const Object fields(value, {"of", "rings"});
  SelectionSpec::Rim rim{parse_child(fields.required("of"))};
  fields.optional("rings", [&](const Value& v) { rim.rings = static_cast<int>(v.integer_in(1, max_rings)); });
  return rim;
}

SelectionSpec::SelPart parse_sel_part(const Value& value) {
  using enum SelectionSpec::SelPart;
  return value.choice<SelectionSpec::SelPart>({{"fixed", fixed}, {"free", free}, {"handle", handle}});
}

SelectionSpec::Kind parse_produced(const Value& value) {
  const Object fields(value, {"step", "what"});
  return SelectionSpec::Produced{fields.required("step").name(), fields.required("what").name()};
}

}  // namespace

// One field says what kind of selection it is; `take` goes with `sel`.
SelectionSpec parse_selection(const Value& value) {
  if (value.is_string()) {
    if (value.string() == "all") return {Selection::All{}};
    return {SelectionSpec::Named{value.name()}};
  }
  using Parser = std::function<SelectionSpec::Kind(const Value&)>;
  static const std::vector<std::pair<std::string_view, Parser>> parsers = {
      {"indices", [](const Value& v) { return Selection::Indices{v.vertices()}; }},
      {"box", parse_box},
      {"sphere", parse_sphere},
      {"half_space", parse_half_space},
      {"component", [](const Value& v) { return Selection::Component{v.vertex()}; }},
      {"loop", [](const Value& v) { return Selection::Loop{v.vertex()}; }},
      {"nearest", [](const Value& v) { return Selection::NearestVertex{v.vector3()}; }},
      {"path", parse_path},
      {"file", [](const Value& v) { return SelectionSpec::IndexFile{v.name()}; }},
      {"sel", [](const Value& v) { return SelectionSpec::SelFile{v.name()}; }},
      {"produced", parse_produced},
      {"grow", parse_grow},
      {"grow_length", parse_grow_length},
      {"union", [](const Value& v) { return SelectionSpec::Union{parse_operands(v)}; }},
      {"minus", [](const Value& v) { return SelectionSpec::Minus{parse_operands(v)}; }},
      {"intersect", [](const Value& v) { return SelectionSpec::Intersect{parse_operands(v)}; }},
      {"mirror", parse_mirror},
      {"rim", parse_rim},
  };
  const Object fields(
      value, {"indices", "box", "sphere", "half_space", "component", "loop", "nearest", "path", "file", "sel",
              "take", "produced", "grow", "grow_length", "union", "minus", "intersect", "mirror", "rim"});
  const std::size_t expected_fields = fields.has("sel") ? 2 : 1;
  if (value.raw().size() != expected_fields)
    value.fail(fields.has("sel") ? "expected the fields 'sel' and 'take'"
                                 : "expected exactly one field that says what is selected",
               "Combine selections with 'union', 'minus' or 'intersect'.");
  for (const auto& [key, parser] : parsers) {
    if (!fields.has(key)) continue;
    SelectionSpec selection{parser(value.member(key))};
    if (auto* sel = std::get_if<SelectionSpec::SelFile>(&selection.kind))
      sel->take = parse_sel_part(fields.required("take"));
    return selection;
  }
  value.fail("'take' goes with 'sel'");
}

DeformerOptions parse_deformer(const Object& fields) {
  DeformerOptions options;
  OperatorOptions& operators = options.operators;
  fields.optional("method", [&](const Value& v) {
    options.method = v.choice<DeformMethod>({{"ft05", DeformMethod::ft05},
                                             {"rotation-aware", DeformMethod::rotation_aware},
                                             {"corotational", DeformMethod::corotational}});
  });
  fields.optional("stiffness", [&](const Value& v) { options.stiffness = v.number_in(0, 1e6); });
  fields.optional("iterations",
                  [&](const Value& v) { options.iterations = static_cast<int>(v.integer_in(0, 1000)); });
  fields.optional("smoothing_length_rel",
                  [&](const Value& v) { options.smoothing_length_rel = v.number_in(0, 10); });
  fields.optional("weights", [&](const Value& v) {
    operators.weights =
        v.choice<WeightScheme>({{"uniform", WeightScheme::uniform}, {"cotangent", WeightScheme::cotangent}});
  });
  fields.optional("density", [&](const Value& v) {
    operators.density = v.choice<Density>({{"ft05", Density::ft05}, {"aware", Density::aware}});
  });
  fields.optional("degenerate", [&](const Value& v) {
    operators.degenerate = v.choice<DegenerateTreatment>({{"auto", DegenerateTreatment::automatic},
                                                          {"ft05-noise", DegenerateTreatment::ft05_noise},
                                                          {"apex", DegenerateTreatment::apex}});
  });
  fields.optional("apex_height_rel", [&](const Value& v) { operators.apex_height_rel = v.positive_number(); });
  fields.optional("noise_length_rel",
                  [&](const Value& v) { operators.noise_length_rel = v.positive_number(); });
  fields.optional("flatness", [&](const Value& v) { operators.flatness = v.number_in(0, 1); });
  fields.optional("seed", [&](const Value& v) { operators.seed = v.unsigned_integer(); });
  fields.optional("laplacian_weight",
                  [&](const Value& v) { operators.laplacian_weight = v.number_in(1e-6, 1e6); });
  fields.optional("laplacian_order",
                  [&](const Value& v) { operators.laplacian_order = static_cast<int>(v.integer_in(1, 3)); });
  fields.optional("residual_corrections", [&](const Value& v) {
    options.residual_corrections = static_cast<int>(v.integer_in(0, 10));
  });
  fields.optional("backend", [&](const Value& v) {
    options.backend = v.choice<SolverBackend>({{"auto", SolverBackend::automatic},
                                               {"cholmod", SolverBackend::cholmod},
                                               {"eigen", SolverBackend::eigen}});
  });
  return options;
}

namespace {

HandleMotion parse_motion(const Object& fields) {
  HandleMotion motion;
  fields.optional("translate", [&](const Value& v) { motion.translate = v.vector3(); });
  fields.optional("rotate", [&](const Value& v) {
    const Object rotate(v, {"axis", "angle_deg"});
    motion.axis = rotate.required("axis").direction();
    motion.angle_deg = rotate.required("angle_deg").number();
  });
  fields.optional("scale", [&](const Value& v) {
    if (v.is_array())
      motion.scale = v.vector3();
    else if (v.is_number())
      motion.scale = Eigen::Vector3d::Constant(v.number());
    else
      v.fail("expected a number or 3 numbers");
  });
  fields.optional("pivot", [&](const Value& v) { motion.pivot = v.vector3(); });
  return motion;
}

PoseSpec parse_pose(const Value& value, HandleShape shape) {
  const Object fields(value, {"matrix", "def", "curve", "translate", "rotate", "scale", "pivot"});
  for (const std::string_view alone : {"matrix", "def", "curve"})
    if (fields.has(alone) && value.raw().size() > 1)
      value.fail(fmt::format("'{}' says the whole pose and goes with no other field", alone));
  if (fields.has("matrix")) return {fields.required("matrix").affine_matrix()};
  if (fields.has("def")) return {PoseSpec::DefFile{fields.required("def").name()}};
  if (fields.has("curve")) {
    if (shape != HandleShape::curve)
      fields.required("curve").fail("only a handle of shape 'curve' can be redrawn");
    return {PoseSpec::Redrawn{fields.required("curve").points(2)}};
  }
  return {parse_motion(fields)};
}

HandleShape parse_shape(const Value& value) {
  using enum HandleShape;
  return value.choice<HandleShape>({{"vertex", vertex}, {"curve", curve}, {"region", region}});
}

HandleSpec parse_handle(const Value& value) {
  const Object fields(value, {"name", "shape", "closed", "select", "constrain", "pose"});
  HandleSpec handle;
  handle.name = fields.required("name").name();
  fields.optional("shape", [&](const Value& v) { handle.shape = parse_shape(v); });
  fields.optional("closed", [&](const Value& v) {
    if (handle.shape != HandleShape::curve) v.fail("only a handle of shape 'curve' can be closed");
    handle.closed = v.boolean();
  });
  handle.select = parse_selection(fields.required("select"));
  fields.optional("constrain", [&](const Value& v) {
    enum class Constrain { both, position, transform };
    const auto what = v.choice<Constrain>(
        {{"both", Constrain::both}, {"position", Constrain::position}, {"transform", Constrain::transform}});
    handle.constrain_position = what != Constrain::transform;
    handle.constrain_transform = what != Constrain::position;
  });
  fields.optional("pose", [&](const Value& v) { handle.pose = parse_pose(v, handle.shape); });
  return handle;
}

// Refuses an element whose name an earlier one of the list has.
void require_new_name(std::set<std::string>& names, const std::string& name, const Value& value) {
  if (!names.insert(name).second) value.fail(fmt::format("the name '{}' is already taken", name));
}

std::vector<HandleSpec> parse_handles(const Value& value,
                                      const std::function<HandleSpec(const Value&)>& parse) {
  std::vector<HandleSpec> handles;
  std::set<std::string> names;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    handles.push_back(parse(element));
    require_new_name(names, handles.back().name, element.member("name"));
  }
  return handles;
}

std::vector<TargetSpec> parse_targets(const Value& value) {
  std::vector<TargetSpec> targets;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    const Object fields(element, {"vertex", "position"});
    targets.push_back({fields.required("vertex").vertex(), fields.required("position").vector3()});
  }
  return targets;
}

std::vector<TransformSpec> parse_transforms(const Value& value) {
  std::vector<TransformSpec> transforms;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    const Object fields(element, {"vertex", "matrix"});
    transforms.push_back({fields.required("vertex").vertex(), fields.required("matrix").matrix3()});
  }
  return transforms;
}

std::vector<AnchorSpec> parse_anchors(const Value& value) {
  std::vector<AnchorSpec> anchors;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    const Object fields(element, {"select", "weight"});
    AnchorSpec anchor{parse_selection(fields.required("select"))};
    fields.optional("weight", [&](const Value& v) { anchor.weight = v.positive_number(); });
    anchors.push_back(std::move(anchor));
  }
  return anchors;
}

DeformSettings parse_settings(const Value& value) {
  std::vector<std::string_view> known(deformer_fields.begin(), deformer_fields.end());
  known.emplace_back("refine_boundary");
  const Object fields(value, known);
  DeformSettings settings;
  settings.deformer = parse_deformer(fields);
  fields.optional("refine_boundary", [&](const Value& v) {
    settings.refine_boundary = static_cast<int>(v.integer_in(0, max_refinements));
  });
  return settings;
}

ExpectedCounts parse_counts(const Value& value, std::string_view region_key) {
  const Object fields(value, {"vertices", "faces", region_key, "fixed", "handle", "free"});
  ExpectedCounts counts;
  read_count(fields, "vertices", counts.vertices);
  read_count(fields, "faces", counts.faces);
  read_count(fields, region_key, counts.region);
  read_count(fields, "fixed", counts.fixed);
  read_count(fields, "handle", counts.handle);
  read_count(fields, "free", counts.free);
  return counts;
}

EditStep parse_deform_step(const Value& value) {
  const Object fields(value, {"kind", "name", "about", "mesh", "result", "region", "fixed", "handles",
                              "targets", "transforms", "anchors", "settings", "counts"});
  DeformStep step;
  step.mesh = fields.required("mesh").name();
  fields.optional("result", [&](const Value& v) { step.result = v.name(); });
  fields.optional("region", [&](const Value& v) { step.region = parse_selection(v); });
  fields.optional("fixed", [&](const Value& v) { step.fixed = parse_selection(v); });
  fields.optional("handles", [&](const Value& v) { step.handles = parse_handles(v, parse_handle); });
  fields.optional("targets", [&](const Value& v) { step.targets = parse_targets(v); });
  fields.optional("transforms", [&](const Value& v) { step.transforms = parse_transforms(v); });
  fields.optional("anchors", [&](const Value& v) { step.anchors = parse_anchors(v); });
  fields.optional("settings", [&](const Value& v) { step.settings = parse_settings(v); });
  fields.optional("counts", [&](const Value& v) { step.counts = parse_counts(v, "region"); });
  return {{}, {}, std::move(step)};
}

// The kinds of step and their parsers; one without belongs to the format, not to this version.
EditStep parse_step(const Value& value) {
  if (!value.is_object()) Object(value, {});
  if (!value.raw().contains("kind")) value.fail("the field 'kind' is missing");
  using Parser = EditStep (*)(const Value&);
  const Value kind = value.member("kind");
  const auto parser = kind.choice<Parser>({{"deform", &parse_deform_step},
                                           {"cut", &parse_cut_step},
                                           {"merge", &parse_merge_step},
                                           {"accept", nullptr}});
  if (!parser) kind.fail(fmt::format("'{}' steps are not part of this version", kind.string()));
  EditStep step = parser(value);
  if (value.raw().contains("name")) step.name = value.member("name").name();
  if (value.raw().contains("about")) step.about = value.member("about").string();
  return step;
}

std::string parse_sha256(const Value& value) {
  const std::string& digits = value.string();
  if (digits.size() != 64 || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
    value.fail("expected 64 lower-case hexadecimal digits");
  return digits;
}

EditInput parse_input(const std::string& name, const Value& value) {
  const Object fields(value, {"file", "sha256", "sample", "resolution"});
  if (fields.has("file") == fields.has("sample")) value.fail("expected one of the fields 'file' and 'sample'");
  EditInput input;
  input.name = name;
  fields.optional("file", [&](const Value& v) { input.file = v.name(); });
  fields.optional("sample", [&](const Value& v) { input.sample = v.name(); });
  fields.optional("sha256", [&](const Value& v) {
    if (input.file.empty()) v.fail("goes with 'file'");
    input.sha256 = parse_sha256(v);
  });
  fields.optional("resolution", [&](const Value& v) {
    if (input.sample.empty()) v.fail("goes with 'sample'");
    input.resolution = static_cast<int>(v.integer_in(4, 4096));
  });
  return input;
}

// Calls `visit` with every selection below and including `selection`.
void for_each_selection(const SelectionSpec& selection,
                        const std::function<void(const SelectionSpec&)>& visit) {
  visit(selection);
  std::visit(
      [&](const auto& kind) {
        if constexpr (requires { kind.of->kind; }) {
          for_each_selection(*kind.of, visit);
        } else if constexpr (requires { kind.of.size(); }) {
          for (const SelectionSpec& operand : kind.of) for_each_selection(operand, visit);
        }
      },
      selection.kind);
}

// Calls `visit` with every top-level selection of a step and the path of its field.
void for_each_step_selection(const DeformStep& step,
                             const std::function<void(const SelectionSpec&, const std::string&)>& visit) {
  visit(step.region, "region");
  if (step.fixed) visit(*step.fixed, "fixed");
  for (std::size_t i = 0; i < step.handles.size(); ++i)
    visit(step.handles[i].select, fmt::format("handles[{}].select", i));
  for (std::size_t i = 0; i < step.anchors.size(); ++i)
    visit(step.anchors[i].select, fmt::format("anchors[{}].select", i));
}

void for_each_step_selection(const MergeStep& step,
                             const std::function<void(const SelectionSpec&, const std::string&)>& visit) {
  for (std::size_t i = 0; i < step.pairs.size(); ++i) {
    visit(step.pairs[i].source_loop, fmt::format("pairs[{}].source_loop", i));
    visit(step.pairs[i].target_loop, fmt::format("pairs[{}].target_loop", i));
  }
  if (step.fixed) visit(*step.fixed, "fixed");
  for (std::size_t i = 0; i < step.features.size(); ++i)
    visit(step.features[i].select, fmt::format("features[{}].select", i));
}

void for_each_step_selection(const CutStep&,
                             const std::function<void(const SelectionSpec&, const std::string&)>&) {}

void for_each_step_selection(const EditStep& step,
                             const std::function<void(const SelectionSpec&, const std::string&)>& visit) {
  std::visit([&](const auto& action) { for_each_step_selection(action, visit); }, step.action);
}

// The fields of a step that name a mesh.
std::vector<std::pair<std::string, std::string>> mesh_fields(const EditStep& step) {
  if (const auto* merge = std::get_if<MergeStep>(&step.action))
    return {{"target", merge->target}, {"source", merge->source}};
  return {{"mesh", mesh_of(step)}};
}

template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const auto& element : list) names.push_back(element.name);
  return names;
}

[[noreturn]] void fail_unknown_name(const std::string& place, std::string_view what, const std::string& name,
                                    const std::vector<std::string>& known) {
  std::string remedy;
  if (const auto meant = json::nearest_name(name, known))
    remedy = fmt::format("Did you mean '{}'?", *meant);
  else if (!known.empty())
    remedy = fmt::format("Known are '{}'.", fmt::join(known, "', '"));
  throw Error(ErrorCode::input, fmt::format("there is no {} named '{}'", what, name), place, remedy);
}

// Selections may use each other, but not in a circle, and only so deep that resolving them is safe.
class ReferenceCheck {
 public:
  explicit ReferenceCheck(const EditFile& edit) : edit_(edit), names_(names_of(edit.selections)) {}

  void require_named(const SelectionSpec& selection, const std::string& place) {
    for_each_selection(selection, [&](const SelectionSpec& part) {
      if (const auto* named = std::get_if<SelectionSpec::Named>(&part.kind))
        if (std::find(names_.begin(), names_.end(), named->name) == names_.end())
          fail_unknown_name(place, "selection", named->name, names_);
    });
  }

  int depth(const NamedSelection& selection, int above = 0) {
    const std::string place = fmt::format("{}: selections.{}", edit_.place, selection.name);
    if (above > edit_file_depth_limit)
      throw Error(
          ErrorCode::input,
          fmt::format("selections use each other more than {} deep or in a circle", edit_file_depth_limit),
          place);
    if (const auto known = depths_.find(selection.name); known != depths_.end()) return known->second;
    require_named(selection.selection, place);
    int deepest = 0;
    for_each_selection(selection.selection, [&](const SelectionSpec& part) {
      if (const auto* named = std::get_if<SelectionSpec::Named>(&part.kind)) {
        if (named->name == selection.name) throw Error(ErrorCode::input, "a selection uses itself", place);
        const auto used = std::find(names_.begin(), names_.end(), named->name) - names_.begin();
        deepest = std::max(deepest, depth(edit_.selections[static_cast<std::size_t>(used)], above + 1));
      }
    });
    if (deepest + 1 > edit_file_depth_limit)
      throw Error(ErrorCode::input,
                  fmt::format("selections use each other more than {} deep", edit_file_depth_limit), place);
    return depths_[selection.name] = deepest + 1;
  }

 private:
  const EditFile& edit_;
  std::vector<std::string> names_;
  std::map<std::string, int> depths_;
};

// Every name that is used must mean something at that point of the edit.
void require_names(const EditFile& edit) {
  ReferenceCheck references(edit);
  for (const NamedSelection& selection : edit.selections) references.depth(selection);
  std::vector<std::string> meshes = names_of(edit.inputs);
  for (std::size_t i = 0; i < edit.steps.size(); ++i) {
    const std::string place = fmt::format("{}: steps[{}]", edit.place, i);
    for (const auto& [field, name] : mesh_fields(edit.steps[i]))
      if (std::find(meshes.begin(), meshes.end(), name) == meshes.end())
        fail_unknown_name(place + "." + field, "mesh", name, meshes);
    const std::string& outcome = outcome_of(edit.steps[i]);
    if (std::find(meshes.begin(), meshes.end(), outcome) == meshes.end()) meshes.push_back(outcome);
    for_each_step_selection(edit.steps[i], [&](const SelectionSpec& selection, const std::string& field) {
      references.require_named(selection, place + "." + field);
    });
  }
  if (!edit.output.empty() && std::find(meshes.begin(), meshes.end(), edit.output) == meshes.end())
    fail_unknown_name(edit.place + ": output", "mesh", edit.output, meshes);
}

EditFile parse_version_2(const Value& root) {
  const Object fields(
      root, {"$schema", "format", "version", "name", "about", "inputs", "selections", "steps", "output"});
  EditFile edit;
  fields.optional("$schema", [](const Value& v) { v.string(); });
  fields.optional("name", [&](const Value& v) { edit.name = v.string(); });
  fields.optional("about", [&](const Value& v) { edit.about = v.string(); });
  const Value inputs = fields.required("inputs");
  if (!inputs.is_object() || inputs.raw().empty()) inputs.fail("expected an object with at least one mesh");
  for (const auto& [name, input] : inputs.raw().items()) {
    if (name.empty()) inputs.fail("a mesh needs a name");
    edit.inputs.push_back(parse_input(name, inputs.member(name)));
  }
  fields.optional("selections", [&](const Value& selections) {
    if (!selections.is_object()) selections.fail("expected an object of named selections");
    for (const auto& [name, selection] : selections.raw().items()) {
      if (name.empty()) selections.fail("a selection needs a name");
      if (name == "all") selections.member(name).fail("'all' already means every vertex");
      edit.selections.push_back({name, parse_selection(selections.member(name))});
    }
  });
  const Value steps = fields.required("steps");
  if (steps.size() == 0) steps.fail("expected at least one step");
  std::set<std::string> step_names;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Value step = steps[i];
    edit.steps.push_back(parse_step(step));
    if (!edit.steps.back().name.empty())
      require_new_name(step_names, edit.steps.back().name, step.member("name"));
  }
  fields.optional("output", [&](const Value& v) { edit.output = v.name(); });
  return edit;
}

HandleSpec parse_handle_version_1(const Value& value) {
  const Object fields(value, {"name", "shape", "vertices", "transform"});
  HandleSpec handle;
  handle.name = fields.required("name").name();
  handle.shape = parse_shape(fields.required("shape"));
  handle.select = {Selection::Indices{fields.required("vertices").vertices()}};
  handle.pose = {fields.required("transform").affine_matrix()};
  return handle;
}

EditFile parse_version_1(const Value& root) {
  if (!root.raw().contains("kind")) root.fail("the field 'kind' is missing");
  const Value kind = root.member("kind");
  enum class Kind { deform, merge };
  if (kind.choice<Kind>({{"deform", Kind::deform}, {"merge", Kind::merge}}) == Kind::merge)
    return parse_merge_version_1(root);

  const Object fields(root, {"format", "version", "kind", "name", "about", "paper", "mesh", "counts", "roi",
                             "fixed", "handles", "expected"});
  EditFile edit;
  fields.optional("name", [&](const Value& v) { edit.name = v.string(); });
  fields.optional("about", [&](const Value& v) { edit.about = v.string(); });
  fields.optional("paper", [](const Value& v) { v.string(); });
  fields.optional("expected", [](const Value& v) {
    if (!v.is_null() && !v.is_object()) v.fail("expected an object or null");
  });
  EditInput input;
  input.name = "mesh";
  input.file = fields.required("mesh").name();
  edit.inputs.push_back(input);

  DeformStep step;
  step.mesh = input.name;
  step.settings.deformer.method = DeformMethod::ft05;
  const Value roi = fields.required("roi");
  if (roi.is_string()) {
    if (roi.string() != "all") roi.fail("expected a list of vertices or 'all'");
  } else {
    step.region = {Selection::Indices{roi.vertices()}};
  }
  step.fixed = SelectionSpec{Selection::Indices{fields.required("fixed").vertices()}};
  step.handles = parse_handles(fields.required("handles"), parse_handle_version_1);
  fields.optional("counts", [&](const Value& v) { step.counts = parse_counts(v, "roi"); });
  edit.steps.push_back({{}, {}, std::move(step)});
  return edit;
}

}  // namespace

const std::string& mesh_of(const EditStep& step) {
  const auto* merge = std::get_if<MergeStep>(&step.action);
  if (merge) return merge->target;
  const auto* cut = std::get_if<CutStep>(&step.action);
  return cut ? cut->mesh : std::get<DeformStep>(step.action).mesh;
}

const std::string& outcome_of(const EditStep& step) {
  const std::string& result =
      std::visit([](const auto& action) -> const std::string& { return action.result; }, step.action);
  return result.empty() ? mesh_of(step) : result;
}

SelectionSpec parse_selection(std::string_view text, const std::string& place) {
  const json::Json document = json::parse(text, place, edit_file_depth_limit);
  return parse_selection(Value(document, place));
}

EditFile parse_edit(std::string_view text, const std::string& place, const std::filesystem::path& base_folder) {
  if (text.size() > edit_file_size_limit)
    throw Error(ErrorCode::input, fmt::format("larger than {} MiB", edit_file_size_limit >> 20), place);
  const json::Json document = json::parse(text, place, edit_file_depth_limit);
  const Value root(document, place);
  if (!root.is_object() || !document.contains("format") || document["format"] != "meshgraft-edit")
    root.fail("not an edit file", "It begins with {\"format\": \"meshgraft-edit\", \"version\": 2, …}.");
  if (!document.contains("version")) root.fail("the field 'version' is missing");
  const Value version = root.member("version");
  const std::int64_t number = version.integer_in(0, std::numeric_limits<int>::max());
  if (number != 1 && number != 2)
    version.fail(fmt::format("version {} is not known", number), "This program reads versions 1 and 2.");

  EditFile edit = number == 1 ? parse_version_1(root) : parse_version_2(root);
  edit.place = place;
  edit.base_folder = base_folder;
  require_names(edit);
  return edit;
}

EditFile read_edit_file(const std::filesystem::path& path) {
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (!failure && size > edit_file_size_limit)
    throw Error(ErrorCode::input, fmt::format("larger than {} MiB", edit_file_size_limit >> 20), path.string());
  return parse_edit(read_file(path), path.string(), path.parent_path());
}

std::vector<std::filesystem::path> referenced_files(const EditFile& edit) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const std::string& file) {
    const std::filesystem::path path = edit.base_folder / file;
    if (std::find(files.begin(), files.end(), path) == files.end()) files.push_back(path);
  };
  const auto add_from = [&](const SelectionSpec& selection) {
    for_each_selection(selection, [&](const SelectionSpec& part) {
      if (const auto* indices = std::get_if<SelectionSpec::IndexFile>(&part.kind)) add(indices->file);
      if (const auto* sel = std::get_if<SelectionSpec::SelFile>(&part.kind)) add(sel->file);
    });
  };
  for (const EditInput& input : edit.inputs)
    if (!input.file.empty()) add(input.file);
  for (const NamedSelection& selection : edit.selections) add_from(selection.selection);
  for (const EditStep& edit_step : edit.steps) {
    for_each_step_selection(edit_step,
                            [&](const SelectionSpec& selection, const std::string&) { add_from(selection); });
    const auto* deform = std::get_if<DeformStep>(&edit_step.action);
    if (!deform) continue;
    for (const HandleSpec& handle : deform->handles)
      if (const auto* def = std::get_if<PoseSpec::DefFile>(&handle.pose.kind)) add(def->file);
  }
  return files;
}

std::string_view to_string(SelectionSpec::SelPart value) {
  switch (value) {
    case SelectionSpec::SelPart::fixed: return "fixed";
    case SelectionSpec::SelPart::free: return "free";
    case SelectionSpec::SelPart::handle: return "handle";
  }
  return "";
}

}  // namespace meshgraft
