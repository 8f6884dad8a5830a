#include "memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "platform/memory.h"

namespace meshgraft {

std::uint64_t physical_memory() { return platform::physical_memory(); }

std::uint64_t control_group_limit(const std::filesystem::path& membership,
                                  const std::filesystem::path& groups) {
  std::uint64_t limit = std::numeric_limits<std::uint64_t>::max();
  // Without a limit cgroup version 2 reads "max" and version 1 a very large number.
  const auto look_upwards = [&](const std::filesystem::path& root, std::filesystem::path group,
                                const char* file) {
    for (group = group.relative_path();; group = group.parent_path()) {
      std::uint64_t bytes = 0;
      if (std::ifstream(root / group / file) >> bytes && bytes > 0) limit = std::min(limit, bytes);
      if (group.empty()) return;
    }
  };
  // Lines have the form "number:controllers:/path". Version 2 has one line, with neither number nor
  // controllers.
  std::ifstream lines(membership);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t second = line.find(':', line.find(':') + 1);
    if (second == std::string::npos) continue;
    const std::string group = line.substr(second + 1);
    if (line.starts_with("0::")) look_upwards(groups, group, "memory.max");
    if (line.substr(0, second).ends_with(":memory"))
      look_upwards(groups / "memory", group, "memory.limit_in_bytes");
  }
  return limit;
}

std::uint64_t available_memory() {
  const auto [membership, groups] = platform::control_groups();
  return std::min(
      {physical_memory(), platform::process_memory_limit(), control_group_limit(membership, groups)});
}

}  // namespace meshgraft
