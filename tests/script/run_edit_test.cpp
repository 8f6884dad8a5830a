#include <meshgraft/script/run_edit.h>
#include <algorithm>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "deform/setup/memory_estimate.h"
#include "io/file.h"
#include "script/sha256.h"

namespace meshgraft {
namespace {

// Has a temporary folder with a bumpy sheet of 12 × 12 vertices in it.
class RunEdit : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("meshgraft_run_edit_") + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write_mesh(sheet(), folder_ / "sheet.ply");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static constexpr Index side = 12;

  static Mesh sheet() {
    Points positions(side * side, 3);
    Triangles triangles(2 * (side - 1) * (side - 1), 3);
    Index t = 0;
    for (Index y = 0; y < side; ++y) {
      for (Index x = 0; x < side; ++x) {
        positions.row(y * side + x) << x, y, 0.3 * std::sin(1.3 * x + 0.7 * y);
        if (x + 1 == side || y + 1 == side) continue;
        const Index v = y * side + x;
        triangles.row(t++) << v, v + 1, v + side + 1;
        triangles.row(t++) << v, v + side + 1, v + side;
      }
    }
    return make_mesh(positions, triangles);
  }

  // Returns a step with two fixed rows at y = 0, and a handle of two rows at the other end.
  static std::string step(const std::string& more = "",
                          const std::string& pose = R"({"translate": [0, 0, 3]})") {
    return R"({"kind": "deform", "mesh": "sheet",
      "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
      "handles": [{"name": "edge", "select": {"half_space": {"point": [0, 9.5, 0], "normal": [0, 1, 0]}}, "pose": )" +
           pose + "}]" + more + "}";
  }

  EditFile edit(const std::string& steps, const std::string& input = R"({"file": "sheet.ply"})") const {
    return parse_edit(R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": )" + input +
                          R"(}, "steps": [)" + steps + "]}",
                      "edit.json", folder_);
  }

  static std::string refusal(const EditFile& file) {
    try {
      run_edit(file);
    } catch (const Error& error) {
      return error.what();
    }
    return "(accepted)";
  }

  std::filesystem::path folder_;
};

/// Returns a soup in which every face has vertices of its own; v has the position of the mesh's vertex
/// `origin[v]`.
Mesh soup_of(const Mesh& mesh, std::vector<Index>& origin) {
  Mesh soup;
  origin = mesh.faces.corners();
  soup.positions.resize(static_cast<Eigen::Index>(origin.size()), 3);
  for (std::size_t c = 0; c < origin.size(); ++c)
    soup.positions.row(static_cast<Eigen::Index>(c)) = mesh.positions.row(origin[c]);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Index first = mesh.faces.first_corner(f);
    soup.faces.push_back(std::vector<Index>{first, first + 1, first + 2});
  }
  return soup;
}

TEST_F(RunEdit, SolvesASoupAsTheSurfaceThatItIsOf) {
  std::vector<Index> origin;
  const Mesh soup = soup_of(sheet(), origin);
  write_mesh(soup, folder_ / "soup.ply");
  const std::string within = R"({"kind": "deform", "mesh": "sheet",
      "region": {"grow": {"of": {"sphere": {"centre": [5, 6, 0], "radius": 2.5}}, "rings": 3}},
      "handles": [{"name": "bump", "select": {"sphere": {"centre": [5, 6, 0], "radius": 1.6}},
                   "pose": {"translate": [0, 0, 2]}}]})";
  for (const std::string& text : {step(), within}) {
    const EditResult whole = run_edit(edit(text));
    const EditResult result = run_edit(edit(text, R"({"file": "soup.ply"})"));
    EXPECT_EQ(result.mesh.faces, soup.faces);
    EXPECT_EQ(result.report.steps[0].counts.free, whole.report.steps[0].counts.free);
    for (Index v = 0; v < soup.vertex_count(); ++v)
      EXPECT_LT((result.mesh.positions.row(v) - whole.mesh.positions.row(origin[v])).norm(), 1e-8) << v;
    ASSERT_EQ(result.report.steps[0].notes.size(), 1U);
    EXPECT_EQ(result.report.steps[0].notes[0].id(), "script.welded");
  }
  EXPECT_NE(refusal(edit(step(R"(, "settings": {"weld": false})"), R"({"file": "soup.ply"})")), "(accepted)");
}

TEST_F(RunEdit, TakesTargetsOfAnyCopyOfAPlace) {
  std::vector<Index> origin;
  write_mesh(soup_of(sheet(), origin), folder_ / "soup.ply");
  const auto copies_of = [&](Index vertex) {
    std::vector<Index> copies;
    for (Index c = 0; c < static_cast<Index>(origin.size()); ++c)
      if (origin[c] == vertex) copies.push_back(c);
    return copies;
  };
  const std::vector<Index> copies = copies_of(5 * side + 5);
  const auto targets = [&](double second) {
    return R"(, "targets": [{"vertex": )" + std::to_string(copies[1]) +
           R"(, "position": [5, 5, 2]}, {"vertex": )" + std::to_string(copies[3]) + R"(, "position": [5, 5, )" +
           std::to_string(second) + "]}]";
  };
  const EditResult result = run_edit(edit(step(targets(2)), R"({"file": "soup.ply"})"));
  for (const Index v : copies) EXPECT_EQ(result.mesh.positions.row(v), Eigen::RowVector3d(5, 5, 2));
  EXPECT_NE(refusal(edit(step(targets(3)), R"({"file": "soup.ply"})")).find("two targets"), std::string::npos);
}

TEST_F(RunEdit, MovesCurvesOfAnyCopiesOfTheirVertices) {
  std::vector<Index> origin;
  write_mesh(soup_of(sheet(), origin), folder_ / "soup.ply");
  // The lists have the first copy, the last copy or all copies of each vertex of the line y = 5.
  std::array<std::string, 3> lists;
  for (Index x = 0; x < side; ++x) {
    std::vector<Index> copies;
    for (Index c = 0; c < static_cast<Index>(origin.size()); ++c)
      if (origin[c] == 5 * side + x) copies.push_back(c);
    const auto add = [](std::string& list, Index v) { list += (list.empty() ? "" : ", ") + std::to_string(v); };
    add(lists[0], copies.front());
    add(lists[1], copies.back());
    for (const Index c : copies) add(lists[2], c);
  }
  for (const std::string& list : lists) {
    const EditResult result = run_edit(edit(R"({"kind": "deform", "mesh": "sheet",
        "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
        "handles": [{"name": "line", "shape": "curve", "select": {"indices": [)" +
                                                list + R"(]},
                     "pose": {"translate": [0, 0, 2]}}]})",
                                            R"({"file": "soup.ply"})"));
    const Points moved = result.mesh.positions - result.rest;
    const Eigen::RowVector3d up(0, 0, 2);
    for (std::size_t c = 0; c < origin.size(); ++c) {
      if (origin[c] / side != 5) continue;
      EXPECT_LT((moved.row(static_cast<Index>(c)) - up).norm(), 1e-9) << list;
    }
  }
}

TEST_F(RunEdit, SaysWhichSizeOfPinsDoesNotFit) {
  const auto location_of = [](const std::string& pins) {
    const std::string text = R"({"format": "meshgraft-edit", "version": 2,
        "inputs": {"bar": {"sample": "bar", "resolution": 8}},
        "steps": [{"kind": "cut", "mesh": "bar", "plane": {"point": [0, 0, 2.1], "normal": [0, 0, 1]}, "pins": )";
    try {
      run_edit(parse_edit(text + pins + "}]}", "edit.json"));
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), "mesh.pins_do_not_fit");
      return error.location().text();
    }
    return std::string("(accepted)");
  };
  EXPECT_EQ(location_of(R"({"diameter": 3})"), "edit.json: steps[0].pins.diameter");
  EXPECT_EQ(location_of(R"({"diameter": 3, "length": 1})"), "edit.json: steps[0].pins.diameter");
  EXPECT_EQ(location_of(R"({"clearance": 3})"), "edit.json: steps[0].pins.clearance");
  EXPECT_EQ(location_of(R"({"diameter": 0.2, "length": 1})"), "(accepted)");
}

TEST_F(RunEdit, LetsWhatItCutComeApart) {
  const std::string cut = R"({"kind": "cut", "name": "halves", "mesh": "sheet",
      "plane": {"point": [0, 5.5, 0], "normal": [0, 1, 0]}, "keep": "both"}, )";
  const EditResult result = run_edit(edit(cut + R"({"kind": "deform", "mesh": "sheet",
      "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
      "handles": [{"name": "upper", "select": {"produced": {"step": "halves", "what": "above"}},
                   "pose": {"translate": [0, 4, 0]}}]})"));
  EXPECT_TRUE(result.report.steps[1].notes.empty());
  const Index seam = side + side - 1;  // edges of the sheet that cross the plane y = 5.5, with diagonals
  EXPECT_EQ(result.mesh.vertex_count(), side * side + 2 * seam);
  const auto moved = (result.mesh.positions - result.rest).rowwise().norm().eval();
  EXPECT_EQ((moved.array() > 3.9).count(), 6 * side + seam);
}

TEST_F(RunEdit, MovesHandlesExactlyKeepsTheFixedAndBendsTheRest) {
  const EditResult result = run_edit(edit(step()));
  const Points& rest = result.rest;
  const Points& edited = result.mesh.positions;
  for (Index v = 0; v < 2 * side; ++v) EXPECT_EQ(edited.row(v), rest.row(v));
  for (Index v = 10 * side; v < 12 * side; ++v)
    EXPECT_EQ(edited.row(v), rest.row(v) + Eigen::RowVector3d(0, 0, 3));
  const double middle = edited(5 * side + 6, 2) - rest(5 * side + 6, 2);
  EXPECT_GT(middle, 0.5);
  EXPECT_LT(middle, 2.5);
  EXPECT_EQ(result.report.counts.free, 8 * side);
  EXPECT_EQ(result.report.counts.fixed, 2 * side);
  EXPECT_EQ(result.report.counts.handle, 2 * side);
  EXPECT_DOUBLE_EQ(result.report.max_displacement, 3);
  EXPECT_LT(result.report.evaluation->residual, 1e-8);
}

TEST_F(RunEdit, FollowsAnAffineMapOfAllConstraintsExactly) {
  const std::string matrix = "[[1.2, 0.3, 0, 1], [-0.1, 0.8, 0.4, 2], [0.2, 0, 1.5, -3], [0, 0, 0, 1]]";
  const std::string both =
      R"({"kind": "deform", "mesh": "sheet", "handles": [
      {"name": "a", "select": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}}, "pose": {"matrix": )" +
      matrix + R"(}}, {"name": "b", "select": {"indices": [70]}, "shape": "vertex", "pose": {"matrix": )" +
      matrix + "}}]";
  Eigen::Matrix4d m;
  m << 1.2, 0.3, 0, 1, -0.1, 0.8, 0.4, 2, 0.2, 0, 1.5, -3, 0, 0, 0, 1;
  for (const char* more :
       {"}", R"(, "settings": {"refine_boundary": 2}})", R"(, "settings": {"laplacian_order": 2}})"}) {
    const EditResult result = run_edit(edit(both + more));
    const Points expected = (result.rest.rowwise().homogeneous() * m.transpose()).leftCols<3>();
    EXPECT_LT((result.mesh.positions - expected).cwiseAbs().maxCoeff(), 1e-9) << more;
  }
}

TEST_F(RunEdit, SolvesAProxyAndSaysSo) {
  const EditResult exact = run_edit(edit(step()));
  EXPECT_FALSE(exact.report.steps.front().proxy.has_value());
  const EditResult by_proxy = run_edit(edit(step()), {.overrides = {.proxy = 60}});
  ASSERT_TRUE(by_proxy.report.steps.front().proxy.has_value());
  EXPECT_LT(by_proxy.report.steps.front().proxy->free_vertices, exact.report.counts.free);
  EXPECT_EQ(by_proxy.report.counts.free, exact.report.counts.free);
  ASSERT_EQ(by_proxy.report.steps.front().notes.size(), 1u);
  const Note& note = by_proxy.report.steps.front().notes.front();
  EXPECT_EQ(note.id(), "script.proxy_solved");
  EXPECT_EQ(note.get<std::int64_t>("free"), exact.report.counts.free);
  EXPECT_NE(write_report(by_proxy.report).find("\"spacing\""), std::string::npos);
  // The handle moves by 3.
  EXPECT_LT((by_proxy.mesh.positions - exact.mesh.positions).rowwise().norm().maxCoeff(), 0.6);
  // The file can ask for a proxy, too. A proxy of all vertices gives the exact result.
  std::string with_all = step();
  with_all.insert(with_all.rfind('}'), R"(, "settings": {"proxy": 100000})");
  const EditResult all = run_edit(edit(with_all));
  ASSERT_TRUE(all.report.steps.front().proxy.has_value());
  EXPECT_LT((all.mesh.positions - exact.mesh.positions).rowwise().norm().maxCoeff(), 1e-10);
}

TEST_F(RunEdit, TakesAProxyWhereTheMemoryIsTooSmall) {
  RunOptions small, large;
  small.memory = 10'000;
  large.memory = std::uint64_t{1} << 40;
  const EditResult result = run_edit(edit(step()), small);
  EXPECT_TRUE(result.report.steps.front().proxy.has_value());
  ASSERT_FALSE(result.report.steps.front().notes.empty());
  EXPECT_EQ(result.report.steps.front().notes.front().id(), "script.proxy_for_memory");
  EXPECT_FALSE(run_edit(edit(step()), large).report.steps.front().proxy.has_value());
}

TEST_F(RunEdit, OnlyWhatIsFreeHasToFitTheMemory) {
  // The handle is the whole sheet except a strip.
  const std::string most_of_it = R"({"kind": "deform", "mesh": "sheet",
      "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
      "handles": [{"name": "most", "select": {"half_space": {"point": [0, 3.5, 0], "normal": [0, 1, 0]}},
                   "pose": {"translate": [0, 0, 1]}}]})";
  const EditResult unlimited = run_edit(edit(most_of_it));
  const auto needed = 2 * static_cast<std::uint64_t>(
                              estimated_memory(unlimited.report.steps.front().counts.free, DeformerOptions{}));
  RunOptions enough, less;
  enough.memory = needed;
  less.memory = needed / 2;
  EXPECT_FALSE(run_edit(edit(most_of_it), enough).report.steps.front().proxy.has_value());
  EXPECT_TRUE(run_edit(edit(most_of_it), less).report.steps.front().proxy.has_value());
}

TEST_F(RunEdit, TargetsPerVertexDoWhatAHandleDoes) {
  const EditResult by_handle = run_edit(edit(step()));
  std::string targets, transforms;
  for (Index v = 10 * side; v < 12 * side; ++v) {
    const Eigen::RowVector3d u = by_handle.mesh.positions.row(v);
    const std::string separator = targets.empty() ? "" : ",";
    targets += separator + nlohmann::json{{"vertex", v}, {"position", {u(0), u(1), u(2)}}}.dump();
    transforms +=
        separator + R"({"vertex": )" + std::to_string(v) + R"(, "matrix": [[1,0,0],[0,1,0],[0,0,1]]})";
  }
  const EditResult by_target = run_edit(edit(R"({"kind": "deform", "mesh": "sheet",
      "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}}, "targets": [)" +
                                             targets + R"(], "transforms": [)" + transforms + "]}"));
  EXPECT_LT((by_handle.mesh.positions - by_target.mesh.positions).cwiseAbs().maxCoeff(), 1e-10);
}

// A target at the position that its vertex takes anyway changes nothing on the same mesh, unless the handle's
// turn was cut to less than half a circle.
TEST_F(RunEdit, TurnsOfMoreThanHalfACircleSurviveTargetsPerVertex) {
  const std::string method = R"(, "settings": {"method": "rotation-aware", "refine_boundary": 0})";
  const std::string turn = R"({"rotate": {"axis": [0, 1, 0], "angle_deg": 270}})";
  const Index middle = 5 * side + 6;
  const EditResult by_handle = run_edit(edit(step(method, turn)));
  const Eigen::RowVector3d u = by_handle.mesh.positions.row(middle);
  const std::string target = nlohmann::json{{"vertex", middle}, {"position", {u(0), u(1), u(2)}}}.dump();
  const EditResult with_target = run_edit(edit(step(method + ", \"targets\": [" + target + "]", turn)));
  EXPECT_LT((by_handle.mesh.positions - with_target.mesh.positions).cwiseAbs().maxCoeff(), 1e-6);

  const EditResult the_short_way =
      run_edit(edit(step(method, R"({"rotate": {"axis": [0, 1, 0], "angle_deg": -90}})")));
  EXPECT_GT((by_handle.mesh.positions - the_short_way.mesh.positions).cwiseAbs().maxCoeff(), 1);
}

// Four vertices that are held by positions alone always have an affine map that fits.
TEST_F(RunEdit, NotesThatPositionsAloneStretchTheSurface) {
  const auto handle = [](Index vertex, const char* translate) {
    return fmt::format(R"({{"name": "v{0}", "select": {{"indices": [{0}]}}, "constrain": "position",
                           "pose": {{"translate": {1}}}}})",
                       vertex, translate);
  };
  const auto moved = [&](const char* settings, const char* translate) {
    const std::string handles = handle(0, "[0, 0, 0]") + "," + handle(side - 1, "[0, 0, 0]") + "," +
                                handle(side * (side - 1), "[0, 0, 0]") + "," +
                                handle(side * side - 1, translate);
    return run_edit(
               edit(R"({"kind": "deform", "mesh": "sheet", "handles": [)" + handles + "]" + settings + "}"))
        .report.steps[0]
        .notes;
  };
  const std::vector<Note> notes = moved("", "[6, 0, 0]");
  ASSERT_EQ(notes.size(), 1);
  EXPECT_EQ(notes[0].id(), "script.positions_stretch");
  EXPECT_GT(notes[0].get<double>("ratio"), 1.3);
  EXPECT_TRUE(moved("", "[0.1, 0, 0]").empty());
}

TEST_F(RunEdit, NotesThatAMirroringHandleHasNoRotationToFollow) {
  const std::string mirror = R"({"scale": [-1, 1, 1]})";
  for (const char* method : {"corotational", "rotation-aware", "shell", "ft05"}) {
    const std::string settings = R"(, "settings": {"method": ")" + std::string(method) + "\"}";
    const EditReport mirrored = run_edit(edit(step(settings, mirror))).report;
    const auto json = nlohmann::json::parse(write_report(mirrored));
    const auto& notes = json["steps"][0]["notes"];
    EXPECT_EQ(notes.size(), std::string(method) == "ft05" ? 0u : 1u) << method;
    for (const auto& note : notes)
      EXPECT_EQ(note, (nlohmann::json{{"id", "script.no_rotation"},
                                      {"fields", nlohmann::json::object()},
                                      {"text", mirrored.steps[0].notes[0].text()}}));
    EXPECT_TRUE(run_edit(edit(step(settings))).report.steps[0].notes.empty()) << method;
  }
}

TEST_F(RunEdit, GivesTheSameBytesWhateverTheThreads) {
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  const EditFile file = edit(step());
  EXPECT_EQ(run_edit(file, {}, one).mesh.positions, run_edit(file, {}, two).mesh.positions);
}

TEST_F(RunEdit, AWrittenEditGivesTheSameResult) {
  const EditFile file = edit(step(R"(, "anchors": [{"select": {"indices": [60]}}])",
                                  R"({"rotate": {"axis": [1, 0.3, 0], "angle_deg": 40}, "scale": 1.3})"));
  const EditFile again = parse_edit(write_edit(file), "edit.json", folder_);
  EXPECT_EQ(run_edit(file).mesh.positions, run_edit(again).mesh.positions);
}

TEST_F(RunEdit, StepsContinueWhereTheLastOneEnded) {
  const EditResult twice = run_edit(edit(step() + "," + step()));
  EXPECT_EQ(twice.mesh.positions.row(11 * side), twice.rest.row(11 * side) + Eigen::RowVector3d(0, 0, 6));
  ASSERT_EQ(twice.report.steps.size(), 2u);
  EXPECT_DOUBLE_EQ(twice.report.max_displacement, 6);
  EXPECT_DOUBLE_EQ(twice.report.steps[1].max_displacement, 3);

  EditFile branched = edit(step(R"(, "result": "bent")") + "," + step());
  branched.output = "bent";
  EXPECT_EQ(run_edit(branched).mesh.positions, run_edit(edit(step())).mesh.positions);
}

TEST_F(RunEdit, WithoutAFixedPartTheRimOfTheRegionStays) {
  const EditResult result = run_edit(edit(R"({"kind": "deform", "mesh": "sheet",
      "region": {"sphere": {"centre": [5.5, 5.5, 0], "radius": 4.6}},
      "handles": [{"name": "centre", "select": {"sphere": {"centre": [5.5, 5.5, 0], "radius": 1.2}},
                   "pose": {"translate": [0, 0, 2]}}]})"));
  EXPECT_GT(result.report.counts.fixed, 20);
  EXPECT_EQ(result.mesh.positions.row(0), result.rest.row(0));
  EXPECT_GT(result.report.counts.free, 4);
}

TEST_F(RunEdit, RedrawnCurvesGoWhereTheyAreDrawn) {
  const EditResult result = run_edit(edit(R"({"kind": "deform", "mesh": "sheet",
      "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
      "handles": [{"name": "line", "shape": "curve",
                   "select": {"path": {"points": [[0, 11, 0], [11, 11, 0]]}},
                   "pose": {"curve": [[0, 11, 4], [11, 11, 4]]}}]})"));
  for (Index x = 0; x < side; ++x) EXPECT_NEAR(result.mesh.positions(11 * side + x, 2), 4, 1e-12);
}

TEST_F(RunEdit, NotesACurveThatIsRedrawnAsItsMirrorImage) {
  const auto mirrored = [&](const std::string& course) {
    const std::vector<Note> notes =
        run_edit(edit(R"({"kind": "deform", "mesh": "sheet", "handles": [{"name": "corner", "shape": "curve",
                             "select": {"path": {"points": [[0, 0, 0], [11, 0, 0], [11, 11, 0]]}}, "pose": {"curve": )" +
                      course + "}}]}"))
            .report.steps[0]
            .notes;
    return std::ranges::any_of(notes, [](const Note& note) { return note.id() == "script.mirrored_curve"; });
  };
  EXPECT_FALSE(mirrored("[[0, 0, 0], [11, 0, 0], [11, 11, 0]]"));
  EXPECT_FALSE(mirrored("[[0, 0, 0], [0, 0, 11], [0, 11, 11]]"));
  EXPECT_FALSE(mirrored("[[0, 0, 0], [11, 0, 0], [11, -11, 0]]")) << "the surface lies in the plane";
  // Half of the rim of a tube, whose plane the surface does not lie in.
  std::string arc;
  for (int k = 0; k <= 16; ++k) {
    const double angle = std::numbers::pi * k / 16;
    arc += (k > 0 ? ", [" : "[") + std::to_string(0.5 * std::cos(angle)) + ", " +
           std::to_string(-0.5 * std::sin(angle)) + ", 4]";
  }
  const EditFile edit = parse_edit(
      R"({"format": "meshgraft-edit", "version": 2, "inputs": {"tube": {"sample": "cylinder", "resolution": 20}},
                     "steps": [{"kind": "deform", "mesh": "tube",
                                "fixed": {"half_space": {"point": [0, 0, 1], "normal": [0, 0, -1]}},
                                "handles": [{"name": "rim", "shape": "curve",
                                             "select": {"path": {"points": [[0.5, 0, 4], [0, 0.5, 4], [-0.5, 0, 4]]}},
                                             "pose": {"curve": [)" +
          arc + "]}}]}]}",
      "edit.json");
  const std::vector<Note> notes = run_edit(edit).report.steps[0].notes;
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0].id(), "script.mirrored_curve");
  EXPECT_EQ(notes[0].get<std::string>("handle"), "rim");
  EXPECT_EQ(notes[1].id(), "script.pinched");
}

TEST_F(RunEdit, FeaturesKeepTheirShape) {
  const auto step_with = [](const std::string& more) {
    return R"({"kind": "deform", "mesh": "sheet", "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
               "handles": [{"name": "far", "select": {"half_space": {"point": [0, 9.5, 0], "normal": [0, 1, 0]}},
                            "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 70}, "translate": [1, 0, 3]}}])" +
           more + "}";
  };
  const auto disc = [](double x) {
    return R"({"select": {"sphere": {"centre": [)" + std::to_string(x) + R"(, 5.5, 0], "radius": 1.7}}})";
  };
  // Returns how far a disc is from the nearest similarity of itself.
  const auto strain = [&](const EditResult& result, double x) {
    std::vector<Index> inside;
    for (Index v = 0; v < result.rest.rows(); ++v)
      if ((result.rest.row(v) - Eigen::RowVector3d(x, 5.5, 0)).norm() <= 1.7) inside.push_back(v);
    EXPECT_GT(inside.size(), 6U);
    Eigen::Matrix3Xd before(3, inside.size()), after(3, inside.size());
    for (std::size_t k = 0; k < inside.size(); ++k) {
      before.col(static_cast<Eigen::Index>(k)) = result.rest.row(inside[k]).transpose();
      after.col(static_cast<Eigen::Index>(k)) = result.mesh.positions.row(inside[k]).transpose();
    }
    const Eigen::Matrix4d map = Eigen::umeyama(before, after);
    return ((map * before.colwise().homogeneous()).topRows<3>() - after).cwiseAbs().maxCoeff();
  };
  EXPECT_GT(strain(run_edit(edit(step_with(""))), 3), 0.01);
  const EditResult one = run_edit(edit(step_with(R"(, "features": [)" + disc(3) + "]")));
  EXPECT_LT(strain(one, 3), 1e-9);
  EXPECT_GT(strain(one, 8), 0.01);
  const EditResult both = run_edit(edit(step_with(R"(, "features": [)" + disc(3) +
                                                  R"(], "symmetry": {"point": [5.5, 0, 0], "normal": [1, 0, 0],
                                                                     "tolerance_rel": 0.05})")));
  EXPECT_LT(strain(both, 3), 1e-9);
  EXPECT_LT(strain(both, 8), 1e-9);
}

TEST_F(RunEdit, RefusesFeaturesThatAreHeldAndSelectionsWithoutAVertex) {
  const auto id_of = [&](const std::string& more) {
    try {
      run_edit(edit(step(more)));
    } catch (const Error& error) {
      return std::string(error.id()) + " at " + error.location().text();
    }
    return std::string("(accepted)");
  };
  const std::string nothing = R"({"sphere": {"centre": [99, 0, 0], "radius": 1}})";
  EXPECT_EQ(id_of(R"(, "features": [{"select": {"indices": [0, 1]}}])"),
            "deform.feature_vertex_held at edit.json: steps[0].features[0].select");
  EXPECT_EQ(id_of(R"(, "features": [{"select": )" + nothing + "}]"),
            "script.selection_empty at edit.json: steps[0].features[0].select");
  EXPECT_EQ(id_of(R"(, "anchors": [{"select": )" + nothing + "}]"),
            "script.selection_empty at edit.json: steps[0].anchors[0].select");
  const auto fix = [](const std::string& selection) {
    return R"({"kind": "deform", "mesh": "sheet", "fixed": )" + selection + R"(, "handles": [
               {"name": "side", "select": {"half_space": {"point": [0, 9.5, 0], "normal": [0, 1, 0]}}}]})";
  };
  const std::string nothing_fixed = refusal(edit(fix(nothing)));
  EXPECT_NE(nothing_fixed.find("steps[0].fixed: it selects no vertex"), std::string::npos) << nothing_fixed;
  EXPECT_EQ(refusal(edit(fix(R"({"indices": []})"))), "(accepted)");
}

TEST_F(RunEdit, ChecksTheHashOfAFile) {
  const std::string good = sha256(read_file(folder_ / "sheet.ply"));
  const std::string input = R"({"file": "sheet.ply", "sha256": ")";
  EXPECT_NO_THROW(run_edit(edit(step(), input + good + "\"}")));
  const std::string bad(64, 'a');
  const std::string message = refusal(edit(step(), input + bad + "\"}"));
  for (const std::string& part : {std::string("inputs.sheet.sha256"), good, bad})
    EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST_F(RunEdit, NamesTheFieldThatDoesNotFitTheMesh) {
  const auto says = [&](const std::string& steps, const std::string& part) {
    const std::string message = refusal(edit(steps));
    EXPECT_NE(message.find(part), std::string::npos) << message << "\nnot: " << part;
  };
  says(R"({"kind": "deform", "mesh": "sheet", "region": {"indices": [9999]}})", "steps[0].region");
  says(R"({"kind": "deform", "mesh": "sheet", "handles": [{"name": "h", "select":
        {"sphere": {"centre": [99, 0, 0], "radius": 1}}}]})",
       "steps[0].handles[0].select: the handle 'h' has no vertices");
  says(step(R"(, "counts": {"vertices": 7})"), "steps[0].counts.vertices: 7 expected, 144 found");
  says(step(R"(, "counts": {"free": 7})"), "steps[0].counts.free: 7 expected, 96 found");
  says(step(R"(, "targets": [{"vertex": 0, "position": [0, 0, 0]}])"), "targets[0]: vertex 0 is also fixed");
  says(step(R"(, "targets": [{"vertex": 140, "position": [0, 0, 0]}])"), "also belongs to handle 'edge'");
  says(step(R"(, "targets": [{"vertex": 144, "position": [0, 0, 0]}])"),
       "targets[0]: vertex 144 does not exist");
  says(R"({"kind": "deform", "mesh": "sheet", "region": {"indices": [1, 2]},
        "handles": [{"name": "h", "select": {"indices": [3]}}]})",
       "lie outside the region");
  says(R"({"kind": "deform", "mesh": "sheet", "handles": [{"name": "h", "select": {"indices": [3]}},
        {"name": "g", "select": {"indices": [3, 4]}}]})",
       "handles[1].select: vertex 3 also belongs to handle 'h'");
  says(R"({"kind": "deform", "mesh": "sheet", "region": {"file": "no.txt"}})", "steps[0].region");
  says(R"({"kind": "deform", "mesh": "sheet", "region": {"produced": {"step": "x", "what": "y"}}})",
       "steps[0].region: there is no step named 'x'. Cut and merge steps");
}

TEST_F(RunEdit, SaysWhichStepCannotBeSolved) {
  try {
    run_edit(edit(R"({"kind": "deform", "mesh": "sheet", "handles": [{"name": "h", "select": {"indices": [3]},
                      "constrain": "position"}]})"));
    FAIL() << "one position leaves the rest without an answer";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unsolvable);
    EXPECT_NE(std::string(error.what()).find("edit.json: steps[0]"), std::string::npos) << error.what();
  }
}

TEST_F(RunEdit, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  try {
    run_edit(edit(step()), {}, context);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

TEST_F(RunEdit, OverridesReplaceTheSettingsOfEveryStep) {
  RunOptions options;
  options.overrides.method = DeformMethod::rotation_aware;
  options.overrides.stiffness = 3;
  options.overrides.iterations = 5;
  options.overrides.weights = WeightScheme::cotangent;
  options.overrides.degenerate = DegenerateTreatment::ft05_noise;
  options.overrides.density = Density::ft05;
  options.overrides.backend = SolverBackend::eigen;
  const EditReport report = run_edit(edit(step() + "," + step()), options).report;
  for (const StepReport& done : report.steps) {
    EXPECT_EQ(done.method, Method(DeformMethod::rotation_aware));
    EXPECT_EQ(done.settings.deformer.stiffness, 3);
    EXPECT_EQ(done.settings.deformer.iterations, 5);
    EXPECT_EQ(done.settings.deformer.operators.weights, WeightScheme::cotangent);
    EXPECT_EQ(done.settings.deformer.operators.degenerate, DegenerateTreatment::ft05_noise);
    EXPECT_EQ(done.settings.deformer.operators.density, Density::ft05);
    EXPECT_EQ(done.solver.backend, SolverBackend::eigen);
    EXPECT_FALSE(done.condition_estimate.has_value());
  }
}

TEST_F(RunEdit, OverridesThatTheMethodDoesNotUseAreNoted) {
  const auto noted = [&](DeformMethod method) {
    RunOptions options;
    options.overrides.method = method;
    options.overrides.stiffness = 3;
    options.overrides.iterations = 5;
    std::vector<std::string> settings;
    const EditReport report = run_edit(edit(step()), options).report;
    for (const Note& note : report.steps.front().notes)
      if (note.id() == "script.setting_without_use") settings.push_back(note.get<std::string>("setting"));
    return settings;
  };
  EXPECT_EQ(noted(DeformMethod::ft05), (std::vector<std::string>{"stiffness", "iterations"}));
  EXPECT_EQ(noted(DeformMethod::rotation_aware), std::vector<std::string>{"iterations"});
  EXPECT_EQ(noted(DeformMethod::corotational), std::vector<std::string>{});
}

TEST_F(RunEdit, ReportsWhereTheSurfaceWentThroughItself) {
  // The first step moves nothing; the second moves the far edge through the fixed one.
  const std::string still = step("", R"({"translate": [0, 0, 0]})");
  const std::string through = step("", R"({"translate": [0, -10, 0.25]})");
  const EditReport report = run_edit(edit(still + "," + through)).report;
  ASSERT_EQ(report.steps.size(), 2u);
  const auto count = report.steps[1].quality.new_self_intersections;
  ASSERT_TRUE(count);
  EXPECT_GT(*count, 0);
  EXPECT_EQ(report.steps[0].quality.new_self_intersections, 0);
  EXPECT_EQ(report.quality.new_self_intersections, count);
  const auto json = nlohmann::json::parse(write_report(report));
  EXPECT_EQ(json["quality"]["new_self_intersections"], *count);
}

TEST_F(RunEdit, ReportsEverythingThatIsDocumented) {
  const auto json = nlohmann::json::parse(write_report(run_edit(edit(step())).report));
  for (const char* field : {"counts", "method", "seconds", "solver", "residual", "max_transform_deviation",
                            "condition_estimate", "quality", "steps", "inputs"})
    EXPECT_TRUE(json.contains(field)) << field;
  for (const char* count : {"vertices", "faces", "free", "fixed", "handle", "degenerate"})
    EXPECT_TRUE(json["counts"].contains(count)) << count;
  for (const char* stage : {"read", "check", "assemble", "analyse", "factorise", "solve", "write", "total"})
    EXPECT_TRUE(json["seconds"].contains(stage)) << stage;
  EXPECT_GT(json["solver"]["factor_nonzeros"], 0);
  EXPECT_TRUE(json["condition_estimate"].is_null()) << "was not asked for";
  EXPECT_TRUE(json["quality"]["volume_ratio"].is_null());
  EXPECT_GT(json["quality"]["sigma"]["min"], 0);
  EXPECT_EQ(json["quality"]["new_self_intersections"], 0);
  const auto& only = json["steps"][0];
  EXPECT_EQ(only["settings"]["weights"], "uniform");
  EXPECT_EQ(only["method"], "corotational");
  EXPECT_EQ(only["settings"]["method"], "corotational");
  EXPECT_GE(only["iterations"], 1);
  EXPECT_TRUE(only["last_rotation_change"].is_number());
  EXPECT_EQ(only["notes"], nlohmann::json::array());
}

TEST_F(RunEdit, EstimatesTheConditionWhereThatIsAskedFor) {
  RunOptions options;
  options.estimate_condition = true;
  const auto json = nlohmann::json::parse(write_report(run_edit(edit(step()), options).report));
  EXPECT_GT(json["condition_estimate"], 1);
  EXPECT_EQ(json["steps"][0]["condition_estimate"], json["condition_estimate"]);
}

TEST(Sha256, MatchesThePublishedVectors) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

}  // namespace
}  // namespace meshgraft
