#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include <meshgraft/script/edit_file.h>

#include "merge/facts.h"
#include "merge/merge_conflict.h"
#include "merge/pose_source.h"
#include "parse_parts.h"
#include "script/facts.h"

namespace meshgraft {

namespace {

using json::Object;
using json::Value;

// Parses a vertex number, or a point that stands for the nearest vertex.
VertexSpec parse_vertex(const Value& value) {
  if (value.is_array()) return value.vector3();
  return value.vertex();
}

// Parses a source and a target vertex, in this order.
MatchSpec parse_match(const Value& value) {
  if (value.size() != 2) value.fail(facts::script::NotAMatch{});
  return {parse_vertex(value[0]), parse_vertex(value[1])};
}

std::vector<MatchSpec> parse_matches(const Value& value) {
  std::vector<MatchSpec> matches;
  for (std::size_t i = 0; i < value.size(); ++i) matches.push_back(parse_match(value[i]));
  return matches;
}

void add_match(std::vector<MatchSpec>& matches, const MatchSpec& match) {
  if (std::find(matches.begin(), matches.end(), match) == matches.end()) matches.push_back(match);
}

MergePairSpec parse_pair(const Value& value) {
  const Object fields(value, {"source_loop", "target_loop", "start", "matches"});
  MergePairSpec pair;
  pair.source_loop = parse_selection(fields.required("source_loop"));
  pair.target_loop = parse_selection(fields.required("target_loop"));
  fields.optional("start", [&](const Value& v) { add_match(pair.matches, parse_match(v)); });
  fields.optional("matches", [&](const Value& v) {
    for (const MatchSpec& match : parse_matches(v)) add_match(pair.matches, match);
  });
  return pair;
}

DropBase parse_base(const Value& value) {
  const Object fields(value, {"height", "tilt_deg", "tilt_axis"});
  DropBase base;
  fields.optional("height", [&](const Value& v) { base.height = v.positive_number(); });
  fields.optional("tilt_deg", [&](const Value& v) { base.tilt_deg = v.number_in(-90, 90); });
  fields.optional("tilt_axis", [&](const Value& v) { base.tilt_axis = v.direction(); });
  return base;
}

DropSpec parse_drop(const Value& value) {
  const Object fields(value, {"vertex", "point", "spin_deg", "source_loop", "base"});
  if (fields.has("vertex") == fields.has("point"))
    value.fail(facts::script::NotOneOf{.names = std::array{"vertex", "point"}});
  DropSpec drop;
  fields.optional("vertex", [&](const Value& v) { drop.surface_point = v.vertex(); });
  fields.optional("point", [&](const Value& v) { drop.surface_point = v.vector3(); });
  fields.optional("spin_deg", [&](const Value& v) { drop.spin_deg = v.number(); });
  fields.optional("source_loop", [&](const Value& v) { drop.source_loop = parse_selection(v); });
  fields.optional("base", [&](const Value& v) { drop.base = parse_base(v); });
  if (drop.source_loop && drop.base) value.fail(facts::merge::BaseWithSourceLoop{});
  return drop;
}

Plane parse_plane(const Value& value) {
  const Object fields(value, {"point", "normal"});
  return {fields.required("point").vector3(), fields.required("normal").direction()};
}

Reach parse_reach(const Value& value) {
  const Object fields(value, {"rings", "length"});
  if (fields.has("rings") == fields.has("length"))
    value.fail(facts::script::NotOneOf{.names = std::array{"rings", "length"}});
  Reach reach;
  fields.optional("rings", [&](const Value& v) { reach.rings = static_cast<int>(v.integer_in(1, max_rings)); });
  fields.optional("length", [&](const Value& v) { reach.length = v.positive_number(); });
  return reach;
}

MergeSettings parse_merge_settings(const Value& value) {
  std::vector<std::string_view> known(deformer_fields.begin(), deformer_fields.end());
  known.insert(known.end(), {"strip", "edge_ratio", "refine_radius", "fairing_method", "fairings",
                             former_fairings, "band", "sharp_angle_deg", "blend_colours"});
  const Object fields(value, known);
  MergeSettings settings;
  settings.preset = parse_preset(fields);
  const MergeOptions base = settings.preset ? MergeOptions::as_published() : MergeOptions{};
  settings.deformer = parse_deformer(fields, base.deformer, true);
  settings.seam = base.seam;
  SeamOptions& seam = settings.seam;
  fields.optional("strip", [&](const Value& v) {
    seam.strip = v.choice<StripMethod>({{"greedy", StripMethod::greedy}, {"optimal", StripMethod::optimal}});
  });
  fields.optional("edge_ratio", [&](const Value& v) { seam.edge_ratio = v.number_in(1, 1e6); });
  fields.optional("refine_radius", [&](const Value& v) { seam.refine_radius = v.boolean(); });
  fields.optional("fairing_method", [&](const Value& v) {
    seam.fairing_method = v.choice<FairingMethod>(
        {{"umbrella", FairingMethod::umbrella}, {"curvature", FairingMethod::curvature}});
  });
  for (const std::string_view name : {former_fairings, std::string_view("fairings")})
    fields.optional(name, [&](const Value& v) { seam.fairings = static_cast<int>(v.integer_in(0, 1000)); });
  fields.optional("band", [&](const Value& v) { seam.target_rings = static_cast<int>(v.integer_in(0, 100)); });
  fields.optional("sharp_angle_deg", [&](const Value& v) { seam.sharp_angle_deg = v.number_in(0, 180); });
  fields.optional("blend_colours", [&](const Value& v) { seam.blend_colours = v.non_negative_number(); });
  return settings;
}

// Reads the counts that both versions name alike.
void read_mesh_counts(const Object& fields, MergeCounts& counts) {
  read_count(fields, "source_vertices", counts.source_vertices);
  read_count(fields, "source_faces", counts.source_faces);
  read_count(fields, "target_vertices", counts.target_vertices);
  read_count(fields, "target_faces", counts.target_faces);
  read_count(fields, "free", counts.free);
}

MergeCounts parse_merge_counts(const Value& value) {
  const Object fields(value, {"source_vertices", "source_faces", "target_vertices", "target_faces",
                              "source_loops", "target_loops", "fixed", "free"});
  MergeCounts counts;
  read_mesh_counts(fields, counts);
  read_count(fields, "fixed", counts.fixed);
  fields.optional("source_loops", [&](const Value& v) { counts.source_loops = v.vertices(); });
  fields.optional("target_loops", [&](const Value& v) { counts.target_loops = v.vertices(); });
  return counts;
}

// Refuses a step that contradicts itself.
void require_sense(const MergeStep& step, const Object& fields) {
  using enum MergeConflict;
  MergeRequest request{.pose = step.pose,
                       .dropped = fields.has("at"),
                       .pairs_given = fields.has("pairs"),
                       .matches_given = fields.has("matches"),
                       .transform_given = fields.has("source_transform"),
                       .fixed_given = fields.has("fixed"),
                       .size_given = fields.has("size")};
  if (fields.has("align")) request.aligned_pairs = step.align.size();
  const auto conflict = find_conflict(request);
  if (!conflict) return;
  const auto fail = [&](const char* field, const auto& fact) { fields.required(field).fail(fact); };
  switch (*conflict) {
    case dropped_with_pairs: return fail("at", facts::script::AtWithLoops{.field = "pairs"});
    case dropped_with_matches: return fail("at", facts::script::AtWithLoops{.field = "matches"});
    case dropped_pose_kept: return fail("at", facts::script::AtWithKeptPose{});
    case posed_twice: return fail("align", facts::script::PosedTwice{});
    case too_few_aligned:
      return fail("align",
                  facts::script::TooFew{.least = fewest_aligned_pairs, .what = facts::script::Elements::pairs});
    case fixed_pose_found: return fail("fixed", facts::script::FixedWithFoundPose{});
    case size_pose_kept: return fail("size", facts::script::SizeWithKeptPose{});
    case reach_given_twice: return;  // `parse_reach` takes one of the two
  }
}

// Parses a version 1 pair, whose lists of loop vertices begin with the start.
MergePairSpec parse_pair_version_1(const Value& value) {
  const Object fields(value, {"source_loop", "target_loop", "same_direction", "start", "correspondences"});
  MergePairSpec pair;
  pair.source_loop = {Selection::Indices{fields.required("source_loop").vertices()}};
  pair.target_loop = {Selection::Indices{fields.required("target_loop").vertices()}};
  fields.optional("same_direction", [](const Value& v) { v.boolean(); });
  add_match(pair.matches, parse_match(fields.required("start")));
  fields.optional("correspondences", [&](const Value& v) {
    for (const MatchSpec& match : parse_matches(v)) add_match(pair.matches, match);
  });
  return pair;
}

std::vector<Index> parse_handles_version_1(const Value& value) {
  std::set<Index> held;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    const Object fields(element, {"name", "shape", "vertices"});
    fields.required("name").name();
    fields.optional("shape",
                    [](const Value& v) { v.choice<int>({{"vertex", 0}, {"curve", 0}, {"region", 0}}); });
    const std::vector<Index> vertices = fields.required("vertices").vertices();
    held.insert(vertices.begin(), vertices.end());
  }
  return {held.begin(), held.end()};
}

MergeCounts parse_counts_version_1(const Value& value) {
  const Object fields(value, {"source_vertices", "source_faces", "target_vertices", "target_faces",
                              "source_loop", "target_loop", "handle", "free"});
  MergeCounts counts;
  read_mesh_counts(fields, counts);
  read_count(fields, "handle", counts.fixed);
  fields.optional("source_loop", [&](const Value& v) { counts.source_loops = v.vertices(); });
  fields.optional("target_loop", [&](const Value& v) { counts.target_loops = v.vertices(); });
  return counts;
}

}  // namespace

EditStep parse_merge_step(const Value& value) {
  const Object fields(value, {"kind",
                              "name",
                              "about",
                              "target",
                              "source",
                              "result",
                              "pose",
                              "shape",
                              "pairs",
                              "matches",
                              "at",
                              "mirror",
                              "source_transform",
                              "align",
                              "size",
                              "normal_angle_deg",
                              "fixed",
                              "reach",
                              "features",
                              "smooth_boundary",
                              "fix_winding",
                              "retry",
                              "settings",
                              "counts"});
  MergeStep step;
  step.target = fields.required("target").name();
  step.source = fields.required("source").name();
  fields.optional("result", [&](const Value& v) { step.result = v.name(); });
  fields.optional("pose", [&](const Value& v) {
    step.pose = v.choice<MergePose>({{"find", MergePose::find}, {"keep", MergePose::keep}});
  });
  fields.optional("settings", [&](const Value& v) { step.settings = parse_merge_settings(v); });
  if (step.settings.preset) step.shape = MergeOptions::as_published().shape;
  fields.optional("shape", [&](const Value& v) {
    step.shape = v.choice<MergeShape>({{"similar", MergeShape::similar}, {"ft05", MergeShape::ft05}});
  });
  fields.optional("pairs", [&](const Value& v) { step.pairs = parse_list(v, &parse_pair); });
  fields.optional("matches", [&](const Value& v) { step.matches = parse_list(v, &parse_match); });
  fields.optional("at", [&](const Value& v) { step.at = parse_drop(v); });
  fields.optional("mirror", [&](const Value& v) { step.mirror = parse_plane(v); });
  fields.optional("source_transform", [&](const Value& v) { step.source_transform = v.affine_matrix(); });
  fields.optional("align", [&](const Value& v) { step.align = parse_matches(v); });
  fields.optional("size", [&](const Value& v) { step.size = v.positive_number(); });
  fields.optional("normal_angle_deg", [&](const Value& v) { step.normal_angle_deg = v.number_in(-180, 180); });
  fields.optional("fixed", [&](const Value& v) { step.fixed = parse_selection(v); });
  fields.optional("reach", [&](const Value& v) { step.reach = parse_reach(v); });
  fields.optional("features", [&](const Value& v) { step.features = parse_list(v, &parse_feature); });
  fields.optional("smooth_boundary", [&](const Value& v) { step.smooth_boundary = v.boolean(); });
  fields.optional("fix_winding", [&](const Value& v) { step.fix_winding = v.boolean(); });
  fields.optional("retry", [&](const Value& v) { step.retry = v.boolean(); });
  fields.optional("counts", [&](const Value& v) { step.counts = parse_merge_counts(v); });
  require_sense(step, fields);
  return {{}, {}, std::move(step)};
}

namespace {

void parse_pins(const Value& value, CutOptions& options) {
  const Object fields(value, {"count", "diameter", "length", "clearance", "side"});
  options.cap = CutCap::pins;
  fields.optional("count",
                  [&](const Value& v) { options.pin_count = static_cast<Index>(v.integer_in(1, 32)); });
  fields.optional("diameter", [&](const Value& v) { options.pin_diameter = v.positive_number(); });
  fields.optional("length", [&](const Value& v) { options.pin_length = v.positive_number(); });
  fields.optional("clearance", [&](const Value& v) {
    options.pin_clearance = v.number_in(0, std::numeric_limits<double>::max());
  });
  fields.optional("side", [&](const Value& v) {
    options.pin_side = v.choice<PinSide>({{"above", PinSide::above}, {"below", PinSide::below}});
  });
}

}  // namespace

EditStep parse_cut_step(const Value& value) {
  const Object fields(
      value, {"kind", "name", "about", "mesh", "result", "plane", "loop", "keep", "snap", "cap", "pins"});
  if (fields.has("plane") == fields.has("loop"))
    value.fail(facts::script::NotOneOf{.names = std::array{"plane", "loop"}});
  CutStep step;
  step.mesh = fields.required("mesh").name();
  fields.optional("result", [&](const Value& v) { step.result = v.name(); });
  fields.optional("plane", [&](const Value& v) { step.along = parse_plane(v); });
  fields.optional("loop", [&](const Value& v) {
    std::vector<Index> vertices = v.vertices();
    if (vertices.size() < 3)
      v.fail(facts::script::TooFew{.least = 3, .what = facts::script::Elements::vertices});
    step.along = std::move(vertices);
  });
  fields.optional("keep", [&](const Value& v) {
    step.options.keep =
        v.choice<CutKeep>({{"above", CutKeep::above}, {"below", CutKeep::below}, {"both", CutKeep::both}});
  });
  fields.optional("snap", [&](const Value& v) { step.options.snap = v.number_in(0, 0.5); });
  if (fields.has("cap") && fields.has("pins"))
    value.fail(facts::script::NotOneOf{.names = std::array{"cap", "pins"}});
  fields.optional("cap", [&](const Value& v) {
    step.options.cap = v.choice<CutCap>({{"open", CutCap::open}, {"flat", CutCap::flat}});
  });
  fields.optional("pins", [&](const Value& v) { parse_pins(v, step.options); });
  return {{}, {}, std::move(step)};
}

EditFile parse_merge_version_1(const Value& root) {
  const Object fields(
      root, {"format", "version", "kind", "mode", "name", "about", "paper", "source", "target", "counts",
             "source_transform", "normal_angle_degrees", "pairs", "handles", "expected"});
  EditFile edit;
  read_heading_version_1(fields, edit);
  edit.inputs.push_back({.name = "source", .file = fields.required("source").name()});
  edit.inputs.push_back({.name = "target", .file = fields.required("target").name()});

  MergeStep step;
  step.target = "target";
  step.source = "source";
  step.shape = MergeShape::ft05;
  step.pose = fields.required("mode").choice<MergePose>(
      {{"pose-independent", MergePose::find}, {"pose-dependent", MergePose::keep}});
  step.pairs = parse_list(fields.required("pairs"), &parse_pair_version_1);
  fields.optional("source_transform", [&](const Value& v) {
    const Eigen::Matrix4d transform = v.affine_matrix();
    if (step.pose == MergePose::keep) step.source_transform = transform;
  });
  fields.optional("normal_angle_degrees",
                  [&](const Value& v) { step.normal_angle_deg = v.number_in(-180, 180); });
  fields.optional("handles", [&](const Value& v) {
    std::vector<Index> held = parse_handles_version_1(v);
    if (find_conflict({.pose = step.pose, .fixed_given = !held.empty()}))
      v.fail(facts::script::HandlesWithFoundPose{});
    if (!held.empty()) step.fixed = EditSelection{Selection::Indices{std::move(held)}};
  });
  fields.optional("counts", [&](const Value& v) { step.counts = parse_counts_version_1(v); });
  edit.steps.push_back({{}, {}, std::move(step)});
  return edit;
}

}  // namespace meshgraft
