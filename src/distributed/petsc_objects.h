#pragma once

#include <petscksp.h>

#include <utility>

namespace meshgraft::distributed {

/// Throws Error(internal) with PETSc's message, or Error(memory), if a function of PETSc failed.
void require(PetscErrorCode status);

/// Starts PETSc before its first use in the process, unless the caller has started it. It is not ended here.
void start_petsc();

/// An object of PETSc, which is freed with this one.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class Owned {
 public:
  Owned() = default;
  Owned(Owned&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Owned() {
    if (object_ != nullptr) destroy(&object_);
  }
  operator Object() const { return object_; }
  /// Returns where a function of PETSc puts the object that it makes.
  Object* out() { return &object_; }

 private:
  Object object_ = nullptr;
};

using OwnedMat = Owned<Mat, MatDestroy>;
using OwnedVec = Owned<Vec, VecDestroy>;
using OwnedKsp = Owned<KSP, KSPDestroy>;
using OwnedNullSpace = Owned<MatNullSpace, MatNullSpaceDestroy>;

}  // namespace meshgraft::distributed
