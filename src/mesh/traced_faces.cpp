#include "traced_faces.h"

#include <array>

namespace meshgraft {

namespace {

Index corner_of(const Mesh& mesh, Index face, Index vertex) {
  Index c = mesh.faces.first_corner(face);
  while (mesh.faces.corners()[c] != vertex) ++c;
  return c;
}

}  // namespace

void TracedFaces::add(std::span<const Index> face, std::span<const EdgePoint> corners, Index origin) {
  faces.push_back(face);
  corner_origin.insert(corner_origin.end(), corners.begin(), corners.end());
  face_origin.push_back(origin);
}

TracedFaces triangulate_chosen(const Mesh& mesh, const std::function<bool(Index face)>& chosen,
                               const TriangulateOptions& options) {
  const Triangulation pieces = triangulate(mesh, options);
  TracedFaces result;
  std::size_t t = 0;
  std::vector<EdgePoint> corners;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const std::size_t first = t;
    while (t < pieces.face.size() && pieces.face[t] == f) ++t;
    corners.clear();
    if (mesh.faces[f].size() > 3 && chosen(f)) {
      for (std::size_t k = first; k < t; ++k) {
        const auto triangle = pieces.triangles.row(static_cast<Eigen::Index>(k));
        const std::array traced{same(corner_of(mesh, f, triangle[0])), same(corner_of(mesh, f, triangle[1])),
                                same(corner_of(mesh, f, triangle[2]))};
        result.add({triangle.data(), 3}, traced, f);
      }
    } else {
      for (Index c = mesh.faces.first_corner(f); c < mesh.faces.first_corner(f + 1); ++c)
        corners.push_back(same(c));
      result.add(mesh.faces[f], corners, f);
    }
  }
  return result;
}

}  // namespace meshgraft
