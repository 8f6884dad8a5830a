#include "chunk_index.h"

#include <set>
#include <string_view>
#include <system_error>

#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>

#include "core/platform/file.h"
#include "distributed/facts.h"
#include "io/binary_value.h"
#include "io/file.h"
#include "script/json_text.h"
#include "script/json_value.h"

namespace meshgraft::distributed {

namespace {

constexpr std::string_view format_word = "meshgraft-chunks";
constexpr int corners_of_triangle = 3;
/// Counts up to which the bytes of records of a kilobyte are numbered without overflow.
constexpr Number most_records = Number{1} << 52;

RecordField parse_field(const json::Value& value, std::set<std::string>& names) {
  const json::Object object(value, {"name", "type"});
  const json::Value name = object.required("name"), type = object.required("type");
  RecordField field{.name = name.name(), .type = find_record_type(type.string())};
  if (field.type == nullptr)
    type.fail(facts::distributed::UnknownType{.type = type.string(), .known = record_type_names()});
  if (!names.insert(field.name).second) name.fail(facts::distributed::ListedTwice{.name = field.name});
  return field;
}

/// Parses the files of a table. `names` has those of all tables.
void parse_files(const json::Value& list, const std::filesystem::path& folder, std::set<std::string>& names,
                 RecordTable& table) {
  Number found = 0;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const json::Value value = list[k];
    const json::Object object(value, {"file", "count"});
    const json::Value file = object.required("file"), count = object.required("count");
    const std::string& name = file.name();
    if (std::filesystem::path(name).filename() != name || name == "." || name == ".." ||
        name == chunk_index_name)
      file.fail(facts::distributed::NotARecordFile{.name = name});
    if (!names.insert(name).second) file.fail(facts::distributed::ListedTwice{.name = name});
    const Number records = count.integer_in(0, most_records - found);
    table.files.push_back({folder / name, 0, found, records});
    found += records;
  }
  if (found != table.count) list.fail(facts::distributed::CountsDisagree{.found = found, .count = table.count});
}

RecordTable parse_table(const json::Value& value, const std::filesystem::path& folder, bool is_face,
                        std::set<std::string>& file_names) {
  const json::Object object(value, {"count", "properties", "files"});
  RecordTable table;
  table.count = object.required("count").integer_in(0, most_records);
  table.swap = io::swap_little_endian;
  const json::Value fields = object.required("properties"), files = object.required("files");
  std::set<std::string> names;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const json::Value entry = fields[k];
    RecordField field = parse_field(entry, names);
    if (is_face && field.name == "vertex_indices") field.values = corners_of_triangle;
    table.add(std::move(field));
  }
  if (is_face && table.find("vertex_indices") == nullptr)
    fields.fail(facts::io::MissingProperty{.element = "triangle", .property = "vertex_indices"});
  parse_files(files, folder, file_names, table);
  return table;
}

using IndexJson = nlohmann::ordered_json;

IndexJson table_json(const RecordTable& table) {
  IndexJson fields = IndexJson::array(), files = IndexJson::array();
  for (const RecordField& field : table.fields)
    fields.push_back({{"name", field.name}, {"type", field.type->name}});
  for (const RecordFile& file : table.files)
    files.push_back({{"file", file.path.filename().string()}, {"count", file.count}});
  return {{"count", table.count}, {"properties", fields}, {"files", files}};
}

}  // namespace

std::string read_chunk_index(const std::filesystem::path& folder) {
  return read_file(folder / chunk_index_name);
}

StoredMesh parse_chunk_index(const std::string& text, const std::filesystem::path& folder) {
  const std::string name = (folder / chunk_index_name).string();
  constexpr int depth_limit = 8;
  const json::Json document = json::parse(text, Location::file(name), depth_limit);
  const json::Value root(document, name);
  const json::Object object(root, {"format", "version", "comments", "vertex", "triangle"});
  object.required("format").choice<bool>({{format_word, true}});
  object.required("version").integer_in(1, 1);
  StoredMesh mesh{.path = folder, .in_chunks = true, .index = text};
  object.optional("comments", [&](const json::Value& comments) {
    for (std::size_t k = 0; k < comments.size(); ++k) mesh.comments.push_back(comments[k].string());
  });
  std::set<std::string> file_names;
  const json::Value vertices = object.required("vertex"), triangles = object.required("triangle");
  mesh.vertices = parse_table(vertices, folder, false, file_names);
  mesh.faces = parse_table(triangles, folder, true, file_names);
  return mesh;
}

void require_chunks(const StoredMesh& mesh) {
  for (const RecordTable* table : {&mesh.vertices, &mesh.faces})
    for (const RecordFile& file : table->files) {
      std::error_code error;
      const platform::File opened(file.path, platform::OpenMode::read, error);
      if (error) throw io::file_error(file.path, facts::io::Action::open, error);
      const platform::File::Status status = opened.status(error);
      if (error) throw io::file_error(file.path, facts::io::Action::read, error);
      if (status.type == std::filesystem::file_type::directory) throw Error(facts::io::IsFolder{}, file.path);
      if (status.bytes % table->size == 0 &&
          status.bytes / table->size == static_cast<std::uint64_t>(file.count))
        continue;
      throw Error(facts::distributed::ChunkSize{.size = status.bytes,
                                                .whole = status.bytes / table->size,
                                                .record = table->size,
                                                .count = file.count},
                  file.path);
    }
}

void create_chunks(MeshWriter& writer, const StoredMesh& mesh, const std::string& index) {
  for (const RecordTable* table : {&mesh.vertices, &mesh.faces})
    for (const RecordFile& file : table->files) writer.create(file.path.filename());
  writer.create(chunk_index_name);
  writer.write(chunk_index_name, 0, index.data(), index.size());
}

std::string chunk_index_text(const StoredMesh& mesh) {
  const IndexJson json = {{"format", format_word},
                          {"version", 1},
                          {"comments", mesh.comments},
                          {"vertex", table_json(mesh.vertices)},
                          {"triangle", table_json(mesh.faces)}};
  return json::to_text(json);
}

}  // namespace meshgraft::distributed
