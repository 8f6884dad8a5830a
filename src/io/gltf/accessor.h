#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "core/memory_budget.h"
#include "json.h"

namespace meshgraft::io {

/// The number of the component type float in glTF.
inline constexpr int component_type_float = 5126;

/// The address of a byte in one of the buffers.
struct GltfAddress {
  std::size_t buffer = 0;
  std::size_t byte = 0;
};

/// An accessor whose ranges have been checked against the buffers.
struct GltfAccessor {
  ScalarType type = ScalarType::float32;
  bool normalized = false;
  std::size_t components = 1;
  std::size_t count = 0;

  struct Strided {
    GltfAddress begin;
    std::size_t stride = 0;
  };
  std::optional<Strided> dense;  ///< empty: all elements are zero
  /// The elements that a sparse accessor stores separately, with their addresses.
  std::unordered_map<std::size_t, GltfAddress> displaced;
  std::vector<Strided> sparse_parts;  ///< the ranges of the indices and of the values
  std::size_t sparse_count = 0;
  ScalarType sparse_index_type = ScalarType::uint32;

  std::size_t element_size() const;

  /// Returns the address of an element. Returns nothing for a zero that no byte stores.
  std::optional<GltfAddress> address(std::size_t element) const;

  /// Returns the largest integer, which stands for 1. Returns 0 if values are stored as they are.
  double unit() const;
};

/// A value of up to four components. Vertex attributes never use matrix accessors.
using GltfValue = std::array<double, 4>;

/// The bytes of each buffer.
using GltfBytes = std::vector<std::string_view>;

/// Returns whether glTF allows indices of this type.
bool is_index_type(ScalarType type);

/// Checks an accessor and its ranges. Throws Error(input) naming the member that is missing, unknown or out
/// of range. `budget`, which may be null, is charged for the table of a sparse accessor.
GltfAccessor resolve_accessor(const JsonView& root, std::size_t index, const GltfBytes& buffers,
                              MemoryBudget* budget = nullptr);

/// Load one component as it is stored, and all components of an element as the values that they stand for.
double load_component(const GltfAccessor& accessor, std::size_t element, std::size_t component,
                      const GltfBytes& buffers);
GltfValue load_value(const GltfAccessor& accessor, std::size_t element, const GltfBytes& buffers);

/// Returns the component that would be stored for `value`. Integers are rounded, by at most half a quantum.
/// Returns nothing if the value is out of the type's range.
std::optional<double> stored_component(const GltfAccessor& accessor, double value);

}  // namespace meshgraft::io
