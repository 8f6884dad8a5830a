#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <type_traits>

namespace meshgraft::platform {

/// Bytes of the machine's main memory; the largest number where the system does not say.
std::uint64_t physical_memory();

/// Bytes that the limits of this process allow it; the largest number where there are none.
std::uint64_t process_memory_limit();

/// Where the system tells the control groups of this process, and their limits; both are empty where it has
/// none.
struct ControlGroups {
  std::filesystem::path membership, groups;
};
ControlGroups control_groups();

/// Whether so many more bytes of address space can be had. Nothing of them is kept.
bool can_reserve_address_space(std::size_t bytes);

/// Asks for large pages for memory that was reserved and is about to be filled: the first touch of every 4 KiB
/// page otherwise takes a third of the time to read a binary file. Does nothing where the system has none.
void prefer_huge_pages(const void* begin, std::size_t size);

/// The same for an array of `count` elements.
template <class T>
void prefer_huge_pages(const T* begin, std::size_t count)
  requires(!std::is_void_v<T>)
{
  prefer_huge_pages(static_cast<const void*>(begin), count * sizeof(T));
}

}  // namespace meshgraft::platform
