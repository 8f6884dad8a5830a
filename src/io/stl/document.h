#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "io/file_document.h"
#include "io/word_cursor.h"

namespace meshgraft::io {

/// The face attribute for the two bytes behind each facet of a binary file. Some programs put a colour there.
inline constexpr std::string_view stl_attribute = "attribute";

/// An STL file as it was read. It keeps the file's bytes. A writer copies them and changes the corners that
/// moved.
struct StlDocument : FileDocument {
  std::string content;
  bool ascii = false;

  std::string_view format() const override { return "STL"; }
  /// Printers and their programs take z.
  std::optional<UpAxis> stated_up_axis() const override { return UpAxis::z; }
  UpAxis usual_up_axis() const override { return UpAxis::z; }
  std::vector<Note> beside_the_mesh() const override { return {}; }
};

/// The layout of a binary file, in bytes: a free header of 80 bytes, the number of facets, and 50 bytes per
/// facet. A facet holds the normal, three corners (single precision, little endian) and two free bytes.
namespace stl_layout {
inline constexpr std::size_t header = 80;
inline constexpr std::size_t first_facet = 84;
inline constexpr std::size_t facet = 50;
inline constexpr std::size_t corner = 12;
inline constexpr std::size_t attribute = 48;
}  // namespace stl_layout

using FloatPoint = std::array<float, 3>;

std::uint32_t load_stl_count(std::string_view content);
FloatPoint load_stl_point(const char* at);
void store_stl_point(char* at, const FloatPoint& point);
std::uint16_t load_stl_attribute(const char* at);
void store_stl_attribute(char* at, std::uint16_t value);

/// A facet of an ascii file: the normal, then three corners.
struct StlFacetText {
  std::array<double, 12> values;
  std::array<std::string_view, 12> words;  ///< views of the content
};

/// Walks over the facets of an ascii file. Keywords may be in any case, and lines may break anywhere.
class StlTextCursor {
 public:
  StlTextCursor(std::string_view content, const std::string& name)
      : words_(content, name, WordCursor::Comments::none) {}

  /// Reads the next facet. Returns false at the end of the file. Throws Error(input) naming the line.
  bool next_facet(StlFacetText& facet);

  /// Return the number of solids so far and the name of the last one.
  std::size_t solid_count() const { return solid_count_; }
  const std::string& solid_name() const { return solid_name_; }
  std::size_t offset() const { return words_.offset(); }

 private:
  bool next_solid();
  void expect(std::string_view keyword);
  [[noreturn]] void fail_keyword(std::string_view word, std::initializer_list<std::string_view> expected) const;

  WordCursor words_;
  std::size_t solid_count_ = 0;
  std::string solid_name_;
  bool in_solid_ = false;
};

bool is_stl_keyword(std::string_view word, std::string_view keyword);

}  // namespace meshgraft::io
