#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "io/number_text.h"
#include "split.h"

namespace meshgraft::io {

namespace {

constexpr double no_label = std::numeric_limits<double>::quiet_NaN();

const Attribute* label_attribute(const Mesh& mesh, const char* name) {
  const Attribute* attribute = mesh.find_attribute(Domain::face, name);
  const bool usable = attribute != nullptr && attribute->components == 1 &&
                      attribute->values.size() == static_cast<std::size_t>(mesh.face_count());
  return usable ? attribute : nullptr;
}

double label_of(const Attribute* attribute, Index face) {
  return attribute == nullptr ? no_label : attribute->values[face];
}

/// Returns the element of `list` with this label. Adds it if there is none.
template <class Element>
Element& find_or_add(std::vector<Element>& list, double Element::* label, double value) {
  const auto known =
      std::ranges::find_if(list, [&](const Element& element) { return same_value(element.*label, value); });
  if (known != list.end()) return *known;
  list.emplace_back().*label = value;
  return list.back();
}

/// Returns the corners of a face that belong to the vertices of one of its triangles.
CornerTriangle corners_of(const Mesh& mesh, Index face, std::span<const Index> triangle) {
  const std::span<const Index> vertices = mesh.faces[face];
  CornerTriangle corners{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = std::ranges::find(vertices, triangle[k]);
    corners[k] = mesh.faces.first_corner(face) + static_cast<Index>(at - vertices.begin());
  }
  return corners;
}

class VertexSplitter {
 public:
  explicit VertexSplitter(const Mesh& mesh) : mesh_(mesh), first_(mesh.vertex_count(), -1) {
    for (const Attribute& attribute : mesh.attributes) {
      const auto size =
          static_cast<std::size_t>(mesh.faces.corner_count()) * static_cast<std::size_t>(attribute.components);
      if (attribute.domain == Domain::corner && attribute.values.size() == size)
        attributes_.push_back(&attribute);
    }
  }

  void split(SplitPrimitive& primitive) {
    next_.clear();
    for (const CornerTriangle& triangle : primitive.triangles)
      for (const Index corner : triangle) primitive.indices.push_back(vertex_for(corner, primitive));
    for (const Index v : primitive.vertex) first_[v] = -1;
  }

 private:
  std::uint32_t vertex_for(Index corner, SplitPrimitive& primitive) {
    const Index v = mesh_.faces.corners()[corner];
    for (Index made = first_[v]; made >= 0; made = next_[made])
      if (same_values(primitive.corner[made], corner)) return static_cast<std::uint32_t>(made);
    const auto made = static_cast<Index>(primitive.vertex.size());
    primitive.vertex.push_back(v);
    primitive.corner.push_back(corner);
    next_.push_back(first_[v]);
    first_[v] = made;
    return static_cast<std::uint32_t>(made);
  }

  bool same_values(Index a, Index b) const {
    return std::ranges::all_of(attributes_, [&](const Attribute* attribute) {
      const auto components = static_cast<std::size_t>(attribute->components);
      const double* values = attribute->values.data();
      for (std::size_t k = 0; k < components; ++k)
        if (!same_value(values[static_cast<std::size_t>(a) * components + k],
                        values[static_cast<std::size_t>(b) * components + k]))
          return false;
      return true;
    });
  }

  const Mesh& mesh_;
  std::vector<const Attribute*> attributes_;
  std::vector<Index> first_;  // per mesh vertex: the last file vertex made for it, or -1
  std::vector<Index> next_;   // per file vertex: the one made before it for the same mesh vertex, or -1
};

}  // namespace

SplitMesh split_mesh(const Mesh& mesh) {
  SplitMesh split;
  const Attribute* object = label_attribute(mesh, "object");
  const Attribute* material = label_attribute(mesh, "material");
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (mesh.faces[f].size() > 3) ++split.polygons;
  const Triangulation triangulation = triangulate(mesh);
  for (Eigen::Index t = 0; t < triangulation.triangles.rows(); ++t) {
    const Index face = triangulation.face[t];
    SplitObject& owner = find_or_add(split.objects, &SplitObject::object, label_of(object, face));
    SplitPrimitive& primitive =
        find_or_add(owner.primitives, &SplitPrimitive::material, label_of(material, face));
    primitive.triangles.push_back(corners_of(mesh, face, {triangulation.triangles.row(t).data(), 3}));
  }
  VertexSplitter splitter(mesh);
  Flags used(mesh.vertex_count(), false);
  for (SplitObject& owner : split.objects) {
    for (SplitPrimitive& primitive : owner.primitives) {
      splitter.split(primitive);
      for (const Index v : primitive.vertex) used[v] = true;
    }
  }
  split.lonely_vertices = static_cast<Index>(std::ranges::count(used, false));
  return split;
}

}  // namespace meshgraft::io
