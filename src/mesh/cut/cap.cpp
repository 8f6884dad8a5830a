#include "cap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "core/facts.h"
#include "mesh/facts.h"
#include "mesh/fill_attributes.h"
#include "region_triangulation.h"

namespace meshgraft {

namespace {

using Triangle = std::array<Index, 3>;

// Returns whether a half of the cut, the one above (1) or below (-1), carries the pins.
bool carries_pins(int side, const CutOptions& options) {
  return (options.pin_side == PinSide::above) == (side > 0);
}

// The outlines of one half in the plane. They run counter-clockwise around the inside, seen from above.
struct HalfOutlines {
  std::vector<Point2> points;  // per vertex of the cut mesh; only those on the cut are used
  std::vector<CapRegion> regions;
};

double rounding_of(const Points& positions) {
  return 64 * std::numeric_limits<double>::epsilon() * positions.cwiseAbs().maxCoeff();
}

// Returns the side of each vertex on the cut: 1 above, -1 below.
std::vector<std::int8_t> sides_of_vertices(const CutResult& cut) {
  std::vector<std::int8_t> side(cut.mesh.vertex_count(), 0);
  for (Index f = 0; f < cut.mesh.face_count(); ++f)
    for (const Index v : cut.mesh.faces[f]) side[v] = cut.face_side[f];
  return side;
}

HalfOutlines outlines_of(const CutResult& cut, int side, const PlaneFrame& frame, const Context& context) {
  const std::vector<std::int8_t> side_of = sides_of_vertices(cut);
  const double rounding = rounding_of(cut.mesh.positions) + rounding_of(frame.origin.transpose());
  HalfOutlines half;
  half.points.resize(cut.mesh.vertex_count());
  std::vector<Outline> outlines;
  for (const std::vector<Index>& loop : cut.loops) {
    if (side_of[loop.front()] != side) continue;
    for (const Index v : loop) {
      const Eigen::Vector3d position = cut.mesh.positions.row(v);
      if (std::abs((position - frame.origin).dot(frame.normal)) > rounding)
        throw Error(facts::mesh::CapOutlineOpen{});
      half.points[v] = frame.coordinates(position);
    }
    // A loop has its half of the surface on the left, so its cap below the plane lies on the right.
    outlines.push_back(side > 0 ? loop : Outline(loop.rbegin(), loop.rend()));
  }
  half.regions = nest_outlines(half.points, outlines);
  if (half.regions.empty() && !outlines.empty()) throw Error(facts::mesh::CapInsideOut{});
  for (const CapRegion& region : half.regions)
    if (const auto at = find_crossing(half.points, region, context)) {
      const Eigen::Vector3d place = frame.point(*at);
      throw Error(facts::mesh::CapOutlineCrosses{.x = place.x(), .y = place.y(), .z = place.z()});
    }
  return half;
}

// Returns the triangles of the half that takes the holes, with the depth behind the plane as z.
std::vector<DeepTriangle> triangles_behind(const CutResult& cut, int side, const PlaneFrame& frame) {
  std::vector<DeepTriangle> triangles;
  const auto deep = [&](Index v) {
    const Eigen::Vector3d position = cut.mesh.positions.row(v);
    const auto [x, y] = frame.coordinates(position);
    return Eigen::Vector3d(x, y, side * (position - frame.origin).dot(frame.normal));
  };
  const Triangulation triangulation = triangulate(cut.mesh);
  for (Index t = 0; t < triangulation.triangles.rows(); ++t) {
    if (cut.face_side[triangulation.face[t]] != side) continue;
    const auto row = triangulation.triangles.row(t);
    triangles.push_back({deep(row[0]), deep(row[1]), deep(row[2])});
  }
  return triangles;
}

using PinSize = std::optional<double> CutOptions::*;

// The options that give sizes of pins, and their names.
constexpr std::array<std::pair<PinSize, const char*>, 3> pin_size_options{
    {{&CutOptions::pin_diameter, "pin_diameter"},
     {&CutOptions::pin_length, "pin_length"},
     {&CutOptions::pin_clearance, "pin_clearance"}}};

bool has_pins(const std::vector<PinFit>& fits) {
  return std::any_of(fits.begin(), fits.end(), [](const PinFit& fit) { return !fit.centres.empty(); });
}

// Returns the given size without which pins fit, or else the first that is given. Throws Error(input) if none
// is.
template <class FitsOf>
Location size_at_fault(const CutOptions& options, const FitsOf& fits_of) {
  std::optional<Location> first;
  for (const auto& [size, name] : pin_size_options) {
    if (!(options.*size)) continue;
    if (!first) first = Location(name);
    CutOptions without = options;
    (without.*size).reset();
    if (has_pins(fits_of(without))) return Location(name);
  }
  if (!first) throw Error(facts::mesh::NoRoomForPins{});
  return *first;
}

void add_notes(const std::vector<PinFit>& fits, std::vector<Note>& notes) {
  Index empty = 0, left_out = 0, shortened = 0;
  double shortest = std::numeric_limits<double>::infinity();
  for (const PinFit& fit : fits) {
    if (fit.centres.empty()) {
      ++empty;
      continue;
    }
    left_out += fit.left_out;
    if (!fit.shortened) continue;
    shortened += static_cast<Index>(fit.centres.size());
    shortest = std::min(shortest, fit.length);
  }
  if (shortened > 0) notes.emplace_back(facts::mesh::PinsShortened{.count = shortened, .length = shortest});
  if (left_out > 0) notes.emplace_back(facts::mesh::PinsLeftOut{.count = left_out});
  if (empty > 0) notes.emplace_back(facts::mesh::CapsWithoutPins{.count = empty});
}

using Edge = std::pair<Index, Index>;  // the smaller vertex first

Edge edge_of(Index a, Index b) { return std::minmax(a, b); }

// Returns the edges of one half's surface.
std::set<Edge> edges_of_half(const CutResult& cut, int side) {
  std::set<Edge> edges;
  Flags on_cut(cut.mesh.vertex_count(), 0);
  for (const auto& loop : cut.loops)
    for (const Index v : loop) on_cut[v] = 1;
  for (Index f = 0; f < cut.mesh.face_count(); ++f) {
    if (cut.face_side[f] != side) continue;
    const auto face = cut.mesh.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      if (on_cut[a] && on_cut[b]) edges.insert(edge_of(a, b));
    }
  }
  return edges;
}

// Returns the edges inside a cap that the surface has, too: it has faces in the plane there.
std::set<Edge> shared_diagonals(const std::vector<Triangle>& cap, const std::set<Edge>& surface) {
  std::set<Edge> seen, shared;
  for (const Triangle& triangle : cap)
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge edge = edge_of(triangle[k], triangle[(k + 1) % 3]);
      if (!seen.insert(edge).second && surface.contains(edge)) shared.insert(edge);
    }
  return shared;
}

// Divides the triangles at an edge by a vertex on it.
void split_edge(std::vector<Triangle>& triangles, const Edge& edge, Index middle) {
  const std::size_t count = triangles.size();
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (edge_of(triangles[t][k], triangles[t][next]) != edge) continue;
      Triangle other = triangles[t];
      other[k] = middle;
      triangles[t][next] = middle;
      triangles.push_back(other);
      break;
    }
}

// The new faces and vertices of the caps of one half.
class HalfCaps {
 public:
  HalfCaps(const CutResult& cut, int side, const PlaneFrame& frame, const std::vector<PinFit>& fits,
           const CutOptions& options, const Context& context)
      : side_(side),
        frame_(frame),
        has_pins_(carries_pins(side, options)),
        first_new_(cut.mesh.vertex_count()),
        half_(outlines_of(cut, side, frame, context)) {
    const std::set<Edge> surface = edges_of_half(cut, side);
    for (std::size_t k = 0; k < half_.regions.size(); ++k) {
      add_cap(half_.regions[k], k < fits.size() ? fits[k] : PinFit{}, surface, context);
      vertex_sample_.resize(vertices_.size(), half_.regions[k].outer.front());
      face_sample_.resize(faces_.size(), half_.regions[k].outer.front());
    }
  }

  int side() const { return side_; }
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }
  /// Corners from the number of the cut's vertices on are new ones.
  const std::vector<Triangle>& faces() const { return faces_; }
  /// Per new vertex, and per face: a vertex on the outline of its cap.
  const std::vector<Index>& vertex_sample() const { return vertex_sample_; }
  const std::vector<Index>& face_sample() const { return face_sample_; }

 private:
  // An edge of the surface may not be one of the cap, too: it would have four faces.
  void add_cap(CapRegion region, const PinFit& fit, const std::set<Edge>& surface, const Context& context) {
    std::vector<Outline> mouths;
    for (const Point2& centre : fit.centres) {
      mouths.push_back(add_ring(centre, mouth_radius(fit), 0));
      region.inner.emplace_back(mouths.back().rbegin(), mouths.back().rend());
    }
    std::vector<Triangle> triangles = triangulate_region(half_.points, region, context);
    for (const Edge& edge : shared_diagonals(triangles, surface)) {
      const Point2 a = half_.points[edge.first], b = half_.points[edge.second];
      split_edge(triangles, edge, add_vertex({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2}, 0));
    }
    for (const Triangle& triangle : triangles) add_face(triangle);
    for (std::size_t k = 0; k < mouths.size(); ++k) add_body(mouths[k], fit.centres[k], fit);
  }

  double mouth_radius(const PinFit& fit) const { return has_pins_ ? fit.diameter / 2 : fit.hole_radius(); }

  Index add_vertex(const Point2& at, double height) {
    vertices_.push_back(frame_.point(at, height));
    half_.points.push_back(at);
    return first_new_ + static_cast<Index>(vertices_.size()) - 1;
  }

  // Adds a ring of vertices, counter-clockwise seen from above.
  Outline add_ring(const Point2& centre, double radius, double height) {
    Outline ring;
    for (Index k = 0; k < pin_sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / pin_sides;
      ring.push_back(
          add_vertex({centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle)}, height));
    }
    return ring;
  }

  // Adds a face that is counter-clockwise seen from above: as it is below the plane, turned over above.
  void add_face(const Triangle& face) {
    if (side_ < 0)
      faces_.push_back(face);
    else
      faces_.push_back({face[0], face[2], face[1]});
  }

  void add_side(const Outline& near, const Outline& far) {
    for (std::size_t k = 0; k < near.size(); ++k) {
      const std::size_t next = (k + 1) % near.size();
      add_face({near[k], near[next], far[next]});
      add_face({near[k], far[next], far[k]});
    }
  }

  // Adds the pin, or the hole, behind its mouth. Pins stand out from a cap and holes go into it, so both lie on
  // the side that takes the holes.
  void add_body(const Outline& mouth, const Point2& centre, const PinFit& fit) {
    const double away = has_pins_ ? -side_ : side_;
    Outline last = mouth;
    double depth = fit.length + fit.clearance;
    if (has_pins_) {
      depth = fit.length;
      const double chamfer = pin_chamfer_rel * fit.diameter;
      Outline shoulder = add_ring(centre, fit.diameter / 2, away * (depth - chamfer));
      add_side(last, shoulder);
      last = add_ring(centre, fit.diameter / 2 - chamfer, away * depth);
      add_side(shoulder, last);
    } else {
      last = add_ring(centre, fit.hole_radius(), away * depth);
      add_side(mouth, last);
    }
    const Index middle = add_vertex(centre, away * depth);
    for (std::size_t k = 0; k < last.size(); ++k) add_face({last[k], last[(k + 1) % last.size()], middle});
  }

  const int side_;
  const PlaneFrame& frame_;
  const bool has_pins_;
  const Index first_new_;
  HalfOutlines half_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Triangle> faces_;
  std::vector<Index> vertex_sample_, face_sample_;
};

// Returns a corner of the surface at each vertex on the cut, before the caps; -1 elsewhere.
std::vector<Index> corners_at_cut(const CutResult& cut) {
  Flags on_cut(cut.mesh.vertex_count(), 0);
  for (const auto& loop : cut.loops)
    for (const Index v : loop) on_cut[v] = 1;
  std::vector<Index> corner(cut.mesh.vertex_count(), -1);
  const std::vector<Index>& corners = cut.mesh.faces.corners();
  for (Index c = 0; c < static_cast<Index>(corners.size()); ++c)
    if (on_cut[corners[c]] && corner[corners[c]] < 0) corner[corners[c]] = c;
  return corner;
}

Index face_of_corner(const Faces& faces, Index corner) {
  const auto& offsets = faces.offsets();
  return static_cast<Index>(std::upper_bound(offsets.begin(), offsets.end(), corner) - offsets.begin()) - 1;
}

// Gives the elements of caps values: those of the surface at the outline, and values between inside.
class CapAttributes {
 public:
  explicit CapAttributes(const CutResult& cut)
      : old_vertices_(cut.mesh.vertex_count()),
        old_faces_(cut.mesh.face_count()),
        corner_at_(corners_at_cut(cut)) {}

  /// The samples have a vertex on the outline for each new vertex, and for each new face.
  void extend(Mesh& mesh, const std::vector<Index>& vertex_sample, const std::vector<Index>& face_sample,
              const Context& context) const {
    for (Attribute& attribute : mesh.attributes) extend(attribute, mesh, vertex_sample, face_sample);
    Flags is_new(mesh.face_count(), 0);
    std::fill(is_new.begin() + old_faces_, is_new.end(), 1);
    interpolate_in_fills(mesh, is_new, context);
    set_normals(mesh);
  }

 private:
  void extend(Attribute& attribute, const Mesh& mesh, const std::vector<Index>& vertex_sample,
              const std::vector<Index>& face_sample) const {
    const auto append = [&](Index element) {
      for (int k = 0; k < attribute.components; ++k)
        attribute.values.push_back(
            attribute.values[static_cast<std::size_t>(element) * attribute.components + k]);
    };
    switch (attribute.domain) {
      case Domain::vertex:
        for (const Index v : vertex_sample) append(v);
        break;
      case Domain::face:
        for (const Index v : face_sample) append(face_of_corner(mesh.faces, corner_at_[v]));
        break;
      case Domain::corner:
        for (std::size_t f = 0; f < face_sample.size(); ++f)
          for (const Index v : mesh.faces[old_faces_ + static_cast<Index>(f)])
            append(corner_at_[v < old_vertices_ ? v : face_sample[f]]);
        break;
    }
  }

  // Caps are flat: corners of new faces take the face's normal, new vertices the mean one.
  void set_normals(Mesh& mesh) const {
    std::optional<Points> normals;
    for (Attribute& attribute : mesh.attributes) {
      if (attribute.name != "normal" || attribute.components != 3 || attribute.domain == Domain::face) continue;
      const auto write = [&](std::size_t element, const Eigen::Vector3d& normal) {
        for (std::size_t k = 0; k < 3; ++k)
          attribute.values[3 * element + k] = normal[static_cast<Eigen::Index>(k)];
      };
      if (attribute.domain == Domain::vertex) {
        if (!normals) normals = vertex_normals(mesh);
        for (Index v = old_vertices_; v < mesh.vertex_count(); ++v) write(v, normals->row(v));
        continue;
      }
      for (Index f = old_faces_; f < mesh.face_count(); ++f) {
        const auto face = mesh.faces[f];
        const Eigen::Vector3d a = mesh.positions.row(face[0]), b = mesh.positions.row(face[1]),
                              c = mesh.positions.row(face[2]);
        for (Index k = 0; k < 3; ++k)
          write(mesh.faces.first_corner(f) + k, (b - a).cross(c - a).stableNormalized());
      }
    }
  }

  const Index old_vertices_, old_faces_;
  const std::vector<Index> corner_at_;
};

// The new normals that a cut keeps for grafts belong to open loops.
void remove_cut_normals(Mesh& mesh) {
  std::erase_if(mesh.attributes, [](const Attribute& attribute) {
    return attribute.domain == Domain::vertex && attribute.name == cut_normal_name;
  });
}

}  // namespace

void check_pins(const CutOptions& options) {
  constexpr Index most = 32;
  if (options.pin_count && (*options.pin_count < 1 || *options.pin_count > most))
    throw Error(
        facts::core::OutOfRange{.value = static_cast<double>(*options.pin_count), .low = 1, .high = most},
        "pin_count");
  for (const auto& [size, name] :
       {std::pair{options.pin_diameter, "pin_diameter"}, std::pair{options.pin_length, "pin_length"}})
    if (size && !(*size > 0 && std::isfinite(*size)))
      throw Error(facts::core::NotPositive{.value = *size}, name);
  if (options.pin_clearance && !(*options.pin_clearance >= 0 && std::isfinite(*options.pin_clearance)))
    throw Error(facts::core::NegativeOrNotFinite{.value = *options.pin_clearance}, "pin_clearance");
}

std::vector<PinFit> fit_pins(const CutResult& both, const PlaneFrame& frame, const CutOptions& options,
                             const Context& context) {
  const int hole_side = options.pin_side == PinSide::above ? -1 : 1;
  const HalfOutlines half = outlines_of(both, hole_side, frame, context);
  const std::vector<DeepTriangle> behind = triangles_behind(both, hole_side, frame);
  const auto fits_of = [&](const CutOptions& sizes) {
    std::vector<PinFit> fits;
    for (const CapRegion& region : half.regions)
      fits.push_back(fit_pins(half.points, region, behind, sizes, context));
    return fits;
  };
  std::vector<PinFit> fits = fits_of(options);
  if (has_pins(fits)) return fits;
  throw Error(facts::mesh::PinsDoNotFit{.diameter = options.pin_diameter.value_or(0),
                                        .length = options.pin_length.value_or(0)},
              size_at_fault(options, fits_of));
}

void close_cut(CutResult& cut, const PlaneFrame& frame, const std::vector<PinFit>& fits,
               const CutOptions& options, const Context& context) {
  remove_cut_normals(cut.mesh);
  const CapAttributes attributes(cut);
  const std::array halves{HalfCaps(cut, 1, frame, fits, options, context),
                          HalfCaps(cut, -1, frame, fits, options, context)};
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Index> vertex_sample, face_sample;
  Mesh& mesh = cut.mesh;
  for (const HalfCaps& half : halves) {
    const auto shift = static_cast<Index>(vertices.size());
    vertices.insert(vertices.end(), half.vertices().begin(), half.vertices().end());
    vertex_sample.insert(vertex_sample.end(), half.vertex_sample().begin(), half.vertex_sample().end());
    face_sample.insert(face_sample.end(), half.face_sample().begin(), half.face_sample().end());
    for (Triangle face : half.faces()) {
      for (Index& v : face) v += v >= mesh.vertex_count() ? shift : 0;
      mesh.faces.push_back(face);
      cut.face_parent.push_back(-1);
      cut.face_side.push_back(static_cast<std::int8_t>(half.side()));
    }
  }
  const Index old_count = mesh.vertex_count();
  mesh.positions.conservativeResize(old_count + static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k)
    mesh.positions.row(old_count + static_cast<Eigen::Index>(k)) = vertices[k].transpose();
  cut.origin.resize(mesh.vertex_count());
  attributes.extend(mesh, vertex_sample, face_sample, context);
  for (const PinFit& fit : fits)
    for (const Point2& centre : fit.centres)
      cut.pins.push_back({frame.point(centre), fit.diameter, fit.length, fit.clearance});
  add_notes(fits, cut.notes);
}

}  // namespace meshgraft
