#include "models.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meshgraft::samples {

namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;

// Builds a grid of nu×nv vertices, closed in the directions that wrap around. A staggered grid shifts odd
// rows by half a step, so that the point function can make near-equilateral triangles.
template <typename Point>
Mesh grid_mesh(int nu, int nv, bool wrap_u, bool wrap_v, bool staggered, Point point) {
  Mesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(nu) * nv, 3);
  for (int v = 0; v < nv; ++v)
    for (int u = 0; u < nu; ++u)
      mesh.positions.row(static_cast<Eigen::Index>(v) * nu + u) =
          point(u + (staggered && v % 2 ? 0.5 : 0.0), v).transpose();
  const int rows = wrap_v ? nv : nv - 1, columns = wrap_u ? nu : nu - 1;
  mesh.faces.reserve(2 * rows * columns, 6 * rows * columns);
  for (int v = 0; v < rows; ++v)
    for (int u = 0; u < columns; ++u) {
      const auto id = [&](int i, int j) { return static_cast<Index>((j % nv) * nu + i % nu); };
      const Index a = id(u, v), b = id(u + 1, v), c = id(u + 1, v + 1), d = id(u, v + 1);
      const bool other_diagonal = staggered ? v % 2 != 0 : (u + v) % 2 != 0;
      const Index first[3] = {a, b, other_diagonal ? c : d};
      const Index second[3] = {other_diagonal ? a : b, c, d};
      mesh.faces.push_back(first);
      mesh.faces.push_back(second);
    }
  return mesh;
}

// Builds a tube of unit arc-length grid steps around a closed curve.
template <typename Curve>
Mesh closed_tube(int resolution, double length, double radius, Curve curve) {
  // Rows run along the curve and columns around it, for about resolution² vertices of near-equilateral
  // triangles.
  const double area = length * full_turn * radius;
  const double edge = std::sqrt(area / (std::sqrt(0.75) * resolution * resolution));
  const int around = std::max(3, static_cast<int>(std::lround(full_turn * radius / edge)));
  int along = std::max(4, static_cast<int>(std::lround(length / (std::sqrt(0.75) * edge))));
  along += along % 2;
  return grid_mesh(around, along, true, true, true,
                   [&](double u, double v) { return curve(full_turn * v / along, -full_turn * u / around); });
}

}  // namespace

Mesh bumpy_plane(int resolution) {
  return grid_mesh(resolution, resolution, false, false, false, [&](double u, double v) {
    const double x = u / (resolution - 1) - 0.5, y = v / (resolution - 1) - 0.5;
    const double z = 0.045 * noise({8.0 * x + 20.0, 8.0 * y + 20.0, 0.5}, 5) +
                     0.018 * noise({17.0 * x + 40.0, 17.0 * y + 40.0, 0.5}, 6);
    return Vec3(x, y, z);
  });
}

Mesh bar(int resolution) {
  // The sides of the 1 × 1 × 4 bar are one grid around, closed by two square caps that share the grid's ends.
  const int side = std::max(1, static_cast<int>(std::lround(resolution / 4.24)));
  const int along = 4 * side, around = 4 * side;
  Mesh mesh = grid_mesh(around, along + 1, true, false, false, [&](double u, double v) {
    const int edge = static_cast<int>(u) / side;
    const double t = u / side - edge - 0.5;
    const Vec3 corner[4] = {{t, -0.5, 0}, {0.5, t, 0}, {-t, 0.5, 0}, {-0.5, -t, 0}};
    return Vec3(corner[edge] + Vec3(0, 0, 4.0 * v / along));
  });
  for (const bool top : {false, true}) {
    const Index rim = top ? along * around : 0;
    const Index inner = mesh.vertex_count();
    const int n = side - 1;
    mesh.positions.conservativeResize(inner + n * n, 3);
    for (int j = 1; j <= n; ++j)
      for (int i = 1; i <= n; ++i)
        mesh.positions.row(inner + (j - 1) * n + i - 1) << static_cast<double>(i) / side - 0.5,
            static_cast<double>(j) / side - 0.5, top ? 4.0 : 0.0;
    const auto id = [&](int i, int j) -> Index {
      if (j == 0) return rim + i;
      if (i == side) return rim + side + j;
      if (j == side) return rim + 3 * side - i;
      if (i == 0) return rim + (4 * side - j) % around;
      return inner + (j - 1) * n + i - 1;
    };
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const Index a = id(i, j), b = id(i + 1, j), c = id(i + 1, j + 1), d = id(i, j + 1);
        const bool other_diagonal = (i + j) % 2 != 0;
        Index first[3] = {a, b, other_diagonal ? c : d}, second[3] = {other_diagonal ? a : b, c, d};
        if (!top) std::swap(first[1], first[2]), std::swap(second[1], second[2]);
        mesh.faces.push_back(first);
        mesh.faces.push_back(second);
      }
  }
  return mesh;
}

Mesh cylinder(int resolution) {
  constexpr double radius = 0.5, height = 4.0;
  const double edge = std::sqrt(full_turn * radius * height / (std::sqrt(0.75) * resolution * resolution));
  const int around = std::max(3, static_cast<int>(std::lround(full_turn * radius / edge)));
  const int rows = std::max(2, static_cast<int>(std::lround(height / (std::sqrt(0.75) * edge))) + 1);
  return grid_mesh(around, rows, true, false, true, [&](double u, double v) {
    const double turn = full_turn * u / around;
    return Vec3(radius * std::cos(turn), radius * std::sin(turn), height * v / (rows - 1));
  });
}

Mesh torus(int resolution) {
  return closed_tube(resolution, full_turn, 0.4, [](double t, double turn) {
    const double reach = 1.0 + 0.4 * std::cos(turn);
    return Vec3(reach * std::cos(t), reach * std::sin(t), 0.4 + 0.4 * std::sin(turn));
  });
}

Mesh knot(int resolution) {
  // The trefoil; its frame comes from the torus that it winds around.
  const auto axis = [](double t) {
    return Vec3((2.0 + std::cos(3.0 * t)) * std::cos(2.0 * t), (2.0 + std::cos(3.0 * t)) * std::sin(2.0 * t),
                std::sin(3.0 * t));
  };
  double length = 0.0;
  for (int k = 0; k < 1024; ++k)
    length += (axis(full_turn * (k + 1) / 1024) - axis(full_turn * k / 1024)).norm();
  constexpr double radius = 0.42;
  return closed_tube(resolution, length, radius, [&](double t, double turn) {
    const Vec3 p = axis(t), tangent = (axis(t + 1e-4) - axis(t - 1e-4)).normalized();
    const Vec3 centre(2.0 * std::cos(2.0 * t), 2.0 * std::sin(2.0 * t), 0.0);
    const Vec3 out = p - centre;
    const Vec3 normal = (out - tangent * tangent.dot(out)).normalized();
    return Vec3(p + Vec3(0, 0, 1.0 + radius) +
                radius * (std::cos(turn) * normal + std::sin(turn) * normal.cross(tangent)));
  });
}

}  // namespace meshgraft::samples
