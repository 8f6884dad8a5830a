#include "mesh/traced_faces.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace meshgraft {
namespace {

TEST(TriangulateChosen, SplitsTheChosenFacesAlone) {
  for (const Mesh& mesh : {shapes::cube(), shapes::torus(), shapes::tube(7, 3), shapes::grid(3, 2, true)}) {
    for (const Index every : {1, 2, 1000}) {
      const auto chosen = [&](Index f) { return f % every == 0; };
      const TracedFaces traced = triangulate_chosen(mesh, chosen);
      ASSERT_EQ(traced.face_origin.size(), traced.faces.size());
      ASSERT_EQ(traced.corner_origin.size(), traced.faces.corner_count());
      EXPECT_TRUE(std::ranges::is_sorted(traced.face_origin));
      for (Index f = 0; f < traced.faces.size(); ++f) {
        const Index origin = traced.face_origin[f];
        EXPECT_EQ(traced.faces[f].size(), chosen(origin) ? 3 : mesh.faces[origin].size());
        for (Index c = traced.faces.first_corner(f); c < traced.faces.first_corner(f + 1); ++c) {
          const EdgePoint& from = traced.corner_origin[c];
          EXPECT_TRUE(from.from == from.to && from.t == 0);
          EXPECT_EQ(mesh.faces.corners()[from.from], traced.faces.corners()[c]);
          EXPECT_GE(from.from, mesh.faces.first_corner(origin));
          EXPECT_LT(from.from, mesh.faces.first_corner(origin + 1));
        }
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft
