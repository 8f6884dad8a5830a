#pragma once

#include <cstdint>
#include <filesystem>

namespace meshgraft {

/// Returns the size of the machine's main memory in bytes, or the largest representable number where the
/// system does not report it.
std::uint64_t physical_memory();

/// Returns the largest number of bytes that this process may use. It is the smallest of the main memory, the
/// limit of the process, and the limit of its control groups (of a container).
std::uint64_t available_memory();

/// Returns the smallest memory limit of a process's control groups and their ancestors, in bytes. Without a
/// limit it returns the largest representable number. `membership` is a file that lists the process's groups
/// in the format of Linux; `groups` is the folder of all groups.
std::uint64_t control_group_limit(const std::filesystem::path& membership, const std::filesystem::path& groups);

}  // namespace meshgraft
