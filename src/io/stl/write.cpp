#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "document.h"
#include "io/check_interval.h"
#include "io/facts.h"
#include "io/number_text.h"
#include "io/unwritten.h"
#include "point_index.h"
#include "stl.h"

namespace meshgraft::io {

namespace {

float to_float(double value, Index vertex) {
  const ParsedNumber rounded = narrow(value, ScalarType::float32);
  if (rounded.fault != NumberFault::none)
    throw Error(facts::io::ValueDoesNotFit{.property = "vertex", .type = "float", .value = value},
                Location::place("vertex " + std::to_string(vertex)));
  return static_cast<float>(rounded.value);
}

FloatPoint to_floats(const Points& positions, Index vertex) {
  return {to_float(positions(vertex, 0), vertex), to_float(positions(vertex, 1), vertex),
          to_float(positions(vertex, 2), vertex)};
}

/// Returns the unit normal of a triangle. Returns zero, STL's value for "none", if it has no area.
FloatPoint facet_normal(const std::array<Eigen::Vector3d, 3>& corners) {
  // Scaling keeps huge and tiny triangles within the range of doubles.
  Eigen::Vector3d a = corners[1] - corners[0];
  Eigen::Vector3d b = corners[2] - corners[0];
  const double size = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  if (!(size > 0) || !std::isfinite(size)) return {0, 0, 0};
  const Eigen::Vector3d normal = (a / size).cross(b / size);
  const double length = normal.norm();
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(normal[0] / length), static_cast<float>(normal[1] / length),
          static_cast<float>(normal[2] / length)};
}

Eigen::Vector3d to_vector(const FloatPoint& point) { return Eigen::Vector3d(point[0], point[1], point[2]); }

/// Returns whether two coordinates are equal. 0 and -0 are equal, so corners that differ only in that are one
/// vertex and keep their spelling.
template <class Real>
bool same_place(Real a, Real b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

const Attribute* attribute_bytes(const Mesh& mesh) {
  const Attribute* attribute = mesh.find_attribute(Domain::face, stl_attribute);
  const bool fits = attribute != nullptr && attribute->components == 1 &&
                    attribute->values.size() == static_cast<std::size_t>(mesh.face_count());
  return fits ? attribute : nullptr;
}

std::uint16_t to_attribute(double value) {
  const ParsedNumber whole = narrow(value, ScalarType::uint16);
  return whole.fault == NumberFault::none ? static_cast<std::uint16_t>(whole.value) : std::uint16_t{0};
}

/// Copies a binary file with new corners where they moved. The facets of these corners get new normals.
std::string patch_binary(const StlDocument& document, const Mesh& mesh, const Context& context) {
  std::string out = document.content;
  const Attribute* attribute = attribute_bytes(mesh);
  char* facet = out.data() + stl_layout::first_facet;
  for (Index f = 0; f < mesh.face_count(); ++f, facet += stl_layout::facet) {
    if (f % elements_per_check == 0) context.throw_if_stopped();
    std::array<Eigen::Vector3d, 3> corners;
    bool moved = false;
    for (std::size_t c = 0; c < 3; ++c) {
      char* const at = facet + (c + 1) * stl_layout::corner;
      const FloatPoint old = load_stl_point(at);
      FloatPoint point = to_floats(mesh.positions, mesh.faces[f][c]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (same_place(old[axis], point[axis]))
          point[axis] = old[axis];
        else
          moved = true;
      }
      if (moved) store_stl_point(at, point);
      corners[c] = to_vector(point);
    }
    if (moved) store_stl_point(facet, facet_normal(corners));
    if (attribute == nullptr) continue;
    const std::uint16_t value = to_attribute(attribute->values[f]);
    if (value != load_stl_attribute(facet + stl_layout::attribute))
      store_stl_attribute(facet + stl_layout::attribute, value);
  }
  return out;
}

/// Copies the text of an ascii file in the same way.
std::string patch_ascii(const StlDocument& document, const Mesh& mesh, const Context& context) {
  const std::string name = "source";  // the document was read once: it cannot fail to parse
  StlTextCursor cursor(document.content, name);
  WordReplacer out(document.content);
  const auto put = [&](std::string_view word, double value, ScalarType type) {
    std::string text;
    append_number(text, value, type);
    out.replace(word, text);
  };
  StlFacetText facet;
  for (Index f = 0; cursor.next_facet(facet); ++f) {
    if (f % elements_per_check == 0) context.throw_if_stopped();
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) corners[c] = mesh.positions.row(mesh.faces[f][c]);
    std::array<bool, 9> moved;
    for (std::size_t k = 0; k < 9; ++k) moved[k] = !same_place(facet.values[3 + k], corners[k / 3][k % 3]);
    if (std::ranges::none_of(moved, [](bool value) { return value; })) continue;
    const FloatPoint normal = facet_normal(corners);
    for (std::size_t axis = 0; axis < 3; ++axis) put(facet.words[axis], normal[axis], ScalarType::float32);
    for (std::size_t k = 0; k < 9; ++k)
      if (moved[k]) put(facet.words[3 + k], corners[k / 3][k % 3], ScalarType::float64);
  }
  return out.finish();
}

/// Composes a binary file for a mesh without an STL file behind it.
class StlComposer {
 public:
  StlComposer(const Mesh& mesh, const Context& context)
      : mesh_(mesh), context_(context), attribute_(attribute_bytes(mesh)), parts_(triangulate(mesh)) {}

  Written compose() {
    write_header();
    for (Index t = 0; t < parts_.triangles.rows(); ++t) {
      if (t % elements_per_check == 0) context_.throw_if_stopped();
      write_facet(t);
    }
    Written written{std::move(out_)};
    note_losses(written.notes);
    return written;
  }

 private:
  /// Writes the header. The header of a single binary file behind the mesh is kept, because some programs put
  /// a colour there. A header that begins with "solid" is not kept, because many readers would take the file
  /// for an ascii one.
  void write_header() {
    constexpr std::string_view own = "binary STL, written by meshgraft";
    const auto count = static_cast<std::uint32_t>(parts_.triangles.rows());
    out_.assign(stl_layout::first_facet + count * stl_layout::facet, '\0');
    const std::string_view kept = header_behind();
    std::ranges::copy(kept.empty() ? own : kept, out_.begin());
    for (std::size_t k = 0; k < 4; ++k) out_[stl_layout::header + k] = static_cast<char>(count >> (8 * k));
  }

  std::string_view header_behind() const {
    const std::vector<const FileDocument*> documents = documents_of(mesh_);
    const auto* document = documents.size() == 1 ? dynamic_cast<const StlDocument*>(documents[0]) : nullptr;
    if (document == nullptr || document->ascii) return {};
    const std::string_view header = std::string_view(document->content).substr(0, stl_layout::header);
    return is_stl_keyword(header.substr(0, 5), "solid") ? std::string_view{} : header;
  }

  void write_facet(Index t) {
    char* const facet = out_.data() + stl_layout::first_facet + static_cast<std::size_t>(t) * stl_layout::facet;
    std::array<Eigen::Vector3d, 3> corners;
    for (int c = 0; c < 3; ++c) {
      const Index vertex = parts_.triangles(t, c);
      const FloatPoint point = to_floats(mesh_.positions, vertex);
      store_stl_point(facet + static_cast<std::size_t>(c + 1) * stl_layout::corner, point);
      corners[c] = to_vector(point);
      rounded_ = rounded_ || corners[c] != Eigen::Vector3d(mesh_.positions.row(vertex));
    }
    store_stl_point(facet, facet_normal(corners));
    if (attribute_ == nullptr) return;
    const auto face = static_cast<std::size_t>(parts_.face[t]);
    store_stl_attribute(facet + stl_layout::attribute, to_attribute(attribute_->values[face]));
  }

  void note_losses(std::vector<Note>& notes) const {
    notes = left_out_notes(mesh_);
    note_unwritten(mesh_, "STL", {attribute_}, notes);
    Flags used(mesh_.vertex_count(), 0);
    for (const Index vertex : parts_.triangles.reshaped()) used[vertex] = 1;
    const auto isolated = std::ranges::count(used, 0);
    Flags covered(mesh_.face_count(), 0);
    for (const Index face : parts_.face) covered[face] = 1;
    const auto dropped = std::ranges::count(covered, 0);
    Index polygons = 0;
    for (Index f = 0; f < mesh_.face_count(); ++f) polygons += mesh_.faces[f].size() > 3 ? 1 : 0;
    if (const Index joined = joined_vertices(used); joined > 0)
      notes.push_back(facts::io::VerticesJoined{.format = "STL", .count = joined});
    if (polygons > 0) notes.push_back(facts::io::PolygonsSplit{.format = "STL", .count = polygons});
    if (isolated > 0) notes.push_back(facts::io::VerticesLeftOut{.format = "STL", .count = isolated});
    if (dropped > 0) notes.push_back(facts::io::FacesLeftOut{.format = "STL", .count = dropped});
    if (!note_coarse_coordinates(mesh_, "STL", notes) && rounded_)
      notes.push_back(facts::io::CoordinatesRounded{.format = "STL"});
  }

  /// Returns the number of used vertices that have the coordinates of an earlier one in the file.
  Index joined_vertices(const Flags& used) const {
    std::vector<FloatPoint> points;
    for (Index v = 0; v < mesh_.vertex_count(); ++v)
      if (used[v]) points.push_back(to_floats(mesh_.positions, v));
    if (points.empty()) return 0;
    MemoryBudget unlimited(std::numeric_limits<std::uint64_t>::max());
    std::vector<Index> numbers(points.size());
    PointIndex<float>(points.size(), unlimited).add(points, numbers.data());
    return static_cast<Index>(points.size()) - 1 - *std::ranges::max_element(numbers);
  }

  const Mesh& mesh_;
  const Context& context_;
  const Attribute* attribute_;
  Triangulation parts_;
  std::string out_;
  bool rounded_ = false;
};

}  // namespace

Written write_stl(const Mesh& mesh, const std::filesystem::path&, const WriteOptions&, const Context& context) {
  const auto* document = dynamic_cast<const StlDocument*>(mesh.source.get());
  const bool unchanged = document != nullptr && document->has_topology_of(mesh);
  if (!unchanged) return StlComposer(mesh, context).compose();
  return {document->ascii ? patch_ascii(*document, mesh, context) : patch_binary(*document, mesh, context)};
}

}  // namespace meshgraft::io
