#include "deform.h"

#include <functional>
#include <utility>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "bindings.h"
#include "calls.h"
#include "core/stopwatch.h"
#include "edits.h"
#include "from_python.h"
#include "mesh/weld.h"
#include "operators.h"
#include "records.h"
#include "script/symmetry.h"
#include "to_python.h"

namespace meshgraft::python {

Preparation::Preparation(const GivenEdit& input, const Context& context) {
  mesh = input.meshes.begin()->second;
  const auto& step = std::get<DeformStep>(input.edit.steps.front().action);
  const Location location = (Location::file(input.edit.location) / "steps")[0];
  settings = step.settings;
  const MeshState state = make_mesh_state(*mesh, step.mesh, context);
  without_step([&] {
    context.step("select");
    setup = set_up_deform(input.edit, step, location, state, settings);
    return 0;
  });
  const IndexLists rings =
      vertex_rings(mesh->vertex_count(), setup.weld.empty() ? mesh->faces : setup.welded.faces);
  for (std::size_t h = 0; h < step.handles.size(); ++h)
    pivots.push_back(handle_pivot(handles()[h], setup.problem.rest, rings));
}

std::vector<HandlePose> Preparation::poses_of(const nb::sequence& given) const {
  const Points& rest = setup.problem.rest;
  std::vector<HandlePose> poses(handles().size());
  std::vector<const PoseHolder*> holders(own_count(), nullptr);
  for (std::size_t h = 0; h < own_count(); ++h) {
    const nb::object pose = given[h];
    if (pose.is_none()) continue;
    holders[h] = &nb::cast<const PoseHolder&>(pose);
    if (const auto* motion = std::get_if<HandleMotion>(&holders[h]->pose))
      poses[h] = make_pose(*motion, motion->pivot ? *motion->pivot : pivots[h]);
    else if (const auto* matrix = std::get_if<Eigen::Matrix4d>(&holders[h]->pose))
      poses[h].transform.matrix() = *matrix;
    else
      poses[h].curve = redraw_curve(handles()[h], rest, std::get<Points>(holders[h]->pose));
  }
  if (!setup.problem.deform.symmetry) return poses;
  const SymmetryReport& symmetry = *setup.problem.deform.symmetry;
  for (std::size_t k = 0; k < symmetry.twin_of.size(); ++k) {
    const std::size_t own = symmetry.twin_of[k], twin = own_count() + k;
    PoseSpec spec;
    if (holders[own] != nullptr) {
      if (const auto* matrix = std::get_if<Eigen::Matrix4d>(&holders[own]->pose)) spec.kind = *matrix;
      if (const auto* course = std::get_if<Points>(&holders[own]->pose)) spec.kind = PoseSpec::Redrawn{*course};
    }
    poses[twin] = twin_pose(spec, poses[own], handles()[twin], rest, symmetry.reflection);
  }
  return poses;
}

DeformProblem Preparation::problem() const {
  return {setup.problem.rest, setup.problem.triangles, setup.problem.deform.region, {}};
}

void Preparation::spread(Eigen::Map<Points> positions) const {
  if (setup.weld.empty()) return;
  for (Index v = 0; v < mesh->vertex_count(); ++v)
    if (setup.weld.of(v) != v) positions.row(v) = positions.row(setup.weld.of(v));
}

Mesh Preparation::moved(const Points& positions) const {
  Mesh result = *mesh;
  if (setup.weld.empty()) {
    result.positions = positions;
    update_normals(result, mesh->positions);
    return result;
  }
  Mesh welded = setup.welded;
  welded.positions = positions;
  update_normals(welded, setup.welded.positions);
  unweld(welded, setup.weld, result);
  return result;
}

void EvaluationRunner::run(const nb::tuple& arguments, const std::function<void(const Context&)>& work) const {
  const Call call = call_of(arguments);
  constexpr double short_seconds = 0.02;
  const Stopwatch watch;
  if (last_seconds_ < short_seconds && call.progress.is_none())
    run_short(call, work);
  else
    python::run(call, work);
  last_seconds_ = watch.seconds();
}

namespace {

struct ProxyHolder {
  std::shared_ptr<const Preparation> preparation;
  std::shared_ptr<const ProxyDeformer> deformer;
  EvaluationRunner runner;
};

struct BasisHolder {
  std::shared_ptr<const Preparation> preparation;
  std::shared_ptr<const HandleBasis> basis;
  EvaluationRunner runner;
};

struct ReducedHolder {
  std::shared_ptr<const Preparation> preparation;
  std::shared_ptr<const ReducedFrames> frames;
  EvaluationRunner runner;
};

// Evaluates by `evaluate(poses, positions, context)` into the caller's array, or a new one that is returned.
template <class Holder, class Evaluate>
nb::object evaluate_into(const Holder& holder, const nb::sequence& given, nb::handle out, const nb::tuple& call,
                         const Evaluate& evaluate) {
  const std::vector<HandlePose> poses = holder.preparation->poses_of(given);
  if (!out.is_none()) {
    Eigen::Map<Points> positions = map_of(nb::cast<PointsOut>(out));
    holder.runner.run(call, [&](const Context& context) {
      evaluate(poses, PointsRef(positions), context);
      holder.preparation->spread(positions);
    });
    return nb::borrow(out);
  }
  Points positions(holder.preparation->setup.problem.rest.rows(), 3);
  holder.runner.run(call, [&](const Context& context) {
    evaluate(poses, positions, context);
    holder.preparation->spread({positions.data(), positions.rows(), 3});
  });
  return array_of(std::move(positions));
}

DeformerHolder make_deformer(const nb::tuple& given, const nb::tuple& call) {
  DeformerHolder holder;
  const GivenEdit edit = edit_of_arguments(given);
  run(call_of(call), [&](const Context& context) {
    holder.preparation = std::make_shared<const Preparation>(edit, context);
    holder.deformer = std::make_shared<const Deformer>(holder.preparation->problem(),
                                                       holder.preparation->settings.deformer, context);
  });
  return holder;
}

// Makes a deformer of the same mesh and settings for another region, from what the two have in common.
DeformerHolder with_region(const DeformerHolder& other, const nb::tuple& given, const nb::tuple& call) {
  DeformerHolder holder;
  const GivenEdit edit = edit_of_arguments(given);
  run(call_of(call), [&](const Context& context) {
    holder.preparation = std::make_shared<const Preparation>(edit, context);
    holder.deformer = std::make_shared<const Deformer>(
        other.deformer->with_region(holder.preparation->setup.problem.deform.region, context));
  });
  return holder;
}

ProxyHolder make_proxy(const nb::tuple& given, Index vertices, const nb::tuple& call) {
  ProxyHolder holder;
  const GivenEdit edit = edit_of_arguments(given);
  run(call_of(call), [&](const Context& context) {
    holder.preparation = std::make_shared<const Preparation>(edit, context);
    holder.deformer = std::make_shared<const ProxyDeformer>(
        holder.preparation->problem(), ProxyOptions{holder.preparation->settings.deformer, vertices}, context);
  });
  return holder;
}

nb::object region_vertices(const Preparation& preparation, bool fixed) {
  const Region& region = preparation.setup.problem.deform.region;
  if (fixed) return array_of(region.fixed);
  if (!region.whole) return array_of(region.vertices);
  std::vector<Index> all(static_cast<std::size_t>(preparation.mesh->vertex_count()));
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<Index>(v);
  return array_of(std::move(all));
}

template <class Holder>
nb::object handle_of(const Holder& holder, std::size_t number) {
  return array_of(holder.preparation->handles().at(number).vertices);
}

// Binds the methods that both deformers have.
template <class Holder>
void bind_common(nb::class_<Holder>& bound) {
  bound
      .def(
          "evaluate",
          [](const Holder& holder, const nb::sequence& poses, nb::handle out, const nb::tuple& call) {
            return evaluate_into(holder, poses, out, call,
                                 [&](const auto& given, PointsRef positions, const Context& context) {
                                   holder.deformer->evaluate(given, positions, context);
                                 });
          },
          nb::arg(), nb::arg().none(), nb::arg())
      .def("evaluate_with_report",
           [](const Holder& holder, const nb::sequence& poses, const nb::tuple& call) {
             EvaluationReport report;
             nb::object positions =
                 evaluate_into(holder, poses, nb::none(), call,
                               [&](const auto& given, PointsRef out, const Context& context) {
                                 holder.deformer->evaluate(given, out, context, &report);
                               });
             return nb::make_tuple(positions, to_python(report));
           })
      .def("moved",
           [](const Holder& holder, const PointsIn& positions) {
             return to_python(holder.preparation->moved(points_of(positions)));
           })
      .def("summary", [](const Holder& holder) { return to_python(holder.deformer->summary()); })
      .def("notes",
           [](const Holder& holder) { return to_python(holder.preparation->setup.problem.deform.notes); })
      .def("free_vertices",
           [](const Holder& holder) {
             const auto free = holder.deformer->free_vertices();
             return array_of(std::vector<Index>(free.begin(), free.end()));
           })
      .def("region", [](const Holder& holder) { return region_vertices(*holder.preparation, false); })
      .def("fixed", [](const Holder& holder) { return region_vertices(*holder.preparation, true); })
      .def("handle", &handle_of<Holder>)
      .def("pivot", [](const Holder& holder,
                       std::size_t number) { return array_of(holder.preparation->pivots.at(number)); })
      .def("condition_estimate", [](const Holder& holder, const nb::tuple& call) {
        return run_for(call_of(call),
                       [&](const Context& context) { return holder.deformer->condition_estimate(context); });
      });
}

BasisHolder make_basis(const DeformerHolder& holder, bool with_normals, const nb::tuple& call) {
  return run_for(call_of(call), [&](const Context& context) {
    Points normals;
    if (with_normals) {
      const ResolvedProblem& problem = holder.preparation->setup.problem;
      const auto count = static_cast<Index>(problem.rest.rows());
      normals = vertex_normals(problem.rest, problem.triangles,
                               vertex_triangles(count, problem.triangles, context), context);
    }
    return BasisHolder{
        holder.preparation, std::make_shared<const HandleBasis>(*holder.deformer, normals, context), {}};
  });
}

using DirectionsOut = nb::ndarray<float, nb::ndim<2>, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

// Returns the normals of a frame in a new array.
nb::object frame_normals(const BasisHolder& holder, const nb::sequence& given, nb::handle out,
                         const nb::tuple& call) {
  Directions normals(holder.preparation->setup.problem.rest.rows(), 3);
  nb::object positions =
      evaluate_into(holder, given, out, call, [&](const auto& poses, PointsRef places, const Context& context) {
        holder.basis->frame(poses, places, &normals, context);
      });
  return nb::make_tuple(positions, array_of(std::move(normals)));
}

nb::object pose_matrices(const BasisHolder& holder, const nb::sequence& given) {
  const auto matrices = holder.basis->pose_matrices(holder.preparation->poses_of(given));
  std::vector<float> numbers;
  for (const auto& matrix : matrices) numbers.insert(numbers.end(), matrix.data(), matrix.data() + 12);
  return array_over(std::move(numbers), std::array<std::size_t, 3>{matrices.size(), 4, 3});
}

void bind_quick_frames(nb::module_& module) {
  nb::class_<BasisHolder>(module, "HandleBasis")
      .def(
          "frame",
          [](const BasisHolder& holder, const nb::sequence& poses, nb::handle out, const nb::tuple& call) {
            return evaluate_into(holder, poses, out, call,
                                 [&](const auto& given, PointsRef positions, const Context& context) {
                                   holder.basis->frame(given, positions, nullptr, context);
                                 });
          },
          nb::arg(), nb::arg().none(), nb::arg())
      .def("frame_with_normals", &frame_normals, nb::arg(), nb::arg().none(), nb::arg())
      .def("has_normals", [](const BasisHolder& holder) { return holder.basis->has_normals(); })
      .def("memory_bytes", [](const BasisHolder& holder) { return holder.basis->memory_bytes(); })
      .def("buffers", [](const BasisHolder& holder) { return to_python(holder.basis->buffers()); })
      .def("pose_matrices", &pose_matrices);
  nb::class_<ReducedHolder>(module, "ReducedFrames")
      .def(
          "frame",
          [](const ReducedHolder& holder, const nb::sequence& poses, nb::handle out, const nb::tuple& call) {
            return evaluate_into(holder, poses, out, call,
                                 [&](const auto& given, PointsRef positions, const Context& context) {
                                   holder.frames->frame(given, positions, context);
                                 });
          },
          nb::arg(), nb::arg().none(), nb::arg())
      .def("centres", [](const ReducedHolder& holder) { return holder.frames->centres(); })
      .def("memory_bytes", [](const ReducedHolder& holder) { return holder.frames->memory_bytes(); });
  module.def("handle_basis", &make_basis);
  module.def("reduced_frames", [](const DeformerHolder& holder, const nb::dict& keywords,
                                  const nb::tuple& call) {
    const auto options = options_of<ReducedFramesOptions>(keywords);
    return run_for(call_of(call), [&](const Context& context) {
      return ReducedHolder{
          holder.preparation, std::make_shared<const ReducedFrames>(*holder.deformer, options, context), {}};
    });
  });
}

void bind_poses(nb::module_& module) {
  nb::class_<PoseHolder>(module, "Pose");
  module.def(
      "motion",
      [](const NumbersIn& translate, const NumbersIn& axis, double angle_deg, const NumbersIn& scale,
         const std::optional<NumbersIn>& pivot) {
        HandleMotion motion;
        motion.translate = Eigen::Map<const Eigen::Vector3d>(translate.data());
        motion.axis = Eigen::Map<const Eigen::Vector3d>(axis.data());
        motion.angle_deg = angle_deg;
        motion.scale = Eigen::Map<const Eigen::Vector3d>(scale.data());
        if (pivot) motion.pivot = Eigen::Map<const Eigen::Vector3d>(pivot->data());
        return PoseHolder{motion};
      },
      nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg().none());
  module.def("matrix_pose", [](const nb::ndarray<const double, nb::shape<4, 4>, nb::c_contig>& matrix) {
    using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    return PoseHolder{Eigen::Matrix4d(Eigen::Map<const RowMajor>(matrix.data()))};
  });
  module.def("curve_pose", [](const PointsIn& course) { return PoseHolder{points_of(course)}; });
  // Returns the 4x4 matrix of a motion about its pivot, or about `pivot`.
  module.def("pose_matrix", [](const PoseHolder& holder, const NumbersIn& pivot) -> nb::object {
    if (const auto* matrix = std::get_if<Eigen::Matrix4d>(&holder.pose))
      return to_python(Eigen::Affine3d(*matrix));
    const auto* motion = std::get_if<HandleMotion>(&holder.pose);
    if (motion == nullptr) return nb::none();
    return to_python(make_pose(*motion, motion->pivot
                                            ? *motion->pivot
                                            : Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(pivot.data())))
                         .transform);
  });
}

}  // namespace

void bind_deform(nb::module_& module) {
  bind_poses(module);
  nb::class_<DeformerHolder> deformer(module, "Deformer");
  bind_common(deformer);
  deformer.def("with_region", &with_region)
      .def("operator",
           [](const DeformerHolder& holder) {
             return OperatorHolder{
                 std::shared_ptr<const AffineOperator>(holder.deformer, &holder.deformer->affine_operator())};
           })
      .def("patch_vertices",
           [](const DeformerHolder& holder) {
             const auto patch = holder.deformer->patch_vertices();
             return array_of(std::vector<Index>(patch.begin(), patch.end()));
           })
      .def("normal_matrix", [](const DeformerHolder& holder, const nb::tuple& call) {
        return sparse_parts(run_for(
            call_of(call), [&](const Context& context) { return holder.deformer->normal_matrix(context); }));
      });
  module.def("make_deformer", &make_deformer);
  nb::class_<ProxyHolder> proxy(module, "ProxyDeformer");
  bind_common(proxy);
  proxy
      .def("proxy_vertices",
           [](const ProxyHolder& holder) {
             const auto vertices = holder.deformer->proxy_vertices();
             return array_of(std::vector<Index>(vertices.begin(), vertices.end()));
           })
      .def("proxy_triangles",
           [](const ProxyHolder& holder) { return array_of(Triangles(holder.deformer->proxy_triangles())); });
  module.def("make_proxy", &make_proxy);
  module.def("estimated_memory", [](Index free_vertices) { return estimated_memory(free_vertices); });
  bind_quick_frames(module);
}

}  // namespace meshgraft::python
