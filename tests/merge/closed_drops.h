#pragma once

#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/mesh.h>

/// Drops of closed models on surfaces.
namespace meshgraft::test {

/// Number of models and of places for each of them.
inline constexpr int closed_models = 20, places_of_a_model = 5;

/// A closed model, a target, and the vertex of it where the model is dropped.
struct ClosedDrop {
  std::string name;
  Mesh target, source;
  Index vertex = -1;
};

/// Returns the model of that number, closed; nothing where it is one of the public test data, which are not
/// there. Models 0 to 9 are built in.
std::optional<Mesh> closed_model(int number, int resolution, std::string& name);

/// Returns the drop of a model at a place, always the same one. The model is two fifths as large as the target.
/// Samples have about resolution² vertices. Nothing where model or target are not there.
std::optional<ClosedDrop> closed_drop(int model, int place, int resolution = 64);

/// Returns the faults of a drop's result, one text each: its topology, inverted maps, folds at the seam, and
/// intersections of the seam or the band.
std::vector<std::string> faults_of(const ClosedDrop& drop, const DropResult& result);

}  // namespace meshgraft::test
