#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "io/file_document.h"

namespace meshgraft::io {

/// An OBJ file as it was read. The text itself is the record of everything; a writer copies it with new
/// numbers in its v and vn lines.
struct ObjDocument : FileDocument {
  std::string content;
  std::vector<double> normals;        ///< 3 per vn line
  std::vector<Index> corner_normals;  ///< the vn line of each corner, -1 for none; empty if no face has any

  std::vector<std::string> beside_the_mesh() const override;
};

/// Walks over the lines of an OBJ file and the words in them. Lines end in LF, CRLF or CR; a backslash before
/// the end continues a line (except a comment); '#' before a word makes the rest a comment.
class ObjCursor {
 public:
  explicit ObjCursor(std::string_view content);

  /// Moves to the next line that is not empty, and reads its keyword. False at the end of the file.
  bool next_line();

  /// The keyword of the line; empty for a comment.
  std::string_view keyword() const { return keyword_; }

  /// The next word of the line; empty where there is none.
  std::string_view next_word();

  /// The rest of the line without surrounding blanks, for names may contain spaces; up to the backslash where
  /// the line is continued.
  std::string_view rest_of_line();

  std::size_t line_begin() const { return line_begin_; }
  std::size_t offset() const { return offset_; }
  std::size_t word_begin() const { return word_begin_; }

  /// Moves behind the end of the line, unless it is there already.
  void finish_line();

 private:
  void skip_blanks();
  bool begins_comment() const;            ///< at `offset_`
  std::size_t continuation_size() const;  ///< of a backslash and line end at `offset_`; 0 if there is none

  std::string_view content_;
  std::size_t offset_ = 0;
  std::size_t line_begin_ = 0;
  std::size_t word_begin_ = 0;
  std::string_view keyword_;
  bool line_open_ = false;
};

/// The indices of one corner of a face, as written: 0 where a part is missing.
struct ObjCorner {
  std::int64_t vertex = 0;
  std::int64_t uv = 0;
  std::int64_t normal = 0;
  bool has_uv = false;
  bool has_normal = false;
  std::size_t normal_begin = 0;  ///< of the third part, within the word
};

/// Parses "v", "v/vt", "v//vn" or "v/vt/vn". False where the word is nothing of the kind.
bool parse_obj_corner(std::string_view word, ObjCorner& corner);

/// True for the keywords of faces (fo is their old name).
inline bool is_face_keyword(std::string_view keyword) { return keyword == "f" || keyword == "fo"; }

}  // namespace meshgraft::io
