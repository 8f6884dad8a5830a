#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/mesh/weld.h>

namespace meshgraft {

/// What a selection is resolved against; made once per mesh, which must outlive it. For a welded mesh with its
/// weld: selections then name representatives.
struct SelectionContext {
  explicit SelectionContext(const Mesh& mesh, Weld weld = {});
  const Mesh& mesh;
  Weld weld;
  IndexLists rings;                       ///< over the polygons' edges
  std::vector<Index> components;          ///< per vertex, -1 for isolated ones
  std::vector<std::vector<Index>> loops;  ///< boundary loops as `boundary_loops` orders them
};

/// A description of a vertex set: by index, by geometry, by connectivity, or by combining others. Resolves to
/// distinct indices: `Indices`, `Loop` and `Path` in their own order, for they may be a curve; all others
/// ascending. Lengths and points are in model units.
class Selection {
 public:
  /// Every vertex.
  struct All {};
  /// These vertices; one that comes again is dropped.
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
  /// (x − point)·normal ≥ 0; the normal need not have unit length.
  struct HalfSpace {
    Eigen::Vector3d point, normal;
  };
  /// A connected component as `connected_components` numbers them.
  struct Component {
    Index number = 0;
  };
  /// A boundary loop as `boundary_loops` numbers them, in its order.
  struct Loop {
    Index number = 0;
  };
  /// The vertex of a face that is nearest to `point`; the smallest index among equals.
  struct NearestVertex {
    Eigen::Vector3d point;
  };
  /// Edges that join the vertices nearest to `points`, in order, each leg by the shortest way that touches no
  /// vertex of the others; with `closed` also the last to the first. Successive points that have the same
  /// nearest vertex count once.
  struct Path {
    std::vector<Eigen::Vector3d> points;
    bool closed = false;
  };
  /// Grown by rings of edges; a negative number takes as many rings away from the outside.
  struct Grow {
    std::shared_ptr<const Selection> of;
    int rings = 0;
  };
  /// Grown by a length along edges.
  struct GrowLength {
    std::shared_ptr<const Selection> of;
    double length = 0;
  };
  struct Union {
    std::vector<Selection> of;
  };
  /// The first without the others.
  struct Minus {
    std::vector<Selection> of;
  };
  struct Intersect {
    std::vector<Selection> of;
  };
  /// The vertices nearest to the images behind a mirror, where one lies within `tolerance_rel` × the diagonal
  /// of the mesh's bounding box.
  struct Mirror {
    std::shared_ptr<const Selection> of;
    Eigen::Vector3d point, normal;
    double tolerance_rel = 1e-3;
  };
  /// Its vertices within `rings` edges of the outside.
  struct Rim {
    std::shared_ptr<const Selection> of;
    int rings = 1;
  };

  using Kind = std::variant<All, Indices, Box, Sphere, HalfSpace, Component, Loop, NearestVertex, Path, Grow,
                            GrowLength, Union, Minus, Intersect, Mirror, Rim>;
  Selection(Kind description) : kind(std::move(description)) {}  // NOLINT(google-explicit-constructor)
  Kind kind;
};

/// The vertices that `selection` means; may be none. Throws Error(input), naming `location` (a field of the
/// edit file) and the part of it, for an index, component or loop that does not exist, a malformed shape, or
/// points of a path that are not connected.
std::vector<Index> resolve(const Selection& selection, const SelectionContext& context,
                           const std::string& location);

/// The `.sel` file of the field's standard tests: 0 fixed, 1 free, 2 handle, one number per vertex.
struct SelFile {
  std::vector<Index> fixed, free, handle;
};

/// Text of a `.sel` file; `#` starts a comment. Throws Error(input) with `location` and the line for anything
/// but 0, 1 or 2 and for a count that differs from the mesh's.
SelFile parse_sel(std::string_view text, Index vertex_count, const std::string& location);

/// Text of vertex indices (from 0), separated by white space, in their order; `#` starts a comment, an index
/// that comes again is dropped. Throws Error(input) with `location` and the line for anything else and for an
/// index out of range.
std::vector<Index> parse_indices(std::string_view text, Index vertex_count, const std::string& location);

/// A `.def` file: an affine 4×4 matrix as 16 numbers, row by row; `#` starts a comment. Throws Error(input)
/// with `location` and the line for anything else, for a number that is not finite, and for a last row other
/// than 0 0 0 1.
Eigen::Matrix4d parse_def(std::string_view text, const std::string& location);

}  // namespace meshgraft
