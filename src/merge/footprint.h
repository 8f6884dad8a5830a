#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

#include "mesh/refine.h"

#include "placement.h"
#include "prepared_target.h"

namespace meshgraft {

/// Largest factor by which the outline may be widened, or narrowed, to keep its width on a curved surface.
inline constexpr double most_widened = 1.5;

/// A surface parametrised around a point by the discrete exponential map.
struct Chart {
  PreparedTarget target;
  SurfacePoint point;
  Eigen::RowVector3d normal, first_axis;  ///< of the tangent plane
  PlanePoints uv;                         ///< per vertex; NaN beyond the radius
};

Chart make_chart(PreparedTarget target, SurfacePoint point, double radius, const Context& context);

/// The part of a surface that an outline covers.
struct Footprint {
  PlanePoints uv;              ///< the chart's, rotated to the outline's axes
  std::vector<double> values;  ///< per vertex: signed distance to the outline, negative within
  std::vector<Index> inside;   ///< vertices within, connected to the deepest one
  double scale = 0;            ///< of the outline

  bool is_inside(Index v) const { return values[v] < 0; }
};

/// Lays the outline on a chart and widens it until the footprint is as wide as the outline in the plane.
Footprint lay_outline(const Chart& chart, const Outline& outline, double size, const Placement& placement);

/// Returns the width of a footprint: the square root of the norm of its boundary's area vector.
double width_of(const PreparedTarget& target, const Footprint& footprint);

/// Returns the reason why the footprint cannot be cut out, if there is one. It names `size`, and vertices as
/// `index_of` does.
std::optional<Note> find_obstacle(const PreparedTarget& target, const Footprint& footprint, double size,
                                  const std::function<Index(Index)>& index_of = std::identity());

/// Halves edges around the outline that are longer than `longest`. Returns nothing where there are none.
std::optional<RefineResult> refine_around(const Mesh& mesh, const Footprint& footprint, double longest,
                                          const Context& context);

}  // namespace meshgraft
