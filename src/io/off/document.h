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

/// Consecutive values in the record of a vertex.
struct OffColumn {
  std::string_view attribute;  ///< empty: the position
  int components = 3;
};

/// An OFF file as it was read. It keeps the file's text. A writer copies the text with new numbers.
struct OffDocument : FileDocument {
  std::string content;
  std::size_t body = 0;                     ///< offset of the first vertex in the content
  std::vector<OffColumn> columns;           ///< of a vertex record, in the file's order
  std::optional<ScalarType> vertex_colour;  ///< uint8 (0–255) or float32 (0–1)
  std::optional<ScalarType> face_colour;
  bool has_face_index = false;

  std::string_view format() const override { return "OFF"; }
  std::optional<UpAxis> stated_up_axis() const override;
  UpAxis usual_up_axis() const override { return UpAxis::y; }
  std::vector<Note> beside_the_mesh() const override { return {}; }
};

/// Returns whether a word has digits without a point or an exponent. A colour of such words ranges from 0 to
/// 255.
bool is_spelled_whole(std::string_view word);

/// Returns the divisor that turns a face's colour in the file into values of the attribute. It is 255 for
/// whole numbers if other faces have fractions. If no number exceeds 1, the colour counts as fractions.
double off_colour_divisor(ScalarType attribute_type, bool whole, double largest);

/// The name of the attribute for a face colour of one value, an index into Geomview's colour map.
inline constexpr std::string_view off_colour_index = "colour_index";

}  // namespace meshgraft::io
