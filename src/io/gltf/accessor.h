#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "json.h"

namespace meshgraft::io {

/// glTF's number of the component type float.
inline constexpr int component_type_float = 5126;

/// A byte of one of the buffers.
struct GltfAddress {
  std::size_t buffer = 0;
  std::size_t byte = 0;
};

/// An accessor whose ranges were checked against the buffers.
struct GltfAccessor {
  ScalarType type = ScalarType::float32;
  bool normalized = false;
  std::size_t components = 1;
  std::size_t count = 0;

  struct Strided {
    GltfAddress begin;
    std::size_t stride = 0;
  };
  std::optional<Strided> dense;  ///< none: zeros
  /// Elements that have a place of their own (a sparse accessor).
  std::unordered_map<std::size_t, GltfAddress> displaced;
  std::vector<Strided> sparse_parts;  ///< their indices, then their values
  std::size_t sparse_count = 0;
  ScalarType sparse_index_type = ScalarType::uint32;

  std::size_t element_size() const;

  /// Where an element is stored; none for a zero that no byte holds.
  std::optional<GltfAddress> address(std::size_t element) const;

  /// Largest integer that stands for 1, or 0 where values are stored as they are.
  double unit() const;
};

/// A value of up to four components; MAT accessors are not for vertices.
using GltfValue = std::array<double, 4>;

/// The bytes of each buffer.
using GltfBytes = std::vector<std::string_view>;

/// Whether glTF allows indices of this type.
bool is_index_type(ScalarType type);

/// Throws Error(input) naming the member that is missing, unknown or out of range.
GltfAccessor resolve_accessor(const JsonView& root, std::size_t index, const GltfBytes& buffers);

/// One component as it is stored, and an element as what it stands for.
double load_component(const GltfAccessor& accessor, std::size_t element, std::size_t component,
                      const GltfBytes& buffers);
GltfValue load_value(const GltfAccessor& accessor, std::size_t element, const GltfBytes& buffers);

/// What would be stored for `value`; none where the type cannot hold it (half a quantum for integers).
std::optional<double> stored_component(const GltfAccessor& accessor, double value);

}  // namespace meshgraft::io
