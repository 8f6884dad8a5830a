#include "group_weights.h"

#include "core/parallel.h"
#include "limb_faces.h"

namespace meshgraft {

GroupWeights::GroupWeights(const IndexLists& rings, std::span<const std::uint8_t> given,
                           const SurfaceFields& fields, const Context& context)
    : group_(rings.size(), -1), first_group_(rings.size(), -1) {
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
  std::vector<Index> first_of(fields.constrained_components().size(), -1);
  for (std::size_t v = 0; v < group_.size(); ++v)
    if (group_[v] >= 0 && first_of[fields.component()[v]] < 0) first_of[fields.component()[v]] = group_[v];
  for (std::size_t v = 0; v < group_.size(); ++v)
    if (fields.component()[v] >= 0) first_group_[v] = first_of[fields.component()[v]];
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

Columns GroupWeights::spread(const Columns& of_groups, Columns values, const Context& context) const {
  // Sums up differences from one group of the component, so that a constant stays exactly constant.
  parallel_blocks(
      group_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          const Index first = first_group_[v];
          if (group_[v] >= 0 || first < 0) continue;
          const auto row = static_cast<Eigen::Index>(v);
          values.row(row) = of_groups.row(first);
          for (Index g = 0; g < count_; ++g)
            values.row(row) += weights_(row, g) * (of_groups.row(g) - of_groups.row(first));
        }
      },
      context);
  return values;
}

}  // namespace meshgraft
