#pragma once

#include <optional>
#include <vector>

#include <meshgraft/deform/deform_problem.h>

#include "part_fields.h"
#include "part_limbs.h"
#include "part_system.h"

namespace meshgraft::distributed {

/// The given transforms of the own vertices of a part.
struct GivenTransform {
  Index vertex = -1;
  Eigen::Matrix3d transform = Eigen::Matrix3d::Identity();
  std::optional<Eigen::Vector3d> rotation{};  ///< rotation vector with all turns
};

/// Finds the field of maps on the right-hand side of a part's system, as `RotationField` does on one machine.
class PartRotation {
 public:
  /// The arguments must outlive the object.
  PartRotation(const Communicator& comm, const Part& part, const PartSystem& system,
               const DistributedOptions& options);

  struct Result {
    PartField field;
    Columns guess;  ///< the unknowns of the last iteration, or empty
    int iterations = 0;
    double change = 0;    ///< root mean square change that the last iteration asked for, radians
    bool linear = false;  ///< a transform has no logarithm
  };
  Result find(const std::vector<GivenTransform>& given, const PartValues& values) const;

 private:
  struct Blend {
    std::vector<Eigen::Matrix3d> rotation, stretch;  ///< per local vertex
  };
  bool blend(const std::vector<GivenTransform>& given, Blend& blended) const;
  PartField linear_field(const std::vector<GivenTransform>& given) const;
  PartField compose(const Blend& blended, const Columns& deviation) const;
  void local_steps(const PartValues& values, const Blend& blended, Result& result) const;
  Columns surface_deviation(const Columns& maps, const Blend& blended, const Columns& current) const;
  double mean_product(const Columns& a, const Columns& b) const;

  const Communicator& comm_;
  const Part& part_;
  const PartSystem& system_;
  int iterations_ = 0;
  PartFields fields_;
  PartLimbs limbs_;
  Points normals_;
};

}  // namespace meshgraft::distributed
