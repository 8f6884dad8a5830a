
#include <algorithm>

#include <gtest/gtest.h>

#include <meshgraft/mesh/diagnostics.h>

#include "mesh/sound_mesh.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(SoundMesh, IsTheGivenMeshWhereNothingIsRefused) {
  for (const test::TestMesh& family : test::small_families()) {
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    const Diagnostics diagnostics = check_mesh(mesh);
    const SoundMesh sound(mesh, diagnostics, family.name);
    EXPECT_EQ(&sound.mesh(), &mesh);
    EXPECT_FALSE(sound.any() || sound.note());
    EXPECT_NO_THROW(sound.require_beyond(std::vector<Index>{0, 1, 2}));
  }
}

TEST(SoundMesh, LeavesOutRefusedFacesAndPutsCoordinatesBack) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh whole = make_mesh(family.positions, family.triangles);
    if (whole.face_count() < 30) continue;
    const Mesh mesh = test::with_bad_indices(test::with_non_finite(whole, 2, 1), 2, 1);
    const Diagnostics diagnostics = check_mesh(mesh);
    const SoundMesh sound(mesh, diagnostics, family.name);
    ASSERT_TRUE(sound.any() && sound.note());
    EXPECT_TRUE(sound.mesh().positions.allFinite());
    for (const FindingKind refused : {FindingKind::non_finite, FindingKind::index_out_of_range})
      EXPECT_EQ(check_mesh(sound.mesh()).find(refused), nullptr);

    Mesh result = sound.mesh();
    IndexMap same_vertices;
    for (Index v = 0; v < mesh.vertex_count(); ++v) same_vertices.new_index.push_back(v);
    sound.put_back(same_vertices, result);
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      for (int k = 0; k < 3; ++k)
        EXPECT_TRUE(result.positions(v, k) == mesh.positions(v, k) ||
                    (std::isnan(result.positions(v, k)) && std::isnan(mesh.positions(v, k))));
  }
}

TEST(SoundMesh, IsRequiredOnlyWhereAnEditReaches) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    Mesh mesh = make_mesh(family.positions, family.triangles);
    if (mesh.face_count() < 30) continue;
    const Index broken = mesh.faces.corners().front();
    mesh.positions(broken, 1) = std::nan("");
    const Diagnostics diagnostics = check_mesh(mesh);
    const SoundMesh sound(mesh, diagnostics, family.name);
    Flags beside(mesh.vertex_count(), 0);
    for (Index f = 0; f < mesh.face_count(); ++f)
      if (std::ranges::count(mesh.faces[f], broken) > 0)
        for (const Index v : mesh.faces[f]) beside[v] = 1;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      const std::vector<Index> reached{v};
      if (beside[v]) {
        EXPECT_THROW(sound.require_beyond(reached), Error) << v;
      } else {
        EXPECT_NO_THROW(sound.require_beyond(reached)) << v;
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft
