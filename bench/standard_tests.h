#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench_edit.h"

namespace meshgraft::bench {

struct StandardTest {
  std::string name;  ///< plane, cylinder, bar, cactus
  BenchEdit edit;
};

/// Returns the four tests of Botsch and Sorkine (TVCG 2008) on our own samples: a bumpy plane whose middle is
/// lifted, a cylinder bent by 120°, a bar twisted by 135°, a cactus bent by 70°.
std::vector<StandardTest> sample_tests();

/// Reads the four tests from the user's files: NAME.off, NAME.sel and NAME.def in `folder` for each name.
std::vector<StandardTest> read_tests(const std::filesystem::path& folder);

}  // namespace meshgraft::bench
