#pragma once

#include <bit>
#include <cstddef>
#include <span>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// Returns whether the bytes of numbers in a little-endian file have to be swapped on this machine.
inline constexpr bool swap_little_endian = std::endian::native != std::endian::little;

/// Load and store one scalar of a binary file. `swap` is true if the file's byte order is not the machine's.
double load_binary(const char* at, ScalarType type, bool swap);
void store_binary(char* at, double value, ScalarType type, bool swap);

/// The values of one property in binary records of equal size.
struct BinaryColumn {
  const char* first = nullptr;  ///< the value in the first record
  std::size_t record = 0;       ///< bytes from one record to the next
  ScalarType type = ScalarType::float32;
  bool swap = false;
};

/// Writes the column's value of record r to `values[r * stride]`.
void load_binary_column(const BinaryColumn& column, std::size_t rows, double* values, std::size_t stride);

/// Reads a list of vertex indices of an integer type. Returns false if an index is too large.
bool load_binary_corners(const char* at, ScalarType type, bool swap, std::span<Index> corners);

}  // namespace meshgraft::io
