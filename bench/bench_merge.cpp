#include "bench_merge.h"

#include <cmath>

#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

namespace meshgraft::bench {

BenchMerge make_head_on_bust(Index vertex_count) {
  const int resolution = static_cast<int>(std::lround(std::sqrt(vertex_count)));
  BenchMerge merge{make_sample("bust", resolution), make_sample("head", resolution), {}};
  constexpr double raise = 0.15;  // from below the bust's loop to a little above it
  merge.source.positions.col(2).array() += raise;
  merge.pairs = {{{boundary_loops(merge.source).front(), boundary_loops(merge.target).front()}, {}}};
  return merge;
}

}  // namespace meshgraft::bench
