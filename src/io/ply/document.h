#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "core/memory_budget.h"
#include "io/facts.h"
#include "io/file_document.h"

namespace meshgraft::io {

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::float32;
  bool is_list = false;
  ScalarType count_type = ScalarType::uint8;  ///< of a list's length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  /// Returns the size of one record in a binary file, in bytes. Lists count with their length alone.
  std::size_t smallest_binary_size() const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;  ///< text after "comment "
  std::size_t size = 0;               ///< bytes up to the first record
};

/// Parses the header. Throws Error(input) naming the line. The header's counts are checked against the size
/// of `content`, so they can be trusted for allocation. Charges what the lines become. `file_bytes` is the size
/// of the file if `content` is only its beginning.
PlyHeader parse_ply_header(std::string_view content, const std::string& name, MemoryBudget& budget,
                           std::optional<std::uint64_t> file_bytes = {});

/// The destination of a property's values in a mesh: component `component` of an attribute. An empty name
/// means the positions. A list property holds all components of a face's corners.
struct PlyBinding {
  std::size_t property = 0;
  Domain domain = Domain::vertex;
  std::string attribute;
  int component = 0;
};

/// An element that has values in the mesh.
struct PlyTable {
  std::size_t element = 0;  ///< in the header
  std::vector<PlyBinding> bindings;
};

/// A PLY file as it was read. It keeps the file's bytes. A writer copies them and patches the values that
/// differ.
struct PlyDocument : FileDocument {
  std::string content;
  PlyHeader header;
  std::vector<std::size_t> element_begin;  ///< first byte of each element's records, then the end
  std::vector<PlyTable> tables;            ///< vertices, faces
  ScalarType position_type = ScalarType::float64;

  std::string_view format() const override { return "PLY"; }
  std::optional<UpAxis> stated_up_axis() const override;
  UpAxis usual_up_axis() const override { return UpAxis::y; }
  std::vector<Note> beside_the_mesh() const override;
};

/// Returns the images of the comments "TextureFile NAME" in their order. Missing images are included, because
/// the `texnumber` of faces counts them.
std::vector<std::filesystem::path> texture_files(const PlyDocument& document);

/// Returns whether the byte order of a binary file is not the machine's.
bool needs_swap(PlyEncoding encoding);

/// Walks over the values of an ascii body, one record per line. Line ends may be LF, CRLF or CR.
class PlyTextCursor {
 public:
  PlyTextCursor(std::string_view content, std::size_t offset, const std::string& name)
      : content_(content), offset_(offset), name_(name) {}

  void begin_record(const PlyElement& element, std::uint64_t row);
  double scalar(const PlyProperty& property, ScalarType type);
  void end_record();

  /// Skips blank lines. Returns true at the end of the file.
  bool at_end();

  std::size_t offset() const { return offset_; }
  std::size_t value_begin() const { return value_begin_; }  ///< start of the last value
  std::size_t remaining_values() const { return (content_.size() - offset_ + 1) / 2; }
  [[noreturn]] void fail(Fact fact) const;

 private:
  std::string_view content_;
  std::size_t offset_;
  std::size_t value_begin_ = 0;
  const std::string& name_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;
};

/// Walks over the values of a binary body.
class PlyBinaryCursor {
 public:
  PlyBinaryCursor(std::string_view content, std::size_t offset, bool swap, const std::string& name)
      : content_(content), offset_(offset), swap_(swap), name_(name) {}

  void begin_record(const PlyElement& element, std::uint64_t row) {
    element_ = &element;
    row_ = row;
  }
  double scalar(const PlyProperty& property, ScalarType type);
  void end_record() {}
  bool at_end() const { return offset_ == content_.size(); }

  std::size_t offset() const { return offset_; }
  std::size_t value_begin() const { return value_begin_; }
  std::size_t remaining_values() const { return content_.size() - offset_; }
  [[noreturn]] void fail(Fact fact) const;

 private:
  std::string_view content_;
  std::size_t offset_;
  std::size_t value_begin_ = 0;
  bool swap_;
  const std::string& name_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;
};

/// Reads and checks a list's length: it is not negative, and no larger than the file can hold.
template <class Cursor>
std::size_t read_list_length(Cursor& cursor, const PlyProperty& property) {
  const double length = cursor.scalar(property, property.count_type);
  if (!(length >= 0 && length <= static_cast<double>(cursor.remaining_values())))
    cursor.fail(facts::io::BadLength{
        .list = property.name, .length = static_cast<std::int64_t>(length), .most = cursor.remaining_values()});
  return static_cast<std::size_t>(length);
}

}  // namespace meshgraft::io
