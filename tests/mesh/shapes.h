#pragma once

#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

/// Tiny meshes for tests.
namespace meshgraft::shapes {

inline Mesh polygons(std::initializer_list<Eigen::Vector3d> points,
                     std::initializer_list<std::vector<Index>> faces) {
  Mesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::Index row = 0;
  for (const auto& point : points) mesh.positions.row(row++) = point.transpose();
  for (const auto& face : faces) mesh.faces.push_back(face);
  return mesh;
}

/// The unit cube of six quads, outward.
inline Mesh cube() {
  return polygons({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
                  {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
}

/// A sheet of columns × rows quads over two parameters. Each direction may be closed; `twist` reverses closed
/// columns.
struct Sheet {
  int columns = 4, rows = 3;
  bool close_columns = false, close_rows = false, twist = false, triangles = false;
};

inline Mesh sheet(const Sheet& s, const std::function<Eigen::Vector3d(double, double)>& place) {
  const int width = s.close_columns ? s.columns : s.columns + 1;
  const int height = s.close_rows ? s.rows : s.rows + 1;
  Mesh mesh;
  mesh.positions.resize(width * height, 3);
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      mesh.positions.row(r * width + c) = place(double(c) / s.columns, double(r) / s.rows).transpose();
    }
  }
  const auto vertex = [&](int c, int r) -> Index {
    if (c == width && s.twist) r = height - 1 - r;
    return (r % height) * width + c % width;
  };
  for (int r = 0; r < s.rows; ++r) {
    for (int c = 0; c < s.columns; ++c) {
      const Index a = vertex(c, r), b = vertex(c + 1, r), d = vertex(c + 1, r + 1), e = vertex(c, r + 1);
      if (s.triangles) {
        mesh.faces.push_back(std::vector{a, b, d});
        mesh.faces.push_back(std::vector{a, d, e});
      } else {
        mesh.faces.push_back(std::vector{a, b, d, e});
      }
    }
  }
  return mesh;
}

/// An open grid in the plane z = 0, `columns` × `rows` cells of size 1, facing +z.
inline Mesh grid(int columns, int rows, bool triangles = false) {
  return sheet({.columns = columns, .rows = rows, .triangles = triangles},
               [&](double u, double v) { return Eigen::Vector3d(u * columns, v * rows, 0); });
}

/// A tube about the z axis, radius 1, outward: loops at the bottom and at the top.
inline Mesh tube(int around, int along, bool triangles = false) {
  return sheet({.columns = around, .rows = along, .close_columns = true, .triangles = triangles},
               [&](double u, double v) {
                 const double a = 2 * std::numbers::pi * u;
                 return Eigen::Vector3d(std::cos(a), std::sin(a), v * along);
               });
}

inline Mesh torus(int around = 8, int across = 5, bool triangles = false) {
  return sheet(
      {.columns = around, .rows = across, .close_columns = true, .close_rows = true, .triangles = triangles},
      [](double u, double v) {
        const double a = 2 * std::numbers::pi * u, b = 2 * std::numbers::pi * v;
        const double r = 2 + std::cos(b);
        return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), std::sin(b));
      });
}

inline Mesh moebius_strip(int around = 9) {
  return sheet({.columns = around, .rows = 2, .close_columns = true, .twist = true}, [](double u, double v) {
    const double a = 2 * std::numbers::pi * u, w = v - 0.5, r = 2 + w * std::cos(a / 2);
    return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), w * std::sin(a / 2));
  });
}

/// Two triangles that share vertex 2 only.
inline Mesh bow_tie() {
  return polygons({{0, 0, 0}, {0, 2, 0}, {1, 1, 0}, {2, 0, 0}, {2, 2, 0}}, {{0, 2, 1}, {2, 3, 4}});
}

/// Three triangles on the edge 0–1.
inline Mesh three_on_an_edge() {
  return polygons({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
                  {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}});
}

/// Returns flat sheets (20×20 vertices) that meet in the line x = 0 … 1, at angles around it. With `turned` the
/// second is wound the other way.
inline Mesh sheets_at_a_line(const std::vector<double>& degrees, double noise = 0, bool turned = false) {
  constexpr int n = 20;
  Mesh mesh;
  mesh.positions.resize(n + static_cast<Index>(degrees.size()) * n * (n - 1), 3);
  const auto vertex = [&](std::size_t sheet, int row, int column) {
    return row == 0 ? column : n + (static_cast<Index>(sheet) * (n - 1) + row - 1) * n + column;
  };
  for (std::size_t sheet = 0; sheet < degrees.size(); ++sheet) {
    const double angle = degrees[sheet] * std::numbers::pi / 180;
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column) {
        const double r = static_cast<double>(row) / n, x = static_cast<double>(column) / (n - 1);
        mesh.positions.row(vertex(sheet, row, column)) << x, r * std::cos(angle), r * std::sin(angle);
        if (row == 0 || column == 0) continue;
        const Index a = vertex(sheet, row - 1, column - 1), b = vertex(sheet, row - 1, column),
                    c = vertex(sheet, row, column), d = vertex(sheet, row, column - 1);
        for (std::vector<Index> face : {std::vector<Index>{a, b, c}, {a, c, d}}) {
          if (turned && sheet == 1) std::swap(face[1], face[2]);
          mesh.faces.push_back(face);
        }
      }
  }
  std::minstd_rand generator(3);
  for (double& coordinate : mesh.positions.reshaped())
    coordinate += noise * (static_cast<double>(generator() % 2001) / 1000 - 1);
  return mesh;
}

/// Returns one mesh of all parts, in order.
inline Mesh together(std::initializer_list<Mesh> parts) {
  Mesh all;
  for (const Mesh& part : parts) {
    const Index shift = all.vertex_count();
    all.positions.conservativeResize(shift + part.vertex_count(), 3);
    all.positions.bottomRows(part.vertex_count()) = part.positions;
    for (Index f = 0; f < part.face_count(); ++f) {
      std::vector<Index> face(part.faces[f].begin(), part.faces[f].end());
      for (Index& v : face) v += shift;
      all.faces.push_back(face);
    }
  }
  return all;
}

inline Context with_threads(int threads) {
  Context context;
  context.threads = threads;
  return context;
}

inline void add_vertex(Mesh& mesh, const Eigen::Vector3d& point) {
  mesh.positions.conservativeResize(mesh.vertex_count() + 1, 3);
  mesh.positions.row(mesh.vertex_count() - 1) = point.transpose();
}

}  // namespace meshgraft::shapes
