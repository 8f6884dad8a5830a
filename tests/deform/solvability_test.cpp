#include "deform/setup/solvability.h"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/QR>

#include <meshgraft/core/error.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// Returns whether the energy has one minimum: its rows in the unknown positions and apexes, and those of the
/// anchors, have full column rank.
bool has_one_minimum(const test::TestMesh& mesh, const ConstraintMask& mask) {
  const AffineOperator rows(OperatorMesh{mesh.positions, mesh.triangles}, mask,
                            {.degenerate = DegenerateTreatment::apex});
  const Eigen::MatrixXd A = Eigen::MatrixXd(rows.A());
  const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
  std::vector<Eigen::Index> unknown;
  for (Index v = 0; v < mesh.size(); ++v)
    if (!mask.position[v] && !rings[v].empty()) unknown.push_back(v);
  for (Eigen::Index apex = mesh.size(); apex < A.cols(); ++apex) unknown.push_back(apex);
  if (unknown.empty()) return true;
  const auto anchors = std::count(mask.anchored.begin(), mask.anchored.end(), 1);
  Eigen::MatrixXd columns(A.rows() + anchors, static_cast<Eigen::Index>(unknown.size()));
  columns.setZero();
  for (std::size_t c = 0; c < unknown.size(); ++c)
    columns.col(static_cast<Eigen::Index>(c)).head(A.rows()) = A.col(unknown[c]);
  Eigen::Index row = A.rows();
  for (Index v = 0; v < mesh.size(); ++v) {
    if (!mask.anchored[v]) continue;
    const auto at = std::find(unknown.begin(), unknown.end(), v);
    if (at != unknown.end()) columns(row, at - unknown.begin()) = 1;
    ++row;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  qr.setThreshold(1e-10);
  return qr.rank() == columns.cols();
}

/// Returns the id of the refusal, or "".
std::string refusal_of(const test::TestMesh& mesh, const ConstraintMask& mask) {
  try {
    require_solvable(mesh.positions, mesh.triangles, mask, {});
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unsolvable);
    return std::string(error.id());
  }
}

ConstraintMask random_mask(Index count, int positions, int transforms, int anchors, std::mt19937& random) {
  ConstraintMask mask(count, false);
  for (int k = 0; k < positions; ++k) mask.position[random() % count] = 1;
  for (int k = 0; k < transforms; ++k) mask.transform[random() % count] = 1;
  for (int k = 0; k < anchors; ++k) mask.anchored[random() % count] = 1;
  return mask;
}

TEST(Solvability, IsThatTheEnergyHasOneMinimum) {
  std::mt19937 random(31);
  int held = 0, loose = 0;
  for (const test::TestMesh& mesh :
       {test::tetrahedron(), test::octahedron(), test::icosphere(1), test::grid(4, 3), test::tube(6, 3)}) {
    for (int positions = 0; positions <= 5; ++positions)
      for (int transforms = 0; transforms <= 1; ++transforms)
        for (int anchors = 0; anchors <= 2; ++anchors) {
          const ConstraintMask mask = random_mask(mesh.size(), positions, transforms, anchors, random);
          const bool is_held = refusal_of(mesh, mask).empty();
          EXPECT_EQ(is_held, has_one_minimum(mesh, mask))
              << mesh.name << ": " << positions << " positions, " << transforms << " transforms, " << anchors
              << " anchors";
          ++(is_held ? held : loose);
        }
  }
  EXPECT_GT(held, 30);
  EXPECT_GT(loose, 30);
}

TEST(Solvability, TellsWhatTheGivenPositionsSpan) {
  const test::TestMesh mesh = test::flat_sheet(6, 6);
  const auto mask_with = [&](std::vector<Index> given) {
    ConstraintMask mask(mesh.size(), false);
    for (const Index v : given) mask.position[v] = 1;
    return mask;
  };
  EXPECT_EQ(refusal_of(mesh, mask_with({})), "deform.component_not_held");
  for (const std::vector<Index>& given : {std::vector<Index>{8}, {8, 9}, {0, 3, 30, 44}})
    EXPECT_EQ(refusal_of(mesh, mask_with(given)), "deform.component_held_by_positions");
  ConstraintMask with_transform = mask_with({8});
  with_transform.transform[20] = 1;
  EXPECT_EQ(refusal_of(mesh, with_transform), "");
}

TEST(Solvability, IsAskedOfEachComponent) {
  const test::TestMesh one = test::octahedron();
  const Index n = one.size();
  test::TestMesh two = one;
  two.positions.conservativeResize(2 * n, 3);
  two.positions.bottomRows(n) = one.positions.array() + 10;
  two.triangles.conservativeResize(2 * one.triangles.rows(), 3);
  two.triangles.bottomRows(one.triangles.rows()) = one.triangles.array() + n;

  ConstraintMask mask(2 * n, false);
  mask.position[0] = mask.transform[0] = 1;
  try {
    require_solvable(two.positions, two.triangles, mask, {});
    ADD_FAILURE() << "the second component is loose";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "deform.component_not_held");
    EXPECT_NE(error.problem().find(std::to_string(n)), std::string::npos) << error.problem();
  }
  // A feature that both share moves them as one.
  for (const Index v : {Index{1}, Index{2}, static_cast<Index>(n + 1)}) mask.feature[v] = 0;
  EXPECT_EQ(refusal_of(two, mask), "");
}

TEST(Solvability, FixesTransformsThatNothingDependsOn) {
  const test::TestMesh mesh = test::with_isolated_vertices(test::grid(5, 4));
  const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
  ConstraintMask held(mesh.size(), false);
  std::fill(held.position.begin(), held.position.end(), 1);
  ConstraintMask fixed = held;
  fix_unconstrained_components(rings, fixed);
  for (Index v = 0; v < mesh.size(); ++v) EXPECT_EQ(fixed.transform[v] != 0, !rings[v].empty()) << v;

  Index inner = 0;
  while (rings[inner].size() < 5) ++inner;
  held.position[inner] = 0;
  fixed = held;
  fix_unconstrained_components(rings, fixed);
  EXPECT_EQ(fixed.transform, held.transform) << "one free vertex depends on all transforms of its component";
}

}  // namespace
}  // namespace meshgraft
