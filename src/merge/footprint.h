#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "placement.h"
#include "prepared_target.h"

namespace meshgraft {

/// The outline may be widened by at most this factor, or narrowed, to be as wide on a curved surface.
inline constexpr double most_widened = 1.5;

/// A surface spread out around a point by the discrete exponential map.
struct Chart {
  PreparedTarget target;
  SurfacePoint point;
  Eigen::RowVector3d normal, first_axis;  ///< of the tangent plane
  PlanePoints uv;                         ///< per vertex; NaN beyond the reach
};

std::shared_ptr<const Chart> make_chart(std::shared_ptr<const Mesh> mesh, const Drop& drop, double reach,
                                        const Context& context);

/// What an outline covers of a surface.
struct Footprint {
  PlanePoints uv;              ///< the chart's, along the outline's axes
  std::vector<double> values;  ///< per vertex: signed distance to the outline, negative within
  std::vector<Index> inside;   ///< the vertices within that hang together with the deepest one
  double scale = 0;            ///< of the outline

  bool is_inside(Index v) const { return values[v] < 0; }
};

/// Lays the outline on a chart, widened until it is as wide there as it is in the plane.
Footprint lay_outline(const Chart& chart, const Outline& outline, double size, const Placement& placement);

/// How wide a footprint is: the root of the area that it spans, seen from where it is largest.
double width_of(const PreparedTarget& target, const Footprint& footprint);

/// Why a hole cannot be opened.
struct Misfit {
  std::string what;
};

inline constexpr const char* no_disc =
    "the loop reaches round the surface there, so that what it encloses is no disc";

/// What keeps the footprint from being cut away.
std::optional<Misfit> find_obstacle(const PreparedTarget& target, const Footprint& footprint);

/// Halves edges around the outline that are too long to draw it. Null where there are none.
std::shared_ptr<const Mesh> refine_around(const Mesh& mesh, const Footprint& footprint, double longest,
                                          const Context& context);

}  // namespace meshgraft
