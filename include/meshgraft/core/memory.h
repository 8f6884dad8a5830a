#pragma once

#include <cstdint>
#include <filesystem>

namespace meshgraft {

/// Bytes of the machine's main memory; the largest number where the system does not say.
std::uint64_t physical_memory();

/// Bytes that this process may use at most: of main memory, and as far as limits of the process and of its
/// group of processes (a container's) allow.
std::uint64_t available_memory();

/// The least limit of a process's control groups and those above them, in bytes; the largest number where there
/// is none. `membership` is a file that lists the process's groups as Linux does, `groups` the folder of all
/// groups.
std::uint64_t control_group_limit(const std::filesystem::path& membership, const std::filesystem::path& groups);

}  // namespace meshgraft
