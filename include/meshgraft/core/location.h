#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshgraft {

/// A part of a location.
struct LocationPart {
  enum class Kind {
    file,     ///< a file or a named part of one, by its name: "edit.json"
    field,    ///< a field of a document or of options, by its name: "size"
    element,  ///< an element of a list, by its index from 0: "[2]"
    handle,   ///< a handle, by its name: "handle 'nose'"
    pair,     ///< a pair of boundary loops, by its index from 0: "pair 1"
    place,    ///< a place that is named by a text of its own: "line 3", "vertex 7"
  };
  Kind kind;
  std::string name{};     ///< of file, field, handle and place
  std::size_t index = 0;  ///< of element and pair

  friend bool operator==(const LocationPart&, const LocationPart&) = default;
};

/// Tells where an error is: parts from the outermost to the innermost, e.g. a file, a list of it, an element, a
/// field. It may be empty. A front end may rename or leave out parts before it shows them.
class Location {
 public:
  Location() = default;
  /// A field of options or of a document.
  Location(const char* field);
  /// A file.
  Location(const std::filesystem::path& file);

  static Location file(std::string name);
  static Location field(std::string name);
  static Location handle(std::string name);
  static Location pair(std::size_t index);
  static Location place(std::string text);

  /// Returns the location `inner` within this one.
  Location operator/(const Location& inner) const;
  /// Returns the element `index` of the list at this location.
  Location operator[](std::size_t index) const;
  /// Returns the parts from `first` on: the location within the first ones.
  Location from(std::size_t first) const;
  bool starts_with(const Location& outer) const;

  bool empty() const noexcept { return parts_.empty(); }
  const std::vector<LocationPart>& parts() const noexcept { return parts_; }
  /// Returns e.g. "edit.json: steps[2].handles[0].pose" or "edit.json: steps[2]: handle 'nose'".
  std::string text() const;

  friend bool operator==(const Location&, const Location&) = default;

 private:
  explicit Location(LocationPart part) { parts_.push_back(std::move(part)); }

  std::vector<LocationPart> parts_;
};

}  // namespace meshgraft
