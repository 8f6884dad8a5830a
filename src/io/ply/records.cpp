#include "records.h"

#include <limits>
#include <string>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "io/binary_value.h"
#include "io/charged.h"
#include "io/check_interval.h"
#include "io/facts.h"
#include "io/number_text.h"

namespace meshgraft::io {

namespace {

constexpr std::size_t rows_per_block = 1 << 13;  // rows read at once; a block fits the second-level cache

class RecordReader {
 public:
  RecordReader(const PlyDocument& document, const Context& context)
      : document_(document), name_(document.path.string()), context_(context) {}

  std::size_t read(const PlyElement& element, std::size_t offset, PlySinks& sinks) const {
    const PlyEncoding encoding = document_.header.encoding;
    if (element.properties.empty()) return offset;  // a header can announce two billion of these
    if (encoding == PlyEncoding::ascii) {
      PlyTextCursor cursor(document_.content, offset, name_);
      return read_rows(element, cursor, sinks);
    }
    if (!element.has_lists()) return read_columns(element, offset, sinks);
    if (const auto end = read_polygons(element, offset, sinks)) return *end;
    PlyBinaryCursor cursor(document_.content, offset, needs_swap(encoding), name_);
    return read_rows(element, cursor, sinks);
  }

 private:
  /// Reads binary records of one size, a block of rows at a time.
  std::size_t read_columns(const PlyElement& element, std::size_t offset, const PlySinks& sinks) const {
    const std::size_t record = element.smallest_binary_size();
    const std::size_t count = element.count;
    if (record != 0 && count > (document_.content.size() - offset) / record) {
      const std::size_t read = (document_.content.size() - offset) / record;
      throw Error(facts::io::TruncatedRecords{.element = element.name, .read = read, .count = count},
                  Location::file(name_));
    }
    const bool swap = needs_swap(document_.header.encoding);
    const char* const records = document_.content.data() + offset;
    const auto read_block = [&](std::size_t begin, std::size_t end) {
      const char* column = records + begin * record;
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const ScalarType type = element.properties[p].type;
        const PlyTarget target = sinks.scalars[p];
        if (target.values != nullptr) {
          load_binary_column({column, record, type, swap}, end - begin, target.values + begin * target.stride,
                             target.stride);
        }
        column += size_of(type);
      }
    };
    parallel_blocks(count, read_block, context_, rows_per_block);
    return offset + count * record;
  }

  /// Reads binary faces whose one list is that of their corners, without a look at the type of every value.
  /// Returns nothing for other elements and on any error. Reading row by row then finds the location of the
  /// error.
  std::optional<std::size_t> read_polygons(const PlyElement& element, std::size_t offset,
                                           PlySinks& sinks) const {
    if (!sinks.corners || !sinks.lists.empty()) return std::nullopt;
    const bool swap = needs_swap(document_.header.encoding);
    const PlyProperty& list = element.properties[*sinks.corners];
    const std::size_t fixed = element.smallest_binary_size();
    std::size_t before_list = 0;
    for (std::size_t p = 0; p < *sinks.corners; ++p) before_list += size_of(element.properties[p].type);

    std::vector<Index> corners;
    const char* at = document_.content.data() + offset;
    const char* const end = document_.content.data() + document_.content.size();
    for (std::size_t row = 0; row < element.count; ++row) {
      if (row % elements_per_check == 0) context_.throw_if_stopped();
      const auto left = static_cast<std::size_t>(end - at);
      const std::optional<std::size_t> length =
          left < fixed
              ? std::nullopt
              : load_binary_length(at + before_list, list, swap, left - fixed, sinks.faces->corner_count());
      if (length) corners.resize(*length);
      if (!length ||
          !load_binary_corners(at + before_list + size_of(list.count_type), list.type, swap, corners)) {
        free_charged(*sinks.faces, sinks.budget);
        return std::nullopt;
      }
      push_charged(*sinks.faces, corners, sinks.budget);
      if (element.properties.size() > 1) read_scalars(element, at, row, *length, sinks);
      at += fixed + *length * size_of(list.type);
    }
    return offset + static_cast<std::size_t>(at - (document_.content.data() + offset));
  }

  /// Returns the length of a list of corners. Returns nothing if it is negative, or exceeds the bytes left or
  /// the largest index.
  static std::optional<std::size_t> load_binary_length(const char* at, const PlyProperty& list, bool swap,
                                                       std::size_t bytes_left, Index corners_before) {
    const double length = load_binary(at, list.count_type, swap);
    const std::size_t most = bytes_left / size_of(list.type);
    if (length < 0 || length > static_cast<double>(most)) return std::nullopt;
    if (length > std::numeric_limits<Index>::max() - corners_before) return std::nullopt;
    return static_cast<std::size_t>(length);
  }

  /// Reads the values of a record whose one list has `list_length` values.
  void read_scalars(const PlyElement& element, const char* at, std::size_t row, std::size_t list_length,
                    const PlySinks& sinks) const {
    const bool swap = needs_swap(document_.header.encoding);
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (property.is_list) {
        at += size_of(property.count_type) + list_length * size_of(property.type);
        continue;
      }
      const PlyTarget target = sinks.scalars[p];
      if (target.values != nullptr) target.values[row * target.stride] = load_binary(at, property.type, swap);
      at += size_of(property.type);
    }
  }

  /// Reads records one after another, for ascii files and for lists.
  template <class Cursor>
  std::size_t read_rows(const PlyElement& element, Cursor& cursor, PlySinks& sinks) const {
    std::vector<PlyListValues*> list_of(element.properties.size(), nullptr);
    for (PlyListValues& list : sinks.lists) list_of[list.property] = &list;
    std::vector<Index> corners;
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (row % elements_per_check == 0) context_.throw_if_stopped();
      cursor.begin_record(element, row);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!property.is_list) {
          const double value = cursor.scalar(property, property.type);
          const PlyTarget target = sinks.scalars[p];
          if (target.values != nullptr) target.values[row * target.stride] = value;
          continue;
        }
        const std::size_t length = read_list_length(cursor, property);
        if (p == sinks.corners) {
          read_corners(cursor, property, length, corners);
          push_face(cursor, corners, sinks);
        } else {
          PlyListValues* const list = list_of[p];
          for (std::size_t k = 0; k < length; ++k) {
            const double value = cursor.scalar(property, property.type);
            if (list != nullptr) push_charged(list->values, value, sinks.budget);
          }
          if (list != nullptr) push_charged(list->lengths, static_cast<std::uint32_t>(length), sinks.budget);
        }
      }
      cursor.end_record();
    }
    return cursor.offset();
  }

  template <class Cursor>
  static void read_corners(Cursor& cursor, const PlyProperty& property, std::size_t length,
                           std::vector<Index>& corners) {
    corners.clear();
    for (std::size_t k = 0; k < length; ++k) {
      const double index = cursor.scalar(property, property.type);
      if (index > std::numeric_limits<Index>::max())
        cursor.fail(facts::io::IndexTooLarge{.index = static_cast<std::int64_t>(index)});
      corners.push_back(static_cast<Index>(index));
    }
  }

  template <class Cursor>
  static void push_face(Cursor& cursor, const std::vector<Index>& corners, const PlySinks& sinks) {
    const auto room = static_cast<std::size_t>(std::numeric_limits<Index>::max() - sinks.faces->corner_count());
    if (corners.size() > room)
      cursor.fail(facts::io::TooMany{.elements = facts::io::Elements::corners,
                                     .most = std::numeric_limits<Index>::max()});
    push_charged(*sinks.faces, corners, sinks.budget);
  }

  const PlyDocument& document_;
  const std::string name_;
  const Context& context_;
};

}  // namespace

std::size_t read_ply_records(const PlyDocument& document, const PlyElement& element, std::size_t offset,
                             PlySinks& sinks, const Context& context) {
  return RecordReader(document, context).read(element, offset, sinks);
}

}  // namespace meshgraft::io
