// The preset `as-published` in edit files, and the program that wrote a file.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>
#include <meshgraft/script/run_edit.h>

namespace meshgraft {
namespace {

EditFile bend_with(const std::string& settings, const std::string& heading = "") {
  return parse_edit(R"({"format": "meshgraft-edit", "version": 2,)" + heading +
                        R"("inputs": {"bar": {"sample": "bar", "resolution": 8}}, "steps": [
      {"kind": "deform", "mesh": "bar", "fixed": {"half_space": {"point": [0, 0, 0.6], "normal": [0, 0, -1]}},
       "handles": [{"name": "top", "select": {"half_space": {"point": [0, 0, 3.4], "normal": [0, 0, 1]}},
                    "pose": {"rotate": {"axis": [0, 0, 1], "angle_deg": 60}, "scale": 1.2}}],
       "settings": )" + settings +
                        "}]}",
                    "edit.json");
}

EditFile graft_with(const std::string& settings, const std::string& more = "",
                    const std::string& heading = "") {
  return parse_edit(R"({"format": "meshgraft-edit", "version": 2,)" + heading +
                        R"("inputs": {"tube": {"sample": "cylinder", "resolution": 12}}, "steps": [
      {"kind": "cut", "name": "upper", "mesh": "tube", "result": "upper",
       "plane": {"point": [0, 0, 2], "normal": [0.2, 0.1, 1]}, "keep": "above"},
      {"kind": "cut", "name": "lower", "mesh": "tube", "result": "lower",
       "plane": {"point": [0, 0, 2], "normal": [0, 0, 1]}, "keep": "below"},
      {"kind": "merge", "target": "lower", "source": "upper",
       "pairs": [{"source_loop": {"produced": {"step": "upper", "what": "loop"}},
                  "target_loop": {"produced": {"step": "lower", "what": "loop"}},
                  "start": [[0.5, 0, 1.9], [0.5, 0, 2]]}],)" +
                        more + R"("settings": )" + settings + "}]}",
                    "edit.json");
}

nlohmann::json written_settings(const EditFile& edit) {
  return nlohmann::json::parse(write_edit(edit))["steps"].back()["settings"];
}

TEST(AsPublishedEdit, HasThePapersSettings) {
  const nlohmann::json settings = written_settings(bend_with(R"({"preset": "as-published"})"));
  EXPECT_EQ(settings["preset"], "as-published");
  EXPECT_EQ(settings["method"], "ft05");
  EXPECT_EQ(settings["stiffness"], 0);
  EXPECT_EQ(settings["weights"], "uniform");
  EXPECT_EQ(settings["density"], "ft05");
  EXPECT_EQ(settings["degenerate"], "ft05-noise");
  EXPECT_EQ(settings["noise_lengths"], "random");
  EXPECT_EQ(settings["laplacian_weight"], 1);
  EXPECT_EQ(settings["refine_boundary"], 0);
  EXPECT_EQ(written_settings(
                bend_with(R"({"preset": "as-published", "refine_boundary": "auto"})"))["refine_boundary"],
            "auto");
  const EditFile merge = graft_with(R"({"preset": "as-published"})");
  const nlohmann::json seam = written_settings(merge);
  EXPECT_EQ(seam["preset"], "as-published");
  EXPECT_EQ(seam["laplacian_weight"], 1);
  EXPECT_EQ(seam["strip"], "greedy");
  EXPECT_EQ(seam["fairing_method"], "umbrella");
  EXPECT_EQ(seam["fairings"], 3);
  EXPECT_EQ(seam["refine_radius"], false);
  EXPECT_EQ(seam["sharp_angle_deg"], 180);
  EXPECT_EQ(std::get<MergeStep>(merge.steps.back().action).shape, MergeShape::ft05);
}

TEST(AsPublishedEdit, OtherSettingsWin) {
  const nlohmann::json settings = written_settings(
      bend_with(R"({"density": "aware", "preset": "as-published", "laplacian_weight": 5, "seed": 9})"));
  EXPECT_EQ(settings["density"], "aware");
  EXPECT_EQ(settings["laplacian_weight"], 5);
  EXPECT_EQ(settings["seed"], 9);
  EXPECT_EQ(settings["method"], "ft05");
  const EditFile merge = graft_with(
      R"({"strip": "optimal", "preset": "as-published", "noise_lengths": "equal"})", R"("shape": "similar",)");
  EXPECT_EQ(written_settings(merge)["strip"], "optimal");
  EXPECT_EQ(written_settings(merge)["noise_lengths"], "equal");
  EXPECT_EQ(written_settings(merge)["fairing_method"], "umbrella");
  EXPECT_EQ(std::get<MergeStep>(merge.steps.back().action).shape, MergeShape::similar);
}

TEST(AsPublishedEdit, ReadsBackWhatItWrites) {
  for (const EditFile& edit :
       {bend_with(R"({"preset": "as-published", "seed": 4})"), graft_with(R"({"preset": "as-published"})")})
    EXPECT_EQ(write_edit(parse_edit(write_edit(edit), "edit.json")), write_edit(edit));
}

TEST(AsPublishedEdit, IsWhatTheOverrideDoes) {
  const RunOptions published{.overrides = {.preset = Preset::as_published}};
  const RunOptions plain;
  const EditResult named = run_edit(bend_with(R"({"preset": "as-published"})"), plain);
  const EditResult overridden = run_edit(bend_with(R"({"density": "aware", "proxy": 60})"), published);
  EXPECT_EQ(overridden.mesh.positions, named.mesh.positions);
  EXPECT_EQ(overridden.report.steps[0].settings.preset, Preset::as_published);
  EXPECT_NE(run_edit(bend_with("{}"), plain).mesh.positions, named.mesh.positions);
  RunOptions other = published;
  other.overrides.density = Density::aware;
  EXPECT_NE(run_edit(bend_with("{}"), other).mesh.positions, named.mesh.positions);

  const EditResult merged = run_edit(graft_with(R"({"preset": "as-published"})"), plain);
  const EditResult merged_so = run_edit(graft_with(R"({"strip": "optimal"})"), published);
  EXPECT_EQ(merged_so.mesh.positions, merged.mesh.positions);
  EXPECT_EQ(merged_so.report.steps.back().merge->preset, Preset::as_published);
  EXPECT_EQ(merged_so.report.steps.back().merge->options.shape, MergeShape::ft05);
}

TEST(MergeSettings, KeepTheDefaultOfIterationsBesideOtherSettings) {
  EXPECT_EQ(written_settings(graft_with(R"({"strip": "greedy"})"))["iterations"], 60);
}

std::string made_with(int methods) {
  return R"("made_with": {"version": "0.0.9", "methods": )" + std::to_string(methods) + "},";
}

TEST(MadeWith, OtherMethodsGiveANote) {
  constexpr int other = current_methods + 1;
  const EditFile edit = bend_with("{}", made_with(other));
  ASSERT_EQ(edit.notes.size(), 1U);
  EXPECT_EQ(edit.notes[0].id(), "script.other_methods");
  EXPECT_EQ(edit.notes[0].get<std::string>("version"), "0.0.9");
  EXPECT_EQ(edit.notes[0].get<std::int64_t>("methods"), other);
  EXPECT_EQ(edit.notes[0].get<std::int64_t>("current"), current_methods);
  EXPECT_EQ(run_edit(edit).report.notes.size(), 1U);
  EXPECT_EQ(graft_with("{}", "", made_with(other)).notes.size(), 1U);
}

TEST(MadeWith, TheSameMethodsAndFilesWithoutThemGiveNone) {
  EXPECT_TRUE(bend_with("{}", made_with(current_methods)).notes.empty());
  EXPECT_TRUE(bend_with("{}").notes.empty());
  EXPECT_FALSE(bend_with("{}").made_with);
}

TEST(MadeWith, AsPublishedGivesNone) {
  const std::string other = made_with(current_methods + 1);
  EXPECT_TRUE(bend_with(R"({"preset": "as-published"})", other).notes.empty());
  EXPECT_TRUE(graft_with(R"({"preset": "as-published"})", "", other).notes.empty());
  EXPECT_EQ(bend_with(R"({"preset": "as-published", "method": "corotational"})", other).notes.size(), 1U);
  EXPECT_EQ(graft_with(R"({"preset": "as-published"})", R"("shape": "similar",)", other).notes.size(), 1U);
  const RunOptions published{.overrides = {.preset = Preset::as_published}};
  EXPECT_TRUE(run_edit(bend_with("{}", other), published).report.notes.empty());
}

TEST(MadeWith, TheVersionIsAShortPrintableText) {
  const auto edit_by = [](const std::string& version) {
    return bend_with("{}", R"("made_with": {"version": ")" + version + R"(", "methods": 1},)");
  };
  EXPECT_EQ(edit_by(std::string(64, 'v')).made_with->version.size(), 64U);
  EXPECT_EQ(edit_by("0.2.0-rc.1 (~)").made_with->version, "0.2.0-rc.1 (~)");
  for (const std::string& version :
       {std::string(), std::string(65, 'v'), std::string("\\u001b[2J"), std::string("0.1\\n0.2"),
        std::string("\xc3\xa4"), std::string("\\u007f")}) {
    SCOPED_TRACE(version);
    try {
      edit_by(version);
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), "script.not_a_version");
      EXPECT_NE(std::string(error.what()).find("made_with.version: expected a version"), std::string::npos)
          << error.what();
    }
  }
}

TEST(MadeWith, IsWrittenAsItIs) {
  EditFile edit = bend_with("{}", made_with(7));
  EXPECT_NE(write_edit(edit).find(R"("made_with": {"version": "0.0.9", "methods": 7})"), std::string::npos)
      << write_edit(edit);
  edit.made_with = this_library();
  const EditFile again = parse_edit(write_edit(edit), "edit.json");
  EXPECT_EQ(again.made_with->version, MESHGRAFT_VERSION);
  EXPECT_EQ(again.made_with->methods, current_methods);
}

}  // namespace
}  // namespace meshgraft
