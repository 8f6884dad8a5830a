#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <type_traits>

namespace meshgraft::platform {

/// Returns the bytes of the machine's main memory, or the largest number if the system does not report them.
std::uint64_t physical_memory();

/// Returns the bytes that this process may use under its limits, or the largest number without a limit.
std::uint64_t process_memory_limit();

/// Paths of the files that describe the control groups of this process and their limits; both are empty on
/// systems without control groups.
struct ControlGroups {
  std::filesystem::path membership, groups;
};
ControlGroups control_groups();

/// Returns whether `bytes` more of address space can be reserved. Keeps no reservation.
bool can_reserve_address_space(std::size_t bytes);

/// Gives freed memory back to the system. Small blocks that were freed leave gaps in which the large arrays of
/// a next step do not fit. Does nothing where the C library offers no way.
void release_freed_memory();

/// Gives blocks of `bytes` and more back to the system as soon as they are freed. By itself the C library keeps
/// blocks of up to 32 MB for later, and Open MPI makes it keep all. Does nothing where it offers no way.
void map_large_blocks(std::size_t bytes);

/// Asks for large pages for memory that is reserved and about to be filled. The first touches of 4 KiB pages
/// otherwise take a third of the time to read a binary file. Does nothing if the system has no large pages.
void prefer_huge_pages(const void* begin, std::size_t size);

/// Does the same for an array of `count` elements.
template <class T>
void prefer_huge_pages(const T* begin, std::size_t count)
  requires(!std::is_void_v<T>)
{
  prefer_huge_pages(static_cast<const void*>(begin), count * sizeof(T));
}

}  // namespace meshgraft::platform
