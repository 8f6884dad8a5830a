#include "support/start_tasks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "merge/loop_curve.h"
#include "merge/match_by_arc_length.h"
#include "support/paths.h"

namespace meshgraft::test {

namespace {

using Vector = Eigen::Vector3d;

struct KnownModel {
  const char* name;
  const char* file;  ///< in the test data; empty for a built-in model
  Vector up, front;
};

const Vector X = Vector::UnitX(), Y = Vector::UnitY(), Z = Vector::UnitZ();

const KnownModel models[] = {
    {"venus", "venus_torso.obj", Y, Z},
    {"mannequin", "mannequin.ply", Z, -Y},
    {"horse", "horse.ply", Y, -Z},
    {"horse 8k", "horse_8k.ply", Y, -Z},
    {"feline", "feline.ply", -Z, X},
    {"skeleton", "dinosaur.ply", Y, -X},
    {"bunny", "bunny.ply", Y, -X},
    {"skull", "skull.ply", Z, -Y},
    {"head", "", Z, -Y},
    {"bust", "", Z, -Y},
    {"dinosaur", "", Z, -X},
};

/// A plane through a limb of a model; the normal points to the part.
struct KnownCut {
  const char* where;
  const char* model;
  Vector point, normal, in_part;
  std::optional<Vector> part_front{};  ///< where the part does not face the way of the model
};

const Vector spine = Vector(-1, 1, 0).normalized();

const KnownCut cuts[] = {
    {"neck", "venus", {-0.191, 2.357, 0.217}, {0.1, 0.93, 0.33}, {-0.2, 2.6, 0.25}},
    {"neck", "mannequin", {0, 0.2, -1.1}, {0, -0.3, 1}, Z},
    {"neck", "horse", {-0.06, 0.26, -0.3}, {-0.55, 0.45, -0.7}, {-0.2, 0.2, -0.5}, Vector(-0.45, 0, -0.9)},
    {"neck", "horse 8k", {-0.06, 0.26, -0.3}, {-0.55, 0.45, -0.7}, {-0.2, 0.2, -0.5}, Vector(-0.45, 0, -0.9)},
    {"neck", "feline", {0.24, 0, -1.68}, {0.8, 0, -0.6}, {0.45, 0, -1.9}},
    {"neck", "skeleton", {-30, 38, 2}, spine, {-45, 48, 2}},
    {"neck", "bunny", {-0.05, 0.118, 0.01}, {-0.6, 0.75, 0.1}, {-0.08, 0.14, 0.02}},
    {"neck", "skull", {0, 4, -6}, {0, -0.5, 0.85}, {0, 0, 5}},
    {"neck", "head", {0, 0.1, -0.22}, Z, Z},
    {"neck", "bust", {0, 0.1, -0.38}, Z, {0, 0.1, -0.28}},
    {"neck", "dinosaur", {-1.6, 0, 2.3}, {-0.4, 0, 0.9}, {-2.2, 0, 3.4}},
    {"waist", "feline", {-0.18, 0, 0}, X, {0.5, 0, -1.9}},
    {"waist", "skeleton", spine*(spine.dot(Vector(8, 2, 2)) + 4.5), spine, {-45, 48, 2}},
    {"waist", "horse", {0, 0.15, 0}, -Z, {0, 0.2, -0.4}},
    {"waist", "horse 8k", {0, 0.15, 0}, -Z, {0, 0.2, -0.4}},
    {"waist", "dinosaur", {0.1, 0, 1.2}, -X, {-2.2, 0, 3.4}},
    {"waist", "bunny", {-0.005, 0.08, 0}, -X, {-0.08, 0.14, 0.02}},
    {"tail", "dinosaur", {1.7, 0, 1.2}, {1, 0, 0.1}, {3.5, 0, 0.8}},
    {"tail", "skeleton", {25, -14, 3}, {0.85, -0.5, 0}, {66, -40, 3}},
};

/// Models whose parts are grafted onto bodies of others; `part_is_body`: the larger piece is the part.
struct Family {
  const char *kind, *where;
  bool part_is_body;
  std::vector<const char*> parts, bodies;
};

const Family families[] = {
    {"head",
     "neck",
     false,
     {"mannequin", "horse", "feline", "skeleton", "bunny", "skull", "head", "dinosaur"},
     {"venus", "mannequin", "horse", "feline", "skeleton", "bunny", "bust", "dinosaur"}},
    {"fore part",
     "waist",
     false,
     {"feline", "skeleton", "horse", "dinosaur", "bunny"},
     {"feline", "skeleton", "horse", "dinosaur", "bunny"}},
    {"hind part",
     "waist",
     true,
     {"feline", "skeleton", "horse", "dinosaur", "bunny"},
     {"feline", "skeleton", "horse", "dinosaur", "bunny"}},
    {"tail", "tail", false, {"dinosaur", "skeleton"}, {"dinosaur", "skeleton"}},
};

Vector mean_of(const Mesh& mesh, const std::vector<Index>& loop) {
  Vector sum = Vector::Zero();
  for (const Index v : loop) sum += mesh.positions.row(v).transpose();
  return sum / static_cast<double>(loop.size());
}

double radius_of(const Mesh& mesh, const std::vector<Index>& loop) {
  const Vector centre = mean_of(mesh, loop);
  double sum = 0;
  for (const Index v : loop) sum += (mesh.positions.row(v).transpose() - centre).squaredNorm();
  return std::sqrt(sum / static_cast<double>(loop.size()));
}

/// Returns the component with the vertex nearest to a point, or the one with the most vertices.
Mesh one_component(const Mesh& mesh, const std::optional<Vector>& point) {
  Index count = 0;
  const std::vector<Index> component = connected_components(mesh, &count);
  Index kept = 0;
  if (point) {
    Eigen::Index nearest = 0;
    (mesh.positions.rowwise() - point->transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    kept = component[nearest];
  } else {
    std::vector<int> sizes(count, 0);
    for (const Index c : component)
      if (c >= 0) ++sizes[c];
    kept = static_cast<Index>(std::ranges::max_element(sizes) - sizes.begin());
  }
  std::vector<Index> number(component.size(), -1);
  Mesh piece;
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (component[v] == kept) number[v] = static_cast<Index>(vertices.size()), vertices.push_back(v);
  piece.positions.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k)
    piece.positions.row(static_cast<Eigen::Index>(k)) = mesh.positions.row(vertices[k]);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    std::vector<Index> face;
    for (const Index v : mesh.faces[f]) face.push_back(number[v]);
    if (face.front() >= 0) piece.faces.push_back(face);
  }
  return piece;
}

struct Piece {
  Mesh mesh;
  std::vector<Index> loop;
};

/// Cuts a model, and returns one side with the loop nearest to the point of the cut.
Piece cut_piece(const Mesh& model, const KnownCut& cut, const Vector& point, const Vector& normal, bool part) {
  const CutKeep keep = part ? CutKeep::above : CutKeep::below;
  Piece piece;
  piece.mesh = one_component(cut_by_plane(model, {point, normal}, {.keep = keep}).mesh,
                             part ? std::optional(cut.in_part) : std::nullopt);
  double least = std::numeric_limits<double>::infinity();
  for (std::vector<Index>& loop : boundary_loops(piece.mesh)) {
    double off_plane = 0;
    for (const Index v : loop)
      off_plane = std::max(
          off_plane, std::abs((piece.mesh.positions.row(v).transpose() - point).dot(normal.normalized())));
    const double distance = (mean_of(piece.mesh, loop) - point).norm() + 5 * off_plane;
    if (distance < least) least = distance, piece.loop = std::move(loop);
  }
  return piece;
}

/// Reads and cuts models.
class Workshop {
 public:
  explicit Workshop(bool data) : data_(data) {}

  bool has(const std::string& name) const { return data_ || known(name).file[0] == '\0'; }

  static const KnownModel& known(const std::string& name) {
    return *std::ranges::find_if(models, [&](const KnownModel& model) { return model.name == name; });
  }

  const Mesh& model(const std::string& name) {
    if (const auto found = meshes_.find(name); found != meshes_.end()) return found->second;
    const KnownModel& model = known(name);
    Mesh mesh = model.file[0] == '\0' ? make_sample(name) : read_mesh(data_folder() / "models" / model.file);
    guesses_[name] = guess_orientations(mesh);
    return meshes_[name] = std::move(mesh);
  }
  const std::vector<OrientationGuess>& guesses(const std::string& name) {
    model(name);
    return guesses_.at(name);
  }

  /// Returns a piece cut with a tilt (degrees) about a direction and a shift (× the loop's diameter), or
  /// nothing where that loop is of another size or elsewhere.
  std::optional<Piece> piece(const KnownCut& cut, bool part, const Vector& about, double tilt_deg,
                             double shift) {
    try {
      const Mesh& whole = model(cut.model);
      const Vector normal = cut.normal.normalized();
      const Piece plain = cut_piece(whole, cut, cut.point, normal, part);
      const Vector centre = mean_of(plain.mesh, plain.loop);
      const double radius = radius_of(plain.mesh, plain.loop);
      const Vector axis = normal.cross(about).normalized();
      const Vector tilted = Eigen::AngleAxisd(tilt_deg * std::numbers::pi / 180, axis) * normal;
      const Vector point = centre + 2 * shift * radius * normal;
      Piece piece = cut_piece(whole, cut, point, tilted, part);
      if (piece.loop.empty()) return std::nullopt;
      const double ratio = radius_of(piece.mesh, piece.loop) / radius;
      if (ratio > 1.6 || ratio < 0.6 || (mean_of(piece.mesh, piece.loop) - point).norm() > radius)
        return std::nullopt;
      return piece;
    } catch (const Error&) {
      return std::nullopt;  // the plane misses the limb
    }
  }

 private:
  bool data_;
  std::map<std::string, Mesh> meshes_;
  std::map<std::string, std::vector<OrientationGuess>> guesses_;
};

const KnownCut& cut_of(const char* where, const std::string& model) {
  return *std::ranges::find_if(
      cuts, [&](const KnownCut& cut) { return std::string(cut.where) == where && model == cut.model; });
}

}  // namespace

std::vector<StartTask> start_tasks(bool data, int variants) {
  Workshop workshop(data);
  std::vector<StartTask> tasks;
  std::mt19937 random(7);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
  };
  const auto direction = [&] { return Vector(draw(-1, 1), draw(-1, 1), draw(-1, 1)); };
  const auto one_of = [&](std::initializer_list<double> values) {
    return *std::next(values.begin(), random() % 3);
  };
  for (const Family& family : families)
    for (const std::string part : family.parts)
      for (const std::string body : family.bodies) {
        if (part == body) continue;
        for (int variant = 0; variant < variants; ++variant) {
          // The horse has a second tessellation.
          const auto tessellated = [&](const std::string& name) {
            return name == "horse" && random() % 2 == 0 ? std::string("horse 8k") : name;
          };
          const std::string source_name = tessellated(part), target_name = tessellated(body);
          const Vector about_source = direction(), about_target = direction();
          const bool plain = variant == 0;
          const double tilts[] = {plain ? 0 : one_of({-10, 0, 10}), plain ? 0 : one_of({-10, 0, 10})};
          const double shifts[] = {plain ? 0 : one_of({-0.2, 0, 0.2}), plain ? 0 : one_of({-0.2, 0, 0.2})};
          if (!workshop.has(source_name) || !workshop.has(target_name)) continue;
          const KnownCut &source_cut = cut_of(family.where, source_name),
                         &target_cut = cut_of(family.where, target_name);
          auto source = workshop.piece(source_cut, !family.part_is_body, about_source, tilts[0], shifts[0]);
          auto target = workshop.piece(target_cut, family.part_is_body, about_target, tilts[1], shifts[1]);
          if (!source || !target) continue;
          const KnownModel &here = Workshop::known(source_name), &there = Workshop::known(target_name);
          tasks.push_back(
              {fmt::format("{} of {} on {}, tilted by {:.0f}° and {:.0f}°, shifted by {} and {}", family.kind,
                           source_name, target_name, tilts[0], tilts[1], shifts[0], shifts[1]),
               family.kind,
               std::move(target->mesh),
               std::move(source->mesh),
               {std::move(source->loop), std::move(target->loop)},
               make_orientation(there.up, there.front),
               make_orientation(here.up, source_cut.part_front.value_or(here.front)),
               workshop.guesses(target_name),
               workshop.guesses(source_name)});
        }
      }
  return tasks;
}

namespace {

Points loop_points(const Mesh& mesh, const std::vector<Index>& loop) {
  Points rows(static_cast<Eigen::Index>(loop.size()), 3);
  for (std::size_t k = 0; k < loop.size(); ++k)
    rows.row(static_cast<Eigen::Index>(k)) = mesh.positions.row(loop[k]);
  return rows;
}

/// Returns the rotation of the similarity that brings one list of points nearest to another.
Eigen::Matrix3d rotation_between(const Points& from, const Points& to) {
  Similarity best;
  fit_similarity(from, to, Eigen::VectorXd::Ones(from.rows()), best);
  return best.rotation;
}

/// Returns the rotation of a graft from a start.
Eigen::Matrix3d rotation_from(const StartTask& task, const Match& start) {
  PairGeometry pair;
  pair.loops = task.loops;
  pair.source.points = loop_points(task.source, task.loops.source);
  pair.target.points = loop_points(task.target, task.loops.target);
  const Correspondence found = match_by_arc_length(pair, {{start}});
  Points there(pair.source.points.rows(), 3);
  for (Eigen::Index i = 0; i < there.rows(); ++i)
    there.row(i) = at(pair.target.points, found.loop_parameter[i]);
  return rotation_between(pair.source.points, there);
}

constexpr int arcs = 180;

/// Returns points at equal lengths along a loop.
Points evenly(const Points& loop, bool backwards) {
  const LoopCurve curve(loop);
  Points points(arcs, 3);
  for (int k = 0; k < arcs; ++k)
    points.row(k) = at(loop, curve.parameter_at(curve.length() * (backwards ? arcs - k : k) / arcs));
  return points;
}

Eigen::Matrix3d frame_of(const Orientation& orientation) {
  Eigen::Matrix3d frame;
  frame << orientation.up, orientation.front, orientation.up.cross(orientation.front);
  return frame;
}

}  // namespace

double start_error_deg(const StartTask& task, const Match& start) {
  const Eigen::Matrix3d aligned =
      frame_of(task.target_orientation) * frame_of(task.source_orientation).transpose();
  const Points from = evenly(loop_points(task.source, task.loops.source), false),
               to = evenly(loop_points(task.target, task.loops.target), true);
  Eigen::Matrix3d right = Eigen::Matrix3d::Identity();
  double most = -2;
  for (int shift = 0; shift < arcs; ++shift) {
    Points shifted(arcs, 3);
    shifted << to.bottomRows(arcs - shift), to.topRows(shift);
    const Eigen::Matrix3d rotation = rotation_between(from, shifted);
    const double trace = rotation.cwiseProduct(aligned).sum();
    if (trace > most) most = trace, right = rotation;
  }
  return Eigen::AngleAxisd(rotation_from(task, start) * right.transpose()).angle() * 180 / std::numbers::pi;
}

}  // namespace meshgraft::test
