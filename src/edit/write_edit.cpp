#include <nlohmann/json.hpp>

#include <meshgraft/edit/edit_file.h>

#include "json_text.h"
#include "settings_json.h"

namespace meshgraft {

namespace {

using Json = nlohmann::ordered_json;

template <class Derived>
Json vector_json(const Eigen::MatrixBase<Derived>& vector) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) list.push_back(vector(i));
  return list;
}

template <class Derived>
Json matrix_json(const Eigen::MatrixBase<Derived>& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back(vector_json(matrix.row(i)));
  return rows;
}

Json selection_json(const SelectionSpec& selection);

// One overload per kind of selection: what stands behind the kind's word.
struct SelectionWriter {
  Json operator()(const Selection::All&) const { return "all"; }
  Json operator()(const Selection::Indices& s) const { return {{"indices", s.vertices}}; }
  Json operator()(const Selection::Box& s) const {
    return {{"box", {{"min", vector_json(s.min)}, {"max", vector_json(s.max)}}}};
  }
  Json operator()(const Selection::Sphere& s) const {
    return {{"sphere", {{"centre", vector_json(s.centre)}, {"radius", s.radius}}}};
  }
  Json operator()(const Selection::HalfSpace& s) const {
    return {{"half_space", {{"point", vector_json(s.point)}, {"normal", vector_json(s.normal)}}}};
  }
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
  Json operator()(const SelectionSpec::Named& s) const { return s.name; }
  Json operator()(const SelectionSpec::IndexFile& s) const { return {{"file", s.file}}; }
  Json operator()(const SelectionSpec::SelFile& s) const {
    return {{"sel", s.file}, {"take", std::string(to_string(s.take))}};
  }
  Json operator()(const SelectionSpec::Produced& s) const {
    return {{"produced", {{"step", s.step}, {"what", s.what}}}};
  }
  Json operator()(const SelectionSpec::Grow& s) const {
    return {{"grow", {{"of", selection_json(*s.of)}, {"rings", s.rings}}}};
  }
  Json operator()(const SelectionSpec::GrowLength& s) const {
    return {{"grow_length", {{"of", selection_json(*s.of)}, {"length", s.length}}}};
  }
  Json operator()(const SelectionSpec::Union& s) const { return {{"union", operands(s.of)}}; }
  Json operator()(const SelectionSpec::Minus& s) const { return {{"minus", operands(s.of)}}; }
  Json operator()(const SelectionSpec::Intersect& s) const { return {{"intersect", operands(s.of)}}; }
  Json operator()(const SelectionSpec::Mirror& s) const {
    return {{"mirror",
             {{"of", selection_json(*s.of)},
              {"point", vector_json(s.point)},
              {"normal", vector_json(s.normal)},
              {"tolerance_rel", s.tolerance_rel}}}};
  }
  Json operator()(const SelectionSpec::Rim& s) const {
    return {{"rim", {{"of", selection_json(*s.of)}, {"rings", s.rings}}}};
  }
  static Json operands(const std::vector<SelectionSpec>& list) {
    Json operands = Json::array();
    for (const SelectionSpec& operand : list) operands.push_back(selection_json(operand));
    return operands;
  }
};

Json selection_json(const SelectionSpec& selection) { return std::visit(SelectionWriter{}, selection.kind); }

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
  json["settings"] = settings_json(step.settings);
  if (const Json counts = counts_json(step.counts); !counts.empty()) json["counts"] = counts;
  return json;
}

Json input_json(const EditInput& input) {
  Json json = Json::object();
  if (!input.file.empty()) json["file"] = input.file;
  if (input.sha256) json["sha256"] = *input.sha256;
  if (!input.sample.empty()) json["sample"] = input.sample;
  if (input.resolution != 0) json["resolution"] = input.resolution;
  return json;
}

}  // namespace

Json settings_json(const DeformSettings& settings) {
  const OperatorOptions& operators = settings.deformer.operators;
  const bool automatic = operators.degenerate == DegenerateTreatment::automatic;
  return {{"method", std::string(to_string(settings.deformer.method))},
          {"stiffness", settings.deformer.stiffness},
          {"iterations", settings.deformer.iterations},
          {"smoothing_length_rel", settings.deformer.smoothing_length_rel},
          {"weights", operators.weights == WeightScheme::cotangent ? "cotangent" : "uniform"},
          {"density", operators.density == Density::aware ? "aware" : "ft05"},
          {"degenerate", automatic                                           ? "auto"
                         : operators.degenerate == DegenerateTreatment::apex ? "apex"
                                                                             : "ft05-noise"},
          {"apex_height_rel", operators.apex_height_rel},
          {"noise_length_rel", operators.noise_length_rel},
          {"flatness", operators.flatness},
          {"seed", operators.seed},
          {"laplacian_weight", operators.laplacian_weight},
          {"laplacian_order", operators.laplacian_order},
          {"residual_corrections", settings.deformer.residual_corrections},
          {"backend", backend_word(settings.deformer.backend)},
          {"refine_boundary", settings.refine_boundary}};
}

std::string backend_word(SolverBackend backend) {
  switch (backend) {
    case SolverBackend::automatic: return "auto";
    case SolverBackend::cholmod: return "cholmod";
    case SolverBackend::eigen: return "eigen";
  }
  return {};
}

std::string write_edit(const EditFile& edit) {
  Json json = {{"format", "meshgraft-edit"}, {"version", 2}};
  if (!edit.name.empty()) json["name"] = edit.name;
  if (!edit.about.empty()) json["about"] = edit.about;
  json["inputs"] = Json::object();
  for (const EditInput& input : edit.inputs) json["inputs"][input.name] = input_json(input);
  if (!edit.selections.empty()) json["selections"] = Json::object();
  for (const NamedSelection& named : edit.selections)
    json["selections"][named.name] = selection_json(named.selection);
  json["steps"] = Json::array();
  for (const EditStep& step : edit.steps)
    json["steps"].push_back(
        std::visit([&](const auto& action) { return step_json(step, action); }, step.action));
  if (!edit.output.empty()) json["output"] = edit.output;
  return json::to_text(json);
}

}  // namespace meshgraft
