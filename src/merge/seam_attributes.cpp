#include "seam_attributes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Geometry>

#include <meshgraft/mesh/normals.h>

#include "mesh/interpolate_attribute.h"

namespace meshgraft {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

Attribute* find_groups(Mesh& mesh) {
  for (Attribute& attribute : mesh.attributes) {
    if (attribute.domain == Domain::face && attribute.name == "group") return &attribute;
  }
  return nullptr;
}

// Returns the index of a label; adds the label where it is new.
double number_of(Attribute& attribute, const std::string& label) {
  const auto found = std::find(attribute.labels.begin(), attribute.labels.end(), label);
  const auto number = static_cast<double>(found - attribute.labels.begin());
  if (found == attribute.labels.end()) attribute.labels.push_back(label);
  return number;
}

bool is_surface_normal(const Attribute& attribute) {
  return attribute.name == "normal" && attribute.components == 3;
}

Eigen::RowVector3d face_normal(const Mesh& mesh, Index triangle) {
  const auto corners = mesh.faces[triangle];
  const Eigen::RowVector3d a = mesh.positions.row(corners[1]) - mesh.positions.row(corners[0]);
  const Eigen::RowVector3d b = mesh.positions.row(corners[2]) - mesh.positions.row(corners[0]);
  return a.cross(b).normalized();
}

// Writes smooth normals to the corners of the strip and to those corners beside it that were smooth before.
void renew_corner_normals(const Mesh& mesh, const Points& normals, Index first_new, Attribute& attribute) {
  constexpr double smooth = 0.7;  // cosine
  Flags on_strip(mesh.vertex_count(), false);
  for (Index c = mesh.faces.first_corner(first_new); c < mesh.faces.corner_count(); ++c) {
    on_strip[mesh.faces.corners()[c]] = true;
  }
  for (Index c = 0; c < mesh.faces.corner_count(); ++c) {
    const Index v = mesh.faces.corners()[c];
    if (v < 0 || !on_strip[v]) continue;
    Eigen::Map<Eigen::RowVector3d> value(attribute.values.data() + 3 * std::ptrdiff_t{c});
    const bool is_new = c >= mesh.faces.first_corner(first_new);
    if (is_new || value.dot(normals.row(v)) > smooth) value = normals.row(v);
  }
}

}  // namespace

void label_sides(Mesh& mesh, const SeamLayout& layout) {
  if (!find_groups(mesh)) {
    Attribute groups{.name = "group",
                     .domain = Domain::face,
                     .interpolation = Interpolation::nearest,
                     .type = ScalarType::int32};
    groups.values.assign(mesh.face_count(), none);
    mesh.attributes.push_back(std::move(groups));
  }
  Attribute& groups = *find_groups(mesh);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!std::isnan(groups.values[f])) continue;
    groups.values[f] = number_of(groups, layout.side_of_face(f) == SeamSide::target ? "target" : "source");
  }
}

void add_strip(Mesh& mesh, std::span<const std::array<Index, 3>> triangles, std::span<const Index> neighbour) {
  std::vector<EdgePoint> faces;
  for (const Index f : neighbour) faces.push_back({f, f, 0});
  for (Attribute& attribute : mesh.attributes) {
    if (attribute.domain == Domain::face) {
      const std::vector<double> values = interpolate_attribute(attribute, faces).values;
      attribute.values.insert(attribute.values.end(), values.begin(), values.end());
    } else if (attribute.domain == Domain::corner) {
      attribute.values.insert(attribute.values.end(), 3 * triangles.size() * attribute.components, none);
    }
  }
  Attribute& groups = *find_groups(mesh);
  std::fill(groups.values.end() - std::ssize(triangles), groups.values.end(), number_of(groups, "seam"));
  for (const auto& triangle : triangles) mesh.faces.push_back(triangle);
}

void renew_normals(Mesh& mesh, const SeamLayout& layout, const Points& unfaired) {
  const bool has_normals = std::any_of(mesh.attributes.begin(), mesh.attributes.end(), is_surface_normal);
  if (!has_normals) return;
  update_normals(mesh, unfaired);
  const Points normals = vertex_normals(mesh);
  Flags on_strip(mesh.vertex_count(), false);
  const Index first_new = layout.target_faces + layout.source_faces;
  for (Index f = first_new; f < mesh.face_count(); ++f) {
    for (const Index v : mesh.faces[f]) on_strip[v] = true;
  }
  for (Attribute& attribute : mesh.attributes) {
    if (!is_surface_normal(attribute)) continue;
    const auto put = [&](Index element, const Eigen::RowVector3d& normal) {
      std::copy_n(normal.data(), 3, attribute.values.begin() + 3 * std::ptrdiff_t{element});
    };
    if (attribute.domain == Domain::vertex) {
      for (Index v = 0; v < mesh.vertex_count(); ++v) {
        if (on_strip[v]) put(v, normals.row(v));
      }
    } else if (attribute.domain == Domain::face) {
      for (Index f = first_new; f < mesh.face_count(); ++f) put(f, face_normal(mesh, f));
    } else {
      renew_corner_normals(mesh, normals, first_new, attribute);
    }
  }
}

}  // namespace meshgraft
