#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace meshgraft {

using Index = std::int32_t;

/// n×3, one point or vector per row, model units.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// m×3, vertex indices, counter-clockwise seen from outside.
using Triangles = Eigen::Matrix<Index, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// One flag per element, 0 or 1. They are bytes, so that threads may write adjacent flags at the same time.
using Flags = std::vector<std::uint8_t>;

/// Faces with any number of corners, stored one after another. Corner c of face f is element `offsets[f] + c`
/// of `corners`; corner attributes use the same numbering.
class Faces {
 public:
  Index size() const { return static_cast<Index>(offsets_.size()) - 1; }
  Index corner_count() const { return static_cast<Index>(corners_.size()); }
  std::span<const Index> operator[](Index face) const {
    return {corners_.data() + offsets_[face], static_cast<std::size_t>(offsets_[face + 1] - offsets_[face])};
  }
  Index first_corner(Index face) const { return offsets_[face]; }

  void reserve(Index faces, Index corners);
  void push_back(std::span<const Index> face);

  const std::vector<Index>& offsets() const { return offsets_; }
  const std::vector<Index>& corners() const { return corners_; }

  bool operator==(const Faces&) const = default;

 private:
  std::vector<Index> offsets_{0};
  std::vector<Index> corners_;
};

/// The kind of element that an attribute belongs to.
enum class Domain { vertex, face, corner };

/// The rule for the value of a new element that lies between old ones.
enum class Interpolation {
  linear,     ///< weighted mean (colours, UVs, scalars)
  direction,  ///< weighted mean, renormalised (normals)
  nearest,    ///< the value of the element with the largest weight (labels, indices, flags)
};

/// The scalar type of values in the file they came from, in which they are written again.
enum class ScalarType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// A value per vertex, face or corner. All scalar types fit into double without loss.
struct Attribute {
  std::string name;  ///< "normal", "uv", "colour", "group", "material", or the file's own name
  Domain domain = Domain::vertex;
  Interpolation interpolation = Interpolation::linear;
  ScalarType type = ScalarType::float64;
  int components = 1;
  std::vector<double> values{};             ///< element-major, `components` per element; NaN = missing
  std::vector<std::string> labels{};        ///< for group and material: the name of value k; else empty
  std::vector<std::string> source_names{};  ///< the file's names of the components, e.g. "red", "green", "blue"
};

/// The contents of a file that its reader keeps. A writer of the same format can then change positions and
/// leave everything else as it was, including data that meshgraft does not understand. Each format derives
/// its own class.
class SourceDocument {
 public:
  virtual ~SourceDocument() = default;
};

/// A polygon mesh and the data that its file carried.
struct Mesh {
  Points positions{0, 3};             ///< n×3, model units
  Faces faces;                        ///< indices into `positions`
  std::vector<Attribute> attributes;  ///< names are unique within a domain

  /// Holds where the mesh comes from, such as its file; null for a mesh that was made of arrays.
  std::shared_ptr<const SourceDocument> source;

  Index vertex_count() const { return static_cast<Index>(positions.rows()); }
  Index face_count() const { return faces.size(); }

  /// Returns the attribute of that domain and name, or null.
  const Attribute* find_attribute(Domain domain, std::string_view name) const;
};

/// Makes a mesh of triangles without attributes from n×3 positions and m×3 triangles.
Mesh make_mesh(const Points& positions, const Triangles& triangles);

/// A plane through `point`; the normal need not have unit length.
struct Plane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
};

/// The origin of an element of a new mesh between two old ones: (1 − t)·from + t·to.
struct EdgePoint {
  Index from = -1, to = -1;
  double t = 0;
};

/// The new indices of the elements of an old mesh: `new_index[old]`, or -1 where one was removed.
struct IndexMap {
  std::vector<Index> new_index;
};

/// Triangles that cover the faces of a mesh, and the face each comes from.
struct Triangulation {
  Triangles triangles;      ///< m×3
  std::vector<Index> face;  ///< m, the polygon that triangle t is a piece of
};

struct TriangulateOptions {
  /// Skip faces with an index out of range instead of throwing, for an edit that does not reach them.
  bool skip_out_of_range = false;
};

/// Splits polygons into triangles. Triangles pass through, and convex quads are split along the shorter
/// diagonal. All other faces are split by ear clipping in the polygon's plane (Newell's normal), the
/// best-shaped ear first. The order follows the faces. Repeated corners are skipped; a face with fewer than
/// three corners left gives no triangle. Time is quadratic in the corners of one face. Throws Error(input)
/// with the id mesh.face_index_out_of_range for an index of a vertex that does not exist.
Triangulation triangulate(const Mesh& mesh, const TriangulateOptions& options = {});

}  // namespace meshgraft
