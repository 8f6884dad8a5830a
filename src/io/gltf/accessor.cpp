#include "accessor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <meshgraft/core/error.h>

#include "gltf/facts.h"
#include "io/binary_value.h"
#include "io/facts.h"
#include "io/number_text.h"

namespace meshgraft::io {

namespace {

ScalarType scalar_type(const JsonView& component_type) {
  const std::uint64_t number = component_type.whole();
  switch (number) {
    case 5120: return ScalarType::int8;
    case 5121: return ScalarType::uint8;
    case 5122: return ScalarType::int16;
    case 5123: return ScalarType::uint16;
    case 5125: return ScalarType::uint32;
    case 5126: return ScalarType::float32;
    default: component_type.fail(facts::gltf::UnknownConstant{.value = std::to_string(number)});
  }
}

std::size_t component_count(const JsonView& type) {
  const std::string name = type.text();
  if (name == "SCALAR") return 1;
  if (name == "VEC2") return 2;
  if (name == "VEC3") return 3;
  if (name == "VEC4") return 4;
  type.fail(facts::gltf::UnknownConstant{.value = name});
}

/// Returns the address of `count` elements of `size` bytes, which begin at the owner's byteOffset in its
/// buffer view.
GltfAccessor::Strided resolve_range(const JsonView& root, const JsonView& owner, std::size_t count,
                                    std::size_t size, bool may_be_strided, const GltfBytes& buffers) {
  const JsonView reference = owner.at("bufferView");
  const JsonView view = root.at("bufferViews").at(reference.index(root.count("bufferViews"), "bufferViews"));
  if (const auto extensions = view.find("extensions")) {
    for (const char* compression : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (extensions->find(compression)) view.fail(facts::gltf::Compressed{.extension = compression});
  }
  const JsonView buffer = view.at("buffer");
  const std::size_t b = buffer.index(buffers.size(), "buffers");
  if (buffers[b].data() == nullptr) root.at("buffers").at(b).fail(facts::gltf::BufferAbsent{});
  const std::uint64_t available = buffers[b].size();
  const std::uint64_t view_offset = view.whole("byteOffset", 0);
  const std::uint64_t view_size = view.at("byteLength").whole();
  if (view_offset > available || view_size > available - view_offset)
    view.fail(facts::gltf::BeyondBytes{.bytes = available, .whole = facts::gltf::Whole::buffer});
  std::uint64_t stride = size;
  if (may_be_strided) stride = view.whole("byteStride", size);
  if (stride < size || stride > 255) view.fail(facts::gltf::StrideMismatch{.stride = stride, .bytes = size});
  const std::uint64_t offset = owner.whole("byteOffset", 0);
  // Checks that the last element fits, without a product that could overflow.
  const bool fits = count == 0 || (offset <= view_size && size <= view_size - offset &&
                                   count - 1 <= (view_size - offset - size) / stride);
  if (!fits) owner.fail(facts::gltf::BeyondBytes{.bytes = view_size, .whole = facts::gltf::Whole::buffer_view});
  return {{b, static_cast<std::size_t>(view_offset + offset)}, static_cast<std::size_t>(stride)};
}

std::size_t load_index(const GltfBytes& buffers, const GltfAccessor::Strided& at, std::size_t k,
                       ScalarType type) {
  const char* byte = buffers[at.begin.buffer].data() + at.begin.byte + k * at.stride;
  return static_cast<std::size_t>(load_binary(byte, type, swap_little_endian));
}

void resolve_sparse(const JsonView& root, const JsonView& sparse, const GltfBytes& buffers,
                    MemoryBudget* budget, GltfAccessor& accessor) {
  const std::uint64_t count = sparse.at("count").whole();
  if (count > accessor.count)
    sparse.at("count").fail(facts::gltf::SparseCountTooLarge{.sparse = count, .count = accessor.count});
  const JsonView indices = sparse.at("indices");
  const JsonView values = sparse.at("values");
  accessor.sparse_count = static_cast<std::size_t>(count);
  accessor.sparse_index_type = scalar_type(indices.at("componentType"));
  const ScalarType type = accessor.sparse_index_type;
  if (!is_index_type(type))
    indices.at("componentType").fail(facts::gltf::NotForIndices{.what = facts::gltf::Storage::type});
  const auto index_range = resolve_range(root, indices, accessor.sparse_count, size_of(type), false, buffers);
  const auto value_range =
      resolve_range(root, values, accessor.sparse_count, accessor.element_size(), false, buffers);
  accessor.sparse_parts = {index_range, value_range};
  constexpr std::uint64_t bytes_of_entry = 64;  // of a hash table with a node per entry
  if (budget != nullptr) budget->charge(accessor.sparse_count * bytes_of_entry);
  for (std::size_t k = 0; k < accessor.sparse_count; ++k) {
    const std::size_t element = load_index(buffers, index_range, k, type);
    if (element >= accessor.count)
      indices.fail(facts::gltf::SparseIndexOutOfRange{.value = k, .index = element, .count = accessor.count});
    accessor.displaced.insert_or_assign(
        element, GltfAddress{value_range.begin.buffer, value_range.begin.byte + k * value_range.stride});
  }
}

}  // namespace

bool is_index_type(ScalarType type) {
  return type == ScalarType::uint8 || type == ScalarType::uint16 || type == ScalarType::uint32;
}

std::size_t GltfAccessor::element_size() const { return components * size_of(type); }

std::optional<GltfAddress> GltfAccessor::address(std::size_t element) const {
  if (!displaced.empty())
    if (const auto own = displaced.find(element); own != displaced.end()) return own->second;
  if (!dense) return std::nullopt;
  return GltfAddress{dense->begin.buffer, dense->begin.byte + element * dense->stride};
}

double GltfAccessor::unit() const {
  if (!normalized) return 0;
  switch (type) {
    case ScalarType::int8: return 127;
    case ScalarType::uint8: return 255;
    case ScalarType::int16: return 32767;
    case ScalarType::uint16: return 65535;
    default: return 0;
  }
}

GltfAccessor resolve_accessor(const JsonView& root, std::size_t index, const GltfBytes& buffers,
                              MemoryBudget* budget) {
  const JsonView json = root.at("accessors").at(index);
  GltfAccessor accessor;
  accessor.type = scalar_type(json.at("componentType"));
  accessor.components = component_count(json.at("type"));
  accessor.normalized = json.flag("normalized");
  const std::uint64_t count = json.at("count").whole();
  constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<Index>::max());
  if (count > most)
    json.at("count").fail(facts::io::TooMany{.elements = facts::io::Elements::accessor_elements, .most = most});
  accessor.count = static_cast<std::size_t>(count);
  if (json.find("bufferView"))
    accessor.dense = resolve_range(root, json, accessor.count, accessor.element_size(), true, buffers);
  if (const auto sparse = json.find("sparse")) resolve_sparse(root, *sparse, buffers, budget, accessor);
  if (!accessor.dense) {
    // Zeros need no bytes in a file, so a count without data must not decide how much memory is taken.
    std::size_t bytes = 0;
    for (const std::string_view buffer : buffers) bytes += buffer.size();
    if (accessor.count > bytes) json.fail(facts::gltf::CountWithoutData{.count = accessor.count});
  }
  return accessor;
}

double load_component(const GltfAccessor& accessor, std::size_t element, std::size_t component,
                      const GltfBytes& buffers) {
  const auto at = accessor.address(element);
  if (!at) return 0;
  const char* byte = buffers[at->buffer].data() + at->byte + component * size_of(accessor.type);
  return load_binary(byte, accessor.type, swap_little_endian);
}

GltfValue load_value(const GltfAccessor& accessor, std::size_t element, const GltfBytes& buffers) {
  GltfValue value{};
  const double unit = accessor.unit();
  for (std::size_t k = 0; k < accessor.components; ++k) {
    value[k] = load_component(accessor, element, k, buffers);
    if (unit > 0) value[k] = std::max(value[k] / unit, -1.0);
  }
  return value;
}

std::optional<double> stored_component(const GltfAccessor& accessor, double value) {
  if (!is_integer(accessor.type)) {
    const ParsedNumber rounded = narrow(value, accessor.type);
    if (rounded.fault != NumberFault::none) return std::nullopt;
    return rounded.value;
  }
  const double scaled = std::round(accessor.unit() > 0 ? value * accessor.unit() : value);
  if (!std::isfinite(scaled) || narrow(scaled, accessor.type).fault != NumberFault::none) return std::nullopt;
  return scaled;
}

}  // namespace meshgraft::io
