#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/mesh/orientation.h>

#include "core/stopwatch.h"
#include "merge/pose_source.h"
#include "run_steps.h"
#include "script/facts.h"

namespace meshgraft {

namespace {

Eigen::Affine3d map_of(const TransformStep& step) {
  if (const auto* matrix = std::get_if<Eigen::Matrix4d>(&step.pose)) return Eigen::Affine3d(*matrix);
  return make_pose(std::get<HandleMotion>(step.pose), Eigen::Vector3d::Zero()).transform;
}

void require_invertible(const Eigen::Affine3d& map, const Location& location) {
  const double scale = map.linear().cwiseAbs().maxCoeff();
  if (scale > 0 && !(scale >= 1e-100 && scale <= 1e100))
    throw Error(facts::script::PoseScaleBeyondRange{.scale = scale}, location);
  const Eigen::Matrix3d unit = map.linear() / (scale > 0 ? scale : 1);
  if (!(std::abs(unit.determinant()) > 1e-12 * std::pow(unit.norm(), 3)))
    throw Error(facts::script::PoseFlattens{}, location);
}

// Maps the directions of tangents, which keep their length. A fourth component is the side of the bitangent.
void transform_tangents(Mesh& mesh, const Eigen::Matrix3d& linear) {
  const bool mirrors = linear.determinant() < 0;
  for (Attribute& attribute : mesh.attributes) {
    if (attribute.name != "tangent" || attribute.components < 3) continue;
    const auto stride = static_cast<std::size_t>(attribute.components);
    for (std::size_t at = 0; at + 2 < attribute.values.size(); at += stride) {
      Eigen::Map<Eigen::Vector3d> tangent(&attribute.values[at]);
      const double length = tangent.norm();
      if (length > 0) tangent = (linear * tangent).normalized() * length;
      if (mirrors && stride == 4) attribute.values[at + 3] *= -1;
    }
  }
}

std::vector<OrientationGuess> transformed(std::vector<OrientationGuess> guesses,
                                          const Eigen::Matrix3d& linear) {
  for (OrientationGuess& guess : guesses)
    guess.orientation = make_orientation(linear * guess.orientation.up, linear * guess.orientation.front);
  return guesses;
}

}  // namespace

StepReport run_transform(const EditStep& edit_step, const Location& location,
                         std::map<std::string, MeshState>& states, const Context& context) {
  const auto& step = std::get<TransformStep>(edit_step.action);
  Stopwatch watch;
  MeshState& state = state_for_outcome(edit_step, states);
  StepReport report;
  report.mesh = step.mesh;
  report.result = outcome_of(edit_step);
  Eigen::Affine3d map;
  try {
    map = map_of(step);
  } catch (const Error& error) {
    throw error.within(location / "pose");
  }
  require_invertible(map, location / "pose");
  state.mesh = transformed(state.mesh, map, location / "pose");
  for (Index v = 0; v < state.mesh.vertex_count(); ++v)
    if (state.mesh.positions.row(v).array().isInf().any())
      throw Error(facts::script::PoseBeyondNumbers{.vertex = v}, location / "pose");
  transform_tangents(state.mesh, map.linear());
  state.rest = ((state.rest * map.linear().transpose()).rowwise() + map.translation().transpose()).eval();
  state.orientations = transformed(std::move(state.orientations), map.linear());
  report.seconds.solve = watch.lap();
  check_state(state, context);
  report.counts.vertices = state.mesh.vertex_count();
  report.counts.faces = state.mesh.face_count();
  report.transform = map;
  report.seconds.check = watch.lap();
  report.seconds.total = watch.seconds();
  return report;
}

}  // namespace meshgraft
