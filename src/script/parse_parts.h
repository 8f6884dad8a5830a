#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <meshgraft/script/edit_file.h>

#include "json_value.h"
#include "script/facts.h"

namespace meshgraft {

// Parsers of fields that several parts of an edit file have.

inline constexpr int max_rings = 1'000'000;

EditSelection parse_selection(const json::Value& value);

/// Parses a handle's pose. Only a curve may have a redrawn course.
PoseSpec parse_pose(const json::Value& value, HandleShape shape);

/// The fields of a pose that is one affine map.
inline constexpr std::array<std::string_view, 5> affine_fields = {"matrix", "translate", "rotate", "scale",
                                                                  "pivot"};
/// Parses a pose with these fields, of which `matrix` goes alone.
std::variant<HandleMotion, Eigen::Matrix4d> parse_affine_pose(const json::Object& fields,
                                                              const json::Value& value);

inline void read_count(const json::Object& fields, std::string_view key, std::optional<Index>& count) {
  fields.optional(key, [&](const json::Value& value) { count = value.vertex(); });
}

/// Reads the elements of a list, which must have some.
template <class Element>
std::vector<Element> parse_list(const json::Value& value, Element (*parse)(const json::Value&)) {
  std::vector<Element> list;
  for (std::size_t i = 0; i < value.size(); ++i) list.push_back(parse(value[i]));
  if (list.empty()) value.fail(facts::script::EmptyList{.what = facts::script::Element::element});
  return list;
}

/// Reads the heading that both kinds of version 1 files have.
inline void read_heading_version_1(const json::Object& fields, EditFile& edit) {
  fields.optional("name", [&](const json::Value& v) { edit.name = v.string(); });
  fields.optional("about", [&](const json::Value& v) { edit.about = v.string(); });
  fields.optional("paper", [](const json::Value& v) { v.string(); });
  fields.optional("expected", [](const json::Value& v) {
    if (!v.is_null() && !v.is_object()) v.fail_type(facts::script::Type::object_or_null);
  });
}

/// The fields of settings that `parse_preset` and `parse_deformer` read.
inline constexpr std::array<std::string_view, 17> deformer_fields = {"preset",
                                                                     "method",
                                                                     "stiffness",
                                                                     "iterations",
                                                                     "smoothing_length_rel",
                                                                     "weights",
                                                                     "density",
                                                                     "degenerate",
                                                                     "apex_height_rel",
                                                                     "noise_length_rel",
                                                                     "noise_lengths",
                                                                     "flatness",
                                                                     "seed",
                                                                     "laplacian_weight",
                                                                     "laplacian_order",
                                                                     "residual_corrections",
                                                                     "backend"};
std::optional<Preset> parse_preset(const json::Object& fields);
/// Reads the options of a solve. Those that are not given are those of `options`. Merges do not have the method
/// `shell`: it would bend the source beside the seam.
DeformerOptions parse_deformer(const json::Object& fields, DeformerOptions options, bool of_merge = false);
FeatureSpec parse_feature(const json::Value& value);
SymmetrySpec parse_symmetry(const json::Value& value);

/// Former name of the backend `multifrontal`. Edit files with it are still read, with a note.
inline constexpr std::string_view former_multifrontal = "cholmod";

/// Former name of the setting `fairings`. Edit files with it are still read, with a note.
inline constexpr std::string_view former_fairings = "smoothing_steps";

/// Refuses an element whose name an earlier one of its list has.
inline void require_new_name(std::set<std::string>& names, const std::string& name, const json::Value& value) {
  if (!names.insert(name).second) value.fail(facts::script::NameTaken{.name = name});
}

EditStep parse_deform_step(const json::Value& value);
EditStep parse_merge_step(const json::Value& value);
EditStep parse_cut_step(const json::Value& value);
EditStep parse_repair_step(const json::Value& value);
EditStep parse_transform_step(const json::Value& value);
EditStep parse_sculpt_step(const json::Value& value);
EditFile parse_deform_version_1(const json::Value& root);
EditFile parse_merge_version_1(const json::Value& root);

}  // namespace meshgraft
