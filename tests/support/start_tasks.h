#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/orientation.h>

namespace meshgraft::test {

/// A part of one model, and another model without its like, both cut anew. The start is known, for up and front
/// of both models are.
struct StartTask {
  std::string text;  ///< description of models and cuts
  std::string kind;  ///< "head", "fore part", "hind part", "tail"
  Mesh target, source;
  LoopPair loops;
  Orientation target_orientation, source_orientation;
  /// Guesses from the models before they were cut.
  std::vector<OrientationGuess> target_guesses, source_guesses;
};

/// Returns the tasks of which all models are there: built-in ones, and with `data` those of the public test
/// data, too. Cuts are turned by up to 10° and shifted by up to a fifth of the loop's diameter, in `variants`
/// ways for each pair of models. Cuts that give a loop of quite another size are left out.
std::vector<StartTask> start_tasks(bool data, int variants);

/// Returns the angle, degrees, by which a start turns the source beyond the start that brings up to up and
/// front to front as far as the loops allow.
double start_error_deg(const StartTask& task, const Match& start);

}  // namespace meshgraft::test
