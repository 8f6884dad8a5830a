#include <meshgraft/core/error.h>

#include <algorithm>
#include <utility>

namespace meshgraft {

namespace {

using Kind = LocationPart::Kind;

std::string text_of(const LocationPart& part) {
  switch (part.kind) {
    case Kind::element: return "[" + std::to_string(part.index) + "]";
    case Kind::handle: return "handle '" + part.name + "'";
    case Kind::pair: return "pair " + std::to_string(part.index);
    case Kind::file:
    case Kind::field:
    case Kind::place: return part.name;
  }
  return part.name;
}

std::string_view separator(Kind outer, Kind inner) {
  const bool in_file = outer == Kind::file || outer == Kind::place;
  if (inner == Kind::field && !in_file) return ".";
  if (inner == Kind::element && !in_file) return "";
  if (inner == Kind::place && in_file) return ", ";
  return ": ";
}

}  // namespace

Location::Location(const char* field) : Location(LocationPart{Kind::field, field}) {}
Location::Location(const std::filesystem::path& file) : Location(LocationPart{Kind::file, file.string()}) {}

Location Location::file(std::string name) { return Location({Kind::file, std::move(name)}); }
Location Location::field(std::string name) { return Location({Kind::field, std::move(name)}); }
Location Location::handle(std::string name) { return Location({Kind::handle, std::move(name)}); }
Location Location::pair(std::size_t index) { return Location({Kind::pair, {}, index}); }
Location Location::place(std::string text) { return Location({Kind::place, std::move(text)}); }

Location Location::operator/(const Location& inner) const {
  Location location = *this;
  location.parts_.insert(location.parts_.end(), inner.parts_.begin(), inner.parts_.end());
  return location;
}

Location Location::operator[](std::size_t index) const {
  return *this / Location(LocationPart{Kind::element, {}, index});
}

Location Location::from(std::size_t first) const {
  Location location;
  location.parts_.assign(parts_.begin() + static_cast<std::ptrdiff_t>(std::min(first, parts_.size())),
                         parts_.end());
  return location;
}

bool Location::starts_with(const Location& outer) const {
  return parts_.size() >= outer.parts_.size() &&
         std::equal(outer.parts_.begin(), outer.parts_.end(), parts_.begin());
}

std::string Location::text() const {
  std::string text;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (i > 0) text += separator(parts_[i - 1].kind, parts_[i].kind);
    text += text_of(parts_[i]);
  }
  return text;
}

}  // namespace meshgraft
