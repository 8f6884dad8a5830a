#include "operators.h"

#include <nanobind/nanobind.h>

#include "bindings.h"
#include "calls.h"
#include "from_python.h"
#include "mesh.h"
#include "records.h"
#include "to_python.h"

namespace meshgraft::python {

void bind_operators(nb::module_& module) {
  nb::class_<OperatorHolder>(module, "AffineOperator")
      .def("L", [](const OperatorHolder& holder) { return sparse_parts(holder.rows->L()); })
      .def("delta", [](const OperatorHolder& holder) { return sparse_parts(holder.rows->delta()); })
      .def("H", [](const OperatorHolder& holder) { return sparse_parts(holder.rows->H()); })
      .def("P", [](const OperatorHolder& holder) { return sparse_parts(holder.rows->P()); })
      .def("A",
           [](const OperatorHolder& holder, const nb::tuple& call) {
             return sparse_parts(
                 run_for(call_of(call), [&](const Context& context) { return holder.rows->A(context); }));
           })
      .def("coupling",
           [](const OperatorHolder& holder, const nb::tuple& call) {
             return sparse_parts(run_for(
                 call_of(call), [&](const Context& context) { return holder.rows->coupling(context); }));
           })
      .def("pairs",
           [](const OperatorHolder& holder) {
             const auto& pairs = holder.rows->pairs();
             Eigen::Matrix<Index, Eigen::Dynamic, 2, Eigen::RowMajor> rows(
                 static_cast<Eigen::Index>(pairs.size()), 2);
             for (std::size_t k = 0; k < pairs.size(); ++k)
               rows.row(static_cast<Eigen::Index>(k)) << pairs[k][0], pairs[k][1];
             return array_of(std::move(rows));
           })
      .def("edge_lengths", [](const OperatorHolder& holder) { return array_of(holder.rows->edge_lengths()); })
      .def("mean_edge_length", [](const OperatorHolder& holder) { return holder.rows->mean_edge_length(); })
      .def("nodes", [](const OperatorHolder& holder) { return to_python(holder.rows->nodes()); });
  module.def("affine_operator", [](const PointsIn& points, const TrianglesIn& triangles,
                                   const nb::dict& keywords, const nb::tuple& call) {
    const auto options = options_of<OperatorOptions>(keywords);
    const Points positions = points_of(points);
    const Triangles faces = triangles_of(triangles);
    return run_for(call_of(call), [&](const Context& context) {
      return OperatorHolder{std::make_shared<const AffineOperator>(positions, faces, options, context)};
    });
  });
}

}  // namespace meshgraft::python
