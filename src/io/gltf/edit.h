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

/// New values of elements of an accessor, by element: as stored after rounding.
using GltfChanges = std::map<std::size_t, GltfValue>;

/// A glTF file being changed: its JSON and its buffers, copied only where something is written.
class GltfEdit {
 public:
  explicit GltfEdit(const GltfDocument& document);

  Json json;
  std::vector<std::string> notes;
  std::vector<std::filesystem::path> inputs;  ///< that no new buffer may replace, beside the document's own

  JsonView view() const { return JsonView(json, "", name_); }
  GltfBytes bytes() const;
  GltfAccessor accessor(std::size_t index) const { return resolve_accessor(view(), index, bytes()); }

  /// Whether every value has a byte of its own and fits the accessor's type.
  static bool can_store(const GltfAccessor& accessor, const GltfChanges& changes);

  /// Writes values where they are stored, and the accessor's min and max where it has them.
  void store(std::size_t accessor_index, const GltfChanges& changes);

  /// A dense copy of an accessor with these changes at the end of a buffer; as floats where its type cannot
  /// hold one of them.
  std::size_t store_copy(std::size_t accessor_index, const GltfChanges& changes);

  /// A buffer view of new bytes, aligned to 4; `target` 0 for none.
  std::size_t append_view(std::string_view bytes, std::size_t stride = 0, int target = 0);

  /// An element at the end of one of the JSON's arrays, which is made where it is missing.
  std::size_t append(const char* array, Json value);

  /// The file at `path`, in the container of its extension, with what goes beside it.
  Written finish(const std::filesystem::path& path) const;

 private:
  std::string& writable(std::size_t buffer);
  std::size_t buffer_for_new_bytes();
  void refresh_bounds(std::size_t accessor_index);
  friend class GltfPacker;

  const GltfDocument& document_;
  const std::string name_;
  std::vector<std::optional<std::string>> changed_;  // buffers
};

void append_float(std::string& out, double value);

/// The JSON's min and max of a whole accessor, as they are stored: bounds that are right already keep their
/// numbers.
void set_bounds(Json& accessor_json, const GltfAccessor& accessor, const GltfBytes& bytes);

}  // namespace meshgraft::io
