#include "bench_edit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace meshgraft::bench {

namespace {

Points bumpy_sheet(Index side, std::mt19937_64& random) {
  const auto jitter = [&] { return 0.4 * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5); };
  Points points(static_cast<Eigen::Index>(side) * side, 3);
  for (Index row = 0; row < side; ++row) {
    for (Index column = 0; column < side; ++column) {
      const double x = (column + jitter()) / (side - 1), y = (row + jitter()) / (side - 1);
      const double z = 0.03 * std::sin(8 * std::numbers::pi * x) * std::sin(8 * std::numbers::pi * y);
      points.row(row * side + column) << x, y, z;
    }
  }
  return points;
}

Triangles irregular_triangles(Index side, std::mt19937_64& random) {
  Triangles triangles(2 * static_cast<Eigen::Index>(side - 1) * (side - 1), 3);
  Eigen::Index t = 0;
  for (Index row = 0; row + 1 < side; ++row) {
    for (Index column = 0; column + 1 < side; ++column) {
      const Index a = row * side + column, b = a + 1, c = b + side, d = a + side;
      if (random() & 1) {
        triangles.row(t++) << a, b, c;
        triangles.row(t++) << a, c, d;
      } else {
        triangles.row(t++) << a, b, d;
        triangles.row(t++) << b, c, d;
      }
    }
  }
  return triangles;
}

}  // namespace

BenchEdit make_bump_edit(Index vertex_count) {
  const auto side = static_cast<Index>(std::lround(std::sqrt(vertex_count)));
  std::mt19937_64 random(1);
  BenchEdit edit;
  edit.positions = bumpy_sheet(side, random);
  edit.triangles = irregular_triangles(side, random);
  const Eigen::Vector3d centre(0.5, 0.5, 0);
  for (Index v = 0; v < static_cast<Index>(edit.positions.rows()); ++v) {
    const Index row = v / side, column = v % side;
    if (std::min(row, column) < 2 || std::max(row, column) >= side - 2) {
      edit.fixed.push_back(v);
    } else if ((edit.positions.row(v).transpose() - centre).head<2>().norm() < 0.1) {
      edit.handle.push_back(v);
    }
  }
  edit.pose = Eigen::Translation3d(centre) * Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::UnitX()) *
              Eigen::Translation3d(-centre);
  return edit;
}

BenchEdit make_bend_edit(const Mesh& mesh) {
  BenchEdit edit;
  edit.positions = mesh.positions;
  edit.triangles = triangulate(mesh).triangles;
  const Eigen::RowVector3d low = edit.positions.colwise().minCoeff();
  const Eigen::RowVector3d size = edit.positions.colwise().maxCoeff() - low;
  int longest = 0;
  size.maxCoeff(&longest);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (Index v = 0; v < static_cast<Index>(edit.positions.rows()); ++v) {
    const double height = (edit.positions(v, longest) - low[longest]) / size[longest];
    if (height < 0.1) edit.fixed.push_back(v);
    if (height <= 0.9) continue;
    edit.handle.push_back(v);
    centre += edit.positions.row(v).transpose();
  }
  centre /= static_cast<double>(edit.handle.size());
  edit.pose = Eigen::Translation3d(centre) *
              Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::Unit((longest + 1) % 3)) *
              Eigen::Translation3d(-centre);
  return edit;
}

Region region_of(const BenchEdit& edit) {
  Region region;
  region.whole = true;
  region.fixed = edit.fixed;
  region.handles = {Handle{"disc", HandleShape::region, edit.handle}};
  return region;
}

}  // namespace meshgraft::bench
