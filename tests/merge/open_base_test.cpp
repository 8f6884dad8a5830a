#include "merge/open_base.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "mesh/join.h"
#include "mesh/winding.h"

namespace meshgraft {
namespace {

Mesh closed_sample(const std::string& name, int resolution = 24) {
  const Mesh mesh = make_sample(name, resolution);
  if (boundary_loops(mesh).empty()) return mesh;
  constexpr Index any_hole = 1000;
  return repair(mesh, {.hole_edges = any_hole}).mesh;
}

std::string refusal(const Mesh& mesh, const DropBase& base) {
  try {
    open_base(mesh, base);
  } catch (const Error& error) {
    return std::string(error.id()) + " at " + error.location().text();
  }
  return "none";
}

double height_of(const OpenedSource& opened, const Eigen::RowVector3d& point) {
  return (point.transpose() - opened.report.point).dot(opened.report.normal);
}

TEST(OpenBase, CutsOffWhatLiesBelowThePlane) {
  for (const char* name :
       {"bar", "cactus", "dinosaur", "head", "bust", "torus", "knot", "bracket", "octopus"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = closed_sample(name);
    const OpenedSource opened = open_base(mesh);
    const TopologySummary topology = summarise_topology(opened.mesh);
    EXPECT_TRUE(topology.manifold && topology.oriented);
    EXPECT_EQ(topology.components, 1);
    EXPECT_EQ(topology.boundary_loops, opened.report.loops);
    EXPECT_EQ(opened.loops.size(), static_cast<std::size_t>(opened.report.loops));
    const double size = (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).norm();
    Index gone = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      const Index now = opened.vertex.new_index[v];
      gone += now < 0 ? 1 : 0;
      if (now >= 0) continue;
      EXPECT_LT(height_of(opened, mesh.positions.row(v)), 1e-9 * size);
    }
    EXPECT_EQ(gone, opened.report.cut_away);
    for (Index v = 0; v < opened.mesh.vertex_count(); ++v) {
      EXPECT_GT(height_of(opened, opened.mesh.positions.row(v)), -1e-9 * size);
      ASSERT_TRUE(opened.nearest[v] >= 0 && opened.nearest[v] < mesh.vertex_count());
    }
    for (const auto& loop : opened.loops)
      for (const Index v : loop) EXPECT_NEAR(height_of(opened, opened.mesh.positions.row(v)), 0, 1e-9 * size);
  }
}

TEST(OpenBase, StandsOnEachFoot) {
  EXPECT_EQ(open_base(closed_sample("dinosaur", 40)).report.loops, 4);
  EXPECT_EQ(open_base(closed_sample("bracket", 40)).report.loops, 4);
  EXPECT_EQ(open_base(closed_sample("cactus")).report.loops, 1);
}

TEST(OpenBase, FindsAFlatSideWhereverItIs) {
  Mesh lying = closed_sample("cylinder");  // its ends are flat, and it is longer than wide
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).matrix();
  lying.positions = (lying.positions * turn.transpose()).eval();
  const OpenedSource opened = open_base(lying);
  EXPECT_TRUE(opened.report.flat);
  EXPECT_NEAR(std::abs(opened.report.normal.y()), 1, 1e-9);
  EXPECT_EQ(opened.report.loops, 1);
}

TEST(OpenBase, FollowsASimilarityAboutUp) {
  const Mesh mesh = closed_sample("bust", 32);
  Mesh moved = mesh;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).matrix();
  moved.positions = (3.5 * mesh.positions * turn.transpose()).rowwise() + Eigen::RowVector3d(4, -2, 9);
  const BaseReport a = open_base(mesh).report, b = open_base(moved).report;
  EXPECT_EQ(a.cut_away, b.cut_away);
  EXPECT_NEAR(3.5 * a.height, b.height, 1e-9);
  EXPECT_LT((turn * a.normal - b.normal).norm(), 1e-9);
  EXPECT_LT((3.5 * turn * a.point + Eigen::Vector3d(4, -2, 9) - b.point).norm(), 1e-7);
  EXPECT_EQ(open_base(turned_over(mesh)).report.cut_away, a.cut_away);
}

TEST(OpenBase, CutsAtTheHeightThatIsGiven) {
  const Mesh mesh = closed_sample("cactus");
  const double lowest = mesh.positions.col(2).minCoeff();
  const OpenedSource found = open_base(mesh);
  Index before = 0;
  for (const double height : {0.1, 0.2, 0.35, 0.5}) {
    const BaseReport report = open_base(mesh, {.height = height}).report;
    EXPECT_EQ(report.height, height);
    EXPECT_LT((report.normal - found.report.normal).norm(), 1e-12);
    EXPECT_NEAR(report.point.z(), lowest + height, 0.01 * height);  // the base is nearly level
    EXPECT_GT(report.cut_away, before);
    before = report.cut_away;
  }
}

TEST(OpenBase, TurnsThePlaneAboutTheCentreOfItsSection) {
  const Mesh mesh = closed_sample("bar");
  const BaseReport level = open_base(mesh, {.height = 1.0}).report;
  const std::vector<Eigen::Vector3d> axes{{1, 0, 0}, {0, 2, 0}, {1, 1, 0}};
  for (const Eigen::Vector3d& axis : axes)
    for (const double tilt : {-20.0, 5.0, 30.0}) {
      const DropBase base{.height = 1.0, .tilt_deg = tilt, .tilt_axis = axis};
      const BaseReport report = open_base(mesh, base).report;
      const Eigen::AngleAxisd turn(tilt * std::numbers::pi / 180, axis.normalized());
      EXPECT_LT((turn * level.normal - report.normal).norm(), 1e-9);
      EXPECT_LT((report.point - level.point).norm(), 1e-6);  // the bar is symmetrical
    }
  const BaseReport about_x = open_base(mesh, {.height = 1.0, .tilt_deg = 20}).report;
  EXPECT_NEAR(about_x.normal.x(), 0, 1e-12);
}

TEST(OpenBase, SaysWhyAPlaneIsNoBase) {
  const Mesh bar = closed_sample("bar"), dinosaur = closed_sample("dinosaur", 40);
  EXPECT_EQ(refusal(bar, {.height = 5.0}), "merge.base_height_outside at base.height");
  EXPECT_EQ(refusal(bar, {.height = -1.0}), "merge.base_height_outside at base.height");
  EXPECT_EQ(refusal(bar, {.height = std::nan("")}), "merge.base_height_outside at base.height");
  EXPECT_EQ(refusal(bar, {.tilt_deg = 90}), "merge.base_tilt_too_large at base.tilt_deg");
  EXPECT_EQ(refusal(bar, {.tilt_deg = 5, .tilt_axis = Eigen::Vector3d(0, 0, 1)}),
            "merge.base_tilt_turns_nothing at base.tilt_axis");
  EXPECT_EQ(refusal(bar, {.tilt_deg = 5, .tilt_axis = Eigen::Vector3d::Zero()}),
            "merge.base_tilt_turns_nothing at base.tilt_axis");
  // Between its legs and its back the dinosaur's neck, body and tail are apart above the plane.
  const double top = dinosaur.positions.col(2).maxCoeff() - dinosaur.positions.col(2).minCoeff();
  Index pieces = 0;
  for (double height = 0.05; height < 1; height += 0.05)
    pieces += refusal(dinosaur, {.height = height * top}) == "merge.base_divides_source at base" ? 1 : 0;
  EXPECT_GT(pieces, 0);
  // The torus stands on its outer side. A plane that is nearly level cuts it in two rings, one within the
  // other.
  const Mesh torus = make_sample("torus", 40);
  const Eigen::Vector3d up = open_base(torus).report.normal;
  EXPECT_NEAR(up.z(), 0, 1e-9);
  const Eigen::Vector3d axis = up.cross(Eigen::Vector3d::UnitZ());
  EXPECT_EQ(refusal(torus, {.height = 1.4, .tilt_deg = 85, .tilt_axis = axis}), "merge.base_is_hollow at base");
}

TEST(OpenBase, RefusesASourceWithoutABase) {
  // A chain of needles has no side with a clean section.
  Mesh star;
  constexpr int points = 24;
  std::vector<Mesh> needles;
  star.positions.resize(2 * points + 2, 3);
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = std::numbers::pi * k / points, radius = k % 2 == 0 ? 1 : 0.05;
    star.positions.row(k) << radius * std::cos(angle), radius * std::sin(angle), 0;
  }
  star.positions.row(2 * points) << 0, 0, 1;
  star.positions.row(2 * points + 1) << 0, 0, -1;
  for (int k = 0; k < 2 * points; ++k) {
    const Index a = k, b = (k + 1) % (2 * points);
    star.faces.push_back(std::vector<Index>{a, b, 2 * points});
    star.faces.push_back(std::vector<Index>{b, a, 2 * points + 1});
  }
  EXPECT_EQ(refusal(star, {}), "merge.no_base at base");
}

}  // namespace
}  // namespace meshgraft
