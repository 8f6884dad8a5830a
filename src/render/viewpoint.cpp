#include "viewpoint.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "core/scattered_bits.h"
#include "mesh/ray_tracer.h"
#include "mesh/up_axis.h"
#include "occluders.h"

namespace meshgraft::render {

namespace {

// Returns a hash per face of the positions of its corners, in whatever order.
std::vector<std::uint64_t> face_hashes(const Mesh& mesh) {
  std::vector<std::uint64_t> of_vertex(mesh.positions.rows());
  for (std::size_t v = 0; v < of_vertex.size(); ++v) {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double x = mesh.positions(static_cast<Eigen::Index>(v), axis) + 0.0;  // -0 is 0
      hash = scattered_bits(hash + std::bit_cast<std::uint64_t>(x));
    }
    of_vertex[v] = hash;
  }
  std::vector<std::uint64_t> hashes(mesh.face_count());
  for (Index f = 0; f < mesh.face_count(); ++f)
    for (const Index v : mesh.faces[f]) hashes[f] += of_vertex[v];
  return hashes;
}

bool have_same_faces(const Mesh& a, const Mesh& b) {
  return a.positions.rows() == b.positions.rows() && a.faces == b.faces;
}

// Returns the faces with a vertex that has another position in `other`, which has the same faces.
std::vector<Index> moved_faces(const Mesh& mesh, const Mesh& other, const Context& context) {
  Flags is_moved(mesh.face_count(), 0);
  parallel_blocks(
      is_moved.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
          is_moved[f] = std::ranges::any_of(mesh.faces[static_cast<Index>(f)], [&](Index v) {
            return mesh.positions.row(v) != other.positions.row(v);
          });
      },
      context, 4096);
  std::vector<Index> moved;
  for (std::size_t f = 0; f < is_moved.size(); ++f)
    if (is_moved[f]) moved.push_back(static_cast<Index>(f));
  return moved;
}

// Returns the faces of `mesh` that `other` does not have.
std::vector<Index> own_faces(const Mesh& mesh, const Mesh& other, const Context& context) {
  if (have_same_faces(mesh, other)) return moved_faces(mesh, other, context);
  std::vector<std::uint64_t> known = face_hashes(other);
  std::sort(known.begin(), known.end());
  const std::vector<std::uint64_t> hashes = face_hashes(mesh);
  std::vector<Index> own;
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (!std::binary_search(known.begin(), known.end(), hashes[f])) own.push_back(f);
  return own;
}

Eigen::AlignedBox3d box_of_faces(const Mesh& mesh, const std::vector<Index>& faces, const Context& context) {
  constexpr std::size_t block_size = 16384;
  std::vector<Eigen::AlignedBox3d> blocks((faces.size() + block_size - 1) / block_size);
  parallel_blocks(
      blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block)
          for (std::size_t k = block * block_size; k < std::min(faces.size(), (block + 1) * block_size); ++k)
            for (const Index v : mesh.faces[faces[k]])
              if (mesh.positions.row(v).allFinite()) blocks[block].extend(mesh.positions.row(v).transpose());
      },
      context, 1);
  Eigen::AlignedBox3d box;
  for (const Eigen::AlignedBox3d& block : blocks) box.extend(block);
  return box;
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

// Returns the mean over the spots of the cosine to the eye, 0 where a spot is hidden. Rays begin `above` the
// spots, in radii of the mesh.
double seen_share(const std::vector<Spot>& spots, const RayTracer& tracer, const Eigen::Affine3d& to_unit,
                  double above, const Eigen::Vector3d& direction) {
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

Eigen::AlignedBox3d box_of_change(std::span<const Mesh* const> meshes, const Context& context) {
  const Eigen::AlignedBox3d all = box_of(meshes);
  Eigen::AlignedBox3d changed;
  const Mesh& first = *meshes.front();
  for (const Mesh* mesh : meshes.subspan(1)) {
    const std::vector<Index> faces = own_faces(*mesh, first, context);
    changed.extend(box_of_faces(*mesh, faces, context));
    const bool moved = have_same_faces(*mesh, first);  // the same faces in both
    changed.extend(box_of_faces(first, moved ? faces : own_faces(first, *mesh, context), context));
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
  const std::vector<Spot> spots = spots_on(after, own_faces(after, before, context));
  if (spots.empty()) return usual;

  const Mesh* shown = &after;
  const Eigen::AlignedBox3d box = box_of({&shown, 1});
  const Eigen::Affine3d to_unit =
      Eigen::Scaling(2 / box.diagonal().stableNorm()) * Eigen::Translation3d(-box.center());
  std::vector<Eigen::Vector3f> points(static_cast<std::size_t>(after.positions.rows()));
  parallel_blocks(
      points.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
          points[v] = (to_unit * after.positions.row(static_cast<Eigen::Index>(v)).transpose()).cast<float>();
      },
      context, 4096);
  constexpr float cell = 0.01f;
  const Occluders occluders = make_occluders(points, triangulate(after).triangles, cell, context);
  const RayTracer tracer(occluders.triangles, context);
  const double above =
      std::max(1e-3, static_cast<double>(occluders.lift));  // so that a face does not hide itself

  constexpr double preference = 2;  // for the usual direction
  Eigen::Vector3d best = usual;
  double most_seen = preference * seen_share(spots, tracer, to_unit, above, usual);
  const Eigen::Vector3d sideways = up.cross(usual).normalized();
  for (const double raised : {0.0, 0.5, -0.8})  // radians; the last one looks from below
    for (int eighth = 0; eighth < 8; ++eighth) {
      const Eigen::Vector3d direction = Eigen::AngleAxisd(eighth * std::numbers::pi / 4, up.normalized()) *
                                        (Eigen::AngleAxisd(-raised, sideways) * usual);
      const double seen = seen_share(spots, tracer, to_unit, above, direction);
      if (seen > most_seen) {
        most_seen = seen;
        best = direction;
      }
    }
  return best;
}

}  // namespace meshgraft::render
