#include "convert_mesh.h"

#include <algorithm>
#include <limits>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "chunk_index.h"
#include "distributed/facts.h"
#include "io/binary_value.h"
#include "io/file.h"
#include "mesh_writer.h"
#include "ply_header.h"
#include "stored_mesh.h"

namespace meshgraft::distributed {

namespace {

constexpr Number most_in_ply = std::numeric_limits<std::int32_t>::max();

/// Returns the records of the output, but for their files. Corners are a list in PLY, and an array in chunks.
RecordTable converted_table(const StoredMesh& from, const RecordTable& table, bool to_chunks) {
  RecordTable converted{.count = table.count, .swap = io::swap_little_endian};
  for (const RecordField& field : table.fields) {
    RecordField to{.name = field.name, .type = field.type, .values = field.values};
    if (&field == &from.corners()) {
      to.name = "vertex_indices";
      if (!to_chunks) to.length = &record_type(ScalarType::uint8);
      if (!to_chunks && !to.type->scalar) to.type = &record_type(ScalarType::int32);
    } else if (!to_chunks && !to.type->scalar) {
      throw Error(
          facts::distributed::TypeNotInPly{.property = field.name, .type = std::string(field.type->name)},
          from.path);
    }
    converted.add(std::move(to));
  }
  return converted;
}

void add_files(RecordTable& table, const char* name, Number per_file) {
  const Number files = (table.count + per_file - 1) / per_file;
  for (Number file = 0; file < files; ++file) {
    const Number first = file * per_file;
    table.files.push_back(
        {fmt::format("{}-{:04}.bin", name, file), 0, first, std::min(per_file, table.count - first)});
  }
}

StoredMesh converted_layout(const StoredMesh& from, const ConvertRequest& request) {
  StoredMesh to{.path = request.output, .in_chunks = names_chunks(request.output), .comments = from.comments};
  if (!from.other_elements.empty())
    throw Error(facts::distributed::ElementNotConverted{.element = from.other_elements.front()}, from.path);
  for (const auto& [table, element] :
       {std::pair(&from.vertices, "vertices"), std::pair(&from.faces, "triangles")})
    if (!to.in_chunks && table->count > most_in_ply)
      throw Error(
          facts::distributed::TooManyForPly{.count = table->count, .what = element, .most = most_in_ply},
          from.path);
  to.vertices = converted_table(from, from.vertices, to.in_chunks);
  to.faces = converted_table(from, from.faces, to.in_chunks);
  if (to.in_chunks) {
    add_files(to.vertices, "vertices", request.records_per_file);
    add_files(to.faces, "triangles", request.records_per_file);
    return to;
  }
  const std::uint64_t begin = ply_header_text(to).size();
  to.vertices.files.push_back({request.output, begin, 0, to.vertices.count});
  to.faces.files.push_back({request.output,
                            begin + to.vertices.size * static_cast<std::uint64_t>(to.vertices.count), 0,
                            to.faces.count});
  return to;
}

/// Copies a record's values into a record of another layout.
void convert_record(const char* from, const RecordTable& source, char* to, const RecordTable& target) {
  const bool swap = source.swap != target.swap;
  for (std::size_t f = 0; f < source.fields.size(); ++f) {
    const RecordField &have = source.fields[f], &want = target.fields[f];
    if (want.length != nullptr) *(to + want.offset - 1) = 3;
    for (int k = 0; k < have.values; ++k) {
      const char* value = from + have.offset + have.type->bytes * static_cast<std::uint64_t>(k);
      char* place = to + want.offset + want.type->bytes * static_cast<std::uint64_t>(k);
      if (have.type == want.type)
        copy_value(value, place, have.type->bytes, swap);
      else
        io::store_binary(place, static_cast<double>(load_number(value, *have.type, source.swap)),
                         *want.type->scalar, target.swap);
    }
  }
}

/// Converts this rank's share of a table. `check` is called for each record before.
template <class Check>
void convert_table(const Communicator& comm, const RecordTable& source, const RecordTable& target,
                   MeshWriter& writer, const Check& check) {
  const std::vector<Number> share = equal_shares(source.count, comm.size());
  std::vector<char> converted;
  source.for_each_block(share[comm.rank()], share[comm.rank() + 1],
                        [&](const char* bytes, const RecordFile& file, Number first, Number count) {
                          converted.resize(target.size * static_cast<std::uint64_t>(count));
                          for (Number k = 0; k < count; ++k) {
                            const char* record = bytes + source.size * static_cast<std::uint64_t>(k);
                            check(record, file, first + k);
                            convert_record(record, source,
                                           converted.data() + target.size * static_cast<std::uint64_t>(k),
                                           target);
                          }
                          writer.write(target, first, count, converted.data());
                        });
}

}  // namespace

void require_mesh_name(const std::filesystem::path& output) {
  if (!names_chunks(output) && output.extension() != ".ply" && output.extension() != ".PLY")
    throw Error(facts::io::UnknownExtension{.extension = output.extension().string(),
                                            .known = std::vector<std::string>{".ply", ".chunks"}},
                output);
}

void require_output(const std::filesystem::path& output, const std::filesystem::path& input, bool force) {
  const std::filesystem::path named = output.has_filename() ? output : output.parent_path();
  std::error_code missing;
  if (!force && std::filesystem::equivalent(named, input, missing) && !missing)
    throw Error(facts::distributed::OutputIsInput{}, output);
  if (names_chunks(named) && std::filesystem::exists(std::filesystem::symlink_status(named)))
    throw Error(facts::distributed::ChunksReplaceNothing{}, output);
  if (std::filesystem::exists(named) && !std::filesystem::is_regular_file(named))
    throw std::filesystem::is_directory(named) ? Error(facts::io::IsFolder{}, output)
                                               : Error(facts::distributed::NotARegularFile{}, output);
  const std::filesystem::path folder =
      named.has_parent_path() ? named.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder))
    throw io::file_error(output, facts::io::Action::create,
                         std::make_error_code(std::errc::no_such_file_or_directory));
}

void convert_mesh(MPI_Comm mpi, const ConvertRequest& request) {
  const Communicator comm(mpi);
  StoredMesh to;
  comm.together([&] {
    require_mesh_name(request.output);
    if (comm.rank() == 0) require_output(request.output, request.input, request.force);
  });
  const StoredMesh from = open_stored_mesh(comm, request.input);
  comm.together([&] { to = converted_layout(from, request); });

  MeshWriter writer(comm, request.output, to.in_chunks);
  comm.together([&] {
    if (comm.rank() != 0) return;
    if (to.in_chunks) return create_chunks(writer, to, chunk_index_text(to));
    const std::string header = ply_header_text(to);
    writer.write({}, 0, header.data(), header.size());
  });
  comm.together([&] {
    convert_table(comm, from.vertices, to.vertices, writer, [](const char*, const RecordFile&, Number) {});
    convert_table(comm, from.faces, to.faces, writer,
                  [&](const char* record, const RecordFile& file, Number face) {
                    load_triangle(record, from.corners(), from.faces.swap, from.vertices.count,
                                  [&] { return from.faces.location(file, "face", face); });
                  });
  });
  writer.appear();
}

}  // namespace meshgraft::distributed
