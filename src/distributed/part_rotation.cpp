#include "part_rotation.h"

#include <algorithm>
#include <cmath>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "deform/solve/anderson_mixing.h"
#include "deform/solve/corotation.h"
#include "deform/solve/limb_twist.h"
#include "deform/solve/rotations.h"
#include "distributed/facts.h"

namespace meshgraft::distributed {

namespace {

Flags known_maps(const ConstraintMask& mask) {
  Flags known(mask.transform);
  for (Index v = 0; v < mask.size(); ++v) known[v] = !mask.is_fitted(v);
  return known;
}

}  // namespace

PartRotation::PartRotation(const Communicator& comm, const Part& part, const PartSystem& system,
                           const DistributedOptions& options)
    : comm_(comm),
      part_(part),
      system_(system),
      iterations_(options.deformer.method == DeformMethod::corotational ? options.deformer.iterations : 0),
      fields_(comm, part, known_maps(part.mask), options.tolerance,
              iterations_ > 0 ? std::optional(options.deformer.smoothing_length_rel) : std::nullopt),
      limbs_(comm, part, fields_, known_maps(part.mask), options.tolerance),
      normals_(vertex_normals(part.points, part.mesh.triangles, part.mesh.faces_at, {.threads = 1})) {
  comm.together([&] {
    for (Index v = 0; v < part.mesh.vertices.own(); ++v)
      if (const Number c = fields_.component()[v]; c >= 0 && !fields_.is_constrained(c))
        throw Error(facts::distributed::ComponentWithoutTransform{.vertex = part.original[v]});
  });
}

PartRotation::Result PartRotation::find(const std::vector<GivenTransform>& given,
                                        const PartValues& values) const {
  Result result;
  Blend blended;
  if (!blend(given, blended)) {
    result.linear = true;
    result.field = linear_field(given);
    return result;
  }
  result.field = compose(blended, Columns::Zero(part_.mesh.vertices.size(), 3));
  if (iterations_ > 0) local_steps(values, blended, result);
  return result;
}

/// Blends the logarithms of the known transforms over the surface. Returns false on all ranks if a transform
/// has no logarithm.
bool PartRotation::blend(const std::vector<GivenTransform>& given, Blend& blended) const {
  const Index count = part_.mesh.vertices.size(), own = part_.mesh.vertices.own();
  std::vector<PolarParts> parts(given.size());
  Flags constrained(count, 0);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(9);
  bool from_rest = false, fails = false;
  for (std::size_t g = 0; g < given.size(); ++g) {
    const Index v = given[g].vertex;
    if (part_.mesh.rings[v].empty()) continue;
    fails = fails || !polar_decompose(given[g].transform, parts[g]);
    constrained[v] = 1;
    from_rest = from_rest || given[g].rotation.has_value();
    sum += fields_.areas()[v] * parts[g].rotation.reshaped();
  }
  if (comm_.any(fails)) return false;
  for (Index v = 0; v < own; ++v)
    from_rest = from_rest || (part_.mask.transform[v] && !constrained[v] && !part_.mesh.rings[v].empty());
  sum = comm_.sum(sum);
  const Eigen::Matrix3d reference = comm_.any(from_rest) ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                                         : nearest_rotation(sum.reshaped(3, 3));

  Columns logs = Columns::Zero(count, 9);
  for (std::size_t g = 0; g < given.size(); ++g) {
    const Index v = given[g].vertex;
    if (part_.mesh.rings[v].empty()) continue;
    Eigen::Vector3d turn = rotation_log(parts[g].rotation * reference.transpose());
    if (given[g].rotation) turn = nearest_turn(turn, *given[g].rotation);
    logs.row(v) << turn.transpose(), stretch_log(parts[g].stretch).transpose();
  }
  part_.mesh.vertices.update(logs);
  logs = fields_.spread(logs);

  blended.rotation.resize(count);
  blended.stretch.resize(count);
  const Columns slopes = limbs_.empty() ? Columns() : limbs_.slopes(logs.leftCols<3>());
  for (Index v = 0; v < count; ++v) {
    const Eigen::Vector3d turn = logs.row(v).head<3>().transpose();
    blended.rotation[v] = rotation_exp(turn) * reference;
    blended.stretch[v] = stretch_exp(logs.row(v).tail<6>().transpose());
    if (limbs_.empty()) continue;
    const LimbPoint at = limbs_.at(v);
    blended.stretch[v] += twist_shear(at, turn, slopes.row(v).transpose(), reference, blended.stretch[v]) *
                          at.moment * at.direction.transpose();
  }
  return true;
}

/// Returns the right-hand side of a linear blend: edges with stiffness keep the linearly blended transforms.
PartField PartRotation::linear_field(const std::vector<GivenTransform>& given) const {
  const Index count = part_.mesh.vertices.size();
  Columns entries(count, 9);
  entries.rowwise() = Eigen::Matrix3d::Identity().reshaped().transpose();
  for (const GivenTransform& one : given) entries.row(one.vertex) = one.transform.reshaped().transpose();
  part_.mesh.vertices.update(entries);
  entries = fields_.spread(entries);
  PartField field;
  field.smooth = false;
  field.maps.resize(3 * Eigen::Index{count}, 3);
  for (Index v = 0; v < count; ++v) {
    const Eigen::Matrix3d map = entries.row(v).transpose().reshaped(3, 3);
    field.maps.middleRows<3>(3 * Eigen::Index{v}) = (map - Eigen::Matrix3d::Identity()).transpose();
  }
  return field;
}

PartField PartRotation::compose(const Blend& blended, const Columns& deviation) const {
  PartField field;
  field.maps.resize(3 * deviation.rows(), 3);
  for (Eigen::Index v = 0; v < deviation.rows(); ++v) {
    const Eigen::Matrix3d map =
        rotation_exp(deviation.row(v).transpose()) * blended.rotation[v] * blended.stretch[v];
    field.maps.middleRows<3>(3 * v) = (map - Eigen::Matrix3d::Identity()).transpose();
  }
  return field;
}

/// Performs fixed-point steps, as `RotationField` does.
void PartRotation::local_steps(const PartValues& values, const Blend& blended, Result& result) const {
  const Index count = part_.mesh.vertices.size();
  Columns deviation = Columns::Zero(count, 3);
  AndersonMixing mixing([this](const Columns& a, const Columns& b) { return mean_product(a, b); });
  while (result.iterations < iterations_) {
    result.guess = system_.solve(values, result.field, 0, result.guess.rows() > 0 ? &result.guess : nullptr);
    const Columns raw = surface_deviation(system_.maps(result.guess, values), blended, deviation);
    const Columns step = fields_.smooth(raw) - deviation;
    deviation = mixing.next(deviation, step);
    result.field = compose(blended, deviation);
    result.change = std::sqrt(mean_product(step, step));
    ++result.iterations;
    if (result.change < settled_change) break;
  }
}

/// Returns rotation vectors of the local vertices that take the blended rotations to those of the maps. `maps`
/// are those of the own vertices.
Columns PartRotation::surface_deviation(const Columns& maps, const Blend& blended,
                                        const Columns& current) const {
  const std::vector<Index>& apex = system_.rows().nodes().apex;
  Columns deviation = Columns::Zero(current.rows(), 3);
  for (Index v = 0; v < part_.mesh.vertices.own(); ++v) {
    const Eigen::Matrix3d map =
        maps.middleRows<3>(3 * Eigen::Index{v}).transpose() + Eigen::Matrix3d::Identity();
    const Eigen::Vector3d normal =
        apex[v] < 0 ? Eigen::Vector3d(normals_.row(v).transpose()) : Eigen::Vector3d::Zero();
    deviation.row(v) =
        surface_turn(map, {blended.rotation[v], blended.stretch[v]}, normal, current.row(v).transpose())
            .transpose();
  }
  part_.mesh.vertices.update(deviation);
  return deviation;
}

double PartRotation::mean_product(const Columns& a, const Columns& b) const {
  double sum = 0, area = 0;
  for (Index v = 0; v < part_.mesh.vertices.own(); ++v) {
    if (!part_.mask.is_fitted(v)) continue;
    sum += fields_.areas()[v] * a.row(v).dot(b.row(v));
    area += fields_.areas()[v];
  }
  sum = comm_.sum(sum);
  area = comm_.sum(area);
  return area > 0 ? sum / area : 0;
}

}  // namespace meshgraft::distributed
