#include "viewpoint.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "mesh/ray_tracer.h"
#include "mesh/up_axis.h"

namespace meshgraft::render {

namespace {

// Scatters the bits of a number (the finaliser of splitmix64).
std::uint64_t scattered(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

// Returns a hash per face of the positions of its corners, in whatever order.
std::vector<std::uint64_t> face_hashes(const Mesh& mesh) {
  std::vector<std::uint64_t> of_vertex(mesh.positions.rows());
  for (std::size_t v = 0; v < of_vertex.size(); ++v) {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double x = mesh.positions(static_cast<Eigen::Index>(v), axis) + 0.0;  // -0 is 0
      hash = scattered(hash + std::bit_cast<std::uint64_t>(x));
    }
    of_vertex[v] = hash;
  }
  std::vector<std::uint64_t> hashes(mesh.face_count());
  for (Index f = 0; f < mesh.face_count(); ++f)
    for (const Index v : mesh.faces[f]) hashes[f] += of_vertex[v];
  return hashes;
}

// Returns the faces with a vertex that has another position in `other`, which has the same faces.
std::vector<Index> moved_faces(const Mesh& mesh, const Mesh& other) {
  std::vector<Index> moved;
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (std::ranges::any_of(mesh.faces[f],
                            [&](Index v) { return mesh.positions.row(v) != other.positions.row(v); }))
      moved.push_back(f);
  return moved;
}

// Returns the faces of `mesh` that `other` does not have.
std::vector<Index> own_faces(const Mesh& mesh, const Mesh& other) {
  if (mesh.positions.rows() == other.positions.rows() && mesh.faces == other.faces)
    return moved_faces(mesh, other);
  std::vector<std::uint64_t> known = face_hashes(other);
  std::sort(known.begin(), known.end());
  const std::vector<std::uint64_t> hashes = face_hashes(mesh);
  std::vector<Index> own;
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (!std::binary_search(known.begin(), known.end(), hashes[f])) own.push_back(f);
  return own;
}

void extend(Eigen::AlignedBox3d& box, const Mesh& mesh, const std::vector<Index>& faces) {
  for (const Index f : faces)
    for (const Index v : mesh.faces[f])
      if (mesh.positions.row(v).allFinite()) box.extend(mesh.positions.row(v).transpose());
}

// A point of a surface that shall be seen.
struct Spot {
  Eigen::Vector3d point, normal;
};

std::vector<Spot> spots_on(const Mesh& mesh, const std::vector<Index>& faces) {
  constexpr std::size_t most_spots = 500;
  const std::size_t stride = faces.size() / most_spots + 1;
  std::vector<Spot> spots;
  for (std::size_t i = 0; i < faces.size(); i += stride) {
    const auto face = mesh.faces[faces[i]];
    Spot spot{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    const Eigen::Vector3d first = mesh.positions.row(face[0]);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Eigen::Vector3d a = mesh.positions.row(face[k]),
                            b = mesh.positions.row(face[(k + 1) % face.size()]);
      spot.point += a / static_cast<double>(face.size());
      spot.normal += (a - first).cross(b - first);
    }
    spot.normal.normalize();
    if (spot.point.allFinite() && spot.normal.allFinite()) spots.push_back(spot);
  }
  return spots;
}

// Returns the mean over the spots of the cosine to the eye, 0 where a spot is hidden.
double seen_share(const std::vector<Spot>& spots, const RayTracer& tracer, const Eigen::Affine3d& to_unit,
                  const Eigen::Vector3d& direction) {
  constexpr double above = 1e-3;  // of the radius of the mesh, so that a face does not hide itself
  double seen = 0;
  for (const Spot& spot : spots) {
    const double cosine = spot.normal.dot(direction);
    if (cosine <= 0) continue;
    const Eigen::Vector3d from = to_unit * spot.point + above * spot.normal;
    if (!tracer.blocked(from.cast<float>(), direction.cast<float>())) seen += cosine;
  }
  return seen / static_cast<double>(spots.size());
}

}  // namespace

Eigen::Vector3d up_of(const Mesh& mesh) {
  return up_axis_of(mesh) == UpAxis::y ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d usual_direction(const Eigen::Vector3d& up) {
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up) *
         Camera().from_direction.normalized();
}

Eigen::Vector3d usual_direction(const Orientation& orientation) {
  const auto& [up, front] = orientation;
  const Eigen::Vector3d usual = Camera().from_direction.normalized();  // with z up and -y in front
  return usual.x() * up.cross(front) - usual.y() * front + usual.z() * up;
}

Eigen::AlignedBox3d box_of(std::span<const Mesh* const> meshes) {
  Eigen::AlignedBox3d box;
  for (const Mesh* mesh : meshes)
    for (const auto& position : mesh->positions.rowwise())
      if (position.allFinite()) box.extend(position.transpose());
  return box;
}

Eigen::AlignedBox3d box_of_change(std::span<const Mesh* const> meshes) {
  const Eigen::AlignedBox3d all = box_of(meshes);
  Eigen::AlignedBox3d changed;
  for (const Mesh* mesh : meshes.subspan(1)) {
    extend(changed, *mesh, own_faces(*mesh, *meshes.front()));
    extend(changed, *meshes.front(), own_faces(*meshes.front(), *mesh));
  }
  constexpr double largest_detail = 0.4;  // of the diagonal of all
  if (changed.isEmpty() || changed.diagonal().stableNorm() > largest_detail * all.diagonal().stableNorm())
    return all;
  const double margin = std::max(0.5 * changed.sizes().maxCoeff(), 0.05 * all.diagonal().stableNorm());
  const Eigen::Vector3d around = Eigen::Vector3d::Constant(margin);
  return Eigen::AlignedBox3d(changed.min() - around, changed.max() + around).intersection(all);
}

Eigen::Vector3d direction_to_change(const Mesh& before, const Mesh& after, const Eigen::Vector3d& up,
                                    const Context& context) {
  const Eigen::Vector3d usual = usual_direction(up);
  const std::vector<Spot> spots = spots_on(after, own_faces(after, before));
  if (spots.empty()) return usual;

  const Mesh* shown = &after;
  const Eigen::AlignedBox3d box = box_of({&shown, 1});
  const Eigen::Affine3d to_unit =
      Eigen::Scaling(2 / box.diagonal().stableNorm()) * Eigen::Translation3d(-box.center());
  const Triangles corners_of = triangulate(after).triangles;
  std::vector<RayTriangle> triangles;
  triangles.reserve(static_cast<std::size_t>(corners_of.rows()));
  for (const auto corners : corners_of.rowwise()) {
    RayTriangle& triangle = triangles.emplace_back();
    for (int c = 0; c < 3; ++c)
      triangle[static_cast<std::size_t>(c)] =
          (to_unit * after.positions.row(corners[c]).transpose()).cast<float>();
  }
  const RayTracer tracer(triangles, context);

  constexpr double preference = 2;  // for the usual direction
  Eigen::Vector3d best = usual;
  double most_seen = preference * seen_share(spots, tracer, to_unit, usual);
  const Eigen::Vector3d sideways = up.cross(usual).normalized();
  for (const double raised : {0.0, 0.5, -0.8})  // radians; the last one looks from below
    for (int eighth = 0; eighth < 8; ++eighth) {
      const Eigen::Vector3d direction = Eigen::AngleAxisd(eighth * std::numbers::pi / 4, up.normalized()) *
                                        (Eigen::AngleAxisd(-raised, sideways) * usual);
      const double seen = seen_share(spots, tracer, to_unit, direction);
      if (seen > most_seen) {
        most_seen = seen;
        best = direction;
      }
    }
  return best;
}

}  // namespace meshgraft::render
