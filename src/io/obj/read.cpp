#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <unordered_map>
#include <utility>

#include <meshgraft/core/error.h>

#include "document.h"
#include "io/charged.h"
#include "io/check_interval.h"
#include "io/facts.h"
#include "io/number_text.h"
#include "io/up_axis_comment.h"
#include "io/word_cursor.h"
#include "materials.h"
#include "obj.h"

namespace meshgraft::io {

namespace {

constexpr std::array<const char*, 3> axes = {"x", "y", "z"};

/// Parses a whole number, positive or negative.
bool parse_index(std::string_view& text, std::int64_t& value) {
  const std::size_t plus = text.starts_with('+') ? 1 : 0;
  const auto [end, error] = std::from_chars(text.data() + plus, text.data() + text.size(), value);
  if (error != std::errc{}) return false;
  text.remove_prefix(end - text.data());
  return true;
}

/// The kinds of line that faces refer to.
enum class Reference { vertex, uv, normal };

std::string_view keyword_of(Reference kind) {
  switch (kind) {
    case Reference::vertex: return "v";
    case Reference::uv: return "vt";
    case Reference::normal: break;
  }
  return "vn";
}

/// A positive index beyond the lines so far. It is legal only if its line comes later.
struct ForwardReference {
  Reference kind;
  std::int64_t index;
  std::size_t offset;
};

/// Collects the labels that g, o, usemtl and s lines set for the faces after them.
class FaceLabels {
 public:
  FaceLabels(std::string name, bool named, MemoryBudget& budget)
      : name_(std::move(name)), named_(named), budget_(budget) {}

  void set(std::string_view label) {
    if (!numbers_.contains(std::string(label))) budget_.charge(bytes_of(label));
    const auto [entry, is_new] = numbers_.try_emplace(std::string(label), static_cast<double>(labels_.size()));
    if (is_new) labels_.push_back(entry->first);
    current_ = entry->second;
  }
  void set_number(double number) { current_ = number; }

  /// Stores the current label of a face. Faces before the first label have none.
  void push_face(Index face, std::size_t expected_faces) {
    if (values_.empty() && std::isnan(current_)) return;
    if (values_.empty()) reserve_charged(values_, expected_faces, budget_);
    make_room(values_, static_cast<std::size_t>(face) + 1 - values_.size(), budget_);
    values_.resize(face, no_value);
    values_.push_back(current_);
  }

  void move_to(Mesh& mesh) {
    if (values_.empty()) return;
    Attribute attribute;
    attribute.name = name_;
    attribute.domain = Domain::face;
    attribute.interpolation = Interpolation::nearest;
    attribute.type = ScalarType::int32;
    attribute.values = std::move(values_);
    if (named_) attribute.labels = std::move(labels_);
    mesh.attributes.push_back(std::move(attribute));
  }

 private:
  std::string name_;
  bool named_;
  MemoryBudget& budget_;
  double current_ = no_value;
  std::vector<double> values_;
  std::vector<std::string> labels_;
  std::unordered_map<std::string, double> numbers_;
};

/// Reads an OBJ file in one pass.
class ObjReader {
 public:
  ObjReader(std::string content, const std::string& name, MemoryBudget& budget, const Context& context)
      : name_(name), budget_(budget), context_(context), document_(std::make_shared<ObjDocument>()) {
    document_->content = std::move(content);
    document_->path = name;
  }

  Mesh read() {
    require_text(document_->content, name_, "OBJ");
    reserve();
    ObjCursor cursor(document_->content);
    for (std::size_t line = 1; cursor.next_line(); ++line) {
      if (line % elements_per_check == 0) report_progress(cursor);
      read_line(cursor);
    }
    check_forward_references();
    if (vertices_.empty()) throw Error(facts::io::NoVertices{.element = "v"}, Location::file(name_));
    fill_mesh();
    return std::move(mesh_);
  }

 private:
  /// The lines of each kind, and the first face.
  struct LineCounts {
    std::size_t vertices = 0, uvs = 0, normals = 0, faces = 0;
    std::string_view first_face;
  };

  LineCounts count_lines() const {
    const std::string_view content = document_->content;
    LineCounts counts;
    for (std::size_t line = 0; line + 1 < content.size(); ++line) {
      const std::size_t end = std::min(content.find('\n', line), content.size());
      const char first = content[line], second = content[line + 1];
      if (first == 'v') {
        counts.vertices += second == ' ';
        counts.uvs += second == 't';
        counts.normals += second == 'n';
      } else if (first == 'f' && second == ' ') {
        if (counts.faces++ == 0) counts.first_face = content.substr(line, end - line);
      }
      line = end;
    }
    return counts;
  }

  /// Reserves memory for the lines, which are counted first. Growing step by step takes up to half as much
  /// again. Also refuses a file whose mesh exceeds the budget if all faces are triangles like the first.
  void reserve() {
    LineCounts counts = count_lines();
    constexpr std::size_t most = std::numeric_limits<Index>::max() / 4;
    for (std::size_t* count : {&counts.vertices, &counts.uvs, &counts.normals, &counts.faces})
      *count = std::min(*count, most);
    ObjCursor cursor(counts.first_face);
    ObjCorner corner;
    std::size_t first_corners = 0;
    if (cursor.next_line())
      while (parse_obj_corner(cursor.next_word(), corner)) ++first_corners;

    const std::size_t corners = 3 * counts.faces;
    const std::size_t of_uvs = corner.has_uv ? 2 * sizeof(double) * corners : 0;
    const std::size_t of_normals =
        corner.has_normal ? (3 * sizeof(double) + sizeof(Index)) * corners + 3 * sizeof(double) * counts.normals
                          : 0;
    budget_.require(3 * sizeof(double) * counts.vertices + sizeof(Index) * (counts.faces + corners) + of_uvs +
                    of_normals);

    expected_vertices_ = counts.vertices;
    expected_faces_ = counts.faces;
    expected_corners_ = std::clamp<std::size_t>(first_corners, 3, 4) * counts.faces;
    reserve_charged(vertices_, 3 * counts.vertices, budget_);
    reserve_charged(mesh_.faces, counts.faces, expected_corners_, budget_);
    reserve_charged(uvs_, 2 * counts.uvs, budget_);
    reserve_charged(document_->normals, 3 * counts.normals, budget_);
  }

  void report_progress(const ObjCursor& cursor) const {
    context_.step("read",
                  static_cast<double>(cursor.offset()) / static_cast<double>(document_->content.size()));
  }

  void read_line(ObjCursor& cursor) {
    const std::string_view keyword = cursor.keyword();
    if (keyword == "v") return read_vertex(cursor);
    if (keyword == "vt") return read_uv(cursor);
    if (keyword == "vn") return read_normal(cursor);
    if (is_face_keyword(keyword)) return read_face(cursor);
    if (keyword == "g") return groups_.set(cursor.rest_of_line());
    if (keyword == "o") return objects_.set(cursor.rest_of_line());
    if (keyword == "usemtl") return materials_.set(cursor.rest_of_line());
    if (keyword == "s") return read_smoothing(cursor);
    // Everything else, comments and free-form surfaces included, stays in the document.
  }

  void read_vertex(ObjCursor& cursor) {
    static constexpr const char* names[] = {"x", "y", "z", "r", "g", "b", "a"};
    std::array<double, 7> values;
    std::size_t count = 0;
    for (std::string_view word = cursor.next_word(); !word.empty(); word = cursor.next_word()) {
      if (count == values.size()) fail(cursor, facts::io::ExtraValues{.element = "v"});
      values[count] = number(cursor, names[count], word);
      ++count;
    }
    if (count < 3) fail(cursor, facts::io::MissingValue{.element = "v", .value = axes[count]});
    if (vertices_.size() / 3 == static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
      fail(cursor, facts::io::TooMany{.elements = facts::io::Elements::vertices,
                                      .most = std::numeric_limits<Index>::max()});
    }
    make_room(vertices_, 3, budget_);
    vertices_.insert(vertices_.end(), values.begin(), values.begin() + 3);
    // The forms "x y z w", "x y z r g b" and "x y z r g b a" are in use.
    if (count >= 6) {
      const std::size_t size = vertices_.size() / 3 * 4;
      if (colours_.empty()) reserve_charged(colours_, 4 * expected_vertices_, budget_);
      make_room(colours_, size - colours_.size(), budget_);
      colours_.resize(size - 4, no_value);
      colours_.insert(colours_.end(), {values[3], values[4], values[5], count == 7 ? values[6] : no_value});
      has_alpha_ = has_alpha_ || count == 7;
    }
  }

  void read_uv(ObjCursor& cursor) {
    const std::string_view u = cursor.next_word();
    if (u.empty()) fail(cursor, facts::io::MissingValue{.element = "vt", .value = "u"});
    push_charged(uvs_, number(cursor, "u", u), budget_);
    const std::string_view v = cursor.next_word();
    push_charged(uvs_, v.empty() ? 0.0 : number(cursor, "v", v), budget_);
  }

  void read_normal(ObjCursor& cursor) {
    for (const char* axis : axes) {
      const std::string_view word = cursor.next_word();
      if (word.empty()) fail(cursor, facts::io::MissingValue{.element = "vn", .value = axis});
      push_charged(document_->normals, number(cursor, axis, word), budget_);
    }
  }

  void read_face(ObjCursor& cursor) {
    corners_.clear();
    for (std::string_view word = cursor.next_word(); !word.empty(); word = cursor.next_word()) {
      ObjCorner corner;
      if (!parse_obj_corner(word, corner)) {
        fail(cursor, facts::io::BadCorner{.word = shown(word)});
      }
      push_charged(corners_, resolve(cursor, Reference::vertex, corner.vertex, vertices_.size() / 3), budget_);
      const Index uv = corner.has_uv ? resolve(cursor, Reference::uv, corner.uv, uvs_.size() / 2) : -1;
      const Index normal =
          corner.has_normal ? resolve(cursor, Reference::normal, corner.normal, document_->normals.size() / 3)
                            : -1;
      push_reference(corner_uvs_, uv);
      push_reference(document_->corner_normals, normal);
      ++corner_count_;
    }
    if (corners_.empty()) fail(cursor, facts::io::MissingValue{.element = "f", .value = "v"});
    if (corner_count_ > static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
      fail(cursor, facts::io::TooMany{.elements = facts::io::Elements::corners,
                                      .most = std::numeric_limits<Index>::max()});
    }
    for (FaceLabels* labels : {&groups_, &objects_, &materials_, &smoothing_})
      labels->push_face(mesh_.faces.size(), expected_faces_);
    push_charged(mesh_.faces, corners_, budget_);
  }

  /// Appends the reference of a corner. Files without uvs or normals need no memory for them.
  void push_reference(std::vector<Index>& references, Index reference) {
    if (references.empty() && reference < 0) return;
    if (references.empty()) reserve_charged(references, expected_corners_, budget_);
    make_room(references, corner_count_ + 1 - references.size(), budget_);
    references.resize(corner_count_, -1);
    references.push_back(reference);
  }

  /// Returns a 0-based index from a 1-based index, or from a negative one that counts back from the last line
  /// so far.
  Index resolve(const ObjCursor& cursor, Reference kind, std::int64_t index, std::size_t lines_so_far) {
    const auto count = static_cast<std::int64_t>(lines_so_far);
    if (index == 0 || index < -count || index > std::numeric_limits<Index>::max()) {
      fail_index(cursor.word_begin(), kind, index, count);
    }
    if (index > count)
      push_charged(forward_references_, ForwardReference{kind, index, cursor.word_begin()}, budget_);
    return static_cast<Index>(index > 0 ? index - 1 : count + index);
  }

  void check_forward_references() const {
    for (const ForwardReference& reference : forward_references_) {
      const std::size_t count = reference.kind == Reference::vertex ? vertices_.size() / 3
                                : reference.kind == Reference::uv   ? uvs_.size() / 2
                                                                    : document_->normals.size() / 3;
      if (reference.index > static_cast<std::int64_t>(count)) {
        fail_index(reference.offset, reference.kind, reference.index, static_cast<std::int64_t>(count));
      }
    }
  }

  void read_smoothing(ObjCursor& cursor) {
    const std::string_view word = cursor.next_word();
    const ParsedNumber group = parse_number(word, ScalarType::int32);
    // "s off" and "s 0" mean the same. Any other text counts as 0, too.
    smoothing_.set_number(group.fault == NumberFault::none ? group.value : 0.0);
  }

  double number(const ObjCursor& cursor, std::string_view value, std::string_view word) const {
    const ParsedNumber parsed = parse_number(word, ScalarType::float64);
    if (parsed.fault != NumberFault::none) {
      fail(cursor, bad_number(cursor.keyword(), value, word, ScalarType::float64, parsed.fault));
    }
    return parsed.value;
  }

  void fill_mesh() {
    const std::size_t count = vertices_.size() / 3;
    resize_charged(mesh_.positions, count, budget_);
    mesh_.positions = Eigen::Map<const Points>(vertices_.data(), static_cast<Eigen::Index>(count), 3);
    free_charged(vertices_, budget_);  // before the attributes take their memory
    fill_colours(count);
    free_charged(colours_, budget_);
    fill_corners("uv", Interpolation::linear, 2, corner_uvs_, uvs_);
    free_charged(corner_uvs_, budget_);
    free_charged(uvs_, budget_);
    fill_corners("normal", Interpolation::direction, 3, document_->corner_normals, document_->normals);
    for (FaceLabels* labels : {&groups_, &objects_, &materials_, &smoothing_}) labels->move_to(mesh_);
    document_->remember_topology(mesh_);
    mesh_.source = std::move(document_);
  }

  void fill_colours(std::size_t count) {
    if (colours_.empty()) return;
    resize_charged(colours_, 4 * count, no_value, budget_);
    Attribute attribute;
    attribute.name = "colour";
    attribute.components = has_alpha_ ? 4 : 3;
    attribute.type = ScalarType::float32;
    reserve_charged(attribute.values, count * static_cast<std::size_t>(attribute.components), budget_);
    for (std::size_t v = 0; v < count; ++v) {
      const auto first = colours_.begin() + static_cast<std::ptrdiff_t>(4 * v);
      attribute.values.insert(attribute.values.end(), first, first + attribute.components);
    }
    mesh_.attributes.push_back(std::move(attribute));
  }

  /// Adds a corner attribute with the values that the corners refer to.
  void fill_corners(const char* attribute_name, Interpolation interpolation, int components,
                    std::vector<Index>& references, const std::vector<double>& lines) {
    if (references.empty()) return;
    resize_charged(references, corner_count_, Index{-1}, budget_);
    Attribute attribute;
    attribute.name = attribute_name;
    attribute.domain = Domain::corner;
    attribute.interpolation = interpolation;
    attribute.type = ScalarType::float32;
    attribute.components = components;
    resize_charged(attribute.values, corner_count_ * static_cast<std::size_t>(components), no_value, budget_);
    for (std::size_t c = 0; c < corner_count_; ++c) {
      if (references[c] < 0) continue;
      const auto first = lines.begin() + static_cast<std::ptrdiff_t>(references[c]) * components;
      std::copy(first, first + components,
                attribute.values.begin() + static_cast<std::ptrdiff_t>(c) * components);
    }
    mesh_.attributes.push_back(std::move(attribute));
  }

  [[noreturn]] void fail_index(std::size_t offset, Reference kind, std::int64_t index,
                               std::int64_t count) const {
    const Location location = Location::file(name_) / Location::place(line_name(document_->content, offset));
    const std::string_view element = keyword_of(kind);
    if (index == 0) throw Error(facts::io::IndexZero{}, location);
    if (index < 0)
      throw Error(facts::io::IndexBeforeFirst{.element = element, .index = index, .count = count}, location);
    throw Error(facts::io::IndexOutOfRange{.element = element, .index = index, .count = count}, location);
  }

  [[noreturn]] void fail(const ObjCursor& cursor, Fact fact) const {
    throw Error(std::move(fact),
                Location::file(name_) / Location::place(line_name(document_->content, cursor.line_begin())));
  }

  const std::string& name_;
  MemoryBudget& budget_;
  const Context& context_;
  std::shared_ptr<ObjDocument> document_;
  Mesh mesh_;
  std::vector<double> vertices_;
  std::vector<double> colours_;  // red, green, blue, alpha
  bool has_alpha_ = false;
  std::vector<double> uvs_;
  std::vector<Index> corner_uvs_;
  std::size_t corner_count_ = 0;
  std::size_t expected_vertices_ = 0, expected_faces_ = 0, expected_corners_ = 0;
  std::vector<Index> corners_;  // of the current face
  std::vector<ForwardReference> forward_references_;
  FaceLabels groups_{"group", true, budget_};
  FaceLabels objects_{"object", true, budget_};
  FaceLabels materials_{"material", true, budget_};
  FaceLabels smoothing_{"smoothing", false, budget_};
};

}  // namespace

Format obj_format() {
  static constexpr std::array<std::string_view, 1> extensions = {".obj"};
  return {"OBJ", extensions, nullptr, read_obj, write_obj, files_of_materials};
}

Mesh read_obj(std::string content, const std::string& name, MemoryBudget& budget, const Context& context) {
  return ObjReader(std::move(content), name, budget, context).read();
}

std::vector<Note> ObjDocument::beside_the_mesh() const {
  constexpr std::array<std::string_view, 11> known = {"",  "v", "vt", "vn",     "f",     "fo",
                                                      "g", "o", "s",  "usemtl", "mtllib"};
  std::map<std::string, std::size_t, std::less<>> lines;
  ObjCursor cursor(content);
  while (cursor.next_line())
    if (std::ranges::find(known, cursor.keyword()) == known.end()) ++lines[std::string(cursor.keyword())];
  std::vector<Note> notes;
  for (const auto& [keyword, count] : lines)
    notes.push_back(facts::io::LeftOut{.file = path.filename(), .content = keyword, .count = count});
  return notes;
}

std::optional<UpAxis> ObjDocument::stated_up_axis() const { return up_axis_in_text(content, true); }

ObjCursor::ObjCursor(std::string_view content) : content_(content) {
  if (content_.starts_with("\xEF\xBB\xBF")) offset_ = 3;  // byte order mark
}

bool ObjCursor::next_line() {
  finish_line();
  while (offset_ < content_.size() && (is_blank(content_[offset_]) || is_line_end(content_[offset_])))
    ++offset_;
  if (offset_ == content_.size()) return false;
  line_begin_ = offset_;
  line_open_ = true;
  keyword_ = next_word();
  return true;
}

std::string_view ObjCursor::next_word() {
  skip_blanks();
  word_begin_ = offset_;
  if (offset_ < content_.size() && content_[offset_] == '#') return {};
  for (; offset_ < content_.size(); ++offset_) {
    const char c = content_[offset_];
    if (is_blank(c) || is_line_end(c)) break;
    if (c == '\\' && continuation_size() > 0) break;
  }
  return content_.substr(word_begin_, offset_ - word_begin_);
}

std::string_view ObjCursor::rest_of_line() {
  skip_blanks();
  const std::size_t begin = offset_;
  for (bool is_comment = false; offset_ < content_.size() && !is_line_end(content_[offset_]); ++offset_) {
    is_comment = is_comment || begins_comment();
    if (!is_comment && continuation_size() > 0) break;
  }
  std::size_t end = offset_;
  while (end > begin && is_blank(content_[end - 1])) --end;
  return content_.substr(begin, end - begin);
}

void ObjCursor::finish_line() {
  if (!line_open_) return;
  bool is_comment = false;
  while (offset_ < content_.size() && !is_line_end(content_[offset_])) {
    is_comment = is_comment || begins_comment();
    const std::size_t continuation = is_comment ? 0 : continuation_size();
    offset_ += continuation > 0 ? continuation : 1;
  }
  if (content_.substr(offset_, 2) == "\r\n") {
    offset_ += 2;
  } else if (offset_ < content_.size()) {
    ++offset_;
  }
  line_open_ = false;
}

void ObjCursor::skip_blanks() {
  while (offset_ < content_.size()) {
    if (is_blank(content_[offset_])) {
      ++offset_;
    } else if (const std::size_t continuation = continuation_size()) {
      offset_ += continuation;
    } else {
      return;
    }
  }
}

bool ObjCursor::begins_comment() const {
  if (content_[offset_] != '#') return false;
  return offset_ == line_begin_ || is_blank(content_[offset_ - 1]) || is_line_end(content_[offset_ - 1]);
}

std::size_t ObjCursor::continuation_size() const {
  if (content_[offset_] != '\\') return 0;
  const std::string_view after = content_.substr(offset_ + 1, 2);
  if (after == "\r\n") return 3;
  if (after.empty()) return 1;
  return is_line_end(after[0]) ? 2 : 0;
}

bool parse_obj_corner(std::string_view word, ObjCorner& corner) {
  std::string_view rest = word;
  if (!parse_index(rest, corner.vertex)) return false;
  if (rest.empty()) return true;
  if (rest[0] != '/') return false;
  rest.remove_prefix(1);
  if (!rest.empty() && rest[0] != '/') {
    if (!parse_index(rest, corner.uv)) return false;
    corner.has_uv = true;
  }
  if (rest.empty()) return true;
  if (rest[0] != '/') return false;
  rest.remove_prefix(1);
  if (rest.empty()) return true;
  corner.normal_begin = word.size() - rest.size();
  corner.has_normal = parse_index(rest, corner.normal);
  return corner.has_normal && rest.empty();
}

}  // namespace meshgraft::io
