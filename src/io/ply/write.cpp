#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "core/platform/memory.h"
#include "document.h"
#include "io/binary_value.h"
#include "io/check_interval.h"
#include "io/facts.h"
#include "io/number_text.h"
#include "io/obj/materials.h"
#include "io/unwritten.h"
#include "io/up_axis_comment.h"
#include "ply.h"

namespace meshgraft::io {

namespace {

/// The mesh's values for one property of the file.
struct Column {
  const double* values = nullptr;  ///< null: the file's values stay
  std::size_t stride = 0;          ///< from one row (one corner, for lists) to the next
};

std::string_view type_name(ScalarType type) {
  switch (type) {
    case ScalarType::int8: return "char";
    case ScalarType::uint8: return "uchar";
    case ScalarType::int16: return "short";
    case ScalarType::uint16: return "ushort";
    case ScalarType::int32: return "int";
    case ScalarType::uint32: return "uint";
    case ScalarType::float32: return "float";
    case ScalarType::float64: break;
  }
  return "double";
}

/// Returns the value to be written in place of `old`, or nothing if `old` stays. Throws Error(input) if the
/// file's type cannot hold the new value.
std::optional<double> replacement(double old, double value, const PlyElement& element, std::uint64_t row,
                                  const PlyProperty& property) {
  if (same_value(old, value)) return std::nullopt;
  if (std::isnan(value) && is_integer(property.type)) return std::nullopt;
  const ParsedNumber rounded = narrow(value, property.type);
  if (rounded.fault != NumberFault::none)
    throw Error(
        facts::io::ValueDoesNotFit{.property = property.name, .type = type_name(property.type), .value = value},
        Location::place(element.name + " " + std::to_string(row)));
  if (same_value(old, rounded.value)) return std::nullopt;
  return rounded.value;
}

/// Copies the file's bytes, with new values where the mesh differs from the file.
class PlyPatcher {
 public:
  PlyPatcher(const PlyDocument& document, const Mesh& mesh, const Context& context)
      : document_(document), mesh_(mesh), context_(context) {}

  std::string patch() {
    const bool ascii = document_.header.encoding == PlyEncoding::ascii;
    if (!ascii) copy_document();
    for (const PlyTable& table : document_.tables) {
      const PlyElement& element = document_.header.elements[table.element];
      const std::vector<Column> columns = columns_of(element, table);
      const std::size_t begin = document_.element_begin[table.element];
      if (ascii) {
        PlyTextCursor cursor(document_.content, begin, name_);
        patch_rows(element, columns, cursor);
      } else if (!element.has_lists()) {
        patch_columns(element, columns, begin);
      } else {
        PlyBinaryCursor cursor(document_.content, begin, swap(), name_);
        patch_rows(element, columns, cursor);
      }
    }
    if (ascii) copy_until(document_.content.size());
    return std::move(out_);
  }

 private:
  bool swap() const { return needs_swap(document_.header.encoding); }

  std::vector<Column> columns_of(const PlyElement& element, const PlyTable& table) const {
    std::vector<Column> columns(element.properties.size());
    if (element.count == 0) return columns;
    for (const PlyBinding& binding : table.bindings) {
      Column& column = columns[binding.property];
      if (binding.attribute.empty()) {
        column = {mesh_.positions.data() + binding.component, 3};
        continue;
      }
      const Attribute* attribute = mesh_.find_attribute(binding.domain, binding.attribute);
      if (attribute == nullptr || attribute->components <= binding.component) continue;
      const auto components = static_cast<std::size_t>(attribute->components);
      const std::size_t count = binding.domain == Domain::corner
                                    ? static_cast<std::size_t>(mesh_.faces.corner_count())
                                    : static_cast<std::size_t>(element.count);
      if (attribute->values.size() != count * components) continue;
      column = {attribute->values.data() + binding.component, components};
    }
    return columns;
  }

  void copy_document() {
    out_.reserve(document_.content.size());
    platform::prefer_huge_pages(out_.data(), out_.capacity());
    out_.append(document_.content);
  }

  /// Patches blocks of rows in parallel. If a value does not fit, the error is that of the first one in the
  /// order of the properties.
  void patch_columns(const PlyElement& element, const std::vector<Column>& columns, std::size_t begin) {
    std::atomic<bool> all_fit = true;
    constexpr std::size_t rows_per_block = 1 << 13;
    parallel_blocks(
        element.count,
        [&](std::size_t first, std::size_t last) {
          try {
            patch_rows_of_columns(element, columns, begin, {first, last});
          } catch (const Error&) {
            all_fit = false;
          }
        },
        context_, rows_per_block);
    if (!all_fit) patch_rows_of_columns(element, columns, begin, {0, element.count});
  }

  void patch_rows_of_columns(const PlyElement& element, const std::vector<Column>& columns, std::size_t begin,
                             std::array<std::size_t, 2> rows) {
    const std::size_t record = element.smallest_binary_size();
    char* at = out_.data() + begin;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (columns[p].values != nullptr) {
        for (std::size_t row = rows[0]; row < rows[1]; ++row) {
          const double old = load_binary(at + row * record, property.type, swap());
          const double value = columns[p].values[row * columns[p].stride];
          if (old == value) continue;
          if (const auto next = replacement(old, value, element, row, property))
            store_binary(at + row * record, *next, property.type, swap());
        }
      }
      at += size_of(property.type);
    }
  }

  template <class Cursor>
  void patch_rows(const PlyElement& element, const std::vector<Column>& columns, Cursor& cursor) {
    if (std::ranges::all_of(columns, [](const Column& column) { return column.values == nullptr; })) return;
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (row % elements_per_check == 0) context_.throw_if_stopped();
      cursor.begin_record(element, row);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        const Column column = columns[p];
        if (!property.is_list) {
          const double* value = column.values == nullptr ? nullptr : column.values + row * column.stride;
          patch_value(element, row, property, cursor, value);
          continue;
        }
        const double* values = nullptr;
        if (column.values != nullptr) {
          values = column.values +
                   static_cast<std::size_t>(mesh_.faces.first_corner(static_cast<Index>(row))) * column.stride;
        }
        const std::size_t length = read_list_length(cursor, property);
        for (std::size_t k = 0; k < length; ++k) {
          patch_value(element, row, property, cursor, values == nullptr ? nullptr : values + k);
        }
      }
      cursor.end_record();
    }
  }

  template <class Cursor>
  void patch_value(const PlyElement& element, std::uint64_t row, const PlyProperty& property, Cursor& cursor,
                   const double* value) {
    const double old = cursor.scalar(property, property.type);
    if (value == nullptr) return;
    if (const auto next = replacement(old, *value, element, row, property)) put(cursor, property, *next);
  }

  void put(const PlyTextCursor& cursor, const PlyProperty& property, double value) {
    copy_until(cursor.value_begin());
    append_number(out_, value, property.type);
    copied_ = cursor.offset();
  }

  void put(const PlyBinaryCursor& cursor, const PlyProperty& property, double value) {
    store_binary(out_.data() + cursor.value_begin(), value, property.type, swap());
  }

  void copy_until(std::size_t end) {
    out_.append(document_.content, copied_, end - copied_);
    copied_ = end;
  }

  const PlyDocument& document_;
  const Mesh& mesh_;
  const Context& context_;
  const std::string name_ = "source";  // the document was read once: its records cannot fail to parse
  std::string out_;
  std::size_t copied_ = 0;  // bytes of an ascii document copied so far
};

/// A property of a new file, and the source of its values.
struct NewProperty {
  std::string name;
  ScalarType type = ScalarType::float64;
  const Attribute* attribute = nullptr;  ///< null: the positions, or the corners of a face
  int component = 0;
  bool is_list = false;
  double scale = 1;  ///< factor from the mesh's values to the file's
};

/// Returns the property name that other programs look for.
std::string component_name(const Attribute& attribute, int component) {
  const auto k = static_cast<std::size_t>(component);
  if (attribute.domain != Domain::corner &&
      attribute.source_names.size() == static_cast<std::size_t>(attribute.components)) {
    return attribute.source_names[k];
  }
  constexpr std::array<std::string_view, 3> normal = {"nx", "ny", "nz"};
  constexpr std::array<std::string_view, 4> colour = {"red", "green", "blue", "alpha"};
  constexpr std::array<std::string_view, 2> uv = {"s", "t"};
  if (attribute.name == "normal" && k < normal.size()) return std::string(normal[k]);
  if (attribute.name == "colour" && k < colour.size()) return std::string(colour[k]);
  if (attribute.name == "uv" && k < uv.size()) return std::string(uv[k]);
  return attribute.components == 1 ? attribute.name : attribute.name + "_" + std::to_string(component);
}

/// Composes a binary little-endian file for a mesh without a PLY file behind it.
class PlyComposer {
 public:
  PlyComposer(const Mesh& mesh, ScalarType position_type, const Context& context)
      : mesh_(mesh), context_(context) {
    for (const std::string_view axis : {"x", "y", "z"}) {
      add_property(vertex_, std::string(axis), position_type, nullptr, static_cast<int>(vertex_.size()), false);
    }
    add_property(face_, "vertex_indices", ScalarType::int32, nullptr, 0, true);
    for (const Attribute& attribute : mesh.attributes) add_attribute(attribute);
  }

  std::string compose() {
    write_header();
    write_vertices();
    write_faces();
    return std::move(out_);
  }

 private:
  void add_attribute(const Attribute& attribute) {
    const auto components = static_cast<std::size_t>(attribute.components);
    if (attribute.domain == Domain::corner) {
      if (attribute.values.size() != static_cast<std::size_t>(mesh_.faces.corner_count()) * components) return;
      const std::string name = attribute.name == "uv" ? "texcoord" : attribute.name;
      return add_property(face_, name, attribute.type, &attribute, 0, true);
    }
    const bool of_vertex = attribute.domain == Domain::vertex;
    const auto count = static_cast<std::size_t>(of_vertex ? mesh_.vertex_count() : mesh_.face_count());
    if (attribute.values.size() != count * components) return;
    for (int k = 0; k < attribute.components; ++k) {
      add_property(of_vertex ? vertex_ : face_, component_name(attribute, k), attribute.type, &attribute, k,
                   false);
    }
    for (std::size_t k = 0; k < attribute.labels.size(); ++k) {
      labels_ += "comment label " + attribute.name + " " + std::to_string(k) + " " + attribute.labels[k] + "\n";
    }
  }

  /// Returns whether the attribute is a colour between 0 and 1 from a format without integer colours. Such
  /// colours become bytes, as PLY readers expect.
  static bool is_unit_colour(const Attribute* attribute) {
    return attribute != nullptr && attribute->name == "colour" && attribute->source_names.empty() &&
           !is_integer(attribute->type);
  }

  static void add_property(std::vector<NewProperty>& element, std::string name, ScalarType type,
                           const Attribute* attribute, int component, bool is_list) {
    std::replace_if(name.begin(), name.end(), [](unsigned char c) { return c <= 32; }, '_');
    while (name.empty() || std::ranges::any_of(element, [&](const NewProperty& p) { return p.name == name; })) {
      name += '_';
    }
    NewProperty property{std::move(name), type, attribute, component, is_list, 1.0};
    if (is_unit_colour(attribute)) {
      property.type = ScalarType::uint8;
      property.scale = 255;
    }
    element.push_back(std::move(property));
  }

  /// Returns the type of a list's length: a byte if that suffices, as most readers expect.
  ScalarType count_type(const NewProperty& property) const {
    std::size_t longest = 0;
    for (Index f = 0; f < mesh_.face_count(); ++f) longest = std::max(longest, mesh_.faces[f].size());
    if (property.attribute != nullptr) longest *= static_cast<std::size_t>(property.attribute->components);
    return longest <= 255 ? ScalarType::uint8 : ScalarType::uint32;
  }

  void write_header() {
    out_ = "ply\nformat binary_little_endian 1.0\n";
    if (const std::string_view comment = up_axis_comment(mesh_); !comment.empty())
      out_.append("comment ").append(comment) += '\n';
    out_ += labels_;
    write_element("vertex", mesh_.vertex_count(), vertex_);
    if (mesh_.face_count() > 0 || mesh_.vertex_count() == 0) write_element("face", mesh_.face_count(), face_);
    out_ += "end_header\n";
  }

  void write_element(const std::string& name, Index count, const std::vector<NewProperty>& properties) {
    out_ += "element " + name + " " + std::to_string(count) + "\n";
    for (const NewProperty& property : properties) {
      out_ += "property ";
      if (property.is_list) {
        out_ += "list ";
        out_ += type_name(count_type(property));
        out_ += ' ';
      }
      out_ += type_name(property.type);
      out_ += " " + property.name + "\n";
    }
  }

  void write_vertices() {
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      if (v % elements_per_check == 0) context_.throw_if_stopped();
      for (const NewProperty& property : vertex_) {
        const double value = property.attribute == nullptr
                                 ? mesh_.positions(v, property.component)
                                 : value_of(property, static_cast<std::size_t>(v), property.component);
        put(value, property, "vertex", v);
      }
    }
  }

  void write_faces() {
    std::vector<ScalarType> count_types;
    for (const NewProperty& property : face_) count_types.push_back(count_type(property));
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      if (f % elements_per_check == 0) context_.throw_if_stopped();
      for (std::size_t p = 0; p < face_.size(); ++p) {
        const NewProperty& property = face_[p];
        if (property.is_list && property.attribute == nullptr) {
          put_scalar(static_cast<double>(mesh_.faces[f].size()), count_types[p]);
          for (const Index corner : mesh_.faces[f]) put_scalar(corner, property.type);
        } else if (property.is_list) {
          put_corner_list(f, property, count_types[p]);
        } else {
          put(value_of(property, static_cast<std::size_t>(f), property.component), property, "face", f);
        }
      }
    }
  }

  /// Writes a list of corner values. The list is empty if the face's corners have no value.
  void put_corner_list(Index f, const NewProperty& property, ScalarType count_type) {
    const auto components = static_cast<std::size_t>(property.attribute->components);
    const std::size_t first = static_cast<std::size_t>(mesh_.faces.first_corner(f)) * components;
    const std::span<const double> values(property.attribute->values.data() + first,
                                         mesh_.faces[f].size() * components);
    if (std::ranges::all_of(values, [](double value) { return std::isnan(value); })) {
      return put_scalar(0, count_type);
    }
    put_scalar(static_cast<double>(values.size()), count_type);
    for (const double value : values) put(value * property.scale, property, "face", f);
  }

  static double value_of(const NewProperty& property, std::size_t row, int component) {
    const auto components = static_cast<std::size_t>(property.attribute->components);
    return property.scale * property.attribute->values[row * components + static_cast<std::size_t>(component)];
  }

  void put(double value, const NewProperty& property, const char* element, Index row) {
    if (is_integer(property.type) && std::isnan(value)) value = missing_value(property);
    if (is_unit_colour(property.attribute)) value = std::clamp(value, 0.0, 255.0);
    const ParsedNumber rounded = narrow(value, property.type);
    if (rounded.fault != NumberFault::none)
      throw Error(
          facts::io::ValueDoesNotFit{
              .property = property.name, .type = type_name(property.type), .value = value},
          Location::place(std::string(element) + " " + std::to_string(row)));
    put_scalar(rounded.value, property.type);
  }

  /// Returns the integer for a missing value, because integers have no NaN. Signed types, which labels have,
  /// use -1; the others use 0.
  static double missing_value(const NewProperty& property) {
    const bool is_signed = property.type == ScalarType::int8 || property.type == ScalarType::int16 ||
                           property.type == ScalarType::int32;
    return is_signed ? -1 : 0;
  }

  void put_scalar(double value, ScalarType type) {
    const std::size_t at = out_.size();
    out_.resize(at + size_of(type));
    store_binary(out_.data() + at, value, type, needs_swap(PlyEncoding::little_endian));
  }

  const Mesh& mesh_;
  const Context& context_;
  std::vector<NewProperty> vertex_;
  std::vector<NewProperty> face_;
  std::string labels_;
  std::string out_;
};

}  // namespace

Written write_ply(const Mesh& mesh, const std::filesystem::path&, const WriteOptions&, const Context& context) {
  const auto* document = dynamic_cast<const PlyDocument*>(mesh.source.get());
  const bool unchanged = document != nullptr && document->has_topology_of(mesh);
  const bool from_floats = document != nullptr && document->position_type == ScalarType::float32;
  Written written{
      unchanged
          ? PlyPatcher(*document, mesh, context).patch()
          : PlyComposer(mesh, from_floats ? ScalarType::float32 : ScalarType::float64, context).compose()};
  if (from_floats) note_coarse_coordinates(mesh, "this PLY file", written.notes);
  if (unchanged) return written;
  for (Note& note : left_out_notes(mesh)) written.notes.push_back(std::move(note));
  for (const std::string& library : material_libraries_of(mesh))
    written.notes.push_back(facts::io::MaterialsNamedOnly{.format = "PLY", .library = library});
  return written;
}

}  // namespace meshgraft::io
