#include "support/surface_losses.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "mesh/area_vector.h"

namespace meshgraft::test {

namespace {

// Numbers positions, the same for equal ones.
class PositionNumbers {
 public:
  Index of(const Points& points, Index v) {
    const std::array<double, 3> point{points(v, 0), points(v, 1), points(v, 2)};
    return numbers_.try_emplace(point, static_cast<Index>(numbers_.size())).first->second;
  }

 private:
  std::map<std::array<double, 3>, Index> numbers_;
};

// Returns the numbers of a face's positions, ascending, each once; none if an index or a coordinate is invalid.
std::vector<Index> positions_of(const Mesh& mesh, Index face, PositionNumbers& numbers) {
  std::vector<Index> positions;
  for (const Index v : mesh.faces[face]) {
    if (v < 0 || v >= mesh.vertex_count() || !mesh.positions.row(v).allFinite()) return {};
    positions.push_back(numbers.of(mesh.positions, v));
  }
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  return positions;
}

}  // namespace

SurfaceLosses surface_losses(const Mesh& given, const Mesh& repaired) {
  PositionNumbers numbers;
  std::set<std::vector<Index>> faces;
  std::set<Index> positions;
  for (Index f = 0; f < repaired.face_count(); ++f) {
    const std::vector<Index> face = positions_of(repaired, f, numbers);
    positions.insert(face.begin(), face.end());
    faces.insert(face);
  }
  SurfaceLosses losses;
  double area = 0, lost = 0;
  std::set<Index> vertices;
  for (Index f = 0; f < given.face_count(); ++f) {
    const std::vector<Index> face = positions_of(given, f, numbers);
    if (face.size() < 3) continue;
    const double own = area_vector(given.faces[f], given.positions).norm() / 2;
    area += own;
    for (std::size_t k = 0; k < given.faces[f].size(); ++k) {
      const Index v = given.faces[f][k];
      if (!positions.contains(numbers.of(given.positions, v))) vertices.insert(v);
    }
    if (faces.contains(face)) continue;
    ++losses.faces;
    lost += own;
  }
  losses.vertices = static_cast<Index>(vertices.size());
  losses.area_rel = area > 0 ? lost / area : 0;
  return losses;
}

}  // namespace meshgraft::test
