// Deforming by constraints per vertex, and by a field of maps that the caller gives.
#include <map>
#include <utility>

#include <nanobind/stl/optional.h>

#include "bindings.h"
#include "deform.h"
#include "records.h"
#include "to_python.h"

namespace meshgraft::python {

namespace {

using MapsIn = nb::ndarray<const double, nb::ndim<3>, nb::shape<-1, 3, 3>, nb::c_contig, nb::device::cpu>;

Eigen::Matrix3d map_at(const MapsIn& maps, std::size_t number) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(maps.data() + 9 * number);
}

std::vector<Eigen::Matrix3d> maps_of(const MapsIn& array) {
  std::vector<Eigen::Matrix3d> maps(array.shape(0));
  for (std::size_t i = 0; i < maps.size(); ++i) maps[i] = map_at(array, i);
  return maps;
}

// Stands behind Python's VertexDeformer.
struct VertexDeformerHolder {
  std::shared_ptr<const Preparation> preparation;
  std::vector<VertexConstraint> rest;                // all constraints, as they are at rest
  std::vector<std::size_t> targets{}, transforms{};  // where the caller's values belong among these
  std::shared_ptr<const Deformer> deformer{};
  EvaluationRunner runner{};

  VertexDeformerHolder(std::shared_ptr<const Preparation> given, const std::vector<Index>& target_vertices,
                       const std::vector<Index>& transform_vertices)
      : preparation(std::move(given)) {
    const Points& positions = preparation->setup.problem.rest;
    const Weld& weld = preparation->setup.weld;
    const auto own = [&](Index v) { return weld.empty() ? v : weld.of(v); };
    std::map<Index, VertexConstraint> all;
    const auto hold = [&](Index v) -> VertexConstraint& {
      VertexConstraint& one = all[v];
      one.vertex = v;
      return one;
    };
    for (const Index v : preparation->setup.problem.deform.region.fixed) {
      hold(v).position = positions.row(v);
      hold(v).transform = Eigen::Matrix3d::Identity();
    }
    for (const Index v : target_vertices) hold(own(v)).position = positions.row(own(v));
    for (const Index v : transform_vertices) hold(own(v)).transform = Eigen::Matrix3d::Identity();
    std::map<Index, std::size_t> at;
    for (const auto& [v, one] : all) {
      at[v] = rest.size();
      rest.push_back(one);
    }
    for (const Index v : target_vertices) targets.push_back(at[own(v)]);
    for (const Index v : transform_vertices) transforms.push_back(at[own(v)]);
  }

  std::vector<VertexConstraint> constraints(const std::optional<PointsIn>& positions,
                                            const std::optional<MapsIn>& maps) const {
    std::vector<VertexConstraint> all = rest;
    if (positions)
      for (std::size_t i = 0; i < targets.size(); ++i)
        all[targets[i]].position = Eigen::Map<const Eigen::Vector3d>(positions->data() + 3 * i);
    if (maps)
      for (std::size_t i = 0; i < transforms.size(); ++i) all[transforms[i]].transform = map_at(*maps, i);
    return all;
  }
};

VertexDeformerHolder make_vertex_deformer(const nb::tuple& given, const IndicesIn& targets,
                                          const IndicesIn& transforms, const nb::tuple& call) {
  const GivenEdit edit = edit_of_arguments(given);
  const std::vector<Index> target_vertices = indices_of(targets), transform_vertices = indices_of(transforms);
  return run_for(call_of(call), [&](const Context& context) {
    auto preparation = std::make_shared<const Preparation>(edit, context);
    VertexDeformerHolder holder(preparation, target_vertices, transform_vertices);
    DeformProblem problem = preparation->problem();
    problem.region.fixed.clear();
    problem.constraints = holder.rest;
    holder.deformer =
        std::make_shared<const Deformer>(std::move(problem), preparation->settings.deformer, context);
    return holder;
  });
}

nb::object evaluate(const VertexDeformerHolder& holder, const std::optional<PointsIn>& targets,
                    const std::optional<MapsIn>& transforms, nb::handle out, const nb::tuple& call) {
  const std::vector<VertexConstraint> constraints = holder.constraints(targets, transforms);
  if (!out.is_none()) {
    Eigen::Map<Points> positions = map_of(nb::cast<PointsOut>(out));
    holder.runner.run(call, [&](const Context& context) {
      holder.deformer->evaluate(constraints, PointsRef(positions), context);
      holder.preparation->spread(positions);
    });
    return nb::borrow(out);
  }
  Points positions(holder.preparation->setup.problem.rest.rows(), 3);
  holder.runner.run(call, [&](const Context& context) {
    holder.deformer->evaluate(constraints, positions, context);
    holder.preparation->spread({positions.data(), positions.rows(), 3});
  });
  return array_of(std::move(positions));
}

// Returns the positions that follow a field of maps, one for each vertex of the mesh.
template <class Holder>
nb::object solve_with_field(const Holder& holder, const std::vector<VertexConstraint>& constraints,
                            const MapsIn& field, const nb::tuple& call) {
  const std::vector<Eigen::Matrix3d> maps = maps_of(field);
  Points positions;
  holder.runner.run(call, [&](const Context& context) {
    positions = holder.deformer->evaluate_with_field(constraints, maps, context);
    holder.preparation->spread({positions.data(), positions.rows(), 3});
  });
  return array_of(std::move(positions));
}

// Returns (vertices, positions, transforms) of constraints per vertex, with NaN where one is not given.
nb::tuple arrays_of(const std::vector<VertexConstraint>& constraints) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<Index> vertices;
  Points positions(static_cast<Eigen::Index>(constraints.size()), 3);
  std::vector<double> maps;
  for (const VertexConstraint& one : constraints) {
    positions.row(static_cast<Eigen::Index>(vertices.size())) =
        one.position.value_or(Eigen::Vector3d::Constant(none));
    const Eigen::Matrix3d map = one.transform.value_or(Eigen::Matrix3d::Constant(none));
    for (int k = 0; k < 9; ++k) maps.push_back(map(k / 3, k % 3));
    vertices.push_back(one.vertex);
  }
  const std::array<std::size_t, 3> shape{constraints.size(), 3, 3};
  return nb::make_tuple(array_of(std::move(vertices)), array_of(std::move(positions)),
                        array_over(std::move(maps), shape));
}

}  // namespace

void bind_vertex_deform(nb::module_& module) {
  nb::class_<VertexDeformerHolder>(module, "VertexDeformer")
      .def("evaluate", &evaluate, nb::arg().none(), nb::arg().none(), nb::arg().none(), nb::arg())
      .def(
          "evaluate_with_field",
          [](const VertexDeformerHolder& holder, const std::optional<PointsIn>& targets,
             const std::optional<MapsIn>& transforms, const MapsIn& field, const nb::tuple& call) {
            return solve_with_field(holder, holder.constraints(targets, transforms), field, call);
          },
          nb::arg().none(), nb::arg().none(), nb::arg(), nb::arg())
      .def("moved",
           [](const VertexDeformerHolder& holder, const PointsIn& positions) {
             return to_python(holder.preparation->moved(points_of(positions)));
           })
      .def("summary", [](const VertexDeformerHolder& holder) { return to_python(holder.deformer->summary()); })
      .def("free_vertices", [](const VertexDeformerHolder& holder) {
        const auto free = holder.deformer->free_vertices();
        return array_of(std::vector<Index>(free.begin(), free.end()));
      });
  module.def("make_vertex_deformer", &make_vertex_deformer);
  // These two take a deformer with handles.
  module.def("constraints", [](const DeformerHolder& holder, const nb::sequence& poses) {
    return arrays_of(holder.deformer->constraints(holder.preparation->poses_of(poses)));
  });
  module.def("evaluate_with_field", [](const DeformerHolder& holder, const nb::sequence& poses,
                                       const MapsIn& field, const nb::tuple& call) {
    const auto constraints = holder.deformer->constraints(holder.preparation->poses_of(poses));
    return solve_with_field(holder, constraints, field, call);
  });
}

}  // namespace meshgraft::python
