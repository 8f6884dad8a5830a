#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "document.h"
#include "io/format.h"

namespace meshgraft::io {

/// New values of an accessor's elements, by element, before they are rounded to the stored type.
using GltfChanges = std::map<std::size_t, GltfValue>;

/// A glTF file being changed: its JSON and its buffers. A buffer is copied only when it is written to.
class GltfEdit {
 public:
  explicit GltfEdit(const GltfDocument& document);

  Json json;
  std::vector<Note> notes;
  std::vector<std::filesystem::path> inputs;  ///< no new buffer may replace these or the document's own

  JsonView view() const { return JsonView(json, "", name_); }
  GltfBytes bytes() const;
  GltfAccessor accessor(std::size_t index) const { return resolve_accessor(view(), index, bytes()); }

  /// Returns whether every element has bytes of its own and every value fits the accessor's type.
  static bool can_store(const GltfAccessor& accessor, const GltfChanges& changes);

  /// Overwrites the values in the buffers. Updates the accessor's min and max if it has them.
  void store(std::size_t accessor_index, const GltfChanges& changes);

  /// Appends a dense copy of an accessor with these changes. It has floats if the accessor's type cannot hold
  /// one of the values. Returns the index of the new accessor.
  std::size_t store_copy(std::size_t accessor_index, const GltfChanges& changes);

  /// Appends a buffer view of new bytes, aligned to 4 bytes. `target` is 0 for none. Returns its index.
  std::size_t append_view(std::string_view bytes, std::size_t stride = 0, int target = 0);

  /// Appends an element to one of the JSON's arrays, which is created if it is missing. Returns its index.
  std::size_t append(const char* array, Json value);

  /// Composes the file for `path`, in the container of its extension, with the files beside it.
  Written finish(const std::filesystem::path& path) const;

 private:
  std::string& writable(std::size_t buffer);
  std::size_t buffer_for_new_bytes();
  void refresh_bounds(std::size_t accessor_index);
  friend class GltfPacker;

  const GltfDocument& document_;
  const std::string name_;
  std::vector<std::optional<std::string>> changed_;  // per buffer: its new bytes, if it was changed
};

void append_float(std::string& out, double value);

/// Sets min and max in the JSON to the bounds of a whole accessor, as stored. Bounds that are right already
/// keep their text.
void set_bounds(Json& accessor_json, const GltfAccessor& accessor, const GltfBytes& bytes);

}  // namespace meshgraft::io
