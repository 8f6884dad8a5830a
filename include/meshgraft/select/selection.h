#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// The mesh and connectivity against which selections are resolved. It is made once per mesh, and the mesh
/// must outlive it. For a welded mesh it takes the weld; selections then consist of representatives.
struct SelectionMesh {
  explicit SelectionMesh(const Mesh& mesh, Weld weld = {});
  /// Takes the connectivity of a mesh without weld, if it is known.
  SelectionMesh(const Mesh& mesh, Connectivity connectivity);
  const Mesh& mesh;
  Weld weld;
  IndexLists rings;                       ///< vertex rings over the polygons' edges
  std::vector<Index> components;          ///< per vertex: connected component, or -1 for isolated vertices
  std::vector<std::vector<Index>> loops;  ///< boundary loops in the order of `boundary_loops`
};

/// Operations on vertex sets, whose operands are described by `S`.
template <class S>
struct SelectionOperations {
  /// `of`, grown by `rings` rings of edges. A negative number removes the vertices within that many edges of
  /// a vertex outside `of`.
  struct Grow {
    std::shared_ptr<const S> of;
    int rings = 0;
  };
  /// `of` and the vertices within `length` of it along edges.
  struct GrowLength {
    std::shared_ptr<const S> of;
    double length = 0;
  };
  struct Union {
    std::vector<S> of;
  };
  /// The first selection without the others.
  struct Minus {
    std::vector<S> of;
  };
  struct Intersect {
    std::vector<S> of;
  };
  /// The vertices nearest to the mirror images of `of` in a plane. An image is dropped if its nearest vertex is
  /// farther than `tolerance_rel` × the diagonal of the mesh's bounding box.
  struct Mirror {
    std::shared_ptr<const S> of;
    Plane plane;
    double tolerance_rel = 1e-3;
  };
  /// The vertices of `of` within `rings` edges of a vertex outside it.
  struct Rim {
    std::shared_ptr<const S> of;
    int rings = 1;
  };
};

/// A description of a vertex set: by index, by geometry, by connectivity, or as a combination of others. It
/// resolves to distinct indices. `Indices`, `Loop` and `Path` keep their own order, because they may be a
/// curve; all others are ascending. Lengths and points are in model units.
class Selection {
 public:
  /// Every vertex.
  struct All {};
  /// These vertices, in this order; repeats are dropped.
  struct Indices {
    std::vector<Index> vertices;
  };
  /// min ≤ x ≤ max in every coordinate.
  struct Box {
    Eigen::Vector3d min, max;
  };
  /// |x − centre| ≤ radius.
  struct Sphere {
    Eigen::Vector3d centre;
    double radius = 0;
  };
  /// (x − point)·normal ≥ 0: the side of the plane that its normal points to, and the plane itself.
  struct HalfSpace {
    Plane plane;
  };
  /// A connected component, by its number from `connected_components`.
  struct Component {
    Index number = 0;
  };
  /// A boundary loop, by its number from `boundary_loops`, in the order of that loop.
  struct Loop {
    Index number = 0;
  };
  /// The vertex nearest to `point` among those that belong to a face; the smallest index among equals.
  struct NearestVertex {
    Eigen::Vector3d point;
  };
  /// Chain of edges through the vertices nearest to `points`, in order. Each leg is the shortest chain that
  /// touches no vertex of the other legs. With `closed` a leg also joins the last vertex to the first.
  /// Successive points with the same nearest vertex count once.
  struct Path {
    std::vector<Eigen::Vector3d> points;
    bool closed = false;
  };
  using Grow = SelectionOperations<Selection>::Grow;
  using GrowLength = SelectionOperations<Selection>::GrowLength;
  using Union = SelectionOperations<Selection>::Union;
  using Minus = SelectionOperations<Selection>::Minus;
  using Intersect = SelectionOperations<Selection>::Intersect;
  using Mirror = SelectionOperations<Selection>::Mirror;
  using Rim = SelectionOperations<Selection>::Rim;

  using Kind = std::variant<All, Indices, Box, Sphere, HalfSpace, Component, Loop, NearestVertex, Path, Grow,
                            GrowLength, Union, Minus, Intersect, Mirror, Rim>;
  Selection(Kind description) : kind(std::move(description)) {}
  Kind kind;
};

/// Returns the vertices of `selection`; there may be none. Throws Error(input) for an index, component or
/// loop that does not exist (core.no_such_vertex, select.no_such_component, select.no_such_loop), a malformed
/// shape, or points of a path that are not connected (select.no_way_along_edges). The error's location is
/// `location` (a field of the edit file) with the field inside it.
std::vector<Index> resolve(const Selection& selection, const SelectionMesh& context, const Location& location);

}  // namespace meshgraft
