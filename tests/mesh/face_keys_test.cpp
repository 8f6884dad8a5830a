#include "mesh/face_keys.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(SameFaces, AreThoseWithTheSameCornersInAnyDirection) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = test::with_repeated_faces(make_mesh(family.positions, family.triangles), 5, 1);
    std::map<std::vector<Index>, std::vector<Index>> by_corners;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      std::vector<Index> key(mesh.faces[f].begin(), mesh.faces[f].end());
      std::ranges::sort(key);
      by_corners[key].push_back(f);
    }
    std::vector<std::vector<Index>> expected;
    for (const auto& [key, faces] : by_corners)
      if (faces.size() > 1) expected.push_back(faces);
    std::ranges::sort(expected);
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(same_faces(mesh.faces, mesh.vertex_count()), expected);
  }
}

TEST(SameFaces, HaveOneCyclicOrder) {
  Faces faces;
  for (const std::vector<Index>& face : {std::vector<Index>{0, 1, 2, 3},
                                         {2, 3, 0, 1},
                                         {1, 0, 3, 2},
                                         {0, 2, 1, 3},
                                         {0, 1, 2},
                                         {0, 1, 2, 9},
                                         {0, 0, 1}})
    faces.push_back(face);
  EXPECT_EQ(same_faces(faces, 4), (std::vector<std::vector<Index>>{{0, 1, 2}}));
  const std::vector<Index> renamed{0, 1, 2, 2};  // faces 0 to 3 repeat a vertex then
  EXPECT_TRUE(same_faces(faces, 4, renamed).empty());
}

}  // namespace
}  // namespace meshgraft
