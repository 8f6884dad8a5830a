#include "proxy_relaxation.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

#include "delaunay_flips.h"

namespace meshgraft {

namespace {

Points places(const FineSurface& surface, const std::vector<Index>& vertices) {
  Points result(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k)
    result.row(static_cast<Eigen::Index>(k)) = surface.points.row(vertices[k]);
  return result;
}

/// Flags the coarse vertices that define the outline: on a boundary, at non-manifold vertices and along sharp
/// edges.
Flags flag_outline(const FineSurface& surface, const Decimated& coarse, const IndexLists& rings) {
  constexpr double sharp_cosine = 0.7;  // about 45° away from the mean normal
  const Points points = places(surface, coarse.vertices);
  std::vector<Index> faces(coarse.vertices.size(), 0);
  Points face_normals(coarse.triangles.rows(), 3), normals = Points::Zero(points.rows(), 3);
  for (Eigen::Index t = 0; t < coarse.triangles.rows(); ++t) {
    const auto corners = coarse.triangles.row(t);
    const Eigen::RowVector3d u = points.row(corners[1]) - points.row(corners[0]),
                             v = points.row(corners[2]) - points.row(corners[0]);
    face_normals.row(t) = u.cross(v).normalized();
    for (const Index k : corners) {
      ++faces[k];
      normals.row(k) += u.cross(v);
    }
  }
  Flags outline(faces.size(), 0);
  for (Index k = 0; k < rings.size(); ++k) outline[k] = faces[k] != static_cast<Index>(rings[k].size());
  for (Eigen::Index t = 0; t < coarse.triangles.rows(); ++t)
    for (const Index k : coarse.triangles.row(t))
      outline[k] |= face_normals.row(t).dot(normals.row(k)) < sharp_cosine * normals.row(k).norm();
  return outline;
}

class EvenOut {
 public:
  EvenOut(const FineSurface& surface, Decimated& coarse) : surface_(surface), coarse_(coarse) {
    taken_.assign(surface.points.rows(), 0);
    for (const Index v : coarse.vertices) taken_[v] = 1;
  }

  void round(const Context& context) {
    const IndexLists rings =
        vertex_rings(static_cast<Index>(coarse_.vertices.size()), coarse_.triangles, context);
    const Flags outline = flag_outline(surface_, coarse_, rings);
    for (Index k = 0; k < rings.size(); ++k) {
      if (outline[k] || surface_.locked[coarse_.vertices[k]]) continue;
      Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
      for (const Index j : rings[k]) middle += surface_.points.row(coarse_.vertices[j]);
      step_towards(coarse_.vertices[k], middle / static_cast<double>(rings[k].size()));
    }
    flip_to_delaunay(places(surface_, coarse_.vertices), coarse_.triangles);
  }

 private:
  /// Moves a vertex along edges of the surface while that brings it nearer to `middle`.
  void step_towards(Index& vertex, const Eigen::RowVector3d& middle) {
    const auto distance = [&](Index v) { return (surface_.points.row(v) - middle).squaredNorm(); };
    taken_[vertex] = 0;
    double nearest = distance(vertex);
    for (bool stepped = true; stepped;) {
      stepped = false;
      for (const Index w : surface_.rings[vertex]) {
        if (taken_[w] || surface_.group[w] != surface_.group[vertex] || !(distance(w) < nearest)) continue;
        nearest = distance(w);
        vertex = w;
        stepped = true;
        break;
      }
    }
    taken_[vertex] = 1;
  }

  const FineSurface& surface_;
  Decimated& coarse_;
  Flags taken_;
};

void sort_vertices(Decimated& coarse) {
  std::vector<Index> order(coarse.vertices.size()), inverse_permutation(order.size()), sorted(order.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return coarse.vertices[a] < coarse.vertices[b]; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    inverse_permutation[order[k]] = static_cast<Index>(k);
    sorted[k] = coarse.vertices[order[k]];
  }
  coarse.vertices = std::move(sorted);
  for (Index& k : coarse.triangles.reshaped()) k = inverse_permutation[k];
}

}  // namespace

void relax_proxy(const FineSurface& surface, Decimated& coarse, int rounds, const Context& context) {
  flip_to_delaunay(places(surface, coarse.vertices), coarse.triangles);
  EvenOut state(surface, coarse);
  for (int round = 0; round < rounds; ++round) state.round(context);
  sort_vertices(coarse);
}

}  // namespace meshgraft
