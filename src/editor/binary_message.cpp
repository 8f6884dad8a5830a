#include "binary_message.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

namespace meshgraft::editor {

static_assert(std::endian::native == std::endian::little, "messages are little-endian as they stand in memory");

void BinaryMessage::add(std::string_view name, std::span<const float> values, const Json& of) {
  append({{"name", name}, {"of", of}, {"type", "float32"}, {"length", values.size()}}, std::as_bytes(values));
}

void BinaryMessage::add(std::string_view name, std::span<const Index> values, const Json& of) {
  append({{"name", name}, {"of", of}, {"type", "uint32"}, {"length", values.size()}}, std::as_bytes(values));
}

void BinaryMessage::add(std::string_view name, std::span<const std::uint8_t> values, const Json& of) {
  append({{"name", name}, {"of", of}, {"type", "uint8"}, {"length", values.size()}}, std::as_bytes(values));
}

void BinaryMessage::append(Json description, std::span<const std::byte> bytes) {
  if (description["of"].is_null()) description.erase("of");
  header_["arrays"].push_back(std::move(description));
  arrays_.insert(arrays_.end(), bytes.begin(), bytes.end());
  arrays_.resize((arrays_.size() + 3) / 4 * 4);
}

std::vector<std::byte> BinaryMessage::bytes() const {
  std::string json = header_.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::array<char, 12> start{'M', 'G', 'F', '1'};
  const std::array<std::uint32_t, 2> numbers{static_cast<std::uint32_t>(kind_),
                                             static_cast<std::uint32_t>(json.size())};
  std::memcpy(start.data() + 4, numbers.data(), sizeof numbers);
  std::vector<std::byte> all(start.size() + json.size() + arrays_.size());
  std::memcpy(all.data(), start.data(), start.size());
  std::memcpy(all.data() + start.size(), json.data(), json.size());
  std::copy(arrays_.begin(), arrays_.end(),
            all.begin() + static_cast<std::ptrdiff_t>(start.size() + json.size()));
  return all;
}

ByteParts parts_of(std::span<const std::byte> message) {
  ByteParts parts;
  for (std::size_t at = 0; at < message.size(); at += part_bytes) {
    const std::span<const std::byte> bytes = message.subspan(at, std::min(part_bytes, message.size() - at));
    const std::array<char, 8> start{'M', 'G', 'F', 'P'};
    const std::array<std::uint64_t, 2> numbers{at, message.size()};
    std::vector<std::byte>& part = parts.emplace_back(start.size() + sizeof numbers + bytes.size());
    std::memcpy(part.data(), start.data(), start.size());
    std::memcpy(part.data() + start.size(), numbers.data(), sizeof numbers);
    std::memcpy(part.data() + start.size() + sizeof numbers, bytes.data(), bytes.size());
  }
  return parts;
}

std::vector<float> relative_to(const Eigen::RowVector3d& offset, const Points& points) {
  std::vector<float> values;
  values.reserve(points.size());
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(points(i, k) - offset(k)));
  return values;
}

}  // namespace meshgraft::editor
