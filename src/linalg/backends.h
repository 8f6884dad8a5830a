#pragma once

#include <memory>

#include <meshgraft/linalg/linear_solver.h>

#include "matrix_change.h"

namespace meshgraft {

std::unique_ptr<LinearSolver> make_multifrontal_solver();  // defined only if it is built in
std::unique_ptr<LinearSolver> make_eigen_solver();
std::unique_ptr<LinearSolver> make_iterative_solver();

/// Fills the bisection tree of a graph, unless it is filled or the multifrontal solver would not use it.
void bisect_for_multifrontal(const OrderingGraph& graph, const Context& context);  // if it is built in

/// Returns a solver with the analysis of `solver` and no factorisation, for another matrix of the same pattern.
/// Returns null if its backend has no analysis to share.
std::unique_ptr<LinearSolver> copy_analysis(const LinearSolver& solver);
std::unique_ptr<LinearSolver> copy_multifrontal_analysis(const LinearSolver& solver);  // if it is built in

/// Returns a solver with the factor of a changed matrix. It shares most of the factor of `solver`, which must
/// have factorised N. Returns null if the backend cannot do so, if it would save little work, or if the changed
/// matrix is not positive definite.
std::unique_ptr<LinearSolver> change_factor(const LinearSolver& solver, const MatrixChange& change,
                                            const Context& context);
std::unique_ptr<LinearSolver> change_multifrontal_factor(const LinearSolver& solver, const MatrixChange& change,
                                                         const Context& context);  // if it is built in

/// Rounds a factor to single precision, which serves a preconditioner and takes half the memory, if the backend
/// can.
void round_factor(LinearSolver& solver);
void round_multifrontal_factor(LinearSolver& solver);  // if it is built in

}  // namespace meshgraft
