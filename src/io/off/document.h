#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "io/file_document.h"
#include "io/word_cursor.h"

namespace meshgraft::io {

/// Values that follow each other in the record of a vertex.
struct OffColumn {
  std::string_view attribute;  ///< empty: the position
  int components = 3;
};

/// An OFF file as it was read. The text itself is the record of everything; a writer copies it with new
/// numbers.
struct OffDocument : FileDocument {
  std::string content;
  std::size_t body = 0;                     ///< of the first vertex in the content
  std::vector<OffColumn> columns;           ///< of a vertex, in the file's order
  std::optional<ScalarType> vertex_colour;  ///< uint8 (0–255) or float32 (0–1)
  std::optional<ScalarType> face_colour;
  bool has_face_index = false;

  std::vector<std::string> beside_the_mesh() const override { return {}; }
};

/// True for digits without a point or an exponent: a colour so written counts to 255.
bool is_spelled_whole(std::string_view word);

/// What a face's colour in the file is divided by to become a value of the attribute: 255 for whole numbers
/// where other faces have fractions. A 1 among fractions is a fraction.
double off_colour_divisor(ScalarType attribute_type, bool whole, double largest);

/// How a face's colour of so many values is called: an index into Geomview's colour map, or a colour.
inline constexpr std::string_view off_colour_index = "colour_index";

}  // namespace meshgraft::io
