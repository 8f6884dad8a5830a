#pragma once

#include <cstddef>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "temporary_folder.h"

namespace meshgraft::test {

inline std::string with_line_ends(const std::string& text, const std::string& line_end) {
  std::string result;
  for (const char c : text) result += c == '\n' ? line_end : std::string(1, c);
  return result;
}

/// Expects that a damaged file is refused with Error(input), or is read and written back as it is.
inline void expect_read_or_refused(const TemporaryFolder& folder, const char* name,
                                   const std::string& content) {
  const auto path = folder.file(name, content);
  try {
    const Mesh mesh = read_mesh(path);
    EXPECT_TRUE(folder.written(mesh, name) == content);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    EXPECT_FALSE(error.remedy().empty()) << error.what();
  }
}

/// Expects the same of `count` copies of `content`, each cut off or with a few bytes changed. The copies are
/// the same on every run.
inline void expect_damage_is_survived(const TemporaryFolder& folder, const char* name,
                                      const std::string& content, int count) {
  std::mt19937 random(7);
  const auto below = [&](std::size_t end) { return static_cast<std::size_t>(random() % end); };
  const std::string favourites = {'\0', '\xFF', '-', '9', '.', 'e', '#', '\n', ' ', '\x80'};
  for (int k = 0; k < count; ++k) {
    SCOPED_TRACE("damage " + std::to_string(k));
    std::string damaged = content;
    if (k % 4 == 0) {
      damaged.resize(1 + below(content.size()));
    } else {
      for (std::size_t flips = 1 + below(3); flips > 0; --flips) {
        const char byte =
            random() % 2 == 0 ? favourites[below(favourites.size())] : static_cast<char>(random());
        damaged[below(damaged.size())] = byte;
      }
    }
    expect_read_or_refused(folder, name, damaged);
  }
}

}  // namespace meshgraft::test
