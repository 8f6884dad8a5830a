#pragma once

#include <memory>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

std::unique_ptr<LinearSolver> make_multifrontal_solver();  // defined only if it is built in
std::unique_ptr<LinearSolver> make_eigen_solver();
std::unique_ptr<LinearSolver> make_iterative_solver();

}  // namespace meshgraft
