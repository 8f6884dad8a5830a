#include "cgal_deformation.h"

#include <chrono>
#include <ctime>
#include <stdexcept>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

namespace meshgraft::bench {

namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;

double now(CgalClock clock) {
  if (clock == CgalClock::processor) return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
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
CgalResult run(const BenchEdit& edit, const CgalOptions& options) {
  SurfaceMesh mesh = make_surface_mesh(edit);

  const double start = now(options.clock);
  CGAL::Surface_mesh_deformation<SurfaceMesh, CGAL::Default, CGAL::Default, tag> deformation(mesh);
  deformation.set_sre_arap_alpha(options.sre_alpha);
  for (const auto v : mesh.vertices()) deformation.insert_roi_vertex(v);
  for (const Index v : edit.fixed) deformation.insert_control_vertex(SurfaceMesh::Vertex_index(v));
  for (const Index v : edit.handle) deformation.insert_control_vertex(SurfaceMesh::Vertex_index(v));
  const double constructed = now(options.clock);
  if (!deformation.preprocess()) throw std::runtime_error("CGAL's preprocess() failed");
  const double preprocessed = now(options.clock);
  for (const Index v : edit.handle) {
    const Eigen::Vector3d target = edit.pose * edit.positions.row(v).transpose();
    deformation.set_target_position(SurfaceMesh::Vertex_index(v), Point(target[0], target[1], target[2]));
  }
  const double targets_set = now(options.clock);
  deformation.deform(options.iterations, 0);
  const double deformed = now(options.clock);

  CgalResult result;
  result.times = {constructed - start, preprocessed - constructed, deformed - targets_set};
  result.positions.resize(edit.positions.rows(), 3);
  for (const auto v : mesh.vertices()) {
    const Point& p = mesh.point(v);
    result.positions.row(static_cast<Eigen::Index>(v)) << p[0], p[1], p[2];
  }
  return result;
}

}  // namespace

CgalResult run_cgal(const BenchEdit& edit, CgalMethod method, const CgalOptions& options) {
  switch (method) {
    case CgalMethod::original_arap: return run<CGAL::ORIGINAL_ARAP>(edit, options);
    case CgalMethod::spokes_and_rims: return run<CGAL::SPOKES_AND_RIMS>(edit, options);
    case CgalMethod::sre_arap: return run<CGAL::SRE_ARAP>(edit, options);
  }
  throw std::invalid_argument("unknown method");
}

}  // namespace meshgraft::bench
