#include <meshgraft/mesh/normals.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

Eigen::Matrix3d some_turn() {
  return Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
}

Points transformed(const Points& points, const Eigen::Matrix3d& linear, const Eigen::RowVector3d& shift) {
  return (points * linear.transpose()).rowwise() + shift;
}

Attribute normal_attribute(Domain domain, const std::vector<double>& values) {
  return {.name = "normal",
          .domain = domain,
          .interpolation = Interpolation::direction,
          .components = 3,
          .values = values};
}

std::vector<double> flattened(const Points& points) { return {points.data(), points.data() + points.size()}; }

// Returns corner normals: the face's own (hard) or the vertex's (smooth).
std::vector<double> corner_normals(const Mesh& mesh, bool smooth) {
  const Points of_vertices = vertex_normals(mesh);
  std::vector<double> values;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    const Eigen::Vector3d a = mesh.positions.row(face[1]) - mesh.positions.row(face[0]);
    const Eigen::Vector3d b = mesh.positions.row(face[2]) - mesh.positions.row(face[0]);
    const Eigen::Vector3d own = a.cross(b).normalized();
    for (const Index v : face) {
      const Eigen::Vector3d n = smooth ? Eigen::Vector3d(of_vertices.row(v)) : own;
      values.insert(values.end(), {n.x(), n.y(), n.z()});
    }
  }
  return values;
}

TEST(VertexNormals, OfACubePointFromItsCentre) {
  const Mesh cube = shapes::cube();
  const Points normals = vertex_normals(cube);
  for (Index v = 0; v < 8; ++v) {
    const Eigen::RowVector3d expected = (cube.positions.row(v).array() - 0.5).matrix().normalized();
    EXPECT_LT((normals.row(v) - expected).norm(), 1e-15);
  }
}

TEST(VertexNormals, AgreeForPolygonsAndTriangles) {
  for (const Mesh& mesh : {shapes::grid(4, 3), shapes::torus(9, 7, true)}) {
    const Triangles triangles = triangulate(mesh).triangles;
    const Points normals =
        vertex_normals(mesh.positions, triangles, vertex_triangles(mesh.vertex_count(), triangles));
    EXPECT_LT((normals - vertex_normals(mesh)).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((normals.rowwise().norm().array() - 1).abs().maxCoeff(), 1e-14);
  }
}

TEST(VertexNormals, FollowASimilarityAtAnyScale) {
  const Mesh torus = shapes::torus(12, 9, true);
  const Points before = vertex_normals(torus);
  for (const double scale : {1e-9, 1.0, 1e9}) {
    Mesh moved = torus;
    moved.positions = transformed(torus.positions, scale * some_turn(), Eigen::RowVector3d(3, -7, 1) * scale);
    const Points expected = before * some_turn().transpose();
    EXPECT_LT((vertex_normals(moved) - expected).cwiseAbs().maxCoeff(), 1e-13) << scale;
  }
}

TEST(VertexNormals, AreZeroWhereNothingHasArea) {
  Mesh mesh = shapes::polygons({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {9, 9, 9}},
                               {{0, 1, 2}, {3, 4, 5}});
  const Points normals = vertex_normals(mesh);
  for (const Index v : {0, 1, 2, 6}) EXPECT_EQ(normals.row(v).norm(), 0);
  EXPECT_EQ(normals.row(3), Eigen::RowVector3d(0, 0, 1));
}

TEST(VertexNormals, AreZeroOnSheetsOfTwoSidesInAnyPose) {
  const test::TestMesh sheet = test::irregular_grid(9, 7);
  const Index faces = static_cast<Index>(sheet.triangles.rows());
  Triangles both(2 * faces, 3);
  both.topRows(faces) = sheet.triangles;
  both.bottomRows(faces) = sheet.triangles.rowwise().reverse();
  for (const double scale : {1e-9, 1.0, 1e9}) {
    const Points posed =
        transformed(sheet.positions, scale * some_turn(), scale * Eigen::RowVector3d(3, 1, -2));
    const auto count = static_cast<Index>(posed.rows());
    EXPECT_TRUE(vertex_normals(posed, both, vertex_triangles(count, both)).isZero(0)) << scale;
    const Points one_side = vertex_normals(posed, sheet.triangles, vertex_triangles(count, sheet.triangles));
    EXPECT_TRUE((one_side.rowwise().norm().array() > 0.999).all()) << scale;
  }
}

TEST(VertexNormals, DoNotDependOnTheNumberOfThreads) {
  const Mesh torus = shapes::torus(61, 47, true);
  const Triangles triangles = triangulate(torus).triangles;
  const IndexLists lists = vertex_triangles(torus.vertex_count(), triangles);
  EXPECT_EQ(vertex_normals(torus.positions, triangles, lists, shapes::with_threads(1)),
            vertex_normals(torus.positions, triangles, lists, shapes::with_threads(2)));
}

TEST(UpdateNormals, TurnsEverythingWithARigidMotion) {
  for (const Mesh& shape : {shapes::cube(), shapes::torus(), shapes::tube(7, 3)}) {
    for (const bool smooth : {false, true}) {
      Mesh mesh = shape;
      mesh.attributes.push_back(normal_attribute(Domain::vertex, flattened(vertex_normals(mesh))));
      mesh.attributes.push_back(normal_attribute(Domain::corner, corner_normals(mesh, smooth)));
      const std::vector<Attribute> before = mesh.attributes;
      const Points rest = mesh.positions;
      mesh.positions = transformed(rest, some_turn(), {3, 1, 4});
      update_normals(mesh, rest);
      for (std::size_t k = 0; k < before.size(); ++k) {
        for (std::size_t e = 0; e < before[k].values.size(); e += 3) {
          const Eigen::Vector3d expected =
              some_turn() * Eigen::Map<const Eigen::Vector3d>(&before[k].values[e]);
          EXPECT_LT((Eigen::Map<const Eigen::Vector3d>(&mesh.attributes[k].values[e]) - expected).norm(),
                    1e-12);
        }
      }
    }
  }
}

TEST(UpdateNormals, KeepsTheBytesWhereNothingMoved) {
  Mesh mesh = shapes::grid(6, 1);
  // The file's normals are neither unit nor near the geometry's, and must stay all the same.
  std::vector<double> values(3 * static_cast<std::size_t>(mesh.vertex_count()), 0.3);
  std::vector<double> corner_values(3 * static_cast<std::size_t>(mesh.faces.corner_count()), -0.7);
  mesh.attributes = {normal_attribute(Domain::vertex, values), normal_attribute(Domain::corner, corner_values)};
  const Points rest = mesh.positions;
  mesh.positions(6, 2) = 1;  // the last vertex of the lower row: only face 5 moves
  update_normals(mesh, rest);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const bool touched = v % 7 >= 5;
    const bool same = std::memcmp(&values[3 * v], &mesh.attributes[0].values[3 * v], 3 * sizeof(double)) == 0;
    EXPECT_EQ(same, !touched) << "vertex " << v;
  }
  for (Index f = 0; f < 6; ++f) {
    for (Index c = 4 * f; c < 4 * f + 4; ++c) {
      const bool touched = mesh.faces.corners()[c] % 7 >= 5;  // smooth groups reach into face 4
      const bool same =
          std::memcmp(&corner_values[3 * c], &mesh.attributes[1].values[3 * c], 3 * sizeof(double)) == 0;
      EXPECT_EQ(same, !touched) << "corner " << c;
    }
  }
}

TEST(UpdateNormals, KeepsHardEdgesHardAndSmoothOnesSmooth) {
  Mesh mesh = shapes::torus(8, 6);
  const Points rest = mesh.positions;
  for (const bool smooth : {false, true}) {
    mesh.positions = rest;
    mesh.attributes = {normal_attribute(Domain::corner, corner_normals(mesh, smooth))};
    for (Index v = 0; v < mesh.vertex_count(); ++v) {  // bends the mesh, so every face turns differently
      const double a = 0.2 * rest(v, 2), r = 5 + rest(v, 0);
      mesh.positions.row(v) << r * std::cos(a) - 5, rest(v, 1), r * std::sin(a);
    }
    update_normals(mesh, rest);
    const std::vector<double>& values = mesh.attributes[0].values;
    for (Index c = 0; c < mesh.faces.corner_count(); ++c) {
      const Eigen::Map<const Eigen::Vector3d> n(&values[3 * c]);
      EXPECT_NEAR(n.norm(), 1, 1e-14);
      for (Index d = 0; d < c; ++d) {
        if (mesh.faces.corners()[c] != mesh.faces.corners()[d]) continue;
        const bool equal = std::memcmp(&values[3 * c], &values[3 * d], 3 * sizeof(double)) == 0;
        EXPECT_EQ(equal, smooth);
      }
    }
  }
}

TEST(UpdateNormals, KeepsTheSideAndLeavesMissingValuesOut) {
  Mesh mesh = shapes::cube();
  std::vector<double> inward = flattened(-vertex_normals(mesh));
  inward[0] = inward[1] = inward[2] = std::nan("");
  mesh.attributes = {normal_attribute(Domain::vertex, inward)};
  const Points rest = mesh.positions;
  mesh.positions = transformed(rest, some_turn(), {0, 0, 0});
  update_normals(mesh, rest);
  EXPECT_TRUE(std::isnan(mesh.attributes[0].values[0]));
  for (Index v = 1; v < 8; ++v) {
    const Eigen::Vector3d expected = some_turn() * Eigen::Map<const Eigen::Vector3d>(&inward[3 * v]);
    EXPECT_LT((Eigen::Map<const Eigen::Vector3d>(&mesh.attributes[0].values[3 * v]) - expected).norm(), 1e-13);
  }
}

TEST(UpdateNormals, RecomputesNormalsOfFacesOnTheirSide) {
  Mesh mesh = shapes::cube();
  mesh.attributes.push_back({.name = "normal", .domain = Domain::face, .components = 3});
  for (Index f = 0; f < mesh.face_count(); ++f) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const Index v : mesh.faces[f])
      normal += mesh.positions.row(v).transpose() - Eigen::Vector3d::Constant(0.5);
    normal.normalize();
    if (f == 1) normal = -normal;  // one normal of the file is reversed
    mesh.attributes.back().values.insert(mesh.attributes.back().values.end(), normal.data(), normal.data() + 3);
  }
  const Points rest = mesh.positions;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const std::vector<double> before = mesh.attributes.back().values;
  mesh.positions = rest * turn.transpose();
  update_normals(mesh, rest);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Eigen::Map<const Eigen::Vector3d> old(before.data() + 3 * f),
        now(mesh.attributes.back().values.data() + 3 * f);
    EXPECT_LT((now - turn * old).norm(), 1e-12) << "face " << f;
  }
}

TEST(UpdateNormals, RefusesRestPositionsOfAnotherMesh) {
  Mesh mesh = shapes::cube();
  EXPECT_THROW(update_normals(mesh, Points::Zero(7, 3)), Error);
}

// Returns tangents along each face's first edge; the sign of the bitangent alternates between faces.
Attribute face_tangents(const Mesh& mesh) {
  Attribute tangents{.name = "tangent", .domain = Domain::corner, .components = 4, .values = {}};
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    const Eigen::Vector3d t = (mesh.positions.row(face[1]) - mesh.positions.row(face[0])).normalized();
    for (std::size_t k = 0; k < face.size(); ++k)
      tangents.values.insert(tangents.values.end(), {t[0], t[1], t[2], f % 2 == 0 ? 1.0 : -1.0});
  }
  return tangents;
}

TEST(UpdateTangents, TurnWithTheSurface) {
  Mesh mesh = shapes::cube();
  mesh.attributes.push_back(normal_attribute(Domain::corner, corner_normals(mesh, true)));
  mesh.attributes.push_back(face_tangents(mesh));
  const Points rest = mesh.positions;
  const std::vector<double> before = mesh.attributes[1].values;
  // Tangents become perpendicular to the smooth normals, as exporters write them.
  mesh.positions = transformed(rest, some_turn(), {1, 2, 3});
  update_normals(mesh, rest);
  const std::vector<double>& normals = mesh.attributes[0].values;
  for (std::size_t c = 0; c < before.size() / 4; ++c) {
    const Eigen::Vector3d n(normals[3 * c], normals[3 * c + 1], normals[3 * c + 2]);
    Eigen::Vector3d expected =
        some_turn() * Eigen::Vector3d(before[4 * c], before[4 * c + 1], before[4 * c + 2]);
    expected = (expected - n * n.dot(expected)).normalized();
    const Eigen::Vector3d t(&mesh.attributes[1].values[4 * c]);
    EXPECT_LT((t - expected).norm(), 1e-12);
    EXPECT_EQ(mesh.attributes[1].values[4 * c + 3], before[4 * c + 3]);
  }
}

TEST(UpdateTangents, AreCarriedByAffineMaps) {
  Mesh mesh = shapes::cube();
  mesh.attributes.push_back(normal_attribute(Domain::corner, corner_normals(mesh, false)));
  mesh.attributes.push_back(face_tangents(mesh));
  const Points rest = mesh.positions;
  Eigen::Matrix3d linear;
  linear << 1.5, 0.3, 0, -0.2, 0.7, 0.1, 0.4, 0, 1.1;
  mesh.positions = transformed(rest, linear, {0, 0, 1});
  update_normals(mesh, rest);
  const std::vector<double> expected = face_tangents(mesh).values;  // tangents stay along the edges
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(mesh.attributes[1].values[i], expected[i], 1e-9);
}

TEST(UpdateTangents, KeepTheirBytesWhereNothingMoved) {
  Mesh mesh = shapes::cube();
  mesh.attributes.push_back(face_tangents(mesh));
  const std::vector<double> before = mesh.attributes[0].values;
  const Points rest = mesh.positions;
  mesh.positions.row(0) *= 1.25;
  update_normals(mesh, rest);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    for (std::size_t k = 0; k < mesh.faces[f].size(); ++k) {
      const Index v = mesh.faces[f][k];
      bool near_move = false;
      for (Index g = 0; g < mesh.face_count(); ++g) {
        const auto face = mesh.faces[g];
        const bool has_v = std::find(face.begin(), face.end(), v) != face.end();
        near_move = near_move || (has_v && std::find(face.begin(), face.end(), 0) != face.end());
      }
      if (near_move) continue;
      const std::size_t c = static_cast<std::size_t>(mesh.faces.first_corner(f)) + k;
      EXPECT_EQ(std::memcmp(&mesh.attributes[0].values[4 * c], &before[4 * c], 32), 0);
    }
  }
}

}  // namespace
}  // namespace meshgraft
