#include "label_sums.h"

namespace meshgraft::distributed {

namespace {

/// Brings the numbers of a label to one rank, combines them there, and returns the result to all that have
/// some.
template <class Combine>
LabelValues combine_by_label(const Communicator& comm, const LabelValues& own, const Combine& combine) {
  const auto rank_of = [&](Number label) { return static_cast<std::size_t>(label % comm.size()); };
  ByRank<Number> labels(comm.size());
  ByRank<double> numbers(comm.size());
  Eigen::Index width = 0;
  for (const auto& [label, values] : own) {
    width = values.size();
    labels[rank_of(label)].push_back(label);
    numbers[rank_of(label)].insert(numbers[rank_of(label)].end(), values.begin(), values.end());
  }
  width = static_cast<Eigen::Index>(comm.largest(Number{width}));
  const ByRank<Number> labels_from = comm.exchange(labels);
  ByRank<double> numbers_from = comm.exchange(numbers);
  LabelValues combined;
  const auto for_each_part = [&](const auto& body) {
    for (std::size_t rank = 0; rank < labels_from.size(); ++rank)
      for (std::size_t k = 0; k < labels_from[rank].size(); ++k)
        body(labels_from[rank][k], Eigen::Map<Eigen::VectorXd>(
                                       numbers_from[rank].data() + k * static_cast<std::size_t>(width), width));
  };
  for_each_part([&](Number label, const Eigen::Map<Eigen::VectorXd>& values) {
    const auto [entry, is_new] = combined.try_emplace(label, values);
    if (!is_new) entry->second = combine(entry->second, Eigen::VectorXd(values));
  });
  for_each_part([&](Number label, Eigen::Map<Eigen::VectorXd> values) { values = combined.at(label); });
  const ByRank<double> answers = comm.exchange(numbers_from);
  LabelValues result;
  for (std::size_t rank = 0; rank < labels.size(); ++rank)
    for (std::size_t k = 0; k < labels[rank].size(); ++k)
      result.emplace(labels[rank][k], Eigen::Map<const Eigen::VectorXd>(
                                          answers[rank].data() + k * static_cast<std::size_t>(width), width));
  return result;
}

}  // namespace

LabelValues sum_by_label(const Communicator& comm, const LabelValues& own) {
  return combine_by_label(comm, own, [](const auto& a, const auto& b) { return Eigen::VectorXd(a + b); });
}

LabelValues largest_by_label(const Communicator& comm, const LabelValues& own) {
  return combine_by_label(comm, own,
                          [](const auto& a, const auto& b) { return Eigen::VectorXd(a.cwiseMax(b)); });
}

}  // namespace meshgraft::distributed
