#include "group_weights.h"

#include "core/parallel.h"
#include "limb_faces.h"

namespace meshgraft {

GroupWeights::GroupWeights(const IndexLists& rings, std::span<const std::uint8_t> given,
                           const SurfaceFields& fields, const Context& context)
    : group_(rings.size(), -1) {
  std::vector<Index> queue;
  for (Index start = 0; start < rings.size(); ++start) {
    if (!given[start] || group_[start] >= 0 || rings[start].empty()) continue;
    group_[start] = count_;
    queue.assign(1, start);
    while (!queue.empty()) {
      const Index v = queue.back();
      queue.pop_back();
      for (const Index w : rings[v])
        if (given[w] && group_[w] < 0) {
          group_[w] = count_;
          queue.push_back(w);
        }
    }
    ++count_;
  }
  weights_ = fields.spread(indicators_of_groups(group_, count_), context);
}

std::optional<Columns> GroupWeights::common_values(const Columns& values) const {
  if (count_ == 0 || weights_.cols() != count_) return {};
  Columns common(count_, values.cols());
  Flags is_known(count_, 0);
  for (std::size_t v = 0; v < group_.size(); ++v) {
    const Index g = group_[v];
    if (g < 0) continue;
    const auto row = values.row(static_cast<Eigen::Index>(v));
    if (!is_known[g])
      common.row(g) = row;
    else if (common.row(g) != row)
      return {};
    is_known[g] = 1;
  }
  return common;
}

Columns GroupWeights::spread(const Columns& of_groups, const Columns& values, const SurfaceFields& fields,
                             const Context& context) const {
  // Sums up differences from one group of the component, so that a constant stays exactly constant.
  std::vector<Index> first_group(fields.constrained_components().size(), -1);
  for (std::size_t v = 0; v < group_.size(); ++v)
    if (group_[v] >= 0 && first_group[fields.component()[v]] < 0)
      first_group[fields.component()[v]] = group_[v];
  Columns spread(values.rows(), values.cols());
  parallel_blocks(
      group_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          const auto row = static_cast<Eigen::Index>(v);
          const Index component = fields.component()[v], first = component < 0 ? -1 : first_group[component];
          spread.row(row) = group_[v] >= 0 || first < 0 ? values.row(row) : of_groups.row(first);
          if (group_[v] >= 0 || first < 0) continue;
          for (Index g = 0; g < count_; ++g)
            spread.row(row) += weights_(row, g) * (of_groups.row(g) - of_groups.row(first));
        }
      },
      context);
  return spread;
}

}  // namespace meshgraft
