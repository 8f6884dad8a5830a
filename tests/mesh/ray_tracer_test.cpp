#include "mesh/ray_tracer.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/samples/samples.h>

namespace meshgraft {
namespace {

using Eigen::Vector3f;

std::vector<RayTriangle> triangles_of(const Mesh& mesh) {
  const Triangles corner_lists = triangulate(mesh).triangles;
  std::vector<RayTriangle> out;
  for (const auto corners : corner_lists.rowwise()) {
    RayTriangle& triangle = out.emplace_back();
    for (int c = 0; c < 3; ++c)
      triangle[static_cast<std::size_t>(c)] = mesh.positions.row(corners[c]).transpose().cast<float>();
  }
  return out;
}

class Numbers {
 public:
  Vector3f point(float size = 1) { return size * Vector3f(number(), number(), number()); }
  Vector3f direction() {
    const Vector3f inside = point();
    return inside.norm() > 0.01f ? inside.normalized() : direction();
  }

 private:
  float number() { return 2.0f * static_cast<float>(engine_() >> 8) * 0x1p-24f - 1.0f; }
  std::mt19937 engine_{7};
};

std::vector<RayTriangle> random_triangles(int count, float size) {
  Numbers numbers;
  std::vector<RayTriangle> out;
  for (int t = 0; t < count; ++t) {
    const Vector3f centre = numbers.point();
    out.push_back({centre + numbers.point(size), centre + numbers.point(size), centre + numbers.point(size)});
  }
  return out;
}

// Returns the distance at which a ray meets a triangle, in double precision, or infinity.
double distance_to(const RayTriangle& triangle, const Vector3f& origin, const Vector3f& direction) {
  const Eigen::Vector3d p0 = triangle[0].cast<double>(), d = direction.cast<double>();
  Eigen::Matrix3d columns;
  columns << triangle[1].cast<double>() - p0, triangle[2].cast<double>() - p0, -d;
  const Eigen::Vector3d uvt = columns.inverse() * (origin.cast<double>() - p0);
  const bool inside = uvt[0] >= 0 && uvt[1] >= 0 && uvt[0] + uvt[1] <= 1 && uvt[2] >= 0;
  return inside ? uvt[2] : std::numeric_limits<double>::infinity();
}

TEST(RayTracer, FindsTheNearestOfAllTriangles) {
  for (const int count : {1, 3, 5, 9, 70, 300}) {
    const std::vector<RayTriangle> triangles = random_triangles(count, count < 100 ? 0.8f : 0.3f);
    const RayTracer tracer(triangles);
    Numbers numbers;
    int hits = 0;
    for (int ray = 0; ray < 300; ++ray) {
      const Vector3f origin = numbers.point(2), direction = numbers.direction();
      double nearest = std::numeric_limits<double>::infinity();
      for (const RayTriangle& triangle : triangles)
        nearest = std::min(nearest, distance_to(triangle, origin, direction));
      const auto hit = tracer.first_hit(origin, direction);
      ASSERT_EQ(hit.has_value(), std::isfinite(nearest)) << count << " triangles, ray " << ray;
      ASSERT_EQ(tracer.blocked(origin, direction), hit.has_value());
      if (!hit) continue;
      ++hits;
      ASSERT_NEAR(hit->distance, nearest, 1e-4);
      ASSERT_TRUE(tracer.blocked(origin, direction, 1.001f * hit->distance));
      ASSERT_FALSE(tracer.blocked(origin, direction, 0.999f * hit->distance));
      const auto& [p0, p1, p2] = triangles[hit->triangle];
      const Vector3f by_weights = (1 - hit->u - hit->v) * p0 + hit->u * p1 + hit->v * p2;
      ASSERT_LT((by_weights - (origin + hit->distance * direction)).norm(), 1e-3f);
    }
    EXPECT_GT(hits, 0) << count << " triangles";
  }
}

// From inside a closed surface every ray meets it, also through a vertex or along an edge.
TEST(RayTracer, LetsNoRayOutOfAClosedSurface) {
  for (const bool round : {false, true}) {
    Mesh mesh = make_sample("bar", 12);
    mesh.positions.rowwise() -= mesh.positions.colwise().mean().eval();
    if (round) mesh.positions.rowwise().normalize();
    const std::vector<RayTriangle> triangles = triangles_of(mesh);
    const RayTracer tracer(triangles);
    Numbers numbers;
    for (int from = 0; from < 5; ++from) {
      const Vector3f origin = from == 0 ? Vector3f(Vector3f::Zero()) : numbers.point(0.2f);
      for (const auto& corners : triangles)
        for (std::size_t c = 0; c < 3; ++c)
          for (const float along : {0.0f, 0.3f, 0.5f}) {
            const Vector3f target = (1 - along) * corners[c] + along * corners[(c + 1) % 3];
            const auto hit = tracer.first_hit(origin, target - origin);
            ASSERT_TRUE(hit) << (round ? "ball at " : "bar at ") << target.transpose();
            ASSERT_NEAR(hit->distance, 1.0f, 1e-3f);
          }
    }
  }
}

TEST(RayTracer, FollowsRaysAlongTheAxes) {
  const RayTracer tracer(triangles_of(make_sample("bar", 8)));  // [-0.5, 0.5]² × [0, 4]
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      const Vector3f direction = sign * Vector3f::Unit(axis);
      const auto hit = tracer.first_hit(Vector3f(0, 0, 2) - 10.0f * direction, direction);
      ASSERT_TRUE(hit);
      EXPECT_NEAR(hit->distance, axis == 2 ? 8.0f : 9.5f, 1e-5f);
      EXPECT_FALSE(tracer.first_hit(Vector3f(0, 0, 2) + 10.0f * direction, direction));
      EXPECT_FALSE(tracer.blocked(Vector3f(0, 0, 2) - 10.0f * direction + 7.0f * Vector3f::Unit((axis + 1) % 3),
                                  direction));
    }
}

TEST(RayTracer, LeavesOutWhatHasNoArea) {
  EXPECT_FALSE(RayTracer({}).first_hit(Vector3f::Zero(), Vector3f::UnitX()));
  const Vector3f a(1, -1, -1), b(1, 1, -1), c(1, 0, 1);
  const RayTracer tracer({{a, a, b}, {a, b, 0.5f * (a + b)}, {a, b, c}});
  const auto hit = tracer.first_hit(Vector3f::Zero(), Vector3f::UnitX());
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->triangle, 2u);
  EXPECT_FALSE(tracer.blocked(Vector3f::Zero(), -Vector3f::UnitX()));
}

TEST(RayTracer, LeavesOutWhatIsNotFinite) {
  const std::vector<RayTriangle> sound = random_triangles(100, 0.3f);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                  infinite = std::numeric_limits<float>::infinity();
  std::vector<RayTriangle> mixed;
  for (const RayTriangle& triangle : sound) {
    mixed.push_back(triangle);
    mixed.push_back({triangle[0], triangle[1], Vector3f(nan, infinite, -infinite)});
  }
  const RayTracer without(sound), with(mixed);
  Numbers numbers;
  for (int ray = 0; ray < 300; ++ray) {
    const Vector3f origin = numbers.point(2), direction = numbers.direction();
    const auto expected = without.first_hit(origin, direction), hit = with.first_hit(origin, direction);
    ASSERT_EQ(hit.has_value(), expected.has_value()) << ray;
    if (!hit) continue;
    ASSERT_EQ(hit->triangle, 2 * expected->triangle) << ray;
  }
}

TEST(RayTracer, MeetsNothingWithoutTrianglesOrWithoutARay) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::vector<RayTriangle>& none :
       {std::vector<RayTriangle>{},
        std::vector<RayTriangle>{{Eigen::Vector3f(0, 0, 0), {1, 0, 0}, {0, nan, 0}}}}) {
    const RayTracer tracer(none);
    EXPECT_FALSE(tracer.first_hit({0, 0, 1}, {0, 0, -1}).has_value());
    EXPECT_FALSE(tracer.blocked({0, 0, 1}, {0, 0, -1}));
  }
  const RayTracer tracer(triangles_of(make_sample("torus", 24)));
  for (const Vector3f& strange :
       {Vector3f(0, nan, 0), Vector3f(0, 0, std::numeric_limits<float>::infinity())}) {
    EXPECT_FALSE(tracer.first_hit({0, 0, 1}, strange).has_value());
    EXPECT_FALSE(tracer.blocked(strange, {0, 0, -1}));
  }
}

}  // namespace
}  // namespace meshgraft
