#pragma once

#include <mpi.h>

#include <string>

namespace meshgraft::distributed {

/// MPI and PETSc for the time of a program.
class Session {
 public:
  /// Starts MPI.
  Session(int& argc, char**& argv);
  /// Ends PETSc, if it was started, and MPI.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  MPI_Comm comm() const { return MPI_COMM_WORLD; }
  bool is_first() const;
  /// Starts PETSc with options in its own words, e.g. "-log_view".
  void start_solvers(const std::string& options) const;
  /// Returns whether all ranks call this within some seconds. A rank that fails alone finds out so.
  bool all_arrive(double seconds) const;
  /// Ends the processes of all ranks with this status.
  [[noreturn]] void abort(int status) const;
};

}  // namespace meshgraft::distributed
