#include <meshgraft/script/report.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include <meshgraft/core/version.h>

#include "fact_json.h"
#include "json_text.h"
#include "report_json.h"
#include "settings_json.h"
#include "vector_json.h"

namespace meshgraft {

namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json optional_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json seconds_json(const StageSeconds& seconds) {
  return {{"read", seconds.read},           {"check", seconds.check},       {"select", seconds.select},
          {"match", seconds.match},         {"assemble", seconds.assemble}, {"analyse", seconds.analyse},
          {"factorise", seconds.factorise}, {"solve", seconds.solve},       {"seam", seconds.seam},
          {"retry", seconds.retry},         {"measure", seconds.measure},   {"write", seconds.write},
          {"total", seconds.total}};
}

Json solver_json(const SolverStatistics& solver) {
  Json json = {{"backend", name_of(solver.backend)},
               {"ordering", name_of(solver.ordering)},
               {"unknowns", solver.unknowns},
               {"matrix_nonzeros", solver.matrix_nonzeros},
               {"factor_nonzeros", solver.factor_nonzeros},
               {"factor_flops", solver.factor_flops},
               {"peak_memory_bytes", solver.peak_memory_bytes}};
  if (solver.coarse_unknowns > 0) json["coarse_unknowns"] = solver.coarse_unknowns;
  return json;
}

std::string severity_word(Severity severity) {
  switch (severity) {
    case Severity::info: return "info";
    case Severity::worked_around: return "worked-around";
    case Severity::refused: return "refused";
  }
  return {};
}

std::string domain_word(Domain domain) {
  switch (domain) {
    case Domain::vertex: return "vertex";
    case Domain::face: return "face";
    case Domain::corner: return "corner";
  }
  return {};
}

constexpr std::size_t index_limit = 10;  // of a finding

Json diagnostics_json(const Diagnostics& diagnostics, const Wording& wording) {
  Json findings = Json::array();
  for (const Finding& finding : diagnostics.findings) {
    const FactText text = wording(finding.note);
    const std::size_t shown = std::min(index_limit, finding.indices.size());
    findings.push_back(
        {{"name", name_of(finding.kind)},
         {"severity", severity_word(finding.severity)},
         {"count", finding.count},
         {"domain", domain_word(finding.domain)},
         {"first", std::vector<Index>(finding.indices.begin(),
                                      finding.indices.begin() + static_cast<std::ptrdiff_t>(shown))},
         {"description", text.statement},
         {"remedy", text.remedy}});
  }
  return findings;
}

// Adds the fields that a step and a whole edit share.
template <class Report>
void add_measures(Json& json, const Report& report) {
  json["counts"] = counts_json(report.counts);
  json["seconds"] = seconds_json(report.seconds);
  json["solver"] = report.evaluation ? solver_json(report.solver) : Json(nullptr);
  json["residual"] = report.evaluation ? Json(report.evaluation->residual) : Json(nullptr);
  json["max_transform_deviation"] =
      report.evaluation ? Json(report.evaluation->max_transform_deviation) : Json(nullptr);
  json["condition_estimate"] = optional_json(report.condition_estimate);
}

template <class Report>
void add_quality(Json& json, const Report& report) {
  json["max_displacement"] = report.max_displacement;
  json["quality"] = quality_json(report.quality);
}

Json pair_json(const PairReport& pair) {
  return {{"source_vertices", pair.source_vertices},
          {"target_vertices", pair.target_vertices},
          {"start", {pair.start.source, pair.start.target}},
          {"confidence", pair.confidence},
          {"starts", starts_json(pair.starts)},
          {"raggedness_deg", pair.raggedness_deg},
          {"misfit_rel", pair.misfit_rel},
          {"size_ratio", pair.size_ratio},
          {"edge_ratio", pair.edge_ratio}};
}

Json shape_json(const ShapeReport& shape) {
  Json rotation = Json::array();
  for (int row = 0; row < 3; ++row) rotation.push_back(vector_json(shape.similarity.rotation.row(row)));
  return {{"similarity",
           {{"scale", shape.similarity.scale},
            {"rotation", rotation},
            {"translation", vector_json(shape.similarity.translation)}}},
          {"scales", shape.scales},
          {"distance_rel", shape.distance_rel},
          {"smallest_singular_p5", shape.smallest_singular_p5},
          {"inverted", shape.inverted}};
}

Json seam_json(const SeamReport& seam) {
  return {{"manifold", seam.manifold},
          {"oriented", seam.oriented},
          {"closed", seam.closed},
          {"euler_characteristic", seam.euler_characteristic},
          {"expected_euler_characteristic", seam.expected_euler_characteristic},
          {"new_faces", seam.new_faces},
          {"angle_p1_deg", seam.angle_p1_deg},
          {"dihedral_p99_deg", seam.dihedral_p99_deg},
          {"target_dihedral_p99_deg", seam.target_dihedral_p99_deg},
          {"source_dihedral_p99_deg", seam.source_dihedral_p99_deg},
          {"band_displacement_rel", seam.band_displacement_rel},
          {"edge_ratio", seam.source_edge_ratio},
          {"folded_edges", seam.faults.folded_edges},
          {"crossings", seam.faults.crossings},
          {"far_crossings", seam.faults.far_crossings}};
}

Json retry_json(const RetryReport& retry) {
  return {{"tries", retry.tries},
          {"faults_before", retry.faults_before},
          {"faults", retry.faults},
          {"reach_doublings", retry.reach_doublings},
          {"normal_angle_deg", retry.normal_angle_deg},
          {"size", retry.size > 0 ? Json(retry.size) : Json(nullptr)},
          {"start", retry.start},
          {"start_shift", retry.start_shift}};
}

Json merge_settings_json(const std::optional<Preset>& preset, const MergeOptions& options) {
  Json json = settings_json(MergeSettings{preset, options.deformer, options.seam});
  json["normal_angle_deg"] = options.normal_angle_deg;
  json["smooth_boundary"] = options.smooth_boundary;
  json["fix_winding"] = options.fix_winding;
  json["retry"] = options.retry;
  return json;
}

Json base_json(const std::optional<BaseReport>& base) {
  if (!base) return nullptr;
  return {{"point", vector_json(base->point)},
          {"normal", vector_json(base->normal)},
          {"height", base->height},
          {"flat", base->flat},
          {"loops", base->loops},
          {"cut_away", base->cut_away}};
}

// Adds the fields of a merge step after those that all steps have.
void add_merge(Json& json, const MergeOutcome& merge) {
  const MergeReport& report = merge.report;
  json["source"] = merge.source;
  json["pose"] = pose_word(merge.options.pose);
  json["shape"] = shape_word(merge.options.shape);
  json["settings"] = merge_settings_json(merge.preset, merge.options);
  json["pairs"] = Json::array();
  for (const PairReport& pair : report.pairs) json["pairs"].push_back(pair_json(pair));
  json["base"] = base_json(merge.base);
  json["part"] = shape_json(report.shape);
  json["seam"] = seam_json(report.seam);
  json["retry"] = retry_json(report.retry);
  json["residual"] = report.evaluation.residual;
  json["iterations"] = report.evaluation.iterations;
  json["source_vertices_added"] = report.source_vertices_added;
  json["target_vertices_added"] = report.target_vertices_added;
  json["self_intersections"] = merge.intersections.result;
  json["source_self_intersections"] = merge.intersections.source;
  json["target_map"] = merge.target_map.new_index;
  json["source_map"] = merge.source_map.new_index;
  json["new_faces"] = merge.new_faces;
}

Json rows_json(const Eigen::Affine3d& map) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) rows.push_back(vector_json(map.matrix().row(i)));
  return rows;
}

void add_cut(Json& json, const CutOutcome& cut) {
  json["components"] = cut.topology.components;
  json["boundary_loops"] = cut.topology.boundary_loops;
  json["loops"] = cut.loops;
  json["pins"] = Json::array();
  for (const CutPin& pin : cut.pins) json["pins"].push_back(pin_json(pin));
  json["map"] = cut.map.new_index;
}

void add_repair(Json& json, const RepairOutcome& repair, const Wording& wording) {
  json["settings"] = settings_json(repair.options);
  json["changes"] = Json::array();
  for (const RepairChange& change : repair.changes) json["changes"].push_back(change_json(change, wording));
  json["map"] = repair.map.new_index;
}

// Returns the settings that were used. Published methods use their own defaults.
Json settings_in_force(const StepReport& step) {
  if (std::holds_alternative<DeformMethod>(step.method)) return settings_json(step.settings);
  return {{"backend", name_of(step.settings.deformer.backend)},
          {"refine_boundary", step.settings.refine_boundary.value_or(0)},
          {"weld", step.settings.weld}};
}

Json proxy_json(const std::optional<ProxyReport>& proxy) {
  if (!proxy) return nullptr;
  return {{"vertices", proxy->vertices}, {"free", proxy->free_vertices}, {"spacing", proxy->spacing}};
}

Json symmetry_json(const StepReport& step) {
  if (!step.symmetry) return nullptr;
  const SymmetryReport& facts = *step.symmetry;
  Json twins = Json::array(), own = Json::array();
  const std::size_t first = step.handles.size() - facts.twin_of.size();
  for (std::size_t t = 0; t < facts.twin_of.size(); ++t) twins.push_back(step.handles[first + t]);
  for (const std::size_t handle : facts.own) own.push_back(step.handles[handle]);
  return {{"twins", twins}, {"own_image", own}, {"without_partner", facts.without_partner}};
}

Json deform_json(const StepReport& step, const Wording& wording) {
  Json json = {{"kind", "deform"}, {"name", step.name}, {"mesh", step.mesh}, {"result", step.result}};
  json["method"] = std::string(to_string(step.method));
  json["settings"] = settings_in_force(step);
  add_measures(json, step);
  add_quality(json, step);
  json["iterations"] = step.evaluation ? Json(step.evaluation->iterations) : Json(nullptr);
  json["last_rotation_change"] = step.evaluation ? Json(step.evaluation->last_rotation_change) : Json(nullptr);
  json["shell_steps"] = step.evaluation ? Json(step.evaluation->shell_steps) : Json(nullptr);
  json["proxy"] = proxy_json(step.proxy);
  json["refined_vertices"] = step.refined_vertices;
  json["symmetry"] = symmetry_json(step);
  json["notes"] = to_json(step.notes, wording);
  return json;
}

std::string kind_word(const StepReport& step) {
  if (step.merge) return "merge";
  if (step.cut) return "cut";
  if (step.repair) return "repair";
  if (step.sculpt) return "sculpt";
  return step.transform ? "transform" : "deform";
}

Json step_json(const StepReport& step, const Wording& wording) {
  if (step.is_deform()) return deform_json(step, wording);
  Json json = {{"kind", kind_word(step)},
               {"name", step.name},
               {step.merge ? "target" : "mesh", step.mesh},
               {"result", step.result},
               {"counts", {{"vertices", step.counts.vertices}, {"faces", step.counts.faces}}},
               {"seconds", seconds_json(step.seconds)}};
  if (step.merge) add_merge(json, *step.merge);
  if (step.cut) add_cut(json, *step.cut);
  if (step.repair) add_repair(json, *step.repair, wording);
  if (step.sculpt) {
    json["action"] = to_string(step.sculpt->action);
    json["region"] = step.sculpt->region;
    json["max_displacement"] = step.sculpt->max_displacement;
    json["new_self_intersections"] = step.sculpt->new_self_intersections;
    if (step.symmetry) json["symmetry"] = {{"without_partner", step.symmetry->without_partner}};
  }
  if (step.transform) json["matrix"] = rows_json(*step.transform);
  json["notes"] = to_json(step.notes, wording);
  return json;
}

}  // namespace

Json counts_json(const DeformCounts& counts) {
  return {{"vertices", counts.vertices}, {"faces", counts.faces},   {"free", counts.free},
          {"fixed", counts.fixed},       {"handle", counts.handle}, {"degenerate", counts.degenerate}};
}

Json change_json(const RepairChange& change, const Wording& wording) {
  return {{"name", name_of(change.kind)},
          {"count", change.count},
          {"domain", domain_word(change.domain)},
          {"description", wording(change.note).statement}};
}

Json pin_json(const CutPin& pin) {
  return {{"centre", vector_json(pin.centre)},
          {"diameter", pin.diameter},
          {"length", pin.length},
          {"clearance", pin.clearance}};
}

Json starts_json(const std::vector<StartCandidate>& starts) {
  Json list = Json::array();
  for (const auto& [start, probability, turn_deg] : starts)
    list.push_back(
        {{"start", {start.source, start.target}}, {"probability", probability}, {"turn_deg", turn_deg}});
  return list;
}

Json quality_json(const Quality& quality) {
  return {{"area_ratio", quality.area_ratio},
          {"area_ratio_free", quality.area_ratio_free},
          {"volume_ratio", optional_json(quality.volume_ratio)},
          {"edge_rms", quality.edge_rms},
          {"sigma",
           {{"min", quality.sigma_min},
            {"p1", quality.sigma_p1},
            {"p5", quality.sigma_p5},
            {"p50", quality.sigma_p50},
            {"p95", quality.sigma_p95},
            {"p99", quality.sigma_p99},
            {"max", quality.sigma_max}}},
          {"dihedral_change_deg",
           {{"p50", quality.dihedral_p50_deg},
            {"p99", quality.dihedral_p99_deg},
            {"max", quality.dihedral_max_deg}}},
          {"rim_jump_max_deg", quality.rim_jump_max_deg},
          {"width_min", quality.width_min},
          {"narrowest_vertex", quality.narrowest_vertex},
          {"flipped_faces", quality.flipped_faces},
          {"new_self_intersections", optional_json(quality.new_self_intersections)}};
}

std::string write_report(const EditReport& report, const Wording& wording) {
  Json json = {{"format", "meshgraft-report"},
               {"version", 1},
               {"program", std::string("meshgraft ") + MESHGRAFT_VERSION}};
  json["edit"] = report.edit;
  json["outputs"] = report.outputs;
  json["notes"] = to_json(report.notes, wording);
  const auto deform = std::ranges::find_if(report.steps, &StepReport::is_deform);
  json["method"] = deform == report.steps.end() ? Json(nullptr) : Json(std::string(to_string(deform->method)));
  add_measures(json, report);
  if (report.deformed) {
    add_quality(json, report);
  } else {
    json["max_displacement"] = nullptr;
    json["quality"] = nullptr;
  }
  json["inputs"] = Json::array();
  for (const EditReport::Input& input : report.inputs)
    json["inputs"].push_back({{"name", input.name},
                              {"source", input.source},
                              {"vertices", input.vertices},
                              {"faces", input.faces},
                              {"findings", diagnostics_json(input.diagnostics, wording)}});
  json["steps"] = Json::array();
  for (const StepReport& step : report.steps) json["steps"].push_back(step_json(step, wording));
  return json::to_text(json);
}

std::string write_diagnostics(const Diagnostics& diagnostics, const Wording& wording) {
  return json::to_text(diagnostics_json(diagnostics, wording));
}

}  // namespace meshgraft
