#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>
#include <unordered_map>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/platform/memory.h"
#include "document.h"
#include "io/charged.h"
#include "io/check_interval.h"
#include "io/facts.h"
#include "point_index.h"
#include "stl.h"

namespace meshgraft::io {

namespace {

/// Returns whether the size is that of a binary file. Many binary files begin with "solid", so only the size
/// tells them from ascii files.
bool has_binary_size(std::string_view content) {
  if (content.size() < stl_layout::first_facet) return false;
  const std::uint64_t body = content.size() - stl_layout::first_facet;
  return body == std::uint64_t{load_stl_count(content)} * stl_layout::facet;
}

bool begins_with_solid(std::string_view content) {
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  content.remove_prefix(std::min(content.find_first_not_of(" \t\r\n"), content.size()));
  return is_stl_keyword(content.substr(0, 5), "solid") &&
         (content.size() == 5 || std::string_view(" \t\r\n").find(content[5]) != std::string_view::npos);
}

bool is_text(std::string_view content) { return content.find('\0') == std::string_view::npos; }

/// Swaps the byte order on big-endian machines.
template <class Bits>
Bits little_endian(Bits bits) {
  if constexpr (std::endian::native == std::endian::big) {
    auto bytes = std::bit_cast<std::array<char, sizeof(Bits)>>(bits);
    std::ranges::reverse(bytes);
    return std::bit_cast<Bits>(bytes);
  }
  return bits;
}

template <class Bits>
Bits load(const char* at) {
  Bits bits;
  std::memcpy(&bits, at, sizeof bits);
  return little_endian(bits);
}

template <class Bits>
void store(char* at, Bits bits) {
  bits = little_endian(bits);
  std::memcpy(at, &bits, sizeof bits);
}

class StlReader {
 public:
  StlReader(std::string content, const std::string& name, MemoryBudget& budget, const Context& context)
      : name_(name), budget_(budget), context_(context), document_(std::make_shared<StlDocument>()) {
    document_->content = std::move(content);
    document_->path = name;
  }

  Mesh read() {
    const std::string_view content = document_->content;
    if (has_binary_size(content)) {
      read_binary();
    } else if (begins_with_solid(content) && is_text(content)) {
      document_->ascii = true;
      read_ascii();
    } else {
      fail_size();
    }
    document_->remember_topology(mesh_);
    mesh_.source = std::move(document_);
    return std::move(mesh_);
  }

 private:
  void read_binary() {
    const std::size_t count = load_stl_count(document_->content);
    if (count > max_facets) fail_too_large();
    reserve_charged(mesh_.faces, count, 3 * count, budget_);
    platform::prefer_huge_pages(mesh_.faces.corners().data(), 3 * count);
    platform::prefer_huge_pages(mesh_.faces.offsets().data(), mesh_.faces.offsets().capacity());
    PointIndex<float> points(count / 2 + 3,
                             budget_);  // a closed surface has half as many vertices as triangles
    const char* facet = document_->content.data() + stl_layout::first_facet;
    constexpr std::size_t block = 64;
    std::array<FloatPoint, 3 * block> block_points;
    std::array<Index, 3 * block> corners;
    for (std::size_t begin = 0; begin < count; begin += block) {
      if (begin % elements_per_check == 0) report_progress(begin, count);
      const std::size_t size = std::min(block, count - begin);
      for (std::size_t f = 0; f < size; ++f, facet += stl_layout::facet) {
        for (std::size_t c = 0; c < 3; ++c)
          block_points[3 * f + c] = load_stl_point(facet + (c + 1) * stl_layout::corner);
      }
      points.add({block_points.data(), 3 * size}, corners.data());
      for (std::size_t f = 0; f < size; ++f) mesh_.faces.push_back({corners.data() + 3 * f, 3});
    }
    mesh_.positions = points.take();
    add_attribute(count);
  }

  /// Adds the attribute of the bytes behind each facet. In most files they are zero, and then there is no
  /// attribute.
  void add_attribute(std::size_t count) {
    const char* first = document_->content.data() + stl_layout::first_facet + stl_layout::attribute;
    std::vector<double> values;
    for (std::size_t f = 0; f < count; ++f) {
      const std::uint16_t value = load_stl_attribute(first + f * stl_layout::facet);
      if (value == 0 && values.empty()) continue;
      resize_charged(values, count, 0.0, budget_);
      values[f] = value;
    }
    if (!values.empty()) add_face_values(std::string(stl_attribute), ScalarType::uint16, std::move(values));
  }

  void read_ascii() {
    StlTextCursor cursor(document_->content, name_);
    PointIndex<double> points(0, budget_);
    std::vector<double> objects;
    std::vector<std::string> names;
    std::unordered_map<std::string, double> object_of;
    double object = 0;
    std::size_t solids = 0;
    StlFacetText facet;
    while (cursor.next_facet(facet)) {
      if (objects.size() % elements_per_check == 0) report_progress(cursor.offset(), document_->content.size());
      if (objects.size() == max_facets) fail_too_large();
      if (cursor.solid_count() != solids) {
        solids = cursor.solid_count();
        const std::string solid =
            cursor.solid_name().empty() ? "solid_" + std::to_string(solids) : cursor.solid_name();
        if (!object_of.contains(solid)) budget_.charge(bytes_of(solid));
        const auto [entry, is_new] = object_of.try_emplace(solid, static_cast<double>(names.size()));
        if (is_new) names.push_back(solid);
        object = entry->second;
      }
      std::array<std::array<double, 3>, 3> corners;
      for (std::size_t k = 0; k < 9; ++k) corners[k / 3][k % 3] = facet.values[3 + k];
      std::array<Index, 3> numbers;
      points.add(corners, numbers.data());
      push_charged(mesh_.faces, numbers, budget_);
      push_charged(objects, object, budget_);
    }
    mesh_.positions = points.take();
    if (cursor.solid_count() < 2) return;
    add_face_values("object", ScalarType::int32, std::move(objects)).labels = std::move(names);
  }

  Attribute& add_face_values(std::string attribute_name, ScalarType type, std::vector<double> values) {
    Attribute attribute;
    attribute.name = std::move(attribute_name);
    attribute.domain = Domain::face;
    attribute.interpolation = Interpolation::nearest;
    attribute.type = type;
    attribute.values = std::move(values);
    return mesh_.attributes.emplace_back(std::move(attribute));
  }

  [[noreturn]] void fail_size() const {
    const std::string_view content = document_->content;
    if (is_text(content))
      throw Error(facts::io::NotThisFormat{.format = "ascii STL", .beginning = "solid"},
                  Location::file(name_) / Location::place("line 1"));
    if (content.size() < stl_layout::first_facet)
      throw Error(
          facts::io::TruncatedHeader{
              .format = "binary STL", .needed = stl_layout::first_facet, .size = content.size()},
          Location::file(name_));
    const std::uint64_t count = load_stl_count(content);
    const std::uint64_t needed = stl_layout::first_facet + count * stl_layout::facet;
    throw Error(facts::io::WrongSize{.count = count, .needed = needed, .size = content.size()},
                Location::file(name_) / Location::place("byte " + std::to_string(stl_layout::header)));
  }

  [[noreturn]] void fail_too_large() const {
    throw Error(
        facts::io::TooMany{.elements = facts::io::Elements::corners, .most = std::numeric_limits<Index>::max()},
        Location::file(name_));
  }

  void report_progress(std::size_t done, std::size_t of) const {
    context_.step("read", static_cast<double>(done) / static_cast<double>(of));
  }

  static constexpr std::size_t max_facets = std::numeric_limits<Index>::max() / 3;

  const std::string& name_;
  MemoryBudget& budget_;
  const Context& context_;
  std::shared_ptr<StlDocument> document_;
  Mesh mesh_;
};

}  // namespace

Format stl_format() {
  static constexpr std::array<std::string_view, 1> extensions = {".stl"};
  return {"STL", extensions, has_stl_signature, read_stl, write_stl};
}

bool has_stl_signature(std::string_view content) {
  return has_binary_size(content) || (begins_with_solid(content) && is_text(content.substr(0, 1024)));
}

std::uint32_t load_stl_count(std::string_view content) {
  return load<std::uint32_t>(content.data() + stl_layout::header);
}

FloatPoint load_stl_point(const char* at) {
  FloatPoint point;
  for (std::size_t axis = 0; axis < 3; ++axis)
    point[axis] = std::bit_cast<float>(load<std::uint32_t>(at + 4 * axis));
  return point;
}

void store_stl_point(char* at, const FloatPoint& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) store(at + 4 * axis, std::bit_cast<std::uint32_t>(point[axis]));
}

std::uint16_t load_stl_attribute(const char* at) { return load<std::uint16_t>(at); }
void store_stl_attribute(char* at, std::uint16_t value) { store(at, value); }

Mesh read_stl(std::string content, const std::string& name, MemoryBudget& budget, const Context& context) {
  return StlReader(std::move(content), name, budget, context).read();
}

}  // namespace meshgraft::io
