#include "symmetry.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "merge/pose_source.h"
#include "mesh/box_diagonal.h"
#include "mesh/vertex_tree.h"
#include "script/facts.h"
#include "select/candidates.h"

namespace meshgraft {

namespace {

Eigen::RowVector3d image_of(const Eigen::Affine3d& reflection, const Points& points, Eigen::Index row) {
  return (reflection * points.row(row).transpose()).transpose();
}

void sort_distinct(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

std::vector<Index> joined(const std::vector<Index>& a, const std::vector<Index>& b) {
  std::vector<Index> both;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

}  // namespace

MirrorMatch::MirrorMatch(const SymmetrySpec& symmetry, const SelectionMesh& context, Location location)
    : context_(context),
      location_(std::move(location)),
      reflection_(meshgraft::reflection(symmetry.plane, location_ / "normal")),
      tolerance_rel_(symmetry.tolerance_rel),
      diagonal_(box_diagonal(context.mesh.positions)),
      partner_(context.mesh.vertex_count(), -1),
      distance_(partner_.size(), -1.0) {
  const Points& positions = context.mesh.positions;
  const std::vector<Index> candidates = candidates_of(context);
  const VertexTree tree(positions, candidates);
  parallel_blocks(candidates.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto v = static_cast<std::size_t>(candidates[k]);
      const auto found = tree.nearest(image_of(reflection_, positions, candidates[k]));
      distance_[v] = found->distance;
      if (found->distance <= tolerance_rel_ * diagonal_) partner_[v] = found->vertex;
    }
  });
}

void MirrorMatch::require_face(Index v, const Location& where) const {
  if (image_distance(v) < 0) throw Error(facts::script::VertexWithoutFace{.vertex = v}, where);
}

Index MirrorMatch::required_partner(Index v, const Location& where) const {
  if (partner(v) >= 0) return partner(v);
  require_face(v, where);
  const Lack lack = lack_of({v});
  if (lack.tolerance_rel)
    throw Error(facts::script::VertexWithoutMirrorImage{.vertex = v, .tolerance_rel = *lack.tolerance_rel},
                where);
  throw Error(facts::script::VertexNotMirrored{.vertex = v, .distance_rel = lack.distance_rel}, where);
}

std::vector<Index> MirrorMatch::images(const std::vector<Index>& set) const {
  std::vector<Index> found;
  for (const Index v : set)
    if (partner(v) >= 0) found.push_back(partner(v));
  for (std::size_t v = 0; v < partner_.size(); ++v)
    if (partner_[v] >= 0 && std::binary_search(set.begin(), set.end(), partner_[v]))
      found.push_back(static_cast<Index>(v));
  sort_distinct(found);
  return found;
}

std::vector<Index> MirrorMatch::beyond_edges(const std::vector<Index>& set) const {
  std::vector<Index> beyond;
  for (const Index v : set) {
    double longest = 0;
    for (const Index w : context_.rings[v])
      longest = std::max(longest, (context_.mesh.positions.row(w) - context_.mesh.positions.row(v)).norm());
    if (image_distance(v) > longest) beyond.push_back(v);
  }
  return beyond;
}

std::vector<Index> MirrorMatch::with_nearest_images(const std::vector<Index>& set) const {
  Flags is_in_set(partner_.size(), 0);
  for (const Index v : set) is_in_set[v] = 1;
  const Points& positions = context_.mesh.positions;
  const std::vector<Index> candidates = candidates_of(context_);
  const VertexTree tree(positions, candidates);
  std::vector<Index> found;
  for (const Index v : candidates)
    if (is_in_set[tree.nearest(image_of(reflection_, positions, v))->vertex]) found.push_back(v);
  sort_distinct(found);
  return joined(set, found);
}

std::vector<Index> MirrorMatch::with_images(const std::vector<Index>& set) const {
  return joined(set, images(set));
}

// Returns the partners in the order of the curve. A partner that consecutive vertices share is listed once.
std::vector<Index> MirrorMatch::course_of_images(const Handle& handle, const Location& where) const {
  std::vector<Index> course;
  for (const Index v : handle.vertices)
    if (course.empty() || course.back() != partner(v)) course.push_back(partner(v));
  if (handle.closed && course.size() > 1 && course.front() == course.back()) course.pop_back();
  std::vector<Index> distinct = course;
  sort_distinct(distinct);
  if (distinct.size() != course.size())
    throw Error(facts::script::MirroredCurveReturns{.handle = handle.name, .tolerance_rel = tolerance_rel_},
                where);
  return course;
}

// Returns whether each vertex of the handle has a vertex of the handle at its mirror image.
bool MirrorMatch::is_own_image(const Handle& handle) const {
  const Points& positions = context_.mesh.positions;
  const VertexTree tree(positions, handle.vertices);
  return std::all_of(handle.vertices.begin(), handle.vertices.end(), [&](Index v) {
    return tree.nearest(image_of(reflection_, positions, v))->distance <= tolerance_rel_ * diagonal_;
  });
}

void MirrorMatch::require_partners(const Handle& handle, const Location& where) const {
  std::vector<Index> lost;
  for (const Index v : handle.vertices)
    if (partner(v) < 0) lost.push_back(v);
  if (lost.empty()) return;
  std::sort(lost.begin(), lost.end());
  for (const Index v : lost) require_face(v, where);
  const Lack lack = lack_of(lost);
  if (lack.tolerance_rel)
    throw Error(facts::script::NoMirrorImage{.handle = handle.name,
                                             .lost = lost.size(),
                                             .all = handle.vertices.size(),
                                             .first = lost.front(),
                                             .tolerance_rel = *lack.tolerance_rel},
                where);
  throw Error(facts::script::NotMirrored{.handle = handle.name,
                                         .lost = lost.size(),
                                         .all = handle.vertices.size(),
                                         .first = lost.front(),
                                         .distance_rel = lack.distance_rel},
              where);
}

// The vertices belong to faces and have no partner, so that the diagonal is not zero.
Lack MirrorMatch::lack_of(const std::vector<Index>& vertices) const {
  Lack lack;
  for (const Index v : vertices) lack.distance_rel = std::max(lack.distance_rel, image_distance(v) / diagonal_);
  constexpr double most = 0.05;  // beyond it, any nearest vertex would be taken for an image
  if (lack.distance_rel > most) return lack;
  // Round up to two digits.
  const double unit = std::pow(10.0, std::floor(std::log10(std::max(lack.distance_rel, 1e-12))) - 1);
  lack.tolerance_rel = std::stod(fmt::format("{:.2g}", std::ceil(lack.distance_rel / unit) * unit));
  return lack;
}

std::optional<Handle> MirrorMatch::twin_of(Handle& handle, const Location& where) const {
  require_partners(handle, where);
  std::vector<Index> held = handle.vertices;
  std::sort(held.begin(), held.end());
  const bool has_order = handle.shape != HandleShape::region;
  if (is_own_image(handle)) {
    if (!has_order) handle.vertices = with_images(held);
    return std::nullopt;
  }
  Handle twin = handle;
  twin.name = handle.name + ", mirrored";
  twin.vertices = has_order ? course_of_images(handle, where) : images(held);
  const auto shared = std::count_if(twin.vertices.begin(), twin.vertices.end(),
                                    [&](Index v) { return std::binary_search(held.begin(), held.end(), v); });
  if (shared > 0)
    throw Error(facts::script::OverlapsMirrorImage{.handle = handle.name, .shared = shared, .all = held.size()},
                where);
  return twin;
}

std::vector<Index> MirrorMatch::without_partner(const std::vector<Index>& set) const {
  std::vector<Index> lost;
  for (const Index v : set)
    if (partner(v) < 0 && image_distance(v) >= 0) lost.push_back(v);
  return lost;
}

Note MirrorMatch::note_about(const std::vector<Index>& without_partner, std::size_t of) const {
  const Lack lack = lack_of(without_partner);
  if (lack.tolerance_rel)
    return facts::script::RegionWithoutMirrorImage{.lost = without_partner.size(),
                                                   .all = of,
                                                   .first = without_partner.front(),
                                                   .tolerance_rel = *lack.tolerance_rel};
  return facts::script::RegionNotMirrored{.lost = without_partner.size(),
                                          .all = of,
                                          .first = without_partner.front(),
                                          .distance_rel = lack.distance_rel};
}

Error MirrorMatch::refusal_of(const std::vector<Index>& beyond, std::size_t of, const Location& where) const {
  const Lack lack = lack_of(beyond);
  if (lack.tolerance_rel)
    return Error(
        facts::script::ImageWithGaps{
            .lost = beyond.size(), .all = of, .first = beyond.front(), .tolerance_rel = *lack.tolerance_rel},
        where);
  return Error(
      facts::script::ImageOffSurface{
          .lost = beyond.size(), .all = of, .first = beyond.front(), .distance_rel = lack.distance_rel},
      where);
}

namespace {

// Compares the maps and their rotations: a full turn differs from one in the opposite direction.
bool is_symmetric_map(const HandlePose& pose, const Eigen::Vector3d& at, const Eigen::Affine3d& reflection) {
  constexpr double rounding = 1e-9;
  const HandlePose image = reflected(pose, reflection);
  if (pose.rotation) {
    const Eigen::Vector3d turn = pose.rotation->angle() * pose.rotation->axis();
    const Eigen::Vector3d turn_of_image = image.rotation->angle() * image.rotation->axis();
    if ((turn - turn_of_image).norm() > rounding * (1 + turn.norm())) return false;
  }
  const double off = (image.transform.linear() - pose.transform.linear()).norm();
  const Eigen::Vector3d moved = pose.transform * at;
  return off <= rounding * (1 + pose.transform.linear().norm()) &&
         (image.transform * at - moved).norm() <= rounding * (at.norm() + moved.norm());
}

}  // namespace

MirroredRegion mirrored_region(const std::vector<Index>& region, const SymmetrySpec& symmetry,
                               const SelectionMesh& context, const Location& location) {
  const MirrorMatch match(symmetry, context, location);
  MirroredRegion mirrored;
  mirrored.reflection = match.reflection();
  const std::vector<Index> lost = match.without_partner(region);
  mirrored.without_partner = static_cast<Index>(lost.size());
  if (const std::vector<Index> gaps = match.beyond_edges(lost); !gaps.empty())
    throw match.refusal_of(gaps, region.size(), location);
  std::vector<Index> both = lost.empty() ? match.with_images(region) : match.with_nearest_images(region);
  if (!lost.empty()) mirrored.note = match.note_about(lost, region.size());

  // The half in front of the plane, and the half behind it, if no edge joins them.
  std::vector<Index> front, back, touched;
  const Plane& plane = symmetry.plane;
  for (const Index v : both)
    ((context.mesh.positions.row(v).transpose() - plane.point).dot(plane.normal) > 0 ? front : back)
        .push_back(v);
  const std::vector<Index> around = grow_rings(front, 1, context.rings);
  std::set_intersection(back.begin(), back.end(), around.begin(), around.end(), std::back_inserter(touched));
  if (front.empty() || back.empty() || !touched.empty()) {
    mirrored.own = std::move(both);
  } else {
    mirrored.own = std::move(front);
    mirrored.image = std::move(back);
  }
  return mirrored;
}

bool is_symmetric(const HandlePose& pose, const Handle& handle, const Points& rest,
                  const Eigen::Affine3d& reflection) {
  if (!pose.curve) return is_symmetric_map(pose, rest.row(handle.vertices[0]).transpose(), reflection);
  constexpr double rounding = 1e-9;
  std::map<Index, Eigen::Index> row_of;
  for (std::size_t k = 0; k < handle.vertices.size(); ++k)
    row_of[handle.vertices[k]] = static_cast<Eigen::Index>(k);
  const VertexTree tree(rest, handle.vertices);
  const Points& course = *pose.curve;
  const double size = box_diagonal(course);
  return std::all_of(row_of.begin(), row_of.end(), [&](const auto& entry) {
    const auto partner = tree.nearest(image_of(reflection, rest, entry.first));
    const double off =
        (image_of(reflection, course, entry.second) - course.row(row_of.at(partner->vertex))).norm();
    return off <= rounding * size + 10 * partner->distance;
  });
}

HandlePose twin_pose(const PoseSpec& spec, const HandlePose& pose, const Handle& twin, const Points& rest,
                     const Eigen::Affine3d& reflection) {
  const auto* redrawn = std::get_if<PoseSpec::Redrawn>(&spec.kind);
  if (redrawn == nullptr) return reflected(pose, reflection);
  Points polyline = redrawn->polyline;
  for (Eigen::Index k = 0; k < polyline.rows(); ++k)
    polyline.row(k) = image_of(reflection, redrawn->polyline, k);
  HandlePose image;
  image.curve = redraw_curve(twin, rest, polyline);
  return image;
}

}  // namespace meshgraft
