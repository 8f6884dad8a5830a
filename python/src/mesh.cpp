#include "mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "arrays.h"
#include "bindings.h"
#include "calls.h"
#include "from_python.h"
#include "mesh/up_axis.h"
#include "records.h"
#include "to_python.h"

namespace meshgraft::python {

namespace {

MeshHolder hold(Mesh mesh) { return {std::make_shared<const Mesh>(std::move(mesh))}; }

MeshHolder mesh_of_triangles(const PointsIn& vertices, const TrianglesIn& faces) {
  return hold(make_mesh(points_of(vertices), triangles_of(faces)));
}

MeshHolder mesh_of_polygons(const PointsIn& vertices, const IndicesIn& offsets, const IndicesIn& corners) {
  Mesh mesh;
  mesh.positions = points_of(vertices);
  const Index* first = offsets.data();
  mesh.faces.reserve(static_cast<Index>(offsets.size()) - 1, static_cast<Index>(corners.size()));
  for (std::size_t face = 0; face + 1 < offsets.size(); ++face)
    mesh.faces.push_back({corners.data() + first[face], corners.data() + first[face + 1]});
  return hold(std::move(mesh));
}

template <class Word>
Word word_of(const char* name, const std::string& text) {
  Word word{};
  read_keyword(name, nb::str(text.c_str()), word);
  return word;
}

std::string_view name_of(ScalarType type) {
  constexpr std::array<std::string_view, 8> names = {"int8",  "uint8",  "int16",   "uint16",
                                                     "int32", "uint32", "float32", "float64"};
  return names[static_cast<std::size_t>(type)];
}

ScalarType scalar_type_of(std::string_view name) {
  for (int type = 0; type < 8; ++type)
    if (name_of(static_cast<ScalarType>(type)) == name) return static_cast<ScalarType>(type);
  throw nb::value_error(("no type of attributes: " + std::string(name)).c_str());
}

// Returns (domain, name, type, components, interpolation, labels, source names) of each attribute.
nb::list attributes_of(const MeshHolder& holder) {
  nb::list list;
  for (const Attribute& attribute : holder.mesh->attributes)
    list.append(nb::make_tuple(to_python(attribute.domain), attribute.name, to_python(name_of(attribute.type)),
                               attribute.components, to_python(attribute.interpolation),
                               to_python(attribute.labels), to_python(attribute.source_names)));
  return list;
}

nb::object attribute_values(nb::handle self, const std::string& domain, const std::string& name) {
  const Mesh& mesh = *nb::cast<const MeshHolder&>(self).mesh;
  const Attribute* attribute = mesh.find_attribute(word_of<Domain>("domain", domain), name);
  if (attribute == nullptr) return nb::none();
  const auto components = static_cast<std::size_t>(attribute->components);
  return view_of(attribute->values.data(), {attribute->values.size() / components, components}, self);
}

// Replaces or adds an attribute; values are element-major.
MeshHolder with_attribute(const MeshHolder& holder, const std::string& domain, const std::string& name,
                          const nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>& values,
                          const std::string& type, const std::string& interpolation,
                          std::vector<std::string> labels, std::vector<std::string> source_names) {
  Mesh mesh = *holder.mesh;
  Attribute attribute;
  attribute.name = name;
  attribute.domain = word_of<Domain>("domain", domain);
  attribute.interpolation = word_of<Interpolation>("interpolation", interpolation);
  attribute.type = scalar_type_of(type);
  attribute.components = static_cast<int>(values.shape(1));
  attribute.values.assign(values.data(), values.data() + values.size());
  attribute.labels = std::move(labels);
  attribute.source_names = std::move(source_names);
  const auto same = std::find_if(mesh.attributes.begin(), mesh.attributes.end(), [&](const Attribute& other) {
    return other.domain == attribute.domain && other.name == name;
  });
  if (same != mesh.attributes.end())
    *same = std::move(attribute);
  else
    mesh.attributes.push_back(std::move(attribute));
  forget_file(mesh);  // it has other attributes
  return hold(std::move(mesh));
}

MeshHolder without_attribute(const MeshHolder& holder, const std::string& domain, const std::string& name) {
  Mesh mesh = *holder.mesh;
  const Domain where = word_of<Domain>("domain", domain);
  std::erase_if(mesh.attributes, [&](const Attribute& attribute) {
    return attribute.domain == where && attribute.name == name;
  });
  forget_file(mesh);
  return hold(std::move(mesh));
}

MeshHolder with_vertices(const MeshHolder& holder, const PointsIn& vertices) {
  Mesh mesh = *holder.mesh;
  mesh.positions = points_of(vertices);
  update_normals(mesh, holder.mesh->positions);
  return hold(std::move(mesh));
}

nb::object triangles_view(nb::handle self) {
  const Faces& faces = nb::cast<const MeshHolder&>(self).mesh->faces;
  const auto count = static_cast<std::size_t>(faces.size());
  for (std::size_t face = 0; face <= count; ++face)
    if (faces.offsets()[face] != static_cast<Index>(3 * face)) return nb::none();
  return view_of(faces.corners().data(), {count, 3}, self);
}

nb::object bounds_of(const MeshHolder& holder) {
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> bounds;
  bounds.row(0).setConstant(std::numeric_limits<double>::infinity());
  bounds.row(1).setConstant(-std::numeric_limits<double>::infinity());
  for (const auto& position : holder.mesh->positions.rowwise()) {
    if (!position.allFinite()) continue;
    bounds.row(0) = bounds.row(0).cwiseMin(position);
    bounds.row(1) = bounds.row(1).cwiseMax(position);
  }
  if (bounds(0, 0) > bounds(1, 0)) bounds.setConstant(std::numeric_limits<double>::quiet_NaN());
  return array_of(bounds);
}

// Returns rows of lists of indices as (offsets, values).
nb::object lists_of(const IndexLists& lists) {
  return nb::make_tuple(array_of(lists.offsets), array_of(lists.values));
}

}  // namespace

nb::object to_python(Mesh mesh) {
  return class_of("meshgraft._mesh", "Mesh").attr("_wrap")(hold(std::move(mesh)));
}

void bind_mesh(nb::module_& module) {
  nb::class_<MeshHolder>(module, "Mesh")
      .def_prop_ro("vertex_count", [](const MeshHolder& holder) { return holder.mesh->vertex_count(); })
      .def_prop_ro("face_count", [](const MeshHolder& holder) { return holder.mesh->face_count(); })
      .def("vertices",
           [](nb::handle self) {
             const Points& points = nb::cast<const MeshHolder&>(self).mesh->positions;
             return view_of(points.data(), {static_cast<std::size_t>(points.rows()), 3}, self);
           })
      .def("triangles", &triangles_view)
      .def("polygons",
           [](nb::handle self) {
             const Faces& faces = nb::cast<const MeshHolder&>(self).mesh->faces;
             return nb::make_tuple(view_of(faces.offsets().data(), {faces.offsets().size()}, self),
                                   view_of(faces.corners().data(), {faces.corners().size()}, self));
           })
      .def("attributes", &attributes_of)
      .def("attribute_values", &attribute_values)
      .def("with_attribute", &with_attribute)
      .def("without_attribute", &without_attribute)
      .def("with_vertices", &with_vertices)
      .def("bounds", &bounds_of)
      .def("unit", [](const MeshHolder& holder) { return unit_of(*holder.mesh); })
      .def("notes", [](const MeshHolder& holder) { return to_python(notes_on_files(*holder.mesh)); })
      .def("topology",
           [](const MeshHolder& holder, const nb::tuple& call) {
             return to_python(
                 run_for(call_of(call), [&](const Context&) { return summarise_topology(*holder.mesh); }));
           })
      .def("boundary_loops",
           [](const MeshHolder& holder, const nb::tuple& call) {
             return to_python(
                 run_for(call_of(call), [&](const Context&) { return boundary_loops(*holder.mesh); }));
           })
      .def("components",
           [](const MeshHolder& holder, const nb::tuple& call) {
             return to_python(
                 run_for(call_of(call), [&](const Context&) { return connected_components(*holder.mesh); }));
           })
      .def("vertex_normals",
           [](const MeshHolder& holder, const nb::tuple& call) {
             return to_python(
                 run_for(call_of(call), [&](const Context&) { return vertex_normals(*holder.mesh); }));
           })
      .def("rings",
           [](const MeshHolder& holder, const nb::tuple& call) {
             return lists_of(run_for(call_of(call), [&](const Context&) {
               return vertex_rings(holder.mesh->vertex_count(), holder.mesh->faces);
             }));
           })
      .def("triangulated", [](const MeshHolder& holder, const nb::tuple& call) {
        Triangulation pieces =
            run_for(call_of(call), [&](const Context&) { return triangulate(*holder.mesh); });
        return nb::make_tuple(array_of(std::move(pieces.triangles)), array_of(std::move(pieces.face)));
      });
  module.def("mesh_of_triangles", &mesh_of_triangles);
  module.def("mesh_of_polygons", &mesh_of_polygons);
  module.def("read", [](const std::string& path, const nb::tuple& call) {
    return hold(run_for(call_of(call), [&](const Context& context) { return read_mesh(path, context); }));
  });
  module.def("write", [](const MeshHolder& holder, const std::string& path, bool overwrite,
                         const std::optional<std::string>& target_name, const std::optional<PointsIn>& rest,
                         const nb::tuple& call) {
    WriteOptions options{.overwrite = overwrite};
    if (target_name) options.morph_target = MorphTarget{*target_name, points_of(*rest)};
    return to_python(run_for(call_of(call), [&](const Context& context) {
      return write_mesh(*holder.mesh, path, options, context);
    }));
  });
}

}  // namespace meshgraft::python
