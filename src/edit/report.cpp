#include <meshgraft/edit/report.h>

#include <nlohmann/json.hpp>

#include <meshgraft/core/version.h>

#include "json_text.h"
#include "report_json.h"
#include "settings_json.h"

namespace meshgraft {

namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json optional_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json seconds_json(const StageSeconds& seconds) {
  return {{"read", seconds.read},         {"triage", seconds.triage},   {"select", seconds.select},
          {"assemble", seconds.assemble}, {"analyse", seconds.analyse}, {"factorise", seconds.factorise},
          {"basis", seconds.basis},       {"solve", seconds.solve},     {"measure", seconds.measure},
          {"write", seconds.write},       {"total", seconds.total}};
}

Json solver_json(const SolverStatistics& solver) {
  return {{"backend", solver.backend},
          {"ordering", solver.ordering},
          {"unknowns", solver.unknowns},
          {"matrix_nonzeros", solver.matrix_nonzeros},
          {"factor_nonzeros", solver.factor_nonzeros},
          {"factor_flops", solver.factor_flops},
          {"peak_memory_bytes", solver.peak_memory_bytes}};
}

std::string severity_word(Severity severity) {
  switch (severity) {
    case Severity::note: return "note";
    case Severity::repaired: return "repaired";
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

Json triage_json(const TriageReport& triage, std::size_t index_limit) {
  Json findings = Json::array();
  for (const Finding& finding : triage.findings) {
    const std::size_t shown = std::min(index_limit, finding.indices.size());
    findings.push_back(
        {{"name", finding.name},
         {"severity", severity_word(finding.severity)},
         {"count", finding.count},
         {"domain", domain_word(finding.domain)},
         {"first", std::vector<Index>(finding.indices.begin(),
                                      finding.indices.begin() + static_cast<std::ptrdiff_t>(shown))},
         {"description", finding.description},
         {"remedy", finding.remedy}});
  }
  return findings;
}

// The fields that a step and a whole edit share.
template <class Report>
void add_measures(Json& json, const Report& report) {
  json["counts"] = counts_json(report.counts);
  json["seconds"] = seconds_json(report.seconds);
  json["solver"] = report.evaluation ? solver_json(report.solver) : Json(nullptr);
  json["residual"] = report.evaluation ? Json(report.evaluation->residual) : Json(nullptr);
  json["max_transform_deviation"] =
      report.evaluation ? Json(report.evaluation->max_transform_deviation) : Json(nullptr);
  json["condition_estimate"] = optional_json(report.condition_estimate);
  json["max_displacement"] = report.max_displacement;
  json["quality"] = quality_json(report.quality);
}

// Published methods run by their own defaults.
Json settings_in_force(const StepReport& step) {
  if (std::holds_alternative<DeformMethod>(step.method)) return settings_json(step.settings);
  return {{"backend", backend_word(step.settings.deformer.backend)},
          {"refine_boundary", step.settings.refine_boundary}};
}

Json step_json(const StepReport& step) {
  Json json = {{"kind", "deform"}, {"name", step.name}, {"mesh", step.mesh}};
  json["method"] = std::string(to_string(step.method));
  json["settings"] = settings_in_force(step);
  add_measures(json, step);
  json["iterations"] = step.evaluation ? Json(step.evaluation->iterations) : Json(nullptr);
  json["last_rotation_change"] = step.evaluation ? Json(step.evaluation->last_rotation_change) : Json(nullptr);
  json["notes"] = step.notes;
  return json;
}

}  // namespace

Json counts_json(const DeformCounts& counts) {
  return {{"vertices", counts.vertices}, {"faces", counts.faces},   {"free", counts.free},
          {"fixed", counts.fixed},       {"handle", counts.handle}, {"degenerate", counts.degenerate}};
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
          {"flipped_faces", quality.flipped_faces},
          {"new_self_intersections", optional_json(quality.new_self_intersections)}};
}

std::string write_report(const EditReport& report) {
  Json json = {{"format", "meshgraft-report"},
               {"version", 1},
               {"program", std::string("meshgraft ") + MESHGRAFT_VERSION}};
  json["edit"] = report.edit;
  json["outputs"] = report.outputs;
  json["method"] = report.steps.empty() ? "" : std::string(to_string(report.steps.front().method));
  add_measures(json, report);
  json["inputs"] = Json::array();
  for (const EditReport::Input& input : report.inputs)
    json["inputs"].push_back({{"name", input.name},
                              {"source", input.source},
                              {"vertices", input.vertices},
                              {"faces", input.faces},
                              {"triage", triage_json(input.triage, 10)}});
  json["steps"] = Json::array();
  for (const StepReport& step : report.steps) json["steps"].push_back(step_json(step));
  return json::to_text(json);
}

std::string write_triage(const TriageReport& triage, std::size_t index_limit) {
  return json::to_text(triage_json(triage, index_limit));
}

}  // namespace meshgraft
