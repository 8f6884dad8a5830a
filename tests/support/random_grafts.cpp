#include "support/random_grafts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/pose_source.h"
#include "mesh/interpolate_attribute.h"

namespace meshgraft::test {

namespace {

/// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Index below(Index count) { return static_cast<Index>(uniform(0, count)); }
  bool chance(double probability) { return uniform(0, 1) < probability; }
  template <class List>
  const auto& one_of(const List& list) {
    return list[static_cast<std::size_t>(below(static_cast<Index>(std::size(list))))];
  }

  Eigen::Vector3d direction() {
    const double height = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi);
    const double radius = std::sqrt(1 - height * height);
    return {radius * std::cos(angle), radius * std::sin(angle), height};
  }
  Eigen::Matrix3d rotation() {
    return Eigen::AngleAxisd(uniform(0, 2 * std::numbers::pi), direction()).toRotationMatrix();
  }

 private:
  std::mt19937_64 engine_;
};

struct OpenModel {
  std::string text;
  Mesh mesh;
  std::vector<std::vector<Index>> loops;  ///< boundary loops that the cut made
};

Mesh random_model(Random& random, std::string& text) {
  const auto models = sample_list();
  const std::string name(
      models[static_cast<std::size_t>(random.below(static_cast<Index>(models.size())))].name);
  const int resolution = 24 + random.below(67);
  text = fmt::format("{} {}", name, resolution);
  return make_sample(name, resolution);
}

/// Cuts by a random plane through a point between two vertices.
CutResult cut_by_random_plane(const Mesh& mesh, const CutOptions& options, Random& random, std::string& text) {
  const Eigen::Vector3d a = mesh.positions.row(random.below(mesh.vertex_count())),
                        b = mesh.positions.row(random.below(mesh.vertex_count()));
  const Eigen::Vector3d point = a + random.uniform(0.2, 0.8) * (b - a), normal = random.direction();
  text += fmt::format(", plane {:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}", point.x(), point.y(), point.z(),
                      normal.x(), normal.y(), normal.z());
  return cut_by_plane(mesh, {point, normal}, options);
}

/// Cuts along a loop round a random vertex, some rings away from it.
CutResult cut_along_random_loop(const Mesh& mesh, const CutOptions& options, Random& random,
                                std::string& text) {
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  const Index middle = random.below(mesh.vertex_count());
  const int away = 3 + random.below(6);
  const std::array seed{middle};
  const std::vector<Index> inner = grow_rings(seed, away - 1, rings), outer = grow_rings(seed, away, rings);
  std::vector<Index> ring;
  std::set_difference(outer.begin(), outer.end(), inner.begin(), inner.end(), std::back_inserter(ring));
  const Eigen::RowVector3d centre = mesh.positions.row(middle);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Index v : ring) {
    const Eigen::RowVector3d from_centre = mesh.positions.row(v) - centre;
    spread += from_centre.transpose() * from_centre;
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  const auto angle = [&](Index v) {
    const Eigen::Vector3d from_centre = (mesh.positions.row(v) - centre).transpose();
    return std::atan2(from_centre.dot(axes.col(1)), from_centre.dot(axes.col(2)));
  };
  std::sort(ring.begin(), ring.end(), [&](Index a, Index b) { return angle(a) < angle(b); });
  const std::size_t count = std::min<std::size_t>(ring.size(), 3 + static_cast<std::size_t>(random.below(6)));
  std::vector<Index> corners;
  for (std::size_t k = 0; k < count; ++k) corners.push_back(ring[k * ring.size() / count]);
  text += fmt::format(", loop {}", fmt::join(corners, ","));
  return cut_along_loop(mesh, corners, options);
}

bool is_long_enough(const std::vector<Index>& loop) { return loop.size() >= 5; }

/// Returns one side of a random cut of a random model.
OpenModel random_open_model(Random& random) {
  while (true) {  // until a cut succeeds: planes may miss the mesh, and loops may cross themselves
    OpenModel model;
    const Mesh whole = random_model(random, model.text);
    const CutOptions options{.keep = random.chance(0.5) ? CutKeep::above : CutKeep::below};
    model.text += options.keep == CutKeep::above ? ", above" : ", below";
    try {
      CutResult cut = random.chance(0.7) ? cut_by_random_plane(whole, options, random, model.text)
                                         : cut_along_random_loop(whole, options, random, model.text);
      model.mesh = std::move(cut.mesh);
      std::copy_if(cut.loops.begin(), cut.loops.end(), std::back_inserter(model.loops), is_long_enough);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::input) throw;
    }
    if (!model.loops.empty()) return model;
  }
}

/// Returns the connected component of one loop, with all loops on it.
OpenModel connected_part(const OpenModel& model, const std::vector<Index>& loop) {
  const std::vector<Index> component = connected_components(model.mesh);
  const Index kept = component[loop.front()];
  OpenModel part{model.text, {}, {}};
  std::vector<Index> local(component.size(), -1);
  std::vector<EdgePoint> vertices;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    if (component[v] != kept) continue;
    local[v] = static_cast<Index>(vertices.size());
    vertices.push_back({v, v, 0});
  }
  part.mesh.positions.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k)
    part.mesh.positions.row(static_cast<Eigen::Index>(k)) = model.mesh.positions.row(vertices[k].from);
  std::vector<Index> face;
  for (Index f = 0; f < model.mesh.face_count(); ++f) {
    if (component[model.mesh.faces[f][0]] != kept) continue;
    face.clear();
    for (const Index v : model.mesh.faces[f]) face.push_back(local[v]);
    part.mesh.faces.push_back(face);
  }
  for (const Attribute& attribute : model.mesh.attributes)
    if (attribute.domain == Domain::vertex)
      part.mesh.attributes.push_back(interpolate_attribute(attribute, vertices));
  for (const auto& of_model : model.loops) {
    if (component[of_model.front()] != kept) continue;
    part.loops.emplace_back();
    for (const Index v : of_model) part.loops.back().push_back(local[v]);
  }
  return part;
}

Points points_of(const Mesh& mesh, const std::vector<Index>& loop) {
  Points points(static_cast<Eigen::Index>(loop.size()), 3);
  for (std::size_t i = 0; i < loop.size(); ++i)
    points.row(static_cast<Eigen::Index>(i)) = mesh.positions.row(loop[i]);
  return points;
}

struct LoopFrame {
  Eigen::Vector3d centre, axis;
  double radius = 0;
};

LoopFrame frame_of(const Points& points) {
  LoopFrame frame;
  frame.centre = points.colwise().mean().transpose();
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Vector3d a = points.row(i).transpose() - frame.centre,
                          b = points.row((i + 1) % points.rows()).transpose() - frame.centre;
    area += a.cross(b);
  }
  frame.axis = area.stableNormalized();
  frame.radius = std::sqrt((points.rowwise() - frame.centre.transpose()).rowwise().squaredNorm().mean());
  return frame;
}

/// Returns a pose as a user would choose it. Centres and axes of the loops nearly agree; the turn about the
/// axis is arbitrary.
Eigen::Affine3d pose_by_hand(const LoopFrame& source, const LoopFrame& target, Random& random) {
  const Eigen::Matrix3d onto =
      Eigen::AngleAxisd(random.uniform(-0.25, 0.25), random.direction()).toRotationMatrix() *
      Eigen::AngleAxisd(random.uniform(0, 2 * std::numbers::pi), target.axis).toRotationMatrix() *
      Eigen::Quaterniond::FromTwoVectors(source.axis, -target.axis).toRotationMatrix();
  const double scale = random.uniform(0.8, 1.25) * target.radius / source.radius;
  const Eigen::Vector3d shift = random.uniform(0, 0.2) * target.radius * random.direction();
  return Eigen::Translation3d(target.centre + shift) * (scale * onto) * Eigen::Translation3d(-source.centre);
}

Eigen::Affine3d random_similarity(Random& random) {
  const double scale = std::exp(random.uniform(std::log(0.1), std::log(10)));
  return Eigen::Translation3d(20 * scale * random.direction()) * (scale * random.rotation());
}

/// Returns some vertices of the source away from its loops, or none if fewer than five remain.
std::optional<MergeFeature> random_feature(const OpenModel& source, Random& random) {
  constexpr int free_rings = 4;
  const IndexLists rings = vertex_rings(source.mesh.vertex_count(), source.mesh.faces);
  const std::array seed{random.below(source.mesh.vertex_count())};
  std::vector<Index> vertices = grow_rings(seed, 1 + random.below(5), rings);
  for (const auto& loop : source.loops) {
    const std::vector<Index> near = grow_rings(loop, free_rings, rings);
    std::erase_if(vertices, [&](Index v) { return std::binary_search(near.begin(), near.end(), v); });
  }
  if (vertices.size() < 5) return std::nullopt;
  return MergeFeature{std::move(vertices), random.chance(0.5)};
}

MergeOptions random_options(const OpenModel& source, double radius_ratio, GraftKind kind, Random& random,
                            std::string& text) {
  MergeOptions options;
  const bool ft05 = random.chance(0.4), keep = random.chance(0.2);
  if (kind == GraftKind::any && ft05) options.shape = MergeShape::ft05;
  if (kind == GraftKind::any && keep) options.pose = MergePose::keep;
  options.smooth_boundary = random.chance(0.2);
  const bool leans = random.chance(0.1);
  if (leans) {
    const double angle = random.uniform(-30, 30);
    if (kind == GraftKind::any) options.normal_angle_deg = angle;
  }
  if (options.pose == MergePose::find && random.chance(0.15))
    options.size = radius_ratio * (kind == GraftKind::any ? random.uniform(0.5, 2) : random.uniform(0.7, 1.4));
  if (random.chance(0.15))
    if (auto feature = random_feature(source, random)) options.features.push_back(std::move(*feature));
  text += fmt::format("; {}, pose {}", to_string(options.shape), to_string(options.pose));
  if (options.smooth_boundary) text += ", smooth boundary";
  if (options.normal_angle_deg != 0) text += fmt::format(", normals {:.0f}°", options.normal_angle_deg);
  if (options.size) text += fmt::format(", size {:.3g}", *options.size);
  for (const MergeFeature& feature : options.features)
    text += fmt::format(", {} feature of {} vertices", feature.similarity ? "similarity" : "affine",
                        feature.vertices.size());
  return options;
}

void shuffle(std::vector<std::vector<Index>>& loops, Random& random) {
  for (std::size_t k = loops.size(); k > 1; --k)
    std::swap(loops[k - 1], loops[static_cast<std::size_t>(random.below(static_cast<Index>(k)))]);
}

}  // namespace

RandomGraft make_random_graft(std::uint64_t seed, GraftKind kind) {
  Random random(seed);
  OpenModel target = random_open_model(random);
  const OpenModel whole_source = random_open_model(random);
  OpenModel source = connected_part(whole_source, random.one_of(whole_source.loops));
  shuffle(target.loops, random);
  shuffle(source.loops, random);
  const std::size_t most = std::min({target.loops.size(), source.loops.size(), std::size_t{3}});
  const std::size_t count = random.chance(0.5) ? most : 1;

  const LoopFrame there = frame_of(points_of(target.mesh, target.loops.front())),
                  here = frame_of(points_of(source.mesh, source.loops.front()));
  std::string options_text;
  MergeOptions options = random_options(source, there.radius / here.radius, kind, random, options_text);
  const Eigen::Affine3d pose =
      options.pose == MergePose::keep ? pose_by_hand(here, there, random) : random_similarity(random);
  if (options.size) *options.size /= std::cbrt(pose.linear().determinant());

  RandomGraft graft;
  graft.source = transformed(source.mesh, pose, "source");
  graft.target = std::move(target.mesh);
  graft.options = std::move(options);
  for (std::size_t p = 0; p < count; ++p) {
    MergePair pair{{source.loops[p], target.loops[p]}, {}};
    if (kind == GraftKind::any && random.chance(0.5))
      pair.matches = {{random.one_of(source.loops[p]), random.one_of(target.loops[p])}};
    graft.pairs.push_back(std::move(pair));
    options_text += fmt::format("; loops of {} on {}{}", source.loops[p].size(), target.loops[p].size(),
                                graft.pairs.back().matches.empty() ? "" : " from a start");
  }
  graft.text = source.text + " on " + target.text + options_text;
  return graft;
}

Attempt attempt(const RandomGraft& graft) {
  Attempt made;
  try {
    made.result = merge_meshes(graft.target, graft.source, graft.pairs, graft.options);
  } catch (const Error& error) {
    made.refusal = error;
  }
  return made;
}

}  // namespace meshgraft::test
