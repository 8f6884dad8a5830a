#include "parallel_solver.h"

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include <meshgraft/core/error.h>

#include "distributed/facts.h"
#include "linalg/facts.h"
#include "petsc_objects.h"
#include "prolongation.h"

namespace meshgraft::distributed {

namespace {

/// Returns a number of unknowns as PETSc's. Throws Error(input) if PETSc can not number so many.
PetscInt petsc_int(Number number) {
  if (number > std::numeric_limits<PetscInt>::max())
    throw Error(facts::distributed::NeedsWideIndices{.unknowns = number});
  return static_cast<PetscInt>(number);
}

/// Makes a matrix of a rank's rows. `own_columns` is the rank's number of columns.
OwnedMat make_matrix(const Communicator& comm, MatrixRows rows, Number own_columns, int column_block) {
  const Number own_rows = static_cast<Number>(rows.offsets.size()) - 1;
  OwnedMat matrix;
  require(MatCreate(comm.get(), matrix.out()));
  require(MatSetSizes(matrix, petsc_int(own_rows), petsc_int(own_columns), PETSC_DETERMINE, PETSC_DETERMINE));
  require(MatSetBlockSizes(matrix, 1, column_block));
  require(MatSetType(matrix, MATAIJ));
  std::vector<PetscInt> offsets(rows.offsets.size()), columns(rows.columns.size());
  std::transform(rows.offsets.begin(), rows.offsets.end(), offsets.begin(), petsc_int);
  std::transform(rows.columns.begin(), rows.columns.end(), columns.begin(), petsc_int);
  std::vector<Number>().swap(rows.columns);
  require(MatSeqAIJSetPreallocationCSR(matrix, offsets.data(), columns.data(), rows.values.data()));
  require(MatMPIAIJSetPreallocationCSR(matrix, offsets.data(), columns.data(), rows.values.data()));
  return matrix;
}

/// Computes Pᵀ N P, and frees what PETSc would keep for a second product, N P among it.
OwnedMat galerkin_product(Mat matrix, Mat prolongation) {
  OwnedMat product;
  require(MatProductCreate(matrix, prolongation, nullptr, product.out()));
  require(MatProductSetType(product, MATPRODUCT_PtAP));
  require(MatProductSetFromOptions(product));
  require(MatProductSymbolic(product));
  require(MatProductNumeric(product));
  require(MatProductClear(product));
  return product;
}

/// Gives the rows of a matrix that are zero, the unknowns without a function, a unit diagonal.
void fill_empty_rows(Mat matrix) {
  OwnedVec diagonal;
  require(MatCreateVecs(matrix, diagonal.out(), nullptr));
  require(MatGetDiagonal(matrix, diagonal));
  PetscScalar* values = nullptr;
  PetscInt count = 0;
  require(VecGetLocalSize(diagonal, &count));
  require(VecGetArray(diagonal, &values));
  for (PetscInt k = 0; k < count; ++k) values[k] = values[k] > 0 ? 0 : 1;
  require(VecRestoreArray(diagonal, &values));
  require(MatDiagonalSet(matrix, diagonal, ADD_VALUES));
}

/// Sets an option of PETSc unless it is set.
void set_default_option(const std::string& name, const char* value) {
  PetscBool is_set = PETSC_FALSE;
  require(PetscOptionsHasName(nullptr, nullptr, name.c_str(), &is_set));
  if (is_set == PETSC_FALSE) require(PetscOptionsSetValue(nullptr, name.c_str(), value));
}

/// Attaches the vectors that have (nearly) no energy, the columns of `vectors`, made orthonormal.
void set_near_null_space(Mat matrix, const Eigen::MatrixXd& vectors) {
  std::vector<OwnedVec> handles(vectors.cols());
  std::vector<Vec> kept;
  for (Eigen::Index k = 0; k < vectors.cols(); ++k) {
    OwnedVec& vector = handles[k];
    require(MatCreateVecs(matrix, vector.out(), nullptr));
    PetscScalar* values = nullptr;
    require(VecGetArray(vector, &values));
    std::copy_n(vectors.col(k).data(), vectors.rows(), values);
    require(VecRestoreArray(vector, &values));
    PetscReal before = 0, after = 0;
    require(VecNorm(vector, NORM_2, &before));
    for (int pass = 0; pass < 2; ++pass)
      for (const Vec other : kept) {
        PetscScalar product = 0;
        require(VecDot(vector, other, &product));
        require(VecAXPY(vector, -product, other));
      }
    require(VecNorm(vector, NORM_2, &after));
    constexpr double dependent = 1e-8;  // of a surface that lies in a plane
    if (!(after > dependent * before)) continue;
    require(VecScale(vector, 1 / after));
    kept.push_back(vector);
  }
  OwnedNullSpace space;
  require(MatNullSpaceCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), PETSC_FALSE,
                             static_cast<PetscInt>(kept.size()), kept.data(), space.out()));
  require(MatSetNearNullSpace(matrix, space));
}

/// Counts what PETSc does under the name of a stage, until it is destroyed. `-log_view` shows the stages apart.
class LogStage {
 public:
  explicit LogStage(const char* name) {
    PetscLogStage stage = -1;
    require(PetscLogStageGetId(name, &stage));
    if (stage < 0) require(PetscLogStageRegister(name, &stage));
    require(PetscLogStagePush(stage));
  }
  LogStage(const LogStage&) = delete;
  LogStage& operator=(const LogStage&) = delete;
  ~LogStage() { PetscLogStagePop(); }
};

constexpr const char* set_up_stage = "Set-up";
constexpr const char* fine_stage = "Fine grid";
constexpr const char* coarse_stage = "Coarse grid";

/// Applies a preconditioner of N to interleaved columns, one after another.
struct ColumnByColumn {
  KSP solver = nullptr;
  int width = 1;
  OwnedVec x, y;

  static PetscErrorCode apply(PC preconditioner, Vec from, Vec to) {
    void* context = nullptr;
    PetscCall(PCShellGetContext(preconditioner, &context));
    auto* self = static_cast<ColumnByColumn*>(context);
    const LogStage stage(coarse_stage);
    for (int column = 0; column < self->width; ++column) {
      PetscCall(VecStrideGather(from, column, self->x, INSERT_VALUES));
      PetscCall(KSPSolve(self->solver, self->x, self->y));
      PetscCall(VecStrideScatter(self->y, column, to, INSERT_VALUES));
    }
    return 0;
  }
};

/// Divides interleaved columns by the diagonal of N.
struct DiagonalScaling {
  OwnedVec inverse;
  int width = 1;

  static PetscErrorCode apply(PC preconditioner, Vec from, Vec to) {
    void* context = nullptr;
    PetscCall(PCShellGetContext(preconditioner, &context));
    const auto* self = static_cast<const DiagonalScaling*>(context);
    const PetscScalar *x = nullptr, *d = nullptr;
    PetscScalar* y = nullptr;
    PetscInt count = 0;
    PetscCall(VecGetLocalSize(self->inverse, &count));
    PetscCall(VecGetArrayRead(from, &x));
    PetscCall(VecGetArrayRead(self->inverse, &d));
    PetscCall(VecGetArray(to, &y));
    for (PetscInt k = 0; k < count; ++k)
      for (int column = 0; column < self->width; ++column)
        y[k * self->width + column] = d[k] * x[k * self->width + column];
    PetscCall(VecRestoreArray(to, &y));
    PetscCall(VecRestoreArrayRead(self->inverse, &d));
    PetscCall(VecRestoreArrayRead(from, &x));
    return 0;
  }
};

OwnedVec inverse_diagonal(Mat matrix) {
  OwnedVec inverse;
  require(MatCreateVecs(matrix, inverse.out(), nullptr));
  require(MatGetDiagonal(matrix, inverse));
  require(VecReciprocal(inverse));
  return inverse;
}

/// Returns what PETSc has sent and received so far on this rank.
Traffic traffic_so_far() {
  return {.messages = petsc_irecv_ct + petsc_isend_ct + petsc_recv_ct + petsc_send_ct,
          .bytes = petsc_irecv_len + petsc_isend_len + petsc_recv_len + petsc_send_len,
          .reductions = petsc_allreduce_ct + petsc_gather_ct + petsc_scatter_ct};
}

Number iterations_of(KSP solver) {
  PetscInt iterations = 0;
  require(KSPGetTotalIterations(solver, &iterations));
  return iterations;
}

/// The solver of systems with one number of columns.
struct WidthSolver {
  OwnedMat matrix, coarse, prolongation;  ///< interleaved
  ColumnByColumn by_column;
  DiagonalScaling scaling;
  OwnedKsp cg;
  OwnedVec x, y;
};

}  // namespace

struct ParallelSolver::Impl {
  const Communicator& comm;
  ParallelSolverOptions options;
  OwnedMat matrix, coarse, prolongation;
  OwnedKsp inner;  ///< applies the coarse grid's preconditioner, or the whole one
  ParallelStatistics figures;
  bool iterates_on_coarse_grid = false;
  std::map<int, std::unique_ptr<WidthSolver>> by_width;

  Impl(const Communicator& communicator, const ParallelSolverOptions& chosen)
      : comm(communicator), options(chosen) {}

  void set_up_blended(const UnknownNodes& nodes);
  void set_up_inner(Mat of, const char* type, const std::string& prefix);
  WidthSolver& solver_of(int width);
  void add_multigrid(WidthSolver& solver, int width);
};

void ParallelSolver::Impl::set_up_blended(const UnknownNodes& nodes) {
  Prolongation grid = make_prolongation(comm, nodes);
  const Number own = grid.starts[comm.rank() + 1] - grid.starts[comm.rank()];
  prolongation = make_matrix(comm, std::move(grid.rows), own, 4);
  coarse = galerkin_product(matrix, prolongation);
  fill_empty_rows(coarse);
  require(MatSetOption(coarse, MAT_SPD, PETSC_TRUE));
  set_near_null_space(coarse, grid.affine);
  MatInfo info;
  require(MatGetInfo(coarse, MAT_GLOBAL_SUM, &info));
  figures.coarse_unknowns = grid.starts.back();
  figures.operator_complexity = 1 + info.nz_used / static_cast<double>(figures.matrix_nonzeros);
  const std::string prefix = options.prefix + "coarse_";
  PetscBool is_chosen = PETSC_FALSE;
  require(PetscOptionsHasName(nullptr, prefix.c_str(), "-pc_type", &is_chosen));
#ifdef PETSC_HAVE_MUMPS
  // A factor is quicker as long as it fits: half the time of a solve at one and at four million vertices.
  constexpr Number most_to_factorise = 700'000;
#else
  constexpr Number most_to_factorise = 0;
#endif
  iterates_on_coarse_grid = is_chosen == PETSC_TRUE || figures.coarse_unknowns > most_to_factorise;
  set_up_inner(coarse, iterates_on_coarse_grid ? PCGAMG : PCCHOLESKY, "coarse_");
}

/// Makes the solver of the coarse grid: a factor, or a few iterations of conjugate gradients. For other
/// preconditioners of N makes one that applies them once. PETSc's options may ask for something else.
void ParallelSolver::Impl::set_up_inner(Mat of, const char* type, const std::string& prefix) {
  require(KSPCreate(comm.get(), inner.out()));
  require(KSPSetOptionsPrefix(inner, (options.prefix + prefix).c_str()));
  require(KSPSetOperators(inner, of, of));
  const bool is_factorised = std::string_view(type) == PCCHOLESKY;
  if (of == coarse && !is_factorised) {
    constexpr double tolerance = 0.05;
    constexpr int most_iterations = 16;
    require(KSPSetType(inner, KSPCG));
    require(KSPSetNormType(inner, KSP_NORM_NATURAL));
    require(KSPSetTolerances(inner, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, most_iterations));
  } else {
    require(KSPSetType(inner, KSPPREONLY));
  }
  PC preconditioner = nullptr;
  require(KSPGetPC(inner, &preconditioner));
  require(PCSetType(preconditioner, type));
  if (is_factorised) {
    require(PCFactorSetMatSolverType(preconditioner, MATSOLVERMUMPS));
    // MUMPS maps work to ranks by their load. On busy cores a rank may need more workspace than the analysis
    // foresees, and its usual allowance of 20 % was once too small by a few thousand numbers.
    set_default_option("-" + options.prefix + prefix + "mat_mumps_icntl_14", "60");
  } else if (of == coarse) {
    // Each aggregate has four functions, whose blocks are inverted together. A rank with few unknowns of a
    // level costs more messages than it saves work.
    constexpr PetscInt unknowns_per_rank = 1000;
    require(PCGAMGSetProcEqLim(preconditioner, unknowns_per_rank));
    set_default_option("-" + options.prefix + prefix + "mg_levels_pc_type", PCPBJACOBI);
  }
  require(KSPSetFromOptions(inner));
  require(KSPSetUp(inner));
}

/// Adds the multigrid cycle: Chebyshev smoothing on all columns together, then the coarse grid column by
/// column.
void ParallelSolver::Impl::add_multigrid(WidthSolver& solver, int width) {
  require(MatCreateMAIJ(prolongation, width, solver.prolongation.out()));
  require(MatCreateMAIJ(coarse, width, solver.coarse.out()));
  PC multigrid = nullptr;
  require(KSPGetPC(solver.cg, &multigrid));
  require(PCSetType(multigrid, PCMG));
  require(PCMGSetLevels(multigrid, 2, nullptr));
  require(PCMGSetType(multigrid, PC_MG_MULTIPLICATIVE));
  require(PCMGSetGalerkin(multigrid, PC_MG_GALERKIN_NONE));
  require(PCMGSetInterpolation(multigrid, 1, solver.prolongation));

  KSP smoother = nullptr, coarsest = nullptr;
  PC scaling = nullptr, columns = nullptr;
  require(PCMGGetSmoother(multigrid, 1, &smoother));
  require(KSPSetOperators(smoother, solver.matrix, solver.matrix));
  require(KSPSetType(smoother, KSPCHEBYSHEV));
  constexpr int degree = 2;
  // Bounds of eigenvalues from conjugate gradients need three vectors, those from GMRES twelve.
  set_default_option("-" + options.prefix + "mg_levels_esteig_ksp_type", KSPCG);
  require(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, degree));
  require(KSPGetPC(smoother, &scaling));
  require(PCSetType(scaling, PCSHELL));
  solver.scaling.inverse = inverse_diagonal(matrix);
  solver.scaling.width = width;
  require(PCShellSetContext(scaling, &solver.scaling));
  require(PCShellSetApply(scaling, DiagonalScaling::apply));

  require(PCMGGetCoarseSolve(multigrid, &coarsest));
  require(KSPSetOperators(coarsest, solver.coarse, solver.coarse));
  require(KSPSetType(coarsest, KSPPREONLY));
  require(KSPGetPC(coarsest, &columns));
  require(PCSetType(columns, PCSHELL));
  require(PCShellSetContext(columns, &solver.by_column));
  require(PCShellSetApply(columns, ColumnByColumn::apply));
}

WidthSolver& ParallelSolver::Impl::solver_of(int width) {
  std::unique_ptr<WidthSolver>& known = by_width[width];
  if (known) return *known;
  petsc_int(width * figures.unknowns);
  const LogStage stage(set_up_stage);
  known = std::make_unique<WidthSolver>();
  WidthSolver& solver = *known;
  require(MatCreateMAIJ(matrix, width, solver.matrix.out()));
  require(MatCreateVecs(solver.matrix, solver.x.out(), solver.y.out()));
  require(KSPCreate(comm.get(), solver.cg.out()));
  require(KSPSetOptionsPrefix(solver.cg, options.prefix.c_str()));
  require(KSPSetOperators(solver.cg, solver.matrix, solver.matrix));
  const bool is_flexible = options.preconditioner == Preconditioner::blended;  // the coarse solve is inexact
  require(KSPSetType(solver.cg, options.direct ? KSPPREONLY : is_flexible ? KSPFCG : KSPCG));
  if (is_flexible) {
    constexpr PetscInt kept_directions = 1;
    require(KSPFCGSetMmax(solver.cg, kept_directions));
    require(KSPFCGSetNprealloc(solver.cg, kept_directions));
  }
  require(KSPSetNormType(solver.cg, options.direct ? KSP_NORM_NONE : KSP_NORM_NATURAL));
  solver.by_column.solver = inner;
  solver.by_column.width = width;
  Mat of = nullptr;
  require(KSPGetOperators(inner, &of, nullptr));
  require(MatCreateVecs(of, solver.by_column.x.out(), solver.by_column.y.out()));
  if (options.preconditioner == Preconditioner::blended) {
    add_multigrid(solver, width);
  } else {
    PC columns = nullptr;
    require(KSPGetPC(solver.cg, &columns));
    require(PCSetType(columns, PCSHELL));
    require(PCShellSetContext(columns, &solver.by_column));
    require(PCShellSetApply(columns, ColumnByColumn::apply));
  }
  require(KSPSetFromOptions(solver.cg));
  require(KSPSetUp(solver.cg));
  return solver;
}

ParallelSolver::ParallelSolver(const Communicator& comm, MatrixRows rows, const UnknownNodes& nodes,
                               const ParallelSolverOptions& options)
    : impl_(std::make_unique<Impl>(comm, options)) {
  Impl& d = *impl_;
  start_petsc();
  const LogStage stage(set_up_stage);
  const Number own = static_cast<Number>(rows.offsets.size()) - 1;
  d.figures.unknowns = comm.sum(own);
  d.figures.matrix_nonzeros = comm.sum(rows.offsets.back());
  constexpr Number columns = 3;  // x, y and z, interleaved
  petsc_int(columns * d.figures.unknowns);
  d.matrix = make_matrix(comm, std::move(rows), own, 1);
  require(MatSetOption(d.matrix, MAT_SPD, PETSC_TRUE));
  switch (options.preconditioner) {
    case Preconditioner::blended: d.set_up_blended(nodes); break;
    case Preconditioner::gamg: d.set_up_inner(d.matrix, PCGAMG, "inner_"); break;
    case Preconditioner::hypre: d.set_up_inner(d.matrix, PCHYPRE, "inner_"); break;
    case Preconditioner::mumps: d.set_up_inner(d.matrix, PCCHOLESKY, "inner_"); break;
  }
}

ParallelSolver::ParallelSolver(ParallelSolver&&) noexcept = default;
ParallelSolver::~ParallelSolver() = default;

Columns ParallelSolver::solve(const Columns& rhs, double tolerance, const Columns* guess) const {
  constexpr int most_iterations = 1000;
  const auto width = static_cast<int>(rhs.cols());
  if (width == 1) {  // the interleaved matrix of one column is N itself, whose vectors PETSc 3.18 frees twice
    Columns two = Columns::Zero(rhs.rows(), 2), two_guesses = two;
    two.col(0) = rhs.col(0);
    if (guess != nullptr) two_guesses.col(0) = guess->col(0);
    return solve(two, tolerance, guess != nullptr ? &two_guesses : nullptr).leftCols(1);
  }
  WidthSolver& solver = impl_->solver_of(width);
  const auto write = [](const Columns& from, Vec to) {
    PetscScalar* values = nullptr;
    require(VecGetArray(to, &values));
    std::copy_n(from.data(), from.size(), values);
    require(VecRestoreArray(to, &values));
  };
  write(rhs, solver.y);
  if (guess != nullptr) write(*guess, solver.x);
  require(KSPSetInitialGuessNonzero(solver.cg, guess != nullptr ? PETSC_TRUE : PETSC_FALSE));
  require(KSPSetTolerances(solver.cg, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, most_iterations));
  ParallelStatistics& figures = impl_->figures;
  const Traffic before = traffic_so_far();
  const Number cycles_before = iterations_of(impl_->inner);
  {
    const LogStage stage(fine_stage);
    require(KSPSolve(solver.cg, solver.y, solver.x));
  }
  const Traffic after = traffic_so_far();
  figures.traffic.messages += after.messages - before.messages;
  figures.traffic.bytes += after.bytes - before.bytes;
  figures.traffic.reductions += after.reductions - before.reductions;
  if (impl_->iterates_on_coarse_grid) figures.coarse_iterations += iterations_of(impl_->inner) - cycles_before;

  KSPConvergedReason reason;
  PetscInt iterations = 0;
  PetscReal left = 0;
  require(KSPGetConvergedReason(solver.cg, &reason));
  require(KSPGetIterationNumber(solver.cg, &iterations));
  require(KSPGetResidualNorm(solver.cg, &left));
  figures.iterations = static_cast<int>(iterations);
  figures.all_iterations += iterations;
  if (reason < 0)
    throw Error(facts::linalg::NotConverged{
        .iterations = static_cast<int>(iterations), .error = left, .tolerance = tolerance});
  Columns solution(rhs.rows(), width);
  const PetscScalar* values = nullptr;
  require(VecGetArrayRead(solver.x, &values));
  std::copy_n(values, solution.size(), solution.data());
  require(VecRestoreArrayRead(solver.x, &values));
  return solution;
}

ParallelStatistics ParallelSolver::statistics() const { return impl_->figures; }

}  // namespace meshgraft::distributed
