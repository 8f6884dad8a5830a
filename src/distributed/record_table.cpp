#include "record_table.h"

#include <cstring>
#include <utility>

namespace meshgraft::distributed {

namespace {

constexpr std::array<RecordType, 10> record_types = {{
    {"char", 1, true, ScalarType::int8},
    {"uchar", 1, true, ScalarType::uint8},
    {"short", 2, true, ScalarType::int16},
    {"ushort", 2, true, ScalarType::uint16},
    {"int", 4, true, ScalarType::int32},
    {"uint", 4, true, ScalarType::uint32},
    {"float", 4, false, ScalarType::float32},
    {"double", 8, false, ScalarType::float64},
    {"int64", 8, true, std::nullopt},
    {"uint64", 8, true, std::nullopt},
}};

/// The second names of the first types, in their order.
constexpr std::array<std::string_view, 8> second_names = {"int8",  "uint8",  "int16",   "uint16",
                                                          "int32", "uint32", "float32", "float64"};

template <class T>
Number load_integer(const char* at, bool swap) {
  T value;
  copy_value(at, reinterpret_cast<char*>(&value), sizeof(T), swap);
  return std::in_range<Number>(value) && std::cmp_greater_equal(value, 0) ? static_cast<Number>(value) : -1;
}

}  // namespace

const RecordType* find_record_type(std::string_view name) {
  for (std::size_t k = 0; k < record_types.size(); ++k)
    if (record_types[k].name == name || (k < second_names.size() && second_names[k] == name))
      return &record_types[k];
  return nullptr;
}

const RecordType& record_type(ScalarType type) {
  return *std::ranges::find(record_types, std::optional(type), &RecordType::scalar);
}

std::vector<std::string> record_type_names() {
  std::vector<std::string> names;
  for (const RecordType& type : record_types) names.emplace_back(type.name);
  return names;
}

void RecordTable::add(RecordField field) {
  field.offset = size + (field.length != nullptr ? field.length->bytes : 0);
  size = field.offset + field.bytes();
  fields.push_back(std::move(field));
}

const RecordField* RecordTable::find(std::string_view name) const {
  const auto found = std::ranges::find(fields, name, &RecordField::name);
  return found == fields.end() ? nullptr : &*found;
}

Location RecordTable::location(const RecordFile& file, std::string_view element, Number record) const {
  std::string text = std::string(element) + " " + std::to_string(record);
  if (files.size() > 1) text += ", record " + std::to_string(record - file.first) + " of the file";
  return Location(file.path) / Location::place(text);
}

std::vector<Number> equal_shares(Number count, int ranks) {
  std::vector<Number> starts(static_cast<std::size_t>(ranks) + 1);
  for (int rank = 0; rank <= ranks; ++rank)
    starts[static_cast<std::size_t>(rank)] = count / ranks * rank + std::min<Number>(rank, count % ranks);
  return starts;
}

Number load_number(const char* at, const RecordType& type, bool swap) {
  const bool is_signed = type.name.front() != 'u';
  switch (type.bytes) {
    case 1: return is_signed ? load_integer<std::int8_t>(at, swap) : load_integer<std::uint8_t>(at, swap);
    case 2: return is_signed ? load_integer<std::int16_t>(at, swap) : load_integer<std::uint16_t>(at, swap);
    case 4: return is_signed ? load_integer<std::int32_t>(at, swap) : load_integer<std::uint32_t>(at, swap);
    default: return is_signed ? load_integer<std::int64_t>(at, swap) : load_integer<std::uint64_t>(at, swap);
  }
}

void copy_value(const char* from, char* to, std::uint64_t bytes, bool swap) {
  if (swap)
    std::reverse_copy(from, from + bytes, to);
  else
    std::memcpy(to, from, bytes);
}

}  // namespace meshgraft::distributed
