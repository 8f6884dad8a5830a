#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "parallel_solver.h"

namespace meshgraft::distributed {

namespace {

struct Entry {
  Number row, column;
  double value;
};

}  // namespace

MatrixRows sum_contributions(const Communicator& comm, const Halo& unknowns, const NormalMatrix& lower) {
  // Entries of the halo's rows go to the owners of these rows. Both triangles are meant.
  const Index own = unknowns.own();
  const auto for_each_entry = [&](const auto& body) {
    for (Eigen::Index column = 0; column < lower.cols(); ++column)
      for (NormalMatrix::InnerIterator it(lower, column); it; ++it) {
        body(static_cast<Index>(it.row()), static_cast<Index>(column), it.value());
        if (it.row() != column) body(static_cast<Index>(column), static_cast<Index>(it.row()), it.value());
      }
  };
  ByRank<Entry> to(comm.size());
  std::vector<std::int64_t> begin(static_cast<std::size_t>(own) + 1, 0);
  for_each_entry([&](Index row, Index column, double value) {
    if (row < own) {
      ++begin[static_cast<std::size_t>(row) + 1];
    } else {
      const Number number = unknowns.number(row);
      to[unknowns.owner(number)].push_back({number, unknowns.number(column), value});
    }
  });
  const ByRank<Entry> received = comm.exchange(to);
  const auto local_row = [&](const Entry& entry) {
    return static_cast<std::size_t>(entry.row - unknowns.first());
  };
  for (const auto& list : received)
    for (const Entry& entry : list) ++begin[local_row(entry) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());

  MatrixRows sum;
  sum.columns.resize(begin.back());
  sum.values.resize(begin.back());
  std::vector<std::int64_t> next(begin.begin(), begin.end() - 1);
  const auto put = [&](std::size_t row, Number column, double value) {
    sum.columns[next[row]] = column;
    sum.values[next[row]++] = value;
  };
  for_each_entry([&](Index row, Index column, double value) {
    if (row < own) put(static_cast<std::size_t>(row), unknowns.number(column), value);
  });
  for (const auto& list : received)
    for (const Entry& entry : list) put(local_row(entry), entry.column, entry.value);

  // Sorts each row and adds up what is in one column. Rows only become shorter, so they stay in place.
  std::int64_t end = 0;
  std::vector<std::pair<Number, double>> entries;
  for (Index row = 0; row < own; ++row) {
    entries.clear();
    for (std::int64_t k = begin[row]; k < begin[row + 1]; ++k)
      entries.emplace_back(sum.columns[k], sum.values[k]);
    std::stable_sort(entries.begin(), entries.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [column, value] : entries) {
      if (end > sum.offsets.back() && sum.columns[end - 1] == column) {
        sum.values[end - 1] += value;
        continue;
      }
      sum.columns[end] = column;
      sum.values[end++] = value;
    }
    sum.offsets.push_back(end);
  }
  sum.columns.resize(end);
  sum.values.resize(end);
  return sum;
}

}  // namespace meshgraft::distributed
