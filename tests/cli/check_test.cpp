#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/script/edit_file.h>

#include "command_line.h"
#include "mesh/shapes.h"
#include "support/defects.h"

namespace meshgraft::test {
namespace {

using nlohmann::json;

// A check names whatever a repair would change, and whatever keeps a deformation from working.
TEST_F(CommandLine, CheckNamesWhatARepairChanges) {
  std::vector<DirtyScan> meshes = dirty_scans();
  meshes.push_back({"t_junctions", "", with_t_junctions(shapes::torus(40, 20, true), 3, 1)});
  meshes.push_back({"floating_bits", "", with_floating_bits(shapes::torus(40, 20, true), 2, 1)});
  meshes.push_back({"noisy_soup", "", with_noise(as_soup(shapes::torus(40, 20, true)), 1e-8, 1)});
  const Mesh torus = shapes::torus(40, 20, true);
  for (const double distance : {1e5, 1e7, 1e12, 1e30, 1e100, 1e300})
    for (const std::vector<Index>& moved : {std::vector<Index>{100}, {100, 101}, {5, 300}, {0, 799}})
      meshes.push_back({fmt::format("{} outlying at {}", moved.size(), distance), "",
                        with_outlying(torus, moved, distance)});
  meshes.push_back({"outlying in no face", "", with_outlying(with_isolated(torus, 1, 1), {800}, 1e61)});
  meshes.push_back({"clean", "", torus});
  for (const DirtyScan& scan : meshes) {
    SCOPED_TRACE(scan.name);
    write_mesh(scan.mesh, folder_ / "scan.ply");
    const Outcome check = run("check scan.ply --json");
    const json checked = json::parse(check.out);
    const json repaired = json::parse(run("repair scan.ply --dry-run --json").out);
    bool mends = false;
    std::vector<std::string> named, changed;
    for (const json& change : checked["repair"]) {
      named.push_back(change["name"]);
      mends |= !change["choice"].get<bool>();
    }
    for (const json& change : repaired["changes"]) changed.push_back(change["name"]);
    EXPECT_EQ(named, changed);
    const bool has_defects = std::ranges::any_of(
        checked["findings"], [](const json& finding) { return finding["name"] != "polygon"; });
    EXPECT_EQ(check.status, mends || has_defects ? 3 : 0) << check.out;
    const Mesh mended = repair(scan.mesh).mesh;
    if (!try_deform(scan.mesh).works) {
      EXPECT_EQ(check.status, 3);
      const auto tried = try_deform(mended);
      EXPECT_TRUE(tried.works) << tried.reason;
    }
    const Eigen::RowVector3d centre = mended.positions.colwise().mean();
    const std::string middle =
        fmt::format("--plane {},{},{},1,2,3 -o half.ply --force", centre.x(), centre.y(), centre.z());
    const Outcome cut = run("cut scan.ply " + middle);
    if (cut.status != 0) {
      EXPECT_EQ(check.status, 3) << cut.err;
      write_mesh(mended, folder_ / "repaired.ply");
      const Outcome again = run("cut repaired.ply " + middle);
      EXPECT_EQ(again.status, 0) << again.err;
    }
  }
  EXPECT_EQ(run("check scan.ply").status, 0);
}

// No repair makes a mesh smaller: the remedy is the user's, and no command is prescribed.
TEST_F(CommandLine, CheckNamesMeshesThatAreTooLargeAsAWhole) {
  Mesh torus = shapes::torus(12, 8, true);
  for (const double size : {1e30, 1e59, 1e61, 1e120, 1e300}) {
    SCOPED_TRACE(size);
    Mesh large = torus;
    large.positions *= size;
    write_mesh(large, folder_ / "large.ply");
    const Outcome check = run("check large.ply");
    const Outcome cut = run("cut large.ply --plane x=0 -o half.ply --force");
    EXPECT_EQ(check.status, size < 1e60 ? 0 : 3) << check.out;
    EXPECT_EQ(cut.status, check.status) << cut.err;
    EXPECT_EQ(check.out.find("to mend"), std::string::npos) << check.out;
    EXPECT_EQ(check.out.find("Scale the mesh down") != std::string::npos, size > 1e60) << check.out;
    if (size > 1e60) EXPECT_NE(cut.err.find("Scale the mesh down"), std::string::npos) << cut.err;
  }
}

// The command that a check prescribes works as it is, whatever the file is called.
TEST_F(CommandLine, CheckPrescribesACommandThatWorks) {
  write_mesh(with_t_junctions(shapes::torus(12, 8, true), 3, 1), folder_ / "scan.ply");
  for (const std::string name : {"my $(scan).ply", "it's.ply", "-scan.ply", "scan.txt", "scan"}) {
    SCOPED_TRACE(name);
    std::filesystem::copy_file(folder_ / "scan.ply", folder_ / name);
    const Outcome check = run("check \"./" + (name[0] == 'm' ? "my \\$(scan).ply" : name) + "\"");
    const std::string label = "to mend     meshgraft ";
    const std::size_t begin = check.out.find(label);
    ASSERT_NE(begin, std::string::npos) << check.out;
    const std::size_t at = begin + label.size();
    const Outcome repair = run(check.out.substr(at, check.out.find('\n', at) - at));
    EXPECT_EQ(repair.status, 0) << repair.err;
  }
}

TEST_F(CommandLine, CheckNamesNoRepairThatLeavesNothing) {
  write_mesh(shapes::polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}), folder_ / "line.ply");
  const Outcome check = run("check line.ply");
  EXPECT_EQ(check.status, 3);
  EXPECT_NE(check.out.find("a repair would leave no face"), std::string::npos) << check.out;
}

// A surface with one side has no consistent orientation, so that a repair changes nothing.
TEST_F(CommandLine, CheckNamesNoRepairThatChangesNothing) {
  write_mesh(shapes::moebius_strip(), folder_ / "strip.ply");
  const Outcome check = run("check strip.ply");
  EXPECT_EQ(check.status, 3);
  EXPECT_NE(check.out.find("inconsistent-winding"), std::string::npos) << check.out;
  EXPECT_EQ(check.out.find("to mend"), std::string::npos) << check.out;
}

// Notes on the file itself, such as one that other methods made it, are no defects.
TEST_F(CommandLine, CheckTellsOfAnEditMadeWithOtherMethods) {
  const auto made_with = [&](int methods) {
    std::string text = edit();
    text.insert(text.find("\"inputs\""),
                R"("made_with": {"version": "0.0.1", "methods": )" + std::to_string(methods) + "}, ");
    write("made.json", text);
    return json::parse(run("check made.json --json").out);
  };
  const json notes = made_with(1000)["notes"];
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0]["id"], "script.other_methods");
  const Outcome outcome = run("check made.json");
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("note        the edit was made with meshgraft 0.0.1"), std::string::npos)
      << outcome.out;
  EXPECT_EQ(made_with(current_methods)["notes"], json::array());
}

// Openings may be meant, and intersections keep no command from working.
TEST_F(CommandLine, CheckTellsOfOpeningsAndIntersections) {
  write_mesh(without_faces(shapes::torus(40, 20, true), 1, 0, 1), folder_ / "open.ply");
  const Outcome open = run("check open.ply");
  EXPECT_EQ(open.status, 0) << open.out;
  EXPECT_NE(open.out.find("filled-hole"), std::string::npos) << open.out;
  Mesh moved = shapes::torus(40, 20, true);
  moved.positions.col(0).array() += 0.3;
  write_mesh(both(shapes::torus(40, 20, true), moved), folder_ / "two.ply");
  const Outcome two = run("check two.ply");
  EXPECT_EQ(two.status, 0) << two.out;
  EXPECT_NE(two.out.find("pairs of triangles of the surface intersect"), std::string::npos) << two.out;
  EXPECT_NE(two.out.find("each of the 2 components"), std::string::npos) << two.out;
  EXPECT_GT(json::parse(run("check two.ply --json").out)["self_intersections"], 10);
}

// Components that nothing holds keep an edit from running; only the edit knows which these are.
TEST_F(CommandLine, CheckRunsAnEditWithoutWriting) {
  write_mesh(with_floating_bits(shapes::torus(40, 20, true), 2, 1), folder_ / "scan.ply");
  const auto write_edit = [&](const std::string& file) {
    write("edit.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"scan": {"file": ")" + file +
                           R"("}}, "steps": [{"kind": "deform", "mesh": "scan", "region": "all", "handles": [
        {"name": "hand", "select": {"indices": [0, 1, 2, 3]}, "pose": {"translate": [0, 0, 1]}}]}]})");
  };
  write_edit("scan.ply");
  const Outcome loose = run("check edit.json");
  EXPECT_EQ(loose.status, 4) << loose.out;
  EXPECT_NE(loose.out.find("touches nothing that is fixed"), std::string::npos) << loose.out;
  const json told = json::parse(run("check edit.json --json").out);
  EXPECT_EQ(told["runs"], false);
  EXPECT_EQ(told["error"]["id"], "deform.component_not_held");
  EXPECT_EQ(told["inputs"][0]["repair"][0]["name"], "removed-debris");

  ASSERT_EQ(run("repair scan.ply -o scan_repaired.ply").status, 0);
  write_edit("scan_repaired.ply");
  const std::vector<std::string> files = new_files();
  const Outcome sound = run("check edit.json");
  EXPECT_EQ(sound.status, 0) << sound.out;
  EXPECT_EQ(new_files(), files);
}

}  // namespace
}  // namespace meshgraft::test
