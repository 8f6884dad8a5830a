#pragma once

#include <memory>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::bench {

/// The repair of a polygon soup as CGAL's manual describes it: repair_polygon_soup, orient_polygon_soup,
/// polygon_soup_to_polygon_mesh, stitch_borders, merge_duplicated_vertices_in_boundary_cycles,
/// remove_connected_components_of_negligible_size, triangulate_hole and orient_to_bound_a_volume. CGAL has no
/// limit for holes: those of up to 24 edges and 0.5 % of their component's area are closed, as `repair` does.
class CgalRepair {
 public:
  explicit CgalRepair(const Mesh& mesh);

  /// Repairs the soup from the beginning.
  void run();
  /// Returns the repaired surface of the last run.
  Mesh mesh() const;
  Index closed_holes() const;

 private:
  struct Data;
  std::shared_ptr<Data> data_;
};

}  // namespace meshgraft::bench
