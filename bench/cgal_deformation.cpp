#include "cgal_deformation.h"

#include <chrono>
#include <stdexcept>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

namespace meshgraft::bench {

namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

SurfaceMesh make_surface_mesh(const BenchEdit& edit) {
  SurfaceMesh mesh;
  mesh.reserve(edit.positions.rows(), edit.positions.rows() + edit.triangles.rows(), edit.triangles.rows());
  for (const auto& p : edit.positions.rowwise()) mesh.add_vertex(Point(p[0], p[1], p[2]));
  for (const auto& t : edit.triangles.rowwise()) {
    mesh.add_face(SurfaceMesh::Vertex_index(t[0]), SurfaceMesh::Vertex_index(t[1]),
                  SurfaceMesh::Vertex_index(t[2]));
  }
  return mesh;
}

template <CGAL::Deformation_algorithm_tag tag>
CgalResult run(const BenchEdit& edit, unsigned iterations) {
  SurfaceMesh mesh = make_surface_mesh(edit);

  const auto start = Clock::now();
  CGAL::Surface_mesh_deformation<SurfaceMesh, CGAL::Default, CGAL::Default, tag> deformation(mesh);
  for (const auto v : mesh.vertices()) deformation.insert_roi_vertex(v);
  for (const Index v : edit.fixed) deformation.insert_control_vertex(SurfaceMesh::Vertex_index(v));
  for (const Index v : edit.handle) deformation.insert_control_vertex(SurfaceMesh::Vertex_index(v));
  const auto constructed = Clock::now();
  if (!deformation.preprocess()) throw std::runtime_error("CGAL's preprocess() failed");
  const auto preprocessed = Clock::now();
  for (const Index v : edit.handle) {
    const Eigen::Vector3d target = edit.pose * edit.positions.row(v).transpose();
    deformation.set_target_position(SurfaceMesh::Vertex_index(v), Point(target[0], target[1], target[2]));
  }
  const auto targets_set = Clock::now();
  deformation.deform(iterations, 0);
  const auto deformed = Clock::now();

  CgalResult result;
  result.times = {seconds_between(start, constructed), seconds_between(constructed, preprocessed),
                  seconds_between(targets_set, deformed)};
  result.positions.resize(edit.positions.rows(), 3);
  for (const auto v : mesh.vertices()) {
    const Point& p = mesh.point(v);
    result.positions.row(static_cast<Eigen::Index>(v)) << p[0], p[1], p[2];
  }
  return result;
}

}  // namespace

CgalResult run_cgal(const BenchEdit& edit, CgalMethod method, unsigned iterations) {
  switch (method) {
    case CgalMethod::original_arap: return run<CGAL::ORIGINAL_ARAP>(edit, iterations);
    case CgalMethod::spokes_and_rims: return run<CGAL::SPOKES_AND_RIMS>(edit, iterations);
    case CgalMethod::sre_arap: return run<CGAL::SRE_ARAP>(edit, iterations);
  }
  throw std::invalid_argument("unknown method");
}

}  // namespace meshgraft::bench
