#pragma once

#include <map>

#include <Eigen/Core>

#include "communicator.h"

namespace meshgraft::distributed {

/// Numbers of components, by the components' labels.
using LabelValues = std::map<Number, Eigen::VectorXd>;

/// Adds up the ranks' numbers for each label, or takes the largest. Returns the results for the labels that
/// this rank has numbers for. All numbers of a label have the same length.
LabelValues sum_by_label(const Communicator& comm, const LabelValues& own);
LabelValues largest_by_label(const Communicator& comm, const LabelValues& own);

}  // namespace meshgraft::distributed
