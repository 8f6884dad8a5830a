#include "ply_header.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "core/memory_budget.h"
#include "core/platform/file.h"
#include "distributed/facts.h"
#include "io/facts.h"
#include "io/file.h"
#include "io/ply/document.h"

namespace meshgraft::distributed {

namespace {

/// Returns the records of an element. The list of a face has three values.
RecordTable table_of(const io::PlyElement& element, const std::filesystem::path& path, std::uint64_t begin) {
  constexpr int triangle = 3;
  RecordTable table{.count = static_cast<Number>(element.count)};
  for (const io::PlyProperty& property : element.properties)
    table.add({.name = property.name,
               .type = &record_type(property.type),
               .values = property.is_list ? triangle : 1,
               .length = property.is_list ? &record_type(property.count_type) : nullptr});
  table.files.push_back({path, begin, 0, table.count});
  return table;
}

void append_element(std::string& text, std::string_view name, const RecordTable& table) {
  text += fmt::format("element {} {}\n", name, table.count);
  for (const RecordField& field : table.fields)
    text += field.length != nullptr
                ? fmt::format("property list {} {} {}\n", field.length->name, field.type->name, field.name)
                : fmt::format("property {} {}\n", field.type->name, field.name);
}

}  // namespace

std::string read_ply_beginning(const std::filesystem::path& path, std::uint64_t& file_bytes) {
  std::error_code error;
  platform::File file(path, platform::OpenMode::read, error);
  if (error) throw io::file_error(path, facts::io::Action::open, error);
  const platform::File::Status status = file.status(error);
  if (error) throw io::file_error(path, facts::io::Action::read, error);
  if (status.type == std::filesystem::file_type::directory) throw Error(facts::io::IsFolder{}, path);
  file_bytes = status.bytes;
  constexpr std::size_t longest = std::size_t{16} << 20, step = std::size_t{64} << 10;
  std::string beginning;
  while (beginning.size() < longest && beginning.find("end_header") == std::string::npos) {
    const std::size_t size = beginning.size();
    beginning.resize(size + step);
    const std::size_t got = file.read(beginning.data() + size, step, error);
    beginning.resize(size + got);
    if (error) throw io::file_error(path, facts::io::Action::read, error);
    if (got == 0) break;
  }
  return beginning;
}

StoredMesh parse_ply_beginning(const std::string& beginning, const std::filesystem::path& path,
                               std::uint64_t file_bytes) {
  MemoryBudget budget{Context{}};
  const io::PlyHeader header = io::parse_ply_header(beginning, path.string(), budget, file_bytes);
  if (header.encoding == io::PlyEncoding::ascii) throw Error(facts::distributed::NotBinary{}, path);
  StoredMesh mesh{.path = path, .comments = header.comments, .bytes = file_bytes};
  std::uint64_t at = header.size;
  bool records_end = false;  // what follows a record of unknown size is copied as it is
  for (const io::PlyElement& element : header.elements) {
    const bool is_face = element.name == "face", is_vertex = element.name == "vertex";
    if (!is_face && !is_vertex && element.count > 0) mesh.other_elements.push_back(element.name);
    if (records_end) continue;
    const auto lists = std::ranges::count_if(element.properties, &io::PlyProperty::is_list);
    if (lists > (is_face ? 1 : 0)) {
      if (mesh.vertices.count == 0 || mesh.faces.count == 0)
        throw Error(facts::distributed::RecordsOfDifferentSize{.element = element.name}, path);
      records_end = true;
      continue;
    }
    RecordTable table = table_of(element, path, at);
    table.swap = io::needs_swap(header.encoding);
    at += table.size * element.count;
    if (at > file_bytes)
      throw Error(facts::io::TooShort{.element = element.name, .count = element.count}, path);
    if (is_vertex) mesh.vertices = table;
    if (!is_face || lists == 0) continue;
    mesh.faces = table;
    mesh.corners_name = std::ranges::find_if(element.properties, &io::PlyProperty::is_list)->name;
  }
  if (!records_end && at < file_bytes)
    throw Error(facts::io::TrailingData{.element = header.elements.back().name}, path);
  return mesh;
}

std::string ply_header_text(const StoredMesh& mesh) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : mesh.comments) text += fmt::format("comment {}\n", comment);
  append_element(text, "vertex", mesh.vertices);
  append_element(text, "face", mesh.faces);
  return text + "end_header\n";
}

}  // namespace meshgraft::distributed
