#include "shared_quality.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "deform/measure/quality_terms.h"

namespace meshgraft::distributed {

namespace {

/// Returns the percentile of the numbers of all ranks, which are not negative, by the nearest rank as
/// `percentile` does. Sorts the own ones.
double shared_percentile(const Communicator& comm, std::vector<double>& values, double percent) {
  if (!std::ranges::is_sorted(values)) std::ranges::sort(values);
  const Number count = comm.sum(static_cast<Number>(values.size()));
  const auto wanted =
      std::clamp<Number>(static_cast<Number>(std::ceil(percent / 100 * static_cast<double>(count))), 1, count);
  // The bits of numbers that are not negative ascend as the numbers do. Bisects for the smallest one with so
  // many numbers up to it.
  std::uint64_t low = 0, high = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    const auto end = std::ranges::upper_bound(values, std::bit_cast<double>(middle));
    if (comm.sum(static_cast<Number>(end - values.begin())) >= wanted)
      high = middle;
    else
      low = middle + 1;
  }
  return std::bit_cast<double>(low);
}

QualityBox shared_box(const Communicator& comm, const Points& positions, const LocalMesh& mesh) {
  QualityBox box = quality_box(positions, mesh.faces_at, {.threads = 1});
  for (int k = 0; k < 3; ++k) {
    box.min[k] = comm.smallest(box.min[k]);
    box.max[k] = comm.largest(box.max[k]);
  }
  return box;
}

/// Returns the triangles that this rank counts.
Triangles counted_triangles(const LocalMesh& mesh) {
  std::vector<Index> counted;
  for (Index t = 0; t < mesh.triangles.rows(); ++t)
    if (mesh.owns_triangle(t)) counted.push_back(t);
  return mesh.triangles(counted, Eigen::all);
}

/// Sums up what is summed up, over all ranks. The lists stay in parts.
void sum_parts(const Communicator& comm, WholeSums& whole, QualityTerms& terms) {
  Eigen::VectorXd sums(7);
  sums << whole.rest_area, whole.edited_area, whole.rest_cone, whole.edited_cone, terms.rest_free_area,
      terms.edited_free_area, terms.stretch_squares;
  sums = comm.sum(sums);
  whole = {sums[0], sums[1], sums[2], sums[3], !comm.any(!whole.finite)};
  terms.rest_free_area = sums[4];
  terms.edited_free_area = sums[5];
  terms.stretch_squares = sums[6];
  terms.stretched = comm.sum(terms.stretched);
  terms.flipped_faces = comm.sum(terms.flipped_faces);
  terms.rim_jump_max_deg = comm.largest(terms.rim_jump_max_deg);
}

}  // namespace

Quality measure_shared_quality(const Communicator& comm, const std::vector<Number>& starts,
                               const std::vector<NumberedTriangle>& triangles, const OwnVertices& own) {
  // A face is counted by the rank of its smallest vertex, an edge likewise. One layer has all faces around the
  // corners of such a face.
  const LocalMesh mesh = make_local_mesh(comm, starts, triangles, 1);
  const Index own_count = mesh.vertices.own();
  const auto complete = [&](const Points& values) {
    Points all(mesh.vertices.size(), 3);
    all.topRows(own_count) = values;
    mesh.vertices.update(all);
    return all;
  };
  const Points rest = complete(own.rest), edited = complete(own.edited);
  Flags is_free = own.is_free;
  is_free.resize(mesh.vertices.size());
  mesh.vertices.update(is_free);

  const Context context{.threads = 1};
  const QualityBox rest_box = shared_box(comm, rest, mesh), edited_box = shared_box(comm, edited, mesh);
  const auto [rest_pose, edited_pose] = quality_poses(rest, rest_box, edited, edited_box);
  WholeSums whole;
  QualityTerms terms;
  bool has_hole = false;
  comm.together([&] {
    whole = sum_over_faces(rest_pose, edited_pose, counted_triangles(mesh), context);
    Number with_faces = 0;
    for (Index v = 0; v < own_count; ++v) with_faces += !mesh.faces_at[v].empty();
    has_hole = with_faces > 0 && !is_closed_and_oriented(mesh.triangles, mesh.faces_at, own_count, context);
    const auto owns_edge = [&](Index a, Index b) {
      return (mesh.vertices.number(a) < mesh.vertices.number(b) ? a : b) < own_count;
    };
    terms = measure_terms(rest_pose, edited_pose,
                          {.triangles = mesh.triangles,
                           .faces_around = mesh.faces_at,
                           .is_free = is_free,
                           .measures_face = [&](Index t) { return mesh.owns_triangle(t); },
                           .measures_edge = owns_edge},
                          context);
  });
  sum_parts(comm, whole, terms);
  const bool is_closed = !comm.any(has_hole);
  return quality_of_terms(whole, is_closed, rest_pose.resolution, terms,
                          {.has_sigmas = comm.any(!terms.sigmas.empty()),
                           .has_turns = comm.any(!terms.turns.empty()),
                           .percentiles = [&](std::vector<double>& values, std::span<const double> percents) {
                             std::vector<double> found;
                             for (const double percent : percents)
                               found.push_back(shared_percentile(comm, values, percent));
                             return found;
                           }});
}

}  // namespace meshgraft::distributed
