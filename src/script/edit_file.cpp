#include <meshgraft/script/edit_file.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>
#include <meshgraft/io/mesh_io.h>

#include "io/file.h"
#include "json_value.h"
#include "mesh/facts.h"
#include "parse_parts.h"
#include "script/facts.h"
#include "settings_json.h"

namespace meshgraft {

namespace {

using json::Object;
using json::Value;

// Parses a step by its kind. A kind without a parser belongs to the format but not to this version.
EditStep parse_step(const Value& value) {
  if (!value.is_object()) Object(value, {});
  if (!value.raw().contains("kind")) value.fail(facts::script::MissingField{.field = "kind"});
  using Parser = EditStep (*)(const Value&);
  const Value kind = value.member("kind");
  const auto parser = kind.choice<Parser>({{"deform", &parse_deform_step},
                                           {"cut", &parse_cut_step},
                                           {"merge", &parse_merge_step},
                                           {"repair", &parse_repair_step},
                                           {"transform", &parse_transform_step},
                                           {"sculpt", &parse_sculpt_step},
                                           {"accept", nullptr}});
  if (!parser) kind.fail(facts::script::UnsupportedStep{.kind = kind.string()});
  EditStep step = parser(value);
  if (value.raw().contains("name")) step.name = value.member("name").name();
  if (value.raw().contains("about")) step.about = value.member("about").string();
  return step;
}

// Notes words of earlier versions in a step that was read.
void note_former_words(const Value& step, std::vector<Note>& notes) {
  if (!step.raw().contains("settings")) return;
  const Value settings = step.member("settings");
  if (settings.raw().contains("backend") && settings.raw().at("backend") == former_multifrontal)
    notes.push_back(facts::script::FormerBackend{.location = settings.member("backend").location().text(),
                                                 .former = former_multifrontal,
                                                 .name = "multifrontal"});
  if (settings.raw().contains(former_fairings))
    notes.push_back(facts::script::FormerSetting{
        .location = settings.location().text(), .former = former_fairings, .name = "fairings"});
}

// Returns a version, which notes and messages show as it is.
std::string parse_version(const Value& value) {
  const std::string& version = value.string();
  constexpr std::size_t most = 64;
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  if (version.empty() || version.size() > most || !std::ranges::all_of(version, is_printable))
    value.fail(facts::script::NotAVersion{.most = most});
  return version;
}

MadeWith parse_made_with(const Value& value) {
  const Object fields(value, {"version", "methods"});
  return {parse_version(fields.required("version")),
          static_cast<int>(fields.required("methods").integer_in(1, std::numeric_limits<int>::max()))};
}

// Returns whether a step has the settings of FT05 as written, but for its seed, backend and welding, or none.
bool is_as_published(const EditStep& step) {
  const auto published = [](const DeformerOptions& given) {
    DeformerOptions options = DeformerOptions::as_published();
    options.backend = given.backend;
    options.operators.seed = given.operators.seed;
    return options;
  };
  if (const auto* deform = std::get_if<DeformStep>(&step.action)) {
    DeformSettings settings = deform->settings;
    settings.deformer = published(settings.deformer);
    settings.refine_boundary = 0;
    settings.proxy = 0;
    return settings.preset && settings_json(settings) == settings_json(deform->settings);
  }
  if (const auto* merge = std::get_if<MergeStep>(&step.action)) {
    MergeSettings settings = merge->settings;
    settings.deformer = published(settings.deformer);
    settings.seam = MergeOptions::as_published().seam;
    return settings.preset && merge->shape == MergeShape::ft05 &&
           settings_json(settings) == settings_json(merge->settings);
  }
  return true;
}

// Notes if an edit was made with methods whose results may differ from those of this library.
void note_other_methods(EditFile& edit) {
  if (!edit.made_with || edit.made_with->methods == current_methods) return;
  if (std::all_of(edit.steps.begin(), edit.steps.end(), is_as_published)) return;
  edit.notes.push_back(facts::script::OtherMethods{
      .version = edit.made_with->version, .methods = edit.made_with->methods, .current = current_methods});
}

std::string parse_sha256(const Value& value) {
  const std::string& digits = value.string();
  if (digits.size() != 64 || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
    value.fail(facts::script::NotASha256{});
  return digits;
}

// Parses a direction: the name of an axis, such as "z" or "-y", or a vector.
Eigen::Vector3d parse_direction(const Value& value) {
  if (!value.is_string()) return value.direction();
  const std::optional<Eigen::Vector3d> axis = axis_named(value.string());
  if (!axis) value.fail(facts::script::NotADirection{});
  return *axis;
}

Orientation parse_orientation(const Object& fields, const Value& input) {
  for (const auto& [field, needed] : {std::pair("up", "front"), std::pair("front", "up")})
    if (!fields.has(needed)) input.fail(facts::script::FieldNeedsField{.field = field, .needed = needed});
  try {
    return make_orientation(parse_direction(fields.required("up")), parse_direction(fields.required("front")));
  } catch (const Error& error) {
    if (error.id() != facts::mesh::OrientationUndefined::id) throw;
    throw error.at(input.location());
  }
}

EditInput parse_input(const std::string& name, const Value& value) {
  const Object fields(value, {"file", "sha256", "sample", "resolution", "up", "front"});
  if (fields.has("file") == fields.has("sample"))
    value.fail(facts::script::NotOneOf{.names = std::array{"file", "sample"}});
  EditInput input;
  input.name = name;
  fields.optional("file", [&](const Value& v) { input.file = v.name(); });
  fields.optional("sample", [&](const Value& v) { input.sample = v.name(); });
  fields.optional("sha256", [&](const Value& v) {
    if (input.file.empty()) v.fail(facts::script::FieldNeedsField{.field = "sha256", .needed = "file"});
    input.sha256 = parse_sha256(v);
  });
  fields.optional("resolution", [&](const Value& v) {
    if (input.sample.empty()) v.fail(facts::script::FieldNeedsField{.field = "resolution", .needed = "sample"});
    input.resolution = static_cast<int>(v.integer_in(4, 4096));
  });
  if (fields.has("up") || fields.has("front")) input.orientation = parse_orientation(fields, value);
  return input;
}

std::string parse_colour(const Value& value) {
  const std::string& colour = value.string();
  if (colour.size() != 7 || colour[0] != '#' ||
      colour.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
    value.fail(facts::script::NotAColour{});
  return colour;
}

// Calls `visit` with `selection` and every selection below it.
void for_each_selection(const EditSelection& selection,
                        const std::function<void(const EditSelection&)>& visit) {
  visit(selection);
  std::visit(
      [&](const auto& kind) {
        if constexpr (requires { kind.of->kind; }) {
          for_each_selection(*kind.of, visit);
        } else if constexpr (requires { kind.of.size(); }) {
          for (const EditSelection& operand : kind.of) for_each_selection(operand, visit);
        }
      },
      selection.kind);
}

// Calls `visit` with every top-level selection of a step and the path of its field.
void for_each_step_selection(const DeformStep& step,
                             const std::function<void(const EditSelection&, const Location&)>& visit) {
  visit(step.region, "region");
  if (step.fixed) visit(*step.fixed, "fixed");
  for (std::size_t i = 0; i < step.handles.size(); ++i)
    visit(step.handles[i].select, Location("handles")[i] / "select");
  for (std::size_t i = 0; i < step.anchors.size(); ++i)
    visit(step.anchors[i].select, Location("anchors")[i] / "select");
  for (std::size_t i = 0; i < step.features.size(); ++i)
    visit(step.features[i].select, Location("features")[i] / "select");
}

void for_each_step_selection(const MergeStep& step,
                             const std::function<void(const EditSelection&, const Location&)>& visit) {
  for (std::size_t i = 0; i < step.pairs.size(); ++i) {
    visit(step.pairs[i].source_loop, Location("pairs")[i] / "source_loop");
    visit(step.pairs[i].target_loop, Location("pairs")[i] / "target_loop");
  }
  if (step.fixed) visit(*step.fixed, "fixed");
  for (std::size_t i = 0; i < step.features.size(); ++i)
    visit(step.features[i].select, Location("features")[i] / "select");
}

void for_each_step_selection(const SculptStep& step,
                             const std::function<void(const EditSelection&, const Location&)>& visit) {
  visit(step.region, "region");
}

// The other steps have no selections.
template <class Step>
void for_each_step_selection(const Step&, const std::function<void(const EditSelection&, const Location&)>&) {}

void for_each_step_selection(const EditStep& step,
                             const std::function<void(const EditSelection&, const Location&)>& visit) {
  std::visit([&](const auto& action) { for_each_step_selection(action, visit); }, step.action);
}

// Returns the fields of a step that name a mesh.
std::vector<std::pair<const char*, std::string>> mesh_fields(const EditStep& step) {
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

[[noreturn]] void fail_unknown_name(const Location& location, facts::script::Named what,
                                    const std::string& name, const std::vector<std::string>& known) {
  if (const auto meant = json::nearest_name(name, known))
    throw Error(facts::script::MisspeltName{.what = what, .name = name, .meant = *meant, .known = known},
                location);
  if (known.empty()) throw Error(facts::script::NoSelections{.name = name}, location);
  throw Error(facts::script::NoSuchName{.what = what, .name = name, .known = known}, location);
}

// Checks that selections refer to each other without cycles and with a depth that is safe to resolve.
class ReferenceCheck {
 public:
  explicit ReferenceCheck(const EditFile& edit) : edit_(edit), names_(names_of(edit.selections)) {}

  void require_named(const EditSelection& selection, const Location& location) {
    for_each_selection(selection, [&](const EditSelection& part) {
      if (const auto* named = std::get_if<EditSelection::Named>(&part.kind))
        if (std::find(names_.begin(), names_.end(), named->name) == names_.end())
          fail_unknown_name(location, facts::script::Named::selection, named->name, names_);
    });
  }

  int depth(const NamedSelection& selection, int above = 0) {
    const Location location = Location::file(edit_.location) / "selections" / Location::field(selection.name);
    if (above > edit_file_depth_limit)
      throw Error(facts::script::SelectionsTooDeep{.limit = edit_file_depth_limit}, location);
    if (const auto known = depths_.find(selection.name); known != depths_.end()) return known->second;
    require_named(selection.selection, location);
    int deepest = 0;
    for_each_selection(selection.selection, [&](const EditSelection& part) {
      if (const auto* named = std::get_if<EditSelection::Named>(&part.kind)) {
        if (named->name == selection.name)
          throw Error(facts::script::SelectionUsesItself{.name = named->name}, location);
        const auto used = std::find(names_.begin(), names_.end(), named->name) - names_.begin();
        deepest = std::max(deepest, depth(edit_.selections[used], above + 1));
      }
    });
    if (deepest + 1 > edit_file_depth_limit)
      throw Error(facts::script::SelectionsTooDeep{.limit = edit_file_depth_limit}, location);
    return depths_[selection.name] = deepest + 1;
  }

 private:
  const EditFile& edit_;
  std::vector<std::string> names_;
  std::map<std::string, int> depths_;
};

// Throws unless every name refers to something that exists at that point of the edit.
void require_names(const EditFile& edit) {
  ReferenceCheck references(edit);
  for (const NamedSelection& selection : edit.selections) references.depth(selection);
  std::vector<std::string> meshes = names_of(edit.inputs);
  for (std::size_t i = 0; i < edit.steps.size(); ++i) {
    const Location location = (Location::file(edit.location) / "steps")[i];
    for (const auto& [field, name] : mesh_fields(edit.steps[i]))
      if (std::find(meshes.begin(), meshes.end(), name) == meshes.end())
        fail_unknown_name(location / field, facts::script::Named::mesh, name, meshes);
    const std::string& outcome = outcome_of(edit.steps[i]);
    if (std::find(meshes.begin(), meshes.end(), outcome) == meshes.end()) meshes.push_back(outcome);
    for_each_step_selection(edit.steps[i], [&](const EditSelection& selection, const Location& field) {
      references.require_named(selection, location / field);
    });
  }
  if (!edit.output.empty() && std::find(meshes.begin(), meshes.end(), edit.output) == meshes.end())
    fail_unknown_name(Location::file(edit.location) / "output", facts::script::Named::mesh, edit.output,
                      meshes);
}

EditFile parse_version_2(const Value& root) {
  const Object fields(root, {"$schema", "format", "version", "made_with", "name", "about", "inputs",
                             "selections", "colours", "steps", "output"});
  EditFile edit;
  fields.optional("$schema", [](const Value& v) { v.string(); });
  fields.optional("made_with", [&](const Value& v) { edit.made_with = parse_made_with(v); });
  fields.optional("name", [&](const Value& v) { edit.name = v.string(); });
  fields.optional("about", [&](const Value& v) { edit.about = v.string(); });
  const Value inputs = fields.required("inputs");
  if (!inputs.is_object() || inputs.raw().empty()) inputs.fail(facts::script::NoInputs{});
  for (const auto& [name, input] : inputs.raw().items()) {
    if (name.empty()) inputs.fail(facts::script::Nameless{.what = facts::script::Named::mesh});
    edit.inputs.push_back(parse_input(name, inputs.member(name)));
  }
  fields.optional("selections", [&](const Value& selections) {
    if (!selections.is_object()) selections.fail_type(facts::script::Type::object_of_selections);
    for (const auto& [name, selection] : selections.raw().items()) {
      if (name.empty()) selections.fail(facts::script::Nameless{.what = facts::script::Named::selection});
      if (name == "all") selections.member(name).fail(facts::script::ReservedName{.name = name});
      edit.selections.push_back({name, parse_selection(selections.member(name))});
    }
  });
  fields.optional("colours", [&](const Value& colours) {
    if (!colours.is_object()) colours.fail_type(facts::script::Type::object_of_colours);
    for (const auto& [name, colour] : colours.raw().items()) {
      const auto named = std::find_if(edit.selections.begin(), edit.selections.end(),
                                      [&](const NamedSelection& one) { return one.name == name; });
      if (named == edit.selections.end())
        fail_unknown_name(colours.member(name).location(), facts::script::Named::selection, name,
                          names_of(edit.selections));
      named->colour = parse_colour(colours.member(name));
    }
  });
  const Value steps = fields.required("steps");
  if (steps.size() == 0) steps.fail(facts::script::EmptyList{.what = facts::script::Element::step});
  std::set<std::string> step_names;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Value step = steps[i];
    edit.steps.push_back(parse_step(step));
    note_former_words(step, edit.notes);
    if (!edit.steps.back().name.empty())
      require_new_name(step_names, edit.steps.back().name, step.member("name"));
  }
  fields.optional("output", [&](const Value& v) { edit.output = v.name(); });
  note_other_methods(edit);
  return edit;
}

EditFile parse_version_1(const Value& root) {
  if (!root.raw().contains("kind")) root.fail(facts::script::MissingField{.field = "kind"});
  const Value kind = root.member("kind");
  using Parser = EditFile (*)(const Value&);
  return kind.choice<Parser>({{"deform", &parse_deform_version_1}, {"merge", &parse_merge_version_1}})(root);
}

void require_size(std::uintmax_t size, const Location& location) {
  if (size > edit_file_size_limit)
    throw Error(facts::script::FileTooLarge{.limit_mib = edit_file_size_limit >> 20}, location);
}

}  // namespace

MadeWith this_library() { return {MESHGRAFT_VERSION, current_methods}; }

const std::string& mesh_of(const EditStep& step) {
  return std::visit(
      [](const auto& action) -> const std::string& {
        if constexpr (requires { action.target; })
          return action.target;
        else
          return action.mesh;
      },
      step.action);
}

const std::string& outcome_of(const EditStep& step) {
  const std::string& result =
      std::visit([](const auto& action) -> const std::string& { return action.result; }, step.action);
  return result.empty() ? mesh_of(step) : result;
}

std::vector<std::string> mesh_names(const EditFile& edit) {
  std::vector<std::string> names = names_of(edit.inputs);
  for (const EditStep& step : edit.steps)
    if (const std::string& name = outcome_of(step); std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  return names;
}

EditFile parse_edit(std::string_view text, const std::string& location,
                    const std::filesystem::path& base_folder) {
  require_size(text.size(), Location::file(location));
  const json::Json document = json::parse(text, Location::file(location), edit_file_depth_limit);
  const Value root(document, location);
  if (!root.is_object() || !document.contains("format") || document["format"] != "meshgraft-edit")
    root.fail(facts::script::NotAnEditFile{});
  if (!document.contains("version")) root.fail(facts::script::MissingField{.field = "version"});
  const Value version = root.member("version");
  const std::int64_t number = version.integer_in(0, std::numeric_limits<int>::max());
  if (number != 1 && number != 2) version.fail(facts::script::UnknownVersion{.version = number});

  EditFile edit = number == 1 ? parse_version_1(root) : parse_version_2(root);
  edit.location = location;
  edit.base_folder = base_folder;
  require_names(edit);
  return edit;
}

EditFile read_edit_file(const std::filesystem::path& path) {
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (!failure) require_size(size, path);
  return parse_edit(read_file(path), path.string(), path.parent_path());
}

std::vector<std::filesystem::path> referenced_files(const EditFile& edit) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const std::string& file) {
    const std::filesystem::path path = edit.base_folder / file;
    if (std::find(files.begin(), files.end(), path) == files.end()) files.push_back(path);
  };
  const auto add_from = [&](const EditSelection& selection) {
    for_each_selection(selection, [&](const EditSelection& part) {
      if (const auto* indices = std::get_if<EditSelection::IndexFile>(&part.kind)) add(indices->file);
      if (const auto* sel = std::get_if<EditSelection::SelFile>(&part.kind)) add(sel->file);
    });
  };
  for (const EditInput& input : edit.inputs)
    if (!input.file.empty()) add(input.file);
  for (const NamedSelection& selection : edit.selections) add_from(selection.selection);
  for (const EditStep& edit_step : edit.steps) {
    for_each_step_selection(edit_step,
                            [&](const EditSelection& selection, const Location&) { add_from(selection); });
    const auto* deform = std::get_if<DeformStep>(&edit_step.action);
    if (!deform) continue;
    for (const HandleSpec& handle : deform->handles)
      if (const auto* def = std::get_if<PoseSpec::DefFile>(&handle.pose.kind)) add(def->file);
  }
  return files;
}

std::string_view to_string(Preset value) { return value == Preset::as_published ? "as-published" : ""; }

std::string_view to_string(SculptAction value) {
  switch (value) {
    case SculptAction::smooth: return "smooth";
    case SculptAction::inflate: return "inflate";
    case SculptAction::flatten: return "flatten";
  }
  return "";
}

std::string_view to_string(EditSelection::SelRole value) {
  switch (value) {
    case EditSelection::SelRole::fixed: return "fixed";
    case EditSelection::SelRole::free: return "free";
    case EditSelection::SelRole::handle: return "handle";
  }
  return "";
}

}  // namespace meshgraft
