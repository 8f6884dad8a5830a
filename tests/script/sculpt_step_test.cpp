#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>
#include <meshgraft/script/run_edit.h>

#include "deform/facts.h"
#include "deform/sculpt.h"
#include "io/temporary_folder.h"
#include "script/facts.h"
#include "support/defects.h"
#include "support/mesh_families.h"
#include "support/paths.h"

namespace meshgraft {
namespace {

using Json = nlohmann::ordered_json;

class SculptStepTest : public testing::Test {
 protected:
  void SetUp() override { put(make_mesh(ball_.positions, ball_.triangles)); }
  void put(const Mesh& mesh) { write_mesh(mesh, folder_ / "ball.ply"); }
  EditFile edit(const std::string& fields) const {
    return parse_edit(R"({"format": "meshgraft-edit", "version": 2, "inputs": {"ball": {"file": "ball.ply"}},
                          "selections": {"cap": {"half_space": {"point": [0, 0, 0.5], "normal": [0, 0, 1]}}},
                          "steps": [{"kind": "sculpt", "mesh": "ball", )" +
                          fields + "}]}",
                      "edit.json", folder_.path());
  }
  std::vector<Index> cap(const Mesh& mesh) const {
    std::vector<Index> vertices;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.positions(v, 2) >= 0.5) vertices.push_back(v);
    return vertices;
  }

  const test::TemporaryFolder folder_;
  const test::TestMesh ball_ = test::bumpy_sphere(3);
};

TEST_F(SculptStepTest, DoesWhatTheFunctionsDo) {
  const Mesh given = read_mesh(folder_ / "ball.ply");
  const std::vector<Index> region = cap(given);
  const SculptedSurface surface{given.positions, ball_.triangles, region};
  const auto run = [&](const std::string& fields) { return run_edit(edit(fields)).mesh.positions; };
  EXPECT_EQ(run(R"("action": "smooth", "region": "cap")"), smooth_region(surface, 0.5));
  EXPECT_EQ(run(R"("action": "smooth", "region": "cap", "strength": 1)"), smooth_region(surface, 1));
  EXPECT_EQ(run(R"("action": "inflate", "region": "cap", "height": -0.2)"), inflate_region(surface, -0.2));
  EXPECT_EQ(run(R"("action": "flatten", "region": "cap", "strength": 0.7)"), flatten_region(surface, 0.7));
  EXPECT_EQ(run(R"("action": "inflate", "region": "cap", "height": 0.2, "reach": 0.4)"),
            inflate_region(surface, 0.2, 0.4));
  EXPECT_EQ(run(R"("action": "flatten", "region": "cap", "reach": 0)"), flatten_region(surface, 0.5, 0));
}

TEST_F(SculptStepTest, RefusesAReachByItsName) {
  for (const char* fields : {R"("action": "flatten", "region": "cap", "reach": -0.1)",
                             R"("action": "flatten", "region": "cap", "reach": "0.1")",
                             R"("action": "flatten", "region": "cap", "reach": {"length": 0.1})",
                             R"("action": "inflate", "region": "cap", "height": 1, "reach": null)",
                             R"("action": "smooth", "region": "cap", "reach": 0.1)"}) {
    try {
      edit(fields);
      ADD_FAILURE() << fields;
    } catch (const Error& error) {
      EXPECT_EQ(error.location().text(), "edit.json: steps[0].reach") << fields;
    }
  }
  EXPECT_THROW(edit(R"("action": "flatten", "region": "cap", "reach": NaN)"), Error) << "no JSON";
}

// Shaping reads two rings of triangles around what moves, which quads do not show as their edges.
TEST_F(SculptStepTest, FindsWhatIsNotFiniteAroundItsReach) {
  constexpr Index side = 7;
  Mesh quads;
  quads.positions.resize(side * side, 3);
  for (Index v = 0; v < side * side; ++v) quads.positions.row(v) << v % side, v / side, 0;
  for (Index v = 0; v < side * (side - 1); ++v)
    if (v % side < side - 1) quads.faces.push_back(std::array{v, v + 1, v + side + 1, v + side});
  const Index middle = quads.vertex_count() / 2;
  for (Index bad = 0; bad < quads.vertex_count(); ++bad) {
    const Eigen::RowVector3d kept = quads.positions.row(bad);
    quads.positions(bad, 2) = std::nan("");
    put(quads);
    for (const double reach : {0.0, 1.05, 2.5}) {
      try {
        run_edit(edit(R"("action": "inflate", "height": 0.1, "region": {"indices": [)" +
                      std::to_string(middle) + R"(]}, "reach": )" + std::to_string(reach)));
      } catch (const Error& error) {
        EXPECT_NE(error.id(), facts::deform::SolutionNotFinite::id) << bad << " " << reach;
      }
    }
    quads.positions.row(bad) = kept;
  }
}

// The two sides fade out towards each other. Their mix is symmetric, and no higher than one side.
TEST_F(SculptStepTest, MixesReachesThatMeet) {
  const test::TestMesh ball = test::icosphere(3);
  put(make_mesh(ball.positions, ball.triangles));
  const std::string symmetry = R"("symmetry": {"point": [0, 0, 0], "normal": [0, 0, 1]})";
  for (const char* action :
       {R"("action": "flatten", "strength": 1)", R"("action": "inflate", "height": 0.2)"}) {
    const std::string fields = action + std::string(R"(, "region": "cap", "reach": 0.9)");
    const Points one = run_edit(edit(fields)).mesh.positions,
                 both = run_edit(edit(fields + ", " + symmetry)).mesh.positions;
    double largest = 0, changed = 0;
    for (Index v = 0; v < both.rows(); ++v) {
      const Eigen::RowVector3d at = ball.positions.row(v);
      if (at.z() >= 0.5) EXPECT_LT((both.row(v) - one.row(v)).norm(), 1e-9) << "the region moves as alone";
      largest = std::max(largest, (both.row(v) - at).norm());
      if (at.z() > 0) changed = std::max(changed, (both.row(v) - one.row(v)).norm());
      Index image = 0;
      (ball.positions.rowwise() - Eigen::RowVector3d(at.x(), at.y(), -at.z()))
          .rowwise()
          .norm()
          .minCoeff(&image);
      EXPECT_LT((both.row(v) - Eigen::RowVector3d(both(image, 0), both(image, 1), -both(image, 2))).norm(),
                1e-6);
    }
    EXPECT_GT(changed, 0.001) << action << ": the reaches meet";
    EXPECT_LE(largest, (one - ball.positions).rowwise().norm().maxCoeff() + 1e-9) << action;
  }
}

// Faces with vertices of their own, as in STL files, stay together.
TEST_F(SculptStepTest, MovesTheVerticesAtOnePlaceAsOne) {
  const Mesh whole = run_edit(edit(R"("action": "smooth", "region": "cap")")).mesh;
  const Mesh given = read_mesh(folder_ / "ball.ply");
  put(test::as_soup(given));
  const Mesh soup = run_edit(edit(R"("action": "smooth", "region": "cap")")).mesh;
  ASSERT_EQ(soup.vertex_count(), 3 * given.face_count());
  for (Index f = 0; f < given.face_count(); ++f)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_LT((soup.positions.row(soup.faces[f][c]) - whole.positions.row(given.faces[f][c])).norm(), 1e-9);
}

// The two sides are shaped by themselves: each is flattened to a plane of its own.
TEST_F(SculptStepTest, ShapesTheMirrorImageToo) {
  const test::TestMesh ball = test::icosphere(3);
  put(make_mesh(ball.positions, ball.triangles));
  const std::string symmetry = R"(, "symmetry": {"point": [0, 0, 0], "normal": [0, 0, 1]})";
  for (const char* action :
       {R"("action": "flatten", "strength": 0.8)", R"("action": "inflate", "height": 0.3)"}) {
    const std::string fields = action + std::string(R"(, "region": "cap")");
    const EditResult one = run_edit(edit(fields)), both = run_edit(edit(fields + symmetry));
    EXPECT_EQ(both.report.steps[0].sculpt->region, 2 * one.report.steps[0].sculpt->region);
    for (Index v = 0; v < ball.positions.rows(); ++v) {
      const Eigen::RowVector3d at = ball.positions.row(v);
      if (at.z() > -0.2) EXPECT_LT((both.mesh.positions.row(v) - one.mesh.positions.row(v)).norm(), 1e-12);
      Index image = 0;
      (ball.positions.rowwise() - Eigen::RowVector3d(at.x(), at.y(), -at.z()))
          .rowwise()
          .norm()
          .minCoeff(&image);
      const Eigen::RowVector3d mirrored = both.mesh.positions.row(image);
      EXPECT_LT(
          (both.mesh.positions.row(v) - Eigen::RowVector3d(mirrored.x(), mirrored.y(), -mirrored.z())).norm(),
          1e-6);
    }
  }
}

// Both sides read the rows between them.
TEST_F(SculptStepTest, IsSymmetricWhereTheSidesAreNear) {
  const Mesh bar = make_sample("bar", 24);
  put(bar);
  const double middle = (bar.positions.col(2).minCoeff() + bar.positions.col(2).maxCoeff()) / 2;
  const std::string at = "[0, 0, " + std::to_string(middle);
  for (const char* action : {R"("action": "smooth")", R"("action": "inflate", "height": 0.2)"}) {
    const Points moved = run_edit(edit(std::string(action) +
                                       R"(, "region": {"intersect": [
                                            {"half_space": {"point": [0, 0, 2.05], "normal": [0, 0, 1]}},
                                            {"half_space": {"point": [0, 0, 2.65], "normal": [0, 0, -1]}}]},
                                          "symmetry": {"normal": [0, 0, 1], "point": )" +
                                       at + "]}"))
                             .mesh.positions;
    EXPECT_GT((moved - bar.positions).rowwise().norm().maxCoeff(), 1e-3) << action;
    const auto image_of = [&](const Points& points, Index v) {
      return Eigen::RowVector3d(points(v, 0), points(v, 1), 2 * middle - points(v, 2));
    };
    for (Index v = 0; v < moved.rows(); ++v) {
      Index partner = 0;
      (bar.positions.rowwise() - image_of(bar.positions, v)).rowwise().norm().minCoeff(&partner);
      EXPECT_LT((moved.row(v) - image_of(moved, partner)).norm(), 1e-9) << action << ", vertex " << v;
    }
  }
}

// A region, its mirror image, and both together are one and the same request.
TEST_F(SculptStepTest, IsTheSameFromEitherSide) {
  const test::TestMesh ball = test::icosphere(3);
  put(make_mesh(ball.positions, ball.triangles));
  const std::string other = R"({"half_space": {"point": [0, 0, -0.5], "normal": [0, 0, -1]}})";
  for (const char* action :
       {R"("action": "flatten", "strength": 0.8)", R"("action": "inflate", "height": 0.3)"}) {
    const auto moved = [&](const std::string& region) {
      const EditResult result = run_edit(edit(action + (R"(, "region": )" + region) +
                                              R"(, "symmetry": {"point": [0, 0, 0], "normal": [0, 0, 1]})"));
      const StepReport& report = result.report.steps[0];
      EXPECT_TRUE(report.symmetry.has_value());
      EXPECT_EQ(report.symmetry->without_partner, 0);
      EXPECT_EQ(Json::parse(write_report(result.report))["steps"][0]["symmetry"]["without_partner"], 0);
      return result.mesh.positions;
    };
    const Points above = moved("\"cap\"");
    EXPECT_EQ(moved(other), above) << action;
    EXPECT_EQ(moved(R"({"union": ["cap", )" + other + "]}"), above) << action;
  }
}

// A scan has no vertex exactly at a mirror image. The nearest part of the surface stands in for it.
TEST_F(SculptStepTest, FollowsANearlySymmetricMesh) {
  test::TestMesh ball = test::icosphere(3);
  const Eigen::AngleAxisd turn(0.05, Eigen::Vector3d::UnitX());
  for (auto row : ball.positions.rowwise())
    if (row.z() < 0) row = (turn * Eigen::Vector3d(row.transpose())).transpose();
  put(make_mesh(ball.positions, ball.triangles));
  const EditResult result = run_edit(edit(
      R"("action": "inflate", "height": 0.3, "region": "cap", "symmetry": {"point": [0, 0, 0], "normal": [0, 0, 1]})"));
  const StepReport& report = result.report.steps[0];
  EXPECT_GT(report.symmetry->without_partner, 0);
  ASSERT_EQ(report.notes.size(), 1U);
  EXPECT_TRUE(report.notes[0].id().starts_with("script.region_")) << report.notes[0].id();
  double above = 0, below = 0, step = 0;
  const Points moved = result.mesh.positions - ball.positions;
  for (Index v = 0; v < moved.rows(); ++v)
    (ball.positions(v, 2) > 0 ? above : below) =
        std::max(ball.positions(v, 2) > 0 ? above : below, moved.row(v).norm());
  EXPECT_NEAR(below, above, 0.05 * above);
  for (Index t = 0; t < ball.triangles.rows(); ++t)
    step = std::max(step, (moved.row(ball.triangles(t, 0)) - moved.row(ball.triangles(t, 1))).norm());
  EXPECT_LT(step, 0.5 * above) << "no spikes";
}

TEST_F(SculptStepTest, RefusesARegionWithoutMirrorImage) {
  const std::string fields = R"("action": "inflate", "height": 0.3, "region": "cap", )";
  try {
    run_edit(edit(fields + R"("symmetry": {"point": [0, 0, 50], "normal": [0, 0, 1]})"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "script.image_off_surface");
    EXPECT_GT(error.fact().get<double>("distance_rel"), 0.05);
  }
}

// One vertex of the cap stands on a spike that the other side lacks; all others lack a partner only by a
// little.
TEST_F(SculptStepTest, CountsTheImagesOffTheSurface) {
  test::TestMesh ball = test::icosphere(3);
  const Eigen::AngleAxisd turn(0.01, Eigen::Vector3d::UnitX());
  for (auto row : ball.positions.rowwise())
    if (row.z() < 0) row = (turn * Eigen::Vector3d(row.transpose())).transpose();
  Eigen::Index top = 0;
  ball.positions.col(2).maxCoeff(&top);
  std::vector<Index> around;
  for (auto row : ball.triangles.rowwise())
    if ((row.array() == static_cast<Index>(top)).any())
      for (const Index v : row) around.push_back(v);
  for (const Index v : around)
    ball.positions.row(v) = 0.98 * ball.positions.row(top) + 0.02 * ball.positions.row(v);
  ball.positions.row(top) *= 1.06;
  put(make_mesh(ball.positions, ball.triangles));
  const auto asked = [](const std::string& tolerance) {
    return R"("action": "inflate", "height": 0.3, "region": {"nearest": [0, 0, 2]}, "symmetry": )"
           R"({"point": [0, 0, 0], "normal": [0, 0, 1])" +
           tolerance + "}";
  };
  try {
    run_edit(edit(asked("")));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "script.image_with_gaps");
    EXPECT_EQ(error.fact().get<std::int64_t>("lost"), 1);
    EXPECT_TRUE(error.problem().starts_with("of the region's 1 vertex, 1 has a mirror image farther"))
        << error.what();
    const double suffices = error.fact().get<double>("tolerance_rel");
    EXPECT_NO_THROW(run_edit(edit(asked(R"(, "tolerance_rel": )" + std::to_string(suffices)))));
  }
}

TEST_F(SculptStepTest, IsReported) {
  const EditResult result = run_edit(edit(R"("action": "inflate", "region": "cap", "height": 0.3)"));
  EXPECT_TRUE(result.report.deformed);
  const Json report = Json::parse(write_report(result.report));
  const Json& step = report["steps"][0];
  EXPECT_EQ(step["kind"], "sculpt");
  EXPECT_EQ(step["action"], "inflate");
  EXPECT_EQ(step["region"], cap(read_mesh(folder_ / "ball.ply")).size());
  EXPECT_NEAR(step["max_displacement"].get<double>(), 0.3, 1e-6);
  EXPECT_NEAR(report["max_displacement"].get<double>(), 0.3, 1e-6);
  EXPECT_EQ(step["new_self_intersections"], 0);
  EXPECT_GT(report["quality"]["area_ratio"].get<double>(), 1);
}

TEST_F(SculptStepTest, CountsTheIntersectionsThatItMakes) {
  const EditResult result = run_edit(edit(R"("action": "inflate", "region": "cap", "height": -3)"));
  const std::int64_t counted = result.report.steps[0].sculpt->new_self_intersections;
  EXPECT_GT(counted, 0);
  EXPECT_EQ(counted, result.report.quality.new_self_intersections);
}

TEST_F(SculptStepTest, RefusesWhatMovesNothing) {
  try {
    run_edit(edit(R"("action": "smooth", "region": {"sphere": {"centre": [9, 9, 9], "radius": 1}})"));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), facts::script::SelectionEmpty::id);
    EXPECT_EQ(error.location().text(), "edit.json: steps[0].region");
  }
  EXPECT_THROW(run_edit(edit(R"("action": "smooth", "region": "all", "strength": 1)")), Error);
}

// The step reads two rings around its region.
TEST_F(SculptStepTest, RefusesANonFiniteVertexBesideTheRegion) {
  Mesh given = make_mesh(ball_.positions, ball_.triangles);
  const std::vector<Index> region = cap(given);
  const IndexLists rings = vertex_rings(given.vertex_count(), ball_.triangles);
  const std::vector<Index> around = grow_rings(region, 1, rings);
  const auto beside =
      std::ranges::find_if(around, [&](Index v) { return !std::ranges::binary_search(region, v); });
  ASSERT_NE(beside, around.end());
  given.positions(*beside, 0) = std::nan("");
  put(given);
  for (const char* action :
       {R"("smooth")", R"("flatten")", R"("inflate", "height": 0.1)", R"("flatten", "reach": 0.3)"})
    EXPECT_THROW(run_edit(edit(R"("region": "cap", "action": )" + std::string(action))), Error) << action;
}

TEST_F(SculptStepTest, ReadsBackWhatItWrites) {
  const std::string written =
      write_edit(read_edit_file(test::source_path("tests/script/accepted/sculpt.json")));
  EXPECT_EQ(write_edit(parse_edit(written, "edit.json")), written);
}

}  // namespace
}  // namespace meshgraft
