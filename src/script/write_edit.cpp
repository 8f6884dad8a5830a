#include <nlohmann/json.hpp>

#include <meshgraft/script/edit_file.h>

#include "json_text.h"
#include "settings_json.h"
#include "vector_json.h"

namespace meshgraft {

namespace {

using Json = nlohmann::ordered_json;

template <class Derived>
Json matrix_json(const Eigen::MatrixBase<Derived>& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back(vector_json(matrix.row(i)));
  return rows;
}

Json plane_json(const Plane& plane) {
  return {{"point", vector_json(plane.point)}, {"normal", vector_json(plane.normal)}};
}

Json selection_json(const EditSelection& selection);

// Writes a selection; one overload per kind.
struct SelectionWriter {
  Json operator()(const Selection::All&) const { return "all"; }
  Json operator()(const Selection::Indices& s) const { return {{"indices", s.vertices}}; }
  Json operator()(const Selection::Box& s) const {
    return {{"box", {{"min", vector_json(s.min)}, {"max", vector_json(s.max)}}}};
  }
  Json operator()(const Selection::Sphere& s) const {
    return {{"sphere", {{"centre", vector_json(s.centre)}, {"radius", s.radius}}}};
  }
  Json operator()(const Selection::HalfSpace& s) const { return {{"half_space", plane_json(s.plane)}}; }
  Json operator()(const Selection::Component& s) const { return {{"component", s.number}}; }
  Json operator()(const Selection::Loop& s) const { return {{"loop", s.number}}; }
  Json operator()(const Selection::NearestVertex& s) const { return {{"nearest", vector_json(s.point)}}; }
  Json operator()(const Selection::Path& s) const {
    Json points = Json::array();
    for (const Eigen::Vector3d& point : s.points) points.push_back(vector_json(point));
    Json path = {{"points", points}};
    if (s.closed) path["closed"] = true;
    return {{"path", path}};
  }
  Json operator()(const EditSelection::Named& s) const { return s.name; }
  Json operator()(const EditSelection::IndexFile& s) const { return {{"file", s.file}}; }
  Json operator()(const EditSelection::SelFile& s) const {
    return {{"sel", s.file}, {"take", std::string(to_string(s.take))}};
  }
  Json operator()(const EditSelection::Produced& s) const {
    return {{"produced", {{"step", s.step}, {"what", s.what}}}};
  }
  Json operator()(const EditSelection::Grow& s) const {
    return {{"grow", {{"of", selection_json(*s.of)}, {"rings", s.rings}}}};
  }
  Json operator()(const EditSelection::GrowLength& s) const {
    return {{"grow_length", {{"of", selection_json(*s.of)}, {"length", s.length}}}};
  }
  Json operator()(const EditSelection::Union& s) const { return {{"union", operands(s.of)}}; }
  Json operator()(const EditSelection::Minus& s) const { return {{"minus", operands(s.of)}}; }
  Json operator()(const EditSelection::Intersect& s) const { return {{"intersect", operands(s.of)}}; }
  Json operator()(const EditSelection::Mirror& s) const {
    return {{"mirror",
             {{"of", selection_json(*s.of)},
              {"point", vector_json(s.plane.point)},
              {"normal", vector_json(s.plane.normal)},
              {"tolerance_rel", s.tolerance_rel}}}};
  }
  Json operator()(const EditSelection::Rim& s) const {
    return {{"rim", {{"of", selection_json(*s.of)}, {"rings", s.rings}}}};
  }
  static Json operands(const std::vector<EditSelection>& list) {
    Json operands = Json::array();
    for (const EditSelection& operand : list) operands.push_back(selection_json(operand));
    return operands;
  }
};

Json selection_json(const EditSelection& selection) { return std::visit(SelectionWriter{}, selection.kind); }

struct PoseWriter {
  Json operator()(const HandleMotion& motion) const {
    Json pose = Json::object();
    if (!motion.translate.isZero(0)) pose["translate"] = vector_json(motion.translate);
    if (motion.angle_deg != 0)
      pose["rotate"] = {{"axis", vector_json(motion.axis)}, {"angle_deg", motion.angle_deg}};
    if (motion.scale != Eigen::Vector3d::Ones()) pose["scale"] = vector_json(motion.scale);
    if (motion.pivot) pose["pivot"] = vector_json(*motion.pivot);
    return pose;
  }
  Json operator()(const Eigen::Matrix4d& matrix) const { return {{"matrix", matrix_json(matrix)}}; }
  Json operator()(const PoseSpec::DefFile& def) const { return {{"def", def.file}}; }
  Json operator()(const PoseSpec::Redrawn& curve) const { return {{"curve", matrix_json(curve.polyline)}}; }
};

std::string shape_word(HandleShape shape) {
  switch (shape) {
    case HandleShape::vertex: return "vertex";
    case HandleShape::curve: return "curve";
    case HandleShape::region: return "region";
  }
  return {};
}

Json handle_json(const HandleSpec& handle) {
  Json json = {{"name", handle.name}, {"shape", shape_word(handle.shape)}};
  if (handle.closed) json["closed"] = *handle.closed;
  json["select"] = selection_json(handle.select);
  if (!handle.constrain_transform) json["constrain"] = "position";
  if (!handle.constrain_position) json["constrain"] = "transform";
  json["pose"] = std::visit(PoseWriter{}, handle.pose.kind);
  return json;
}

Json counts_json(const ExpectedCounts& counts) {
  Json json = Json::object();
  const auto write = [&](const char* key, const std::optional<Index>& count) {
    if (count) json[key] = *count;
  };
  write("vertices", counts.vertices);
  write("faces", counts.faces);
  write("region", counts.region);
  write("fixed", counts.fixed);
  write("handle", counts.handle);
  write("free", counts.free);
  return json;
}

template <class List, class Write>
void write_list(Json& json, const char* key, const List& list, Write write) {
  if (list.empty()) return;
  json[key] = Json::array();
  for (const auto& element : list) json[key].push_back(write(element));
}

Json feature_json(const FeatureSpec& feature) {
  return {{"select", selection_json(feature.select)}, {"map", feature.similarity ? "similarity" : "affine"}};
}

Json symmetry_json(const SymmetrySpec& symmetry) {
  Json json = plane_json(symmetry.plane);
  json["tolerance_rel"] = symmetry.tolerance_rel;
  return json;
}

Json step_json(const EditStep& edit_step, const DeformStep& step) {
  Json json = {{"kind", "deform"}};
  if (!edit_step.name.empty()) json["name"] = edit_step.name;
  if (!edit_step.about.empty()) json["about"] = edit_step.about;
  json["mesh"] = step.mesh;
  if (!step.result.empty()) json["result"] = step.result;
  json["region"] = selection_json(step.region);
  if (step.fixed) json["fixed"] = selection_json(*step.fixed);
  write_list(json, "handles", step.handles, handle_json);
  write_list(json, "targets", step.targets, [](const TargetSpec& target) {
    return Json{{"vertex", target.vertex}, {"position", vector_json(target.position)}};
  });
  write_list(json, "transforms", step.transforms, [](const TransformSpec& transform) {
    return Json{{"vertex", transform.vertex}, {"matrix", matrix_json(transform.matrix)}};
  });
  write_list(json, "anchors", step.anchors, [](const AnchorSpec& anchor) {
    return Json{{"select", selection_json(anchor.select)}, {"weight", anchor.weight}};
  });
  write_list(json, "features", step.features, feature_json);
  if (step.symmetry) json["symmetry"] = symmetry_json(*step.symmetry);
  json["settings"] = settings_json(step.settings);
  if (const Json counts = counts_json(step.counts); !counts.empty()) json["counts"] = counts;
  return json;
}

Json vertex_json(const VertexSpec& vertex) {
  if (const auto* point = std::get_if<Eigen::Vector3d>(&vertex)) return vector_json(*point);
  return std::get<Index>(vertex);
}

Json match_json(const MatchSpec& match) {
  return Json::array({vertex_json(match.source), vertex_json(match.target)});
}

Json pair_spec_json(const MergePairSpec& pair) {
  Json json = {{"source_loop", selection_json(pair.source_loop)},
               {"target_loop", selection_json(pair.target_loop)}};
  write_list(json, "matches", pair.matches, match_json);
  return json;
}

Json drop_json(const DropSpec& drop) {
  Json json = Json::object();
  if (const auto* vertex = std::get_if<Index>(&drop.surface_point))
    json["vertex"] = *vertex;
  else
    json["point"] = vector_json(std::get<Eigen::Vector3d>(drop.surface_point));
  json["spin_deg"] = drop.spin_deg;
  if (drop.source_loop) json["source_loop"] = selection_json(*drop.source_loop);
  if (drop.base) {
    Json& base = json["base"] = Json::object();
    if (drop.base->height) base["height"] = *drop.base->height;
    if (drop.base->tilt_deg != 0) base["tilt_deg"] = drop.base->tilt_deg;
    if (drop.base->tilt_axis) base["tilt_axis"] = vector_json(*drop.base->tilt_axis);
  }
  return json;
}

Json counts_json(const MergeCounts& counts) {
  Json json = Json::object();
  const auto write = [&](const char* key, const std::optional<Index>& count) {
    if (count) json[key] = *count;
  };
  write("source_vertices", counts.source_vertices);
  write("source_faces", counts.source_faces);
  write("target_vertices", counts.target_vertices);
  write("target_faces", counts.target_faces);
  if (!counts.source_loops.empty()) json["source_loops"] = counts.source_loops;
  if (!counts.target_loops.empty()) json["target_loops"] = counts.target_loops;
  write("fixed", counts.fixed);
  write("free", counts.free);
  return json;
}

// Writes the fields that pose the source before the merge.
void write_posing(Json& json, const MergeStep& step) {
  if (step.mirror) json["mirror"] = plane_json(*step.mirror);
  if (step.source_transform) json["source_transform"] = matrix_json(*step.source_transform);
  write_list(json, "align", step.align, match_json);
  if (step.size) json["size"] = *step.size;
}

Json step_json(const EditStep& edit_step, const MergeStep& step) {
  Json json = {{"kind", "merge"}};
  if (!edit_step.name.empty()) json["name"] = edit_step.name;
  if (!edit_step.about.empty()) json["about"] = edit_step.about;
  json["target"] = step.target;
  json["source"] = step.source;
  if (!step.result.empty()) json["result"] = step.result;
  json["pose"] = pose_word(step.pose);
  json["shape"] = shape_word(step.shape);
  write_list(json, "pairs", step.pairs, pair_spec_json);
  write_list(json, "matches", step.matches, match_json);
  if (step.at) json["at"] = drop_json(*step.at);
  write_posing(json, step);
  if (step.normal_angle_deg != 0) json["normal_angle_deg"] = step.normal_angle_deg;
  if (step.fixed) json["fixed"] = selection_json(*step.fixed);
  if (step.reach.rings) json["reach"] = {{"rings", *step.reach.rings}};
  if (step.reach.length) json["reach"] = {{"length", *step.reach.length}};
  write_list(json, "features", step.features, feature_json);
  if (step.smooth_boundary) json["smooth_boundary"] = true;
  if (step.fix_winding) json["fix_winding"] = true;
  if (!step.retry) json["retry"] = false;
  json["settings"] = settings_json(step.settings);
  if (const Json counts = counts_json(step.counts); !counts.empty()) json["counts"] = counts;
  return json;
}

std::string keep_word(CutKeep keep) {
  switch (keep) {
    case CutKeep::above: return "above";
    case CutKeep::below: return "below";
    case CutKeep::both: return "both";
  }
  return {};
}

Json pins_json(const CutOptions& options) {
  Json json = Json::object();
  if (options.pin_count) json["count"] = *options.pin_count;
  if (options.pin_diameter) json["diameter"] = *options.pin_diameter;
  if (options.pin_length) json["length"] = *options.pin_length;
  if (options.pin_clearance) json["clearance"] = *options.pin_clearance;
  json["side"] = options.pin_side == PinSide::above ? "above" : "below";
  return json;
}

Json step_json(const EditStep& edit_step, const CutStep& step) {
  Json json = {{"kind", "cut"}};
  if (!edit_step.name.empty()) json["name"] = edit_step.name;
  if (!edit_step.about.empty()) json["about"] = edit_step.about;
  json["mesh"] = step.mesh;
  if (!step.result.empty()) json["result"] = step.result;
  if (const auto* plane = std::get_if<Plane>(&step.along))
    json["plane"] = plane_json(*plane);
  else
    json["loop"] = std::get<std::vector<Index>>(step.along);
  json["keep"] = keep_word(step.options.keep);
  json["snap"] = step.options.snap;
  if (step.options.cap == CutCap::flat) json["cap"] = "flat";
  if (step.options.cap == CutCap::pins) json["pins"] = pins_json(step.options);
  return json;
}

std::string fill_word(HoleFill fill) {
  switch (fill) {
    case HoleFill::plain: return "plain";
    case HoleFill::refined: return "refined";
    case HoleFill::faired: return "faired";
  }
  return {};
}

Json step_json(const EditStep& edit_step, const RepairStep& step) {
  Json json = {{"kind", "repair"}};
  if (!edit_step.name.empty()) json["name"] = edit_step.name;
  if (!edit_step.about.empty()) json["about"] = edit_step.about;
  json["mesh"] = step.mesh;
  if (!step.result.empty()) json["result"] = step.result;
  json.update(settings_json(step.options));
  return json;
}

Json step_json(const EditStep& edit_step, const TransformStep& step) {
  Json json = {{"kind", "transform"}};
  if (!edit_step.name.empty()) json["name"] = edit_step.name;
  if (!edit_step.about.empty()) json["about"] = edit_step.about;
  json["mesh"] = step.mesh;
  if (!step.result.empty()) json["result"] = step.result;
  json["pose"] = std::visit(PoseWriter{}, step.pose);
  return json;
}

Json step_json(const EditStep& edit_step, const SculptStep& step) {
  Json json = {{"kind", "sculpt"}};
  if (!edit_step.name.empty()) json["name"] = edit_step.name;
  if (!edit_step.about.empty()) json["about"] = edit_step.about;
  json["mesh"] = step.mesh;
  if (!step.result.empty()) json["result"] = step.result;
  json["action"] = to_string(step.action);
  json["region"] = selection_json(step.region);
  if (step.action == SculptAction::inflate)
    json["height"] = step.height;
  else
    json["strength"] = step.strength;
  if (step.reach) json["reach"] = *step.reach;
  if (step.symmetry) json["symmetry"] = symmetry_json(*step.symmetry);
  return json;
}

// Returns the name of an axis, or a vector.
Json direction_json(const Eigen::Vector3d& direction) {
  for (const char* name : {"x", "y", "z", "-x", "-y", "-z"})
    if (direction == *axis_named(name)) return name;
  return vector_json(direction);
}

Json input_json(const EditInput& input) {
  Json json = Json::object();
  if (!input.file.empty()) json["file"] = input.file;
  if (input.sha256) json["sha256"] = *input.sha256;
  if (!input.sample.empty()) json["sample"] = input.sample;
  if (input.resolution != 0) json["resolution"] = input.resolution;
  if (input.orientation) {
    json["up"] = direction_json(input.orientation->up);
    json["front"] = direction_json(input.orientation->front);
  }
  return json;
}

// Writes all settings, so that a changed default changes no old edit.
Json deformer_json(const std::optional<Preset>& preset, const DeformerOptions& options) {
  const OperatorOptions& operators = options.operators;
  Json json = Json::object();
  if (preset) json["preset"] = to_string(*preset);
  json["method"] = to_string(options.method);
  json["stiffness"] = options.stiffness;
  json["iterations"] = options.iterations;
  json["smoothing_length_rel"] = options.smoothing_length_rel;
  json["weights"] = to_string(operators.weights);
  json["density"] = to_string(operators.density);
  json["degenerate"] = to_string(operators.degenerate);
  json["apex_height_rel"] = operators.apex_height_rel;
  json["noise_length_rel"] = operators.noise_length_rel;
  json["noise_lengths"] = to_string(operators.noise_lengths);
  json["flatness"] = operators.flatness;
  json["seed"] = operators.seed;
  json["laplacian_weight"] = operators.laplacian_weight;
  json["laplacian_order"] = operators.laplacian_order;
  json["residual_corrections"] = options.residual_corrections;
  json["backend"] = name_of(options.backend);
  return json;
}

}  // namespace

std::string pose_word(MergePose pose) { return pose == MergePose::keep ? "keep" : "find"; }

std::string shape_word(MergeShape shape) { return shape == MergeShape::ft05 ? "ft05" : "similar"; }

Json settings_json(const DeformSettings& settings) {
  Json json = deformer_json(settings.preset, settings.deformer);
  json["refine_boundary"] = settings.refine_boundary ? Json(*settings.refine_boundary) : Json("auto");
  json["proxy"] = settings.proxy;
  json["weld"] = settings.weld;
  return json;
}

Json settings_json(const MergeSettings& settings) {
  Json json = deformer_json(settings.preset, settings.deformer);
  json["strip"] = settings.seam.strip == StripMethod::greedy ? "greedy" : "optimal";
  json["edge_ratio"] = settings.seam.edge_ratio;
  json["refine_radius"] = settings.seam.refine_radius;
  json["fairing_method"] = to_string(settings.seam.fairing_method);
  json["fairings"] = settings.seam.fairings;
  json["band"] = settings.seam.target_rings;
  json["sharp_angle_deg"] = settings.seam.sharp_angle_deg;
  json["blend_colours"] = settings.seam.blend_colours;
  return json;
}

Json settings_json(const RepairOptions& options) {
  Json json = {{"remove_invalid", options.remove_invalid},
               {"clean_faces", options.clean_faces},
               {"remove_duplicate_shells", options.remove_duplicate_shells},
               {"weld", options.weld}};
  if (options.weld_distance) json["weld_distance"] = *options.weld_distance;
  json["split_non_manifold"] = options.split_non_manifold;
  json["remove_debris"] = options.remove_debris;
  json["debris_rel"] = options.debris_rel;
  json["unify_winding"] = options.unify_winding;
  json["hole_edges"] = options.hole_edges ? Json(*options.hole_edges) : Json("auto");
  json["hole_fill"] = fill_word(options.hole_fill);
  json["remove_isolated"] = options.remove_isolated;
  return json;
}

std::string write_edit(const EditFile& edit) {
  Json json = {{"format", "meshgraft-edit"}, {"version", 2}};
  if (edit.made_with)
    json["made_with"] = {{"version", edit.made_with->version}, {"methods", edit.made_with->methods}};
  if (!edit.name.empty()) json["name"] = edit.name;
  if (!edit.about.empty()) json["about"] = edit.about;
  json["inputs"] = Json::object();
  for (const EditInput& input : edit.inputs) json["inputs"][input.name] = input_json(input);
  if (!edit.selections.empty()) json["selections"] = Json::object();
  for (const NamedSelection& named : edit.selections)
    json["selections"][named.name] = selection_json(named.selection);
  for (const NamedSelection& named : edit.selections)
    if (!named.colour.empty()) json["colours"][named.name] = named.colour;
  json["steps"] = Json::array();
  for (const EditStep& step : edit.steps)
    json["steps"].push_back(
        std::visit([&](const auto& action) { return step_json(step, action); }, step.action));
  if (!edit.output.empty()) json["output"] = edit.output;
  return json::to_text(json);
}

}  // namespace meshgraft
