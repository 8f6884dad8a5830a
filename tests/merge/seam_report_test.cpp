#include "merge/seam_report.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "merge/closed_curves.h"
#include "merge/seam_scenes.h"

namespace meshgraft {
namespace {

TEST(SeamReport, TellsTheTopology) {
  for (const test::SeamScene& scene : test::seam_scenes(0.2)) {
    SCOPED_TRACE(scene.name);
    const SeamReport report = measure_seam(scene.mesh, scene.layout, scene.mesh.positions);
    const TopologySummary topology = summarise_topology(scene.mesh);
    EXPECT_TRUE(report.manifold && report.oriented);
    EXPECT_EQ(report.closed, topology.closed);
    EXPECT_EQ(report.euler_characteristic, topology.euler_characteristic);
    EXPECT_EQ(report.new_faces, scene.mesh.face_count() - scene.strip_begin());
    test::SeamScene fin = scene;
    fin.mesh.faces.push_back(
        std::vector<Index>{fin.mesh.faces[0][0], fin.mesh.faces[0][1], fin.mesh.vertex_count() - 1});
    EXPECT_FALSE(measure_seam(fin.mesh, fin.layout, fin.mesh.positions).manifold);
  }
}

TEST(SeamReport, MeasuresAnglesAndFolds) {
  const auto wall = [](double h) { return std::pair(1.0, 2.0 * h); };
  for (const int around : {12, 24, 48}) {
    // Triangles of a tube whose rows are √3/2 of an edge apart are nearly equilateral.
    const double edge = 2 * std::sin(std::numbers::pi / around);
    const test::SeamScene scene = test::round_seam(
        "tube", around, 10, 0, [&](double h) { return std::pair(1.0, 4.5 * std::sqrt(0.75) * edge * h); });
    const SeamReport report = measure_seam(scene.mesh, scene.layout, scene.mesh.positions);
    EXPECT_NEAR(report.angle_p1_deg, 60, 2.0) << around;
    EXPECT_NEAR(report.dihedral_p99_deg, report.target_dihedral_p99_deg, 1e-6);
    EXPECT_NEAR(report.dihedral_p99_deg, report.source_dihedral_p99_deg, 1e-6);
    EXPECT_LT(report.dihedral_p99_deg, 360.0 / around);
  }
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    const SeamReport report = measure_seam(scene.mesh, scene.layout, scene.mesh.positions);
    if (scene.name == "flat ring") {
      EXPECT_NEAR(report.dihedral_p99_deg, 0, 1e-9);
    }
  }
  const SeamReport even = measure_seam(test::round_seam("", 16, 10, 0, wall).mesh,
                                       test::seam_scenes(0)[0].layout, test::seam_scenes(0)[0].smooth),
                   noisy = measure_seam(test::round_seam("", 16, 10, 0.5, wall).mesh,
                                        test::seam_scenes(0)[0].layout, test::seam_scenes(0)[0].smooth);
  EXPECT_GT(noisy.dihedral_p99_deg, even.dihedral_p99_deg + 5);
}

TEST(SeamReport, MeasuresHowFarTheTargetMoved) {
  for (const test::SeamScene& scene : test::seam_scenes(0.1)) {
    SCOPED_TRACE(scene.name);
    EXPECT_EQ(measure_seam(scene.mesh, scene.layout, scene.mesh.positions).band_displacement_rel, 0);
    Points before = scene.mesh.positions;
    before.row(scene.layout.target_vertices) +=
        Eigen::RowVector3d(1, 1, 1);  // of the source: it does not count
    EXPECT_EQ(measure_seam(scene.mesh, scene.layout, before).band_displacement_rel, 0);
    before.row(0) += Eigen::RowVector3d(0, 0.25, 0);
    const double diagonal =
        (scene.mesh.positions.colwise().maxCoeff() - scene.mesh.positions.colwise().minCoeff()).norm();
    EXPECT_NEAR(measure_seam(scene.mesh, scene.layout, before).band_displacement_rel, 0.25 / diagonal, 1e-12);
  }
}

TEST(SeamReport, DoesNotDependOnPoseAndUnit) {
  for (const test::SeamScene& scene : test::seam_scenes(0.3)) {
    const SeamReport report = measure_seam(scene.mesh, scene.layout, scene.smooth);
    for (const Eigen::Affine3d& map : test::similarities()) {
      test::SeamScene moved = scene;
      moved.mesh.positions = test::mapped(scene.mesh.positions, map);
      const SeamReport other = measure_seam(moved.mesh, moved.layout, test::mapped(scene.smooth, map));
      EXPECT_NEAR(other.angle_p1_deg, report.angle_p1_deg, 1e-6) << scene.name;
      EXPECT_NEAR(other.dihedral_p99_deg, report.dihedral_p99_deg, 1e-6) << scene.name;
    }
  }
}

}  // namespace
}  // namespace meshgraft
