#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "merge/seam_patch.h"

#include "support/mesh_families.h"

/// Joined meshes as a seam makes them: the faces of a target, of a source, and of a strip between them.
namespace meshgraft::test {

struct SeamScene {
  std::string name;
  Mesh mesh;
  SeamLayout layout;
  Points smooth;  ///< positions without noise

  Index strip_begin() const { return layout.target_faces + layout.source_faces; }
  bool is_on_strip(Index v) const {
    for (Index f = strip_begin(); f < mesh.face_count(); ++f)
      for (const Index w : mesh.faces[f])
        if (w == v) return true;
    return false;
  }
};

/// Returns a surface of `rows` rows of vertices around z whose middle row of faces is the strip. `shape` takes
/// the height, −1 … 1, to the radius and z. `noise` moves vertices on the strip, and half as much those beside
/// it, along the radius, as a fraction of an edge.
template <class Shape>
SeamScene round_seam(const std::string& name, int around, int rows, double noise, const Shape& shape) {
  SeamScene scene{name, {}, {}, {}};
  const auto at = [&](int row, double k, double outward) {
    const auto [radius, z] = shape(2.0 * row / (rows - 1) - 1);
    const double angle = 2 * std::numbers::pi * (k + 0.5 * (row % 2)) / around;
    return Eigen::RowVector3d((radius + outward) * std::cos(angle), (radius + outward) * std::sin(angle), z);
  };
  scene.mesh.positions.resize(rows * around, 3);
  const int low = rows / 2 - 1;  // the strip is between this row and the next
  const double edge = 2 * std::numbers::pi / around;
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < around; ++k) {
      const double share = row == low || row == low + 1 ? 1 : row == low - 1 || row == low + 2 ? 0.5 : 0;
      scene.mesh.positions.row(row * around + k) =
          at(row, k, noise * share * edge * std::sin(2.3 * k + 5 * row));
    }
  const auto add_row = [&](int row) {
    for (int k = 0; k < around; ++k) {
      const int next = (k + 1) % around;
      const Index a = row * around + k, b = row * around + next, c = a + around, d = b + around;
      if (row % 2 == 0) {
        scene.mesh.faces.push_back(std::vector{a, b, c});
        scene.mesh.faces.push_back(std::vector{b, d, c});
      } else {
        scene.mesh.faces.push_back(std::vector{a, b, d});
        scene.mesh.faces.push_back(std::vector{a, d, c});
      }
    }
  };
  for (int row = 0; row < low; ++row) add_row(row);
  scene.layout.target_vertices = (low + 1) * around;
  scene.layout.target_faces = scene.mesh.face_count();
  for (int row = low + 1; row + 1 < rows; ++row) add_row(row);
  scene.layout.source_faces = scene.mesh.face_count() - scene.layout.target_faces;
  add_row(low);
  scene.smooth.resize(rows * around, 3);
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < around; ++k) scene.smooth.row(row * around + k) = at(row, k, 0);
  return scene;
}

/// Returns a tube, a sphere without its poles, a flat ring and a waist, with noise on the strip.
inline std::vector<SeamScene> seam_scenes(double noise) {
  using std::numbers::pi;
  const auto tube = [](double h) { return std::pair(1.0, 1.6 * h); };
  const auto sphere = [](double h) { return std::pair(std::cos(1.2 * h), std::sin(1.2 * h)); };
  const auto ring = [](double h) { return std::pair(2 - 1.2 * h, 0.0); };
  const auto waist = [](double h) { return std::pair(0.7 + 0.5 * h * h, 1.5 * h); };
  return {round_seam("tube", 16, 10, noise, tube), round_seam("sphere", 20, 12, noise, sphere),
          round_seam("flat ring", 24, 10, noise, ring), round_seam("waist", 14, 10, noise, waist)};
}

}  // namespace meshgraft::test
