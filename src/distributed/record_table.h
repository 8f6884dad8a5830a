#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

#include "communicator.h"
#include "distributed/facts.h"
#include "shared_file.h"

namespace meshgraft::distributed {

/// A type of the values in records: those of PLY, and integers of 64 bits.
struct RecordType {
  std::string_view name;
  std::uint64_t bytes;
  bool is_integer;
  std::optional<ScalarType> scalar;  ///< absent for integers of 64 bits
};

/// Returns the type of this name, by either of the names that PLY has for it, or null.
const RecordType* find_record_type(std::string_view name);
const RecordType& record_type(ScalarType type);
/// Returns the names of all types, without second names.
std::vector<std::string> record_type_names();

/// A property of a record.
struct RecordField {
  std::string name;
  const RecordType* type = nullptr;
  int values = 1;                      ///< one after another
  const RecordType* length = nullptr;  ///< of the number of values that stands before them, in a PLY list
  std::uint64_t offset = 0;            ///< of the first value, bytes from the beginning of the record

  std::uint64_t bytes() const { return type->bytes * static_cast<std::uint64_t>(values); }
};

/// A part of a table, in one file.
struct RecordFile {
  std::filesystem::path path;
  std::uint64_t begin = 0;      ///< byte of its first record
  Number first = 0, count = 0;  ///< numbers of its records in the table

  Number end() const { return first + count; }
};

/// Records of equal size in one file or several, numbered through all of them.
struct RecordTable {
  std::vector<RecordField> fields;
  std::uint64_t size = 0;  ///< bytes of a record
  Number count = 0;
  std::vector<RecordFile> files;  ///< in the order of their records
  bool swap = false;              ///< the byte order is not the machine's

  /// Appends a field to the record.
  void add(RecordField field);
  const RecordField* find(std::string_view name) const;
  /// Returns the byte of a record in its file.
  std::uint64_t byte_of(const RecordFile& file, Number record) const {
    return file.begin + size * static_cast<std::uint64_t>(record - file.first);
  }
  /// Returns the location of a record for an error: the file, the number and, in one of several files, the
  /// record within it.
  Location location(const RecordFile& file, std::string_view element, Number record) const;

  /// Reads records `first` to `end` in blocks of one file each, and calls body(bytes, file, first record of the
  /// block, number of records). Calls no function of a communicator.
  template <class Body>
  void for_each_block(Number first, Number end, const Body& body) const {
    const auto at_once = static_cast<Number>(std::max<std::uint64_t>(1, block_bytes / size));
    std::vector<char> bytes;
    for (const RecordFile& file : files) {
      const Number file_end = std::min(end, file.end());
      Number record = std::max(first, file.first);
      if (record >= file_end) continue;
      const SharedFile open(MPI_COMM_SELF, file.path, MPI_MODE_RDONLY, file.path);
      open.require_open();
      for (; record < file_end; record += at_once) {
        const Number count_here = std::min(at_once, file_end - record);
        bytes.resize(size * static_cast<std::uint64_t>(count_here));
        open.read(byte_of(file, record), bytes.data(), bytes.size());
        body(bytes.data(), file, record, count_here);
      }
    }
  }
};

/// Returns where the ranks' equal shares of so many items start, and their number.
std::vector<Number> equal_shares(Number count, int ranks);

/// Loads an integer of a record. Returns -1 for one that is negative or too large.
Number load_number(const char* at, const RecordType& type, bool swap);

/// Copies a value of `bytes` bytes, in reverse order for `swap`.
void copy_value(const char* from, char* to, std::uint64_t bytes, bool swap);

/// Loads the corners of the triangle in a record. `location` is called for an error. Throws Error(input) for a
/// list of other than three corners, and for a vertex that does not exist.
template <class LocationOf>
std::array<Number, 3> load_triangle(const char* record, const RecordField& corners, bool swap,
                                    Number vertex_count, const LocationOf& location) {
  constexpr Number three = 3;
  const char* at = record + corners.offset;
  if (corners.length != nullptr && load_number(at - corners.length->bytes, *corners.length, swap) != three)
    throw Error(facts::distributed::NotATriangle{}, location());
  std::array<Number, 3> triangle{};
  for (Number& corner : triangle) {
    corner = load_number(at, *corners.type, swap);
    if (corner < 0 || corner >= vertex_count)
      throw Error(facts::distributed::FaceOfNoVertex{.count = vertex_count}, location());
    at += corners.type->bytes;
  }
  return triangle;
}

}  // namespace meshgraft::distributed
