#pragma once

#include <meshgraft/merge/merge.h>

namespace meshgraft::bench {

/// A graft of the built-in head on the bust, both of about `vertex_count` vertices. The head is a little
/// above.
struct BenchMerge {
  Mesh target, source;
  std::vector<MergePair> pairs;
};
BenchMerge make_head_on_bust(Index vertex_count);

}  // namespace meshgraft::bench
