#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/run_edit.h>

#include "mesh/join.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

// A bumpy ball is cut apart, its cap put back, and the cap bent: three kinds of steps in one file.
const std::string cuts = R"(
  {"kind": "cut", "name": "open", "mesh": "ball", "result": "body",
   "plane": {"point": [0, 0, 0.3], "normal": [0, 0, 1]}, "keep": "below"},
  {"kind": "cut", "name": "take", "mesh": "ball", "result": "cap",
   "plane": {"point": [0, 0, 0.3], "normal": [0, 0, 1]}, "keep": "above"})";
const std::string by_loops = R"("pairs": [{"source_loop": {"produced": {"step": "take", "what": "loop"}},
                                          "target_loop": {"produced": {"step": "open", "what": "loop"}}}])";

class MergeEdit : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("meshgraft_merge_edit_") + test->name());
    std::filesystem::create_directories(folder_);
    const test::TestMesh ball = test::bumpy_sphere(3);
    Mesh mesh = make_mesh(ball.positions, ball.triangles);
    Attribute height{.name = "height"};
    for (Index v = 0; v < mesh.vertex_count(); ++v) height.values.push_back(mesh.positions(v, 2));
    mesh.attributes.push_back(height);
    write_mesh(mesh, folder_ / "ball.ply");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  EditFile edit(const std::string& steps) const {
    return parse_edit(R"({"format": "meshgraft-edit", "version": 2, "inputs": {"ball": {"file": "ball.ply"}},
                          "steps": [)" +
                          steps + "]}",
                      "edit.json", folder_);
  }
  EditFile merge(const std::string& fields, const std::string& more = "") const {
    return edit(cuts +
                R"(, {"kind": "merge", "name": "graft", "target": "body", "source": "cap", "result": "whole")" +
                (fields.empty() ? "" : ", " + fields) + "}" + more);
  }
  // Returns the source as the merge step sees it.
  Mesh cap() const {
    EditFile only_cuts = edit(cuts);
    only_cuts.output = "cap";
    return run_edit(only_cuts).mesh;
  }
  // Returns the largest distance of vertices from the best similarity of their former positions, × their
  // size.
  static double distance_from_similarity(const Points& from, const Points& to,
                                         const std::vector<Index>& vertices) {
    Eigen::Matrix3Xd a(3, vertices.size()), b(3, vertices.size());
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      a.col(static_cast<Eigen::Index>(k)) = from.row(vertices[k]).transpose();
      b.col(static_cast<Eigen::Index>(k)) = to.row(vertices[k]).transpose();
    }
    const Eigen::Matrix4d fit = Eigen::umeyama(a, b, true);
    const Eigen::Matrix3Xd off = ((fit.topLeftCorner<3, 3>() * a).colwise() + fit.col(3).head<3>()) - b;
    return off.colwise().norm().maxCoeff() / (b.colwise() - b.rowwise().mean()).colwise().norm().maxCoeff();
  }
  std::string message(const std::string& fields) const {
    try {
      run_edit(merge(fields));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      return error.what();
    }
    return "(accepted)";
  }

  std::filesystem::path folder_;
};

TEST_F(MergeEdit, CutsMergesAndDeformsInOneFile) {
  const EditResult merged = run_edit(merge(R"("pose": "keep", )" + by_loops));
  const TopologySummary topology = summarise_topology(merged.mesh);
  EXPECT_TRUE(topology.closed && topology.manifold && topology.oriented);
  EXPECT_EQ(topology.genus, 0);
  EXPECT_NE(dynamic_cast<const JoinedSources*>(merged.mesh.source.get()), nullptr) << "no file has its faces";
  EXPECT_FALSE(merged.report.deformed);

  const std::string bend = R"(, {"kind": "deform", "mesh": "whole",
    "region": {"produced": {"step": "graft", "what": "source"}},
    "handles": [{"name": "top", "select": {"nearest": [0, 0, 2]}, "pose": {"translate": [0, 0, 0.5]}}]})";
  const EditResult bent = run_edit(merge(R"("pose": "keep", )" + by_loops, bend));
  EXPECT_TRUE(bent.report.deformed);
  EXPECT_EQ(bent.rest, merged.mesh.positions);
  EXPECT_NEAR(bent.report.max_displacement, 0.5, 0.1);
  const MergeOutcome& outcome = *bent.report.steps[2].merge;
  const std::vector<Index>& from_source = outcome.source_map.new_index;
  for (const Index v : outcome.target_map.new_index) {
    if (v < 0 || std::find(from_source.begin(), from_source.end(), v) != from_source.end()) continue;
    ASSERT_EQ(bent.mesh.positions.row(v), bent.rest.row(v)) << "the body is not in the region";
  }
}

TEST_F(MergeEdit, IsNotSolvedAsAShellAndSaysSo) {
  const EditFile edit = merge(R"("pose": "keep", )" + by_loops);
  const EditResult shell = run_edit(edit, {.overrides = {.method = DeformMethod::shell}});
  EXPECT_EQ(shell.mesh.positions, run_edit(edit).mesh.positions);
  const std::vector<Note>& notes = shell.report.steps[2].notes;
  EXPECT_EQ(std::count_if(notes.begin(), notes.end(),
                          [](const Note& note) { return note.id() == "script.merge_without_shell"; }),
            1);
}

TEST_F(MergeEdit, PartsKeepWhatTheirModelTellsOfUpAndFront) {
  EditFile guessed = merge(by_loops);
  const MergeOptions of_guess = run_edit(guessed).report.steps[2].merge->options;
  EXPECT_EQ(of_guess.source_orientations.size(), 24U);
  ASSERT_EQ(of_guess.target_orientations.size(), 24U);
  for (std::size_t k = 0; k < 24; ++k)
    EXPECT_EQ(of_guess.source_orientations[k].probability, of_guess.target_orientations[k].probability);

  // It turns with the source.
  EditFile told =
      merge(by_loops + R"(, "source_transform": [[0, -2, 0, 1], [2, 0, 0, 1], [0, 0, 2, 1], [0, 0, 0, 1]])");
  told.inputs.front().orientation = make_orientation(Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ());
  const MergeOptions options = run_edit(told).report.steps[2].merge->options;
  ASSERT_EQ(options.source_orientations.size(), 1U);
  EXPECT_TRUE(options.target_orientations.front().orientation.up.isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(options.source_orientations.front().orientation.up.isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(options.source_orientations.front().orientation.front.isApprox(Eigen::Vector3d::UnitZ()));
}

TEST_F(MergeEdit, GoesOnBesideWhatIsRefused) {
  Mesh ball = read_mesh(folder_ / "ball.ply");
  Index lowest = 0;
  ball.positions.col(2).minCoeff(&lowest);
  const Mesh whole = ball;
  ball.positions(lowest, 0) = NAN;
  write_mesh(ball, folder_ / "ball.ply");
  const EditResult result = run_edit(merge(by_loops));
  EXPECT_EQ(result.mesh.positions.array().isNaN().count(), 1);
  const std::vector<Note>& notes = result.report.steps[0].notes;
  ASSERT_EQ(notes.size(), 1);
  EXPECT_EQ(notes[0].id(), "mesh.faces_left_out");
  EXPECT_GT(notes[0].get<std::int64_t>("count"), 1);
  EXPECT_TRUE(summarise_topology(result.mesh).manifold);

  ball = whole;
  (ball.positions.col(2).array() + 0.4).abs().minCoeff(&lowest);
  ball.positions.row(lowest).fill(NAN);  // nearer to the cut
  write_mesh(ball, folder_ / "ball.ply");
  EXPECT_EQ(run_edit(merge(by_loops)).mesh.positions.array().isNaN().count(), 3);
  (ball.positions.col(2).array() - 0.3).abs().minCoeff(&lowest);
  ball.positions.row(lowest).fill(NAN);
  write_mesh(ball, folder_ / "ball.ply");
  EXPECT_NE(message(by_loops).find("within reach"), std::string::npos) << message(by_loops);
}

TEST_F(MergeEdit, KeepsAttributesAndMapsVertices) {
  const EditResult result = run_edit(merge(R"("pose": "keep", "settings": {"band": 0}, )" + by_loops));
  const MergeOutcome& outcome = *result.report.steps[2].merge;
  const Attribute* height = result.mesh.find_attribute(Domain::vertex, "height");
  ASSERT_NE(height, nullptr);
  Index kept = 0;
  for (const Index v : outcome.target_map.new_index) {
    if (v < 0) continue;
    ++kept;
    EXPECT_NEAR(height->values[static_cast<std::size_t>(v)], result.mesh.positions(v, 2), 1e-6);
  }
  EXPECT_GT(kept, 100);
  EXPECT_FALSE(outcome.new_faces.empty());
  EXPECT_NE(result.mesh.find_attribute(Domain::face, "group"), nullptr);
}

TEST_F(MergeEdit, AFeatureOfTheSourceFollowsOneSimilarity) {
  // A field of the merge step makes the top of the cap a feature.
  const EditResult result = run_edit(merge(
      R"("shape": "ft05", "normal_angle_deg": 30, "features": [{"select": {"half_space": {"point": [0, 0, 0.7], "normal": [0, 0, 1]}}}], )" +
      by_loops));
  const EditResult plain = run_edit(merge(R"("shape": "ft05", "normal_angle_deg": 30, )" + by_loops));
  const MergeOutcome& outcome = *result.report.steps[2].merge;
  ASSERT_EQ(outcome.options.features.size(), 1u);
  const std::vector<Index>& feature = outcome.options.features[0].vertices;
  ASSERT_GT(feature.size(), 20u);
  EXPECT_TRUE(outcome.options.features[0].similarity);
  const Mesh source = cap();
  EXPECT_LT(distance_from_similarity(source.positions, outcome.grafted, feature), 1e-9);
  EXPECT_GT(distance_from_similarity(source.positions, plain.report.steps[2].merge->grafted, feature), 1e-6)
      << "without it the part is bent there";
}

TEST_F(MergeEdit, NamesTheFieldThatDoesNotFit) {
  const auto says = [&](const std::string& fields, const std::string& words) {
    const std::string text = message(fields);
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  says(R"("pairs": [{"source_loop": {"indices": [0, 1, 2]}, "target_loop": {"loop": 0}}])",
       "edit.json: steps[2].pairs[0].source_loop: ");
  says(R"("pairs": [{"source_loop": {"loop": 0}, "target_loop": {"loop": 7}}])",
       "steps[2].pairs[0].target_loop");
  says(R"("matches": [[999999, 0]])", "steps[2].matches[0]: there is no vertex 999999 among the source's");
  says(R"("pairs": [{"source_loop": {"loop": 9}, "target_loop": {"loop": 0}}])",
       "the source has no boundary loop 9. Its 1 loop has so many vertices, from loop 0 on: ");
  says(R"("matches": [[0, 0]])", "steps[2].matches[0]: vertex 0 is not on a boundary of the source");
  says(R"("counts": {"source_vertices": 3})", "steps[2].counts.source_vertices: 3 expected");
  says(R"("at": {"vertex": 999999})", "steps[2].at: ");
  says(
      R"("pairs": [{"source_loop": {"produced": {"step": "open", "what": "loop"}}, "target_loop": {"loop": 0}}])",
      "steps[2].pairs[0].source_loop: the step 'open' has produced nothing on this mesh");
  says(
      R"("pairs": [{"source_loop": {"produced": {"step": "tkae", "what": "loop"}}, "target_loop": {"loop": 0}}])",
      "there is no step named 'tkae'. Those that produced something here: take.");
  says(
      R"("pairs": [{"source_loop": {"produced": {"step": "take", "what": "rim"}}, "target_loop": {"loop": 0}}])",
      "the step 'take' produces no selection 'rim' on this mesh. It produces above, below, loop, loop 0.");
  try {
    parse_edit(
        R"({"format": "meshgraft-edit", "version": 2, "inputs": {"ball": {"sample": "bar"}}, "output": "zz",
      "steps": [{"kind": "cut", "mesh": "ball", "loop": [1, 2, 3]}, {"kind": "cut", "mesh": "ball", "loop": [1, 2, 3]}]})",
        "edit.json");
    FAIL() << "no step leaves 'zz'";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "edit.json: output: there is no mesh named 'zz'. Known are ball.");
  }
  EXPECT_THROW(run_edit(edit(R"({"kind": "merge", "target": "ball", "source": "ball"})")), Error);
}

}  // namespace
}  // namespace meshgraft
