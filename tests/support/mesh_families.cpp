#include "support/mesh_families.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// Collects vertices and triangles.
struct Builder {
  std::vector<Vector3d> points;
  std::vector<std::array<Index, 3>> triangles;

  Index add(const Vector3d& point) {
    points.push_back(point);
    return static_cast<Index>(points.size()) - 1;
  }
  void face(Index a, Index b, Index c) { triangles.push_back({a, b, c}); }
  void quad(Index a, Index b, Index c, Index d, bool other_diagonal = false) {
    if (other_diagonal) {
      face(a, b, d);
      face(b, c, d);
    } else {
      face(a, b, c);
      face(a, c, d);
    }
  }

  TestMesh finish(std::string name) const {
    TestMesh mesh;
    mesh.name = std::move(name);
    mesh.positions.resize(static_cast<Eigen::Index>(points.size()), 3);
    for (std::size_t i = 0; i < points.size(); ++i)
      mesh.positions.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
    mesh.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int c = 0; c < 3; ++c) mesh.triangles(static_cast<Eigen::Index>(t), c) = triangles[t][c];
    return mesh;
  }
};

/// Returns a uniform number in [-1, 1). mt19937 is specified bit for bit, but standard distributions are not.
double symmetric_random(std::mt19937& random) { return static_cast<double>(random()) / 2147483648.0 - 1.0; }

/// Does one step of 1:4 subdivision. `place` moves the new vertices.
void subdivide(Builder& mesh, const std::function<Vector3d(const Vector3d&)>& place) {
  std::map<std::pair<Index, Index>, Index> middle_of;
  const auto middle = [&](Index a, Index b) {
    const auto [entry, is_new] = middle_of.try_emplace(std::minmax(a, b), 0);
    if (is_new) entry->second = mesh.add(place((mesh.points[a] + mesh.points[b]) / 2));
    return entry->second;
  };
  const auto old = std::exchange(mesh.triangles, {});
  for (const auto& [a, b, c] : old) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    mesh.face(a, ab, ca);
    mesh.face(ab, b, bc);
    mesh.face(ca, bc, c);
    mesh.face(ab, bc, ca);
  }
}

double bumps(double u, double v) {
  return 0.06 * std::sin(7 * u + 1) * std::cos(5 * v) + 0.04 * std::cos(3 * u - 4 * v);
}

enum class Relief { flat, bumpy };
enum class Pattern { even, irregular };

TestMesh make_sheet(std::string name, int cells_u, int cells_v, Relief relief, Pattern pattern) {
  Builder mesh;
  std::mt19937 random(7);
  const double step = 2.0 / cells_u;
  for (int j = 0; j <= cells_v; ++j)
    for (int i = 0; i <= cells_u; ++i) {
      double u = i * step, v = j * step;
      if (pattern == Pattern::irregular) {
        u += 0.3 * step * symmetric_random(random);
        v += 0.3 * step * symmetric_random(random);
      }
      mesh.add({u, v, relief == Relief::bumpy ? bumps(u, v) : 0.0});
    }
  const auto at = [&](int i, int j) { return j * (cells_u + 1) + i; };
  for (int j = 0; j < cells_v; ++j)
    for (int i = 0; i < cells_u; ++i)
      mesh.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1),
                pattern == Pattern::irregular && random() % 2 == 0);
  return mesh.finish(std::move(name));
}

using Cell = std::array<int, 3>;

/// Returns the surface of those unit cubes in a box of `size` cubes for which `solid` holds.
Builder cube_surface(const Cell& size, const std::function<bool(const Cell&)>& solid) {
  Builder mesh;
  std::map<Cell, Index> index_of;
  const auto vertex = [&](const Cell& corner) {
    const auto [entry, is_new] = index_of.try_emplace(corner, 0);
    if (is_new) entry->second = mesh.add(Vector3d(corner[0], corner[1], corner[2]));
    return entry->second;
  };
  const auto is_solid = [&](const Cell& cell) {
    for (int axis = 0; axis < 3; ++axis)
      if (cell[axis] < 0 || cell[axis] >= size[axis]) return false;
    return solid(cell);
  };
  const auto add_side = [&](const Cell& cell, int axis, int side) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    std::array<Index, 4> corners{};
    for (int k = 0; k < 4; ++k) {
      Cell corner = cell;
      corner[axis] += side;
      corner[b] += (k == 1 || k == 2) ? 1 : 0;
      corner[c] += (k == 2 || k == 3) ? 1 : 0;
      corners[k] = vertex(corner);
    }
    if (side == 0) std::swap(corners[1], corners[3]);
    mesh.quad(corners[0], corners[1], corners[2], corners[3], (cell[0] + cell[1] + cell[2]) % 2 != 0);
  };
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x)
        for (int axis = 0; axis < 3; ++axis)
          for (int side = 0; side < 2; ++side) {
            const Cell cell{x, y, z};
            Cell neighbour = cell;
            neighbour[axis] += 2 * side - 1;
            if (is_solid(cell) && !is_solid(neighbour)) add_side(cell, axis, side);
          }
  return mesh;
}

}  // namespace

double TestMesh::box_diagonal() const {
  Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (Index vertex : triangles.reshaped()) {
    low = low.min(positions.row(vertex).transpose().array());
    high = high.max(positions.row(vertex).transpose().array());
  }
  return (high - low).matrix().norm();
}

TestMesh icosphere(int level) {
  Builder mesh;
  const double g = (1 + std::sqrt(5.0)) / 2;
  for (int k = 0; k < 3; ++k)
    for (int s = 0; s < 4; ++s) {
      Vector3d point = Vector3d::Zero();
      point[k] = (s & 1) != 0 ? 1 : -1;
      point[(k + 1) % 3] = (s & 2) != 0 ? g : -g;
      mesh.add(point.normalized());
    }
  // The faces of the icosahedron are its triples of mutually nearest vertices, turned outward.
  const double edge = 2 / std::sqrt(1 + g * g) + 1e-9;
  const auto near = [&](Index a, Index b) { return (mesh.points[a] - mesh.points[b]).norm() < edge; };
  for (Index a = 0; a < 12; ++a)
    for (Index b = a + 1; b < 12; ++b)
      for (Index c = b + 1; c < 12; ++c) {
        if (!near(a, b) || !near(b, c) || !near(c, a)) continue;
        const auto& p = mesh.points;
        const bool outward = (p[b] - p[a]).cross(p[c] - p[a]).dot(p[a]) > 0;
        outward ? mesh.face(a, b, c) : mesh.face(a, c, b);
      }
  for (int k = 0; k < level; ++k) subdivide(mesh, [](const Vector3d& p) { return p.normalized(); });
  return mesh.finish("icosphere");
}

TestMesh bumpy_sphere(int level) {
  TestMesh mesh = icosphere(level);
  mesh.name = "bumpy sphere";
  for (auto row : mesh.positions.rowwise()) {
    const Vector3d p = row.transpose();
    const double radius = 1 + 0.15 * std::sin(3 * p.x() + 1) * std::cos(4 * p.y()) + 0.1 * std::sin(5 * p.z());
    row = radius * Eigen::RowVector3d(p.x(), 0.9 * p.y(), 1.3 * p.z());
  }
  return mesh;
}

TestMesh bar(int across, int along) {
  TestMesh mesh = cube_surface({across, across, along}, [](const Cell&) { return true; }).finish("bar");
  mesh.positions /= across;
  return mesh;
}

TestMesh grid(int cells_u, int cells_v) {
  return make_sheet("grid", cells_u, cells_v, Relief::bumpy, Pattern::even);
}

TestMesh irregular_grid(int cells_u, int cells_v) {
  return make_sheet("irregular grid", cells_u, cells_v, Relief::bumpy, Pattern::irregular);
}

TestMesh flat_sheet(int cells_u, int cells_v) {
  return make_sheet("flat sheet", cells_u, cells_v, Relief::flat, Pattern::irregular);
}

TestMesh tube(int around, int along) {
  Builder mesh;
  const double step = 2 * pi * 0.4 / around;
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * pi * (i + 0.5 * j) / around;
      mesh.add({0.4 * std::cos(angle), 0.4 * std::sin(angle), j * step});
    }
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const int k = (i + 1) % around;
      mesh.quad(j * around + i, j * around + k, (j + 1) * around + k, (j + 1) * around + i, true);
    }
  return mesh.finish("tube");
}

TestMesh torus(int around, int along) {
  Builder mesh;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * pi * i / around, b = 2 * pi * j / along, r = 1.2 + 0.45 * std::cos(a);
      mesh.add({1.2 * r * std::cos(b), r * std::sin(b), 0.45 * std::sin(a)});
    }
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const int k = (i + 1) % around, l = (j + 1) % along;
      mesh.quad(j * around + i, l * around + i, l * around + k, j * around + k);
    }
  return mesh.finish("torus");
}

TestMesh plate_with_holes(int holes, int subdivisions) {
  const auto solid = [](const Cell& cell) { return cell[0] % 2 == 0 || cell[1] != 1; };
  Builder mesh = cube_surface({2 * holes + 1, 3, 1}, solid);
  for (int k = 0; k < subdivisions; ++k) subdivide(mesh, [](const Vector3d& p) { return p; });
  return mesh.finish("plate with holes");
}

TestMesh fan_pole(int around, int segments) {
  Builder mesh;
  const double segment = 1000 * 2 * std::sin(pi / around);  // 1000 × an edge of the circle
  const Index foot = mesh.add({0, 0, 0});
  for (int j = 0; j <= segments; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * pi * i / around;
      mesh.add({std::cos(angle), std::sin(angle), j * segment});
    }
  const Index tip = mesh.add({0, 0, (segments + 0.6) * segment});
  const auto at = [&](int i, int j) { return 1 + j * around + i % around; };
  for (int i = 0; i < around; ++i) {
    mesh.face(foot, at(i + 1, 0), at(i, 0));
    mesh.face(tip, at(i, segments), at(i + 1, segments));
    for (int j = 0; j < segments; ++j) mesh.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return mesh.finish("fan pole");
}

TestMesh needle_sheet(int cells_u, int cells_v) {
  TestMesh mesh = grid(cells_u, cells_v);
  mesh.name = "needle sheet";
  mesh.positions.col(1) *= 1000;
  return mesh;
}

TestMesh tetrahedron() {
  Builder mesh;
  mesh.points = {{0, 0, 0}, {1, 0.1, 0}, {0.2, 1, 0.1}, {0.3, 0.2, 1.4}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh.finish("tetrahedron");
}

TestMesh octahedron() {
  Builder mesh;
  mesh.points = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0.1, 0, 1.3}, {0, 0.1, -1.2}};
  for (Index i = 0; i < 4; ++i) {
    mesh.face(i, (i + 1) % 4, 4);
    mesh.face((i + 1) % 4, i, 5);
  }
  return mesh.finish("octahedron");
}

TestMesh pyramid_without_base() {
  Builder mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0.1}, {1.1, 1, 0}, {0, 0.9, 0.05}, {0.5, 0.4, 1.5}};
  for (Index i = 0; i < 4; ++i) mesh.face(i, (i + 1) % 4, 4);
  return mesh.finish("pyramid without base");
}

TestMesh two_triangles() {
  Builder mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1.5, 1, 0.4}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
  return mesh.finish("two triangles");
}

TestMesh with_isolated_vertices(TestMesh mesh) {
  const Index n = mesh.size(), middle = n / 2;
  Points positions(n + 3, 3);
  positions.row(0) << 5, -3, 2;
  positions.middleRows(1, middle) = mesh.positions.topRows(middle);
  positions.row(1 + middle) << 0.1, 0.1, 0.1;
  positions.middleRows(2 + middle, n - middle) = mesh.positions.bottomRows(n - middle);
  positions.row(n + 2) << -4, 0, 0;
  mesh.triangles = mesh.triangles.unaryExpr([&](Index v) { return v < middle ? v + 1 : v + 2; }).eval();
  mesh.positions = std::move(positions);
  mesh.name += " with isolated vertices";
  return mesh;
}

TestMesh transformed(TestMesh mesh, const Eigen::Affine3d& map, const std::string& suffix) {
  for (auto row : mesh.positions.rowwise()) row = (map * Vector3d(row.transpose())).transpose();
  mesh.name += suffix;
  return mesh;
}

Vector3d far_offset() { return {1e9, -1.1e9, 0.9e9}; }

TestMesh far_away(TestMesh mesh) {
  return transformed(std::move(mesh), Eigen::Affine3d(Eigen::Translation3d(far_offset())), ", far");
}

TestMesh minute(TestMesh mesh) {
  mesh.positions *= 1e-6;
  mesh.name += ", minute";
  return mesh;
}

std::vector<TestMesh> mesh_families() {
  return {icosphere(2),
          bumpy_sphere(3),
          bar(3, 14),
          grid(20, 12),
          irregular_grid(22, 16),
          flat_sheet(18, 12),
          tube(14, 30),
          torus(14, 30),
          plate_with_holes(2, 2),
          fan_pole(24, 4),
          needle_sheet(12, 10),
          tetrahedron(),
          octahedron(),
          pyramid_without_base(),
          two_triangles(),
          icosphere(0),
          with_isolated_vertices(irregular_grid(12, 8)),
          far_away(bumpy_sphere(2)),
          minute(bumpy_sphere(2)),
          far_away(flat_sheet(12, 8)),
          minute(tube(10, 14))};
}

std::vector<TestMesh> small_families() {
  return {icosphere(2), bumpy_sphere(2),       bar(2, 9),
          grid(14, 9),  irregular_grid(14, 9), flat_sheet(14, 9),
          tube(10, 16), torus(9, 16),          plate_with_holes(2, 1),
          octahedron(), icosphere(0),          with_isolated_vertices(irregular_grid(12, 8))};
}

std::vector<TestMesh> large_families(Index vertices) {
  const double n = vertices;
  const int side = static_cast<int>(std::sqrt(n));
  const int level = static_cast<int>(std::lround(std::log((n - 2) / 10) / std::log(4.0)));
  const int around = static_cast<int>(std::sqrt(n / 3));
  const int across = static_cast<int>(std::sqrt(n / 20));
  return {bumpy_sphere(level),      irregular_grid(side, side), flat_sheet(side, side),
          tube(around, 3 * around), torus(around, 3 * around),  bar(across, 5 * across)};
}

Scene make_scene(TestMesh mesh, double foot_fraction, double head_fraction) {
  std::vector<bool> used(static_cast<std::size_t>(mesh.size()), false);
  for (Index v : mesh.triangles.reshaped()) used[static_cast<std::size_t>(v)] = true;
  Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (Index v = 0; v < mesh.size(); ++v)
    if (used[static_cast<std::size_t>(v)]) {
      low = low.min(mesh.positions.row(v).transpose().array());
      high = high.max(mesh.positions.row(v).transpose().array());
    }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const double length = high[axis] - low[axis];
  // In a tiny mesh only the extreme vertices are ends, so that some vertices stay free.
  if (mesh.size() <= 12) foot_fraction = head_fraction = 0;
  Scene scene;
  for (Index v = 0; v < mesh.size(); ++v) {
    if (!used[static_cast<std::size_t>(v)]) continue;
    const double place = (mesh.positions(v, axis) - low[axis]) / length;
    if (place <= foot_fraction) scene.foot.push_back(v);
    if (place >= 1 - head_fraction) scene.head.push_back(v);
  }
  scene.mesh = std::move(mesh);
  return scene;
}

namespace {

constexpr double row_length = 3.0;
constexpr double row_girth = 2.4;  // around a pipe, or across a plane

Vector3d row_point(RowShape shape, double u, double s) {
  switch (shape) {
    case RowShape::plane: return {row_girth / 2 * (s - 0.5), 0, u};
    case RowShape::tube: {
      const double radius = row_girth / (2 * pi);
      return {radius * std::cos(2 * pi * s), radius * std::sin(2 * pi * s), u};
    }
    case RowShape::bar: break;
  }
  const double side = row_girth / 4, along = 4 * s - std::floor(4 * s), half = side / 2;
  switch (static_cast<int>(std::floor(4 * s)) % 4) {
    case 0: return {half, side * along - half, u};
    case 1: return {half - side * along, half, u};
    case 2: return {-half, half - side * along, u};
    default: return {side * along - half, -half, u};
  }
}

/// Returns the positions of the rows and the number of cells in each.
std::vector<Row> place_rows(RowShape shape, int cells_along, int ratio) {
  const double h = row_length / cells_along, held = row_length / 10;
  const double girth = shape == RowShape::plane ? row_girth / 2 : row_girth;
  // A multiple of four puts the corners of a bar on vertices.
  int cells = 4 * static_cast<int>(std::lround(girth / h / 4));
  std::vector<Row> rows;
  const auto fill = [&](double from, double to, double step) {
    const int count = std::max(1, static_cast<int>(std::lround((to - from) / step)));
    for (int k = 1; k <= count; ++k) rows.push_back({k == count ? to : from + (to - from) * k / count, cells});
  };
  rows.push_back({0, cells});
  fill(0, held, h);
  fill(held, row_length / 2, h);
  double u = row_length / 2, step = h;
  for (int r = ratio; r > 1; r /= 2) {
    cells *= 2;
    u += 0.75 * step;
    step /= 2;
    rows.push_back({u, cells});
    u += step;
    rows.push_back({u, cells});
  }
  fill(u, row_length - held, step);
  fill(row_length - held, row_length, step);
  return rows;
}

}  // namespace

RowMesh graded_rows(RowShape shape, int cells_along, int ratio) {
  RowMesh result;
  result.length = row_length;
  result.rows = place_rows(shape, cells_along, ratio);
  const bool closed = shape != RowShape::plane;
  Builder mesh;
  for (Row& row : result.rows) {
    row.first = static_cast<Index>(mesh.points.size());
    row.vertices = closed ? row.cells : row.cells + 1;
    for (Index i = 0; i < row.vertices; ++i)
      mesh.add(row_point(shape, row.u, static_cast<double>(i) / row.cells));
  }
  for (std::size_t k = 0; k + 1 < result.rows.size(); ++k) {
    const Row &low = result.rows[k], &high = result.rows[k + 1];
    const auto at = [](const Row& row, int i) { return row.first + i % row.vertices; };
    for (int i = 0; i < low.cells; ++i) {
      const Index a = at(low, i), b = at(low, i + 1);
      if (high.cells == low.cells) {
        // Alternating diagonals favour no direction of twist.
        mesh.quad(a, b, at(high, i + 1), at(high, i), ((static_cast<int>(k) + i) & 1) != 0);
      } else {
        const Index c = at(high, 2 * i), d = at(high, 2 * i + 1), e = at(high, 2 * i + 2);
        mesh.face(a, d, c);
        mesh.face(a, b, d);
        mesh.face(b, e, d);
      }
    }
  }
  result.mesh = mesh.finish(std::string(to_string(shape)) + " of " + std::to_string(cells_along) + " cells, " +
                            std::to_string(ratio) + ":1");
  return result;
}

const char* to_string(RowShape shape) {
  switch (shape) {
    case RowShape::bar: return "bar";
    case RowShape::tube: return "tube";
    case RowShape::plane: return "plane";
  }
  return "";
}

}  // namespace meshgraft::test
