#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "document.h"
#include "io/check_interval.h"
#include "io/facts.h"
#include "io/number_text.h"
#include "io/up_axis_comment.h"
#include "materials.h"
#include "mesh/join.h"
#include "obj.h"

namespace meshgraft::io {

namespace {

using Triple = std::array<double, 3>;

/// The new values of the vn lines and the new references of the corners to them.
///
/// A vn line may serve many corners. If they agree, the line takes their new value. If they do not, the line
/// keeps its value if a corner still has it, and takes the first corner's value otherwise.
///
/// The other values become new lines behind the last vn line of the file. Only corners that leave their line
/// get a new index, and so do negative indices that count back over the new lines.
class NormalPlan {
 public:
  NormalPlan(const ObjDocument& document, const Mesh& mesh) : document_(document) {
    const Attribute* normals = mesh.find_attribute(Domain::corner, "normal");
    const std::size_t corners = document.corner_normals.size();
    lines_.assign(document.normals.size() / 3, Line{});
    if (normals == nullptr || normals->components != 3 || normals->values.size() != 3 * corners) return;
    keep_unchanged_lines(normals->values);
    for (std::size_t c = 0; c < corners; ++c) assign_corner(c, normals->values);
  }

  /// Returns the new value of a vn line, or null if the line stays.
  const Triple* new_value(std::size_t line) const {
    return lines_[line].replaced ? &lines_[line].value : nullptr;
  }
  const std::vector<Triple>& added_lines() const { return added_; }

  /// Returns the vn line of a corner.
  Index line_of(std::size_t corner) const {
    const auto moved = moved_corners_.find(corner);
    return moved == moved_corners_.end() ? document_.corner_normals[corner] : moved->second;
  }

 private:
  struct Line {
    bool taken = false;     ///< a corner has decided its value
    bool replaced = false;  ///< `value` replaces the value in the file
    Triple value = {};
  };

  Triple old_value(Index line) const {
    const double* at = document_.normals.data() + 3 * static_cast<std::size_t>(line);
    return {at[0], at[1], at[2]};
  }

  static bool same(const Triple& a, const Triple& b) {
    return same_value(a[0], b[0]) && same_value(a[1], b[1]) && same_value(a[2], b[2]);
  }

  /// Returns whether the corner's normal is missing or equals the file's.
  bool is_unchanged(std::size_t corner, const std::vector<double>& values) const {
    const Triple value = {values[3 * corner], values[3 * corner + 1], values[3 * corner + 2]};
    const bool missing = std::isnan(value[0]) || std::isnan(value[1]) || std::isnan(value[2]);
    return missing || same(value, old_value(document_.corner_normals[corner]));
  }

  void keep_unchanged_lines(const std::vector<double>& values) {
    for (std::size_t c = 0; c < document_.corner_normals.size(); ++c) {
      const Index line = document_.corner_normals[c];
      if (line >= 0 && is_unchanged(c, values)) lines_[line].taken = true;
    }
  }

  void assign_corner(std::size_t corner, const std::vector<double>& values) {
    const Index line_index = document_.corner_normals[corner];
    if (line_index < 0 || is_unchanged(corner, values)) return;
    // Single precision suffices for a direction. Corners that differ by rounding keep sharing a line.
    Triple value;
    for (std::size_t axis = 0; axis < 3; ++axis) value[axis] = static_cast<float>(values[3 * corner + axis]);
    Line& line = lines_[line_index];
    if (!line.taken) {
      line = {true, true, value};
    } else if (!line.replaced || !same(line.value, value)) {
      const auto next = static_cast<Index>(lines_.size() + added_.size());
      const auto [entry, is_new] = added_of_.try_emplace({line_index, value}, next);
      if (is_new) added_.push_back(value);
      moved_corners_[corner] = entry->second;
    }
  }

  const ObjDocument& document_;
  std::vector<Line> lines_;
  std::vector<Triple> added_;
  std::map<std::pair<Index, Triple>, Index> added_of_;
  std::unordered_map<std::size_t, Index> moved_corners_;
};

/// Copies the file's text, with new numbers in the v and vn lines whose values differ.
class ObjPatcher {
 public:
  ObjPatcher(const ObjDocument& document, const Mesh& mesh, const Context& context)
      : document_(document), mesh_(mesh), context_(context), normals_(document, mesh) {}

  std::string patch() {
    out_.reserve(document_.content.size() + document_.content.size() / 4);
    const std::size_t normal_lines = document_.normals.size() / 3;
    const bool rewrite_faces = !normals_.added_lines().empty();
    std::size_t vertex = 0;
    std::size_t normal = 0;
    ObjCursor cursor(document_.content);
    for (std::size_t line = 1; cursor.next_line(); ++line) {
      if (line % elements_per_check == 0) context_.throw_if_stopped();
      if (cursor.keyword() == "v") {
        patch_values(cursor, mesh_.positions.data() + 3 * vertex++, ScalarType::float64);
      } else if (cursor.keyword() == "vn") {
        if (const Triple* value = normals_.new_value(normal)) {
          patch_values(cursor, value->data(), ScalarType::float32);
        }
        if (++normal == normal_lines) add_normal_lines(cursor);
      } else if (rewrite_faces && is_face_keyword(cursor.keyword())) {
        patch_face(cursor, normal < normal_lines ? normal : normal_lines + normals_.added_lines().size());
      }
    }
    copy_until(document_.content.size());
    return std::move(out_);
  }

 private:
  /// Replaces the first three numbers of the line. A w or a colour after them stays.
  void patch_values(ObjCursor& cursor, const double* values, ScalarType type) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = cursor.next_word();
      const double old = parse_number(word, ScalarType::float64).value;
      if (!same_value(old, values[axis])) replace_word(cursor, number_text(values[axis], type));
    }
  }

  void patch_face(ObjCursor& cursor, std::size_t normal_lines_so_far) {
    for (std::string_view word = cursor.next_word(); !word.empty(); word = cursor.next_word()) {
      ObjCorner corner;
      parse_obj_corner(word, corner);
      if (corner.has_normal) {
        const std::int64_t line = normals_.line_of(corner_);
        const auto count = static_cast<std::int64_t>(normal_lines_so_far);
        const std::int64_t index = corner.normal < 0 && line < count ? line - count : line + 1;
        if (index != corner.normal) {
          replace_word(cursor, std::string(word.substr(0, corner.normal_begin)) + std::to_string(index));
        }
      }
      ++corner_;
    }
  }

  void add_normal_lines(ObjCursor& cursor) {
    if (normals_.added_lines().empty()) return;
    cursor.finish_line();
    copy_until(cursor.offset());
    const std::string line_end = file_line_end();
    if (!out_.empty() && out_.back() != '\n' && out_.back() != '\r') out_ += line_end;
    for (const Triple& value : normals_.added_lines()) {
      out_ += "vn";
      for (const double component : value) out_ += " " + number_text(component, ScalarType::float32);
      out_ += line_end;
    }
  }

  std::string file_line_end() const {
    const std::string_view content = document_.content;
    const std::size_t end = content.find_first_of("\r\n");
    if (end == std::string_view::npos) return "\n";
    return std::string(content.substr(end, content.substr(end, 2) == "\r\n" ? 2 : 1));
  }

  static std::string number_text(double value, ScalarType type) {
    std::string text;
    append_number(text, value, type);
    return text;
  }

  void replace_word(const ObjCursor& cursor, const std::string& text) {
    copy_until(cursor.word_begin());
    out_ += text;
    copied_ = cursor.offset();
  }

  void copy_until(std::size_t end) {
    out_.append(document_.content, copied_, end - copied_);
    copied_ = end;
  }

  const ObjDocument& document_;
  const Mesh& mesh_;
  const Context& context_;
  NormalPlan normals_;
  std::string out_;
  std::size_t copied_ = 0;  // bytes of the document copied so far
  std::size_t corner_ = 0;  // corners of the faces so far
};

/// The vt or vn lines of a new file, and the 1-based line of each corner (0 = none).
class ReferencedLines {
 public:
  ReferencedLines(const Mesh& mesh, const char* attribute_name, int components) {
    const auto size = static_cast<std::size_t>(components);
    const auto corners = static_cast<std::size_t>(mesh.faces.corner_count());
    const Attribute* of_vertex = mesh.find_attribute(Domain::vertex, attribute_name);
    const Attribute* of_corner = mesh.find_attribute(Domain::corner, attribute_name);
    if (of_corner != nullptr && of_corner->components == components &&
        of_corner->values.size() == corners * size) {
      share_lines(*of_corner, corners, size);
    } else if (of_vertex != nullptr && of_vertex->components == components &&
               of_vertex->values.size() == static_cast<std::size_t>(mesh.vertex_count()) * size) {
      // There is one line per vertex, in the order of the vertices.
      values_ = of_vertex->values;
      type_ = of_vertex->type;
      by_vertex_ = true;
    }
  }

  const std::vector<double>& values() const { return values_; }
  ScalarType type() const { return type_; }
  std::int64_t line_of(std::size_t corner, Index vertex) const {
    if (by_vertex_) return std::int64_t{vertex} + 1;
    return corner_lines_.empty() ? 0 : corner_lines_[corner];
  }

 private:
  struct Hash {
    std::size_t operator()(const Triple& value) const {
      std::size_t hash = 0;
      for (const double component : value) hash = hash * 1000003 + std::hash<double>{}(component);
      return hash;
    }
  };

  /// Gives equal values one line, so that a seam lies exactly where the values of a vertex differ.
  void share_lines(const Attribute& attribute, std::size_t corners, std::size_t size) {
    std::unordered_map<Triple, std::int64_t, Hash> lines;
    type_ = attribute.type;
    corner_lines_.assign(corners, 0);
    for (std::size_t c = 0; c < corners; ++c) {
      Triple value = {};
      std::copy_n(attribute.values.begin() + static_cast<std::ptrdiff_t>(c * size), size, value.begin());
      if (std::ranges::any_of(value, [](double component) { return std::isnan(component); })) continue;
      const auto [entry, is_new] = lines.try_emplace(value, static_cast<std::int64_t>(lines.size()) + 1);
      if (is_new)
        values_.insert(values_.end(), value.begin(), value.begin() + static_cast<std::ptrdiff_t>(size));
      corner_lines_[c] = entry->second;
    }
  }

  std::vector<double> values_;
  std::vector<std::int64_t> corner_lines_;
  ScalarType type_ = ScalarType::float64;
  bool by_vertex_ = false;
};

/// Composes a file for a mesh without an OBJ file behind it.
class ObjComposer {
 public:
  ObjComposer(const Mesh& mesh, const std::filesystem::path& path, const Context& context)
      : mesh_(mesh),
        context_(context),
        materials_(materials_for(mesh, path)),
        uvs_(mesh, "uv", 2),
        normals_(mesh, "normal", 3) {}

  Written compose() {
    write_head();
    write_vertices();
    write_lines("vt", uvs_, 2);
    write_lines("vn", normals_, 3);
    write_faces();
    Written written{std::move(out_)};
    if (materials_.library) written.companions.push_back(std::move(*materials_.library));
    written.notes = std::move(materials_.notes);
    for (Note& note : left_out_notes(mesh_)) written.notes.push_back(std::move(note));
    note_attributes(written.notes);
    return written;
  }

 private:
  /// A label of the faces, the keyword of its line, and its value at the previous face.
  struct Label {
    const char* keyword;
    const Attribute* attribute;
    double current;
    std::string none;  ///< text for faces without a label that follow faces with one
  };

  void write_head() {
    if (const std::string_view comment = up_axis_comment(mesh_); !comment.empty())
      out_.append("# ").append(comment) += '\n';
    if (const auto sources = sources_of(mesh_))
      for (const Note& note : sources->notes) out_ += "# " + note.text() + '\n';
    for (const std::string& library : materials_.libraries) out_ += "mtllib " + library + '\n';
  }

  void write_vertices() {
    const Attribute* colour = mesh_.find_attribute(Domain::vertex, "colour");
    const auto count = static_cast<std::size_t>(mesh_.vertex_count());
    if (colour != nullptr && (colour->components < 3 || colour->components > 4 ||
                              colour->values.size() != count * static_cast<std::size_t>(colour->components))) {
      colour = nullptr;
    }
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      check_stop(v);
      out_ += 'v';
      for (int axis = 0; axis < 3; ++axis) write_number(mesh_.positions(v, axis), ScalarType::float64);
      if (colour != nullptr) write_colour(*colour, static_cast<std::size_t>(v));
      out_ += '\n';
    }
  }

  /// Writes a colour, scaled to OBJ's range from 0 to 1.
  void write_colour(const Attribute& colour, std::size_t vertex) {
    const auto components = static_cast<std::size_t>(colour.components);
    const double* rgba = colour.values.data() + vertex * components;
    if (std::isnan(rgba[0]) || std::isnan(rgba[1]) || std::isnan(rgba[2])) return;
    const double largest = colour.type == ScalarType::uint8    ? 255.0
                           : colour.type == ScalarType::uint16 ? 65535.0
                                                               : 1.0;
    const std::size_t written = components == 4 && !std::isnan(rgba[3]) ? 4 : 3;
    for (std::size_t k = 0; k < written; ++k) write_number(rgba[k] / largest, ScalarType::float32);
  }

  void write_lines(const char* keyword, const ReferencedLines& lines, std::size_t components) {
    const std::vector<double>& values = lines.values();
    const ScalarType type = lines.type() == ScalarType::float32 ? ScalarType::float32 : ScalarType::float64;
    for (std::size_t i = 0; i < values.size(); i += components) {
      out_ += keyword;
      for (std::size_t k = 0; k < components; ++k) write_number(values[i + k], type);
      out_ += '\n';
    }
  }

  void write_faces() {
    std::array<Label, 4> labels = {face_label("o", "object"), face_label("g", "group"),
                                   face_label("usemtl", "material"), face_label("s", "smoothing")};
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      check_stop(f);
      for (Label& label : labels) write_label(label, static_cast<std::size_t>(f));
      out_ += 'f';
      const std::span<const Index> corners = mesh_.faces[f];
      for (std::size_t k = 0; k < corners.size(); ++k) {
        write_corner(corners[k], static_cast<std::size_t>(mesh_.faces.first_corner(f)) + k);
      }
      out_ += '\n';
    }
  }

  Label face_label(const char* keyword, const char* attribute_name) const {
    const Attribute* attribute = mesh_.find_attribute(Domain::face, attribute_name);
    const auto faces = static_cast<std::size_t>(mesh_.face_count());
    if (attribute != nullptr && (attribute->components != 1 || attribute->values.size() != faces))
      attribute = nullptr;
    std::string none = attribute_name == std::string_view("smoothing") ? "off" : "default";
    if (attribute != nullptr)
      for (int k = 2; std::ranges::find(attribute->labels, none) != attribute->labels.end(); ++k)
        none = "default_" + std::to_string(k);
    return {keyword, attribute, std::numeric_limits<double>::quiet_NaN(), none};
  }

  void write_label(Label& label, std::size_t face) {
    if (label.attribute == nullptr) return;
    const double value = label.attribute->values[face];
    if (same_value(value, label.current)) return;
    label.current = value;
    out_ += label.keyword;
    out_ += ' ';
    out_ += std::isnan(value) ? label.none : label_text(*label.attribute, value);
    out_ += '\n';
  }

  static std::string label_text(const Attribute& attribute, double value) {
    if (value >= 0 && value < static_cast<double>(attribute.labels.size())) {
      return attribute.labels[static_cast<std::size_t>(value)];
    }
    std::string text = attribute.name == "smoothing" ? "" : attribute.name + "_";
    append_number(text, value, ScalarType::float64);
    return text;
  }

  void write_corner(Index vertex, std::size_t corner) {
    out_ += ' ';
    out_ += std::to_string(std::int64_t{vertex} + 1);
    const std::int64_t uv = uvs_.line_of(corner, vertex);
    const std::int64_t normal = normals_.line_of(corner, vertex);
    if (uv > 0 || normal > 0) out_ += '/';
    if (uv > 0) out_ += std::to_string(uv);
    if (normal > 0) out_ += '/' + std::to_string(normal);
  }

  void write_number(double value, ScalarType type) {
    out_ += ' ';
    append_number(out_, value, type);
  }

  void check_stop(Index element) const {
    if (element % elements_per_check == 0) context_.throw_if_stopped();
  }

  /// Adds a note that names the attributes for which OBJ has no line.
  void note_attributes(std::vector<Note>& notes) const {
    std::vector<std::string> names;
    for (const Attribute& attribute : mesh_.attributes) {
      if (is_written(attribute)) continue;
      if (std::ranges::all_of(attribute.values, [](double value) { return std::isnan(value); })) continue;
      names.push_back(attribute.name);
    }
    if (!names.empty()) notes.push_back(facts::io::AttributesLeftOut{.format = "OBJ", .attributes = names});
  }

  bool is_written(const Attribute& attribute) const {
    const std::string_view name = attribute.name;
    switch (attribute.domain) {
      case Domain::face:
        return attribute.components == 1 &&
               (name == "object" || name == "group" || name == "material" || name == "smoothing");
      case Domain::vertex:
        if (name == "colour") return attribute.components == 3 || attribute.components == 4;
        [[fallthrough]];
      case Domain::corner: break;
    }
    return (name == "uv" && attribute.components == 2) || (name == "normal" && attribute.components == 3);
  }

  const Mesh& mesh_;
  const Context& context_;
  ObjMaterials materials_;
  ReferencedLines uvs_;
  ReferencedLines normals_;
  std::string out_;
};

}  // namespace

Written write_obj(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions&,
                  const Context& context) {
  const auto* document = dynamic_cast<const ObjDocument*>(mesh.source.get());
  const bool unchanged = document != nullptr && document->has_topology_of(mesh);
  if (!unchanged) return ObjComposer(mesh, path, context).compose();
  Written written{ObjPatcher(*document, mesh, context).patch()};
  for (const std::string& library : libraries_to_copy(*document, path))
    written.notes.push_back(facts::io::LibraryToCopy{.library = library});
  return written;
}

}  // namespace meshgraft::io
