#pragma once

#include <mpi.h>

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/error.h>

namespace meshgraft::distributed {

/// The number of a vertex, a face or an unknown among those of all ranks.
using Number = std::int64_t;

/// Lists for each rank, or from each rank.
template <class T>
using ByRank = std::vector<std::vector<T>>;

/// The ranks of an MPI communicator, which must outlive this object. All ranks call the same functions in the
/// same order, but for `rank`, `size` and `get`. Throws Error(internal) where MPI fails.
class Communicator {
 public:
  explicit Communicator(MPI_Comm comm);

  int rank() const { return rank_; }
  int size() const { return size_; }
  MPI_Comm get() const { return comm_; }

  /// Return the sum, the smallest and the largest of all ranks' values.
  Number sum(Number value) const;
  double sum(double value) const;
  Number smallest(Number value) const;
  double smallest(double value) const;
  Number largest(Number value) const;
  double largest(double value) const;
  bool any(bool value) const { return largest(Number{value}) != 0; }
  /// Returns the sums of all ranks' values, entry by entry.
  Eigen::VectorXd sum(const Eigen::VectorXd& values) const;
  /// Returns where the items of each rank start if those of all ranks are numbered in the order of the ranks:
  /// size + 1 numbers, the last one is the number of all items.
  std::vector<Number> starts(Number own) const;
  /// Returns the text of the rank `root` on all ranks.
  std::string broadcast(std::string text, int root = 0) const;

  /// Sends a list to each rank and returns the lists that came from each rank.
  template <class T>
  ByRank<T> exchange(const ByRank<T>& to) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<Number> counts(size_), received(size_);
    for (int rank = 0; rank < size_; ++rank) counts[rank] = static_cast<Number>(to[rank].size());
    exchange_counts(counts.data(), received.data());
    ByRank<T> from(size_);
    std::vector<Message> sent, expected;
    for (int rank = 0; rank < size_; ++rank) {
      from[rank].resize(received[rank]);
      if (rank == rank_) {
        from[rank] = to[rank];
        continue;
      }
      if (counts[rank] > 0) sent.push_back({rank, const_cast<T*>(to[rank].data()), counts[rank]});
      if (received[rank] > 0) expected.push_back({rank, from[rank].data(), received[rank]});
    }
    transfer(sent, expected, sizeof(T));
    return from;
  }

  /// A list of items to or from a rank.
  struct Message {
    int rank;
    void* items;
    Number count;
  };
  /// Sends and receives lists of items of `item_size` bytes, and waits for all of them.
  void transfer(const std::vector<Message>& sent, const std::vector<Message>& expected,
                std::size_t item_size) const;

  /// Does local work, which calls no function of the communicator. If it throws on some ranks, all ranks throw
  /// the error of the first one of these.
  template <class Work>
  void together(const Work& work) const {
    std::optional<Error> error;
    try {
      work();
    } catch (...) {
      error = current_error();
    }
    agree(error);
  }
  /// Throws on all ranks the error of the first rank that has one.
  void agree(const std::optional<Error>& error) const;

 private:
  void exchange_counts(const Number* to, Number* from) const;

  MPI_Comm comm_;
  int rank_ = 0, size_ = 1;
};

}  // namespace meshgraft::distributed
