#include "open_base.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "base_side.h"
#include "merge/facts.h"
#include "mesh/box_diagonal.h"
#include "mesh/facts.h"
#include "plane_section.h"

namespace meshgraft {

namespace {

using Direction = Eigen::Vector3d;

/// A side of a source with the extent along its direction.
struct ExtentOfSide {
  double low = 0, extent = 0;
};

ExtentOfSide extent_along(const Direction& up, const Points& points) {
  const Eigen::VectorXd along = points * up;
  const double low = along.minCoeff();
  return {low, along.maxCoeff() - low};
}

/// A clean section of a side.
struct Candidate {
  BaseSide side;
  double height = 0;
  PlaneSection section;
  double cost = 0;  ///< lower is better
};

Error at_base(const Fact& fact) { return Error(fact, "base"); }

/// Refuses a section that cannot be a base.
void require_sound(const PlaneSection& section) {
  constexpr std::size_t most_loops = 12;
  constexpr double least_area = 1e-4;  // chosen, × that of the largest loop
  const std::vector<SectionLoop>& loops = section.loops;
  if (loops.empty()) throw at_base(facts::merge::BaseMissesSource{});
  if (!section.closed) throw at_base(facts::merge::BaseCutsOpenChain{});
  if (section.pieces > 1) throw at_base(facts::merge::BaseDividesSource{.pieces = section.pieces});
  if (loops.size() > most_loops)
    throw at_base(facts::merge::BaseHasTooManyLoops{.loops = loops.size(), .most = most_loops});
  if (loops.back().area < -least_area * loops.front().area) throw at_base(facts::merge::BaseIsHollow{});
  if (!(loops.back().area > least_area * loops.front().area))
    throw at_base(facts::merge::BaseLoopWithoutArea{.loops = loops.size()});
}

/// Returns whether the loops are round, apart and alike, and the surface does not turn far under them.
bool is_clean(const PlaneSection& section, double diagonal) {
  // All bounds are chosen.
  constexpr double least_round = 0.35, most_overhang = 0.75, least_alike = 0.15, least_apart = 1.4;
  constexpr double least_area = 2e-4;  // × the square of the diagonal
  constexpr std::size_t most_feet = 6;
  const std::vector<SectionLoop>& loops = section.loops;
  if (loops.empty() || loops.size() > most_feet || !section.closed || section.pieces != 1) return false;
  double area = 0;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (!(loops[i].area > 0) || loops[i].roundness() < least_round || loops[i].overhang > most_overhang ||
        loops[i].area < least_alike * loops.front().area)
      return false;
    for (std::size_t j = 0; j < i; ++j)
      if ((loops[i].centre - loops[j].centre).norm() < least_apart * (loops[i].radius() + loops[j].radius()))
        return false;
    area += loops[i].area;
  }
  return area > least_area * diagonal * diagonal;
}

/// Returns the cost of a clean section: low ones, those with one loop, and those where the surface rises
/// steeply are cheap.
double cost_of(const PlaneSection& section, double height_rel) {
  // Chosen: a chamfer is cut off, a ball is cut near its lowest point.
  constexpr double of_overhang = 0.4, free_overhang = 0.3, of_several = 0.12;
  double overhang = 0;
  for (const SectionLoop& loop : section.loops) overhang = std::max(overhang, loop.overhang);
  return height_rel + of_overhang * std::max(0.0, overhang - free_overhang) +
         (section.loops.size() > 1 ? of_several : 0);
}

/// Returns the clean sections of a side, the cheapest first.
std::vector<Candidate> clean_sections(const Mesh& source, const PlaneSections& sections, const BaseSide& side,
                                      double diagonal) {
  constexpr std::array heights{0.02, 0.03, 0.05, 0.07, 0.09, 0.12, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45};
  constexpr double least_if_round = 0.04;
  const auto [low, extent] = extent_along(side.up, source.positions);
  std::vector<Candidate> found;
  for (const double height : heights) {
    if (!side.flat && height < least_if_round) continue;
    PlaneSection section = sections.at(side.up, low + height * extent);
    if (!is_clean(section, diagonal)) continue;
    const double cost = cost_of(section, height);
    found.push_back({side, height * extent, std::move(section), cost});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  return found;
}

/// Returns whether the source's centre is above the hull of the loops.
bool is_stable(const Candidate& base, const Direction& centre) {
  constexpr int directions = 32;
  const Direction x = base.side.up.unitOrthogonal(), y = base.side.up.cross(x);
  for (int k = 0; k < directions; ++k) {
    const double angle = 2 * std::numbers::pi * k / directions;
    const Direction along = std::cos(angle) * x + std::sin(angle) * y;
    const bool reached = std::any_of(
        base.section.loops.begin(), base.section.loops.end(),
        [&](const SectionLoop& loop) { return (loop.points * along).maxCoeff() >= centre.dot(along); });
    if (!reached) return false;
  }
  return true;
}

/// Returns sections of the side on which the source stands best, then one of the next side. That is a flat side
/// or the lowest one, if it has a clean section; else the side whose cheapest section carries the source.
std::vector<Candidate> find_candidates(const Mesh& source, const PlaneSections& sections,
                                       const std::vector<BaseSide>& sides) {
  constexpr double of_instability = 1;
  const double diagonal = box_diagonal_of_faces(source);
  const Direction centre = source.positions.colwise().mean().transpose();
  std::vector<std::vector<Candidate>> found;
  for (const BaseSide& side : sides) {
    std::vector<Candidate> clean = clean_sections(source, sections, side, diagonal);
    if (clean.empty()) continue;
    const bool preferred = side.flat || side.lowest;
    if (!preferred && !is_stable(clean.front(), centre))
      for (Candidate& candidate : clean) candidate.cost += of_instability;
    if (preferred)
      for (Candidate& candidate : clean) candidate.cost -= of_instability;
    found.push_back(std::move(clean));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    const bool a_preferred = a.front().side.flat || a.front().side.lowest;
    const bool b_preferred = b.front().side.flat || b.front().side.lowest;
    return a_preferred != b_preferred ? a_preferred : !a_preferred && a.front().cost < b.front().cost;
  });
  constexpr std::size_t most_of_first = 3;
  std::vector<Candidate> taken;
  if (found.empty()) return taken;
  for (const Candidate& candidate : found.front()) {
    const bool only_several = std::none_of(
        taken.begin(), taken.end(), [](const Candidate& other) { return other.section.loops.size() == 1; });
    if (taken.size() < most_of_first || (only_several && candidate.section.loops.size() == 1))
      taken.push_back(candidate);
  }
  if (found.size() > 1) taken.push_back(found[1].front());
  return taken;
}

Direction centre_of(const std::vector<SectionLoop>& loops) {
  Direction moment = Direction::Zero();
  double area = 0;
  for (const SectionLoop& loop : loops) {
    moment += loop.area * loop.centre;
    area += loop.area;
  }
  return moment / area;
}

Direction tilted(const Direction& up, const DropBase& base) {
  constexpr double right_angle = 90;
  constexpr double parallel = 0.02;  // chosen: within about a degree a turn does hardly anything
  if (!(std::abs(base.tilt_deg) < right_angle))
    throw Error(facts::merge::BaseTiltTooLarge{.tilt_deg = base.tilt_deg}, Location("base") / "tilt_deg");
  const bool along_x = std::abs(up.x()) > std::max(std::abs(up.y()), std::abs(up.z()));
  const Direction axis =
      base.tilt_axis.value_or(along_x ? Direction(Direction::UnitY()) : Direction(Direction::UnitX()));
  if (!(axis.cross(up).norm() > parallel * axis.norm()))
    throw Error(facts::merge::BaseTiltTurnsNothing{}, Location("base") / "tilt_axis");
  return Eigen::AngleAxisd(base.tilt_deg * std::numbers::pi / 180, axis.normalized()) * up;
}

}  // namespace

BaseSearch::BaseSearch(const Mesh& source, const DropBase& base) : source_(source), sections_(source) {
  const std::vector<BaseSide> sides = base_sides(source);
  std::vector<Candidate> candidates = find_candidates(source, sections_, sides);
  if (base.height) {
    const BaseSide side = candidates.empty() ? sides.front() : candidates.front().side;
    const auto [low, extent] = extent_along(side.up, source.positions);
    if (!(*base.height > 0 && *base.height < extent))
      throw Error(facts::merge::BaseHeightOutside{.height = *base.height, .extent = extent},
                  Location("base") / "height");
    candidates = {{side, *base.height, sections_.at(side.up, low + *base.height)}};
    require_sound(candidates.front().section);
  }
  if (candidates.empty()) throw at_base(facts::merge::NoBase{});
  for (const Candidate& candidate : candidates) {
    const Direction& up = candidate.side.up;
    planes_.push_back({{centre_of(candidate.section.loops), base.tilt_deg == 0 ? up : tilted(up, base)},
                       candidate.height,
                       candidate.side.flat,
                       static_cast<Index>(candidate.section.loops.size())});
  }
}

OpenedSource BaseSearch::open(const BasePlane& base, const Context& context) const {
  const Plane& plane = base.plane;
  require_sound(sections_.at(plane.normal, plane.point.dot(plane.normal)));
  CutResult cut;
  try {
    cut = cut_by_plane(source_, plane, {.keep = CutKeep::above}, context);
  } catch (const Error& error) {
    if (error.id() != facts::mesh::PlaneMissesMesh::id && error.id() != facts::mesh::NothingCut::id) throw;
    throw at_base(facts::merge::BaseMissesSource{});
  }
  OpenedSource opened;
  opened.report = {.point = plane.point,
                   .normal = plane.normal,
                   .height = base.height,
                   .flat = base.flat,
                   .loops = static_cast<Index>(cut.loops.size()),
                   .cut_away = static_cast<Index>(
                       std::count(cut.vertex.new_index.begin(), cut.vertex.new_index.end(), Index{-1}))};
  for (const EdgePoint& origin : cut.origin) opened.nearest.push_back(origin.t < 0.5 ? origin.from : origin.to);
  opened.loops = std::move(cut.loops);
  opened.vertex = std::move(cut.vertex);
  opened.mesh = std::move(cut.mesh);
  return opened;
}

OpenedSource open_base(const Mesh& source, const DropBase& base, const Context& context) {
  const BaseSearch search(source, base);
  return search.open(search.planes().front(), context);
}

}  // namespace meshgraft
