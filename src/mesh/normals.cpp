#include <meshgraft/mesh/normals.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <meshgraft/core/error.h>

#include "area_vector.h"
#include "core/facts.h"
#include "core/parallel.h"
#include "face_defects.h"
#include "tangents.h"

namespace meshgraft {

namespace {

Eigen::Vector3d unit_or_zero(const Eigen::Vector3d& vector) {
  const double length = vector.stableNorm();
  return length > 0 && std::isfinite(length) ? Eigen::Vector3d(vector / length) : Eigen::Vector3d::Zero();
}

// Returns the rotation (det +1) that best maps a face's centred rest corners to the moved ones.
Eigen::Matrix3d face_rotation(std::span<const Index> face, const Points& rest, const Points& moved) {
  Eigen::Vector3d rest_centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d moved_centre = Eigen::Vector3d::Zero();
  for (const Index v : face) {
    rest_centre += (rest.row(v) - rest.row(face[0])).transpose();
    moved_centre += (moved.row(v) - moved.row(face[0])).transpose();
  }
  rest_centre /= static_cast<double>(face.size());
  moved_centre /= static_cast<double>(face.size());
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const Index v : face) {
    const Eigen::Vector3d p = (rest.row(v) - rest.row(face[0])).transpose() - rest_centre;
    const Eigen::Vector3d x = (moved.row(v) - moved.row(face[0])).transpose() - moved_centre;
    moment += x * p.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs[2] = -1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Flags moved_faces(const Mesh& mesh, const Points& rest) {
  Flags moved_vertex(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    moved_vertex[v] = (mesh.positions.row(v).array() != rest.row(v).array()).any();
  }
  Flags moved(mesh.face_count(), false);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!in_range(mesh.faces[f], mesh.vertex_count())) continue;
    for (const Index v : mesh.faces[f]) moved[f] = moved[f] || moved_vertex[v];
  }
  return moved;
}

Eigen::Map<Eigen::Vector3d> value_of(Attribute& attribute, Index element) {
  return Eigen::Map<Eigen::Vector3d>(attribute.values.data() + 3 * std::ptrdiff_t{element});
}

Points sum_area_vectors(const Faces& faces, const Points& positions) {
  Points sums = Points::Zero(positions.rows(), 3);
  for (Index f = 0; f < faces.size(); ++f) {
    if (!in_range(faces[f], static_cast<Index>(positions.rows()))) continue;
    const Eigen::Vector3d area = area_vector(faces[f], positions);
    for (const Index v : faces[f]) sums.row(v) += area.transpose();
  }
  return sums;
}

// Rotates each vertex normal as the faces around it rotate, weighted by their area. This keeps the weighting
// and the side of a file's own normals, and changes them little for a small move.
void update_vertex_normals(const Mesh& mesh, const Points& rest, const Flags& moved, Attribute& normals) {
  Points sums = Points::Zero(mesh.vertex_count(), 3);
  Flags touched(mesh.vertex_count(), false);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!in_range(mesh.faces[f], mesh.vertex_count())) continue;
    const double area = area_vector(mesh.faces[f], mesh.positions).stableNorm();
    const Eigen::Matrix3d rotation =
        moved[f] ? face_rotation(mesh.faces[f], rest, mesh.positions) : Eigen::Matrix3d::Identity();
    for (const Index v : mesh.faces[f]) {
      touched[v] = touched[v] || moved[f];
      sums.row(v) += area * (rotation * value_of(normals, v)).transpose();
    }
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    auto value = value_of(normals, v);
    const Eigen::Vector3d turned = unit_or_zero(sums.row(v).transpose());
    if (touched[v] && value.allFinite() && !turned.isZero(0)) value = turned;
  }
}

void update_face_normals(const Mesh& mesh, const Points& rest, const Flags& moved, Attribute& normals) {
  for (Index f = 0; f < mesh.face_count(); ++f) {
    auto value = value_of(normals, f);
    if (!moved[f] || !value.allFinite()) continue;
    const Eigen::Vector3d after = unit_or_zero(area_vector(mesh.faces[f], mesh.positions));
    if (after.isZero(0)) continue;
    const double side = value.dot(area_vector(mesh.faces[f], rest)) < 0 ? -1 : 1;
    value = side * after;
  }
}

// Corners of a vertex that share one normal form a smooth group, which keeps sharing one. The new normal is
// the area-weighted mean of the old normal rotated by each face of the group.
void update_corner_normals(const Mesh& mesh, const Points& rest, const Flags& moved, Attribute& normals) {
  std::vector<Index> face_of(mesh.faces.corner_count());
  IndexLists corners;  // per vertex
  corners.offsets.assign(static_cast<std::size_t>(mesh.vertex_count()) + 1, 0);
  Flags usable(mesh.face_count());
  for (Index f = 0; f < mesh.face_count(); ++f) {
    usable[f] = in_range(mesh.faces[f], mesh.vertex_count());
    for (std::size_t c = 0; c < mesh.faces[f].size(); ++c) {
      face_of[mesh.faces.first_corner(f) + static_cast<Index>(c)] = f;
      if (usable[f]) ++corners.offsets[mesh.faces[f][c] + 1];
    }
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v) corners.offsets[v + 1] += corners.offsets[v];
  corners.values.resize(corners.offsets.back());
  std::vector<Index> cursor(corners.offsets.begin(), corners.offsets.end() - 1);
  for (Index c = 0; c < mesh.faces.corner_count(); ++c) {
    if (usable[face_of[c]]) corners.values[cursor[mesh.faces.corners()[c]]++] = c;
  }

  std::vector<Eigen::Matrix3d> rotation(mesh.face_count(), Eigen::Matrix3d::Identity());
  std::vector<double> area(mesh.face_count(), 0);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!usable[f]) continue;
    area[f] = area_vector(mesh.faces[f], mesh.positions).stableNorm();
    if (moved[f]) rotation[f] = face_rotation(mesh.faces[f], rest, mesh.positions);
  }

  const Attribute old = normals;
  Flags done(mesh.faces.corner_count(), false);
  std::vector<Index> group;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    for (const Index first : corners[v]) {
      const Eigen::Vector3d normal =
          Eigen::Map<const Eigen::Vector3d>(old.values.data() + 3 * std::ptrdiff_t{first});
      if (done[first] || !normal.allFinite()) continue;
      group.clear();
      bool any_moved = false;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      Eigen::Vector3d plain = Eigen::Vector3d::Zero();  // unweighted sum, for a group of faces without area
      for (const Index c : corners[v]) {
        if (Eigen::Map<const Eigen::Vector3d>(old.values.data() + 3 * std::ptrdiff_t{c}) != normal) continue;
        done[c] = true;
        group.push_back(c);
        any_moved = any_moved || moved[face_of[c]];
        sum += area[face_of[c]] * (rotation[face_of[c]] * normal);
        plain += rotation[face_of[c]] * normal;
      }
      if (!any_moved) continue;
      const Eigen::Vector3d turned = unit_or_zero(sum.isZero(0) ? plain : sum);
      if (turned.isZero(0)) continue;
      for (const Index c : group) value_of(normals, c) = turned;
    }
  }
}

}  // namespace

Points vertex_normals(const Points& positions, const Triangles& triangles, const IndexLists& vertex_triangles,
                      const Context& context) {
  Points area(triangles.rows(), 3);
  const auto measure = [&](std::size_t begin, std::size_t end) {
    for (auto t = static_cast<Eigen::Index>(begin); t < static_cast<Eigen::Index>(end); ++t) {
      area.row(t) = area_vector({triangles.row(t).data(), 3}, positions).transpose();
    }
  };
  parallel_blocks(triangles.rows(), measure, context);

  Points normals(positions.rows(), 3);
  const auto gather = [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero(), size = Eigen::Vector3d::Zero();
      for (const Index t : vertex_triangles[v]) {
        sum += area.row(t).transpose();
        size += area.row(t).cwiseAbs().transpose();
      }
      // The sum of faces that lie back to back is zero but for rounding.
      constexpr double rounding = 1e-12;
      if ((sum.array().abs() <= rounding * size.maxCoeff()).all()) sum.setZero();
      normals.row(v) = unit_or_zero(sum).transpose();
    }
  };
  parallel_blocks(positions.rows(), gather, context);
  return normals;
}

Points vertex_normals(const Mesh& mesh) {
  Points normals = sum_area_vectors(mesh.faces, mesh.positions);
  for (Eigen::Index v = 0; v < normals.rows(); ++v) {
    normals.row(v) = unit_or_zero(normals.row(v).transpose()).transpose();
  }
  return normals;
}

void update_normals(Mesh& mesh, const Points& rest) {
  if (rest.rows() != mesh.positions.rows())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::rest_positions, .given = rest.rows(), .needed = mesh.positions.rows()});
  const bool has_directions = std::ranges::any_of(mesh.attributes, [](const Attribute& attribute) {
    return attribute.name == "normal" || attribute.name == "tangent";
  });
  if (!has_directions) return;
  const Flags moved = moved_faces(mesh, rest);
  for (Attribute& attribute : mesh.attributes) {
    if (attribute.name != "normal" || attribute.components != 3) continue;
    if (attribute.domain == Domain::vertex) update_vertex_normals(mesh, rest, moved, attribute);
    if (attribute.domain == Domain::face) update_face_normals(mesh, rest, moved, attribute);
    if (attribute.domain == Domain::corner) update_corner_normals(mesh, rest, moved, attribute);
  }
  update_tangents(mesh, rest, moved);
}

}  // namespace meshgraft
