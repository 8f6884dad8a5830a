#include <bit>
#include <utility>

#include <meshgraft/core/error.h>

#include "document.h"
#include "io/binary_value.h"
#include "io/facts.h"
#include "io/number_text.h"

namespace meshgraft::io {

bool needs_swap(PlyEncoding encoding) {
  return encoding ==
         (std::endian::native == std::endian::little ? PlyEncoding::big_endian : PlyEncoding::little_endian);
}

double PlyBinaryCursor::scalar(const PlyProperty&, ScalarType type) {
  const std::size_t size = size_of(type);
  if (content_.size() - offset_ < size)
    fail(facts::io::TruncatedRecords{.element = element_->name, .read = row_, .count = element_->count});
  value_begin_ = offset_;
  offset_ += size;
  return load_binary(content_.data() + value_begin_, type, swap_);
}

void PlyBinaryCursor::fail(Fact fact) const {
  const std::string location =
      element_->name + " " + std::to_string(row_) + " (byte " + std::to_string(offset_) + ")";
  throw Error(std::move(fact), Location::file(name_) / Location::place(location));
}

}  // namespace meshgraft::io
