#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/script/edit_file.h>

#include "support/paths.h"

namespace meshgraft {
namespace {

EditFile accepted(const std::string& name) {
  return read_edit_file(test::source_path("tests/script/accepted") / name);
}

// Returns a version 2 file whose only step grafts `arm` onto `body`.
std::string merge_with(const std::string& fields) {
  return R"({"format": "meshgraft-edit", "version": 2,
             "inputs": {"body": {"file": "body.ply"}, "arm": {"file": "arm.ply"}},
             "steps": [{"kind": "merge", "target": "body", "source": "arm")" +
         (fields.empty() ? "" : ", " + fields) + "}]}";
}

std::string merge_refusal(const std::string& text) {
  try {
    parse_edit(text, "edit.json");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    return error.what();
  }
  return "(accepted)";
}

TEST(MergeEditFile, ReadsBackWhatItWrites) {
  for (const std::string name : {"merge.json", "version_1_merge.json"}) {
    const std::string written = write_edit(accepted(name));
    EXPECT_EQ(write_edit(parse_edit(written, "edit.json")), written) << name;
  }
}

TEST(MergeEditFile, KeepsEveryField) {
  const EditFile edit = accepted("merge.json");
  const auto& cut = std::get<CutStep>(edit.steps.at(0).action);
  EXPECT_EQ(cut.mesh, "body");
  EXPECT_EQ(std::get<Plane>(cut.along).normal, Eigen::Vector3d(0, 0, 2));
  EXPECT_EQ(cut.options.keep, CutKeep::below);
  EXPECT_EQ(cut.options.snap, 0.2);
  EXPECT_EQ(outcome_of(edit.steps[0]), "torso");
  const auto& drawn = std::get<CutStep>(edit.steps.at(1).action);
  EXPECT_EQ(std::get<std::vector<Index>>(drawn.along), (std::vector<Index>{4, 8, 15}));
  EXPECT_EQ(drawn.options.keep, CutKeep::both);
  EXPECT_EQ(outcome_of(edit.steps[1]), "arm");

  const auto& merge = std::get<MergeStep>(edit.steps.at(2).action);
  EXPECT_EQ(mesh_of(edit.steps[2]), "torso");
  EXPECT_EQ(merge.pose, MergePose::keep);
  EXPECT_EQ(merge.shape, MergeShape::ft05);
  ASSERT_EQ(merge.pairs.size(), 2u);
  ASSERT_EQ(merge.pairs[0].matches.size(), 3u);
  EXPECT_EQ(merge.pairs[0].matches[0].source, VertexSpec(3));
  EXPECT_EQ(merge.pairs[0].matches[0].target, VertexSpec(7));
  EXPECT_TRUE(merge.pairs[1].matches.empty());
  EXPECT_EQ((*merge.source_transform)(1, 1), 2);
  EXPECT_EQ(merge.mirror->normal, Eigen::Vector3d::UnitX());
  EXPECT_EQ(merge.normal_angle_deg, -12.5);
  EXPECT_TRUE(merge.fixed.has_value());
  EXPECT_EQ(merge.reach.rings, 5);
  ASSERT_EQ(merge.features.size(), 2u);
  EXPECT_TRUE(merge.features[0].similarity);
  EXPECT_FALSE(merge.features[1].similarity);
  EXPECT_TRUE(merge.smooth_boundary);
  EXPECT_TRUE(merge.fix_winding);
  EXPECT_FALSE(merge.retry);
  EXPECT_EQ(merge.settings.deformer.method, DeformMethod::rotation_aware);
  EXPECT_EQ(merge.settings.seam.strip, StripMethod::greedy);
  EXPECT_EQ(merge.settings.seam.edge_ratio, 3);
  EXPECT_EQ(merge.settings.seam.fairings, 4);
  EXPECT_EQ(merge.settings.seam.target_rings, 0);
  EXPECT_EQ(merge.settings.seam.sharp_angle_deg, 30);
  EXPECT_EQ(merge.settings.seam.blend_colours, 0.25);
  EXPECT_EQ(merge.counts.source_loops, (std::vector<Index>{3, 3}));
  EXPECT_EQ(merge.counts.free, 1);

  const auto& matched = std::get<MergeStep>(edit.steps.at(3).action);
  EXPECT_EQ(matched.matches.size(), 2u);
  EXPECT_EQ(matched.align.size(), 3u);
  EXPECT_EQ(matched.size, 1.5);
  EXPECT_EQ(matched.reach.length, 0.25);
  const auto& dropped = std::get<MergeStep>(edit.steps.at(4).action);
  EXPECT_EQ(std::get<Eigen::Vector3d>(dropped.at->surface_point), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(dropped.at->spin_deg, 45);
  EXPECT_EQ(std::get<Index>(std::get<MergeStep>(edit.steps.at(5).action).at->surface_point), 5);
}

TEST(MergeEditFile, ReadsTheBaseOfADroppedSource) {
  const EditFile edit = accepted("drop_base.json");
  const auto& step = std::get<MergeStep>(edit.steps.at(0).action);
  ASSERT_TRUE(step.at && step.at->base);
  EXPECT_EQ(step.at->base->height, 0.25);
  EXPECT_EQ(step.at->base->tilt_deg, -15);
  EXPECT_EQ(step.at->base->tilt_axis, Eigen::Vector3d(0, 1, 0));
}

TEST(MergeEditFile, ReadsVersionOneAsAMergeByThePaper) {
  const EditFile edit = accepted("version_1_merge.json");
  ASSERT_EQ(edit.steps.size(), 1u);
  const auto& step = std::get<MergeStep>(edit.steps[0].action);
  EXPECT_EQ(step.shape, MergeShape::ft05);
  EXPECT_EQ(step.pose, MergePose::keep);
  EXPECT_EQ(step.settings.deformer.method, DeformMethod::corotational)
      << "for another shape, where one is asked for";
  ASSERT_EQ(step.pairs.size(), 1u);
  EXPECT_EQ(step.pairs[0].matches.size(), 2u)
      << "the start is listed among the correspondences and counts once";
  EXPECT_EQ(std::get<Selection::Indices>(step.fixed->kind).vertices, (std::vector<Index>{7, 8}));
  EXPECT_TRUE(step.source_transform.has_value());
  EXPECT_EQ(step.normal_angle_deg, 5);
  EXPECT_EQ(step.counts.fixed, 2);
  EXPECT_EQ(edit.inputs.size(), 2u);
}

TEST(MergeEditFile, NamesTheFieldThatIsWrong) {
  EXPECT_EQ(merge_refusal(merge_with("")), "(accepted)");
  EXPECT_EQ(merge_refusal(merge_with(R"("pair": [])")),
            "edit.json: steps[0]: unknown field 'pair'. Did you mean 'pairs'?");
  EXPECT_EQ(merge_refusal(merge_with(R"("pairs": [{"source_loop": {"loop": 0}, "target_loop": {"loop": 0},
                                            "matches": [[1, 2], [3, -4]]}])")),
            "edit.json: steps[0].pairs[0].matches[1][1]: must be from 0 to 2147483647, is -4");
  EXPECT_NE(merge_refusal(merge_with(R"("fixed": "all")")).find("steps[0].fixed: nothing can be fixed"),
            std::string::npos);
  EXPECT_NE(merge_refusal(merge_with(R"("fixed": "top", "pose": "keep")"))
                .find("steps[0].fixed: there is no selection"),
            std::string::npos);
  EXPECT_NE(merge_refusal(merge_with(R"("pairs": [{"source_loop": "a", "target_loop": "all"}])"))
                .find("steps[0].pairs[0].source_loop: there is no selection named 'a'"),
            std::string::npos);
  const std::string unknown =
      R"({"format": "meshgraft-edit", "version": 2, "inputs": {"body": {"file": "b.ply"}},
                                  "steps": [{"kind": "merge", "target": "body", "source": "arm"}]})";
  EXPECT_NE(merge_refusal(unknown).find("steps[0].source: there is no mesh named 'arm'"), std::string::npos);
}

TEST(MergeEditFile, ListsTheFilesOfItsSelections) {
  const EditFile edit = parse_edit(merge_with(R"("pose": "keep", "fixed": {"file": "top.txt"},
                    "features": [{"select": {"sel": "face.sel", "take": "handle"}}])"),
                                   "edit.json", "folder");
  std::vector<std::string> names;
  for (const auto& path : referenced_files(edit)) names.push_back(path.generic_string());
  EXPECT_EQ(names, (std::vector<std::string>{"folder/arm.ply", "folder/body.ply", "folder/top.txt",
                                             "folder/face.sel"}));
}

TEST(MergeEditFile, ReadsASelectionAlone) {
  const EditSelection spec = parse_selection(R"({"loop": 3})", "--fix");
  EXPECT_EQ(std::get<Selection::Loop>(spec.kind).number, 3);
  EXPECT_THROW(parse_selection(R"({"loop": -3})", "--fix"), Error);
  EXPECT_THROW(parse_selection("{", "--fix"), Error);
}

}  // namespace
}  // namespace meshgraft
