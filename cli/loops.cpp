#include "loops.h"

#include <fmt/format.h>

namespace meshgraft::cli {

std::vector<LoopFacts> loop_facts(const Mesh& mesh, const std::vector<std::vector<Index>>& loops) {
  std::vector<LoopFacts> facts;
  for (const std::vector<Index>& loop : loops) {
    LoopFacts one{static_cast<Index>(loop.size()), loop.front(), 0, mesh.positions.row(loop.front())};
    Eigen::RowVector3d moment = Eigen::RowVector3d::Zero();  // relative to the first vertex
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Eigen::RowVector3d a = mesh.positions.row(loop[k]),
                               b = mesh.positions.row(loop[(k + 1) % loop.size()]);
      const double length = (b - a).norm();
      one.length += length;
      moment += length * ((a + b) / 2 - mesh.positions.row(loop.front()));
    }
    if (one.length != 0) one.centre += moment / one.length;  // NaN if a vertex has no finite position
    facts.push_back(one);
  }
  return facts;
}

std::string loop_text(const LoopFacts& loop) {
  return fmt::format("{} vertices from {}, length {:.6g}, centre {:.6g} {:.6g} {:.6g}", loop.vertices,
                     loop.first_vertex, loop.length, loop.centre(0), loop.centre(1), loop.centre(2));
}

nlohmann::ordered_json loop_json(std::size_t number, const LoopFacts& loop) {
  return {{"number", number},
          {"vertices", loop.vertices},
          {"first_vertex", loop.first_vertex},
          {"length", loop.length},
          {"centre", {loop.centre(0), loop.centre(1), loop.centre(2)}}};
}

}  // namespace meshgraft::cli
