#include "deform/sculpt.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "core/facts.h"
#include "deform/facts.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using Eigen::Vector3d;

std::vector<Index> where(const test::TestMesh& mesh, const auto& is_meant) {
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh.size(); ++v)
    if (is_meant(Vector3d(mesh.positions.row(v)))) vertices.push_back(v);
  return vertices;
}

std::vector<Index> cap(const test::TestMesh& ball) {
  return where(ball, [](const Vector3d& p) { return p.z() > 0.6; });
}

// Moves the vertices of a set at random, the same way in every run.
test::TestMesh noisy(test::TestMesh mesh, const std::vector<Index>& vertices, double size) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-size, size);
  for (const Index v : vertices)
    for (int k = 0; k < 3; ++k) mesh.positions(v, k) += shift(random);
  return mesh;
}

void expect_only_moves(const Points& before, const Points& after, const std::vector<Index>& region) {
  std::vector<bool> is_meant(static_cast<std::size_t>(before.rows()), false);
  for (const Index v : region) is_meant[static_cast<std::size_t>(v)] = true;
  for (Index v = 0; v < before.rows(); ++v)
    if (!is_meant[static_cast<std::size_t>(v)]) {
      EXPECT_EQ(before.row(v), after.row(v)) << v;
    }
}

/// Returns the root mean square of the distances from the unit sphere.
double roughness(const Points& points, const std::vector<Index>& vertices) {
  double sum = 0;
  for (const Index v : vertices) sum += std::pow(points.row(v).norm() - 1, 2);
  return std::sqrt(sum / static_cast<double>(vertices.size()));
}

TEST(Sculpt, SmoothingRemovesNoiseAndKeepsTheShape) {
  const test::TestMesh ball = test::icosphere(4);
  const std::vector<Index> region = cap(ball);
  const test::TestMesh rough = noisy(ball, region, 0.02);
  const double before = roughness(rough.positions, region);
  double last = before;
  for (const double strength : {0.1, 0.2, 0.4}) {
    const Points smooth = smooth_region({rough.positions, rough.triangles, region}, strength);
    expect_only_moves(rough.positions, smooth, region);
    const double now = roughness(smooth, region);
    EXPECT_LT(now, last) << strength;
    last = now;
  }
  EXPECT_LT(last, 0.25 * before);
}

// With full strength the surface around decides. The given shape, 0.12 away, acts on the weights alone.
TEST(Sculpt, FullStrengthForgetsNearlyAllThatWasThere) {
  const test::TestMesh ball = test::icosphere(4);
  const std::vector<Index> region = cap(ball);
  const auto smoothed = [&](double size) {
    test::TestMesh bumped = ball;
    for (const Index v : region) bumped.positions.row(v) *= 1 + size * (ball.positions(v, 2) - 0.6);
    return smooth_region({bumped.positions, bumped.triangles, region}, 1);
  };
  const Points one = smoothed(0), other = smoothed(0.3);
  EXPECT_LT((one - other).rowwise().norm().maxCoeff(), 0.05);
  EXPECT_LT((one - ball.positions).rowwise().norm().maxCoeff(), 0.1) << "the tangents around it lift it";
}

TEST(Sculpt, NoStrengthChangesNothing) {
  const test::TestMesh ball = test::bumpy_sphere(3);
  const std::vector<Index> region = cap(ball);
  EXPECT_EQ(smooth_region({ball.positions, ball.triangles, region}, 0), ball.positions);
  EXPECT_EQ(flatten_region({ball.positions, ball.triangles, region}, 0), ball.positions);
  EXPECT_EQ(inflate_region({ball.positions, ball.triangles, region}, 0), ball.positions);
  EXPECT_EQ(smooth_region({ball.positions, ball.triangles, {}}, 0.5), ball.positions);
}

TEST(Sculpt, InflatingRaisesTheMiddleByItsHeight) {
  const test::TestMesh ball = test::icosphere(4);
  const std::vector<Index> region = cap(ball);
  for (const double height : {0.3, -0.2}) {
    const Points raised = inflate_region({ball.positions, ball.triangles, region}, height);
    expect_only_moves(ball.positions, raised, region);
    double most = 0;
    for (const Index v : region) {
      const double by = raised.row(v).norm() - 1;
      EXPECT_GE(by * height, -1e-9);
      most = std::max(most, std::abs(by));
    }
    EXPECT_NEAR(most, std::abs(height), 0.02 * std::abs(height));
  }
}

TEST(Sculpt, FlatteningMakesTheMiddleFlat) {
  const test::TestMesh ball = test::icosphere(4);
  const std::vector<Index> region = cap(ball),
                           middle = where(ball, [](const Vector3d& p) { return p.z() > 0.9; });
  const Points flat = flatten_region({ball.positions, ball.triangles, region}, 1);
  expect_only_moves(ball.positions, flat, region);
  double low = 2, high = -2;
  for (const Index v : middle) {
    low = std::min(low, flat(v, 2));
    high = std::max(high, flat(v, 2));
  }
  EXPECT_LT(high - low, 0.01);
  const Points half = flatten_region({ball.positions, ball.triangles, region}, 0.5);
  EXPECT_LT((2 * half - flat - ball.positions).norm(), 1e-9);
}

/// A region of a sphere, with each vertex's distance from it along edges.
struct Fading {
  test::TestMesh ball = test::icosphere(4);
  std::vector<Index> region = where(ball, [](const Vector3d& p) { return p.z() > 0.9; });
  std::vector<double> distance =
      edge_distance(region, ball.positions, vertex_rings(ball.size(), ball.triangles));
  SculptedSurface surface() const { return {ball.positions, ball.triangles, region}; }
  Index moved(const Points& points) const {
    Index count = 0;
    for (Index v = 0; v < ball.size(); ++v) count += points.row(v) != ball.positions.row(v) ? 1 : 0;
    return count;
  }
};

TEST(Sculpt, FadesOutOverItsReach) {
  const Fading cap;
  Index last = 0;
  for (const double reach : {0.0, 0.2, 0.4, 0.8}) {
    const std::vector<double> weights = reach_weights(cap.surface(), reach);
    const Points raised = inflate_region(cap.surface(), 0.1, reach),
                 flat = flatten_region(cap.surface(), 1, reach);
    for (Index v = 0; v < cap.ball.size(); ++v) {
      if (cap.distance[v] == 0) {
        EXPECT_EQ(weights[v], 1) << "the whole region moves";
      }
      if (cap.distance[v] > 0 && cap.distance[v] >= reach) {
        EXPECT_EQ(weights[v], 0);
        EXPECT_EQ(raised.row(v), cap.ball.positions.row(v)) << reach;
        EXPECT_EQ(flat.row(v), cap.ball.positions.row(v)) << reach;
      }
      EXPECT_NEAR((raised.row(v) - cap.ball.positions.row(v)).norm(), 0.1 * weights[v], 1e-9);
      for (Index w = 0; w < cap.ball.size(); ++w)
        if (cap.distance[w] > cap.distance[v]) {
          EXPECT_LE(weights[w], weights[v]) << "it falls with the distance";
        }
    }
    EXPECT_GT(cap.moved(raised), last) << "a larger reach moves more";
    last = cap.moved(raised);
  }
  EXPECT_EQ(cap.moved(inflate_region(cap.surface(), 0.1, 0.0)), static_cast<Index>(cap.region.size()));
}

// The plane is that of the region, whatever its reach.
TEST(Sculpt, FlattensTheWholeRegionWithAReach) {
  const Fading cap;
  const Points hard = flatten_region(cap.surface(), 1, 0), soft = flatten_region(cap.surface(), 1, 0.5);
  double low = 2, high = -2;
  for (const Index v : cap.region) {
    EXPECT_EQ(soft.row(v), hard.row(v));
    low = std::min(low, soft(v, 2));
    high = std::max(high, soft(v, 2));
  }
  EXPECT_LT(high - low, 1e-9);
}

TEST(Sculpt, FadesTowardsAnOpenBoundary) {
  const test::TestMesh sheet = test::grid(16, 16);
  const Vector3d low = sheet.positions.colwise().minCoeff(), high = sheet.positions.colwise().maxCoeff();
  const double size = (high - low).x();
  const std::vector<Index> half = where(sheet, [&](const Vector3d& p) { return p.x() < low.x() + 0.5 * size; });
  const SculptedSurface surface{sheet.positions, sheet.triangles, half};
  const std::vector<double> weights = reach_weights(surface, 0.3 * size);
  for (Index v = 0; v < sheet.size(); ++v) {
    const Vector3d p = sheet.positions.row(v);
    const double room = std::min({p.x() - low.x(), high.x() - p.x(), p.y() - low.y(), high.y() - p.y()});
    if (room <= 0) {
      EXPECT_EQ(weights[v], 0);
    } else if (room < 0.1 * size) {
      EXPECT_LT(weights[v], 0.5);
    }
    if (room > 0.31 * size && p.x() < low.x() + 0.5 * size) {
      EXPECT_EQ(weights[v], 1);
    }
  }
}

// However large the reach is, the middle of the region makes the whole movement, and nothing else makes more.
TEST(Sculpt, MovesTheMiddleOfARegionWhateverItsReach) {
  const test::TestMesh sheet = test::grid(16, 16);
  const Vector3d low = sheet.positions.colwise().minCoeff(), high = sheet.positions.colwise().maxCoeff();
  const double size = (high - low).x();
  const std::vector<Index> corner =
      where(sheet, [&](const Vector3d& p) { return (p.head<2>() - low.head<2>()).maxCoeff() < 0.3 * size; });
  const SculptedSurface surface{sheet.positions, sheet.triangles, corner};
  for (const double reach : {0.1, 0.5, 1.0, 5.0, 100.0, 1e300}) {
    const std::vector<double> weights = reach_weights(surface, reach * size);
    double most = 0;
    for (const Index v : corner) most = std::max(most, weights[v]);
    EXPECT_EQ(most, 1) << reach;
    EXPECT_LE(*std::max_element(weights.begin(), weights.end()), 1) << reach;
  }
}

// A region of nothing but an open boundary stays, and so does the surface around it.
TEST(Sculpt, LeavesAllWhereTheRegionCannotMove) {
  const test::TestMesh sheet = test::grid(16, 16);
  const double left = sheet.positions.col(0).minCoeff();
  const std::vector<Index> rim = where(sheet, [&](const Vector3d& p) { return p.x() == left; });
  const SculptedSurface surface{sheet.positions, sheet.triangles, rim};
  const double reach = 0.5 * (sheet.positions.col(0).maxCoeff() - left);
  EXPECT_EQ(inflate_region(surface, 0.1, reach), sheet.positions);
  EXPECT_EQ(flatten_region(surface, 1, reach), sheet.positions);
}

TEST(Sculpt, RefusesAReachThatIsNone) {
  const Fading cap;
  for (const double reach : {-0.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (const auto& shape : {std::function([&] { inflate_region(cap.surface(), 0.1, reach); }),
                              std::function([&] { flatten_region(cap.surface(), 0.5, reach); })}) {
      try {
        shape();
        FAIL() << reach;
      } catch (const Error& error) {
        EXPECT_EQ(error.location().text(), "reach");
        EXPECT_EQ(error.id(), facts::core::NegativeOrNotFinite::id);
      }
    }
  }
}

TEST(Sculpt, FollowsSimilarities) {
  const Eigen::Affine3d map = Eigen::Translation3d(5, -3, 2) *
                              Eigen::AngleAxisd(0.8, Vector3d(1, 2, 2).normalized()) * Eigen::Scaling(3.0);
  const test::TestMesh ball = test::bumpy_sphere(3), moved = test::transformed(ball, map, "");
  const std::vector<Index> region = cap(ball);
  const auto mapped = [&](const Points& points) -> Points {
    return (points * map.linear().transpose()).rowwise() + map.translation().transpose();
  };
  const SculptedSurface here{ball.positions, ball.triangles, region},
      there{moved.positions, moved.triangles, region};
  EXPECT_LT((mapped(smooth_region(here, 0.4)) - smooth_region(there, 0.4)).norm(), 1e-7);
  EXPECT_LT((mapped(inflate_region(here, 0.1)) - inflate_region(there, 0.3)).norm(), 1e-7);
  EXPECT_LT((mapped(flatten_region(here, 0.7)) - flatten_region(there, 0.7)).norm(), 1e-7);
  EXPECT_LT((mapped(inflate_region(here, 0.1, 0.3)) - inflate_region(there, 0.3, 0.9)).norm(), 1e-7);
  EXPECT_LT((mapped(flatten_region(here, 0.7, 0.3)) - flatten_region(there, 0.7, 0.9)).norm(), 1e-7);
}

TEST(Sculpt, LeavesTheOpenBoundaryWhereItIs) {
  const test::TestMesh sheet = test::grid(16, 16);
  std::vector<Index> all(static_cast<std::size_t>(sheet.size()));
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<Index>(v);
  const Points smooth = smooth_region({sheet.positions, sheet.triangles, all}, 1);
  int still = 0;
  for (Index v = 0; v < sheet.size(); ++v) still += smooth.row(v) == sheet.positions.row(v) ? 1 : 0;
  EXPECT_EQ(still, 4 * 16);
}

TEST(Sculpt, RefusesWhatHasNoShapeLeft) {
  const test::TestMesh ball = test::icosphere(2);
  const std::vector<Index> all = where(ball, [](const Vector3d&) { return true; });
  try {
    smooth_region({ball.positions, ball.triangles, all}, 1);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), facts::deform::SmoothedAway::id);
  }
  const std::vector<Index> most(all.begin() + 2, all.end());
  EXPECT_THROW(smooth_region({ball.positions, ball.triangles, most}, 1), Error);
  const Points smooth = smooth_region({ball.positions, ball.triangles, all}, 0.5);
  EXPECT_TRUE(smooth.allFinite());
  EXPECT_THROW(smooth_region({ball.positions, ball.triangles, all}, 1.5), Error);
  EXPECT_THROW(flatten_region({ball.positions, ball.triangles, all}, -1), Error);
}

TEST(Sculpt, LeavesFacesWithoutAreaAlone) {
  test::TestMesh line = test::grid(6, 6);
  line.positions.col(1).setZero();
  line.positions.col(2).setZero();
  const std::vector<Index> all = where(line, [](const Vector3d&) { return true; });
  const SculptedSurface surface{line.positions, line.triangles, all};
  EXPECT_EQ(smooth_region(surface, 0.5), line.positions);
  EXPECT_EQ(flatten_region(surface, 1), line.positions);
  EXPECT_EQ(inflate_region(surface, 1), line.positions);
}

}  // namespace
}  // namespace meshgraft
