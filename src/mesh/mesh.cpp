#include <meshgraft/mesh/mesh.h>

#include <algorithm>

namespace meshgraft {

void Faces::reserve(Index faces, Index corners) {
  offsets_.reserve(static_cast<std::size_t>(faces) + 1);
  corners_.reserve(corners);
}

void Faces::push_back(std::span<const Index> face) {
  corners_.insert(corners_.end(), face.begin(), face.end());
  offsets_.push_back(static_cast<Index>(corners_.size()));
}

const Attribute* Mesh::find_attribute(Domain domain, std::string_view name) const {
  const auto found = std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& attribute) {
    return attribute.domain == domain && attribute.name == name;
  });
  return found == attributes.end() ? nullptr : &*found;
}

Mesh make_mesh(const Points& positions, const Triangles& triangles) {
  Mesh mesh;
  mesh.positions = positions;
  mesh.faces.reserve(static_cast<Index>(triangles.rows()), static_cast<Index>(triangles.size()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) mesh.faces.push_back({triangles.row(t).data(), 3});
  return mesh;
}

}  // namespace meshgraft
