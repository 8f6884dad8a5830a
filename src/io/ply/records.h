#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "core/memory_budget.h"
#include "document.h"

namespace meshgraft::io {

/// The destination of the values of one property while its element is read.
struct PlyTarget {
  double* values = nullptr;  ///< null: not kept
  std::size_t stride = 0;    ///< values from one row to the next
};

/// The values of a list property, row after row.
struct PlyListValues {
  std::size_t property = 0;
  std::vector<double> values;
  std::vector<std::uint32_t> lengths;
};

/// The destinations of all values of an element.
struct PlySinks {
  explicit PlySinks(MemoryBudget& charged) : budget(charged) {}

  MemoryBudget& budget;                ///< charged for lists and faces
  std::vector<PlyTarget> scalars;      ///< one per property
  std::vector<PlyListValues> lists;    ///< lists whose values are kept
  std::optional<std::size_t> corners;  ///< the list of vertex indices
  Faces* faces = nullptr;
};

/// Reads an element's records, which begin at `offset` of the document's content. Returns the offset of their
/// end. Throws Error(input) naming the line, or the record and the byte, and Error(memory).
std::size_t read_ply_records(const PlyDocument& document, const PlyElement& element, std::size_t offset,
                             PlySinks& sinks, const Context& context);

}  // namespace meshgraft::io
