#include "proxy_domain.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "core/parallel.h"
#include "deform/facts.h"
#include "deform/setup/ball_walk.h"

namespace meshgraft {

namespace {

struct Neighbourhood {
  Flags inside;  ///< per vertex of the mesh
  Index unknown = 0;
};

/// Returns the unknown vertices and the rings around them. The number of rings grows with the number of
/// unknown vertices.
Neighbourhood neighbourhood_of_unknown(const Triangles& triangles, const IndexLists& faces_at,
                                       const ConstraintMask& mask, int laplacian_order, Index wanted) {
  const Index n = faces_at.size();
  Neighbourhood neighbourhood{Flags(n, 0)};
  std::vector<Index> front;
  for (Index v = 0; v < n; ++v) {
    if (!mask.is_unknown(v) || faces_at[v].empty()) continue;
    neighbourhood.inside[v] = 1;
    ++neighbourhood.unknown;
    front.push_back(v);
  }
  // Covers as many rings as the proxy's rows need, counted in the proxy's edges.
  const double edges_per_edge = std::max(1.0, std::sqrt(static_cast<double>(neighbourhood.unknown) / wanted));
  const int rings = static_cast<int>(std::ceil((laplacian_order + 2) * edges_per_edge)) + 2;
  std::vector<Index> next;
  for (int ring = 0; ring < rings && !front.empty(); ++ring) {
    next.clear();
    for (const Index v : front)
      for (const Index t : faces_at[v])
        for (const Index w : triangles.row(t))
          if (!neighbourhood.inside[w]) {
            neighbourhood.inside[w] = 1;
            next.push_back(w);
          }
    front.swap(next);
  }
  return neighbourhood;
}

double unknown_area(const Points& rest, const Triangles& triangles, const ConstraintMask& mask) {
  double sum = 0;
  for (const auto& t : triangles.rowwise()) {
    if (std::none_of(t.begin(), t.end(), [&](Index v) { return mask.is_unknown(v); })) continue;
    const Eigen::RowVector3d u = rest.row(t[1]) - rest.row(t[0]), v = rest.row(t[2]) - rest.row(t[0]);
    sum += u.cross(v).norm() / 2;
  }
  return sum;
}

void take_points(const Points& rest, ProxyDomain& domain) {
  for (const Index v : domain.vertices)
    if (!rest.row(v).allFinite()) throw Error(facts::deform::VertexNotFinite{.vertex = v});
  Eigen::RowVector3d low = rest.row(domain.vertices.front()), high = low;
  for (const Index v : domain.vertices) {
    low = low.cwiseMin(rest.row(v));
    high = high.cwiseMax(rest.row(v));
  }
  domain.centre = low + (high - low) / 2;
  domain.points.resize(domain.size(), 3);
  for (Index i = 0; i < domain.size(); ++i) domain.points.row(i) = rest.row(domain.vertices[i]) - domain.centre;
}

/// Flags the handle boundaries: vertices with a holder and a neighbour with another holder or none.
Flags flag_boundary(const ProxyDomain& domain) {
  Flags boundary(domain.vertices.size(), 0);
  for (Index v = 0; v < domain.size(); ++v) {
    const auto ring = domain.rings[v];
    boundary[v] = domain.holder[v] >= 0 && std::any_of(ring.begin(), ring.end(), [&](Index w) {
                    return domain.holder[w] != domain.holder[v];
                  });
  }
  return boundary;
}

/// Returns up to four vertices that span about the extent of the given ones. They are the first vertex, the
/// farthest from it, then the farthest from the line and from the plane through those found.
std::vector<Index> extremes(const Points& points, const std::vector<Index>& vertices) {
  std::vector<Index> found{vertices.front()};
  const Eigen::RowVector3d origin = points.row(found.front());
  Eigen::Matrix3d across = Eigen::Matrix3d::Identity();  // projects out the directions found
  for (int direction = 0; direction < 3; ++direction) {
    Index farthest = -1;
    double length = 0;
    for (const Index v : vertices) {
      const double distance = ((points.row(v) - origin) * across).norm();
      if (distance > length) {
        length = distance;
        farthest = v;
      }
    }
    if (farthest < 0) break;
    const Eigen::RowVector3d unit = (points.row(farthest) - origin) * across / length;
    across -= across * unit.transpose() * unit;
    found.push_back(farthest);
  }
  return found;
}

/// Returns the connected sets of vertices that have the same holder.
std::vector<std::vector<Index>> held_pieces(const ProxyDomain& domain) {
  Flags seen(domain.vertices.size(), 0);
  std::vector<std::vector<Index>> pieces;
  for (Index start = 0; start < domain.size(); ++start) {
    if (domain.holder[start] < 0 || seen[start]) continue;
    std::vector<Index> piece{start};
    seen[start] = 1;
    for (std::size_t next = 0; next < piece.size(); ++next)
      for (const Index w : domain.rings[piece[next]])
        if (!seen[w] && domain.holder[w] == domain.holder[start]) {
          seen[w] = 1;
          piece.push_back(w);
        }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace

ProxyDomain make_proxy_domain(const Points& rest, const Triangles& triangles, const ConstraintMask& mask,
                              std::span<const Index> holder, int laplacian_order, Index wanted,
                              const Context& context) {
  const auto n = static_cast<Index>(rest.rows());
  ProxyDomain domain;
  std::vector<Index> local_index(n, -1);
  {
    const IndexLists faces_at = vertex_triangles(n, triangles, context);
    const Neighbourhood neighbourhood =
        neighbourhood_of_unknown(triangles, faces_at, mask, laplacian_order, wanted);
    domain.unknown_vertices = neighbourhood.unknown;
    if (neighbourhood.unknown == 0) return domain;
    for (Index v = 0; v < n; ++v) {
      if (!neighbourhood.inside[v]) continue;
      local_index[v] = domain.size();
      domain.vertices.push_back(v);
    }
  }
  take_points(rest, domain);
  std::vector<Index> corners;
  for (const auto& t : triangles.rowwise())
    if (std::all_of(t.begin(), t.end(), [&](Index v) { return local_index[v] >= 0; }))
      for (const Index v : t) corners.push_back(local_index[v]);
  domain.triangles =
      Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  corners = {};
  for (const Index v : domain.vertices) domain.holder.push_back(holder[v]);
  const IndexLists faces_at = vertex_triangles(domain.size(), domain.triangles, context);
  domain.rings = vertex_rings(domain.triangles, faces_at, context);
  domain.normals = vertex_normals(domain.points, domain.triangles, faces_at, context);
  constexpr double area_per_vertex = 0.866;  // of equilateral triangles with unit edges
  domain.spacing = std::sqrt(unknown_area(rest, triangles, mask) / (area_per_vertex * wanted));
  return domain;
}

Flags vertices_to_keep(const ProxyDomain& domain, bool all) {
  constexpr double apart = 0.7;  // of the spacing, so that few edges exceed the spacing
  Flags keep(domain.vertices.size(), 0);
  Flags boundary = flag_boundary(domain);
  if (all) return boundary;
  Flags settled(keep.size(), 0);
  BallWalk ball(domain.points, domain.rings);
  const auto keep_and_settle = [&](Index v) {
    keep[v] = 1;
    ball.from(v, apart * domain.spacing,
              [&](Index w, double) { settled[w] |= domain.holder[w] == domain.holder[v]; });
  };
  for (const std::vector<Index>& piece : held_pieces(domain)) {
    std::vector<Index> edge;
    for (const Index v : piece)
      if (boundary[v]) edge.push_back(v);
    if (edge.empty()) continue;
    for (const Index v : extremes(domain.points, edge)) keep_and_settle(v);
    for (const Index v : edge)
      if (!settled[v]) keep_and_settle(v);
  }
  return keep;
}

std::vector<double> influence_radii(const ProxyDomain& domain, const Decimated& proxy) {
  constexpr double beyond = 1.1;  // a margin, so that the weight is positive at the ends of a proxy's edges
  std::vector<double> radii(proxy.vertices.size(), 0);
  for (const auto& t : proxy.triangles.rowwise())
    for (int c = 0; c < 3; ++c) {
      const Index a = t[c], b = t[(c + 1) % 3], v = proxy.vertices[a], w = proxy.vertices[b];
      const auto ring = domain.rings[v];
      if (std::binary_search(ring.begin(), ring.end(), w)) continue;
      const double length = beyond * (domain.points.row(v) - domain.points.row(w)).norm();
      radii[a] = std::max(radii[a], length);
      radii[b] = std::max(radii[b], length);
    }
  return radii;
}

}  // namespace meshgraft
