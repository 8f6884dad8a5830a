// The preset `as-published` is Fu and Tai's paper as written, and stays so. A reference that is made of the
// paper's equations alone agrees with it: with its own umbrella, maps, pairs and noise.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"
#include "support/oracle.h"
#include "support/pin.h"

namespace meshgraft::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A motion with nine degrees of freedom, as the paper states it: turn, scales along the axes, shift.
struct Motion {
  Vector3d shift, axis, scale;
  double angle_deg;

  HandlePose pose(const Vector3d& pivot) const {
    return make_pose({.translate = shift, .axis = axis, .angle_deg = angle_deg, .scale = scale, .pivot = pivot},
                     pivot);
  }
  Matrix3d linear() const {
    const Vector3d n = axis.normalized();
    const double angle = angle_deg * std::numbers::pi / 180;
    Matrix3d cross;
    cross << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
    const Matrix3d turn =
        Matrix3d::Identity() + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
    return turn * scale.asDiagonal();
  }
};

/// Glues a triangle to every third boundary edge of a mesh. The new vertices have two neighbours.
TestMesh with_tabs(TestMesh mesh) {
  std::map<std::pair<Index, Index>, int> faces;
  std::vector<std::pair<Index, Index>> open;
  for (const auto& t : mesh.triangles.rowwise())
    for (int c = 0; c < 3; ++c) ++faces[std::minmax(t[c], t[(c + 1) % 3])];
  for (const auto& t : mesh.triangles.rowwise())
    for (int c = 0; c < 3; ++c)
      if (faces[std::minmax(t[c], t[(c + 1) % 3])] == 1) open.emplace_back(t[c], t[(c + 1) % 3]);
  std::set<Index> used;
  for (std::size_t k = 0; k < open.size(); k += 3) {
    const auto [a, b] = open[k];
    if (used.contains(a) || used.contains(b)) continue;
    used.insert({a, b});
    const Index tip = mesh.size();
    const Eigen::RowVector3d along = mesh.positions.row(b) - mesh.positions.row(a);
    const Eigen::RowVector3d out = Eigen::RowVector3d(0.3, -0.2, 1).cross(along);
    mesh.positions.conservativeResize(tip + 1, 3);
    mesh.positions.row(tip) = (mesh.positions.row(a) + mesh.positions.row(b)) / 2 + 0.7 * out;
    mesh.triangles.conservativeResize(mesh.triangles.rows() + 1, 3);
    mesh.triangles.bottomRows(1) << b, a, tip;
  }
  mesh.name += " with tabs";
  return mesh;
}

/// Returns a bumpy sphere without the part beyond x = 0.5.
TestMesh open_bumpy_sphere() {
  const TestMesh whole = bumpy_sphere(2);
  TestMesh part{.name = "part of a bumpy sphere", .positions = {}, .triangles = {}};
  std::map<Index, Index> number;
  std::vector<std::array<Index, 3>> kept;
  for (const auto& t : whole.triangles.rowwise()) {
    if (whole.positions(t[0], 0) + whole.positions(t[1], 0) + whole.positions(t[2], 0) > 1.5) continue;
    auto& face = kept.emplace_back();
    for (int c = 0; c < 3; ++c)
      face[c] = number.try_emplace(t[c], static_cast<Index>(number.size())).first->second;
  }
  part.positions.resize(static_cast<Eigen::Index>(number.size()), 3);
  for (const auto& [old, now] : number) part.positions.row(now) = whole.positions.row(old);
  part.triangles.resize(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t t = 0; t < kept.size(); ++t)
    part.triangles.row(static_cast<Eigen::Index>(t)) << kept[t][0], kept[t][1], kept[t][2];
  return part;
}

std::vector<TestMesh> meshes() {
  return {irregular_grid(13, 9),  open_bumpy_sphere(),          tube(9, 14), flat_sheet(12, 9), bar(3, 9),
          with_tabs(grid(14, 7)), with_tabs(flat_sheet(11, 8)), grid(10, 10)};
}

/// A mesh with a fixed foot and two handles that move differently.
struct Edit {
  TestMesh mesh;
  Region region;
  std::vector<Motion> motions;
  std::vector<Vector3d> pivots;

  explicit Edit(TestMesh given) : mesh(std::move(given)) {
    const Scene scene = make_scene(mesh, 0.15, 0.08);
    region.whole = true;
    region.fixed = scene.foot;
    const Points& p = mesh.positions;
    const Eigen::RowVector3d middle = p.colwise().mean();
    Index nearest = -1;
    const auto is_taken = [&](Index v) {
      return std::count(scene.foot.begin(), scene.foot.end(), v) +
                 std::count(scene.head.begin(), scene.head.end(), v) >
             0;
    };
    for (Index v = 0; v < mesh.size(); ++v)
      if (!is_taken(v) && (nearest < 0 || (p.row(v) - middle).norm() < (p.row(nearest) - middle).norm()))
        nearest = v;
    std::set<Index> around{nearest};
    for (const auto& t : mesh.triangles.rowwise())
      if ((t.array() == nearest).any())
        for (const Index v : t)
          if (!is_taken(v)) around.insert(v);
    region.handles = {{.name = "head", .vertices = scene.head},
                      {.name = "middle", .vertices = {around.begin(), around.end()}}};
    const double size = mesh.box_diagonal();
    motions = {{size * Vector3d(0.05, 0.1, 0.15), {1, -2, 0.5}, {1.3, 0.8, 1.1}, 50},
               {size * Vector3d(-0.1, 0.04, 0.12), {0.3, 1, 1}, {0.9, 1.2, 0.7}, -35}};
    for (const Handle& handle : region.handles)
      pivots.emplace_back(p.row(handle.vertices.front()).transpose() + size * Vector3d(0.01, 0.02, -0.03));
  }

  std::vector<HandlePose> poses() const { return {motions[0].pose(pivots[0]), motions[1].pose(pivots[1])}; }

  /// Returns u = c + t + R S (p − c) and W = R S at handles, u = p and W = I at fixed vertices.
  std::vector<VertexConstraint> constraints() const {
    std::vector<VertexConstraint> all;
    for (const Index v : region.fixed)
      all.push_back({v, Vector3d(mesh.positions.row(v)), Matrix3d::Identity()});
    for (std::size_t h = 0; h < motions.size(); ++h)
      for (const Index v : region.handles[h].vertices) {
        const Vector3d p = mesh.positions.row(v), &c = pivots[h];
        all.push_back({v, Vector3d(c + motions[h].shift + motions[h].linear() * (p - c)), motions[h].linear()});
      }
    return all;
  }

  Points solved(const DeformerOptions& options) const {
    return Deformer(mesh.positions, mesh.triangles, region, options).evaluate(poses());
  }
};

TEST(AsPublished, AgreesWithThePapersEquations) {
  double worst = 0;
  std::size_t moved = 0, widened = 0;
  for (const TestMesh& mesh : meshes())
    for (const std::uint64_t seed : {1U, 77U}) {
      SCOPED_TRACE(mesh.name);
      const Edit edit(mesh);
      DeformerOptions options = DeformerOptions::as_published();
      options.operators.seed = seed;
      const Oracle oracle({.rest = mesh.positions,
                           .moved = {},
                           .noise_seed = seed,
                           .triangles = mesh.triangles,
                           .constraints = edit.constraints()});
      const Points expected = oracle.moved_back(oracle.dense_minimum());
      const double difference =
          (edit.solved(options) - expected).rowwise().norm().maxCoeff() / mesh.box_diagonal();
      EXPECT_LT(difference, 1e-10);
      worst = std::max(worst, difference);
      moved += static_cast<std::size_t>((oracle.moved() - mesh.positions).rowwise().any().count());
      widened += oracle.widened().size();
    }
  // The meshes have flat vertices, and free ones with two neighbours.
  EXPECT_GT(moved, 100U);
  EXPECT_GT(widened, 10U);
  RecordProperty("worst_difference_of_box", std::to_string(worst * 1e12) + "e-12");
}

TEST(AsPublished, DiffersFromTheDefault) {
  const Edit edit(flat_sheet(12, 9));
  const Points published = edit.solved(DeformerOptions::as_published());
  EXPECT_GT((published - edit.solved({})).rowwise().norm().maxCoeff(), 1e-2 * edit.mesh.box_diagonal());
  DeformerOptions other = DeformerOptions::as_published();
  other.operators.seed = 2;
  EXPECT_GT((published - edit.solved(other)).rowwise().norm().maxCoeff(), 1e-5 * edit.mesh.box_diagonal());
}

TEST(AsPublished, HasLengthsOfTwoToThreeTenthsToOneSide) {
  const TestMesh sheet = flat_sheet(20, 20);
  const AffineOperator rows(sheet.positions, sheet.triangles, OperatorOptions::as_published());
  double shortest = 1, longest = 0;
  for (const Index v : rows.nodes().moved) {
    const double length = rows.nodes().positions(v, 2) / rows.edge_lengths()[v];
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
  }
  EXPECT_EQ(rows.nodes().moved.size(), static_cast<std::size_t>(sheet.size()));
  EXPECT_GE(shortest, 0.2);
  EXPECT_LT(shortest, 0.205);
  EXPECT_LT(longest, 0.3);
  EXPECT_GT(longest, 0.295);
}

/// Results that must never change, in the order of `meshes`.
const std::vector<Pin> pins = {
    {{0.910597334869, 0.762692081342, 0.203890768829}, {1.14131770451, 1.05739197375, 0.292847392592}},
    {{-0.197231515184, 0.229945648725, 0.290882464895}, {0.623121205074, 0.593824581631, 1.13562570151}},
    {{-0.124125326034, 0.155394405321, 2.30750285988}, {0.332979436759, 0.344141011501, 3.33800556319}},
    {{0.894416231931, 0.808553790914, 0.23513986433}, {1.09339453092, 1.11604850561, 0.322311556551}},
    {{0.475457730011, 0.684717524865, 1.92573211281}, {0.713359869779, 0.854725404143, 2.91216924832}},
    {{0.935210966156, 0.550544952348, 0.207904116684}, {1.16174943048, 0.736352308948, 0.293818412354}},
    {{0.870650209238, 0.764094327036, 0.260617212907}, {1.08137833559, 1.03590161046, 0.345245244884}},
    {{0.902395199382, 1.02918648786, 0.240476764363}, {1.08861652882, 1.43616813516, 0.367349883506}},
};

TEST(AsPublished, NeverChanges) {
  const std::vector<TestMesh> all = meshes();
  ASSERT_EQ(pins.size(), all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(all[k].name);
    expect_pin(Edit(all[k]).solved(DeformerOptions::as_published()), pins[k]);
  }
}

// The paper does not say how a redrawn curve turns about its tangents. The preset's way does not change either.
TEST(AsPublished, NeverChangesForARedrawnCurve) {
  const TestMesh mesh = grid(12, 10);
  Region region{.whole = true};
  for (Index v = 0; v < 26; ++v) region.fixed.push_back(v);
  Handle curve{.name = "curve", .shape = HandleShape::curve};
  for (Index v = 7 * 13; v < 8 * 13; ++v) curve.vertices.push_back(v);
  region.handles = {curve};
  Points course(13, 3);
  for (Index k = 0; k < 13; ++k)
    course.row(k) << 0.16 * k, 1.1 + 0.3 * std::sin(0.5 * k), 0.5 + 0.2 * std::cos(0.4 * k);
  const Deformer deformer(mesh.positions, mesh.triangles, region, DeformerOptions::as_published());
  expect_pin(deformer.evaluate(std::vector<HandlePose>{{.curve = course}}),
             {{0.976732374611, 0.80052581883, 0.287751151615}, {1.18350333594, 1.17054332162, 0.466307037296}});
}

}  // namespace
}  // namespace meshgraft::test
