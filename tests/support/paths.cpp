#include "support/paths.h"

#include <cstdlib>

namespace meshgraft::test {

std::filesystem::path source_path(const std::filesystem::path& below) {
  return std::filesystem::path(MESHGRAFT_SOURCE_DIR) / below;
}

std::filesystem::path data_folder() {
  const char* folder = std::getenv("MESHGRAFT_DATA");
  return folder != nullptr ? std::filesystem::path(folder) : source_path("../shared/data");
}

const char* program() { return MESHGRAFT_PROGRAM; }
const char* python() { return MESHGRAFT_PYTHON; }

}  // namespace meshgraft::test
