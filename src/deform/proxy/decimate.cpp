#include "decimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include <meshoptimizer.h>
#include <Eigen/Geometry>

#include "core/parallel.h"
#include "core/scattered_bits.h"

namespace meshgraft {

namespace {

/// The most triangles of a chunk. Surfaces with more than twice as many are thinned in chunks.
constexpr std::size_t triangles_of_chunk = std::size_t{1} << 16;
constexpr double least_share = 0.125;  // of a chunk's triangles that is left; its border stays as it is

/// Returns the k-th of some equal pieces of a list.
template <class T>
std::span<T> chunk_of(std::span<T> list, std::size_t k, std::size_t chunks) {
  const std::size_t begin = list.size() * k / chunks, end = list.size() * (k + 1) / chunks;
  return list.subspan(begin, end - begin);
}

/// Returns a pseudo-random value in −1 … 1 for a number.
double drawn(std::uint64_t number) {
  return static_cast<double>(scattered_bits(number + splitmix_step) >> 11) * 0x1p-52 - 1;
}

double surface_area(const Points& points, const Triangles& triangles) {
  double sum = 0;
  for (const auto& t : triangles.rowwise()) {
    const Eigen::RowVector3d u = points.row(t[1]) - points.row(t[0]), v = points.row(t[2]) - points.row(t[0]);
    sum += u.cross(v).norm() / 2;
  }
  return sum;
}

/// Returns positions for the simplifier, in the unit box. The simplifier keeps vertices where the surface is
/// curved and none where it is flat, but a deformation bends both. So each vertex is moved along its normal
/// by a random fraction of the wanted edge length. The surface is then equally rough everywhere, and the
/// remaining vertices are evenly spread. The median and 99th percentile of the edges are 1.15 and 2.2 times
/// the even length, instead of 0.8 and 24.
std::vector<float> roughened(const Points& points, const Points& normals, double edge_length) {
  constexpr double roughness = 0.15;
  const Eigen::RowVector3d low = points.colwise().minCoeff(), high = points.colwise().maxCoeff();
  const double extent = (high - low).maxCoeff(), scale = extent > 0 ? 1 / extent : 1;
  std::vector<float> coordinates;
  coordinates.reserve(points.size());
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const double lift = roughness * edge_length * drawn(static_cast<std::uint64_t>(v));
    const Eigen::RowVector3d lifted = (points.row(v) - low + lift * normals.row(v)) * scale;
    for (const double x : lifted) coordinates.push_back(static_cast<float>(x));
  }
  return coordinates;
}

/// Adds for each locked vertex a face that has only this vertex as its corners. The simplifier moves no vertex
/// of such a face.
template <class IsLocked>
void add_locks(std::vector<unsigned>& corners, std::size_t vertex_count, const IsLocked& is_locked) {
  for (std::size_t v = 0; v < vertex_count; ++v)
    if (is_locked(v)) corners.insert(corners.end(), 3, static_cast<unsigned>(v));
}

/// Collapses edges until about `target` of the triangles with these corners are left, and returns their
/// corners.
std::vector<unsigned> simplified(const std::vector<unsigned>& corners, const std::vector<float>& coordinates,
                                 std::size_t target, unsigned options) {
  constexpr float any_error = std::numeric_limits<float>::max();
  std::vector<unsigned> left(corners.size());
  left.resize(meshopt_simplify(left.data(), corners.data(), corners.size(), coordinates.data(),
                               coordinates.size() / 3, 3 * sizeof(float), std::min(3 * target, corners.size()),
                               any_error, options, nullptr));
  return left;
}

/// Some triangles of a surface, with numbers of their own for the vertices that they use.
struct Part {
  std::vector<unsigned> vertices;  ///< of the surface, ascending
  std::vector<unsigned> corners;
  std::vector<float> coordinates;
};

constexpr unsigned no_number = std::numeric_limits<unsigned>::max();

/// Returns the part of a surface with these triangles. `number` is scratch space for each vertex, filled with
/// `no_number` before and after.
Part part_of(std::span<const unsigned> corners, std::span<const unsigned> triangles,
             const std::vector<float>& coordinates, std::vector<unsigned>& number) {
  Part part;
  for (const unsigned t : triangles)
    for (const unsigned v : corners.subspan(3 * std::size_t{t}, 3)) {
      if (number[v] == no_number) part.vertices.push_back(v);
      number[v] = 0;
    }
  std::sort(part.vertices.begin(), part.vertices.end());
  part.coordinates.reserve(3 * part.vertices.size());
  for (std::size_t k = 0; k < part.vertices.size(); ++k) {
    const unsigned v = part.vertices[k];
    number[v] = static_cast<unsigned>(k);
    part.coordinates.insert(part.coordinates.end(),
                            {coordinates[3 * std::size_t{v}], coordinates[3 * std::size_t{v} + 1],
                             coordinates[3 * std::size_t{v} + 2]});
  }
  part.corners.reserve(3 * triangles.size());
  for (const unsigned t : triangles)
    for (const unsigned v : corners.subspan(3 * std::size_t{t}, 3)) part.corners.push_back(number[v]);
  for (const unsigned v : part.vertices) number[v] = no_number;
  return part;
}

/// Returns the triangles in an order in which equal pieces of the list are compact pieces of the surface.
std::vector<unsigned> in_chunks(const std::vector<unsigned>& corners, const std::vector<float>& coordinates,
                                int levels, const Context& context) {
  std::vector<unsigned> order(corners.size() / 3);
  std::iota(order.begin(), order.end(), 0U);
  const auto centre = [&](unsigned t, int axis) {  // times three
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
      sum += coordinates[3 * std::size_t{corners[3 * std::size_t{t} + c]} + static_cast<std::size_t>(axis)];
    return sum;
  };
  const auto split = [&](std::span<unsigned> piece) {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    for (const unsigned t : piece)
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], centre(t, axis));
        high[axis] = std::max(high[axis], centre(t, axis));
      }
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    std::nth_element(piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(piece.size() / 2), piece.end(),
                     [&](unsigned a, unsigned b) { return centre(a, longest) < centre(b, longest); });
  };
  for (int level = 0; level < levels; ++level) {
    const std::size_t pieces = std::size_t{1} << level;
    parallel_blocks(
        pieces,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) split(chunk_of<unsigned>(order, k, pieces));
        },
        context, 1);
  }
  return order;
}

/// Collapses edges within compact pieces of the surface, in parallel, until about a `share` of the triangles is
/// left. The pieces and their borders, which stay, do not depend on the number of threads.
std::vector<unsigned> thinned(const std::vector<unsigned>& corners, const std::vector<float>& coordinates,
                              std::span<const std::uint8_t> locked, double share, const Context& context) {
  int levels = 0;
  while ((corners.size() / 3) >> levels > triangles_of_chunk) ++levels;
  const std::vector<unsigned> order = in_chunks(corners, coordinates, levels, context);
  const std::size_t chunks = std::size_t{1} << levels;
  std::vector<std::vector<unsigned>> left(chunks);
  share_out(
      static_cast<int>(chunks),
      [&](int begin, int end) {
        std::vector<unsigned> number(coordinates.size() / 3, no_number);
        for (int k = begin; k < end; ++k) {
          context.throw_if_stopped();
          const auto triangles = chunk_of<const unsigned>(order, static_cast<std::size_t>(k), chunks);
          Part part = part_of(corners, triangles, coordinates, number);
          add_locks(part.corners, part.vertices.size(),
                    [&](std::size_t v) { return locked[part.vertices[v]]; });
          const std::size_t locks = part.corners.size() / 3 - triangles.size();
          const auto target = locks + static_cast<std::size_t>(share * static_cast<double>(triangles.size()));
          for (const unsigned v :
               simplified(part.corners, part.coordinates, target, meshopt_SimplifyLockBorder))
            left[k].push_back(part.vertices[v]);
        }
      },
      context);
  std::vector<unsigned> all;
  for (const std::vector<unsigned>& of_chunk : left)
    for (std::size_t c = 0; c < of_chunk.size(); c += 3)
      if (of_chunk[c] != of_chunk[c + 1])  // no lock
        all.insert(all.end(), of_chunk.begin() + static_cast<std::ptrdiff_t>(c),
                   of_chunk.begin() + static_cast<std::ptrdiff_t>(c) + 3);
  return all;
}

/// Removes pairs of faces back to back. The simplifier makes them where it closes a pocket of the surface.
void drop_closed_pockets(std::vector<Index>& corners) {
  const std::size_t count = corners.size() / 3;
  std::vector<std::array<Index, 3>> sorted(count);
  for (std::size_t t = 0; t < count; ++t) {
    std::copy_n(corners.begin() + static_cast<std::ptrdiff_t>(3 * t), 3, sorted[t].begin());
    std::sort(sorted[t].begin(), sorted[t].end());
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return std::pair(sorted[a], a) < std::pair(sorted[b], b); });
  Flags dropped(count, 0);
  for (std::size_t i = 0; i + 1 < count; ++i)
    if (sorted[order[i]] == sorted[order[i + 1]]) dropped[order[i]] = dropped[order[i + 1]] = 1;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < count; ++t) {
    if (dropped[t]) continue;
    std::copy_n(corners.begin() + static_cast<std::ptrdiff_t>(3 * t), 3,
                corners.begin() + static_cast<std::ptrdiff_t>(3 * kept++));
  }
  corners.resize(3 * kept);
}

Decimated gather(std::span<const unsigned> corners, Eigen::Index vertex_count) {
  std::vector<Index> kept;
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const unsigned a = corners[t], b = corners[t + 1], c = corners[t + 2];
    if (a == b || b == c || c == a) continue;
    for (const unsigned v : {a, b, c}) kept.push_back(static_cast<Index>(v));
  }
  drop_closed_pockets(kept);
  std::vector<Index> coarse_index(vertex_count, -1);
  for (const Index v : kept) coarse_index[v] = 0;
  Decimated result;
  for (std::size_t v = 0; v < coarse_index.size(); ++v) {
    if (coarse_index[v] < 0) continue;
    coarse_index[v] = static_cast<Index>(result.vertices.size());
    result.vertices.push_back(static_cast<Index>(v));
  }
  result.triangles.resize(static_cast<Eigen::Index>(kept.size() / 3), 3);
  std::transform(kept.begin(), kept.end(), result.triangles.data(), [&](Index v) { return coarse_index[v]; });
  return result;
}

}  // namespace

Decimated decimate(const Points& points, const Triangles& triangles, const Points& normals,
                   std::span<const std::uint8_t> locked, Index target, const Context& context) {
  // A closed surface has twice as many faces as vertices, one with boundary has fewer.
  const std::size_t faces = 2 * static_cast<std::size_t>(target);
  const std::vector<float> coordinates =
      roughened(points, normals, std::sqrt(surface_area(points, triangles) / target));
  std::vector<unsigned> corners(triangles.data(), triangles.data() + triangles.size());
  constexpr std::size_t spare = 4;  // × the faces that are wanted: the last collapses choose among all of these
  while (corners.size() / 3 > std::max(2 * triangles_of_chunk, 2 * spare * faces)) {
    const double share = static_cast<double>(spare * faces) / static_cast<double>(corners.size() / 3);
    const std::size_t before = corners.size();
    corners = thinned(corners, coordinates, locked, std::max(share, least_share), context);
    if (corners.size() > before - before / 4) break;  // the topology forbids collapses
  }
  std::vector<unsigned> number(static_cast<std::size_t>(points.rows()), no_number);
  std::vector<unsigned> all(corners.size() / 3);
  std::iota(all.begin(), all.end(), 0U);
  // The simplifier owns its data, so that a cancelled caller can leave it behind.
  struct Simplification {
    Part part;
    std::vector<unsigned> left;
  };
  const auto s = std::make_shared<Simplification>(part_of(corners, all, coordinates, number));
  add_locks(s->part.corners, s->part.vertices.size(),
            [&](std::size_t v) { return locked[s->part.vertices[v]]; });
  run_abandonable([s, faces] { s->left = simplified(s->part.corners, s->part.coordinates, faces, 0); },
                  context);
  for (unsigned& v : s->left) v = s->part.vertices[v];
  return gather(s->left, points.rows());
}

}  // namespace meshgraft
