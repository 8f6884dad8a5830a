#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

#include "mesh/shapes.h"

namespace meshgraft {
namespace {

Eigen::Vector3d area_vector(const Points& p, std::span<const Index> face) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t c = 2; c < face.size(); ++c) {
    const Eigen::Vector3d a = p.row(face[c - 1]) - p.row(face[0]);
    const Eigen::Vector3d b = p.row(face[c]) - p.row(face[0]);
    sum += 0.5 * a.cross(b);
  }
  return sum;
}

// Returns a polygon in a tilted plane far from the origin, given its plane coordinates.
Mesh tilted(const std::vector<Eigen::Vector2d>& outline) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Mesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(outline.size()), 3);
  std::vector<Index> face;
  for (const auto& q : outline) {
    const auto k = static_cast<Index>(face.size());
    mesh.positions.row(k) =
        (turn * Eigen::Vector3d(q.x(), q.y(), 0) + Eigen::Vector3d(100, -50, 30)).transpose();
    face.push_back(k);
  }
  mesh.faces.push_back(face);
  return mesh;
}

std::vector<Eigen::Vector2d> star(int spikes) {
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k < 2 * spikes; ++k) {
    const double a = std::numbers::pi * k / spikes, r = k % 2 ? 0.3 : 1;
    outline.emplace_back(r * std::cos(a), r * std::sin(a));
  }
  return outline;
}

std::vector<Eigen::Vector2d> comb(int teeth) {
  std::vector<Eigen::Vector2d> outline = {{2.0 * teeth - 1, 0}};
  for (int k = teeth - 1; k >= 0; --k) {
    outline.insert(outline.end(), {{2.0 * k + 1, 3}, {2.0 * k, 3}});
    if (k > 0) outline.insert(outline.end(), {{2.0 * k, 1}, {2.0 * k - 1, 1}});
  }
  outline.emplace_back(0, 0);
  return outline;
}

std::vector<Eigen::Vector2d> spiral(int points) {
  std::vector<Eigen::Vector2d> outline;
  const auto at = [&](int k, double r) {
    const double a = 0.35 * k;
    return Eigen::Vector2d((1 + 0.1 * a) * r * std::cos(a), (1 + 0.1 * a) * r * std::sin(a));
  };
  for (int k = 0; k < points; ++k) outline.push_back(at(k, 1.2));
  for (int k = points - 1; k >= 0; --k) outline.push_back(at(k, 1));
  return outline;
}

struct Outline {
  std::string name;
  std::vector<Eigen::Vector2d> points;
};

const std::vector<Outline>& outlines() {
  static const std::vector<Outline> all = {
      {"convex quad", {{0, 0}, {3, 0}, {2.5, 1}, {0.5, 1.2}}},
      {"arrow head", {{0, 0}, {2, -1}, {0.6, 0}, {2, 1}}},
      {"quad with a straight corner", {{0, 0}, {1, 0}, {2, 0}, {1, 1}}},
      {"triangle with points on every side",
       {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {2, 1}, {1, 2}, {0, 3}, {0, 2}, {0, 1}}},
      {"L", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}},
      {"L with straight corners", {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}}},
      {"star", star(7)},
      {"comb", comb(5)},
      {"spiral", spiral(17)},
      {"large star", star(200)},
      {"large comb", comb(150)},
      {"square ring with a slit",
       {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}},
  };
  return all;
}

TEST(Triangulate, CoversEveryOutlineOnce) {
  for (const Outline& outline : outlines()) {
    SCOPED_TRACE(outline.name);
    const Mesh mesh = tilted(outline.points);
    const auto n = static_cast<Eigen::Index>(outline.points.size());
    const Triangles triangles = triangulate(mesh).triangles;
    ASSERT_EQ(triangles.rows(), n - 2);
    const Eigen::Vector3d whole = area_vector(mesh.positions, mesh.faces[0]);
    double covered = 0;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      const double part = area_vector(mesh.positions, {triangles.row(t).data(), 3}).dot(whole.normalized());
      EXPECT_GT(part, 1e-9) << "triangle " << t << " is turned over or has no area";
      covered += part;
    }
    // No triangle is turned over, so equal areas mean no overlap and no gap.
    EXPECT_NEAR(covered, whole.norm(), 1e-12 * whole.norm());
  }
}

TEST(Triangulate, StartCornerDoesNotMatter) {
  for (const Outline& outline : outlines()) {
    const std::size_t step = 1 + outline.points.size() / 40;
    for (std::size_t shift = 1; shift < outline.points.size(); shift += step) {
      SCOPED_TRACE(outline.name + " from corner " + std::to_string(shift));
      auto points = outline.points;
      std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(shift), points.end());
      const Mesh mesh = tilted(points);
      const Eigen::Vector3d normal = area_vector(mesh.positions, mesh.faces[0]).normalized();
      const Triangles triangles = triangulate(mesh).triangles;
      for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        EXPECT_GT(area_vector(mesh.positions, {triangles.row(t).data(), 3}).dot(normal), 1e-9);
      }
    }
  }
}

TEST(Triangulate, PassesTrianglesThroughAndFollowsTheFaces) {
  const Mesh mesh = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}},
                                     {{4, 2, 1}, {0, 1, 2, 3}, {2, 4, 5}});
  const Triangulation result = triangulate(mesh);
  EXPECT_EQ(result.face, (std::vector<Index>{0, 1, 1, 2}));
  EXPECT_EQ(result.triangles.row(0), (Eigen::RowVector3i(4, 2, 1)));
  EXPECT_EQ(result.triangles.row(3), (Eigen::RowVector3i(2, 4, 5)));
}

TEST(Triangulate, SplitsConvexQuadsAlongTheShorterDiagonal) {
  const auto has_diagonal = [](const Triangles& t, Index a, Index b) {
    int triangles_with_both = 0;
    for (Eigen::Index r = 0; r < t.rows(); ++r) {
      triangles_with_both += (t.row(r).array() == a).any() && (t.row(r).array() == b).any();
    }
    return triangles_with_both == 2;
  };
  EXPECT_TRUE(has_diagonal(triangulate(tilted({{0, 0}, {1, 0}, {3, 1}, {2, 1}})).triangles, 1, 3));
  EXPECT_TRUE(has_diagonal(triangulate(tilted({{2, 0}, {3, 0}, {1, 1}, {0, 1}})).triangles, 0, 2));
}

TEST(Triangulate, SkipsRepeatedCornersAndFacesWithoutThree) {
  const Mesh mesh = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                     {{0, 0, 1}, {0, 1, 1, 2}, {0, 1}, {}, {0, 2, 3, 0}});
  const Triangulation result = triangulate(mesh);
  EXPECT_EQ(result.face, (std::vector<Index>{1, 4}));
  for (Eigen::Index t = 0; t < result.triangles.rows(); ++t) {
    EXPECT_GT(area_vector(mesh.positions, {result.triangles.row(t).data(), 3}).z(), 0.4);
  }
}

TEST(Triangulate, EndsOnPolygonsWithoutAPlane) {
  const Mesh flat = tilted({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {1.5, 0}});
  EXPECT_EQ(triangulate(flat).triangles.rows(), 3);
  const Mesh tangled = tilted({{0, 0}, {2, 2}, {2, 0}, {0, 2}, {1, 3}, {1, -1}});
  EXPECT_EQ(triangulate(tangled).triangles.rows(), 4);
  Mesh broken = tilted({{0, 0}, {1, 0}, {1, 1}, {0.5, 0.2}, {0, 1}});
  broken.positions(2, 1) = std::nan("");
  EXPECT_EQ(triangulate(broken).triangles.rows(), 3);
}

TEST(Triangulate, NamesTheFaceWithAnIndexOutOfRange) {
  const Mesh mesh = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 1, 7}});
  try {
    triangulate(mesh);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.location().text(), "face 1");
    EXPECT_EQ(error.id(), "mesh.face_index_out_of_range");
    EXPECT_EQ(error.fact().get<std::int64_t>("vertex"), 7);
  }
  EXPECT_EQ(triangulate(mesh, {.skip_out_of_range = true}).face, (std::vector<Index>{0}));
}

}  // namespace
}  // namespace meshgraft
