
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>

#include "baselines/baselines.h"
#include "script/compare.h"

namespace meshgraft {
namespace {

// Returns an edit that turns the end of a bar; `more` are further fields of each step.
EditFile bent_bar(const std::string& more = "", int steps = 1) {
  const std::string step = R"({"kind": "deform", "mesh": "bar",
      "fixed": {"half_space": {"point": [0, 0, 0.6], "normal": [0, 0, -1]}},
      "handles": [{"name": "end", "select": {"half_space": {"point": [0, 0, 3.4], "normal": [0, 0, 1]}},
                   "pose": {"rotate": {"axis": [0, 1, 0], "angle_deg": 50}}}])" +
                           more + "}";
  std::string list = step;
  for (int i = 1; i < steps; ++i) list += "," + step;
  return parse_edit(
      R"({"format": "meshgraft-edit", "version": 2, "inputs": {"bar": {"sample": "bar", "resolution": 16}},
          "steps": [)" +
          list + "]}",
      "edit.json");
}

std::string message_of(const EditFile& edit, const std::vector<Contender>& methods) {
  try {
    compare_methods(edit, methods);
  } catch (const Error& error) {
    return error.what();
  }
  return "(accepted)";
}

TEST(Compare, EveryMethodMeetsTheConstraintsAndNamesItself) {
  const std::vector<Contender> methods = all_contenders();
  ASSERT_EQ(methods.size(), 12u);
  const EditFile edit = bent_bar();
  const Comparison comparison = compare_methods(edit, methods);
  ASSERT_EQ(comparison.outcomes.size(), methods.size());
  const EditResult expected = run_edit(edit);
  for (const MethodOutcome& outcome : comparison.outcomes) {
    const std::string name(to_string(outcome.method));
    ASSERT_TRUE(outcome.result) << name << ": " << outcome.failure->what();
    const EditResult& result = *outcome.result;
    EXPECT_EQ(result.report.counts.free, expected.report.counts.free) << name;
    EXPECT_GT(result.report.max_displacement, 0.1) << name;
    for (Eigen::Index v = 0; v < result.rest.rows(); ++v) {
      if (std::abs(result.rest(v, 2) - 2) < 1.4) continue;
      EXPECT_LT((result.mesh.positions.row(v) - expected.mesh.positions.row(v)).norm(), 1e-12) << name;
    }
    const auto json = nlohmann::json::parse(write_report(result.report));
    const std::string method = std::holds_alternative<Preset>(outcome.method) ? "ft05" : name;
    EXPECT_EQ(json["method"], method);
    EXPECT_EQ(json["steps"][0]["method"], method);
    const bool published = std::holds_alternative<Baseline>(outcome.method);
    EXPECT_EQ(json["residual"].is_null(), published) << name;
    EXPECT_EQ(json["solver"].is_null(), published) << name;
    EXPECT_EQ(json["steps"][0]["settings"].contains("method"), !published) << name;
  }
  EXPECT_EQ(comparison.outcomes[0].result->mesh.positions, expected.mesh.positions)
      << "corotational is the default and comes first";
}

TEST(Compare, AMethodThatFailsIsARow) {
  const EditFile anchored = bent_bar(R"(, "anchors": [{"select": {"nearest": [0, 0, 2]}}])");
  const std::vector<Contender> methods{DeformMethod::ft05, Baseline::lipman_2004};
  const Comparison comparison = compare_methods(anchored, methods);
  EXPECT_TRUE(comparison.outcomes[0].result);
  EXPECT_FALSE(comparison.outcomes[1].result);
  EXPECT_FALSE(comparison.outcomes[0].failure);
  const Error failure = comparison.outcomes[1].failure.value();
  EXPECT_EQ(failure.location().text(), "edit.json: steps[0].anchors");
  EXPECT_EQ(failure.id(), "script.no_anchors");
  EXPECT_EQ(failure.fact().get<std::string>("method"), "lipman-2004");
  const std::string table = comparison_table(comparison);
  EXPECT_NE(table.find("| lipman-2004 | failed: "), std::string::npos) << table;
  const auto json = nlohmann::json::parse(write_comparison(comparison));
  EXPECT_TRUE(json["methods"][0]["failure"].is_null());
  EXPECT_EQ(json["methods"][1]["failure"], (nlohmann::json{{"id", "script.no_anchors"},
                                                           {"code", "input"},
                                                           {"location", failure.location().text()},
                                                           {"fields", {{"method", "lipman-2004"}}},
                                                           {"problem", failure.problem()},
                                                           {"remedy", failure.remedy()},
                                                           {"notes", nlohmann::json::array()}}));

  const std::vector<Contender> only{Baseline::lipman_2004};
  EXPECT_EQ(message_of(anchored, only), failure.what()) << "where all fail, that is the error";
}

TEST(Compare, RunsAllStepsByTheMethod) {
  const std::vector<Contender> methods{Baseline::arap_2007};
  const Comparison comparison = compare_methods(bent_bar(R"(, "settings": {"method": "ft05"})", 2), methods);
  const EditReport& report = comparison.outcomes[0].result->report;
  ASSERT_EQ(report.steps.size(), 2u);
  for (const StepReport& step : report.steps) EXPECT_EQ(to_string(step.method), "arap-2007");
}

TEST(Compare, PublishedMethodsRefineTheBoundaryToo) {
  const std::vector<Contender> methods{Baseline::yu_2004};
  const Comparison plain = compare_methods(bent_bar(), methods);
  const Comparison refined = compare_methods(bent_bar(R"(, "settings": {"refine_boundary": 1})"), methods);
  ASSERT_TRUE(refined.outcomes[0].result) << refined.outcomes[0].failure->what();
  const Points& coarse = plain.outcomes[0].result->mesh.positions;
  const Points& fine = refined.outcomes[0].result->mesh.positions;
  ASSERT_EQ(coarse.rows(), fine.rows());
  EXPECT_GT((coarse - fine).cwiseAbs().maxCoeff(), 0);
}

TEST(Compare, TheTableHasARowPerMethodAndACellPerMeasure) {
  const std::vector<Contender> methods{DeformMethod::corotational, Baseline::sorkine_2004};
  const std::string table = comparison_table(compare_methods(bent_bar(), methods));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4) << table;
  std::vector<std::ptrdiff_t> bars;
  for (std::size_t start = 0; start < table.size(); start = table.find('\n', start) + 1)
    bars.push_back(std::count(table.begin() + static_cast<std::ptrdiff_t>(start),
                              table.begin() + static_cast<std::ptrdiff_t>(table.find('\n', start)), '|'));
  EXPECT_EQ(bars, std::vector<std::ptrdiff_t>(4, bars[0])) << table;
  EXPECT_NE(table.find("| corotational"), std::string::npos) << table;
  EXPECT_NE(table.find("| sorkine-2004"), std::string::npos) << table;
}

TEST(Compare, NotesStandBelowTheTable) {
  EditFile edit = bent_bar();
  HandleMotion mirror;
  mirror.scale = {-1, 1, 1};
  std::get<DeformStep>(edit.steps[0].action).handles[0].pose.kind = mirror;
  const std::vector<Contender> methods{DeformMethod::corotational};
  const Comparison comparison = compare_methods(edit, methods);
  EXPECT_NE(comparison_table(comparison).find("\n\n- corotational: a handle mirrors"), std::string::npos);
  const auto notes = nlohmann::json::parse(write_comparison(comparison))["methods"][0]["notes"];
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_EQ(notes[1]["id"], "script.pinched")
      << "between a bar and its mirror image nothing is left of the width";
  EXPECT_LT(notes[1]["fields"]["percent"].get<double>(), 20);
  EXPECT_EQ(notes[0]["id"], "script.no_rotation");
  EXPECT_EQ(notes[0]["fields"], nlohmann::json::object());
  EXPECT_FALSE(notes[0].contains("step")) << "the step has no name";

  edit.steps[0].name = "flip";
  const Comparison named = compare_methods(edit, methods);
  EXPECT_NE(comparison_table(named).find("\n\n- corotational: flip: a handle mirrors"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(write_comparison(named))["methods"][0]["notes"][0]["step"], "flip");
}

TEST(Compare, SentencesAreInTheWordsOfTheInterface) {
  const Wording by_id = [](const Fact& fact) { return FactText{"says " + std::string(fact.id()), "Do so."}; };
  EditFile edit = bent_bar(R"(, "anchors": [{"select": {"nearest": [0, 0, 2]}}])");
  HandleMotion mirror;
  mirror.scale = {-1, 1, 1};
  std::get<DeformStep>(edit.steps[0].action).handles[0].pose.kind = mirror;
  const std::vector<Contender> methods{DeformMethod::corotational, Baseline::lipman_2004};
  const Comparison comparison = compare_methods(edit, methods);
  const std::string table = comparison_table(comparison, by_id);
  EXPECT_NE(table.find("\n- corotational: says script.no_rotation. Do so."), std::string::npos) << table;
  EXPECT_NE(table.find("anchors: says script.no_anchors. Do so."), std::string::npos) << table;
  const auto json = nlohmann::json::parse(write_comparison(comparison, by_id))["methods"];
  EXPECT_EQ(json[0]["notes"][0]["text"], "says script.no_rotation. Do so.");
  EXPECT_EQ(json[1]["failure"]["problem"], "says script.no_anchors");
  EXPECT_EQ(json[1]["failure"]["remedy"], "Do so.");
  const auto report = nlohmann::json::parse(write_report(comparison.outcomes[0].result->report, by_id));
  EXPECT_EQ(report["steps"][0]["notes"][0]["text"], "says script.no_rotation. Do so.");
}

TEST(Compare, ProgressNamesAndCountsTheMethod) {
  std::set<std::tuple<std::string, int, int>> solving;
  Context context;
  context.progress = [&](const Progress& progress) {
    if (progress.stage == "solve") solving.emplace(progress.within, progress.number, progress.count);
  };
  const std::vector<Contender> methods{DeformMethod::ft05, Baseline::arap_2007};
  compare_methods(bent_bar(), methods, context);
  EXPECT_EQ(solving, (std::set<std::tuple<std::string, int, int>>{{"ft05", 1, 2}, {"arap-2007", 2, 2}}));
}

TEST(Compare, StopsWhenAsked) {
  std::stop_source stop;
  Context context;
  context.stop_token = stop.get_token();
  context.progress = [&](const Progress& progress) {
    if (progress.within == "arap-2007") stop.request_stop();
  };
  const std::vector<Contender> methods{DeformMethod::ft05, Baseline::arap_2007};
  try {
    compare_methods(bent_bar(), methods, context);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

TEST(Compare, RefusesNoMethodAndOneTwice) {
  EXPECT_NE(message_of(bent_bar(), {}).find("no method"), std::string::npos);
  EXPECT_NE(message_of(bent_bar(), {DeformMethod::ft05, DeformMethod::ft05}).find("'ft05' is given twice"),
            std::string::npos);
  EditFile still = bent_bar();
  still.steps.clear();
  EXPECT_NE(message_of(still, {DeformMethod::ft05}).find("no step deforms anything"), std::string::npos);
}

TEST(Compare, APresetTakesThePlaceOfAllSettings) {
  const std::vector<Contender> methods{Preset::as_published, DeformMethod::ft05};
  const Comparison comparison = compare_methods(bent_bar(R"(, "settings": {"laplacian_weight": 7})"), methods);
  const EditReport& published = comparison.outcomes[0].result->report;
  EXPECT_EQ(published.steps[0].settings.preset, Preset::as_published);
  EXPECT_EQ(comparison.outcomes[0].result->mesh.positions,
            run_edit(bent_bar(R"(, "settings": {"preset": "as-published"})")).mesh.positions);
  EXPECT_EQ(comparison.outcomes[1].result->report.steps[0].settings.deformer.operators.laplacian_weight, 7);
  EXPECT_NE(comparison_table(comparison).find("| as-published "), std::string::npos);
}

TEST(Method, NamesGoBothWays) {
  for (const Method& method : all_methods()) EXPECT_EQ(method_named(to_string(method)), method);
  for (const Contender& contender : all_contenders()) {
    EXPECT_EQ(contender_named(to_string(contender)), contender);
    if (!std::holds_alternative<Preset>(contender)) continue;
    EXPECT_THROW(method_named(to_string(contender)), Error);
  }
  for (const auto& [wrong, nearest] :
       {std::pair{"arpa-2007", "Did you mean 'arap-2007'?"},
        std::pair{"nothing like it", "Known are corotational, rotation-aware, ft05, shell"}})
    try {
      method_named(wrong);
      FAIL() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_EQ(error.fact().get<std::string>("name"), wrong);
      EXPECT_NE(std::string(error.what()).find(nearest), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("yu-2004"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace meshgraft
