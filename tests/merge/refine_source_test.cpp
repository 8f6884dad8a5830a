#include "merge/refine_source.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "merge/graft.h"
#include "merge/grafts.h"
#include "mesh/shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// A source whose faces are triangles or flat polygons, with the size of a target loop for each of its loops.
struct RefineCase {
  std::string name;
  Mesh mesh;
  std::vector<LoopPair> pairs;
};

std::vector<RefineCase> refine_cases() {
  std::vector<RefineCase> cases;
  const auto add = [&](const std::string& name, const Mesh& mesh, const std::vector<Index>& target_sizes) {
    RefineCase result{name, mesh, {}};
    for (const std::vector<Index>& loop : boundary_loops(mesh)) {
      if (result.pairs.size() == target_sizes.size()) break;
      LoopPair pair{loop, {}};
      for (Index k = 0; k < target_sizes[result.pairs.size()]; ++k) pair.target.push_back(k);
      result.pairs.push_back(pair);
    }
    cases.push_back(result);
  };
  for (const Index rows : {2, 4})
    for (const Index around : {6, 16})
      for (const Index target : {4, 32, 100})
        add("peg of " + std::to_string(rows) + " rows, " + std::to_string(around) + " around on " +
                std::to_string(target),
            test::peg(rows, around), {target});
  add("tube of quads", shapes::tube(8, 2), {40, 7});
  add("tube of triangles", shapes::tube(14, 3, true), {20, 200});
  for (const test::TestMesh& family : {test::tube(12, 20), test::irregular_grid(14, 9), test::grid(12, 12)})
    add(family.name, make_mesh(family.positions, family.triangles), {60});
  return cases;
}

constexpr double most_edges_per_edge = 2;  // the default of SeamOptions::edge_ratio

RefinedSource refined(const RefineCase& given, double edge_ratio = most_edges_per_edge) {
  return refine_source(given.mesh, given.pairs, {.edge_ratio = edge_ratio}, {});
}

double area_of(const Mesh& mesh) {
  double area = 0;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    const auto face = mesh.faces[f];
    const Eigen::RowVector3d first = mesh.positions.row(face[0]);
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      sum += (mesh.positions.row(face[k]) - first).cross(mesh.positions.row(face[k + 1]) - first);
    area += sum.norm() / 2;
  }
  return area;
}

/// Returns the distance of a point from a flat convex face.
double face_distance(const Mesh& mesh, Index f, const Eigen::RowVector3d& point) {
  const auto face = mesh.faces[f];
  Eigen::RowVector3d normal = Eigen::RowVector3d::Zero();
  for (std::size_t k = 0; k < face.size(); ++k)
    normal += mesh.positions.row(face[k]).cross(mesh.positions.row(face[(k + 1) % face.size()]));
  normal.normalize();
  double outside = std::abs((point - mesh.positions.row(face[0])).dot(normal));
  for (std::size_t k = 0; k < face.size(); ++k) {
    const Eigen::RowVector3d from = mesh.positions.row(face[k]),
                             along = mesh.positions.row(face[(k + 1) % face.size()]) - from;
    outside = std::max(outside, (point - from).dot(along.cross(normal).normalized()));
  }
  return outside;
}

TEST(RefineSource, KeepsItsVerticesAndPutsNewOnesBehindThem) {
  Index most_added = 0;
  for (const RefineCase& given : refine_cases()) {
    const RefinedSource source = refined(given);
    const Index count = given.mesh.vertex_count();
    EXPECT_EQ(source.mesh.positions.topRows(count), given.mesh.positions) << given.name;
    EXPECT_EQ(source.added, source.mesh.vertex_count() - count) << given.name;
    most_added = std::max(most_added, source.added);
  }
  EXPECT_GT(most_added, 100);
}

TEST(RefineSource, LoopsKeepTheirVerticesInOrder) {
  for (const RefineCase& given : refine_cases()) {
    const RefinedSource source = refined(given);
    ASSERT_EQ(source.pairs.size(), given.pairs.size());
    std::vector<std::vector<Index>> loops = boundary_loops(source.mesh);
    for (std::size_t p = 0; p < given.pairs.size(); ++p) {
      EXPECT_EQ(source.pairs[p].target, given.pairs[p].target);
      std::vector<Index> old = source.pairs[p].source;
      std::erase_if(old, [&](Index v) { return v >= given.mesh.vertex_count(); });
      EXPECT_EQ(old, given.pairs[p].source) << given.name;
      // The listed loop is a whole boundary loop.
      std::vector<Index> listed = source.pairs[p].source;
      std::ranges::rotate(listed, std::ranges::min_element(listed));
      EXPECT_NE(std::ranges::find(loops, listed), loops.end()) << given.name;
    }
  }
}

TEST(RefineSource, KeepsTheTopology) {
  for (const RefineCase& given : refine_cases()) {
    const TopologySummary before = summarise_topology(given.mesh),
                          after = summarise_topology(refined(given).mesh);
    EXPECT_EQ(after.euler_characteristic, before.euler_characteristic) << given.name;
    EXPECT_EQ(after.boundary_loops, before.boundary_loops) << given.name;
    EXPECT_EQ(after.components, before.components) << given.name;
    EXPECT_EQ(after.genus, before.genus) << given.name;
    EXPECT_TRUE(after.manifold && after.oriented) << given.name;
  }
}

TEST(RefineSource, KeepsTheShapeOfTheSurface) {
  for (const RefineCase& given : refine_cases()) {
    const Mesh mesh = refined(given, 8).mesh;
    EXPECT_NEAR(area_of(mesh), area_of(given.mesh), 1e-10 * area_of(given.mesh)) << given.name;
    for (Index v = given.mesh.vertex_count(); v < mesh.vertex_count(); ++v) {
      double least = 1;
      for (Index f = 0; f < given.mesh.face_count() && least > 1e-12; ++f)
        least = std::min(least, face_distance(given.mesh, f, mesh.positions.row(v)));
      ASSERT_LT(least, 1e-12) << given.name;
    }
  }
}

TEST(RefineSource, LoopsAreFineEnoughForTheirTargets) {
  for (const RefineCase& given : refine_cases())
    for (const double ratio : {1.0, 2.0, 3.5}) {
      const RefinedSource source = refined(given, ratio);
      for (const LoopPair& pair : source.pairs)
        EXPECT_LE(static_cast<double>(pair.target.size()), ratio * static_cast<double>(pair.source.size()))
            << given.name;
    }
}

TEST(RefineSource, AHigherRatioNeedsNoFinerLoops) {
  for (const RefineCase& given : refine_cases()) {
    std::vector<LoopPair> last = refined(given, 1).pairs;
    for (const double ratio : {1.5, 2.0, 4.0, 100.0}) {
      const std::vector<LoopPair> pairs = refined(given, ratio).pairs;
      for (std::size_t p = 0; p < pairs.size(); ++p)
        EXPECT_LE(pairs[p].source.size(), last[p].source.size()) << given.name << ", " << ratio;
      last = pairs;
    }
  }
}

/// Returns whether a loop that keeps its edges has one whose two thirds are longer than edges near it may be.
/// Beside such an edge, halving tends to edges of two thirds of its length, and only the number of passes ends
/// it.
bool keeps_a_long_edge(const RefinedSource& source) {
  const Points& points = source.mesh.positions;
  for (const LoopPair& pair : source.pairs)
    for (std::size_t i = 0; i < pair.source.size(); ++i) {
      const Index v = pair.source[i], w = pair.source[(i + 1) % pair.source.size()];
      if ((points.row(v) - points.row(w)).norm() * 2 / 3 > 0.35 * loop_radius(points, pair.source)) return true;
    }
  return false;
}

TEST(RefineSource, EdgesWithinALoopsRadiusAreShort) {
  int checked = 0;
  for (const RefineCase& given : refine_cases()) {
    const RefinedSource source = refined(given);
    if (keeps_a_long_edge(source)) continue;
    ++checked;
    const Points& points = source.mesh.positions;
    const IndexLists rings = vertex_rings(source.mesh.vertex_count(), source.mesh.faces);
    for (const LoopPair& pair : source.pairs) {
      const double radius = loop_radius(points, pair.source);
      const std::vector<double> distance = edge_distance(pair.source, points, rings);
      const auto is_kept = [&](Index v) {  // on a loop of enough vertices
        return std::ranges::any_of(source.pairs, [&](const LoopPair& other) {
          return other.source.size() >= 12 && std::ranges::count(other.source, v) > 0;
        });
      };
      for (Index v = 0; v < source.mesh.vertex_count(); ++v)
        for (const Index w : rings[v])
          if (distance[v] <= radius && !(is_kept(v) && is_kept(w))) {
            EXPECT_LE((points.row(v) - points.row(w)).norm(), 0.35 * radius) << given.name;
          }
    }
  }
  EXPECT_GE(checked, 12);
}

TEST(RefineSource, EdgesFarFromTheLoopsStayWhole) {
  for (const RefineCase& given : refine_cases()) {
    const RefinedSource source = refined(given, 100);
    const Points& points = given.mesh.positions;
    const IndexLists before = vertex_rings(given.mesh.vertex_count(), given.mesh.faces),
                     after = vertex_rings(source.mesh.vertex_count(), source.mesh.faces);
    const auto is_far = [&](Index v) {
      return std::ranges::all_of(given.pairs, [&](const LoopPair& pair) {
        const double radius = loop_radius(points, pair.source);
        return std::ranges::all_of(source.pairs[&pair - given.pairs.data()].source, [&](Index on_loop) {
          return (source.mesh.positions.row(on_loop) - points.row(v)).norm() > radius;
        });
      });
    };
    for (Index v = 0; v < given.mesh.vertex_count(); ++v)
      for (const Index w : before[v])
        if (is_far(v) && is_far(w)) {
          EXPECT_TRUE(std::ranges::binary_search(after[v], w)) << given.name;
        }
  }
}

TEST(RefineSource, AddsNothingToWhatIsFineEnough) {
  for (const RefineCase& given : refine_cases()) {
    const RefinedSource once = refined(given);
    if (keeps_a_long_edge(once)) continue;
    const RefinedSource twice = refine_source(once.mesh, once.pairs, {.edge_ratio = most_edges_per_edge}, {});
    EXPECT_EQ(twice.added, 0) << given.name;
    EXPECT_EQ(twice.mesh.positions, once.mesh.positions) << given.name;
    EXPECT_EQ(twice.mesh.faces, once.mesh.faces) << given.name;
    for (std::size_t p = 0; p < once.pairs.size(); ++p)
      EXPECT_EQ(twice.pairs[p].source, once.pairs[p].source) << given.name;
  }
}

}  // namespace
}  // namespace meshgraft
