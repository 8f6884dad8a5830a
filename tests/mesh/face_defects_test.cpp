#include "mesh/face_defects.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(HasNoArea, IsSaidOfFlattenedTrianglesInAnyUnit) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    for (const double unit : {1e-30, 1e-3, 1.0, 1e20}) {
      for (Eigen::Index t = 0; t < family.triangles.rows(); ++t) {
        Points corners(3, 3);
        for (int k = 0; k < 3; ++k) corners.row(k) = unit * family.positions.row(family.triangles(t, k));
        const std::array<Index, 3> face{0, 1, 2};
        EXPECT_FALSE(has_no_area(face, corners));
        corners.row(2) = corners.row(0) + 0.25 * (corners.row(1) - corners.row(0));
        EXPECT_TRUE(has_no_area(face, corners));
        corners.row(2) = corners.row(0);
        EXPECT_TRUE(has_no_area(face, corners));
      }
    }
  }
}

TEST(HasNoArea, IsDecidedByTheHeightOverTheLongestEdge) {
  const std::array<Index, 3> face{0, 1, 2};
  for (const double unit : {1e-30, 1.0, 1e20}) {
    for (const double height : {1e-15, 0.9e-12, 1.1e-12, 1e-3}) {
      Points corners(3, 3);
      corners << 0, 0, 0, unit, 0, 0, unit / 2, unit * height, 0;
      EXPECT_EQ(has_no_area(face, corners), height < 1e-12) << height << " in units of " << unit;
    }
  }
}

TEST(IsDegenerate, IsSaidOfFacesThatRepeatAVertex) {
  std::vector<Index> face;
  for (Index corners = 0; corners < 8; ++corners) {
    EXPECT_EQ(is_degenerate(face), corners < 3) << corners;
    for (std::size_t k = 0; k < face.size(); ++k) {
      std::vector<Index> repeating = face;
      repeating.push_back(face[k]);
      EXPECT_TRUE(is_degenerate(repeating)) << corners << " corners, and corner " << k << " again";
    }
    face.push_back(corners);
  }
}

TEST(InRange, AsksForEveryCorner) {
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<Index> face{0, 1, 2, 3};
    EXPECT_TRUE(in_range(face, 4));
    for (const Index bad : {-1, 4}) {
      face[k] = bad;
      EXPECT_FALSE(in_range(face, 4));
    }
  }
}

}  // namespace
}  // namespace meshgraft
