#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

#include "editor/message_kind.h"
#include "protocol.h"

namespace meshgraft::editor {

/// A binary message that carries arrays of numbers to the page. Its bytes, all little-endian:
///   "MGF1", kind (uint32), length of the JSON (uint32, a multiple of 4), the JSON, padded with blanks,
///   then the arrays that its field `arrays` lists as {name, of, type, length}, one after another, each
///   padded to 4 bytes. Only arrays of which a message has several by one name have `of`.
class BinaryMessage {
 public:
  BinaryMessage(MessageKind kind, Json header) : kind_(kind), header_(std::move(header)) {
    header_["arrays"] = Json::array();
  }

  /// Adds an array. `of` tells arrays of one name apart: the name of a handle or the number of a picture. It
  /// is null for the only array of the name.
  void add(std::string_view name, std::span<const float> values, const Json& of = {});
  void add(std::string_view name, std::span<const Index> values,
           const Json& of = {});  ///< as uint32; no value is negative
  void add(std::string_view name, std::span<const std::uint8_t> values, const Json& of = {});

  std::vector<std::byte> bytes() const;

 private:
  void append(Json description, std::span<const std::byte> bytes);

  MessageKind kind_;
  Json header_;
  std::vector<std::byte> arrays_;
};

/// Largest part of a message, bytes. A browser assembles and copies what the socket delivers on the page's
/// thread and blocks it meanwhile.
constexpr std::size_t part_bytes = std::size_t{1} << 22;

/// Splits a message into parts of at most `part_bytes`, each with a header. The bytes of a part, all
/// little-endian: "MGFP", 0 (uint32), its offset in the message (uint64), length of the message (uint64), and
/// the bytes from there on.
ByteParts parts_of(std::span<const std::byte> message);

/// Returns positions relative to `offset` in single precision, 3 numbers per point.
std::vector<float> relative_to(const Eigen::RowVector3d& offset, const Points& points);

}  // namespace meshgraft::editor
