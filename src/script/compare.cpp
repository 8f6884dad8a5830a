#include "compare.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>

#include "fact_json.h"
#include "json_text.h"
#include "percent.h"
#include "report_json.h"
#include "run_steps.h"
#include "script/facts.h"

namespace meshgraft {

namespace {

using Json = nlohmann::ordered_json;

void require_distinct(std::span<const Contender> methods) {
  if (methods.empty()) throw Error(facts::script::NoMethods{});
  for (auto method = methods.begin(); method != methods.end(); ++method)
    if (std::find(methods.begin(), method, *method) != method)
      throw Error(facts::script::MethodGivenTwice{.method = to_string(*method)});
}

void require_deform_step(const EditFile& edit) {
  if (std::none_of(edit.steps.begin(), edit.steps.end(),
                   [](const EditStep& step) { return std::holds_alternative<DeformStep>(step.action); }))
    throw Error(facts::script::NothingToCompare{}, Location::file(edit.location));
}

SettingsOverrides overrides_of(const Contender& contender) {
  if (const auto* preset = std::get_if<Preset>(&contender)) return {.preset = *preset};
  if (const auto* baseline = std::get_if<Baseline>(&contender)) return {.method = *baseline};
  return {.method = std::get<DeformMethod>(contender)};
}

// Returns a context whose progress also names and counts the method.
Context context_of(const Contender& method, std::size_t number, std::size_t count, const Context& context) {
  Context own = context;
  if (context.progress)
    own.progress = [&context, name = to_string(method), number, count](Progress progress) {
      progress.within = name;
      progress.number = static_cast<int>(number);
      progress.count = static_cast<int>(count);
      context.progress(progress);
    };
  return own;
}

// Returns the seconds before the first solve. Published methods do not measure them separately.
std::optional<double> set_up_seconds(const MethodOutcome& outcome) {
  if (std::holds_alternative<Baseline>(outcome.method)) return std::nullopt;
  const StageSeconds& seconds = outcome.result->report.seconds;
  return seconds.assemble + seconds.analyse + seconds.factorise;
}

/// A note, and the name of the step that it is about; empty for the whole edit and for steps without a name.
struct PlacedNote {
  std::string step;
  Note note;
};

std::vector<PlacedNote> notes_of(const EditReport& report) {
  std::vector<PlacedNote> notes;
  for (const Note& note : report.notes) notes.push_back({{}, note});
  for (const StepReport& step : report.steps)
    for (const Note& note : step.notes) notes.push_back({step.name, note});
  return notes;
}

Json notes_json(const EditReport& report, const Wording& wording) {
  Json list = Json::array();
  for (const PlacedNote& placed : notes_of(report)) {
    list.push_back(to_json(placed.note, wording));
    if (!placed.step.empty()) list.back()["step"] = placed.step;
  }
  return list;
}

constexpr std::array columns = {"method", "edges RMS", "bending p50", "bending p99", "bending max",
                                "σ min",  "σ p1",      "σ p50",       "σ max",       "free area",
                                "volume", "rim jump",  "width",       "flipped",     "self-intersections",
                                "set-up", "solve"};
using Row = std::vector<std::string>;

template <class T, class Write>
std::string where_known(const std::optional<T>& value, Write write) {
  return value ? write(*value) : std::string("–");
}

Row row_of(const MethodOutcome& outcome, const Wording& wording) {
  const std::string name(to_string(outcome.method));
  if (!outcome.result) return {name, fmt::format("failed: {}", sentence(*outcome.failure, wording))};
  const Quality& quality = outcome.result->report.quality;
  const auto degrees = [](double angle) { return fmt::format("{:.1f}°", angle); };
  const auto sigma = [](double value) { return fmt::format("{:.3f}", value); };
  const auto seconds = [](double value) { return fmt::format("{:.3f} s", value); };
  return {name,
          fmt::format("{:.1f} %", 100 * quality.edge_rms),
          degrees(quality.dihedral_p50_deg),
          degrees(quality.dihedral_p99_deg),
          degrees(quality.dihedral_max_deg),
          sigma(quality.sigma_min),
          sigma(quality.sigma_p1),
          sigma(quality.sigma_p50),
          sigma(quality.sigma_max),
          percent_change(quality.area_ratio_free),
          where_known(quality.volume_ratio, percent_change),
          degrees(quality.rim_jump_max_deg),
          quality.narrowest_vertex < 0 ? "–" : fmt::format("{:.0f} %", 100 * quality.width_min),
          std::to_string(quality.flipped_faces),
          where_known(
              quality.new_self_intersections, [](std::int64_t count) { return std::to_string(count); }),
          where_known(set_up_seconds(outcome), seconds),
          seconds(outcome.result->report.seconds.solve)};
}

// Counts code points, which equals the number of columns for these texts.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string space(width - std::min(width, width_of(text)), ' ');
  return left ? text + space : space + text;
}

// Escapes a message for a cell of a table.
std::string cell_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c == '\n' ? ' ' : c;
  }
  return escaped;
}

std::string table_of(const std::vector<Row>& rows) {
  std::array<std::size_t, columns.size()> widths{};
  for (const Row& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c)
      if (row.size() == columns.size() || c == 0) widths[c] = std::max(widths[c], width_of(row[c]));
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c)
      text += fmt::format("| {} ", padded(cell_text(row[c]), widths[c], c == 0 || row.size() < columns.size()));
    text += "|\n";
    if (&row != &rows.front()) continue;
    text += fmt::format("|:{:-<{}} ", "", widths[0]);
    for (std::size_t c = 1; c < row.size(); ++c) text += fmt::format("|{:->{}}: ", "", widths[c]);
    text += "|\n";
  }
  return text;
}

Json outcome_json(const MethodOutcome& outcome, const Wording& wording) {
  Json json = {{"method", std::string(to_string(outcome.method))}};
  if (!outcome.result) {
    json["failure"] = to_json(*outcome.failure, wording);
    return json;
  }
  const EditReport& report = outcome.result->report;
  const std::optional<double> set_up = set_up_seconds(outcome);
  json["failure"] = nullptr;
  json["outputs"] = report.outputs;
  json["counts"] = counts_json(report.counts);
  json["seconds"] = {{"set_up", set_up ? Json(*set_up) : Json(nullptr)}, {"solve", report.seconds.solve}};
  json["max_displacement"] = report.max_displacement;
  json["quality"] = quality_json(report.quality);
  json["notes"] = notes_json(report, wording);
  return json;
}

}  // namespace

Comparison compare_methods(const EditFile& edit, std::span<const Contender> methods, const Context& context) {
  require_distinct(methods);
  require_deform_step(edit);
  return compare_methods(edit, load_inputs(edit, context), methods, context);
}

Comparison compare_methods(const EditFile& edit, const LoadedInputs& inputs, std::span<const Contender> methods,
                           const Context& context) {
  require_distinct(methods);
  require_deform_step(edit);
  Comparison comparison;
  comparison.edit = edit.location;
  for (const Contender& method : methods) {
    MethodOutcome outcome{method, {}, {}};
    RunOptions options;
    options.overrides = overrides_of(method);
    try {
      const std::size_t number = comparison.outcomes.size() + 1;
      outcome.result = run_steps(edit, inputs, options, context_of(method, number, methods.size(), context));
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) throw;
      outcome.failure = error;
    }
    comparison.outcomes.push_back(std::move(outcome));
  }
  const bool any = std::any_of(comparison.outcomes.begin(), comparison.outcomes.end(),
                               [](const MethodOutcome& outcome) { return outcome.result.has_value(); });
  if (!any) throw *comparison.outcomes.front().failure;
  return comparison;
}

std::string comparison_table(const Comparison& comparison, const Wording& wording) {
  std::vector<Row> rows{Row(columns.begin(), columns.end())};
  std::string notes;
  for (const MethodOutcome& outcome : comparison.outcomes) {
    rows.push_back(row_of(outcome, wording));
    if (!outcome.result) continue;
    for (const auto& [step, note] : notes_of(outcome.result->report)) {
      const FactText text = wording(note);
      notes += fmt::format("- {}: {}\n", to_string(outcome.method),
                           error_sentence(step, text.statement, text.remedy));
    }
  }
  return table_of(rows) + (notes.empty() ? "" : "\n" + notes);
}

std::string write_comparison(const Comparison& comparison, const Wording& wording) {
  Json json = {{"format", "meshgraft-comparison"},
               {"version", 1},
               {"program", std::string("meshgraft ") + MESHGRAFT_VERSION},
               {"edit", comparison.edit},
               {"outputs", comparison.outputs}};
  json["methods"] = Json::array();
  for (const MethodOutcome& outcome : comparison.outcomes)
    json["methods"].push_back(outcome_json(outcome, wording));
  return json::to_text(json);
}

}  // namespace meshgraft
