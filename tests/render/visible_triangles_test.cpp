#include "render/visible_triangles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/shapes.h"
#include "render/occluders.h"
#include "render/seen_triangle.h"

namespace meshgraft::render {
namespace {

constexpr int width = 64, height = 48;

/// A camera that looks along -z with a field of view of 90°.
View forward() {
  View view;
  view.tangent = 1.0f;
  view.width = width;
  view.height = height;
  return view;
}

/// Returns the triangles that samples show, of a list of triangles by their corners.
std::vector<std::uint32_t> seen(const std::vector<Vec3>& corners, const Samples& samples = {width, height}) {
  Triangles triangles(static_cast<Eigen::Index>(corners.size() / 3), 3);
  std::iota(triangles.data(), triangles.data() + triangles.size(), 0);
  return visible_triangles(corners, triangles, forward(), samples, {});
}

std::vector<Vec3> facing(float depth) { return {{-9, -9, -depth}, {9, -9, -depth}, {0, 9, -depth}}; }

std::vector<Vec3> together(std::vector<Vec3> first, const std::vector<Vec3>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

TEST(VisibleTriangles, TheNearestOneIsSeenFromBothSides) {
  const std::size_t middle = static_cast<std::size_t>(height / 2 * width + width / 2);
  EXPECT_EQ(seen(together(facing(2), facing(1)))[middle], 1u);
  EXPECT_EQ(seen(together(facing(1), facing(2)))[middle], 0u);
  EXPECT_EQ(seen(together(facing(1), facing(1)))[middle], 0u) << "the first of two in one place";
  std::vector<Vec3> turned = facing(1);
  std::swap(turned[0], turned[1]);
  EXPECT_EQ(seen(together(facing(2), turned))[middle], 1u);
}

TEST(VisibleTriangles, NoneBehindTheEye) {
  EXPECT_TRUE(std::ranges::all_of(seen(facing(-1)), [](std::uint32_t t) { return t == no_triangle; }));
}

TEST(VisibleTriangles, AFloorThatBeginsBehindTheEyeFillsTheLowerHalf) {
  const std::vector<std::uint32_t> floor = seen({{-1e3f, -1, 5}, {1e3f, -1, 5}, {0, -1, -1e4f}});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      EXPECT_EQ(floor[static_cast<std::size_t>(y * width + x)], y < height / 2 ? no_triangle : 0u)
          << x << ' ' << y;
}

TEST(VisibleTriangles, ManyThatBeginBehindTheEyeFillTheLowerHalf) {
  // Strips of the floor, some with a corner exactly beside the eye.
  std::vector<Vec3> strips;
  for (int k = -200; k < 200; ++k) {
    const float left = 0.5f * static_cast<float>(k), right = left + 0.5f;
    strips.insert(strips.end(), {{left, -1, 5}, {right, -1, k % 2 == 0 ? 0.0f : 5.0f}, {left, -1, -1e5f}});
    strips.insert(strips.end(), {{right, -1, k % 2 == 0 ? 0.0f : 5.0f}, {right, -1, -1e5f}, {left, -1, -1e5f}});
  }
  const Samples samples(width, height, 2, Flags(static_cast<std::size_t>(width * height), 1));
  const std::vector<std::uint32_t> floor = seen(strips, samples);
  for (int y = height / 2 + 1; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t s = 0; s < samples.per_pixel(); ++s)
        EXPECT_NE(floor[samples.first(samples.pixel(x, y)) + s], no_triangle) << x << ' ' << y;
}

TEST(VisibleTriangles, NeedlesHideOnlyWhatIsBehindThem) {
  // Needles of every direction, at the depth 3, between two faces.
  std::vector<Vec3> needles;
  for (int k = 0; k < 100; ++k) {
    const float turn = 0.0314159f * static_cast<float>(k), x = std::cos(turn), y = std::sin(turn);
    needles.insert(needles.end(), {{-9 * x, -9 * y, -3}, {9 * x, 9 * y, -3}, {x, y + 1e-7f, -3}});
  }
  const auto front = seen(together(needles, facing(2))), back = seen(together(needles, facing(4)));
  EXPECT_TRUE(std::ranges::all_of(front, [](std::uint32_t t) { return t >= 100; }));
  EXPECT_TRUE(std::ranges::any_of(back, [](std::uint32_t t) { return t < 100; }));
}

TEST(SeenTriangle, WeightsGiveThePointThatADirectionMeets) {
  const Vec3 a(-3, -2, -4), b(4, -1, -9), c(0, 3, 2);  // one corner behind the eye
  const SeenTriangle triangle(a, b, c);
  for (const Vec3& expected : {Vec3(0.5f, 0.4f, 0.1f), Vec3(0.1f, 0.8f, 0.1f), Vec3(1, 0, 0)}) {
    const Vec3 point = expected[0] * a + expected[1] * b + expected[2] * c;
    const Eigen::Vector3d direction = point.cast<double>() / -static_cast<double>(point.z());
    if (expected[0] < 1) {
      EXPECT_TRUE(triangle.is_met(direction));
    }
    EXPECT_TRUE(triangle.weights(direction).isApprox(expected, 1e-5f)) << expected.transpose();
    EXPECT_NEAR(triangle.depth(direction), -point.z(), 1e-5);
  }
}

TEST(VisibleTriangles, ASurfaceHasNoHoles) {
  for (const int resolution : {3, 20, 150}) {  // from large triangles to several in a pixel
    const Mesh sheet = shapes::sheet({.columns = resolution, .rows = resolution}, [](double u, double v) {
      return Eigen::Vector3d(5 * (u - 0.5 + 0.13 * v), 5 * (v - 0.5), -2 - u * v);
    });
    std::vector<Vec3> points;
    for (const auto& position : sheet.positions.rowwise()) points.push_back(position.transpose().cast<float>());
    const Samples samples(width, height, 3, Flags(static_cast<std::size_t>(width * height), 1));
    const auto shown = visible_triangles(points, triangulate(sheet).triangles, forward(), samples, {});
    for (int y = height / 4; y < 3 * height / 4; ++y)
      for (int x = width / 4; x < 3 * width / 4; ++x)
        for (std::size_t s = 0; s < samples.per_pixel(); ++s)
          EXPECT_NE(shown[samples.first(samples.pixel(x, y)) + s], no_triangle) << x << ' ' << y;
  }
}

TEST(PictureSamples, LieInTheCellsOfTheirPixel) {
  Flags chosen(static_cast<std::size_t>(width * height), 0);
  chosen[7] = chosen[100] = 1;
  const Samples samples(width, height, 2, chosen);
  EXPECT_EQ(samples.size(), 8u);
  EXPECT_EQ(samples.first(6), Samples::none);
  EXPECT_EQ(samples.first(100), 4u);
  for (std::size_t s = 0; s < 4; ++s) {
    const Eigen::Vector2f place = 2.0f * samples.place(100, s);
    EXPECT_EQ(static_cast<std::size_t>(place.x()), s % 2);
    EXPECT_EQ(static_cast<std::size_t>(place.y()), s / 2);
  }
  EXPECT_EQ(Samples(width, height).place(100, 0), Eigen::Vector2f(0.5f, 0.5f));
}

TEST(Occluders, AreCoarseWhereTrianglesAreManyAndBlockTheSameRays) {
  const Mesh wave = shapes::sheet({.columns = 600, .rows = 500}, [](double u, double v) {
    return Eigen::Vector3d(2 * u - 1, 2 * v - 1, 0.2 * std::sin(9 * u));
  });
  std::vector<Vec3> points;
  for (const auto& position : wave.positions.rowwise()) points.push_back(position.transpose().cast<float>());
  const Triangles triangles = triangulate(wave).triangles;
  constexpr float cell = 0.02f;
  const Occluders occluders = make_occluders(points, triangles, cell, {});
  EXPECT_GT(occluders.triangles.size(), 10'000u);
  EXPECT_LT(occluders.triangles.size(), 40'000u);
  EXPECT_EQ(occluders.lift, cell / 2);
  const RayTracer tracer(occluders.triangles);
  for (int i = -9; i <= 9; ++i)
    for (int j = -9; j <= 9; ++j) {
      const float x = 0.1f * static_cast<float>(i), y = 0.1f * static_cast<float>(j);
      const float surface = 0.2f * std::sin(4.5f * (x + 1));
      const auto hit = tracer.first_hit({x, y, 1}, -Vec3::UnitZ());
      ASSERT_TRUE(hit) << x << ' ' << y;
      EXPECT_NEAR(1 - hit->distance, surface, 0.1f * cell);
      EXPECT_FALSE(tracer.blocked({x, y, surface + occluders.lift}, Vec3::UnitZ()));
    }
  const Occluders few = make_occluders(points, triangles.topRows(100), cell, {});
  EXPECT_EQ(few.triangles.size(), 100u);
  EXPECT_LT(few.lift, cell);
}

}  // namespace
}  // namespace meshgraft::render
