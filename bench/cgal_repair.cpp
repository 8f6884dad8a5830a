#include "cgal_repair.h"

#include <iterator>
#include <map>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/merge_border_vertices.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

namespace meshgraft::bench {

namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;
using Halfedge = Surface::Halfedge_index;
using Face = Surface::Face_index;

double fan_area(const std::vector<Point>& loop) {
  Kernel::Vector_3 sum(0, 0, 0);
  for (const Point& p : loop) sum = sum + (p - CGAL::ORIGIN);
  const Point centre = CGAL::ORIGIN + sum / static_cast<double>(loop.size());
  double area = 0;
  for (std::size_t k = 0; k < loop.size(); ++k)
    area += std::sqrt(CGAL::squared_area(centre, loop[k], loop[(k + 1) % loop.size()]));
  return area;
}

Index close_small_holes(Surface& mesh) {
  constexpr std::size_t most_edges = 24;
  constexpr double most_area_rel = 0.005;
  auto component = mesh.add_property_map<Face, std::size_t>("f:component", 0).first;
  PMP::connected_components(mesh, component);
  std::map<std::size_t, double> area;
  for (const Face f : mesh.faces()) area[component[f]] += PMP::face_area(f, mesh);
  std::vector<Halfedge> cycles;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(cycles));
  Index closed = 0;
  for (const Halfedge border : cycles) {
    std::vector<Point> loop;
    for (const Halfedge h : CGAL::halfedges_around_face(border, mesh))
      loop.push_back(mesh.point(mesh.target(h)));
    const double around = area[component[mesh.face(mesh.opposite(border))]];
    if (loop.size() > most_edges || fan_area(loop) > most_area_rel * around) continue;
    std::vector<Face> faces;
    PMP::triangulate_hole(mesh, border, std::back_inserter(faces));
    closed += !faces.empty();
  }
  return closed;
}

}  // namespace

struct CgalRepair::Data {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
  Surface mesh;
  Index closed_holes = 0;
};

CgalRepair::CgalRepair(const Mesh& mesh) : data_(std::make_shared<Data>()) {
  for (const auto& p : mesh.positions.rowwise()) data_->points.emplace_back(p[0], p[1], p[2]);
  for (Index f = 0; f < mesh.face_count(); ++f)
    data_->polygons.emplace_back(mesh.faces[f].begin(), mesh.faces[f].end());
}

void CgalRepair::run() {
  std::vector<Point> points = data_->points;
  std::vector<std::vector<std::size_t>> polygons = data_->polygons;
  PMP::repair_polygon_soup(points, polygons);
  PMP::orient_polygon_soup(points, polygons);
  Surface& mesh = data_->mesh;
  mesh.clear();
  PMP::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  PMP::stitch_borders(mesh);
  PMP::merge_duplicated_vertices_in_boundary_cycles(mesh);
  if (!CGAL::is_triangle_mesh(mesh)) PMP::triangulate_faces(mesh);
  PMP::remove_connected_components_of_negligible_size(mesh);
  data_->closed_holes = close_small_holes(mesh);
  if (CGAL::is_closed(mesh)) PMP::orient_to_bound_a_volume(mesh);
  PMP::remove_isolated_vertices(mesh);
  mesh.collect_garbage();
}

Mesh CgalRepair::mesh() const {
  const Surface& surface = data_->mesh;
  Mesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(surface.number_of_vertices()), 3);
  for (const auto v : surface.vertices())
    for (int k = 0; k < 3; ++k) mesh.positions(static_cast<Eigen::Index>(v.idx()), k) = surface.point(v)[k];
  for (const Face f : surface.faces()) {
    std::vector<Index> face;
    for (const auto v : CGAL::vertices_around_face(surface.halfedge(f), surface))
      face.push_back(static_cast<Index>(v.idx()));
    mesh.faces.push_back(face);
  }
  return mesh;
}

Index CgalRepair::closed_holes() const { return data_->closed_holes; }

}  // namespace meshgraft::bench
