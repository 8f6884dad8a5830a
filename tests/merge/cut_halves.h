#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/interpolate_attribute.h"

/// Meshes for grafts whose result is known: one surface in two pieces.
namespace meshgraft::test {

/// Returns the faces for which `is_in` holds, with their vertices in the same order and their attributes.
inline Mesh faces_where(const Mesh& mesh, const std::function<bool(Index)>& is_in) {
  std::vector<Index> local(static_cast<std::size_t>(mesh.vertex_count()), -1);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    for (const Index v : mesh.faces[f]) {
      if (is_in(f)) local[v] = 0;
    }
  }
  std::vector<EdgePoint> vertices, faces, corners;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (local[v] < 0) continue;
    local[v] = static_cast<Index>(vertices.size());
    vertices.push_back({v, v, 0});
  }
  Mesh part;
  part.positions.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    part.positions.row(static_cast<Eigen::Index>(k)) = mesh.positions.row(vertices[k].from);
  }
  std::vector<Index> face;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!is_in(f)) continue;
    face.clear();
    for (const Index v : mesh.faces[f]) face.push_back(local[v]);
    part.faces.push_back(face);
    faces.push_back({f, f, 0});
    for (Index c = mesh.faces.first_corner(f); c < mesh.faces.first_corner(f + 1); ++c)
      corners.push_back({c, c, 0});
  }
  for (const Attribute& attribute : mesh.attributes) {
    const auto& elements = attribute.domain == Domain::vertex ? vertices
                           : attribute.domain == Domain::face ? faces
                                                              : corners;
    part.attributes.push_back(interpolate_attribute(attribute, elements));
  }
  return part;
}

/// Returns the faces whose centroids lie on one side of a plane.
inline Mesh side_of_plane(const Mesh& mesh, const Eigen::RowVector3d& normal, double offset, bool above) {
  return faces_where(mesh, [&](Index f) {
    Eigen::RowVector3d centroid = Eigen::RowVector3d::Zero();
    for (const Index v : mesh.faces[f]) centroid += mesh.positions.row(v);
    return (centroid.dot(normal) / static_cast<double>(mesh.faces[f].size()) > offset) == above;
  });
}

/// Pairs the loops of two meshes that have the same points.
inline std::vector<LoopPair> coinciding_loops(const Mesh& target, const Mesh& source) {
  const auto key = [](const Mesh& mesh, const std::vector<Index>& loop) {
    std::vector<std::array<double, 3>> points;
    for (const Index v : loop)
      points.push_back({mesh.positions(v, 0), mesh.positions(v, 1), mesh.positions(v, 2)});
    return *std::min_element(points.begin(), points.end());
  };
  std::map<std::array<double, 3>, std::vector<Index>> of_source;
  for (const auto& loop : boundary_loops(source)) of_source[key(source, loop)] = loop;
  std::vector<LoopPair> pairs;
  for (const auto& loop : boundary_loops(target)) {
    const auto found = of_source.find(key(target, loop));
    if (found != of_source.end()) pairs.push_back({found->second, loop});
  }
  return pairs;
}

}  // namespace meshgraft::test
