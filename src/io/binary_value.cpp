#include "binary_value.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

namespace meshgraft::io {

namespace {

template <class T>
T load_scalar(const char* at, bool swap) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
void store_as(char* at, double value, bool swap) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(static_cast<T>(value));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  std::memcpy(at, bytes.data(), sizeof(T));
}

/// Calls `body` with a value of the C++ type that `type` names.
template <class Body>
auto with_type(ScalarType type, const Body& body) {
  switch (type) {
    case ScalarType::int8: return body(std::int8_t{});
    case ScalarType::uint8: return body(std::uint8_t{});
    case ScalarType::int16: return body(std::int16_t{});
    case ScalarType::uint16: return body(std::uint16_t{});
    case ScalarType::int32: return body(std::int32_t{});
    case ScalarType::uint32: return body(std::uint32_t{});
    case ScalarType::float32: return body(float{});
    case ScalarType::float64: break;
  }
  return body(double{});
}

}  // namespace

double load_binary(const char* at, ScalarType type, bool swap) {
  return with_type(type, [&]<class T>(T) { return static_cast<double>(load_scalar<T>(at, swap)); });
}

void store_binary(char* at, double value, ScalarType type, bool swap) {
  with_type(type, [&]<class T>(T) { store_as<T>(at, value, swap); });
}

void load_binary_column(const BinaryColumn& column, std::size_t rows, double* values, std::size_t stride) {
  with_type(column.type, [&]<class T>(T) {
    const char* at = column.first;
    for (std::size_t row = 0; row < rows; ++row, at += column.record, values += stride)
      *values = static_cast<double>(load_scalar<T>(at, column.swap));
  });
}

bool load_binary_corners(const char* at, ScalarType type, bool swap, std::span<Index> corners) {
  return with_type(type, [&]<class T>(T) {
    bool fits = true;
    for (Index& corner : corners) {
      const T value = load_scalar<T>(at, swap);
      if constexpr (std::is_same_v<T, std::uint32_t>) fits = fits && std::in_range<Index>(value);
      corner = static_cast<Index>(value);
      at += sizeof(T);
    }
    return fits;
  });
}

}  // namespace meshgraft::io
