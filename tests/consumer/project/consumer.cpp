// Bends a sheet: its left edge stays, its right edge is a handle that goes up.
#include <cmath>
#include <cstdio>
#include <cstring>

#include <meshgraft/core/version.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>

int main() {
  using meshgraft::Index;
  constexpr Index columns = 12, rows = 6;
  meshgraft::Points rest(columns * rows, 3);
  meshgraft::Triangles triangles(2 * (columns - 1) * (rows - 1), 3);
  meshgraft::Region region{.whole = true};
  meshgraft::Handle handle{.name = "right edge"};
  Index face = 0;
  for (Index y = 0; y < rows; ++y)
    for (Index x = 0; x < columns; ++x) {
      const Index v = y * columns + x;
      rest.row(v) << x, y, 0.1 * std::sin(x + 2.0 * y);
      if (x < 2) region.fixed.push_back(v);
      if (x >= columns - 2) handle.vertices.push_back(v);
      if (x + 1 == columns || y + 1 == rows) continue;
      triangles.row(face++) << v, v + 1, v + columns + 1;
      triangles.row(face++) << v, v + columns + 1, v + columns;
    }
  region.handles.push_back(handle);

  const meshgraft::Deformer deformer(rest, triangles, region);
  meshgraft::HandlePose up;
  up.transform.translate(Eigen::Vector3d(0, 0, 3));
  const meshgraft::Points edited = deformer.evaluate({&up, 1});

  // This call needs everything that the library links, including the exact predicates where they are built
  // in.
  const meshgraft::Quality quality =
      meshgraft::measure_quality({rest, edited, triangles, deformer.free_vertices()});

  const double left = edited(0, 2) - rest(0, 2);
  const double middle = edited(columns / 2, 2) - rest(columns / 2, 2);
  const double right = edited(columns - 1, 2) - rest(columns - 1, 2);
  std::printf("meshgraft %s, %s: left %g, middle %g, right %g\n", MESHGRAFT_VERSION,
              std::string(name_of(deformer.summary().solver.backend)).c_str(), left, middle, right);
  const bool bent = left == 0 && middle > 0.5 && middle < 2.5 && std::abs(right - 3) < 1e-12;
  const bool whole = quality.flipped_faces == 0 && quality.new_self_intersections.value_or(0) == 0;
  return bent && whole && std::strcmp(MESHGRAFT_VERSION, PACKAGE_VERSION) == 0 ? 0 : 1;
}
