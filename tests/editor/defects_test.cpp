// Tests the requests that show and repair the defects of a mesh, as a page sends them.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/script/run_edit.h>

#include "io/file.h"
#include "io/temporary_folder.h"
#include "page_client.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

constexpr std::uint32_t marks = 9;

class DefectsEditor : public testing::Test {
 protected:
  TemporaryFolder folder_;
  RunningEditor editor_{{folder_.path()}};
  Page page_{editor_.url()};

  static Mesh ball() {
    const TestMesh ball = bumpy_sphere(3);
    return make_mesh(ball.positions, ball.triangles);
  }
  /// Opens a mesh as `scan.ply` and returns the reply.
  Json open(const Mesh& mesh) {
    write_mesh(mesh, folder_ / "scan.ply");
    return page_.ask({{"do", "open"}, {"path", (folder_ / "scan.ply").string()}});
  }
  void open_damaged() { open(with_isolated(with_turned_patches(ball(), 2, 1, 3), 5, 5)); }
  Json state() { return page_.ask({{"do", "state"}}); }
  std::vector<std::string> kinds() {
    std::vector<std::string> kinds;
    const Json findings = state()["model"]["findings"];
    for (const Json& finding : findings) kinds.push_back(finding["kind"]);
    return kinds;
  }
  /// Returns the mesh that running the saved edit gives.
  Mesh replayed() {
    page_.ask({{"do", "save"}, {"edit", "edit.json"}, {"mesh", "saved.ply"}, {"overwrite", true}});
    Mesh mesh = run_edit(read_edit_file(folder_ / "edit.json")).mesh;
    write_mesh(mesh, folder_ / "replayed.ply");
    EXPECT_EQ(read_file(folder_ / "saved.ply"), read_file(folder_ / "replayed.ply"));
    return mesh;
  }
};

TEST_F(DefectsEditor, ListsEachKindWithTheNumberOfItsPlaces) {
  for (const FindingKind kind : defect_kinds()) {
    if (kind == FindingKind::duplicate_vertex) continue;  // an open seam is no defect for editing
    if (kind == FindingKind::index_out_of_range || kind == FindingKind::non_finite)
      continue;  // no OBJ holds it
    SCOPED_TRACE(name_of(kind));
    const Defective defective = inject(ball(), kind);
    if (defective.count == 0) continue;
    write_mesh(defective.mesh, folder_ / "scan.obj");
    page_.ask({{"do", "open"}, {"path", (folder_ / "scan.obj").string()}});
    const Json findings = state()["model"]["findings"];
    const auto found = std::ranges::find_if(
        findings, [&](const Json& finding) { return finding["kind"] == std::string(name_of(kind)); });
    ASSERT_NE(found, findings.end());
    EXPECT_TRUE((*found)["repairable"].get<bool>());
    EXPECT_EQ((*found)["note"]["fields"]["count"], defective.count);
    EXPECT_GT(page_.ask({{"do", "mark"}, {"finding", (*found)["kind"]}})["marked"], 0);
  }
}

TEST_F(DefectsEditor, MarksTheEdgesOfTurnedFaces) {
  open_damaged();
  const Json finding = state()["model"]["findings"][0];
  ASSERT_EQ(finding["kind"], "isolated-vertex");
  EXPECT_EQ(page_.ask({{"do", "mark"}, {"finding", "isolated-vertex"}})["marked"], 5);
  EXPECT_EQ(page_.frame(marks).numbers.at("points").size(), 15u);
  const Mesh mesh = read_mesh(folder_ / "scan.ply");
  const Diagnostics diagnostics = check_mesh(mesh);
  const Index edges = diagnostics.find(FindingKind::inconsistent_winding)->count;
  EXPECT_EQ(page_.ask({{"do", "mark"}, {"finding", "inconsistent-winding"}})["marked"], edges);
  const Frame frame = page_.frame(marks);
  EXPECT_EQ(frame.header["mesh"], state()["model"]["mesh"]);
  EXPECT_EQ(frame.numbers.at("lines").size(), 6u * static_cast<std::size_t>(edges));
  const std::vector<float>& lines = frame.numbers.at("lines");
  const std::vector<double> offset = frame.header["offset"];
  for (std::size_t at = 0; at < lines.size(); at += 3) {
    const Eigen::RowVector3d end(lines[at] + offset[0], lines[at + 1] + offset[1], lines[at + 2] + offset[2]);
    EXPECT_LT((mesh.positions.rowwise() - end).rowwise().norm().minCoeff(), 1e-6);
  }
}

TEST_F(DefectsEditor, RepairsOneKindAsAStep) {
  open_damaged();
  ASSERT_EQ(kinds(), (std::vector<std::string>{"isolated-vertex", "inconsistent-winding"}));
  const Json notes = page_.ask({{"do", "repair"}, {"kinds", {"isolated-vertex"}}})["notes"];
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0]["id"], "mesh.removed_isolated_vertex");
  EXPECT_EQ(notes[0]["fields"]["count"], 5);
  EXPECT_EQ(kinds(), std::vector<std::string>{"inconsistent-winding"});
  const Json steps = state()["steps"];
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0]["kind"], "repair");
  EXPECT_EQ(steps[0]["found"]["changes"], notes);
  EXPECT_EQ(steps[1]["kind"], "deform");
  page_.ask({{"do", "undo"}});
  EXPECT_EQ(kinds().size(), 2u);
  page_.ask({{"do", "redo"}});
  EXPECT_EQ(kinds(), std::vector<std::string>{"inconsistent-winding"});
}

TEST_F(DefectsEditor, RepairsAllAndRepeatsIt) {
  open_damaged();
  EXPECT_EQ(page_.ask({{"do", "repair"}})["notes"].size(), 2u);
  EXPECT_TRUE(kinds().empty());
  const Mesh expected = repair(read_mesh(folder_ / "scan.ply")).mesh, mesh = replayed();
  EXPECT_EQ(mesh.positions, expected.positions);
  EXPECT_EQ(mesh.faces, expected.faces);
  EXPECT_EQ(page_.refusal({{"do", "repair"}})["id"], "editor.nothing_to_repair");
}

// The step before ends, and what it made is repaired.
TEST_F(DefectsEditor, RepairsWhatAStepMade) {
  open_damaged();
  const std::vector<int> top = page_.vertices([](double, double, double z) { return z > 0.8; });
  page_.ask({{"do", "paint-handle"}, {"vertices", top}, {"name", "top"}, {"reach", 0.6}});
  page_.ask({{"do", "pose"}, {"poses", {{"top", {{"translate", {0, 0, 0.4}}}}}}});
  page_.ask({{"do", "repair"}});
  const Json steps = state()["steps"];
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[1]["kind"], "repair");
  const Mesh mesh = replayed();
  EXPECT_FALSE(check_mesh(mesh).has_defects());
  EXPECT_GT(mesh.positions.col(2).maxCoeff(), ball().positions.col(2).maxCoeff() + 0.3);
}

TEST_F(DefectsEditor, RepairsAPartBesideTheModel) {
  open(ball());
  write_mesh(with_isolated(ball(), 3, 1), folder_ / "part.ply");
  page_.ask({{"do", "part"}, {"what", "add"}, {"path", (folder_ / "part.ply").string()}});
  EXPECT_EQ(page_.refusal({{"do", "repair"}})["id"], "editor.nothing_to_repair");
  EXPECT_EQ(page_.ask({{"do", "mark"}, {"mesh", "part"}, {"finding", "isolated-vertex"}})["marked"], 3);
  page_.ask({{"do", "repair"}, {"mesh", "part"}});
  EXPECT_TRUE(state()["parts"][0]["findings"].empty());
  EXPECT_EQ(state()["model"]["name"], "scan");
}

TEST_F(DefectsEditor, KeepsTheSeamsThatACutOpened) {
  open(with_isolated(ball(), 3, 1));
  page_.ask({{"do", "cut"}, {"plane", {{"point", {0, 0, 0.2}}, {"normal", {0, 0, 1}}}}});
  ASSERT_EQ(state()["model"]["loops"], 2);
  page_.ask({{"do", "repair"}});
  EXPECT_TRUE(kinds().empty());
  EXPECT_EQ(state()["model"]["loops"], 2);
}

TEST_F(DefectsEditor, RefusesWhatIsNotThere) {
  EXPECT_EQ(page_.refusal({{"do", "repair"}})["id"], "editor.nothing_open");
  open_damaged();
  EXPECT_EQ(page_.refusal({{"do", "mark"}, {"finding", "polygon"}})["id"], "editor.no_such_finding");
  EXPECT_EQ(page_.refusal({{"do", "mark"}, {"finding", "dirt"}})["code"], "input");
  EXPECT_EQ(page_.refusal({{"do", "repair"}, {"kinds", {"zero-area-face"}}})["id"], "editor.no_such_finding");
  EXPECT_EQ(page_.refusal({{"do", "repair"}, {"kinds", Json::array()}})["code"], "input");
  EXPECT_EQ(page_.refusal({{"do", "repair"}, {"mesh", "none"}})["id"], "editor.no_such_part");
  EXPECT_EQ(state()["steps"].size(), 1u);
}

}  // namespace
}  // namespace meshgraft::test
