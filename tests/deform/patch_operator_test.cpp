#include "deform/setup/patch_operator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "deform/setup/solvability.h"
#include "linalg/sparse.h"
#include "support/mesh_families.h"
#include "support/variants.h"

namespace meshgraft {
namespace {

/// A family in which the vertices near one vertex are unknown, and fewer of them for a second mask. Of the
/// middle one only the position is known, of a neighbour only the transform.
struct OperatorScene {
  test::TestMesh mesh;
  std::shared_ptr<const RestMesh> rest;
  IndexLists rings;
  ConstraintMask mask, fewer;

  explicit OperatorScene(test::TestMesh family, int radius = 4)
      : mesh(std::move(family)),
        rest(std::make_shared<const RestMesh>(mesh.positions, mesh.triangles)),
        rings(vertex_rings(mesh.size(), mesh.triangles)),
        mask(mesh.size(), true),
        fewer(mesh.size(), true) {
    const Index middle = mesh.triangles(mesh.triangles.rows() / 2, 0);
    unknown(middle, radius, mask);
    unknown(middle, std::max(1, radius - 2), fewer);
    mask.position[middle] = fewer.position[middle] = 1;
    const Index beside = rings[middle].front();
    mask.transform[beside] = fewer.transform[beside] = 1;
  }

  CutPatch cut(int order = 1) const { return {rest, mask, order, Context()}; }
  CutPatch cut_fewer(int order = 1) const { return {rest, fewer, order, Context()}; }

 private:
  void unknown(Index middle, int radius, ConstraintMask& some) const {
    for (const Index v : grow_rings(std::vector{middle}, radius, rings))
      some.position[v] = some.transform[v] = 0;
  }
};

std::vector<OperatorScene> operator_scenes() {
  std::vector<OperatorScene> scenes;
  for (const test::TestMesh& mesh : test::mesh_families()) scenes.emplace_back(mesh);
  return scenes;
}

/// Returns the mask of a patch as a system passes it to the operator.
ConstraintMask operator_mask(const CutPatch& cut, const ConstraintMask& mask) {
  ConstraintMask of_patch = cut.patch_mask(mask);
  fix_unconstrained_components(vertex_rings(cut.patch.size(), cut.patch.triangles), of_patch);
  return of_patch;
}

/// Returns the rows' normal matrix over the unknown nodes: each vertex with an unknown position, then its apex.
Eigen::MatrixXd normal_of(const AffineOperator& op, const SparseRows& H, const ConstraintMask& mask) {
  std::vector<Eigen::Index> nodes;
  for (Index v = 0; v < mask.size(); ++v) {
    if (!mask.position[v]) nodes.push_back(v);
    if (op.nodes().apex[v] >= 0 && mask.is_fitted(v)) nodes.push_back(op.nodes().apex[v]);
  }
  SparseRows columns(op.nodes().positions.rows(), static_cast<Eigen::Index>(nodes.size()));
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    entries.emplace_back(static_cast<int>(nodes[k]), static_cast<int>(k), 1.0);
  columns.setFromTriplets(entries.begin(), entries.end());
  const SparseRows laplacian = op.L() - multiply(op.delta(), H), smoothness = multiply(op.P(), H);
  const SparseRows A = multiply(stack(laplacian, smoothness), columns);
  return Eigen::MatrixXd(multiply(transpose(A), A));
}

/// Returns a row of H by vertices, then apexes by their vertices.
Eigen::RowVectorXd map_row(const AffineOperator& op, const SparseRows& H, Eigen::Index row) {
  const auto n = static_cast<Eigen::Index>(op.nodes().apex.size());
  Eigen::RowVectorXd nodes = Eigen::RowVectorXd(H.row(row)), by_vertex = Eigen::RowVectorXd::Zero(2 * n);
  by_vertex.head(n) = nodes.head(n);
  for (Eigen::Index v = 0; v < n; ++v)
    if (const Index apex = op.nodes().apex[static_cast<std::size_t>(v)]; apex >= 0)
      by_vertex[n + v] = nodes[apex];
  return by_vertex;
}

TEST(PatchOperator, PatchesReachAFewRingsBeyondTheUnknown) {
  for (const OperatorScene& scene : operator_scenes())
    for (const int order : {1, 2, 3}) {
      SCOPED_TRACE(scene.mesh.name);
      const CutPatch cut = scene.cut(order);
      std::vector<Index> unknown;
      for (Index v = 0; v < scene.mesh.size(); ++v) {
        EXPECT_EQ(cut.in_faces[v] != 0, !scene.rings[v].empty());
        EXPECT_EQ(cut.active[v] != 0, cut.in_faces[v] && scene.mask.is_unknown(v));
        if (cut.active[v]) unknown.push_back(v);
      }
      EXPECT_EQ(cut.rings, order + 2);
      EXPECT_EQ(cut.patch.vertices, grow_rings(unknown, order + 3, scene.rings));
    }
}

TEST(PatchOperator, RowsOfTheUnknownAreThoseOfTheWholeMesh) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const int order : {1, 2})
      for (OperatorOptions options : test::operator_variants()) {
        SCOPED_TRACE(mesh.name + ", " + test::describe(options));
        options.laplacian_order = order;
        const OperatorScene scene(mesh, 2);
        const CutPatch cut = scene.cut(order);
        const ConstraintMask of_patch = operator_mask(cut, scene.mask);
        const PatchOperator rows(cut, of_patch, options, {});
        ConstraintMask of_mesh = scene.mask;
        for (Index v = 0; v < cut.patch.size(); ++v) {
          of_mesh.position[cut.patch.vertices[v]] = of_patch.position[v];
          of_mesh.transform[cut.patch.vertices[v]] = of_patch.transform[v];
        }
        const AffineOperator whole(OperatorMesh{mesh.positions, mesh.triangles}, of_mesh, options);
        // A row of a patch differs by ℓ̄ at most. All else in AᵀA has no length.
        double factor = 1;
        if (options.density == Density::aware)
          factor = std::pow(cut.patch.scale * rows.rows().mean_edge_length() / whole.mean_edge_length(), 2);
        const Eigen::MatrixXd expected = factor * normal_of(whole, whole.H(), of_mesh);
        EXPECT_LE((normal_of(rows.rows(), rows.rows().H(), of_patch) - expected).norm(),
                  1e-9 * expected.norm());
      }
}

TEST(PatchOperator, VerticesThatAreUnknownForFewerAreActiveAmongTheOthers) {
  for (const OperatorScene& scene : operator_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const CutPatch cut = scene.cut(), small = scene.cut_fewer();
    const auto active = cut.active_among(scene.fewer);
    ASSERT_TRUE(active.has_value());
    EXPECT_EQ(*active, small.active);
    EXPECT_EQ(cut.active_among(scene.mask), cut.active);
    for (Index v = 0; v < scene.mesh.size(); ++v) {
      if (cut.active[v] || !cut.in_faces[v]) continue;
      ConstraintMask more = scene.fewer;
      (v % 2 ? more.position : more.transform)[v] = 0;
      EXPECT_FALSE(cut.active_among(more).has_value()) << v;
    }
  }
}

TEST(PatchOperator, OnlyTheRimOfAFeatureIsActive) {
  for (OperatorScene scene : operator_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    for (Index v = 0; v < scene.mesh.size(); ++v)
      if (!scene.fewer.position[v]) scene.mask.feature[v] = 0;
    const CutPatch cut = scene.cut();
    for (Index v = 0; v < scene.mesh.size(); ++v) {
      const auto ring = scene.rings[v];
      const bool inner = scene.mask.feature[v] >= 0 && std::all_of(ring.begin(), ring.end(), [&](Index w) {
                           return scene.mask.feature[w] == scene.mask.feature[v];
                         });
      EXPECT_EQ(cut.active[v] != 0, !inner && cut.in_faces[v] && scene.mask.is_unknown(v)) << v;
    }
    EXPECT_EQ(cut.active_among(scene.mask), cut.active);
  }
}

TEST(PatchOperator, VerticesWithoutFacesAreKnownInThePatch) {
  const OperatorScene scene(test::with_isolated_vertices(test::irregular_grid(12, 8)));
  const ConstraintMask none(scene.mesh.size(), false);
  const CutPatch cut(scene.rest, none, 1, {});
  const ConstraintMask of_patch = cut.patch_mask(none);
  ASSERT_EQ(of_patch.size(), cut.patch.size());
  for (Index v = 0; v < cut.patch.size(); ++v)
    EXPECT_EQ(of_patch.is_unknown(v), cut.in_faces[cut.patch.vertices[v]] != 0);
}

TEST(PatchOperator, ThePartAroundFewerIsThePatchCutForThem) {
  int parts = 0;
  for (const OperatorScene& scene : operator_scenes())
    for (const int order : {1, 2}) {
      SCOPED_TRACE(scene.mesh.name);
      const CutPatch cut = scene.cut(order), small = scene.cut_fewer(order);
      const IndexLists rings = vertex_rings(cut.patch.size(), cut.patch.triangles);
      EXPECT_FALSE(part_around(cut, cut.active, rings, {}).has_value());
      const auto part = part_around(cut, small.active, rings, {});
      EXPECT_EQ(part.has_value(), small.patch.size() < cut.patch.size());
      if (!part) continue;
      ++parts;
      EXPECT_EQ(part->size, small.patch.size());
      ASSERT_EQ(part->triangles.rows(), small.patch.triangles.rows());
      for (Eigen::Index t = 0; t < part->triangles.rows(); ++t)
        for (int corner = 0; corner < 3; ++corner)
          EXPECT_EQ(cut.patch.vertices[part->triangles(t, corner)],
                    small.patch.vertices[small.patch.triangles(t, corner)]);
      const IndexLists of_small = vertex_rings(small.patch.size(), small.patch.triangles);
      for (Index v = 0; v < cut.patch.size(); ++v) {
        const Index local = small.patch.local(cut.patch.vertices[v]);
        std::vector<Index> ring, expected;
        for (const Index w : part->rings[v]) ring.push_back(cut.patch.vertices[w]);
        if (local >= 0)
          for (const Index w : of_small[local]) expected.push_back(small.patch.vertices[w]);
        EXPECT_EQ(ring, expected);
      }
    }
  EXPECT_GT(parts, 20);
}

TEST(PatchOperator, ServesFewerUnknownsAndNoMore) {
  for (const OperatorScene& scene : operator_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const CutPatch cut = scene.cut();
    const ConstraintMask mask = operator_mask(cut, scene.mask);
    const PatchOperator rows(cut, mask, {}, {});
    EXPECT_TRUE(rows.serves(mask));
    ASSERT_TRUE(rows.rows().nodes().without_normal.empty());
    for (Index v = 0; v < mask.size(); ++v) {
      ConstraintMask other = mask;
      other.position[v] = other.transform[v] = 1;
      EXPECT_TRUE(rows.serves(other));
      other = mask;
      other.transform[v] = 0;
      EXPECT_EQ(rows.serves(other), !mask.transform[v]);
      other = mask;
      other.position[v] = 0;
      EXPECT_EQ(rows.serves(other), mask.is_unknown(v));
    }
  }
}

TEST(PatchOperator, VerticesMovedOffTheirPlaneHaveToStayMovable) {
  int flat = 0, curved = 0;
  for (const OperatorScene& scene : operator_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const CutPatch cut = scene.cut();
    const ConstraintMask mask = operator_mask(cut, scene.mask);
    const PatchOperator rows(cut, mask, {.degenerate = DegenerateTreatment::ft05_noise}, {});
    for (Index v = 0; v < mask.size(); ++v) {
      if (!mask.is_movable(v)) continue;
      const bool is_flat = rows.rows().nodes().flat[v] != 0;
      for (const bool position : {true, false}) {
        ConstraintMask other = mask;
        (position ? other.position : other.transform)[v] = 1;
        EXPECT_EQ(rows.serves(other), !is_flat);
      }
      ++(is_flat ? flat : curved);
    }
  }
  EXPECT_GT(flat, 50);
  EXPECT_GT(curved, 50);
}

TEST(PatchOperator, MapsWithoutANormalHaveToStayUnknown) {
  // The faces of a sheet and of its reversed copy cancel in every normal, without rounding at such coordinates.
  test::TestMesh sheet = test::grid(6, 5);
  sheet.positions = (64 * sheet.positions).array().round();
  const Eigen::Index faces = sheet.triangles.rows();
  sheet.triangles.conservativeResize(2 * faces, 3);
  for (Eigen::Index t = 0; t < faces; ++t)
    sheet.triangles.row(faces + t) << sheet.triangles(t, 1), sheet.triangles(t, 0), sheet.triangles(t, 2);
  const OperatorScene scene(sheet, 2);
  const CutPatch cut = scene.cut();
  const ConstraintMask mask = operator_mask(cut, scene.mask);
  const PatchOperator rows(cut, mask, {}, {});
  ASSERT_FALSE(rows.rows().nodes().without_normal.empty());
  EXPECT_TRUE(rows.serves(mask));
  for (const Index v : rows.rows().nodes().without_normal) {
    ConstraintMask other = mask;
    other.position[v] = 1;
    EXPECT_TRUE(rows.serves(other));
    other.transform[v] = 1;
    EXPECT_FALSE(rows.serves(other));
  }
}

TEST(PatchOperator, FewerMapsAreThoseOfAnOperatorMadeForThem) {
  int compared = 0;
  for (const OperatorScene& scene : operator_scenes())
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
      SCOPED_TRACE(scene.mesh.name);
      const OperatorOptions options{.degenerate = treatment};
      const CutPatch cut = scene.cut();
      const ConstraintMask mask = operator_mask(cut, scene.mask), fewer = operator_mask(cut, scene.fewer);
      const PatchOperator rows(cut, mask, options, {});
      EXPECT_FALSE(rows.fewer_maps(mask, {}).has_value());
      const auto maps = rows.fewer_maps(fewer, {});
      EXPECT_EQ(maps.has_value(), fewer.transform != mask.transform);
      if (!maps || !rows.serves(fewer)) continue;
      ++compared;
      const PatchOperator fresh(cut, fewer, options, {});
      for (Eigen::Index row = 0; row < maps->rows(); ++row) {
        const Eigen::RowVectorXd expected = map_row(fresh.rows(), fresh.rows().H(), row);
        EXPECT_LE((map_row(rows.rows(), *maps, row) - expected).norm(), 1e-12 * expected.norm());
      }
    }
  EXPECT_GT(compared, 20);
}

TEST(PatchOperator, RowsOfAPartAreMultiplesOfThoseOfThePatch) {
  int served = 0;
  for (const OperatorScene& scene : operator_scenes())
    for (const OperatorOptions& options : test::operator_variants({DegenerateTreatment::apex})) {
      SCOPED_TRACE(scene.mesh.name + ", " + test::describe(options));
      const CutPatch cut = scene.cut(), small = scene.cut_fewer();
      const ConstraintMask mask = operator_mask(cut, scene.mask);
      const PatchOperator rows(cut, mask, options, {});
      const auto part = part_around(cut, small.active, rows.rows().rings(), {});
      if (!part || !rows.serves(*part, cut.patch)) continue;
      const ConstraintMask of_part = operator_mask(small, scene.fewer);
      ConstraintMask fewer = cut.patch_mask(scene.fewer);
      fix_unconstrained_components(part->rings, fewer);
      if (!rows.serves(fewer)) continue;
      ++served;
      const PatchOperator alone(small, of_part, options, {});
      const auto maps = rows.fewer_maps(fewer, {});
      const Eigen::MatrixXd shared = normal_of(rows.rows(), maps ? *maps : rows.rows().H(), fewer);
      double factor = 1;
      if (options.density == Density::aware)
        factor = std::pow(small.patch.scale * alone.rows().mean_edge_length() /
                              (cut.patch.scale * rows.rows().mean_edge_length()),
                          2);
      const Eigen::MatrixXd expected = normal_of(alone.rows(), alone.rows().H(), of_part);
      ASSERT_EQ(shared.rows(), expected.rows());
      EXPECT_LE((factor * shared - expected).norm(), 1e-9 * expected.norm());
    }
  EXPECT_GT(served, 20);
}

TEST(PatchOperator, DoesNotServeAPartWhoseRowsAreBoundedOtherwise) {
  // One vertex far away makes the mean edge of the patch a thousand times that of the part.
  test::TestMesh mesh = test::irregular_grid(22, 16);
  const OperatorScene plain(mesh);
  const CutPatch near = plain.cut();
  const CutPatch part_of_it = plain.cut_fewer();
  for (const Index v : near.patch.vertices)
    if (part_of_it.patch.local(v) < 0) {
      mesh.positions.row(v) *= 1e7;
      break;
    }
  for (const bool far : {false, true}) {
    const OperatorScene scene = far ? OperatorScene(mesh) : plain;
    const CutPatch cut = scene.cut();
    for (const Density density : {Density::ft05, Density::aware}) {
      const PatchOperator rows(cut, operator_mask(cut, scene.mask), {.density = density}, {});
      const auto part = part_around(cut, scene.cut_fewer().active, rows.rows().rings(), {});
      ASSERT_TRUE(part.has_value());
      EXPECT_EQ(rows.serves(*part, cut.patch), !far || density == Density::ft05);
    }
  }
}

}  // namespace
}  // namespace meshgraft
