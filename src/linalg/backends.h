#pragma once

#include <memory>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

std::unique_ptr<LinearSolver> make_cholmod_solver();  // defined where CHOLMOD is built in
std::unique_ptr<LinearSolver> make_eigen_solver();
std::unique_ptr<LinearSolver> make_iterative_solver();

}  // namespace meshgraft
