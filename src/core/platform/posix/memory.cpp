#include "core/platform/memory.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace meshgraft::platform {

namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

}  // namespace

std::uint64_t physical_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page_size = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page_size <= 0) return unlimited;
  return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_size);
}

std::uint64_t process_memory_limit() {
  std::uint64_t least = unlimited;
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit limit{};
    if (::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      least = std::min(least, static_cast<std::uint64_t>(limit.rlim_cur));
  }
  return least;
}

ControlGroups control_groups() {
#ifdef __linux__
  return {"/proc/self/cgroup", "/sys/fs/cgroup"};
#else
  return {};
#endif
}

bool can_reserve_address_space(std::size_t bytes) {
  void* const room =
      ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) return false;
  ::munmap(room, bytes);
  return true;
}

void release_freed_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

void map_large_blocks([[maybe_unused]] std::size_t bytes) {
#ifdef __GLIBC__
  constexpr int most_mapped = 65536;  // the default of glibc
  ::mallopt(M_MMAP_MAX, most_mapped);
  ::mallopt(M_MMAP_THRESHOLD, static_cast<int>(bytes));
#endif
}

void prefer_huge_pages([[maybe_unused]] const void* begin, [[maybe_unused]] std::size_t size) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t page = 4096;
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page;
  const std::uintptr_t last = (address + size) / page * page;
  if (last <= first || last - first < (std::size_t{1} << 23)) return;
  // This is only a hint: if the system rejects it, nothing changes. NOLINTNEXTLINE(performance-no-int-to-ptr)
  ::madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
}

}  // namespace meshgraft::platform
