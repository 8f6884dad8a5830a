#include "bench_merge.h"

#include <cmath>

#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

namespace meshgraft::bench {

BenchMerge make_head_on_bust(Index vertex_count) {
  const int resolution = static_cast<int>(std::lround(std::sqrt(vertex_count)));
  BenchMerge merge{make_sample("bust", resolution), make_sample("head", resolution), {}};
  merge.pairs = {{{boundary_loops(merge.source).front(), boundary_loops(merge.target).front()}, {}}};
  return merge;
}

}  // namespace meshgraft::bench
