#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::cli {

/// A boundary loop in the reports of `info` and `cut`.
struct LoopFacts {
  Index vertices = 0;
  Index first_vertex = 0;
  double length = 0;          ///< model units
  Eigen::RowVector3d centre;  ///< centroid of the curve by length, model units
};

/// Returns the facts in the order of `boundary_loops`, which numbers them from 0.
std::vector<LoopFacts> loop_facts(const Mesh& mesh, const std::vector<std::vector<Index>>& loops);

/// Returns a text such as "24 vertices from 17, length 3.1, centre 0 0 1".
std::string loop_text(const LoopFacts& loop);

/// Returns an object with `number`, `vertices`, `first_vertex`, `length` and `centre`.
nlohmann::ordered_json loop_json(std::size_t number, const LoopFacts& loop);

}  // namespace meshgraft::cli
