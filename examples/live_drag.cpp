// Drags the right edge of a sheet while its set-up is still being made: a frame at once, an exact one at the
// end.
#include <cstdio>
#include <string>

#include <meshgraft/deform/live_deformer.h>

int main() {
  using namespace meshgraft;
  constexpr Index columns = 160, rows = 100;
  Points rest(columns * rows, 3);
  Triangles triangles(2 * (columns - 1) * (rows - 1), 3);
  Region region{.whole = true};
  Handle edge{.name = "right edge"};
  Index face = 0;
  for (Index v = 0; v < columns * rows; ++v) {
    const Index x = v % columns, y = v / columns;
    rest.row(v) << x, y, 0;
    if (x < 3) region.fixed.push_back(v);
    if (x >= columns - 3) edge.vertices.push_back(v);
    if (x + 1 == columns || y + 1 == rows) continue;
    triangles.row(face++) << v, v + 1, v + columns + 1;
    triangles.row(face++) << v, v + columns + 1, v + columns;
  }
  region.handles.push_back(edge);

  const auto show = [](const LiveFrame& frame) {
    std::printf("pose %d, %s, %.0f ms\n", static_cast<int>(frame.pose),
                std::string(to_string(frame.accuracy)).c_str(), 1e3 * frame.seconds);
  };
  LiveDeformer live({rest, triangles, region}, {.frame = show});
  for (int step = 1; step <= 20; ++step) {
    HandlePose lifted;
    lifted.transform.translate(Eigen::Vector3d(0, 0, step));
    live.drag({&lifted, 1});  // most of these are superseded before anything can be computed
  }
  live.wait_until_exact();
}
