#include "graft_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh_messages.h"
#include "script/fact_json.h"
#include "script/report_json.h"
#include "script/vector_json.h"

namespace meshgraft::editor {

namespace {

enum class Origin : std::uint8_t { target = 0, source = 1, seam = 2 };

// Returns the origin of each triangle. The result lists the target's vertices first, then the source's.
std::vector<std::uint8_t> origins(const MergeOutcome& merge, const Triangulation& surface, Index faces) {
  Index first_of_source = std::numeric_limits<Index>::max();
  for (const Index v : merge.source_map.new_index)
    if (v >= 0) first_of_source = std::min(first_of_source, v);
  Flags is_seam(faces, 0);
  for (const Index face : merge.new_faces) is_seam[face] = 1;
  std::vector<std::uint8_t> found;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    Origin origin = surface.triangles(t, 0) < first_of_source ? Origin::target : Origin::source;
    if (is_seam[surface.face[t]] != 0) origin = Origin::seam;
    found.push_back(static_cast<std::uint8_t>(origin));
  }
  return found;
}

void add_lines(BinaryMessage& message, const MergeReport& report, const Eigen::RowVector3d& offset) {
  std::vector<Index> sources, pairs;
  std::vector<float> line_points;
  for (std::size_t p = 0; p < report.pairs.size(); ++p) {
    const PairReport& pair = report.pairs[p];
    sources.insert(sources.end(), pair.met.begin(), pair.met.end());
    pairs.resize(sources.size(), static_cast<Index>(p));
    const std::vector<float> there = relative_to(offset, pair.target_points);
    line_points.insert(line_points.end(), there.begin(), there.end());
  }
  message.add("line_sources", sources);
  message.add("line_places", line_points);
  message.add("line_pairs", pairs);
}

Json start_json(const PairReport& pair) { return {pair.start.source, std::max(Index{0}, pair.start.target)}; }

// Returns the location on the target's loop that the start's source vertex meets; null where none is reported.
Json start_place(const PairReport& pair) {
  if (pair.met.empty() || pair.met.front() != pair.start.source) return nullptr;
  return vector_json<Json>(Eigen::Vector3d(pair.target_points.row(0)));
}

Json pair_summary(const PairReport& pair) {
  return {{"start", start_json(pair)},          {"confidence", pair.confidence},
          {"starts", starts_json(pair.starts)}, {"misfit_rel", pair.misfit_rel},
          {"edge_ratio", pair.edge_ratio},      {"raggedness_deg", pair.raggedness_deg}};
}

Json seam_summary(const SeamReport& seam) {
  return {{"manifold", seam.manifold},
          {"oriented", seam.oriented},
          {"closed", seam.closed},
          {"new_faces", seam.new_faces},
          {"angle_p1_deg", seam.angle_p1_deg},
          {"dihedral_p99_deg", seam.dihedral_p99_deg}};
}

Eigen::Affine3d map_of(const Similarity& similarity) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = similarity.scale * similarity.rotation;
  map.translation() = similarity.translation;
  return map;
}

// Returns the map from the source's original coordinates to its final placement, without its deformation.
Eigen::Affine3d whole_map(const MergeOutcome& merge) {
  return map_of(merge.report.shape.similarity) * merge.posing;
}

double scale_of(const Eigen::Affine3d& map) { return std::cbrt(std::abs(map.linear().determinant())); }

// Returns where each vertex of the result was before the source was deformed: at the target's position, or at
// the source's in its final placement. NaN for vertices that neither has.
Points rest_of(const ShownGraft& graft) {
  const MergeOutcome& merge = *graft.report.merge;
  Points rest = Points::Constant(graft.mesh.vertex_count(), 3, std::numeric_limits<double>::quiet_NaN());
  const auto place = [&](const Mesh& mesh, const IndexMap& map, const Eigen::Affine3d& placement) {
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (const Index now = map.new_index[v]; now >= 0)
        rest.row(now) = (placement * Eigen::Vector3d(mesh.positions.row(v))).transpose();
  };
  place(graft.source.mesh(), merge.source_map, whole_map(merge));
  place(graft.target.mesh(), merge.target_map, Eigen::Affine3d::Identity());
  return rest;
}

// Describes the plane of a base in the source's original coordinates.
Json base_summary(const BaseReport& base, const Eigen::Affine3d& posing) {
  const Eigen::Vector3d point = posing.inverse() * base.point;
  const Eigen::Vector3d normal = (posing.linear().transpose() * base.normal).normalized();
  return {{"height", base.height / scale_of(posing)},
          {"loops", base.loops},
          {"point", vector_json<Json>(point)},
          {"normal", vector_json<Json>(normal)}};
}

}  // namespace

Json found_json(const MergeOutcome& merge) {
  Json starts = Json::array(), places = Json::array();
  for (const PairReport& pair : merge.report.pairs) {
    starts.push_back(start_json(pair));
    places.push_back(start_place(pair));
  }
  Json found = {{"size", scale_of(whole_map(merge))}, {"starts", starts}, {"start_places", places}};
  if (merge.base) found["base_height"] = merge.base->height / scale_of(merge.posing);
  return found;
}

Json found_json(const SculptOutcome& sculpt, std::span<const Note> notes) {
  return {{"moved", sculpt.max_displacement}, {"notes", to_json(notes)}};
}

Json found_json(const CutOutcome&, std::span<const Note> notes) { return {{"notes", to_json(notes)}}; }

Json found_json(const RepairOutcome& repair, std::span<const Note> notes) {
  std::vector<Note> told;
  for (const RepairChange& change : repair.changes) told.push_back(change.note);
  told.insert(told.end(), notes.begin(), notes.end());
  return {{"changes", to_json(told)}};
}

Json matrix_json(const Eigen::Affine3d& map) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i)
    rows.push_back({map.matrix()(i, 0), map.matrix()(i, 1), map.matrix()(i, 2), map.matrix()(i, 3)});
  return rows;
}

std::vector<std::byte> graft_frame(const ShownGraft& graft) {
  const Eigen::RowVector3d& offset = graft.target.offset;
  const MergeOutcome& merge = *graft.report.merge;
  BinaryMessage message(MessageKind::graft, {{"graft", graft.number},
                                             {"dragged", graft.dragged},
                                             {"mesh", graft.target.id},
                                             {"source", graft.source.id},
                                             {"offset", {offset.x(), offset.y(), offset.z()}},
                                             {"scale", 1.0},
                                             {"vertices", graft.mesh.vertex_count()},
                                             {"faces", graft.mesh.face_count()},
                                             {"seconds", graft.report.seconds.total}});
  const Triangulation surface = triangulate(graft.mesh, {.skip_out_of_range = true});
  add_surface(message, graft.mesh, surface.triangles, offset);
  add_corner_uv(message, graft.mesh, surface.triangles, surface.face);
  add_shared_pictures(message, graft.mesh, surface.face, {&graft.target, &graft.source});
  message.add("rest", relative_to(offset, rest_of(graft)));
  message.add("origin", origins(merge, surface, graft.mesh.face_count()));
  add_lines(message, merge.report, offset);
  return message.bytes();
}

Json graft_fields(const ShownGraft& graft) {
  const MergeOutcome& merge = *graft.report.merge;
  const MergeReport& report = merge.report;
  Json pairs = Json::array();
  for (const PairReport& pair : report.pairs) pairs.push_back(pair_summary(pair));
  const Eigen::Affine3d map = whole_map(merge);
  Json fields = {{"graft", graft.number},
                 {"dragged", graft.dragged},
                 {"seconds", graft.report.seconds.total},
                 {"transform", matrix_json(map)},
                 {"size", scale_of(map)},
                 {"normal_angle_deg", merge.options.normal_angle_deg},
                 {"pairs", pairs},
                 {"seam", seam_summary(report.seam)},
                 {"inverted", report.shape.inverted},
                 {"self_intersections", merge.intersections.result},
                 {"notes", to_json(graft.report.notes)}};
  if (merge.base) fields["base"] = base_summary(*merge.base, merge.posing);
  return fields;
}

}  // namespace meshgraft::editor
