#include "seam_colours.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <meshgraft/mesh/topology.h>

#include "core/sparse_checks.h"
#include "mesh/interpolate_attribute.h"

namespace meshgraft {

namespace {

Attribute* find_colours(Mesh& mesh) {
  for (Attribute& attribute : mesh.attributes)
    if (attribute.domain == Domain::vertex && attribute.name == "colour") return &attribute;
  return nullptr;
}

Eigen::VectorXd colour_of(const Attribute& colours, Index v) {
  return Eigen::Map<const Eigen::VectorXd>(colours.values.data() + std::ptrdiff_t{v} * colours.components,
                                           colours.components);
}

void set_colour(Attribute& colours, Index v, const Eigen::VectorXd& colour) {
  const auto first = colours.values.begin() + std::ptrdiff_t{v} * colours.components;
  for (int k = 0; k < colours.components; ++k) first[k] = representable(colour[k], colours.type);
}

/// Extends the colours of some vertices over space (Shepard 1968, with the inverse square of the distance).
class ExtendedColours {
 public:
  ExtendedColours(const Mesh& mesh, const Attribute& colours, std::span<const Index> vertices) {
    for (const Index v : vertices) {
      const Eigen::VectorXd colour = colour_of(colours, v);
      if (!colour.allFinite()) continue;
      points_.push_back(mesh.positions.row(v));
      colours_.push_back(colour);
    }
  }

  std::optional<Eigen::VectorXd> at(const Eigen::RowVector3d& point) const {
    if (points_.empty()) return std::nullopt;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(colours_.front().size());
    double weights = 0;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const double distance = (point - points_[k]).squaredNorm();
      if (distance == 0) return colours_[k];
      sum += colours_[k] / distance;
      weights += 1 / distance;
    }
    return sum / weights;
  }

 private:
  std::vector<Eigen::RowVector3d> points_;
  std::vector<Eigen::VectorXd> colours_;
};

std::vector<Index> all_of(const std::vector<StripLoops>& strips, std::vector<Index> StripLoops::* side) {
  std::vector<Index> vertices;
  for (const StripLoops& strip : strips)
    vertices.insert(vertices.end(), (strip.*side).begin(), (strip.*side).end());
  return vertices;
}

}  // namespace

void colour_source_like_target(Mesh& mesh, const SeamLayout& layout, const std::vector<StripLoops>& strips,
                               const Context& context) {
  Attribute* colours = find_colours(mesh);
  if (colours == nullptr) return;
  const ExtendedColours target(mesh, *colours, all_of(strips, &StripLoops::target));
  SparseChecks check(context);
  for (Index v = layout.target_vertices; v < mesh.vertex_count(); ++v) {
    check();
    if (const auto colour = target.at(mesh.positions.row(v))) set_colour(*colours, v, *colour);
  }
}

void blend_colours(Mesh& mesh, const SeamLayout& layout, const std::vector<StripLoops>& strips, double length,
                   const Context& context) {
  Attribute* colours = find_colours(mesh);
  if (colours == nullptr || length <= 0) return;
  const std::vector<Index> of_target = all_of(strips, &StripLoops::target),
                           of_source = all_of(strips, &StripLoops::source);
  const ExtendedColours target(mesh, *colours, of_target), source(mesh, *colours, of_source);
  std::vector<Index> seam = of_target;
  seam.insert(seam.end(), of_source.begin(), of_source.end());
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  const std::vector<double> distance = edge_distance(seam, mesh.positions, rings, {.limit = length});
  std::vector<std::pair<Index, Eigen::VectorXd>> mixed;
  SparseChecks check(context);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    check();
    if (!(distance[v] < length)) continue;
    const auto other =
        (layout.side_of_vertex(v) == SeamSide::target ? source : target).at(mesh.positions.row(v));
    const Eigen::VectorXd own = colour_of(*colours, v);
    if (!other || !own.allFinite()) continue;
    const double share = 0.5 * (1 + std::cos(std::numbers::pi * distance[v] / length)) / 2;
    mixed.emplace_back(v, (1 - share) * own + share * *other);
  }
  for (const auto& [v, colour] : mixed) set_colour(*colours, v, colour);
}

}  // namespace meshgraft
