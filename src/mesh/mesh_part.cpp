#include "mesh_part.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/sparse_checks.h"
#include "interpolate_attribute.h"
#include "traced_faces.h"

namespace meshgraft {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// Per element of a result: where its values come from.
struct ElementSource {
  bool replaced = false;  // from the replacement, otherwise from the whole
  Index index = -1;
};

class PartReplacement {
 public:
  PartReplacement(const Mesh& whole, const MeshPart& part, const Replacement& replacement,
                  const Context& context)
      : whole_(whole), part_(part), replacement_(replacement), context_(context) {}

  ReplaceResult run() {
    number_vertices();
    add_faces();
    for (const Attribute& attribute : replacement_.mesh.attributes) add(attribute);
    result_.mesh.source = replacement_.mesh.source;
    return std::move(result_);
  }

 private:
  void number_vertices() {
    const Index whole_count = whole_.vertex_count(), count = replacement_.mesh.vertex_count();
    constexpr Index outside = -1, removed = -2;
    std::vector<Index> kept_as(whole_count, outside);  // the replacement's vertex that a vertex of the whole is
    for (const Index v : part_.vertices) kept_as[v] = removed;
    for (Index v = 0; v < count; ++v)
      if (replacement_.vertex[v] >= 0) kept_as[replacement_.vertex[v]] = v;

    result_.whole.new_index.assign(whole_count, -1);
    result_.replacement.new_index.assign(count, -1);
    const auto append = [&](const ElementSource& source) {
      vertices_.push_back(source);
      return static_cast<Index>(vertices_.size()) - 1;
    };
    vertices_.reserve(static_cast<std::size_t>(whole_count) + count);
    SparseChecks check(context_);
    for (Index v = 0; v < whole_count; ++v) {
      check();
      if (kept_as[v] == removed) continue;
      const bool is_outside = kept_as[v] == outside;
      const Index now = append(is_outside ? ElementSource{false, v} : ElementSource{true, kept_as[v]});
      result_.whole.new_index[v] = now;
      if (!is_outside) result_.replacement.new_index[kept_as[v]] = now;
    }
    for (Index v = 0; v < count; ++v)
      if (replacement_.vertex[v] < 0) result_.replacement.new_index[v] = append({true, v});

    Points& positions = result_.mesh.positions;
    positions.resize(static_cast<Eigen::Index>(vertices_.size()), 3);
    for (std::size_t k = 0; k < vertices_.size(); ++k) {
      const auto& [replaced, v] = vertices_[k];
      positions.row(static_cast<Eigen::Index>(k)) = (replaced ? replacement_.mesh : whole_).positions.row(v);
    }
  }

  void add_faces() {
    const Mesh& mesh = replacement_.mesh;
    result_.mesh.faces.reserve(whole_.face_count() + mesh.face_count(),
                               whole_.faces.corner_count() + mesh.faces.corner_count());
    auto in_part = part_.faces.begin();
    Index next = 0;  // of the replacement
    SparseChecks check(context_);
    for (Index f = 0; f < whole_.face_count(); ++f) {
      check();
      if (in_part == part_.faces.end() || *in_part != f) {
        add_face(whole_, {false, f}, result_.whole);
        continue;
      }
      for (; next < mesh.face_count() && replacement_.face[next] == f; ++next)
        add_face(mesh, {true, next}, result_.replacement);
      ++in_part;
    }
  }

  // An index out of range stays out of range.
  void add_face(const Mesh& mesh, const ElementSource& source, const IndexMap& vertex) {
    face_.assign(mesh.faces[source.index].begin(), mesh.faces[source.index].end());
    for (Index& v : face_) v = v >= 0 && v < mesh.vertex_count() ? vertex.new_index[v] : -1;
    result_.mesh.faces.push_back(face_);
    faces_.push_back(source);
  }

  void add(const Attribute& attribute) {
    Attribute joined = attribute;
    joined.values.clear();
    const Attribute* of_whole = whole_.find_attribute(attribute.domain, attribute.name);
    if (of_whole != nullptr && of_whole->components != attribute.components) of_whole = nullptr;
    SparseChecks check(context_);
    const auto append = [&](bool replaced, Index first, Index count) {
      check();
      const Attribute* from = replaced ? &attribute : of_whole;
      const auto width = static_cast<std::ptrdiff_t>(attribute.components);
      if (from == nullptr) {
        joined.values.insert(joined.values.end(), count * width, missing);
      } else {
        const auto begin = from->values.begin() + first * width;
        joined.values.insert(joined.values.end(), begin, begin + count * width);
      }
    };
    switch (attribute.domain) {
      case Domain::vertex:
        for (const auto& [replaced, v] : vertices_) append(replaced, v, 1);
        break;
      case Domain::face:
        for (const auto& [replaced, f] : faces_) append(replaced, f, 1);
        break;
      case Domain::corner:
        for (const auto& [replaced, f] : faces_) {
          const Faces& faces = (replaced ? replacement_.mesh : whole_).faces;
          append(replaced, faces.first_corner(f), static_cast<Index>(faces[f].size()));
        }
        break;
    }
    result_.mesh.attributes.push_back(std::move(joined));
  }

  const Mesh& whole_;
  const MeshPart& part_;
  const Replacement& replacement_;
  const Context& context_;
  std::vector<ElementSource> vertices_, faces_;  // of the result
  std::vector<Index> face_;
  ReplaceResult result_;
};

}  // namespace

MeshPart part_of(const Mesh& whole, std::vector<Index> faces) {
  MeshPart part;
  part.faces = std::move(faces);
  Index corner_count = 0;
  for (const Index f : part.faces) {
    part.vertices.insert(part.vertices.end(), whole.faces[f].begin(), whole.faces[f].end());
    corner_count += static_cast<Index>(whole.faces[f].size());
  }
  std::sort(part.vertices.begin(), part.vertices.end());
  part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());

  Mesh& mesh = part.mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(part.vertices.size()), 3);
  std::vector<EdgePoint> vertex_origin, face_origin, corner_origin;
  for (std::size_t k = 0; k < part.vertices.size(); ++k) {
    mesh.positions.row(static_cast<Eigen::Index>(k)) = whole.positions.row(part.vertices[k]);
    vertex_origin.push_back(same(part.vertices[k]));
  }
  mesh.faces.reserve(static_cast<Index>(part.faces.size()), corner_count);
  std::vector<Index> face;
  for (const Index f : part.faces) {
    face.clear();
    for (Index c = whole.faces.first_corner(f); c < whole.faces.first_corner(f + 1); ++c) {
      const auto found = std::lower_bound(part.vertices.begin(), part.vertices.end(), whole.faces.corners()[c]);
      face.push_back(static_cast<Index>(found - part.vertices.begin()));
      corner_origin.push_back(same(c));
    }
    mesh.faces.push_back(face);
    face_origin.push_back(same(f));
  }
  for (const Attribute& attribute : whole.attributes)
    mesh.attributes.push_back(
        interpolate_attribute(attribute, attribute.domain == Domain::vertex ? vertex_origin
                                         : attribute.domain == Domain::face ? face_origin
                                                                            : corner_origin));
  mesh.source = whole.source;
  return part;
}

ReplaceResult replace_part(const Mesh& whole, const MeshPart& part, const Replacement& replacement,
                           const Context& context) {
  return PartReplacement(whole, part, replacement, context).run();
}

}  // namespace meshgraft
