#include "deform/setup/region_mask.h"

#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "deform/setup/checks.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

Handle handle_of(std::string name, std::vector<Index> vertices, bool position = true, bool transform = true) {
  Handle handle;
  handle.name = std::move(name);
  handle.vertices = std::move(vertices);
  handle.constrain_position = position;
  handle.constrain_transform = transform;
  return handle;
}

VertexConstraint constraint_at(Index vertex) {
  VertexConstraint constraint;
  constraint.vertex = vertex;
  constraint.position = Eigen::RowVector3d::Zero();
  return constraint;
}

void expect_refused(const std::function<void()>& call, const std::string& id, const std::string& location) {
  try {
    call();
    ADD_FAILURE() << id << " was not thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), id);
    EXPECT_EQ(error.location().text(), location) << id;
  }
}

TEST(RegionMask, KnowsWhatLiesOutsideTheRegionOrIsFixed) {
  std::mt19937 random(5);
  constexpr Index count = 40;
  for (int trial = 0; trial < 20; ++trial) {
    Region region;
    region.whole = trial % 3 == 0;
    std::vector<int> state(count, region.whole ? 1 : 0);  // 1 inside, 2 fixed
    for (Index v = 0; v < count; ++v) {
      const unsigned draw = random() % 4;
      if (draw == 1) region.vertices.push_back(v), state[v] = 1;
      if (draw == 2) region.fixed.push_back(v), state[v] = 2;
    }
    const ConstraintMask mask = mask_of_region(count, region);
    for (Index v = 0; v < count; ++v) {
      EXPECT_EQ(mask.is_unknown(v), state[v] == 1) << v;
      EXPECT_EQ(mask.position[v], mask.transform[v]) << v;
      EXPECT_EQ(mask.feature[v], -1);
      EXPECT_EQ(mask.anchored[v], 0);
    }
  }
}

TEST(RegionMask, MarksWhatHandlesGiveAndKeepsTheirOrder) {
  Region region;
  region.whole = true;
  region.handles = {handle_of("both", {7, 3}), handle_of("place", {9}, true, false),
                    handle_of("turn", {1}, false, true)};
  region.features = {{.vertices = {4, 5}}, {.vertices = {2}}};
  region.anchors = {{.vertex = 4}, {.vertex = 0}};
  ConstraintList constrained;
  const ConstraintMask mask = make_mask(12, region, {}, constrained);
  EXPECT_EQ(constrained.vertex, (std::vector<Index>{7, 3, 9, 1}));
  EXPECT_EQ(constrained.gives_position, (Flags{1, 1, 1, 0}));
  EXPECT_EQ(constrained.gives_transform, (Flags{1, 1, 0, 1}));
  for (Index v = 0; v < 12; ++v) {
    EXPECT_EQ(mask.position[v] != 0, v == 7 || v == 3 || v == 9) << v;
    EXPECT_EQ(mask.transform[v] != 0, v == 7 || v == 3 || v == 1) << v;
    EXPECT_EQ(mask.feature[v], v == 4 || v == 5 ? 0 : v == 2 ? 1 : -1) << v;
    EXPECT_EQ(mask.anchored[v] != 0, v == 4 || v == 0) << v;
  }
}

TEST(RegionMask, OfConstraintsIsThatOfHandlesWithTheSameVertices) {
  Region with_handles;
  with_handles.vertices = {1, 2, 3, 4, 5};
  Region bare = with_handles;
  with_handles.handles = {handle_of("a", {4}, true, false), handle_of("b", {2, 8}, true, false)};
  const std::vector<VertexConstraint> constraints = {constraint_at(4), constraint_at(2), constraint_at(8)};
  ConstraintList of_handles, of_constraints;
  const ConstraintMask a = make_mask(10, with_handles, {}, of_handles);
  const ConstraintMask b = make_mask(10, bare, constraints, of_constraints);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.transform, b.transform);
  EXPECT_EQ(of_handles.vertex, of_constraints.vertex);
  EXPECT_NO_THROW(of_handles.require_matching(constraints));
}

TEST(RegionMask, NamesWhatIsWrongAndWhere) {
  struct Case {
    const char *id, *location;
    std::function<void(Region&, std::vector<VertexConstraint>&)> spoil;
  };
  const Case cases[] = {
      {"core.no_such_vertex", "region", [](Region& r, auto&) { r.vertices.push_back(10); }},
      {"core.no_such_vertex", "fixed", [](Region& r, auto&) { r.fixed.push_back(-1); }},
      {"core.no_such_vertex", "handle 'a'", [](Region& r, auto&) { r.handles = {handle_of("a", {10})}; }},
      {"core.no_such_vertex", "features[0]", [](Region& r, auto&) { r.features = {{.vertices = {10}}}; }},
      {"core.no_such_vertex", "anchors[0]", [](Region& r, auto&) { r.anchors = {{.vertex = 10}}; }},
      {"core.no_such_vertex", "constraints[0]", [](Region&, auto& c) { c = {constraint_at(10)}; }},
      {"deform.no_vertices", "handle 'a'", [](Region& r, auto&) { r.handles = {handle_of("a", {})}; }},
      {"deform.no_vertices", "features[1]", [](Region& r, auto&) { r.features = {{.vertices = {1}}, {}}; }},
      {"deform.handle_constrains_nothing", "handle 'a'",
       [](Region& r, auto&) { r.handles = {handle_of("a", {1}, false, false)}; }},
      {"deform.vertex_named_twice", "handle 'a'",
       [](Region& r, auto&) { r.handles = {handle_of("a", {1, 1})}; }},
      {"deform.vertex_also_fixed", "handle 'a'",
       [](Region& r, auto&) {
         r.fixed = {1};
         r.handles = {handle_of("a", {1})};
       }},
      {"deform.vertex_of_two_handles", "handle 'b'",
       [](Region& r, auto&) { r.handles = {handle_of("a", {1}), handle_of("b", {1})}; }},
      {"deform.vertex_named_twice", "constraints[1]",
       [](Region&, auto& c) { c = {constraint_at(1), constraint_at(1)}; }},
      {"deform.vertex_constrains_nothing", "constraints[0]",
       [](Region&, auto& c) {
         c = {constraint_at(1)};
         c[0].position.reset();
       }},
      {"deform.vertex_in_two_features", "features[1]",
       [](Region& r, auto&) { r.features = {{.vertices = {1}}, {.vertices = {1}}}; }},
      {"deform.feature_vertex_held", "features[0]",
       [](Region& r, auto&) {
         r.handles = {handle_of("a", {1})};
         r.features = {{.vertices = {1}}};
       }},
      {"core.not_positive", "features[0].scale",
       [](Region& r, auto&) { r.features = {{.vertices = {1}, .scale = 0.0}}; }},
      {"core.not_positive", "anchors[0].weight",
       [](Region& r, auto&) { r.anchors = {{.vertex = 1, .weight = -1}}; }},
      {"core.not_finite", "anchors[0]",
       [](Region& r, auto&) {
         r.anchors = {{.vertex = 1, .target = Eigen::RowVector3d::Constant(not_a_number)}};
       }},
      {"deform.handles_and_constraints", "",
       [](Region& r, auto& c) {
         r.handles = {handle_of("a", {1})};
         c = {constraint_at(2)};
       }},
  };
  for (const Case& one : cases) {
    Region region;
    region.whole = true;
    std::vector<VertexConstraint> constraints;
    one.spoil(region, constraints);
    ConstraintList constrained;
    expect_refused([&] { make_mask(10, region, constraints, constrained); }, one.id, one.location);
  }
}

TEST(RegionMask, RefusesTrianglesOfMissingVertices) {
  for (const test::TestMesh& mesh : test::small_families()) {
    EXPECT_NO_THROW(require_triangles(mesh.positions, mesh.triangles)) << mesh.name;
    for (const Index wrong : {Index{-1}, mesh.size()}) {
      Triangles triangles = mesh.triangles;
      triangles(triangles.rows() - 1, 1) = wrong;
      expect_refused([&] { require_triangles(mesh.positions, triangles); }, "core.no_such_vertex",
                     "triangle " + std::to_string(triangles.rows() - 1));
    }
  }
}

TEST(RegionMask, RefusesValuesThatCannotBeUsed) {
  expect_refused([] { validate({.stiffness = -1}); }, "core.out_of_range", "stiffness");
  expect_refused([] { validate({.stiffness = not_a_number}); }, "core.out_of_range", "stiffness");
  expect_refused([] { validate({.iterations = 1001}); }, "core.out_of_range", "iterations");
  expect_refused([] { validate({.smoothing_length_rel = 11}); }, "core.out_of_range", "smoothing_length_rel");
  EXPECT_NO_THROW(validate(DeformerOptions{}));

  ConstraintList list;
  list.vertex = {4};
  list.gives_position = {1};
  list.gives_transform = {0};
  VertexConstraint good = constraint_at(4);
  EXPECT_NO_THROW(list.require_matching({{good}}));
  VertexConstraint other = constraint_at(5), turned = good, large = good;
  turned.transform = Eigen::Matrix3d::Identity();
  large.position = Eigen::RowVector3d(1e101, 0, 0);
  expect_refused([&] { list.require_matching({}); }, "core.size_mismatch", "");
  expect_refused([&] { list.require_matching({{other}}); }, "deform.constraint_differs", "");
  expect_refused([&] { list.require_matching({{turned}}); }, "deform.constraint_differs", "");
  expect_refused([&] { list.require_matching({{large}}); }, "deform.too_large_or_not_finite",
                 "the constraint of vertex 4");
}

}  // namespace
}  // namespace meshgraft
