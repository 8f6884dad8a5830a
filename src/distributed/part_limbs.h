#pragma once

#include <optional>
#include <vector>

#include "deform/solve/limb_twist.h"
#include "part_fields.h"

namespace meshgraft::distributed {

/// The limbs of a surface that is divided among the ranks, as `LimbTwist` finds them. Values are those of the
/// local vertices.
class PartLimbs {
 public:
  PartLimbs(const Communicator& comm, const Part& part, const PartFields& fields, const Flags& given,
            double tolerance);

  bool empty() const { return !means_; }
  LimbPoint at(Index v) const {
    return {axes_.row(v).transpose(), moments_.row(v).transpose(), rates_along_.row(v).transpose()};
  }
  /// Returns the rates at which fields (local vertices × k) change per length along `direction`.
  Columns slopes(const Columns& fields) const;

 private:
  struct Faces;
  Columns group_indicators(const Flags& given) const;
  void find_axes(const PartFields& fields, const Flags& given, const Columns& indicators, const Faces& faces);
  void find_derivatives(const Flags& given, const Faces& faces);

  const Communicator& comm_;
  const Part& part_;
  double tolerance_;
  Points axes_, moments_, rates_along_, directions_;
  std::optional<VertexSystem> means_;  ///< gives means along level lines
  SparseRows derivatives_;             ///< own rows
  Eigen::VectorXd along_axis_;
};

}  // namespace meshgraft::distributed
