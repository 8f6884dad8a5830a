#include "communicator.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "distributed/facts.h"
#include "error_text.h"

namespace meshgraft::distributed {

namespace {

void require_success(int status) {
  if (status == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(status, text, &length);
  throw Error(facts::distributed::CommunicationFailed{.reason = std::string(text, length)});
}

template <class T>
T reduce(const Communicator& comm, T value, MPI_Datatype type, MPI_Op operation) {
  T result = value;
  require_success(MPI_Allreduce(&value, &result, 1, type, operation, comm.get()));
  return result;
}

}  // namespace

Communicator::Communicator(MPI_Comm comm) : comm_(comm) {
  require_success(MPI_Comm_rank(comm, &rank_));
  require_success(MPI_Comm_size(comm, &size_));
}

Number Communicator::sum(Number value) const { return reduce(*this, value, MPI_INT64_T, MPI_SUM); }
double Communicator::sum(double value) const { return reduce(*this, value, MPI_DOUBLE, MPI_SUM); }
Number Communicator::smallest(Number value) const { return reduce(*this, value, MPI_INT64_T, MPI_MIN); }
double Communicator::smallest(double value) const { return reduce(*this, value, MPI_DOUBLE, MPI_MIN); }
Number Communicator::largest(Number value) const { return reduce(*this, value, MPI_INT64_T, MPI_MAX); }
double Communicator::largest(double value) const { return reduce(*this, value, MPI_DOUBLE, MPI_MAX); }

Eigen::VectorXd Communicator::sum(const Eigen::VectorXd& values) const {
  Eigen::VectorXd sums(values.size());
  require_success(
      MPI_Allreduce(values.data(), sums.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm_));
  return sums;
}

std::vector<Number> Communicator::starts(Number own) const {
  std::vector<Number> counts(size_), starts(size_ + 1, 0);
  require_success(MPI_Allgather(&own, 1, MPI_INT64_T, counts.data(), 1, MPI_INT64_T, comm_));
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  return starts;
}

std::string Communicator::broadcast(std::string text, int root) const {
  Number length = static_cast<Number>(text.size());
  require_success(MPI_Bcast(&length, 1, MPI_INT64_T, root, comm_));
  text.resize(length);
  constexpr Number most = std::numeric_limits<int>::max();
  for (Number begin = 0; begin < length; begin += most)
    require_success(MPI_Bcast(text.data() + begin, static_cast<int>(std::min(most, length - begin)), MPI_BYTE,
                              root, comm_));
  return text;
}

void Communicator::exchange_counts(const Number* to, Number* from) const {
  require_success(MPI_Alltoall(to, 1, MPI_INT64_T, from, 1, MPI_INT64_T, comm_));
}

void Communicator::transfer(const std::vector<Message>& sent, const std::vector<Message>& expected,
                            std::size_t item_size) const {
  constexpr int tag = 17;
  MPI_Datatype item;
  require_success(MPI_Type_contiguous(static_cast<int>(item_size), MPI_BYTE, &item));
  require_success(MPI_Type_commit(&item));
  std::vector<MPI_Request> requests(sent.size() + expected.size());
  std::size_t next = 0;
  for (const Message& message : expected)
    require_success(MPI_Irecv(message.items, static_cast<int>(message.count), item, message.rank, tag, comm_,
                              &requests[next++]));
  for (const Message& message : sent)
    require_success(MPI_Isend(message.items, static_cast<int>(message.count), item, message.rank, tag, comm_,
                              &requests[next++]));
  require_success(MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE));
  MPI_Type_free(&item);
}

void Communicator::agree(const std::optional<Error>& error) const {
  const Number first = smallest(error ? Number{rank_} : Number{size_});
  if (first == size_) return;
  const std::string text = broadcast(error ? text_of_error(*error) : std::string(), static_cast<int>(first));
  throw error_of_text(text);
}

}  // namespace meshgraft::distributed
