#include "edit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <meshgraft/core/error.h>

#include "accessor.h"
#include "core/facts.h"
#include "gltf/facts.h"
#include "io/binary_value.h"
#include "io/number_text.h"

namespace meshgraft::io {

namespace {

void put_component(char* element, const GltfAccessor& accessor, std::size_t component, double stored) {
  store_binary(element + component * size_of(accessor.type), stored, accessor.type, swap_little_endian);
}

/// Returns the elements in order, each padded to a multiple of 4 bytes, as vertex attributes require.
std::string dense_bytes(const GltfAccessor& accessor, const GltfBytes& bytes, std::size_t stride) {
  std::string dense(accessor.count * stride, '\0');
  for (std::size_t e = 0; e < accessor.count; ++e)
    if (const auto at = accessor.address(e))
      std::copy_n(bytes[at->buffer].data() + at->byte, accessor.element_size(), dense.data() + e * stride);
  return dense;
}

std::string float_bytes(const GltfAccessor& accessor, const GltfBytes& bytes) {
  std::string dense;
  dense.reserve(accessor.count * accessor.components * sizeof(float));
  for (std::size_t e = 0; e < accessor.count; ++e) {
    const GltfValue value = load_value(accessor, e, bytes);
    for (std::size_t k = 0; k < accessor.components; ++k) append_float(dense, value[k]);
  }
  return dense;
}

/// Compares bounds as floats, because they are often written with fewer digits than a float has.
bool is_same_bound(double a, double b, ScalarType type) {
  return is_integer(type) ? a == b : static_cast<float>(a) == static_cast<float>(b);
}

bool has_bounds(const Json& accessor) { return accessor.contains("min") || accessor.contains("max"); }

}  // namespace

void append_float(std::string& out, double value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof(float));
  store_binary(out.data() + at, value, ScalarType::float32, swap_little_endian);
}

GltfEdit::GltfEdit(const GltfDocument& document)
    : json(document.json), document_(document), name_(document.name()), changed_(document.buffers.size()) {}

GltfBytes GltfEdit::bytes() const {
  GltfBytes bytes = document_.bytes();
  bytes.resize(changed_.size());
  for (std::size_t b = 0; b < changed_.size(); ++b)
    if (changed_[b]) bytes[b] = *changed_[b];
  return bytes;
}

std::string& GltfEdit::writable(std::size_t buffer) {
  if (!changed_[buffer]) changed_[buffer] = std::string(document_.bytes()[buffer]);
  return *changed_[buffer];
}

bool GltfEdit::can_store(const GltfAccessor& accessor, const GltfChanges& changes) {
  for (const auto& [element, value] : changes) {
    if (!accessor.address(element)) return false;
    for (std::size_t k = 0; k < accessor.components; ++k)
      if (!stored_component(accessor, value[k])) return false;
  }
  return true;
}

void GltfEdit::store(std::size_t accessor_index, const GltfChanges& changes) {
  const GltfAccessor target = accessor(accessor_index);
  for (const auto& [element, value] : changes) {
    const GltfAddress at = target.address(element).value();
    char* byte = writable(at.buffer).data() + at.byte;
    for (std::size_t k = 0; k < target.components; ++k)
      put_component(byte, target, k, stored_component(target, value[k]).value());
  }
  refresh_bounds(accessor_index);
}

std::size_t GltfEdit::store_copy(std::size_t accessor_index, const GltfChanges& changes) {
  const GltfAccessor old = accessor(accessor_index);
  Json copy = json["accessors"][accessor_index];
  for (const char* member : {"sparse", "byteOffset", "bufferView"}) copy.erase(member);
  GltfAccessor dense = old;
  const bool as_it_is = std::ranges::all_of(changes, [&](const auto& change) {
    for (std::size_t k = 0; k < old.components; ++k)
      if (!stored_component(old, change.second[k])) return false;
    return true;
  });
  if (!as_it_is) {
    dense.type = ScalarType::float32;
    dense.normalized = false;
    copy["componentType"] = component_type_float;
    copy.erase("normalized");
  }
  const std::size_t stride = (dense.element_size() + 3) / 4 * 4;
  std::string elements = as_it_is ? dense_bytes(old, bytes(), stride) : float_bytes(old, bytes());
  for (const auto& [element, value] : changes) {
    for (std::size_t k = 0; k < dense.components; ++k) {
      const auto stored = stored_component(dense, value[k]);
      if (!stored) throw Error(facts::gltf::NumberBeyondFloats{.value = value[k]});
      put_component(elements.data() + element * stride, dense, k, *stored);
    }
  }
  const std::size_t view_index = append_view(elements, stride == dense.element_size() ? 0 : stride, 34962);
  copy["bufferView"] = view_index;
  const std::size_t index = append("accessors", std::move(copy));
  refresh_bounds(index);
  return index;
}

std::size_t GltfEdit::buffer_for_new_bytes() {
  for (std::size_t b = 0; b < document_.buffers.size(); ++b)
    if (document_.buffers[b].storage != GltfBuffer::Storage::absent) return b;
  throw Error(facts::core::Bug{.what = "a glTF file with elements has no buffer"});
}

std::size_t GltfEdit::append_view(std::string_view bytes, std::size_t stride, int target) {
  const std::size_t b = buffer_for_new_bytes();
  std::string& buffer = writable(b);
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  Json view = {{"buffer", b}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
  if (stride > 0) view["byteStride"] = stride;
  if (target > 0) view["target"] = target;
  buffer += bytes;
  json["buffers"][b]["byteLength"] = buffer.size();
  return append("bufferViews", std::move(view));
}

std::size_t GltfEdit::append(const char* array, Json value) {
  Json& list = json[array];
  if (!list.is_array()) list = Json::array();
  list.push_back(std::move(value));
  return list.size() - 1;
}

void GltfEdit::refresh_bounds(std::size_t accessor_index) {
  Json& accessor_json = json["accessors"][accessor_index];
  if (has_bounds(accessor_json)) set_bounds(accessor_json, accessor(accessor_index), bytes());
}

void set_bounds(Json& accessor_json, const GltfAccessor& accessor, const GltfBytes& bytes) {
  GltfValue low;
  GltfValue high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t e = 0; e < accessor.count; ++e) {
    for (std::size_t k = 0; k < accessor.components; ++k) {
      const double value = load_component(accessor, e, k, bytes);
      if (!std::isfinite(value)) continue;
      low[k] = std::min(low[k], value);
      high[k] = std::max(high[k], value);
    }
  }
  const auto set = [&](const char* key, const GltfValue& bound) {
    Json& list = accessor_json[key];
    if (!list.is_array() || list.size() != accessor.components) list = Json::array();
    for (std::size_t k = 0; k < accessor.components; ++k) {
      const double value = std::isfinite(bound[k]) ? bound[k] : 0.0;
      const bool is_whole = is_integer(accessor.type);
      const Json number = is_whole ? Json(static_cast<std::int64_t>(value)) : Json(value);
      if (k == list.size())
        list.push_back(number);
      else if (!list[k].is_number() || !is_same_bound(list[k].get<double>(), value, accessor.type))
        list[k] = number;
    }
  };
  set("min", low);
  set("max", high);
}

}  // namespace meshgraft::io
