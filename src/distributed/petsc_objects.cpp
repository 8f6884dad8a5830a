#include "petsc_objects.h"

#include <string>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "distributed/facts.h"

namespace meshgraft::distributed {

void require(PetscErrorCode status) {
  if (status == 0) return;
  if (status == PETSC_ERR_MEM) throw Error(facts::core::OutOfMemory{});
  const char* text = nullptr;
  PetscErrorMessage(status, &text, nullptr);
  throw Error(
      facts::distributed::SolverFailed{.reason = text != nullptr ? std::string(text) : std::to_string(status)});
}

void start_petsc() {
  PetscBool started = PETSC_FALSE;
  require(PetscInitialized(&started));
  if (started == PETSC_TRUE) return;
  require(PetscInitializeNoArguments());
  require(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
}

}  // namespace meshgraft::distributed
