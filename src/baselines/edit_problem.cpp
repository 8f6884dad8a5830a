#include "edit_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "baselines/facts.h"
#include "core/parallel.h"
#include "deform/facts.h"
#include "deform/setup/checks.h"
#include "deform/setup/region_mask.h"
#include "linalg/sparse.h"
#include "mesh/disjoint_sets.h"

namespace meshgraft::baselines {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The constraints of all vertices of the mesh, one entry per vertex.
struct Given {
  ConstraintMask mask;
  std::vector<const VertexConstraint*> constraint;
};

void require_finite(const VertexConstraint& constraint) {
  constexpr double largest = 1e100;  // squares and volumes stay finite
  if ((constraint.position && !(constraint.position->cwiseAbs().maxCoeff() < largest)) ||
      (constraint.transform && !(constraint.transform->cwiseAbs().maxCoeff() < largest)))
    throw Error(facts::baselines::ConstraintNotFinite{.vertex = constraint.vertex},
                Location::place(fmt::format("the constraint of vertex {}", constraint.vertex)));
}

Given read_constraints(const DeformProblem& edit) {
  const auto count = static_cast<Index>(edit.rest.rows());
  const std::vector<VertexConstraint>& constraints = edit.constraints;
  if (!edit.region.handles.empty() || !edit.region.anchors.empty() || !edit.region.features.empty())
    throw Error(facts::baselines::OnlyConstraints{});
  Given given{mask_of_region(count, edit.region), std::vector<const VertexConstraint*>(edit.rest.rows())};
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    const VertexConstraint& constraint = constraints[c];
    const Location location = Location("constraints")[c];
    require_vertex(constraint.vertex, count, location);
    if (given.constraint[constraint.vertex] != nullptr)
      throw Error(facts::deform::VertexNamedTwice{.vertex = constraint.vertex}, location);
    if (!constraint.position && !constraint.transform)
      throw Error(facts::deform::VertexConstrainsNothing{.vertex = constraint.vertex}, location);
    require_finite(constraint);
    given.constraint[constraint.vertex] = &constraint;
    if (constraint.position) given.mask.position[constraint.vertex] = 1;
    if (constraint.transform) given.mask.transform[constraint.vertex] = 1;
  }
  return given;
}

void place_known(const Points& rest, const Given& given, EditProblem& problem) {
  const Patch& patch = problem.patch;
  const Index n = patch.size();
  problem.mask = given.mask.of(patch.vertices);
  problem.transforms.assign(n, Matrix3d::Identity());
  problem.start = patch.points;
  Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
  Index count = 0;
  for (Index v = 0; v < n; ++v) {
    const Index global = patch.vertices[v];
    const VertexConstraint* constraint = given.constraint[global];
    if (constraint != nullptr && constraint->transform) problem.transforms[v] = *constraint->transform;
    if (!problem.mask.position[v]) continue;
    if (constraint != nullptr && constraint->position)
      problem.start.row(v) += (constraint->position->transpose() - rest.row(global)) / patch.scale;
    mean += problem.start.row(v) - patch.points.row(v);
    ++count;
  }
  if (count == 0) return;
  mean /= static_cast<double>(count);
  for (Index v = 0; v < n; ++v)
    if (!problem.mask.position[v]) problem.start.row(v) += mean;
}

/// Requires a known position in every free component, because the component could lie anywhere without one.
void require_held(const EditProblem& problem) {
  DisjointSets sets(problem.size());
  for (Index v = 0; v < problem.size(); ++v)
    for (Index w : problem.rings[v])
      if (!problem.mask.position[v] && !problem.mask.position[w]) sets.unite(v, w);
  Flags held(problem.mask.position.size(), 0);
  for (Index v = 0; v < problem.size(); ++v)
    for (Index w : problem.rings[v])
      if (!problem.mask.position[v] && problem.mask.position[w]) held[sets.root(v)] = 1;
  for (Index v = 0; v < problem.size(); ++v) {
    if (problem.mask.position[v] || held[sets.root(v)]) continue;
    throw Error(facts::baselines::FreeComponentNotHeld{.vertex = problem.patch.vertices[v]});
  }
}

}  // namespace

EditProblem make_problem(const DeformProblem& edit, int depth, const Context& context) {
  const auto n = static_cast<Index>(edit.rest.rows());
  const IndexLists faces_around = vertex_triangles(n, edit.triangles, context);
  const Given given = read_constraints(edit);
  const IndexLists rings = vertex_rings(edit.triangles, faces_around, context);
  Flags free(given.mask.position.size());
  for (Index v = 0; v < n; ++v) free[v] = !given.mask.position[v] && !rings[v].empty();

  EditProblem problem;
  problem.patch = make_patch(edit.rest, edit.triangles, faces_around, free, depth, context);
  if (problem.size() == 0) return problem;
  problem.faces_around = vertex_triangles(problem.size(), problem.triangles(), context);
  problem.rings = vertex_rings(problem.triangles(), problem.faces_around, context);
  place_known(edit.rest, given, problem);
  require_held(problem);
  return problem;
}

Vector3d half_cotangents(const Points& points, const Triangles& triangles, Index face) {
  Vector3d dots, squares;
  double area2 = 0;
  for (int k = 0; k < 3; ++k) {
    const Index i = triangles(face, (k + 1) % 3), j = triangles(face, (k + 2) % 3);
    if (i == j) return Vector3d::Zero();
    const Eigen::RowVector3d a = points.row(i) - points.row(triangles(face, k)),
                             b = points.row(j) - points.row(triangles(face, k));
    dots[k] = a.dot(b);
    squares[k] = a.squaredNorm();
    area2 = std::max(area2, a.cross(b).norm());
  }
  const double least = 1e-6 * squares.maxCoeff();
  if (!(least > 0)) return Vector3d::Zero();
  return 0.5 * dots / std::max(area2, least);
}

SparseRows cotangent_laplacian(const EditProblem& problem) {
  const Triangles& triangles = problem.triangles();
  const Index n = problem.size();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(6 * triangles.rows() + n);
  for (Index v = 0; v < n; ++v) entries.emplace_back(v, v, 0.0);
  for (Index t = 0; t < triangles.rows(); ++t) {
    const Vector3d half = half_cotangents(problem.rest(), triangles, t);
    for (int k = 0; k < 3; ++k) {
      const Index i = triangles(t, (k + 1) % 3), j = triangles(t, (k + 2) % 3);
      if (i == j) continue;
      entries.emplace_back(i, j, half[k]);
      entries.emplace_back(j, i, half[k]);
    }
  }
  SparseRows C(n, n);
  C.setFromTriplets(entries.begin(), entries.end());
  for (Index i = 0; i < n; ++i) {
    double sum = 0;
    double* diagonal = nullptr;
    for (SparseRows::InnerIterator entry(C, i); entry; ++entry) {
      if (entry.col() == i) {
        diagonal = &entry.valueRef();
        continue;
      }
      const double weight = std::clamp(entry.value(), 1e-6, 1e6);
      entry.valueRef() = -weight;
      sum += weight;
    }
    *diagonal = sum;
  }
  return C;
}

std::vector<double> mixed_areas(const EditProblem& problem) {
  const Triangles& triangles = problem.triangles();
  std::vector<double> areas(problem.size(), 0.0);
  for (Index t = 0; t < triangles.rows(); ++t) {
    const Vector3d half = half_cotangents(problem.rest(), triangles, t);
    const auto corner = [&](int k) -> Eigen::RowVector3d { return problem.rest().row(triangles(t, k % 3)); };
    const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (int k = 0; k < 3; ++k) {
      double part = 0;
      if (half.minCoeff() >= 0) {  // Voronoi
        part = 0.25 * (half[(k + 1) % 3] * (corner(k + 2) - corner(k)).squaredNorm() +
                       half[(k + 2) % 3] * (corner(k + 1) - corner(k)).squaredNorm());
      } else {
        part = half[k] < 0 ? area / 2 : area / 4;
      }
      areas[triangles(t, k)] += part;
    }
  }
  double mean = 0;
  for (double area : areas) mean += area / static_cast<double>(areas.size());
  for (double& area : areas) area = mean > 0 ? std::max(area, 1e-6 * mean) : 1.0;
  return areas;
}

namespace {

Matrix3d frame_rotation(Index vertex, std::span<const Index> ring, const Points& from, const Vector3d& normal,
                        const Points& to, const Vector3d& new_normal) {
  if (normal.isZero() || new_normal.isZero()) return Matrix3d::Identity();
  const Matrix3d tilt = Eigen::Quaterniond::FromTwoVectors(normal, new_normal).toRotationMatrix();
  double sine = 0, cosine = 0;
  for (Index w : ring) {
    const Vector3d old_edge = tilt * (from.row(w) - from.row(vertex)).transpose();
    const Vector3d edge = (to.row(w) - to.row(vertex)).transpose();
    sine += new_normal.dot(old_edge.cross(edge));
    cosine += old_edge.dot(edge) - old_edge.dot(new_normal) * edge.dot(new_normal);
  }
  return Eigen::AngleAxisd(std::atan2(sine, cosine), new_normal) * tilt;
}

}  // namespace

std::vector<Matrix3d> frame_rotations(const EditProblem& problem, const Points& from,
                                      const Points& from_normals, const Points& to, const Points& to_normals,
                                      const Context& context) {
  std::vector<Matrix3d> rotations(problem.size());
  parallel_blocks(
      rotations.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          const auto vertex = static_cast<Index>(v);
          rotations[v] =
              frame_rotation(vertex, problem.rings[vertex], from, from_normals.row(vertex).transpose(), to,
                             to_normals.row(vertex).transpose());
        }
      },
      context);
  return rotations;
}

KnownRowsSolver::KnownRowsSolver(const SparseRows& N, std::span<const std::uint8_t> known,
                                 SolverBackend backend, const Context& context)
    : solver_(make_solver(backend)) {
  std::vector<int> number(known.size(), -1);
  for (std::size_t row = 0; row < known.size(); ++row) {
    if (known[row]) continue;
    number[row] = static_cast<int>(unknowns_.size());
    unknowns_.push_back(static_cast<int>(row));
  }
  // Row r of the symmetric N equals its column r.
  const auto size = static_cast<Eigen::Index>(unknowns_.size());
  NormalMatrix lower(size, size);
  for (Eigen::Index column = 0; column < size; ++column) {
    lower.startVec(column);
    for (SparseRows::InnerIterator entry(N, unknowns_[column]); entry; ++entry)
      if (number[entry.col()] >= column) lower.insertBack(number[entry.col()], column) = entry.value();
  }
  lower.finalize();
  solver_->analyse(lower, {}, context);
  solver_->factorise(lower, context);
}

void KnownRowsSolver::correct(Columns& x, const Columns& residual, const Context& context) const {
  Eigen::MatrixXd rhs(static_cast<Eigen::Index>(unknowns_.size()), x.cols());
  for (Eigen::Index u = 0; u < rhs.rows(); ++u) rhs.row(u) = residual.row(unknowns_[u]);
  const Eigen::MatrixXd correction = solver_->solve(rhs, context);
  for (Eigen::Index u = 0; u < rhs.rows(); ++u) x.row(unknowns_[u]) += correction.row(u);
}

void KnownRowsSolver::solve(const SparseRows& N, const Columns& b, Columns& x, const Context& context,
                            int passes) const {
  for (int pass = 0; pass < passes; ++pass) correct(x, b - multiply(N, x, context), context);
}

void KnownRowsSolver::solve_least_squares(const SparseRows& A, const SparseRows& A_transposed, const Columns& b,
                                          Columns& x, const Context& context) const {
  for (int pass = 0; pass < 2; ++pass)
    correct(x, multiply(A_transposed, Columns(b - multiply(A, x, context)), context), context);
}

}  // namespace meshgraft::baselines
