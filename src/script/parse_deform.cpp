#include <functional>
#include <set>

#include <meshgraft/script/edit_file.h>

#include "parse_parts.h"
#include "script/facts.h"

namespace meshgraft {

using json::Object;
using json::Value;

std::optional<Preset> parse_preset(const Object& fields) {
  std::optional<Preset> preset;
  fields.optional("preset",
                  [&](const Value& v) { preset = v.choice<Preset>({{"as-published", Preset::as_published}}); });
  return preset;
}

DeformerOptions parse_deformer(const Object& fields, DeformerOptions options, bool of_merge) {
  OperatorOptions& operators = options.operators;
  fields.optional("method", [&](const Value& v) {
    using enum DeformMethod;
    options.method =
        of_merge ? v.choice<DeformMethod>(
                       {{"ft05", ft05}, {"rotation-aware", rotation_aware}, {"corotational", corotational}})
                 : v.choice<DeformMethod>({{"ft05", ft05},
                                           {"rotation-aware", rotation_aware},
                                           {"corotational", corotational},
                                           {"shell", shell}});
  });
  fields.optional("stiffness", [&](const Value& v) { options.stiffness = v.number_in(0, 1e6); });
  fields.optional("iterations",
                  [&](const Value& v) { options.iterations = static_cast<int>(v.integer_in(0, 1000)); });
  fields.optional("smoothing_length_rel",
                  [&](const Value& v) { options.smoothing_length_rel = v.number_in(0, 10); });
  fields.optional("weights", [&](const Value& v) {
    operators.weights =
        v.choice<WeightScheme>({{"uniform", WeightScheme::uniform}, {"cotangent", WeightScheme::cotangent}});
  });
  fields.optional("density", [&](const Value& v) {
    operators.density = v.choice<Density>({{"ft05", Density::ft05}, {"aware", Density::aware}});
  });
  fields.optional("degenerate", [&](const Value& v) {
    operators.degenerate = v.choice<DegenerateTreatment>({{"auto", DegenerateTreatment::automatic},
                                                          {"ft05-noise", DegenerateTreatment::ft05_noise},
                                                          {"apex", DegenerateTreatment::apex}});
  });
  fields.optional("apex_height_rel", [&](const Value& v) { operators.apex_height_rel = v.positive_number(); });
  fields.optional("noise_length_rel",
                  [&](const Value& v) { operators.noise_length_rel = v.positive_number(); });
  fields.optional("noise_lengths", [&](const Value& v) {
    operators.noise_lengths =
        v.choice<NoiseLengths>({{"equal", NoiseLengths::equal}, {"random", NoiseLengths::random}});
  });
  fields.optional("flatness", [&](const Value& v) { operators.flatness = v.number_in(0, 1); });
  fields.optional("seed", [&](const Value& v) { operators.seed = v.unsigned_integer(); });
  fields.optional("laplacian_weight",
                  [&](const Value& v) { operators.laplacian_weight = v.number_in(1e-6, 1e6); });
  fields.optional("laplacian_order",
                  [&](const Value& v) { operators.laplacian_order = static_cast<int>(v.integer_in(1, 3)); });
  fields.optional("residual_corrections", [&](const Value& v) {
    options.residual_corrections = static_cast<int>(v.integer_in(0, 10));
  });
  fields.optional("backend", [&](const Value& v) {
    options.backend = v.raw() == former_multifrontal
                          ? SolverBackend::multifrontal
                          : v.choice<SolverBackend>({{"auto", SolverBackend::automatic},
                                                     {"multifrontal", SolverBackend::multifrontal},
                                                     {"eigen", SolverBackend::eigen},
                                                     {"iterative", SolverBackend::iterative}});
  });
  return options;
}

namespace {

constexpr int max_refinements = 4;
constexpr int max_proxy = 1'000'000'000;

HandleMotion parse_motion(const Object& fields) {
  HandleMotion motion;
  fields.optional("translate", [&](const Value& v) { motion.translate = v.vector3(); });
  fields.optional("rotate", [&](const Value& v) {
    const Object rotate(v, {"axis", "angle_deg"});
    motion.axis = rotate.required("axis").direction();
    motion.angle_deg = rotate.required("angle_deg").number();
  });
  fields.optional("scale", [&](const Value& v) {
    if (v.is_array())
      motion.scale = v.vector3();
    else if (v.is_number())
      motion.scale = Eigen::Vector3d::Constant(v.number());
    else
      v.fail_type(facts::script::Type::number_or_3_numbers);
  });
  fields.optional("pivot", [&](const Value& v) { motion.pivot = v.vector3(); });
  return motion;
}

// Refuses a pose that has other fields beside one that goes alone.
void require_alone(const Object& fields, const Value& pose, std::initializer_list<std::string_view> names) {
  for (const std::string_view alone : names)
    if (fields.has(alone) && pose.raw().size() > 1)
      pose.fail(facts::script::PoseWithMoreFields{.field = alone});
}

}  // namespace

std::variant<HandleMotion, Eigen::Matrix4d> parse_affine_pose(const Object& fields, const Value& value) {
  require_alone(fields, value, {"matrix"});
  if (fields.has("matrix")) return fields.required("matrix").affine_matrix();
  return parse_motion(fields);
}

PoseSpec parse_pose(const Value& value, HandleShape shape) {
  const Object fields(value, {"matrix", "def", "curve", "translate", "rotate", "scale", "pivot"});
  require_alone(fields, value, {"def", "curve"});
  if (fields.has("def")) return {PoseSpec::DefFile{fields.required("def").name()}};
  if (fields.has("curve")) {
    if (shape != HandleShape::curve) fields.required("curve").fail(facts::script::RedrawnNoCurve{});
    return {PoseSpec::Redrawn{fields.required("curve").points(2)}};
  }
  return {std::visit([](auto&& pose) { return PoseSpec::Kind(std::move(pose)); },
                     parse_affine_pose(fields, value))};
}

namespace {

HandleShape parse_shape(const Value& value) {
  using enum HandleShape;
  return value.choice<HandleShape>({{"vertex", vertex}, {"curve", curve}, {"region", region}});
}

HandleSpec parse_handle(const Value& value) {
  const Object fields(value, {"name", "shape", "closed", "select", "constrain", "pose"});
  HandleSpec handle;
  handle.name = fields.required("name").name();
  fields.optional("shape", [&](const Value& v) { handle.shape = parse_shape(v); });
  fields.optional("closed", [&](const Value& v) {
    if (handle.shape != HandleShape::curve) v.fail(facts::script::ClosedNoCurve{});
    handle.closed = v.boolean();
  });
  handle.select = parse_selection(fields.required("select"));
  fields.optional("constrain", [&](const Value& v) {
    enum class Constrain { both, position, transform };
    const auto what = v.choice<Constrain>(
        {{"both", Constrain::both}, {"position", Constrain::position}, {"transform", Constrain::transform}});
    handle.constrain_position = what != Constrain::transform;
    handle.constrain_transform = what != Constrain::position;
  });
  fields.optional("pose", [&](const Value& v) { handle.pose = parse_pose(v, handle.shape); });
  return handle;
}

std::vector<HandleSpec> parse_handles(const Value& value,
                                      const std::function<HandleSpec(const Value&)>& parse) {
  std::vector<HandleSpec> handles;
  std::set<std::string> names;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    handles.push_back(parse(element));
    require_new_name(names, handles.back().name, element.member("name"));
  }
  return handles;
}

std::vector<TargetSpec> parse_targets(const Value& value) {
  std::vector<TargetSpec> targets;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    const Object fields(element, {"vertex", "position"});
    targets.push_back({fields.required("vertex").vertex(), fields.required("position").vector3()});
  }
  return targets;
}

std::vector<TransformSpec> parse_transforms(const Value& value) {
  std::vector<TransformSpec> transforms;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    const Object fields(element, {"vertex", "matrix"});
    transforms.push_back({fields.required("vertex").vertex(), fields.required("matrix").matrix3()});
  }
  return transforms;
}

std::vector<AnchorSpec> parse_anchors(const Value& value) {
  std::vector<AnchorSpec> anchors;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Value element = value[i];
    const Object fields(element, {"select", "weight"});
    AnchorSpec anchor{parse_selection(fields.required("select"))};
    fields.optional("weight", [&](const Value& v) { anchor.weight = v.positive_number(); });
    anchors.push_back(std::move(anchor));
  }
  return anchors;
}

}  // namespace

FeatureSpec parse_feature(const Value& value) {
  const Object fields(value, {"select", "map"});
  FeatureSpec feature{parse_selection(fields.required("select"))};
  fields.optional("map", [&](const Value& v) {
    feature.similarity = v.choice<bool>({{"similarity", true}, {"affine", false}});
  });
  return feature;
}

SymmetrySpec parse_symmetry(const Value& value) {
  const Object fields(value, {"point", "normal", "tolerance_rel"});
  SymmetrySpec symmetry{{fields.required("point").vector3(), fields.required("normal").direction()}};
  fields.optional("tolerance_rel", [&](const Value& v) { symmetry.tolerance_rel = v.positive_number(); });
  return symmetry;
}

namespace {

DeformSettings parse_settings(const Value& value) {
  std::vector<std::string_view> known(deformer_fields.begin(), deformer_fields.end());
  known.insert(known.end(), {"refine_boundary", "proxy", "weld"});
  const Object fields(value, known);
  DeformSettings settings;
  settings.preset = parse_preset(fields);
  settings.deformer =
      parse_deformer(fields, settings.preset ? DeformerOptions::as_published() : DeformerOptions{});
  if (settings.preset) settings.refine_boundary = 0;
  fields.optional("refine_boundary", [&](const Value& v) {
    settings.refine_boundary.reset();
    if (v.raw() == "auto") return;
    if (!v.raw().is_number_integer()) v.fail_type(facts::script::Type::integer_or_auto);
    settings.refine_boundary = static_cast<int>(v.integer_in(0, max_refinements));
  });
  fields.optional("proxy",
                  [&](const Value& v) { settings.proxy = static_cast<Index>(v.integer_in(0, max_proxy)); });
  fields.optional("weld", [&](const Value& v) { settings.weld = v.boolean(); });
  return settings;
}

ExpectedCounts parse_counts(const Value& value, std::string_view region_key) {
  const Object fields(value, {"vertices", "faces", region_key, "fixed", "handle", "free"});
  ExpectedCounts counts;
  read_count(fields, "vertices", counts.vertices);
  read_count(fields, "faces", counts.faces);
  read_count(fields, region_key, counts.region);
  read_count(fields, "fixed", counts.fixed);
  read_count(fields, "handle", counts.handle);
  read_count(fields, "free", counts.free);
  return counts;
}

HandleSpec parse_handle_version_1(const Value& value) {
  const Object fields(value, {"name", "shape", "vertices", "transform"});
  HandleSpec handle;
  handle.name = fields.required("name").name();
  handle.shape = parse_shape(fields.required("shape"));
  handle.select = {Selection::Indices{fields.required("vertices").vertices()}};
  handle.pose = {fields.required("transform").affine_matrix()};
  return handle;
}

}  // namespace

EditStep parse_deform_step(const Value& value) {
  const Object fields(
      value, {"kind", "name", "about", "mesh", "result", "region", "fixed", "handles", "targets", "transforms",
              "anchors", "features", "symmetry", "settings", "counts"});
  DeformStep step;
  step.mesh = fields.required("mesh").name();
  fields.optional("result", [&](const Value& v) { step.result = v.name(); });
  fields.optional("region", [&](const Value& v) { step.region = parse_selection(v); });
  fields.optional("fixed", [&](const Value& v) { step.fixed = parse_selection(v); });
  fields.optional("handles", [&](const Value& v) { step.handles = parse_handles(v, parse_handle); });
  fields.optional("targets", [&](const Value& v) { step.targets = parse_targets(v); });
  fields.optional("transforms", [&](const Value& v) { step.transforms = parse_transforms(v); });
  fields.optional("anchors", [&](const Value& v) { step.anchors = parse_anchors(v); });
  fields.optional("features", [&](const Value& v) { step.features = parse_list(v, &parse_feature); });
  fields.optional("symmetry", [&](const Value& v) { step.symmetry = parse_symmetry(v); });
  fields.optional("settings", [&](const Value& v) { step.settings = parse_settings(v); });
  fields.optional("counts", [&](const Value& v) { step.counts = parse_counts(v, "region"); });
  return {{}, {}, std::move(step)};
}

EditFile parse_deform_version_1(const Value& root) {
  const Object fields(root, {"format", "version", "kind", "name", "about", "paper", "mesh", "counts", "roi",
                             "fixed", "handles", "expected"});
  EditFile edit;
  read_heading_version_1(fields, edit);
  EditInput input;
  input.name = "mesh";
  input.file = fields.required("mesh").name();
  edit.inputs.push_back(input);

  DeformStep step;
  step.mesh = input.name;
  step.settings.deformer.method = DeformMethod::ft05;
  step.settings.refine_boundary = 0;
  const Value roi = fields.required("roi");
  if (roi.is_string()) {
    if (roi.string() != "all") roi.fail_type(facts::script::Type::indices_or_all);
  } else {
    step.region = {Selection::Indices{roi.vertices()}};
  }
  step.fixed = EditSelection{Selection::Indices{fields.required("fixed").vertices()}};
  step.handles = parse_handles(fields.required("handles"), parse_handle_version_1);
  fields.optional("counts", [&](const Value& v) { step.counts = parse_counts(v, "roi"); });
  edit.steps.push_back({{}, {}, std::move(step)});
  return edit;
}

}  // namespace meshgraft
