#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/samples/samples.h>
#include <meshgraft/script/run_edit.h>

#include "io/temporary_folder.h"
#include "script/facts.h"
#include "support/paths.h"

namespace meshgraft {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* quarter_turn =
    R"({"kind": "transform", "mesh": "bar", "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 90}, "scale": 2,
        "translate": [0, 0, 3]}})";

class TransformStepTest : public testing::Test {
 protected:
  void SetUp() override {
    Mesh bar = make_sample("bar", 12);
    const Points normals = vertex_normals(bar);
    Attribute normal{.name = "normal", .interpolation = Interpolation::direction, .components = 3};
    normal.values.assign(normals.data(), normals.data() + normals.size());
    bar.attributes.push_back(normal);
    write_mesh(bar, folder_ / "bar.ply");
    given_ = read_mesh(folder_ / "bar.ply");
  }
  EditFile edit(const std::string& steps) const {
    return parse_edit(R"({"format": "meshgraft-edit", "version": 2, "inputs": {"bar": {"file": "bar.ply"}},
                          "steps": [)" +
                          steps + "]}",
                      "edit.json", folder_.path());
  }
  static Points moved(const Points& points, const Eigen::Affine3d& map) {
    return (points * map.linear().transpose()).rowwise() + map.translation().transpose();
  }
  static Eigen::Affine3d map_of_quarter_turn() {
    return Eigen::Translation3d(0, 0, 3) * Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX()) *
           Eigen::Scaling(2.0);
  }

  const test::TemporaryFolder folder_;
  Mesh given_;
};

TEST_F(TransformStepTest, MovesEveryVertexAndTurnsTheNormals) {
  const EditResult result = run_edit(edit(quarter_turn));
  EXPECT_LT((result.mesh.positions - moved(given_.positions, map_of_quarter_turn())).norm(), 1e-12);
  EXPECT_EQ(result.mesh.faces, given_.faces);
  const Attribute* before = given_.find_attribute(Domain::vertex, "normal");
  const Attribute* after = result.mesh.find_attribute(Domain::vertex, "normal");
  ASSERT_TRUE(before != nullptr && after != nullptr);
  for (std::size_t k = 0; k < before->values.size(); k += 3) {
    EXPECT_NEAR(after->values[k], before->values[k], 1e-6);
    EXPECT_NEAR(after->values[k + 1], -before->values[k + 2], 1e-6);
    EXPECT_NEAR(after->values[k + 2], before->values[k + 1], 1e-6);
  }
  EXPECT_FALSE(result.report.deformed);
}

TEST_F(TransformStepTest, IsUndoneByTheInverseMap) {
  const Eigen::Matrix4d back = map_of_quarter_turn().inverse().matrix();
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) rows.push_back({back(i, 0), back(i, 1), back(i, 2), back(i, 3)});
  const EditResult result =
      run_edit(edit(std::string(quarter_turn) +
                    R"(, {"kind": "transform", "mesh": "bar", "pose": {"matrix": )" + rows.dump() + "}}"));
  EXPECT_LT((result.mesh.positions - given_.positions).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(TransformStepTest, TurnsTheFacesOverWhereItReflects) {
  const EditResult result =
      run_edit(edit(R"({"kind": "transform", "mesh": "bar", "pose": {"scale": [-1, 1, 1]}})"));
  EXPECT_NE(result.mesh.faces, given_.faces);
  EXPECT_FALSE(check_mesh(result.mesh).has_defects());
  write_mesh(result.mesh, folder_ / "mirrored.ply");
  EXPECT_EQ(read_mesh(folder_ / "mirrored.ply").faces, result.mesh.faces);
}

// The quality compares with the rest positions, which are moved, too.
TEST_F(TransformStepTest, LeavesTheMeasuresOfADeformationAsTheyAre) {
  const std::string bend = R"({"kind": "deform", "mesh": "bar", "handles": [
      {"name": "top", "select": {"half_space": {"point": [0, 0, 3.7], "normal": [0, 0, 1]}},
       "pose": {"translate": [0.5, 0, 0]}},
      {"name": "bottom", "select": {"half_space": {"point": [0, 0, 0.3], "normal": [0, 0, -1]}}}]})";
  const EditReport alone = run_edit(edit(bend)).report,
                   turned = run_edit(edit(bend + ", " + quarter_turn)).report;
  EXPECT_TRUE(turned.deformed);
  EXPECT_NEAR(turned.quality.edge_rms, alone.quality.edge_rms, 1e-9);
  EXPECT_NEAR(turned.max_displacement, 2 * alone.max_displacement, 1e-9);
}

TEST_F(TransformStepTest, IsReported) {
  const Json report = Json::parse(write_report(run_edit(edit(quarter_turn)).report));
  const Json& step = report["steps"][0];
  EXPECT_EQ(step["kind"], "transform");
  EXPECT_EQ(step["mesh"], "bar");
  EXPECT_NEAR(step["matrix"][2][3].get<double>(), 3, 1e-12);
  EXPECT_NEAR(step["matrix"][0][0].get<double>(), 2, 1e-12);
  EXPECT_TRUE(report["quality"].is_null());
}

TEST_F(TransformStepTest, RefusesWhatFlattens) {
  for (const std::string pose : {R"({"scale": 0})", R"({"scale": [1, 1, 0]})"}) {
    try {
      run_edit(edit(R"({"kind": "transform", "mesh": "bar", "pose": )" + pose + "}"));
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), facts::script::PoseFlattens::id);
      EXPECT_EQ(error.location().text(), "edit.json: steps[0].pose");
    }
  }
}

TEST_F(TransformStepTest, NamesAScaleBeyondRange) {
  for (const std::string pose :
       {R"({"scale": 1e200})", R"({"scale": 1e-200})", R"({"scale": [1, 1, 1e110]})"}) {
    try {
      run_edit(edit(R"({"kind": "transform", "mesh": "bar", "pose": )" + pose + "}"));
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), facts::script::PoseScaleBeyondRange::id);
      EXPECT_EQ(error.location().text(), "edit.json: steps[0].pose");
      EXPECT_EQ(error.remedy(), "Choose scales from 1e-100 to 1e100.");
    }
  }
}

TEST_F(TransformStepTest, RefusesNumbersBeyondRange) {
  const std::string step = R"({"kind": "transform", "mesh": "bar", "pose": {"scale": 1e100}})";
  try {
    run_edit(edit(step + ", " + step + ", " + step + ", " + step));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), facts::script::PoseBeyondNumbers::id);
    EXPECT_EQ(error.location().text(), "edit.json: steps[3].pose");
  }
}

TEST_F(TransformStepTest, ReadsBackWhatItWrites) {
  const EditFile all = read_edit_file(test::source_path("tests/script/accepted/transform.json"));
  const std::string written = write_edit(all);
  EXPECT_EQ(write_edit(parse_edit(written, "edit.json")), written);
  EXPECT_EQ(std::get<HandleMotion>(std::get<TransformStep>(all.steps.at(1).action).pose).pivot,
            Eigen::Vector3d(1, 1, 1));
}

}  // namespace
}  // namespace meshgraft
