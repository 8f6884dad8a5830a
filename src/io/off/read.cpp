#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <meshgraft/core/error.h>

#include "document.h"
#include "io/charged.h"
#include "io/check_interval.h"
#include "io/facts.h"
#include "io/number_text.h"
#include "io/up_axis_comment.h"
#include "io/word_cursor.h"
#include "off.h"

namespace meshgraft::io {

namespace {

constexpr double largest_index = std::numeric_limits<Index>::max();

/// The parts of the header's keyword.
struct Keyword {
  bool texture = false, colour = false, normal = false, four = false, any_dimension = false;
  std::size_t size = 0;  ///< 0: the text does not begin with a keyword
};

/// Returns whether a character may follow the keyword. Files of one well-known collection have the counts right
/// behind it: "OFF490 518 0".
bool may_follow_keyword(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '#' || (c >= '0' && c <= '9');
}

Keyword parse_keyword(std::string_view text) {
  Keyword keyword;
  std::size_t at = 0;
  for (;;) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("OFF")) break;
    if (rest.starts_with("ST") && !keyword.texture) {
      keyword.texture = true;
      at += 2;
      continue;
    }
    bool* flag = nullptr;
    switch (rest.empty() ? '\0' : rest[0]) {
      case 'C': flag = &keyword.colour; break;
      case 'N': flag = &keyword.normal; break;
      case '4': flag = &keyword.four; break;
      case 'n': flag = &keyword.any_dimension; break;
      default: break;
    }
    if (flag == nullptr || *flag) return {};
    *flag = true;
    ++at;
  }
  at += 3;
  if (at < text.size() && !may_follow_keyword(text[at])) return {};
  keyword.size = at;
  return keyword;
}

/// Collects the colours of faces, one face after another. Files without colours need no memory for them.
class FaceColours {
 public:
  FaceColours(Index faces, MemoryBudget& budget) : faces_(static_cast<std::size_t>(faces)), budget_(budget) {}

  void push(Index face, const std::array<double, 4>& colour, std::size_t count, bool whole) {
    if (colours_.empty()) {
      reserve_charged(colours_, 4 * faces_, budget_);
      reserve_charged(whole_, faces_, budget_);
      budget_.require(3 * faces_ * sizeof(double));
    }
    colours_.resize(4 * static_cast<std::size_t>(face), no_value);
    whole_.resize(face, true);
    colours_.insert(colours_.end(), colour.begin(), colour.end());
    whole_.push_back(whole);
    has_alpha_ = has_alpha_ || count == 4;
    has_fractions_ = has_fractions_ || !whole;
  }

  std::optional<ScalarType> type() const {
    if (colours_.empty()) return std::nullopt;
    return has_fractions_ ? ScalarType::float32 : ScalarType::uint8;
  }

  void move_to(Mesh& mesh) {
    if (colours_.empty()) return;
    Attribute attribute;
    attribute.name = "colour";
    attribute.domain = Domain::face;
    attribute.type = *type();
    attribute.components = has_alpha_ ? 4 : 3;
    reserve_charged(attribute.values, faces_ * static_cast<std::size_t>(attribute.components), budget_);
    for (std::size_t f = 0; f < whole_.size(); ++f) {
      const double* colour = colours_.data() + 4 * f;
      const double divisor =
          off_colour_divisor(attribute.type, whole_[f], *std::max_element(colour, colour + 3));
      for (int k = 0; k < attribute.components; ++k) attribute.values.push_back(colour[k] / divisor);
    }
    attribute.values.resize(faces_ * static_cast<std::size_t>(attribute.components), no_value);
    mesh.attributes.push_back(std::move(attribute));
    free_charged(colours_, budget_);
    free_charged(whole_, budget_);
  }

 private:
  std::size_t faces_;
  MemoryBudget& budget_;
  std::vector<double> colours_;  // red, green, blue, alpha
  Flags whole_;
  bool has_alpha_ = false;
  bool has_fractions_ = false;
};

/// Reads an OFF file in one pass. Vertices may break across lines. The colour of a face ends with its line.
class OffReader {
 public:
  OffReader(std::string content, const std::string& name, MemoryBudget& budget, const Context& context)
      : name_(name),
        budget_(budget),
        context_(context),
        document_(std::make_shared<OffDocument>()),
        cursor_(set_content(std::move(content)), name, WordCursor::Comments::hash) {
    document_->path = name;
  }

  Mesh read() {
    const Keyword keyword = read_keyword();
    read_counts();
    document_->body = cursor_.offset();
    plan_columns(keyword);
    require_room();
    require_memory();
    read_vertices();
    read_faces();
    if (!cursor_.next().empty()) {
      cursor_.fail(facts::io::TrailingDataOfOff{});
    }
    document_->remember_topology(mesh_);
    mesh_.source = std::move(document_);
    return std::move(mesh_);
  }

 private:
  std::string_view set_content(std::string content) {
    document_->content = std::move(content);
    return document_->content;
  }

  /// Reads the header's keyword, which may be missing: Geomview lets a file begin with its counts.
  Keyword read_keyword() {
    const std::string_view word = cursor_.next();
    const std::size_t begin = cursor_.word_begin();
    const Keyword keyword = parse_keyword(std::string_view(document_->content).substr(begin));
    if (keyword.size == 0) {
      double count = 0;
      if (!WordCursor::to_number(word, ScalarType::float64, count)) {
        cursor_.fail(facts::io::NotThisFormat{.format = "OFF", .beginning = "OFF"});
      }
      cursor_ = WordCursor(document_->content, name_, WordCursor::Comments::hash, begin);
      return keyword;
    }
    if (keyword.four || keyword.any_dimension) {
      cursor_.fail(facts::io::UnsupportedVariant{.format = "OFF", .variant = word.substr(0, keyword.size)});
    }
    cursor_ = WordCursor(document_->content, name_, WordCursor::Comments::hash, begin + keyword.size);
    WordCursor ahead = cursor_;
    if (ahead.next_on_line() == "BINARY") {
      ahead.fail(facts::io::UnsupportedVariant{.format = "OFF", .variant = "BINARY"});
    }
    require_text(document_->content, name_, "OFF");
    return keyword;
  }

  /// Reads the counts. The number of edges, which nobody uses, is missing in some files.
  void read_counts() {
    vertices_ = count("vertex", "vertex_count");
    const std::size_t first = cursor_.word_begin();
    faces_ = count("face", "face_count");
    const std::string_view between =
        std::string_view(document_->content).substr(first, cursor_.word_begin() - first);
    const bool own_lines = between.find_first_of("\r\n") != std::string_view::npos;
    WordCursor ahead = cursor_;
    if (ahead.next_on_line().empty() && !own_lines) return;
    cursor_.number(ScalarType::float64, {"header", "edge_count"});
  }

  Index count(const char* element, const char* name) {
    const double value = cursor_.number(ScalarType::float64, {"header", name});
    if (!(value >= 0 && value <= largest_index && value == std::trunc(value))) {
      const std::size_t begin = cursor_.word_begin();
      const std::string_view word =
          std::string_view(document_->content).substr(begin, cursor_.offset() - begin);
      cursor_.fail(facts::io::BadCount{.element = element, .word = shown(word)});
    }
    return static_cast<Index>(value);
  }

  void plan_columns(const Keyword& keyword) {
    std::vector<OffColumn>& columns = document_->columns;
    columns.push_back({"", 3});
    if (keyword.normal) columns.push_back({"normal", 3});
    if (keyword.colour) columns.push_back({"colour", colour_components(keyword)});
    if (keyword.texture) columns.push_back({"uv", 2});
  }

  /// Returns the number of values in a vertex colour. Geomview writes four, many programs write three. The
  /// number of values on the first vertex's line decides.
  int colour_components(const Keyword& keyword) const {
    WordCursor ahead = cursor_;
    int values = ahead.next().empty() ? 0 : 1;
    while (!ahead.next_on_line().empty()) ++values;
    return values == 6 + (keyword.normal ? 3 : 0) + (keyword.texture ? 2 : 0) ? 3 : 4;
  }

  /// Refuses counts that the file is too short for. A value takes a character and a separator, so the counts
  /// can then be trusted for memory.
  void require_room() const {
    std::size_t values = 0;
    for (const OffColumn& column : document_->columns) values += static_cast<std::size_t>(column.components);
    const std::size_t room = (cursor_.remaining() + 1) / 2;
    const std::size_t for_vertices = values * static_cast<std::size_t>(vertices_);
    if (for_vertices > room) cursor_.fail(facts::io::TooShort{.element = "vertex", .count = vertices_});
    if (static_cast<std::size_t>(faces_) > room - for_vertices)
      cursor_.fail(facts::io::TooShort{.element = "face", .count = faces_});
  }

  /// Refuses counts that exceed the budget if all faces are triangles without a colour.
  void require_memory() const {
    std::uint64_t values = 0;
    for (const OffColumn& column : document_->columns) values += static_cast<std::uint64_t>(column.components);
    const auto vertices = static_cast<std::uint64_t>(vertices_), faces = static_cast<std::uint64_t>(faces_);
    budget_.require(vertices * values * sizeof(double) + faces * 4 * sizeof(Index));
  }

  void read_vertices() {
    resize_charged(mesh_.positions, static_cast<std::size_t>(vertices_), budget_);
    std::vector<double*> targets{mesh_.positions.data()};
    for (const OffColumn& column : document_->columns) {
      if (column.attribute.empty()) continue;
      Attribute attribute;
      attribute.name = column.attribute;
      attribute.type = ScalarType::float32;
      attribute.components = column.components;
      if (column.attribute == "normal") attribute.interpolation = Interpolation::direction;
      const auto components = static_cast<std::size_t>(column.components);
      resize_charged(attribute.values, static_cast<std::size_t>(vertices_) * components, 0.0, budget_);
      mesh_.attributes.push_back(std::move(attribute));
    }
    for (Attribute& attribute : mesh_.attributes) targets.push_back(attribute.values.data());
    for (Index v = 0; v < vertices_; ++v) {
      if (v % elements_per_check == 0) report_progress();
      for (std::size_t c = 0; c < targets.size(); ++c) {
        const OffColumn& column = document_->columns[c];
        for (int k = 0; k < column.components; ++k) *targets[c]++ = vertex_value(v, column);
      }
    }
    settle_vertex_colours();
  }

  double vertex_value(Index v, const OffColumn& column) {
    const std::string_view name = column.attribute.empty() ? "position" : column.attribute;
    return cursor_.number(ScalarType::float64, {"vertex", name, v});
  }

  /// Decides whether vertex colours are fractions or bytes. Geomview writes fractions, most programs write
  /// bytes.
  void settle_vertex_colours() {
    for (Attribute& attribute : mesh_.attributes) {
      if (attribute.name != "colour") continue;
      const auto is_byte = [](double value) {
        return value >= 0 && value <= 255 && value == std::trunc(value);
      };
      const bool bytes = std::ranges::all_of(attribute.values, is_byte) &&
                         std::ranges::any_of(attribute.values, [](double value) { return value > 1; });
      if (bytes) attribute.type = ScalarType::uint8;
      document_->vertex_colour = attribute.type;
    }
  }

  void read_faces() {
    // Most meshes consist of triangles. A wrong guess costs nothing.
    const auto faces = static_cast<std::size_t>(faces_);
    reserve_charged(mesh_.faces, faces, std::min(cursor_.remaining() / 2, 3 * faces), budget_);
    FaceColours colours(faces_, budget_);
    for (Index f = 0; f < faces_; ++f) {
      if (f % elements_per_check == 0) report_progress();
      read_corners(f);
      read_colour(f, colours);
    }
    document_->face_colour = colours.type();
    document_->has_face_index = !indices_.empty();
    colours.move_to(mesh_);
    add_indices();
  }

  void read_corners(Index f) {
    const double size = cursor_.number(ScalarType::int32, {"face", "corner_count", f});
    if (size < 0 || size > static_cast<double>(cursor_.remaining() + 1) / 2) {
      cursor_.fail(facts::io::BadLength{.list = "corners",
                                        .length = static_cast<std::int64_t>(size),
                                        .most = (cursor_.remaining() + 1) / 2},
                   "face", f);
    }
    if (size > largest_index - mesh_.faces.corner_count()) {
      cursor_.fail(facts::io::TooMany{.elements = facts::io::Elements::corners,
                                      .most = std::numeric_limits<Index>::max()});
    }
    resize_charged(corners_, static_cast<std::size_t>(size), Index{0}, budget_);
    for (Index& corner : corners_)
      corner = static_cast<Index>(cursor_.number(ScalarType::int32, {"face", "vertex_index", f}));
    push_charged(mesh_.faces, corners_, budget_);
  }

  void read_colour(Index f, FaceColours& colours) {
    std::array<double, 4> values;
    values.fill(no_value);
    std::size_t size = 0;
    bool whole = true;
    for (std::string_view word = cursor_.next_on_line(); !word.empty(); word = cursor_.next_on_line()) {
      if (size == values.size()) fail_colour(f);
      if (!WordCursor::to_number(word, ScalarType::float64, values[size]))
        cursor_.fail_number(word, ScalarType::float64, {"face", "colour", f});
      whole = whole && is_spelled_whole(word);
      ++size;
    }
    if (size == 0) return;
    if (size == 2 || (size == 1 && !(whole && std::abs(values[0]) <= largest_index))) fail_colour(f);
    if (size == 1) {
      reserve_charged(indices_, static_cast<std::size_t>(faces_), budget_);
      indices_.resize(f, no_value);
      indices_.push_back(values[0]);
      return;
    }
    const auto is_byte = [](double value) { return value >= 0 && value <= 255; };
    if (whole && !std::all_of(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size), is_byte))
      fail_colour(f);
    colours.push(f, values, size, whole);
  }

  [[noreturn]] void fail_colour(Index f) const { cursor_.fail(facts::io::BadColour{.face = f}); }

  void add_indices() {
    if (indices_.empty()) return;
    indices_.resize(faces_, no_value);
    Attribute attribute;
    attribute.name = off_colour_index;
    attribute.domain = Domain::face;
    attribute.interpolation = Interpolation::nearest;
    attribute.type = ScalarType::int32;
    attribute.values = std::move(indices_);
    mesh_.attributes.push_back(std::move(attribute));
  }

  void report_progress() const {
    context_.step("read",
                  static_cast<double>(cursor_.offset()) / static_cast<double>(document_->content.size()));
  }

  const std::string& name_;
  MemoryBudget& budget_;
  const Context& context_;
  std::shared_ptr<OffDocument> document_;
  WordCursor cursor_;
  Mesh mesh_;
  Index vertices_ = 0;
  Index faces_ = 0;
  std::vector<Index> corners_;  // of the current face
  std::vector<double> indices_;
};

}  // namespace

Format off_format() {
  static constexpr std::array<std::string_view, 1> extensions = {".off"};
  return {"OFF", extensions, has_off_signature, read_off, write_off};
}

bool has_off_signature(std::string_view content) {
  if (content.starts_with(byte_order_mark)) content.remove_prefix(byte_order_mark.size());
  return parse_keyword(content).size > 0;
}

bool is_spelled_whole(std::string_view word) {
  return std::ranges::all_of(word, [](char c) { return (c >= '0' && c <= '9') || c == '+' || c == '-'; });
}

double off_colour_divisor(ScalarType attribute_type, bool whole, double largest) {
  return attribute_type != ScalarType::uint8 && whole && largest > 1 ? 255.0 : 1.0;
}

std::optional<UpAxis> OffDocument::stated_up_axis() const {
  return up_axis_in_text(std::string_view(content).substr(0, body), false);
}

Mesh read_off(std::string content, const std::string& name, MemoryBudget& budget, const Context& context) {
  return OffReader(std::move(content), name, budget, context).read();
}

}  // namespace meshgraft::io
