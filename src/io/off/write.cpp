#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <meshgraft/core/error.h>

#include "document.h"
#include "io/check_interval.h"
#include "io/number_text.h"
#include "io/unwritten.h"
#include "io/up_axis_comment.h"
#include "off.h"

namespace meshgraft::io {

namespace {

/// Appends a colour as a fraction with a point. Without it, the colour would read as a whole number up to
/// 255.
void append_fraction(std::string& text, double value) {
  const std::size_t begin = text.size();
  append_number(text, narrow(value, ScalarType::float32).value, ScalarType::float32);
  if (text.find_first_not_of("-0123456789", begin) == std::string::npos) text += ".0";
}

double clamped_byte(double value) { return std::nearbyint(std::clamp(value, 0.0, 255.0)); }

/// Returns the attribute for a column of the file, or null if the mesh has none that fits.
const Attribute* fitting(const Mesh& mesh, Domain domain, std::string_view name, int least, int most) {
  const Attribute* attribute = mesh.find_attribute(domain, name);
  if (attribute == nullptr || attribute->components < least || attribute->components > most) return nullptr;
  const auto count =
      static_cast<std::size_t>(domain == Domain::vertex ? mesh.vertex_count() : mesh.face_count());
  return attribute->values.size() == count * static_cast<std::size_t>(attribute->components) ? attribute
                                                                                             : nullptr;
}

/// Copies the file's text, with new numbers where the mesh differs from the file.
class OffPatcher {
 public:
  OffPatcher(const OffDocument& document, const Mesh& mesh, const Context& context)
      : document_(document),
        mesh_(mesh),
        context_(context),
        cursor_(document.content, name_, WordCursor::Comments::hash, document.body),
        out_(document.content) {}

  std::string patch() {
    patch_vertices();
    if (document_.face_colour || document_.has_face_index) patch_faces();
    return out_.finish();
  }

 private:
  void patch_vertices() {
    std::vector<const double*> values;
    for (const OffColumn& column : document_.columns) values.push_back(values_of(column));
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      if (v % elements_per_check == 0) context_.throw_if_stopped();
      for (std::size_t c = 0; c < values.size(); ++c) {
        const OffColumn& column = document_.columns[c];
        for (int k = 0; k < column.components; ++k) {
          const std::string_view word = cursor_.next();
          if (values[c] != nullptr) patch_value(word, *values[c]++, column);
        }
      }
    }
  }

  const double* values_of(const OffColumn& column) const {
    if (column.attribute.empty()) return mesh_.positions.data();
    const Attribute* attribute =
        fitting(mesh_, Domain::vertex, column.attribute, column.components, column.components);
    return attribute == nullptr ? nullptr : attribute->values.data();
  }

  void patch_value(std::string_view word, double value, const OffColumn& column) {
    if (same_value(parse_number(word, ScalarType::float64).value, value)) return;
    std::string text;
    if (column.attribute == "colour") {
      if (std::isnan(value)) return;
      append_colour(text, value, document_.vertex_colour == ScalarType::uint8);
    } else {
      append_number(text, value, column.attribute.empty() ? ScalarType::float64 : ScalarType::float32);
    }
    out_.replace(word, text);
  }

  void patch_faces() {
    const Attribute* colour = fitting(mesh_, Domain::face, "colour", 3, 4);
    const Attribute* index = fitting(mesh_, Domain::face, off_colour_index, 1, 1);
    if (colour == nullptr && index == nullptr) return;
    for (Index f = 0; f < mesh_.faces.size(); ++f) {
      if (f % elements_per_check == 0) context_.throw_if_stopped();
      for (std::size_t k = 0; k <= mesh_.faces[f].size(); ++k) cursor_.next();
      words_.clear();
      for (std::string_view word = cursor_.next_on_line(); !word.empty(); word = cursor_.next_on_line())
        words_.push_back(word);
      if (words_.size() == 1 && index != nullptr) patch_index(index->values[f]);
      if (words_.size() > 1 && colour != nullptr) patch_colour(*colour, f);
    }
  }

  void patch_index(double value) {
    const double old = parse_number(words_[0], ScalarType::int32).value;
    if (std::isnan(value) || old == value) return;  // 0 and -0 are equal
    out_.replace(words_[0], std::to_string(static_cast<std::int64_t>(std::nearbyint(value))));
  }

  void patch_colour(const Attribute& colour, Index f) {
    bool whole = true;
    double largest = 0;
    for (std::size_t k = 0; k < words_.size(); ++k) {
      const std::string_view word = words_[k];
      whole = whole && is_spelled_whole(word);
      if (k < 3) largest = std::max(largest, parse_number(word, ScalarType::float64).value);
    }
    const auto components = static_cast<std::size_t>(colour.components);
    const double divisor = off_colour_divisor(*document_.face_colour, whole, largest);
    const bool bytes = *document_.face_colour == ScalarType::uint8 || divisor != 1;
    for (std::size_t k = 0; k < std::min(words_.size(), components); ++k) {
      const double value = colour.values[static_cast<std::size_t>(f) * components + k];
      const double old = parse_number(words_[k], ScalarType::float64).value / divisor;
      if (std::isnan(value) || same_value(old, value)) continue;
      std::string text;
      append_colour(text, value * divisor, bytes);
      out_.replace(words_[k], text);
    }
  }

  static void append_colour(std::string& text, double value, bool bytes) {
    if (bytes) return append_number(text, clamped_byte(value), ScalarType::uint8);
    append_fraction(text, value);
  }

  const std::string name_ = "source";  // the document was read once: its numbers cannot fail to parse
  const OffDocument& document_;
  const Mesh& mesh_;
  const Context& context_;
  WordCursor cursor_;
  WordReplacer out_;
  std::vector<std::string_view> words_;  // words behind the corners of a face
};

/// Composes a file for a mesh without an OFF file behind it.
class OffComposer {
 public:
  OffComposer(const Mesh& mesh, const Context& context)
      : mesh_(mesh),
        context_(context),
        normal_(fitting(mesh, Domain::vertex, "normal", 3, 3)),
        vertex_colour_(fitting(mesh, Domain::vertex, "colour", 3, 4)),
        uv_(fitting(mesh, Domain::vertex, "uv", 2, 2)),
        face_colour_(fitting(mesh, Domain::face, "colour", 3, 4)),
        index_(fitting(mesh, Domain::face, off_colour_index, 1, 1)) {}

  Written compose() {
    if (uv_ != nullptr) out_ += "ST";
    if (vertex_colour_ != nullptr) out_ += 'C';
    if (normal_ != nullptr) out_ += 'N';
    out_ += "OFF\n";
    if (const std::string_view comment = up_axis_comment(mesh_); !comment.empty())
      out_.append("# ").append(comment) += '\n';
    out_ += std::to_string(mesh_.vertex_count()) + ' ' + std::to_string(mesh_.face_count()) + " 0\n";
    write_vertices();
    write_faces();
    Written written{std::move(out_)};
    written.notes = left_out_notes(mesh_);
    note_unwritten(mesh_, "OFF", {normal_, vertex_colour_, uv_, face_colour_, index_}, written.notes);
    return written;
  }

 private:
  /// The conversion from an attribute's colour values to the file's numbers.
  struct ColourScale {
    bool bytes = false;
    double divisor = 1;
  };

  static ColourScale scale_of(const Attribute& colour) {
    if (colour.type == ScalarType::uint16) return {false, 65535};
    if (colour.type != ScalarType::uint8) return {false, 1};
    // Whole numbers that are at most 1 in all vertices would read as fractions.
    const bool dark = colour.domain == Domain::vertex &&
                      std::ranges::none_of(colour.values, [](double value) { return value > 1; });
    return dark ? ColourScale{false, 255} : ColourScale{true, 1};
  }

  void write_vertices() {
    const ColourScale scale = vertex_colour_ != nullptr ? scale_of(*vertex_colour_) : ColourScale{};
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      if (v % elements_per_check == 0) context_.throw_if_stopped();
      for (int axis = 0; axis < 3; ++axis) put_number(mesh_.positions(v, axis), ScalarType::float64);
      if (normal_ != nullptr) put_values(*normal_, v);
      if (vertex_colour_ != nullptr) put_colour(row(*vertex_colour_, v), scale, true);
      if (uv_ != nullptr) put_values(*uv_, v);
      out_.back() = '\n';
    }
  }

  void write_faces() {
    const ColourScale scale = face_colour_ != nullptr ? scale_of(*face_colour_) : ColourScale{};
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      if (f % elements_per_check == 0) context_.throw_if_stopped();
      const std::span<const Index> corners = mesh_.faces[f];
      put_number(static_cast<double>(corners.size()), ScalarType::int32);
      for (const Index corner : corners) put_number(corner, ScalarType::int32);
      const bool coloured = face_colour_ != nullptr && put_colour(row(*face_colour_, f), scale, false);
      if (!coloured && index_ != nullptr && !std::isnan(row(*index_, f)[0]))
        put_number(row(*index_, f)[0], ScalarType::int32);
      out_.back() = '\n';
    }
  }

  static std::span<const double> row(const Attribute& attribute, Index element) {
    const auto components = static_cast<std::size_t>(attribute.components);
    return {attribute.values.data() + static_cast<std::size_t>(element) * components, components};
  }

  void put_values(const Attribute& attribute, Index v) {
    const ScalarType type = attribute.type == ScalarType::float32 ? ScalarType::float32 : ScalarType::float64;
    for (const double value : row(attribute, v)) put_number(std::isnan(value) ? 0 : value, type);
  }

  /// Appends a colour. A missing colour becomes white if `required`, as for a vertex among others with
  /// colours. Otherwise returns false, because a face needs none.
  bool put_colour(std::span<const double> colour, const ColourScale& scale, bool required) {
    const bool missing =
        std::any_of(colour.begin(), colour.begin() + 3, [](double c) { return std::isnan(c); });
    if (missing && !required) return false;
    for (std::size_t k = 0; k < colour.size(); ++k) {
      const bool none = missing || std::isnan(colour[k]);
      if (k == 3 && none && !required) break;
      if (scale.bytes) {
        append_number(out_, none ? 255 : clamped_byte(colour[k]), ScalarType::uint8);
      } else {
        append_fraction(out_, none ? 1 : colour[k] / scale.divisor);
      }
      out_ += ' ';
    }
    return true;
  }

  void put_number(double value, ScalarType type) {
    append_number(out_, value, type);
    out_ += ' ';
  }

  const Mesh& mesh_;
  const Context& context_;
  const Attribute* normal_;
  const Attribute* vertex_colour_;
  const Attribute* uv_;
  const Attribute* face_colour_;
  const Attribute* index_;
  std::string out_;
};

}  // namespace

Written write_off(const Mesh& mesh, const std::filesystem::path&, const WriteOptions&, const Context& context) {
  const auto* document = dynamic_cast<const OffDocument*>(mesh.source.get());
  const bool unchanged = document != nullptr && document->has_topology_of(mesh);
  if (unchanged) return {OffPatcher(*document, mesh, context).patch()};
  return OffComposer(mesh, context).compose();
}

}  // namespace meshgraft::io
