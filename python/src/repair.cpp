#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>

#include "arrays.h"
#include "bindings.h"
#include "calls.h"
#include "from_python.h"
#include "mesh.h"
#include "mesh/sound_mesh.h"
#include "records.h"
#include "to_python.h"

namespace meshgraft::python {

namespace {

nb::object check(const MeshHolder& holder, const nb::tuple& call) {
  return to_python(
      run_for(call_of(call), [&](const Context& context) { return check_mesh(*holder.mesh, context); }));
}

nb::object repaired(const MeshHolder& holder, const nb::dict& keywords, const nb::tuple& call) {
  const auto options = options_of<RepairOptions>(keywords);
  return to_python(
      run_for(call_of(call), [&](const Context& context) { return repair(*holder.mesh, options, context); }));
}

// Cuts without what the check refuses, where the cut does not reach that, as the step of an edit does.
template <class Cut>
nb::object cut(const MeshHolder& holder, const nb::dict& keywords, const nb::tuple& call,
               const Cut& cut_sound) {
  const auto options = options_of<CutOptions>(keywords);
  return to_python(run_for(call_of(call), [&](const Context& context) {
    const Diagnostics diagnostics = check_mesh(*holder.mesh, context);
    const SoundMesh sound(*holder.mesh, diagnostics, "mesh");
    try {
      CutResult result = cut_sound(sound.mesh(), options, context);
      sound.require_beyond(vertices_at_cut(result));
      sound.put_back(result.vertex, result.mesh);
      return result;
    } catch (const Error& error) {
      throw sound.explained(error);
    }
  }));
}

Plane plane_of(const NumbersIn& point, const NumbersIn& normal) {
  return {Eigen::Map<const Eigen::Vector3d>(point.data()), Eigen::Map<const Eigen::Vector3d>(normal.data())};
}

nb::object pairs_of(const std::vector<TrianglePair>& pairs) {
  Eigen::Matrix<Index, Eigen::Dynamic, 2, Eigen::RowMajor> rows(static_cast<Eigen::Index>(pairs.size()), 2);
  for (std::size_t k = 0; k < pairs.size(); ++k)
    rows.row(static_cast<Eigen::Index>(k)) << pairs[k][0], pairs[k][1];
  return array_of(std::move(rows));
}

}  // namespace

void bind_repair(nb::module_& module) {
  module.def("check", &check);
  module.def("repair", &repaired);
  module.def("cut_by_plane", [](const MeshHolder& mesh, const NumbersIn& point, const NumbersIn& normal,
                                const nb::dict& keywords, const nb::tuple& call) {
    const Plane plane = plane_of(point, normal);
    return cut(mesh, keywords, call, [&](const Mesh& sound, const CutOptions& options, const Context& context) {
      return cut_by_plane(sound, plane, options, context);
    });
  });
  module.def("cut_along_loop", [](const MeshHolder& mesh, const IndicesIn& loop, const nb::dict& keywords,
                                  const nb::tuple& call) {
    const std::vector<Index> vertices = indices_of(loop);
    return cut(mesh, keywords, call, [&](const Mesh& sound, const CutOptions& options, const Context& context) {
      return cut_along_loop(sound, vertices, options, context);
    });
  });
  module.def("cut_at_zero", [](const MeshHolder& mesh, const NumbersIn& values, const nb::dict& keywords,
                               const nb::tuple& call) {
    const std::vector<double> numbers(values.data(), values.data() + values.size());
    return cut(mesh, keywords, call, [&](const Mesh& sound, const CutOptions& options, const Context& context) {
      return cut_at_zero(sound, numbers, options, context);
    });
  });
  module.def("quality", [](const PointsIn& rest, const PointsIn& edited, const TrianglesIn& triangles,
                           const IndicesIn& free, const bool self_intersections, const nb::tuple& call) {
    const Points from = points_of(rest), to = points_of(edited);
    const Triangles faces = triangles_of(triangles);
    const std::vector<Index> vertices = indices_of(free);
    return to_python(run_for(call_of(call), [&](const Context& context) {
      return measure_quality({from, to, faces, vertices}, {.self_intersections = self_intersections}, context);
    }));
  });
  module.def("self_intersections", [](const PointsIn& points, const TrianglesIn& triangles,
                                      const IndicesIn& free, const nb::tuple& call) {
    const Points positions = points_of(points);
    const Triangles faces = triangles_of(triangles);
    const std::vector<Index> vertices = indices_of(free);
    return pairs_of(run_for(call_of(call), [&](const Context& context) {
      return self_intersections(positions, faces, vertices, context);
    }));
  });
}

}  // namespace meshgraft::python
