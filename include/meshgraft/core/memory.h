#pragma once

#include <cstdint>

namespace meshgraft {

/// Bytes of the machine's main memory; the largest number where the system does not say.
std::uint64_t physical_memory();

/// Bytes that this process may use at most: of main memory, and as far as limits of the process and of its
/// group of processes (a container's) allow.
std::uint64_t available_memory();

}  // namespace meshgraft
