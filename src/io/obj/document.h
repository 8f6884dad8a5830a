#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "io/file_document.h"

namespace meshgraft::io {

/// An OBJ file as it was read. It keeps the file's text. A writer copies the text with new numbers in its v
/// and vn lines.
struct ObjDocument : FileDocument {
  std::string content;
  std::vector<double> normals;        ///< 3 values per vn line
  std::vector<Index> corner_normals;  ///< the vn line of each corner, -1 for none; empty if no face has any

  std::string_view format() const override { return "OBJ"; }
  std::optional<UpAxis> stated_up_axis() const override;
  UpAxis usual_up_axis() const override { return UpAxis::y; }
  std::vector<Note> beside_the_mesh() const override;
};

/// Walks over the lines of an OBJ file and their words. Lines end in LF, CRLF or CR. A backslash before the
/// line end continues a line (except a comment). '#' before a word makes the rest a comment.
class ObjCursor {
 public:
  explicit ObjCursor(std::string_view content);

  /// Moves to the next line that is not empty, and reads its keyword. Returns false at the end of the file.
  bool next_line();

  /// Returns the keyword of the line, which is empty for a comment.
  std::string_view keyword() const { return keyword_; }

  /// Returns the next word of the line, or an empty one at its end.
  std::string_view next_word();

  /// Returns the rest of the line without surrounding blanks, because names may contain spaces. If the line
  /// is continued, the rest ends at the backslash.
  std::string_view rest_of_line();

  std::size_t line_begin() const { return line_begin_; }
  std::size_t offset() const { return offset_; }
  std::size_t word_begin() const { return word_begin_; }

  /// Moves behind the end of the line, unless the cursor is there already.
  void finish_line();

 private:
  void skip_blanks();
  bool begins_comment() const;            ///< at `offset_`
  std::size_t continuation_size() const;  ///< size of a backslash and line end at `offset_`, or 0

  std::string_view content_;
  std::size_t offset_ = 0;
  std::size_t line_begin_ = 0;
  std::size_t word_begin_ = 0;
  std::string_view keyword_;
  bool line_open_ = false;
};

/// The indices of one corner of a face, as written. 0 if a part is missing.
struct ObjCorner {
  std::int64_t vertex = 0;
  std::int64_t uv = 0;
  std::int64_t normal = 0;
  bool has_uv = false;
  bool has_normal = false;
  std::size_t normal_begin = 0;  ///< offset of the third part within the word
};

/// Parses "v", "v/vt", "v//vn" or "v/vt/vn". Returns false if the word has none of these forms.
bool parse_obj_corner(std::string_view word, ObjCorner& corner);

/// Returns whether the keyword is that of a face. "fo" is its old name.
inline bool is_face_keyword(std::string_view keyword) { return keyword == "f" || keyword == "fo"; }

}  // namespace meshgraft::io
