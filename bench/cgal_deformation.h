#pragma once

#include "bench_edit.h"

namespace meshgraft::bench {

enum class CgalMethod { original_arap, spokes_and_rims, sre_arap };

struct CgalTimes {
  double construct_seconds = 0;   // the object's constructor (weights of all edges) and the constraints
  double preprocess_seconds = 0;  // preprocess(): assembly and factorisation
  double deform_seconds = 0;      // deform(iterations, 0)
};

struct CgalResult {
  CgalTimes times;
  Points positions;  // n×3
};

/// The clock of `CgalTimes`: real time, or the processor time of this process.
enum class CgalClock { wall, processor };

struct CgalOptions {
  unsigned iterations = 100;
  CgalClock clock = CgalClock::wall;
  double sre_alpha = 0.02;  ///< the weight of bending; CGAL's default
};

/// Runs the edit once through CGAL's Surface_mesh_deformation with its default weights and linear solver.
CgalResult run_cgal(const BenchEdit& edit, CgalMethod method, const CgalOptions& options = {});

}  // namespace meshgraft::bench
