#include "xml.h"

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <optional>
#include <type_traits>

#include <expat.h>

#include <meshgraft/core/error.h>

#include "io/charged.h"
#include "io/number_text.h"
#include "threemf/facts.h"

namespace meshgraft::io {

namespace {

constexpr std::array<std::string_view, 3> axis_attributes = {"x", "y", "z"};

/// Collects the contents of a part while expat parses the text. Exceptions are rethrown after expat has
/// returned, because they must not cross its C code.
class PartScanner {
 public:
  PartScanner(std::string_view xml, const std::string& location, MemoryBudget& budget)
      : xml_(xml),
        location_(location),
        budget_(budget),
        parser_(XML_ParserCreateNS(nullptr, '|'), &XML_ParserFree) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &start, &end);
    XML_SetStartDoctypeDeclHandler(parser_.get(), &doctype);
  }

  ThreemfPart scan(const Context& context) {
    constexpr std::size_t piece = std::size_t{1} << 20;
    for (std::size_t at = 0; at <= xml_.size(); at += piece) {
      context.throw_if_stopped();
      const std::string_view text = xml_.substr(at, piece);
      const bool last = at + piece > xml_.size();
      const XML_Status status = XML_Parse(parser_.get(), text.data(), static_cast<int>(text.size()), last);
      if (failure_) std::rethrow_exception(failure_);
      if (status != XML_STATUS_OK)
        fail(facts::threemf::NotXml{.reason = XML_ErrorString(XML_GetErrorCode(parser_.get()))});
    }
    for (ThreemfVertices& mesh : part_.meshes) finish(mesh);
    free_charged(coordinates_, budget_);
    return std::move(part_);
  }

 private:
  static void XMLCALL start(void* self, const XML_Char* name, const XML_Char** attributes) {
    static_cast<PartScanner*>(self)->guarded([&](PartScanner& c) { c.start_element(name, attributes); });
  }
  static void XMLCALL end(void* self, const XML_Char* name) {
    static_cast<PartScanner*>(self)->guarded([&](PartScanner& c) {
      if (local(name) == "vertices") c.inside_vertices_ = false;
    });
  }
  static void XMLCALL doctype(void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    static_cast<PartScanner*>(self)->guarded([](PartScanner& c) { c.fail(facts::threemf::HasDocumentType{}); });
  }

  template <class Action>
  void guarded(const Action& action) {
    if (failure_) return;
    try {
      action(*this);
    } catch (...) {
      failure_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  // Returns the name without its namespace for elements of the core namespace, and an empty text for others.
  static std::string_view local(std::string_view name) {
    constexpr std::string_view core = "http://schemas.microsoft.com/3dmanufacturing/core/";
    return name.starts_with(core) ? name.substr(name.rfind('|') + 1) : std::string_view();
  }

  void start_element(std::string_view name, const XML_Char** attributes) {
    const std::string_view element = local(name);
    if (element == "vertex" && inside_vertices_) return add_vertex(attributes);
    if (element == "triangle") ++part_.triangles;
    if (element == "mesh") push_charged(part_.meshes, ThreemfVertices(), budget_);
    if (element == "vertices" && !part_.meshes.empty()) inside_vertices_ = true;
    if (element == "object") object_ = value_of("id", attributes);
    if (element == "component") part_.components[object_].push_back(reference(attributes));
    if (element == "item") part_.items.push_back(reference(attributes));
  }

  ThreemfReference reference(const XML_Char** attributes) const {
    constexpr std::string_view path = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06|path";
    ThreemfReference found = {value_of(path, attributes), value_of("objectid", attributes)};
    budget_.charge(bytes_of(found.path) + bytes_of(found.id));
    return found;
  }

  static std::string value_of(std::string_view name, const XML_Char** attributes) {
    for (; *attributes != nullptr; attributes += 2)
      if (name == attributes[0]) return attributes[1];
    return {};
  }

  void add_vertex(const XML_Char** attributes) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      push_charged(coordinates_, coordinate(axis_attributes[axis], attributes), budget_);
    ThreemfVertices& mesh = part_.meshes.back();
    push_charged(mesh.tag_begin, static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_.get())), budget_);
    push_charged(mesh.tag_length, static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get())), budget_);
  }

  double coordinate(std::string_view axis, const XML_Char** attributes) const {
    for (; *attributes != nullptr; attributes += 2) {
      if (axis != attributes[0]) continue;
      std::string_view text = attributes[1];
      while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
      while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
      const ParsedNumber number = parse_number(text, ScalarType::float64);
      if (number.fault != NumberFault::none)
        fail(bad_number("vertex", axis, text, ScalarType::float64, number.fault));
      return number.value;
    }
    fail(facts::threemf::CoordinateMissing{.axis = axis});
  }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  // Copies the positions of the next mesh. The numbers of all meshes are collected one after another.
  void finish(ThreemfVertices& mesh) {
    const auto count = static_cast<Eigen::Index>(mesh.tag_begin.size());
    resize_charged(mesh.positions, mesh.tag_begin.size(), budget_);
    mesh.positions = Eigen::Map<const Points>(coordinates_.data() + finished_, count, 3);
    finished_ += 3 * static_cast<std::size_t>(count);
  }

  [[noreturn]] void fail(const Fact& fact) const {
    throw Error(fact, Location::file(location_) /
                          Location::place("line " + std::to_string(XML_GetCurrentLineNumber(parser_.get()))));
  }

  std::string_view xml_;
  const std::string& location_;
  MemoryBudget& budget_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, void (*)(XML_Parser)> parser_;
  ThreemfPart part_;
  std::string object_;
  std::vector<double> coordinates_;
  std::size_t finished_ = 0;
  bool inside_vertices_ = false;
  std::exception_ptr failure_;
};

/// Returns the value of an attribute in a tag, without its quotes.
std::string_view value_in(std::string_view tag, std::string_view attribute) {
  for (std::size_t at = tag.find_first_of(" \t\r\n"); at < tag.size();) {
    at = tag.find_first_not_of(" \t\r\n", at);
    const std::size_t equals = tag.find('=', at);
    const std::size_t open = tag.find_first_of("\"'", equals);
    if (open == std::string_view::npos) break;
    const std::size_t close = tag.find(tag[open], open + 1);
    std::string_view name = tag.substr(at, equals - at);
    name = name.substr(0, name.find_last_not_of(" \t\r\n") + 1);
    if (name == attribute) return tag.substr(open + 1, close - open - 1);
    at = close + 1;
  }
  return {};
}

}  // namespace

ThreemfPart scan_part(std::string_view xml, const std::string& location, MemoryBudget& budget,
                      const Context& context) {
  return PartScanner(xml, location, budget).scan(context);
}

bool has_utf16_mark(std::string_view xml) { return xml.starts_with("\xFF\xFE") || xml.starts_with("\xFE\xFF"); }

void append_tag(std::string& out, std::string_view tag, const Eigen::RowVector3d& from,
                const Eigen::RowVector3d& to) {
  struct Change {
    std::string_view old;
    double value;
  };
  std::vector<Change> changes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    if (!same_value(from(a), to(a))) changes.push_back({value_in(tag, axis_attributes[axis]), to(a)});
  }
  std::sort(changes.begin(), changes.end(),
            [](const Change& a, const Change& b) { return a.old.data() < b.old.data(); });
  const char* copied = tag.data();
  for (const Change& change : changes) {
    out.append(copied, static_cast<std::size_t>(change.old.data() - copied));
    append_number(out, change.value, ScalarType::float64);
    copied = change.old.data() + change.old.size();
  }
  out.append(copied, tag.data() + tag.size());
}

}  // namespace meshgraft::io
