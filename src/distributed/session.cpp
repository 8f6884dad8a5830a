#include "session.h"

#include <chrono>
#include <cstdlib>
#include <thread>

#include "core/platform/memory.h"

#include "petsc_objects.h"

namespace meshgraft::distributed {

Session::Session(int& argc, char**& argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  constexpr std::size_t large_block = std::size_t{1} << 25;  // smaller ones are mostly used again at once
  platform::map_large_blocks(large_block);
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
}

Session::~Session() {
  PetscBool started = PETSC_FALSE;
  PetscInitialized(&started);
  if (started == PETSC_TRUE) PetscFinalize();
  MPI_Finalize();
}

bool Session::is_first() const {
  int rank = 0;
  MPI_Comm_rank(comm(), &rank);
  return rank == 0;
}

void Session::start_solvers(const std::string& options) const {
  start_petsc();
  require(PetscOptionsInsertString(nullptr, options.c_str()));
  PetscBool log = PETSC_FALSE;
  require(PetscOptionsHasName(nullptr, nullptr, "-log_view", &log));
  if (log == PETSC_TRUE) require(PetscLogDefaultBegin());
}

bool Session::all_arrive(double seconds) const {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  MPI_Request request;
  MPI_Ibarrier(comm(), &request);
  int arrived = 0;
  while (arrived == 0 && Clock::now() < end) {
    MPI_Test(&request, &arrived, MPI_STATUS_IGNORE);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return arrived != 0;
}

void Session::abort(int status) const {
  MPI_Abort(comm(), status);
  std::abort();
}

}  // namespace meshgraft::distributed
