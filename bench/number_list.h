#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::bench {

/// Returns the numbers of a list such as "1000,2000".
inline std::vector<Index> numbers(const std::string& text) {
  std::vector<Index> result;
  for (std::size_t at = 0; at < text.size(); ++at) {
    result.push_back(static_cast<Index>(std::stol(text.substr(at))));
    at = std::min(text.find(',', at), text.size());
  }
  return result;
}

}  // namespace meshgraft::bench
