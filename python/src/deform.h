#pragma once

#include <functional>
#include <memory>
#include <variant>
#include <vector>

#include <nanobind/nanobind.h>
#include <Eigen/Core>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quick_frames.h>

#include "arrays.h"
#include "calls.h"
#include "edits.h"
#include "mesh.h"
#include "script/run_steps.h"

namespace meshgraft::python {

/// Stands behind Python's Pose: a motion, a matrix, or the new course of a curve.
struct PoseHolder {
  std::variant<HandleMotion, Eigen::Matrix4d, Points> pose;
};

/// A deform step without poses on a mesh, resolved as the step of an edit is.
struct Preparation {
  std::shared_ptr<const Mesh> mesh;
  DeformSetup setup;
  DeformSettings settings;
  std::vector<Eigen::Vector3d> pivots;  ///< per own handle: where it turns unless its pose says otherwise

  /// Resolves the step of an edit of one deform step and one mesh in memory.
  Preparation(const GivenEdit& input, const Context& context);

  const std::vector<Handle>& handles() const { return setup.problem.deform.region.handles; }
  std::size_t own_count() const { return pivots.size(); }

  /// Returns one pose per handle. `given` has one per own handle, or None where it rests; twins get mirrored
  /// ones.
  std::vector<HandlePose> poses_of(const nb::sequence& given) const;

  DeformProblem problem() const;

  /// Copies positions of welded vertices to their copies.
  void spread(Eigen::Map<Points> positions) const;

  /// Returns the mesh at these positions (n×3), with its normals turned.
  Mesh moved(const Points& positions) const;
};

/// Runs an evaluation. Those that took less than a few milliseconds last time run on the calling thread.
class EvaluationRunner {
 public:
  void run(const nb::tuple& call, const std::function<void(const Context&)>& work) const;

 private:
  mutable double last_seconds_ = 1;  // the first one may take long
};

/// Stands behind Python's Deformer.
struct DeformerHolder {
  std::shared_ptr<const Preparation> preparation;
  std::shared_ptr<const Deformer> deformer;
  EvaluationRunner runner;
};

}  // namespace meshgraft::python
