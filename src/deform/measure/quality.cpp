#include <meshgraft/deform/quality.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "core/percentile.h"
#include "deform/setup/free_vertices.h"
#include "mesh/edge_table.h"
#include "quality_of_surface.h"
#include "quality_terms.h"
#include "width.h"

namespace meshgraft {

namespace {

using Eigen::Vector3d;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

using TriangleEdges = std::array<Vector3d, 3>;  // [k] is the edge from corner k to corner k+1, scaled

TriangleEdges triangle_edges(const QualityPose& pose, const std::array<Index, 3>& v) {
  return {pose.between(v[0], v[1]), pose.between(v[1], v[2]), pose.between(v[2], v[0])};
}

// A face in one state of the surface.
struct FaceShape {
  Vector3d normal{0, 0, 0};  // unit length, or zero where the face has no direction
  double area = 0;           // scaled
  double cone = 0;           // signed volume of the cone from the box centre to the face
  bool finite = false;
};

// Returns a shape without its normal.
FaceShape measure_size(const QualityPose& pose, const std::array<Index, 3>& v) {
  FaceShape shape;
  const double norm = pose.between(v[0], v[1]).cross(pose.between(v[1], v[2])).norm();
  const double cone = pose.centred(v[0]).dot(pose.centred(v[1]).cross(pose.centred(v[2]))) / 6;
  if (!std::isfinite(norm) || !std::isfinite(cone)) return shape;
  shape.finite = true;
  shape.area = norm / 2;
  shape.cone = cone;
  return shape;
}

FaceShape measure_shape(const QualityPose& pose, const std::array<Index, 3>& v, const TriangleEdges& edges) {
  FaceShape shape = measure_size(pose, v);
  if (!shape.finite) return shape;
  const Vector3d twice_area = edges[0].cross(edges[1]);
  const double norm = twice_area.norm();
  const double longest = std::max({edges[0].norm(), edges[1].norm(), edges[2].norm()});
  if (norm > longest * pose.resolution) shape.normal = twice_area / norm;
  return shape;
}

// Returns the in-plane singular values σ1 ≥ σ2 of the affine map between two states of a triangle. Both
// triangles are laid into the plane along the same edge, which makes the map upper triangular. Its conformal
// part Q and anticonformal part R give σ = ‖Q‖ ± ‖R‖ without cancellation.
std::array<double, 2> singular_values(const TriangleEdges& rest, const TriangleEdges& edited) {
  std::size_t k = 0;  // a long edge of the edited face has a direction unless the face is a point
  for (std::size_t c = 1; c < 3; ++c) {
    if (edited[c].squaredNorm() > edited[k].squaredNorm()) k = c;
  }
  const auto flat = [k](const TriangleEdges& edges) {
    const Vector3d& u = edges[k];
    const Vector3d& w = edges[(k + 1) % 3];
    const double base = u.norm();
    if (base == 0) return std::array{0.0, 0.0, 0.0};
    return std::array{base, u.dot(w) / base, u.cross(w).norm() / base};
  };
  const auto [l, x, y] = flat(rest);
  const auto [l_edited, x_edited, y_edited] = flat(edited);
  const double a = l_edited / l;
  const double b = (x_edited - a * x) / y;
  const double d = y_edited / y;
  const double q = std::hypot((a + d) / 2, b / 2);
  const double r = std::hypot((a - d) / 2, b / 2);
  return {q + r, std::abs(q - r)};
}

void add_face(WholeSums& sums, const FaceShape& rest, const FaceShape& edited) {
  if (!rest.finite || !edited.finite) {
    sums.finite = false;
    return;
  }
  sums.rest_area += rest.area;
  sums.edited_area += edited.area;
  sums.rest_cone += rest.cone;
  sums.edited_cone += edited.cone;
}

// Returns whether each vertex has another position in the edited state.
Flags flag_moved(const Points& rest, const Points& edited, const Context& context) {
  Flags moved(rest.rows(), 0);
  parallel_blocks(
      moved.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          const auto row = static_cast<Eigen::Index>(v);
          moved[v] = rest(row, 0) != edited(row, 0) || rest(row, 1) != edited(row, 1) ||
                     rest(row, 2) != edited(row, 2);
        }
      },
      context, 4096);
  return moved;
}

// The part of the surface whose faces and edges are measured one by one: the faces that share a vertex with a
// free face. Vertices and faces keep their order, and an edge of a free face has all its faces.
struct NearFaces {
  Points rest, edited;
  Triangles triangles;
  Flags is_free;  // per vertex
};

// Returns the vertices of the flagged faces as flags.
Flags flag_corners(const Triangles& triangles, const Flags& faces, Eigen::Index vertex_count) {
  Flags corners(vertex_count, 0);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!faces[f]) continue;
    for (const Index v : triangles.row(static_cast<Eigen::Index>(f))) corners[v] = 1;
  }
  return corners;
}

// Returns which faces share a vertex with a free face.
Flags flag_near(const Triangles& triangles, const Flags& is_free, const Context& context) {
  const Flags corners_of_free =
      flag_corners(triangles, flag_faces(triangles, is_free, context), std::ssize(is_free));
  return flag_faces(triangles, corners_of_free, context);
}

NearFaces near_faces(const EditedMesh& mesh, const Flags& is_free, const Flags& is_near) {
  const Triangles& triangles = mesh.triangles;
  const Eigen::Index vertex_count = mesh.rest.rows();
  const Flags used = flag_corners(triangles, is_near, vertex_count);
  NearFaces near;
  const Eigen::Index near_vertices = std::count(used.begin(), used.end(), char{1});
  near.rest.resize(near_vertices, 3);
  near.edited.resize(near_vertices, 3);
  near.is_free.resize(near_vertices);
  std::vector<Index> number(vertex_count, -1);
  Index next = 0;
  for (Eigen::Index v = 0; v < vertex_count; ++v) {
    if (!used[v]) continue;
    near.rest.row(next) = mesh.rest.row(v);
    near.edited.row(next) = mesh.edited.row(v);
    near.is_free[next] = is_free[v];
    number[v] = next++;
  }
  near.triangles.resize(std::count(is_near.begin(), is_near.end(), char{1}), 3);
  Eigen::Index row = 0;
  for (std::size_t f = 0; f < is_near.size(); ++f) {
    if (!is_near[f]) continue;
    for (int c = 0; c < 3; ++c) near.triangles(row, c) = number[triangles(static_cast<Eigen::Index>(f), c)];
    ++row;
  }
  return near;
}

struct FaceMeasure {
  Vector3d rest_normal{0, 0, 0},
      edited_normal{0, 0, 0};             // unit length, or zero where the face has no direction
  double rest_area = 0, edited_area = 0;  // scaled
  bool finite = false;
  bool free = false;  // has a free vertex
};

// Returns the measures of all faces, and in `sigmas` two singular values for each, NaN where it has none.
std::vector<FaceMeasure> measure_faces(const QualityPose& rest, const QualityPose& edited,
                                       const QualitySurface& surface, std::vector<double>& sigmas,
                                       const Context& context) {
  std::vector<FaceMeasure> measures(surface.triangles.rows());
  sigmas.resize(2 * measures.size());
  parallel_blocks(
      measures.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
          const auto row = surface.triangles.row(static_cast<Eigen::Index>(f));
          const std::array<Index, 3> v{row[0], row[1], row[2]};
          const TriangleEdges rest_edges = triangle_edges(rest, v), edited_edges = triangle_edges(edited, v);
          const FaceShape at_rest = measure_shape(rest, v, rest_edges);
          const FaceShape when_edited = measure_shape(edited, v, edited_edges);
          const bool finite = at_rest.finite && when_edited.finite;
          const bool free = surface.is_free[v[0]] || surface.is_free[v[1]] || surface.is_free[v[2]];
          measures[f] = {at_rest.normal, when_edited.normal, at_rest.area, when_edited.area, finite, free};
          const bool counts = finite && free && !at_rest.normal.isZero(0) &&
                              (!surface.measures_face || surface.measures_face(static_cast<Index>(f)));
          const auto sigma = counts ? singular_values(rest_edges, edited_edges) : std::array{unknown, unknown};
          std::copy(sigma.begin(), sigma.end(), sigmas.begin() + static_cast<std::ptrdiff_t>(2 * f));
        }
      },
      context);
  return measures;
}

// Returns the signed angle (radians) by which the surface turns across an edge. If the faces are not
// consistently oriented, the sign of one normal is reversed.
double turn_across(const Vector3d& along, const Vector3d& first, const Vector3d& second, bool oriented) {
  const double sign = oriented ? 1.0 : -1.0;
  return std::atan2(sign * along.normalized().dot(first.cross(second)), sign * first.dot(second));
}

struct EdgeMeasure {
  double stretch = unknown;   // (edited − rest) / rest length
  double turn_deg = unknown;  // change of the dihedral angle, 0 … 180
  bool free = false;          // has a free end
  bool boundary = false;      // between held and free surface
};

double turn_change_deg(const TriangleEdge& edge, const FaceMeasure& first, const FaceMeasure& second,
                       const Vector3d& rest_along, const Vector3d& edited_along) {
  const auto directed = [](const FaceMeasure& f) {
    return !f.rest_normal.isZero(0) && !f.edited_normal.isZero(0);
  };
  if (!directed(first) || !directed(second)) return unknown;
  const bool alike = edge.is_balanced();
  const double before = turn_across(rest_along, first.rest_normal, second.rest_normal, alike);
  const double after = turn_across(edited_along, first.edited_normal, second.edited_normal, alike);
  const double change = std::abs(after - before);
  return std::min(change, 2 * std::numbers::pi - change) * 180 / std::numbers::pi;
}

std::vector<EdgeMeasure> measure_edges(const QualityPose& rest, const QualityPose& edited,
                                       const std::vector<TriangleEdge>& edges,
                                       const std::vector<FaceMeasure>& faces, const Flags& is_free,
                                       const Context& context) {
  std::vector<EdgeMeasure> measures(edges.size());
  const auto measure_edge = [&](const TriangleEdge& edge) {
    EdgeMeasure measure;
    const auto [tail, head] = edge.ends;
    measure.free = is_free[tail] || is_free[head];
    measure.boundary = is_free[tail] != is_free[head];
    const FaceMeasure& first = faces[edge.faces[0]];
    if (edge.joins_two_faces()) measure.boundary |= first.free != faces[edge.faces[1]].free;
    if (!measure.free && !measure.boundary) return measure;

    const Vector3d rest_along = rest.between(tail, head);
    const Vector3d edited_along = edited.between(tail, head);
    const double rest_length = rest_along.norm();
    const double stretch = edited_along.norm() / rest_length - 1;
    if (rest_length > rest.resolution && std::isfinite(stretch)) measure.stretch = stretch;
    if (edge.joins_two_faces()) {
      measure.turn_deg = turn_change_deg(edge, first, faces[edge.faces[1]], rest_along, edited_along);
    }
    return measure;
  };
  parallel_blocks(
      edges.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) measures[e] = measure_edge(edges[e]);
      },
      context);
  return measures;
}

void add_faces(const std::vector<FaceMeasure>& faces, const QualitySurface& surface, QualityTerms& terms) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const FaceMeasure& face = faces[f];
    if (surface.measures_face && !surface.measures_face(static_cast<Index>(f))) continue;
    if (!face.finite || !face.free) continue;
    terms.rest_free_area += face.rest_area;
    terms.edited_free_area += face.edited_area;
  }
}

void add_edges(const std::vector<TriangleEdge>& edges, const std::vector<EdgeMeasure>& measures,
               const QualitySurface& surface, QualityTerms& terms) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const EdgeMeasure& edge = measures[e];
    if (surface.measures_edge && !surface.measures_edge(edges[e].ends[0], edges[e].ends[1])) continue;
    if (edge.free && !std::isnan(edge.stretch)) {
      terms.stretch_squares += edge.stretch * edge.stretch;
      ++terms.stretched;
    }
    if (std::isnan(edge.turn_deg)) continue;
    if (edge.free) terms.turns.push_back(edge.turn_deg);
    if (edge.boundary) terms.rim_jump_max_deg = std::max(terms.rim_jump_max_deg, edge.turn_deg);
  }
}

// The volume is the sum of the cones over all faces, for any common apex (divergence theorem).
void report_volume(const WholeSums& whole, double resolution, Quality& quality) {
  const bool encloses_volume = std::abs(whole.rest_cone) > resolution * whole.rest_area;
  if (encloses_volume) quality.volume_ratio = whole.edited_cone / whole.rest_cone;
}

struct PercentileField {
  double percent;
  double Quality::* field;
};
constexpr std::array<PercentileField, 7> sigma_fields{{{0, &Quality::sigma_min},
                                                       {1, &Quality::sigma_p1},
                                                       {5, &Quality::sigma_p5},
                                                       {50, &Quality::sigma_p50},
                                                       {95, &Quality::sigma_p95},
                                                       {99, &Quality::sigma_p99},
                                                       {100, &Quality::sigma_max}}};
constexpr std::array<PercentileField, 3> turn_fields{
    {{50, &Quality::dihedral_p50_deg}, {99, &Quality::dihedral_p99_deg}, {100, &Quality::dihedral_max_deg}}};

// Returns whether a face's normal points against the faces around its corners. Areas at rest are the weights
// in both states, so that neither tessellation nor the growth of a face decides.
bool looks_away(Index face, Vector3d FaceMeasure::* normal, const std::vector<FaceMeasure>& faces,
                const Triangles& triangles, const IndexLists& faces_around) {
  Vector3d mean = Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    for (const Index neighbour : faces_around[triangles(face, c)]) {
      if (neighbour != face) mean += faces[neighbour].rest_area * faces[neighbour].*normal;
    }
  }
  return (faces[face].*normal).dot(mean) < 0;
}

std::int64_t count_flipped(const std::vector<FaceMeasure>& faces, const QualitySurface& surface,
                           const Context& context) {
  Flags flipped(faces.size(), 0);
  const auto looks = [&](Index face, Vector3d FaceMeasure::* normal) {
    return looks_away(face, normal, faces, surface.triangles, surface.faces_around);
  };
  parallel_blocks(
      faces.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
          const auto face = static_cast<Index>(f);
          if (!faces[f].free || !faces[f].finite || faces[f].rest_normal.isZero(0)) continue;
          if (surface.measures_face && !surface.measures_face(face)) continue;
          flipped[f] = looks(face, &FaceMeasure::edited_normal) && !looks(face, &FaceMeasure::rest_normal);
        }
      },
      context);
  return std::count(flipped.begin(), flipped.end(), char{1});
}

}  // namespace

QualityBox quality_box(const Points& positions, const IndexLists& faces_around, const Context& context) {
  constexpr std::size_t block_size = 16384;
  const auto count = static_cast<std::size_t>(faces_around.size());
  std::vector<QualityBox> blocks((count + block_size - 1) / block_size);
  const auto box_of_block = [&](std::size_t block) {
    QualityBox& box = blocks[block];
    const std::size_t end = std::min(count, (block + 1) * block_size);
    for (auto v = static_cast<Index>(block * block_size); v < static_cast<Index>(end); ++v) {
      if (faces_around[v].empty() || !positions.row(v).allFinite()) continue;
      box.min = box.min.cwiseMin(positions.row(v).transpose());
      box.max = box.max.cwiseMax(positions.row(v).transpose());
    }
  };
  parallel_blocks(
      blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) box_of_block(block);
      },
      context, 1);
  QualityBox box;
  for (const QualityBox& part : blocks) box.include(part);
  return box;
}

std::pair<QualityPose, QualityPose> quality_poses(const Points& rest, const QualityBox& rest_box,
                                                  const Points& edited, const QualityBox& edited_box) {
  const double extent = rest_box.extent();
  const double scale = extent > 0 && std::isfinite(extent) ? std::ldexp(1.0, -std::ilogb(extent)) : 1.0;
  const auto pose = [&](const Points& positions, const QualityBox& box) {
    const double largest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
    return QualityPose{positions, box.min / 2 + box.max / 2, scale,
                       4 * std::numeric_limits<double>::epsilon() * largest * scale};
  };
  return {pose(rest, rest_box), pose(edited, edited_box)};
}

// Sums up blocks of a fixed size, so that the result does not depend on the number of threads. A face without a
// moved vertex has the same shape in both states, unless they are measured from different centres.
WholeSums sum_over_faces(const QualityPose& rest, const QualityPose& edited, const Triangles& triangles,
                         const Context& context) {
  constexpr std::size_t block_size = 4096;
  const auto count = static_cast<std::size_t>(triangles.rows());
  std::vector<WholeSums> blocks((count + block_size - 1) / block_size);
  const bool same_centre = rest.centre == edited.centre;
  const Flags moved = flag_moved(rest.positions, edited.positions, context);
  const auto add = [&](WholeSums& sums, std::size_t f) {
    const auto row = triangles.row(static_cast<Eigen::Index>(f));
    const std::array<Index, 3> v{row[0], row[1], row[2]};
    const FaceShape shape = measure_size(rest, v);
    const bool same = same_centre && !moved[v[0]] && !moved[v[1]] && !moved[v[2]];
    add_face(sums, shape, same ? shape : measure_size(edited, v));
  };
  parallel_blocks(
      blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
          for (std::size_t f = b * block_size; f < std::min(count, (b + 1) * block_size); ++f)
            add(blocks[b], f);
      },
      context, 1);
  WholeSums sums;
  for (const WholeSums& block : blocks) sums.add(block);
  return sums;
}

bool is_closed_and_oriented(const Triangles& triangles, const IndexLists& faces_around, Index vertex_count,
                            const Context& context) {
  std::atomic<bool> balanced = true, has_edges = false;
  parallel_blocks(
      static_cast<std::size_t>(vertex_count),
      [&](std::size_t begin, std::size_t end) {
        std::vector<Index> ahead, behind;  // the larger ends of edges from and to a vertex
        for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end) && balanced; ++v) {
          ahead.clear();
          behind.clear();
          for (const Index f : faces_around[v]) {
            const int c = triangles(f, 0) == v ? 0 : triangles(f, 1) == v ? 1 : 2;
            const Index next = triangles(f, (c + 1) % 3), previous = triangles(f, (c + 2) % 3);
            if (next == v || previous == v || next == previous) continue;  // has no edges
            if (next > v) ahead.push_back(next);
            if (previous > v) behind.push_back(previous);
          }
          std::sort(ahead.begin(), ahead.end());
          std::sort(behind.begin(), behind.end());
          if (ahead != behind) balanced = false;
          if (!ahead.empty()) has_edges = true;
        }
      },
      context, 4096);
  return balanced && has_edges;
}

QualityTerms measure_terms(const QualityPose& rest, const QualityPose& edited, const QualitySurface& surface,
                           const Context& context) {
  QualityTerms terms;
  const std::vector<FaceMeasure> faces = measure_faces(rest, edited, surface, terms.sigmas, context);
  std::erase_if(terms.sigmas, [](double sigma) { return std::isnan(sigma); });
  add_faces(faces, surface, terms);
  constexpr Index chunk_size = 1 << 18;  // the edges of so many vertices are kept at a time
  const Index vertex_count = surface.faces_around.size();
  for (Index first = 0, last = 0; first < vertex_count; first = last) {
    last = first + std::min(chunk_size, vertex_count - first);
    const auto edges = list_edges_from(first, last, surface.triangles, surface.faces_around, context);
    add_edges(edges, measure_edges(rest, edited, edges, faces, surface.is_free, context), surface, terms);
  }
  terms.flipped_faces = count_flipped(faces, surface, context);
  return terms;
}

Quality quality_of_terms(const WholeSums& whole, bool is_closed, double rest_resolution, QualityTerms& terms,
                         const QualityLists& lists) {
  Quality quality;
  if (whole.rest_area > 0) quality.area_ratio = whole.edited_area / whole.rest_area;
  if (terms.rest_free_area > 0) quality.area_ratio_free = terms.edited_free_area / terms.rest_free_area;
  if (whole.finite && is_closed) report_volume(whole, rest_resolution, quality);
  if (terms.stretched > 0)
    quality.edge_rms = std::sqrt(terms.stretch_squares / static_cast<double>(terms.stretched));
  quality.rim_jump_max_deg = terms.rim_jump_max_deg;
  quality.flipped_faces = static_cast<Index>(terms.flipped_faces);
  const auto fill = [&](std::vector<double>& values, std::span<const PercentileField> fields) {
    std::vector<double> percents;
    for (const PercentileField& field : fields) percents.push_back(field.percent);
    const std::vector<double> found = lists.percentiles(values, percents);
    for (std::size_t k = 0; k < fields.size(); ++k) quality.*fields[k].field = found[k];
  };
  if (lists.has_sigmas) fill(terms.sigmas, sigma_fields);
  if (lists.has_turns) fill(terms.turns, turn_fields);
  return quality;
}

namespace {

// Measures the faces that share a vertex with a free face, and their edges. Others add nothing. Leaving them
// out pays where they are many.
QualityTerms measure_near(const EditedMesh& mesh, const QualityPose& rest, const QualityPose& edited,
                          const IndexLists& faces_around, const Flags& is_free, const Context& context) {
  const Flags is_near = flag_near(mesh.triangles, is_free, context);
  if (2 * std::ranges::count(is_near, char{1}) >= std::ssize(is_near))
    return measure_terms(rest, edited, {mesh.triangles, faces_around, is_free}, context);
  const NearFaces near = near_faces(mesh, is_free, is_near);
  const IndexLists near_around =
      vertex_triangles(static_cast<Index>(near.rest.rows()), near.triangles, context);
  return measure_terms(rest.of_part(near.rest), edited.of_part(near.edited),
                       {near.triangles, near_around, near.is_free}, context);
}

// Measures a surface with the triangles around its vertices known.
Quality measure(const EditedMesh& mesh, const IndexLists& faces_around, std::optional<bool> is_closed,
                const QualityOptions& options, const Context& context) {
  const Points& rest = mesh.rest;
  const Points& edited = mesh.edited;
  const Triangles& triangles = mesh.triangles;
  const Flags is_free = flag_free(rest.rows(), mesh.free_vertices);
  const auto [rest_whole, edited_whole] = quality_poses(rest, quality_box(rest, faces_around, context), edited,
                                                        quality_box(edited, faces_around, context));
  const WholeSums whole = sum_over_faces(rest_whole, edited_whole, triangles, context);
  if (!is_closed)
    is_closed = whole.finite && is_closed_and_oriented(triangles, faces_around, faces_around.size(), context);

  QualityTerms terms = measure_near(mesh, rest_whole, edited_whole, faces_around, is_free, context);
  Quality quality = quality_of_terms(whole, *is_closed, rest_whole.resolution, terms,
                                     {!terms.sigmas.empty(), !terms.turns.empty(), percentiles});
  Flags has_width = is_free;  // an unused vertex has none, and must not affect the units
  for (Index v = 0; v < faces_around.size(); ++v)
    if (faces_around[v].empty()) has_width[v] = 0;
  const Narrowest narrowest = find_narrowest(mesh, has_width, context);
  quality.width_min = narrowest.width;
  quality.narrowest_vertex = narrowest.vertex;
  if (options.self_intersections) quality.new_self_intersections = count_new_self_intersections(mesh, context);
  return quality;
}

}  // namespace

Quality measure_quality(const EditedMesh& mesh, const QualityOptions& options, const Context& context) {
  require_same_vertices(mesh.rest, mesh.edited);
  const auto count = static_cast<Index>(mesh.rest.rows());
  return measure(mesh, vertex_triangles(count, mesh.triangles, context), std::nullopt, options, context);
}

Quality measure_quality(const EditedMesh& mesh, const SimpleSurface& surface, const QualityOptions& options,
                        const Context& context) {
  require_same_vertices(mesh.rest, mesh.edited);
  return measure(mesh, surface.faces_around, surface.is_closed(), options, context);
}

}  // namespace meshgraft
