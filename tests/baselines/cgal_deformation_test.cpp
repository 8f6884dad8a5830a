// The methods that CGAL has, too, end at the same surfaces.
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "../bench/cgal_deformation.h"
#include "baselines/baselines.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

using bench::BenchEdit;
using bench::CgalMethod;
using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// Returns a torus on which each vertex has six neighbours and all angles are acute. Neighbouring rows are
/// shifted against each other by half a cell.
TestMesh acute_torus() {
  constexpr int around = 24, rows = 12;
  TestMesh mesh{"acute torus", Points(around * rows, 3), Triangles(2 * around * rows, 3)};
  const auto vertex = [](int row, int cell) -> Index {
    const int shift = row >= rows ? rows / 2 : 0;  // by which the rows are shifted after one turn
    return row % rows * around + (cell + shift + around) % around;
  };
  for (int row = 0; row < rows; ++row)
    for (int cell = 0; cell < around; ++cell) {
      const double u = 2 * std::numbers::pi * (cell + 0.5 * row) / around;
      const double v = 2 * std::numbers::pi * row / rows;
      const double radius = 1 + 0.35 * std::cos(v);
      mesh.positions.row(vertex(row, cell)) << radius * std::cos(u), radius * std::sin(u), 0.35 * std::sin(v);
      const Index t = 2 * (row * around + cell);
      mesh.triangles.row(t) << vertex(row, cell), vertex(row, cell + 1), vertex(row + 1, cell);
      mesh.triangles.row(t + 1) << vertex(row, cell + 1), vertex(row + 1, cell + 1), vertex(row + 1, cell);
    }
  return mesh;
}

BenchEdit edit_of(const TestMesh& mesh, double angle_deg) {
  const Scene scene = make_scene(mesh);
  return {mesh.positions, mesh.triangles, scene.foot, scene.head,
          about_middle(
              mesh, AngleAxisd(angle_deg * std::numbers::pi / 180, Vector3d(1, 2, -1).normalized()).matrix())};
}

Points ours(const BenchEdit& edit, Baseline method, const BaselineOptions& options) {
  std::vector<VertexConstraint> constraints;
  for (Index v : edit.fixed) constraints.push_back({v, Vector3d(edit.positions.row(v)), {}});
  for (Index v : edit.handle) constraints.push_back({v, edit.pose * Vector3d(edit.positions.row(v)), {}});
  return deform_by(method, {edit.positions, edit.triangles, {.whole = true}, constraints}, options);
}

struct Pair {
  const char* name;
  Baseline method;
  BaselineOptions options;
  CgalMethod cgal;
  double alpha;
  TestMesh mesh;
  double tolerance;
};

class BesideCgal : public testing::TestWithParam<Pair> {};

TEST_P(BesideCgal, EndsAtTheSameSurface) {
  const Pair& pair = GetParam();
  const BenchEdit edit = edit_of(pair.mesh, 25);
  BaselineOptions options = pair.options;
  options.arap_iterations = 2000;
  options.arap_tolerance = 0;
  const Points other = run_cgal(edit, pair.cgal, {.iterations = 4000, .sre_alpha = pair.alpha}).positions;
  const double moved = largest_distance(other, edit.positions);
  EXPECT_LT(largest_distance(ours(edit, pair.method, options), other), pair.tolerance * moved);
}

// SRE_ARAP weights the rotations around vertex k by 1/d_k, where d_k is the number of its neighbours. The
// energy here is symmetric, and the same for equal d. Its α is half of CGAL's.
INSTANTIATE_TEST_SUITE_P(
    All, BesideCgal,
    testing::Values(
        Pair{"Arap", Baseline::arap_2007, {}, CgalMethod::original_arap, 0, acute_torus(), 1e-6},
        Pair{"SpokesAndRims",
             Baseline::smooth_arap_2025,
             {.smoothness = 0},
             CgalMethod::spokes_and_rims,
             0,
             acute_torus(),
             1e-6},
        Pair{"SpokesAndRimsObtuse",
             Baseline::smooth_arap_2025,
             {.smoothness = 0},
             CgalMethod::spokes_and_rims,
             0,
             bumpy_sphere(3),
             1e-6},
        Pair{"Sr", Baseline::sr_arap_2015, {}, CgalMethod::sre_arap, 0.02, acute_torus(), 1e-6},
        Pair{"SrStiff",
             Baseline::sr_arap_2015,
             {.sr_alpha = 0.1},
             CgalMethod::sre_arap,
             0.2,
             acute_torus(),
             1e-6},
        Pair{"SrUneven", Baseline::sr_arap_2015, {}, CgalMethod::sre_arap, 0.02, icosphere(2), 1e-2}),
    [](const auto& pair) { return std::string(pair.param.name); });

}  // namespace
}  // namespace meshgraft::test
