#pragma once

#include <cstdint>

namespace meshgraft {

/// Bytes of the machine's main memory; the largest number where the system does not say.
std::uint64_t physical_memory();

}  // namespace meshgraft
