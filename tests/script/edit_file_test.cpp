#include <meshgraft/script/edit_file.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "support/paths.h"

namespace meshgraft {
namespace {

// Returns a version 2 file around the fields of one step.
std::string file_with_step(const std::string& fields) {
  return R"({"format": "meshgraft-edit", "version": 2, "inputs": {"body": {"file": "body.ply"}},
             "selections": {"top": {"half_space": {"point": [0, 0, 1], "normal": [0, 0, 1]}}},
             "steps": [{"kind": "deform", "mesh": "body")" +
         (fields.empty() ? "" : ", " + fields) + "}]}";
}

std::string handle(const std::string& fields) {
  return R"("handles": [{"name": "h", "select": "top")" + (fields.empty() ? "" : ", " + fields) + "}]";
}

const DeformStep& first_step(const EditFile& edit) { return std::get<DeformStep>(edit.steps.at(0).action); }

// Returns the message with which a text is refused.
std::string refusal(const std::string& text) {
  try {
    parse_edit(text, "edit.json");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    return error.what();
  }
  return "(accepted)";
}

TEST(EditFile, CutStepsKeepTheirCapsAndPins) {
  const auto round_trip = [](const std::string& fields) {
    const EditFile edit =
        parse_edit(R"({"format": "meshgraft-edit", "version": 2, "inputs": {"m": {"file": "m.ply"}},
                       "steps": [{"kind": "cut", "mesh": "m", "plane": {"point": [0, 0, 0], "normal": [0, 0, 1]})" +
                       fields + "}]}",
                   "edit.json");
    const auto before = std::get<CutStep>(edit.steps[0].action).options;
    const auto after = std::get<CutStep>(parse_edit(write_edit(edit), "edit.json").steps[0].action).options;
    EXPECT_EQ(after.cap, before.cap);
    EXPECT_EQ(after.pin_count, before.pin_count);
    EXPECT_EQ(after.pin_diameter, before.pin_diameter);
    EXPECT_EQ(after.pin_length, before.pin_length);
    EXPECT_EQ(after.pin_clearance, before.pin_clearance);
    EXPECT_EQ(after.pin_side, before.pin_side);
    return before;
  };
  EXPECT_EQ(round_trip("").cap, CutCap::open);
  EXPECT_EQ(round_trip(R"(, "cap": "flat")").cap, CutCap::flat);
  EXPECT_EQ(round_trip(R"(, "pins": {})").cap, CutCap::pins);
  const CutOptions all =
      round_trip(R"(, "pins": {"count": 3, "diameter": 0.5, "length": 2, "clearance": 0, "side": "above"})");
  EXPECT_EQ(all.pin_count, 3);
  EXPECT_EQ(all.pin_clearance, 0);
  EXPECT_EQ(all.pin_side, PinSide::above);
  EXPECT_THROW(round_trip(R"(, "cap": "flat", "pins": {})"), Error);
  EXPECT_THROW(round_trip(R"(, "pins": {"diameter": 0})"), Error);
}

TEST(EditFile, ReadsBackWhatItWritesForEverySelectionPoseAndSetting) {
  const std::string every_selection = R"("region": {"union": ["all", "top", {"indices": [3, 1, 2]},
      {"box": {"min": [0, 0, 0], "max": [1, 2, 3]}}, {"sphere": {"centre": [1, 2, 3], "radius": 0.1}},
      {"half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}}, {"component": 1}, {"loop": 0},
      {"nearest": [1, 2, 3]}, {"path": {"points": [[0, 0, 0], [1, 0, 0], [1, 1, 0]], "closed": true}},
      {"file": "x.txt"}, {"sel": "x.sel", "take": "free"}, {"produced": {"step": "a", "what": "loop"}},
      {"grow": {"of": "top", "rings": -2}}, {"grow_length": {"of": "top", "length": 0.3}},
      {"minus": ["all", "top"]}, {"intersect": ["all", "top"]},
      {"mirror": {"of": "top", "point": [0, 0, 0], "normal": [1, 0, 0], "tolerance_rel": 0.01}},
      {"rim": {"of": "top", "rings": 3}}]})";
  const std::string every_handle = R"("fixed": "top", "handles": [
      {"name": "a", "shape": "region", "select": "top", "constrain": "position",
       "pose": {"translate": [0.1, 0.2, 0.3], "rotate": {"axis": [1, 1, 0], "angle_deg": 720},
                "scale": [1, 2, 3], "pivot": [0, 0, 1]}},
      {"name": "b", "shape": "curve", "closed": true, "select": "top", "constrain": "transform",
       "pose": {"curve": [[0, 0, 0], [1, 0, 0]]}},
      {"name": "c", "shape": "vertex", "select": "top", "pose": {"def": "x.def"}},
      {"name": "d", "select": "top",
       "pose": {"matrix": [[1, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.1], [0, 0, 0, 1]]}}])";
  const std::string everything_else = R"("name": "pull", "about": "x", "result": "posed",
      "targets": [{"vertex": 1, "position": [0.1, 0.2, 0.3]}],
      "transforms": [{"vertex": 1, "matrix": [[1, 0, 0], [0, 2, 0], [0, 0, 3]]}],
      "anchors": [{"select": "top", "weight": 0.3}],
      "settings": {"method": "rotation-aware", "stiffness": 0.5, "iterations": 7, "smoothing_length_rel": 0.2,
                   "weights": "cotangent", "density": "ft05", "degenerate": "ft05-noise",
                   "apex_height_rel": 0.7, "noise_length_rel": 0.1, "flatness": 1e-4,
                   "seed": 18446744073709551615, "laplacian_weight": 3, "laplacian_order": 2, "residual_corrections": 3,
                   "backend": "eigen", "refine_boundary": 1},
      "counts": {"vertices": 8, "faces": 12, "region": 8, "fixed": 1, "handle": 1, "free": 6})";
  const EditFile edit = parse_edit(file_with_step(every_selection + "," + every_handle + "," + everything_else),
                                   "edit.json", "folder");
  const std::string written = write_edit(edit);
  EXPECT_EQ(write_edit(parse_edit(written, "edit.json", "folder")), written);

  const DeformStep& step = first_step(edit);
  EXPECT_EQ(step.settings.deformer.method, DeformMethod::rotation_aware);
  EXPECT_EQ(step.settings.deformer.stiffness, 0.5);
  EXPECT_EQ(step.settings.deformer.iterations, 7);
  EXPECT_EQ(step.settings.deformer.smoothing_length_rel, 0.2);
  EXPECT_EQ(step.settings.deformer.operators.seed, 18446744073709551615u);
  EXPECT_EQ(step.settings.deformer.operators.laplacian_weight, 3);
  EXPECT_EQ(step.settings.deformer.operators.degenerate, DegenerateTreatment::ft05_noise);
  EXPECT_EQ(std::get<HandleMotion>(step.handles.at(0).pose.kind).angle_deg, 720);
  EXPECT_FALSE(step.handles.at(0).constrain_transform);
  EXPECT_FALSE(step.handles.at(1).constrain_position);
  for (const char* word :
       {"produced", "grow_length", "tolerance_rel", "\"take\": \"free\"", "x.def", "0.30000000"})
    EXPECT_EQ(written.find(word) != std::string::npos, std::string(word) != "0.30000000") << word;
}

TEST(EditFile, KeepsOrientations) {
  const EditFile edit = read_edit_file(test::source_path("tests/script/accepted/orientation.json"));
  const EditFile again = parse_edit(write_edit(edit), "again");
  for (const EditFile* one : {&edit, &again}) {
    const Orientation& orientation = one->inputs.front().orientation.value();
    EXPECT_EQ(orientation.up, -Eigen::Vector3d::UnitZ());
    EXPECT_TRUE(orientation.front.isApprox(Eigen::Vector3d(1, 0.5, 0).normalized()));
  }
  EXPECT_NE(write_edit(edit).find("\"up\": \"-z\""), std::string::npos);
}

TEST(EditFile, AppliesTheDocumentedDefaults) {
  const EditFile edit = parse_edit(file_with_step(handle("")), "edit.json");
  const DeformStep& step = first_step(edit);
  EXPECT_TRUE(std::holds_alternative<Selection::All>(step.region.kind));
  EXPECT_FALSE(step.fixed.has_value());
  EXPECT_EQ(step.settings.refine_boundary, std::nullopt);
  EXPECT_EQ(step.settings.deformer.method, DeformMethod::corotational);
  EXPECT_EQ(step.settings.deformer.stiffness, 60);
  EXPECT_EQ(step.settings.deformer.iterations, 20);
  EXPECT_EQ(step.settings.deformer.smoothing_length_rel, 0.04);
  const HandleSpec& only = step.handles.at(0);
  EXPECT_EQ(only.shape, HandleShape::region);
  EXPECT_TRUE(only.constrain_position && only.constrain_transform);
  EXPECT_FALSE(std::get<HandleMotion>(only.pose.kind).pivot.has_value());
}

TEST(EditFile, KeepsAnAutomaticRefinement) {
  const std::string written = write_edit(parse_edit(file_with_step(handle("")), "edit.json"));
  EXPECT_NE(written.find(R"("refine_boundary": "auto")"), std::string::npos);
  EXPECT_EQ(first_step(parse_edit(written, "edit.json")).settings.refine_boundary, std::nullopt);
}

TEST(EditFile, ReadsVersionOneAsOneStep) {
  const EditFile edit = parse_edit(R"({"format": "meshgraft-edit", "version": 1, "kind": "deform",
      "name": "n", "about": "a", "paper": "Figure 3", "mesh": "../m.ply", "counts": {"vertices": 9, "roi": 3},
      "roi": [4, 5, 6], "fixed": [4], "handles": [{"name": "h", "shape": "vertex", "vertices": [6],
      "transform": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]}], "expected": null})",
                                   "e.json");
  ASSERT_EQ(edit.steps.size(), 1u);
  EXPECT_EQ(edit.inputs.at(0).file, "../m.ply");
  const DeformStep& step = first_step(edit);
  EXPECT_EQ(std::get<Selection::Indices>(step.region.kind).vertices, (std::vector<Index>{4, 5, 6}));
  EXPECT_EQ(std::get<Eigen::Matrix4d>(step.handles.at(0).pose.kind)(2, 3), 2);
  EXPECT_EQ(*step.counts.region, 3);
  EXPECT_EQ(step.settings.deformer.method, DeformMethod::ft05);
  EXPECT_EQ(step.settings.refine_boundary, 0);
  const std::string as_version_2 = write_edit(edit);
  EXPECT_NE(as_version_2.find("\"version\": 2"), std::string::npos);
  EXPECT_EQ(write_edit(parse_edit(as_version_2, "e.json")), as_version_2);
}

struct Refusal {
  std::string text;
  std::string message;  // text that the message must contain
};

TEST(EditFile, NamesTheFieldThatIsWrong) {
  const std::vector<Refusal> refusals = {
      {"", "line 1, column 1: is not valid JSON"},
      {"{\"format\": \"meshgraft-edit\",\n \"version\": 2,,}",
       "edit.json, line 2, column 15: is not valid JSON"},
      {"[]", "edit.json: is not an edit file"},
      {R"({"format": "meshgraft-edit", "version": 3})", "version: version 3 is not known"},
      {R"({"format": "meshgraft-edit", "version": "2"})", "version: expected an integer, found a string"},
      {R"({"format": "meshgraft-edit", "version": 2, "version": 2})", "the field 'version' is given twice"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {}, "steps": []})",
       "inputs: expected an object with at least one mesh"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {}}, "steps": []})",
       "inputs.a: expected exactly one of the fields file, sample"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"file": "a", "sha256": "AB"}}, "steps": []})",
       "inputs.a.sha256: expected 64 lower-case hexadecimal digits"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"sample": "bar", "sha256": "AB"}}, "steps": []})",
       "inputs.a.sha256: 'sha256' goes with 'file'"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"sample": "bar", "resolution": 2}}, "steps": []})",
       "inputs.a.resolution: must be from 4 to 4096"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"sample": "bar", "up": "z"}}, "steps": []})",
       "inputs.a: 'up' goes with 'front'"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"sample": "bar", "up": "z", "front": "+y"}}, "steps": []})",
       "inputs.a.front: expected an axis"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"sample": "bar", "up": "z", "front": [0, 0, 2]}}, "steps": []})",
       "inputs.a: up and front are no orientation"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"file": "a"}}, "steps": []})",
       "steps: expected at least one step"},
      {R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"file": "a"}},
           "steps": [{"kind": "deform", "mesh": "a"}], "output": "b"})",
       "output: there is no mesh named 'b'"},
      {file_with_step(R"("handels": [])"), "steps[0]: unknown field 'handels'. Did you mean 'handles'?"},
      {file_with_step(R"("region": "topp")"),
       "steps[0].region: there is no selection named 'topp'. Did you mean 'top'?"},
      {file_with_step(R"("region": {})"), "steps[0].region: expected exactly one field"},
      {file_with_step(R"("region": {"box": {"min": [1, 0, 0], "max": [0, 1, 1]}})"),
       "steps[0].region.box: 'min' is greater than 'max'"},
      {file_with_step(R"("region": {"sphere": {"centre": [0, 0], "radius": 1}})"),
       "steps[0].region.sphere.centre: expected 3 numbers"},
      {file_with_step(R"("region": {"sphere": {"centre": [0, 0, 0], "radius": -1}})"),
       "steps[0].region.sphere.radius: must be positive, is -1"},
      {file_with_step(R"("region": {"half_space": {"point": [0, 0, 0], "normal": [0, 0, 0]}})"),
       "half_space.normal: must not be the zero vector"},
      {file_with_step(R"("region": {"indices": [0, 1.5]})"), "region.indices[1]: expected an integer"},
      {file_with_step(R"("region": {"indices": [-1]})"), "region.indices[0]: must be from 0 to"},
      {file_with_step(R"("region": {"union": ["top", {"grow": {"of": "top"}}]})"),
       "region.union[1].grow: the field 'rings' is missing"},
      {file_with_step(R"("region": {"sel": "x.sel"})"), "expected the fields 'sel' and 'take'"},
      {file_with_step(R"("region": {"take": "free"})"), "'take' goes with 'sel'"},
      {file_with_step(R"("region": {"sel": "x.sel", "take": "fre"})"),
       "region.take: unknown word 'fre'. Did you mean 'free'?"},
      {file_with_step(R"("handles": [{"select": "top"}])"), "handles[0]: the field 'name' is missing"},
      {file_with_step(R"("handles": [{"name": "h", "select": "top"}, {"name": "h", "select": "top"}])"),
       "handles[1].name: the name 'h' is already taken"},
      {file_with_step(handle(R"("shape": "ring")")), "handles[0].shape: unknown word 'ring'"},
      {file_with_step(handle(R"("closed": true)")), "handles[0].closed: only a handle of shape 'curve'"},
      {file_with_step(handle(R"("constrain": "none")")), "handles[0].constrain: unknown word 'none'"},
      {file_with_step(handle(R"("pose": {"rotate": {"axis": [0, 1], "angle_deg": 3}})")),
       "edit.json: steps[0].handles[0].pose.rotate.axis: expected 3 numbers"},
      {file_with_step(handle(R"("pose": {"rotate": {"axis": [0, 0, 1], "angle": 3}})")),
       "pose.rotate: unknown field 'angle'"},
      {file_with_step(handle(R"("pose": {"scale": "2"})")), "pose.scale: expected a number or 3 numbers"},
      {file_with_step(handle(R"("pose": {"matrix": [[1]], "scale": 2})")), "'matrix' says the whole pose"},
      {file_with_step(
           handle(R"("pose": {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]})")),
       "pose.matrix[3]: must be 0, 0, 0, 1"},
      {file_with_step(handle(R"("pose": {"matrix": [[1, 0, 0, 0], [0, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]})")),
       "pose.matrix[1]: expected 4 numbers"},
      {file_with_step(handle(R"("pose": {"curve": [[0, 0, 0], [1, 1, 1]]})")),
       "only a handle of shape 'curve'"},
      {file_with_step(R"("targets": [{"vertex": 1}])"), "targets[0]: the field 'position' is missing"},
      {file_with_step(R"("transforms": [{"vertex": 1, "matrix": [[1, 0, 0]]}])"),
       "transforms[0].matrix: expected 3 rows of 3 numbers"},
      {file_with_step(R"("anchors": [{"select": "top", "weight": 0}])"), "anchors[0].weight: must be positive"},
      {file_with_step(R"("settings": {"weights": "cotan"})"), "settings.weights: unknown word 'cotan'"},
      {file_with_step(R"("settings": {"method": "corotationl"})"),
       "settings.method: unknown word 'corotationl'. Did you mean 'corotational'?"},
      {file_with_step(R"("settings": {"stiffness": -0.5})"), "settings.stiffness: must be from 0 to"},
      {file_with_step(R"("settings": {"iterations": 1001})"),
       "settings.iterations: must be from 0 to 1000, is 1001"},
      {file_with_step(R"("settings": {"iterations": 2.5})"), "settings.iterations: expected an integer"},
      {file_with_step(R"("settings": {"smoothing_length_rel": 11})"),
       "settings.smoothing_length_rel: must be from 0 to 10, is 11"},
      {file_with_step(R"("settings": {"laplacian_order": 4})"),
       "settings.laplacian_order: must be from 1 to 3, is 4"},
      {file_with_step(R"("settings": {"seed": -1})"), "settings.seed: expected an integer from 0 on"},
      {file_with_step(R"("counts": {"roi": 3})"), "counts: unknown field 'roi'"},
  };
  for (const Refusal& expected : refusals)
    EXPECT_NE(refusal(expected.text).find(expected.message), std::string::npos)
        << expected.text << "\nsays: " << refusal(expected.text) << "\nnot:  " << expected.message;
}

Error error_of(const std::string& text) {
  try {
    parse_edit(text, "edit.json");
  } catch (const Error& error) {
    return error;
  }
  throw std::logic_error("accepted: " + text);
}

TEST(EditFile, SaysInFieldsWhatItExpectedAndFound) {
  const Error type = error_of(file_with_step(R"("region": 3)"));
  EXPECT_EQ(type.id(), "script.wrong_type");
  EXPECT_EQ(type.location().text(), "edit.json: steps[0].region");
  EXPECT_EQ(type.fact().get<std::string>("expected"), "object");
  EXPECT_EQ(type.fact().get<std::string>("found"), "number");

  const Error misspelt = error_of(file_with_step(R"("handels": [])"));
  EXPECT_EQ(misspelt.id(), "script.misspelt_field");
  EXPECT_EQ(misspelt.fact().get<std::string>("field"), "handels");
  EXPECT_EQ(misspelt.fact().get<std::string>("meant"), "handles");
  const Error unknown = error_of(file_with_step(R"("counts": {"qqqqqq": 3})"));
  EXPECT_EQ(unknown.id(), "script.unknown_field");
  EXPECT_EQ(unknown.fact().get<std::vector<std::string>>("known"),
            (std::vector<std::string>{"vertices", "faces", "region", "fixed", "handle", "free"}));
  EXPECT_EQ(unknown.remedy(), "Known are vertices, faces, region, fixed, handle, free.");

  const Error range = error_of(file_with_step(R"("settings": {"iterations": 1001})"));
  EXPECT_EQ(range.id(), "core.out_of_range");
  EXPECT_EQ(range.fact().get<double>("low"), 0);
  EXPECT_EQ(range.fact().get<double>("high"), 1000);
  EXPECT_EQ(range.fact().get<double>("value"), 1001);
  EXPECT_EQ(error_of(file_with_step(R"("anchors": [{}])")).id(), "script.missing_field");

  const std::string coloured = R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"file": "a"}},
      "selections": {"top": {"loop": 0}}, "colours": {"topp": "#112233"}, "steps": [{"kind": "deform", "mesh": "a"}]})";
  EXPECT_STREQ(error_of(coloured).what(),
               "edit.json: colours.topp: there is no selection named 'topp'. Did you mean 'top'?");
}

TEST(EditFile, RefusesSelectionsThatUseThemselves) {
  const auto with_selections = [](const std::string& selections) {
    return R"({"format": "meshgraft-edit", "version": 2, "inputs": {"a": {"file": "a"}}, "selections": {)" +
           selections + R"(}, "steps": [{"kind": "deform", "mesh": "a"}]})";
  };
  EXPECT_NE(refusal(with_selections(R"("a": {"grow": {"of": "a", "rings": 1}})"))
                .find("selections.a: a selection uses itself"),
            std::string::npos);
  EXPECT_NE(refusal(with_selections(R"("a": "b", "b": "c", "c": "a")")).find("in a circle"), std::string::npos);
  EXPECT_NE(refusal(with_selections(R"("all": {"loop": 0})")).find("'all' already means every vertex"),
            std::string::npos);
  std::string chain = R"("s0": {"loop": 0})";
  for (int i = 1; i < 200; ++i) chain += ", \"s" + std::to_string(i) + "\": \"s" + std::to_string(i - 1) + "\"";
  EXPECT_NE(refusal(with_selections(chain)).find("deep"), std::string::npos);
}

TEST(EditFile, BoundsTheNesting) {
  std::string deep = "\"top\"";
  for (int i = 0; i < 10000; ++i) deep = R"({"union": [)" + deep + "]}";
  EXPECT_NE(refusal(file_with_step("\"region\": " + deep)).find("nested more than 64 deep"), std::string::npos);
}

TEST(EditFile, NamesTheFilesItNeeds) {
  const EditFile edit = parse_edit(
      file_with_step(
          R"("region": {"union": [{"file": "a.txt"}, {"sel": "b.sel", "take": "handle"}, {"file": "a.txt"}]},
                        "handles": [{"name": "h", "select": "top", "pose": {"def": "c.def"}}])"),
      "edit.json", "folder");
  std::vector<std::string> names;
  for (const auto& path : referenced_files(edit)) names.push_back(path.generic_string());
  EXPECT_EQ(names,
            (std::vector<std::string>{"folder/body.ply", "folder/a.txt", "folder/b.sel", "folder/c.def"}));
}

TEST(EditFile, ReadsTheFormerNameOfASettingAndSaysSo) {
  const EditFile edit = parse_edit(R"({"format": "meshgraft-edit", "version": 2,
      "inputs": {"a": {"file": "a.ply"}, "b": {"file": "b.ply"}},
      "steps": [{"kind": "merge", "target": "a", "source": "b", "settings": {"smoothing_steps": 5}}]})",
                                   "edit.json");
  EXPECT_EQ(std::get<MergeStep>(edit.steps[0].action).settings.seam.fairings, 5);
  ASSERT_EQ(edit.notes.size(), 1U);
  EXPECT_EQ(edit.notes[0].id(), "script.former_setting");
  EXPECT_EQ(edit.notes[0].text(),
            "edit.json: steps[0].settings: the setting 'smoothing_steps' is called 'fairings' now");
  EXPECT_EQ(write_edit(edit).find("smoothing_steps"), std::string::npos);
}

TEST(EditFile, ReadsTheFormerNameOfASolverAndSaysSo) {
  const std::string former = R"("settings": {"backend": "cholmod"})",
                    merge = R"({"format": "meshgraft-edit", "version": 2,
      "inputs": {"a": {"file": "a.ply"}, "b": {"file": "b.ply"}},
      "steps": [{"kind": "merge", "target": "a", "source": "b", )" +
                            former + "}]}";
  const EditFile edit = parse_edit(file_with_step(former), "edit.json");
  EXPECT_EQ(first_step(edit).settings.deformer.backend, SolverBackend::multifrontal);
  ASSERT_EQ(edit.notes.size(), 1U);
  EXPECT_EQ(edit.notes[0].id(), "script.former_backend");
  EXPECT_EQ(edit.notes[0].get<std::string>("location"), "edit.json: steps[0].settings.backend");
  EXPECT_EQ(edit.notes[0].text().rfind("edit.json: steps[0].settings.backend: ", 0), 0U)
      << edit.notes[0].text();
  EXPECT_NE(edit.notes[0].text().find("'multifrontal'"), std::string::npos) << edit.notes[0].text();
  EXPECT_EQ(parse_edit(merge, "edit.json").notes.size(), 1U);

  // The solver is written by its present name, which needs no note.
  const EditFile again = parse_edit(write_edit(edit), "edit.json");
  EXPECT_EQ(first_step(again).settings.deformer.backend, SolverBackend::multifrontal);
  EXPECT_TRUE(again.notes.empty());
  EXPECT_TRUE(parse_edit(file_with_step(R"("settings": {"backend": "auto"})"), "edit.json").notes.empty());
  EXPECT_NE(refusal(file_with_step(R"("settings": {"backend": "cholesky"})")).find("multifrontal"),
            std::string::npos);
}

// The schema test runs over the same files with the same expectation.
TEST(EditFile, AgreesWithTheSchemaOnTheCorpus) {
  int files = 0;
  for (const std::string kind : {"accepted", "refused"}) {
    for (const auto& entry : std::filesystem::directory_iterator(test::source_path("tests/script") / kind)) {
      ++files;
      if (kind == "accepted")
        EXPECT_NO_THROW(read_edit_file(entry.path())) << entry.path();
      else
        EXPECT_THROW(read_edit_file(entry.path()), Error) << entry.path();
    }
  }
  EXPECT_GE(files, 20);
}

}  // namespace
}  // namespace meshgraft
